"""The ball in SI units, and its dimensionless groups.

:class:`PointContact` is to the ball what :class:`stribeck.LineContact` is to the cylinder.  No equation is solved here.

Source: H. Hertz (1882), as in K. L. Johnson, Contact Mechanics (1985), for the dry contact; theory.md, section 11.
"""

from __future__ import annotations

import inspect
import math
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, Self

from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact, HertzScales
from stribeck.contacts.groups import Groups
from stribeck.contacts.model import BASE_MODEL, Model
from stribeck.contacts.parts import BASE_PARTS, PURE_SLIDING, Parts, signature_with_parts
from stribeck.quantities.contact_values import signature_of
from stribeck.quantities.formats import format_si
from stribeck.quantities.inputs import POINT, InputTable, quantity
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.units import InputError, show

__all__ = ["HamrockDowsonNumbers", "PointContact"]


class HamrockDowsonNumbers(NamedTuple):
    """The numbers of B. J. Hamrock and D. Dowson, with the mean speed and E' = 2 E*."""

    speed: float  # Viscosity times mean speed over E' R [-]
    load: float  # Load over E' R**2 [-]


@dataclass(frozen=True, init=False, repr=False)
class PointContact(Contact):
    r"""A rough ball on a lubricated elastic half-space, in SI units: what a ball-on-disc tribometer has.

    Every quantity is text with a unit (``"9.5 mm"``) or a bare number in SI units; floats in SI are kept.

    Parameters
    ----------
    radius : str or float
        Radius :math:`R > 0` of the ball [m].
    modulus : str or float, optional
        Effective modulus :math:`1/E^* = (1-\nu_1^2)/E_1 + (1-\nu_2^2)/E_2` [Pa]; or give the moduli and Poisson ratios.
    load : str or float
        Normal load :math:`F_N > 0`, a force [N].
    viscosity : str or float
        Viscosity :math:`\eta > 0` of the fluid [Pa s].
    speed : str or float, optional
        Sum of the speeds of both surfaces through the contact, :math:`U = u_1 + u_2 \ge 0` [m/s]: with one surface at rest
        the sliding speed.  Where both surfaces move give ``entrainment_speed`` and ``slide_to_roll`` instead.
    roughness : str or float
        Root-mean-square roughness :math:`h_\mathrm{rms} \ge 0` of both surfaces together [m].
    alpha : float
        Coefficient :math:`\alpha > 0` of the contact law, as in :class:`stribeck.LineContact` [-].
    beta : float
        Coefficient :math:`\beta > 0` of the same law [-].
    boundary_friction : float
        Friction coefficient :math:`\mu_0 \ge 0` of the solid contact [-].
    youngs_modulus : str or float, optional
        Young's modulus :math:`E > 0` of the soft body, ball or disc [Pa].
    poisson_ratio : float, optional
        Poisson ratio :math:`0 \le \nu \le 1/2` of the same body [-].
    entrainment_speed : str or float, optional
        Mean of both surface speeds, :math:`U/2`, which tribometers report [m/s].
    slide_to_roll : float
        Slide-to-roll ratio :math:`S = 2 (u_1 - u_2)/(u_1 + u_2)`, 0 to 2 [-]; 2 is one surface at rest.
    wetted_radius : str or float, optional
        Radius of the disc around the contact that is filled with liquid [m], beyond which nothing drags; without it the ball
        is immersed.
    radius_2 : str or float, optional
        Radius of the other body where it is curved too [m]; then :math:`1/R = 1/R_1 + 1/R_2`.
    youngs_modulus_2 : str or float, optional
        Young's modulus of the other body where it is soft too [Pa].
    poisson_ratio_2 : float, optional
        Poisson ratio of the other body [-].
    law : str or AsperityLaw, optional
        Contact law, or the name of one that needs no surface,
        :math:`p_c = \beta E^* \Phi(\alpha h/h_\mathrm{rms})`; :math:`\Phi(s) = \exp(-s)` by default.
    fluid, cavitation, cavity_pressure, flow_factors, solid : object, optional
        As in :class:`stribeck.LineContact`; those that a ball does not have are refused by :func:`stribeck.solve`.

    Attributes
    ----------
    groups : Groups
        The dimensionless groups, with ``geometry="point"``.
    hertz : HertzScales
        The scales with which dimensionless results return to SI.
    hersey_number : float
        :math:`\eta U R/F_N` [-], with the sum :math:`U`: twice the number that is made with a mean speed.

    Raises
    ------
    InputError
        Where a value is impossible, a unit is wrong, the modulus is given twice or not at all, ``speed`` is given with a
        slide-to-roll ratio other than 2, or the wetted radius lies inside the contact.

    Notes
    -----
    Films and load shares are those of :math:`U`, whatever the slide-to-roll ratio; friction takes the sliding speed
    :math:`u_1 - u_2 = S U/2`, for the shear of the fluid.  ``modulus``, ``radius`` and ``speed`` always hold :math:`E^*`,
    :math:`R` and :math:`U` afterwards, and :meth:`replace` takes them as such.

    Friction depends on where the liquid ends, by a logarithm: see ``wetted_radius`` and theory.md, section 11.

    Source: theory.md, section 11.

    Examples
    --------
    >>> ball = PointContact(radius="9.5 mm", modulus="1.6 MPa", load="1.3 N", viscosity="10 mPa*s",
    ...                     entrainment_speed="50 mm/s", slide_to_roll=0.5, roughness="0.4 um", alpha=2.0, beta=0.05,
    ...                     boundary_friction=0.9)
    >>> round(ball.slope, 3), round(ball.groups.load, 1)
    (0.189, 13.9)
    """

    slide_to_roll: float
    wetted_radius: float | None

    INPUTS: ClassVar[InputTable] = POINT
    WIDTH: ClassVar[str] = "Hertz radius"
    __signature__: ClassVar[inspect.Signature] = signature_with_parts(signature_of(POINT))

    @answers_typos
    def __init__(self, *, law: str | AsperityLaw | None = None, **inputs: Any) -> None:
        speed, ratio = inputs.get("speed"), inputs.get("slide_to_roll")
        if speed is not None and ratio is not None and quantity("slide_to_roll", ratio, POINT) != PURE_SLIDING:
            raise InputError(
                f"speed = {show(speed)} is the sliding speed over a surface at rest, slide_to_roll 2, but slide_to_roll = "
                f"{show(ratio)}; give the mean of both surface speeds as entrainment_speed instead."
            )
        super().__init__(law=law, **inputs)

    @property
    def groups(self) -> Groups:
        """The dimensionless groups, see :class:`Groups`."""
        eta, U, R, E_star, F_N = self.viscosity, self.speed, self.radius, self.modulus, self.load
        return Groups(
            speed=3 * math.pi * (eta * U / R / E_star) / self.slope**4,
            load=6 / math.pi**3 * (F_N / R / R / E_star) / self.beta**3,
            roughness=4 / math.pi**2 * (self.roughness / R) / self.alpha / self.beta / self.beta,
            law=self.law,
            geometry="point",
            model=self._model(),
        )

    def _model(self) -> Model:
        if self.parts is BASE_PARTS or self.parts == BASE_PARTS:
            return BASE_MODEL
        moving = Parts(**{**self.parts.items(), "slide_to_roll": self.slide_to_roll})
        return moving.model(self.film_units, self.hertz.half_width, self.speed)

    @property
    def hertz(self) -> HertzScales:
        """The Hertz scales, see :class:`HertzScales`."""
        R, E_star, F_N = self.radius, self.modulus, self.load
        a = (0.75 * F_N / E_star * R) ** (1 / 3)
        return HertzScales(half_width=a, indentation=a * (a / R), pressure=1.5 * F_N / math.pi / a / a)

    @property
    def hersey_number(self) -> float:
        r"""The Hersey number :math:`\eta U R/F_N` [-], :math:`U` being the sum of the surface speeds."""
        return self.viscosity * self.speed / self.load * self.radius

    @property
    def sliding_speed(self) -> float:
        """Difference of the surface speeds, :math:`u_1 - u_2` [m/s]."""
        return 0.5 * self.slide_to_roll * self.speed

    @property
    def moes_number(self) -> float:
        r"""The load number of H. Moes [-]; infinite at rest.

        .. math:: M = \frac{F_N}{E' R^2} \left(\frac{\eta U}{E' R}\right)^{-3/4}
            = \frac23 \left(\frac{6\pi}{\lambda}\right)^{3/4}, \qquad E' = 2 E^*

        His lubricant number L is zero, as viscosity does not depend on the pressure.
        """
        speed = float(self.groups.speed)
        return 2 / 3 * (6 * math.pi / speed) ** 0.75 if speed > 0 else math.inf

    @property
    def hamrock_dowson_numbers(self) -> HamrockDowsonNumbers:
        r"""The speed and load numbers of B. J. Hamrock and D. Dowson.

        .. math:: \frac{\eta U/2}{E' R} = \frac{\lambda}{12 \pi} \left(\frac aR\right)^4, \qquad
            \frac{F_N}{E' R^2} = \frac23 \left(\frac aR\right)^3, \qquad E' = 2 E^*
        """
        R, stiffness = self.radius, 2 * self.modulus
        return HamrockDowsonNumbers(0.5 * self.viscosity * self.speed / stiffness / R, self.load / stiffness / R / R)

    @classmethod
    @answers_typos
    def from_groups(
        cls,
        groups: Groups,
        *,
        radius: str | float,
        modulus: str | float,
        viscosity: str | float,
        alpha: float,
        beta: float,
        boundary_friction: float,
        slide_to_roll: float = PURE_SLIDING,
        wetted_radius: str | float | None = None,
    ) -> Self:
        r"""Return the contact whose :attr:`groups` are ``groups``.

        .. math::

            F_N = \frac{\pi^3}{6} \beta^3 R^2 E^* \bar F_N, \quad
            U = \frac{\lambda E^* R}{3\pi \eta} \left(\frac aR\right)^4, \quad
            h_\mathrm{rms} = \frac{\pi^2}{4} \alpha \beta^2 R \bar h_\mathrm{rms}

        Parameters
        ----------
        groups : Groups
            Groups of one state of a ball.
        radius, modulus, viscosity : str or float
            As in :class:`PointContact`.
        alpha, beta, boundary_friction, slide_to_roll : float
            As in :class:`PointContact`.
        wetted_radius : str or float, optional
            As in :class:`PointContact`.

        Returns
        -------
        PointContact
            The contact, with load, speed and roughness in SI.

        Raises
        ------
        InputError
            Where the groups hold more than one state or are those of a cylinder, or a value is impossible.
        """
        if groups.shape != ():
            raise InputError(f"groups of shape {groups.shape} hold many states; from_groups takes one, without arrays.")
        if groups.geometry != "point":
            raise InputError(f"groups.geometry = {groups.geometry!r}; a ball has 'point', for a cylinder use LineContact.")
        R, E_star, eta = quantity("radius", radius), quantity("modulus", modulus), quantity("viscosity", viscosity)
        beta, alpha = quantity("beta", beta), quantity("alpha", alpha)
        speed = float(groups.speed) * float(groups.slope(beta)) ** 4 / (3 * math.pi) * E_star * R / eta
        return cls(
            radius=R,
            load=math.pi**3 / 6 * beta**3 * R * R * E_star * float(groups.load),
            viscosity=eta,
            entrainment_speed=0.5 * speed,
            slide_to_roll=slide_to_roll,
            roughness=math.pi**2 / 4 * alpha * beta * beta * R * float(groups.roughness),
            alpha=alpha,
            beta=beta,
            boundary_friction=boundary_friction,
            modulus=E_star,
            wetted_radius=wetted_radius,
            law=groups.law,
        )

    def _check_scales(self) -> None:
        """Refuse what leaves double precision, and a wetted radius inside the contact."""
        super()._check_scales()
        a = self.hertz.half_width
        if self.wetted_radius is not None and self.wetted_radius <= a:
            wetted, radius = (format_si(value, "length") for value in (self.wetted_radius, a))
            raise InputError(
                f"wetted_radius = {wetted} lies inside the contact, whose Hertz radius is {radius}; give the radius at "
                "which the liquid around the contact ends, or leave it out if the ball is immersed."
            )
