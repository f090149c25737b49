"""The line contact in SI units, and the dimensionless groups that the model makes of it.

:class:`LineContact` is what a tribologist knows; it turns into :class:`Groups` and back, and gives the Hertz scales with
which results return to SI. No equation is solved here.

Source: [Bertin & Pouliquen] Eq. (Hertz_scales).
"""

from __future__ import annotations

import inspect
import math
from dataclasses import dataclass
from typing import ClassVar, Self

from stribeck.contacts.contact import Contact, HertzScales
from stribeck.contacts.groups import Groups
from stribeck.contacts.model import BASE_MODEL
from stribeck.contacts.parts import BASE_PARTS, signature_with_parts
from stribeck.quantities.contact_values import signature_of
from stribeck.quantities.inputs import LINE, InputTable, quantity
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.units import InputError

__all__ = ["Groups", "HertzScales", "InputError", "LineContact"]


@dataclass(frozen=True, init=False, repr=False)
class LineContact(Contact):
    r"""A rigid rough cylinder sliding on a lubricated elastic half-space, in SI units.

    Every quantity is text with a unit (``"10 mm"``) or a bare number in SI units; floats in SI are kept.

    Parameters
    ----------
    radius : str or float
        Radius :math:`R > 0` of the cylinder [m].
    modulus : str or float, optional
        Effective modulus :math:`E^* = E/(1 - \nu^2) > 0` [Pa], of two soft bodies
        :math:`1/E^* = (1-\nu_1^2)/E_1 + (1-\nu_2^2)/E_2`; or give Young's modulus and Poisson ratio.
    load : str or float
        Normal load per unit length :math:`F_N > 0` [N/m].
    viscosity : str or float
        Viscosity :math:`\eta > 0` of the fluid [Pa s].
    speed : str or float, optional
        Sum of the speeds of both surfaces through the contact, :math:`U = u_1 + u_2 \ge 0` [m/s]: with one surface at rest
        the sliding speed, in general twice the mean (entrainment) speed :math:`(u_1 + u_2)/2` that tribometers report; or
        give that as ``entrainment_speed``.
    roughness : str or float
        Root-mean-square roughness :math:`h_\mathrm{rms} \ge 0` [m].
    alpha : float
        Coefficient :math:`\alpha > 0` of the contact law
        :math:`p_c = \beta E^* \exp(-\alpha h/h_\mathrm{rms})` [-]; about 2 for self-affine surfaces.
    beta : float
        Coefficient :math:`\beta > 0` of the same law [-]; about the wave number of the longest roughness
        times :math:`h_\mathrm{rms}`, so 1e-3 to 1e-1 for real surfaces.
    boundary_friction : float
        Friction coefficient :math:`\mu_0 \ge 0` of the solid contact [-].
    youngs_modulus : str or float, optional
        Young's modulus :math:`E > 0` of the half-space [Pa].
    poisson_ratio : float, optional
        Poisson ratio :math:`0 \le \nu \le 1/2` of the half-space [-].
    entrainment_speed : str or float, optional
        Mean of both surface speeds, in place of ``speed`` [m/s].
    radius_2 : str or float, optional
        Radius of the other body where it is curved too [m]; then :math:`1/R = 1/R_1 + 1/R_2`.
    youngs_modulus_2 : str or float, optional
        Young's modulus of the other body where it is soft too [Pa].
    poisson_ratio_2 : float, optional
        Poisson ratio of the other body [-].
    law : str or AsperityLaw, optional
        Contact law, or the name of one that needs no surface,
        :math:`p_c = \beta E^* \Phi(\alpha h/h_\mathrm{rms})`; :math:`\Phi(s) = \exp(-s)` by default.
    fluid : Fluid or law of sb.fluids, optional
        The fluid, whose viscosity at ambient pressure and low rate is ``viscosity``; Newtonian without it.
    cavitation : {"none", "exit", "reform"}
        How the film ends behind the contact.
    cavity_pressure : str or float
        Rupture pressure of a film that reforms, above the ambient one, zero or below [Pa].
    flow_factors : {"none", "effective-medium", "patir-cheng"} or law of sb.fluids, optional
        What roughness does to the flow.
    solid : solid of sb.solids, optional
        The soft body; a half-space without it.
    slide_to_roll : float
        :math:`2 (u_1 - u_2)/(u_1 + u_2)` [-]; 2, pure sliding with the cylinder at rest, by default.

    Attributes
    ----------
    groups : Groups
        The dimensionless groups.
    hertz : HertzScales
        The scales with which dimensionless results return to SI.
    hersey_number : float
        :math:`\eta U/F_N` [-], with that sum :math:`U`: twice the number that is made with a mean speed.

    Raises
    ------
    InputError
        Where a value is impossible, a unit is wrong, or the modulus is given twice or not at all.

    Notes
    -----
    Where both surfaces move, films of Newtonian fluids and load shares are those of :math:`U = u_1 + u_2`, and friction is
    that of the sliding speed :math:`u_1 - u_2`, by ``slide_to_roll``.

    ``modulus`` always holds :math:`E^*` afterwards; ``youngs_modulus`` and ``poisson_ratio`` are not kept.  Inputs as data
    sheets have them (``shore_a``, ``ra``, ``kinematic_viscosity`` ...) may take the place of others: docs/data_sheet.md.

    Source: [Bertin & Pouliquen] Eq. (contact_pressure) for the contact law, Section "Dimensional analysis"
    for the groups. The paper calls :math:`\beta` a number of order unity; for real surfaces it is small.

    Examples
    --------
    >>> contact = LineContact(radius="10 mm", modulus="2.1 MPa", load="50 N/m", viscosity="1 mPa*s",
    ...                       speed="0.1 m/s", roughness="1 um", alpha=2.0, beta=0.05,
    ...                       boundary_friction=0.8)
    >>> round(contact.groups.load, 3)
    0.303
    """

    INPUTS: ClassVar[InputTable] = LINE
    __signature__: ClassVar[inspect.Signature] = signature_with_parts(signature_of(LINE))

    @property
    def groups(self) -> Groups:
        """The dimensionless groups, see :class:`Groups`."""
        eta, U, R, E_star, F_N = self.viscosity, self.speed, self.radius, self.modulus, self.load
        # Quotients one by one: a product of small numbers may underflow where the group itself does not.
        return Groups(
            speed=3 * math.pi**2 / 4 * (eta * U / F_N) * (R / F_N * E_star),
            load=F_N / R / E_star / self.beta / self.beta / math.pi,
            roughness=self.roughness / R / self.beta / self.beta / self.alpha / 4,
            law=self.law,
            model=BASE_MODEL if self.parts is BASE_PARTS else self.parts.model(self.film_units, self.hertz.half_width, U),
        )

    @property
    def slide_to_roll(self) -> float:
        """Ratio of the sliding speed to the mean of the surface speeds [-]."""
        return self.parts.slide_to_roll

    @property
    def hertz(self) -> HertzScales:
        """The Hertz scales, see :class:`HertzScales`."""
        R, E_star, F_N = self.radius, self.modulus, self.load
        a = math.sqrt(F_N / E_star) * math.sqrt(4 * R / math.pi)
        return HertzScales(half_width=a, indentation=4 * F_N / E_star / math.pi, pressure=2 * F_N / a / math.pi)

    @property
    def hersey_number(self) -> float:
        r"""The Hersey number :math:`\eta U/F_N` [-], :math:`U` being the sum of the surface speeds."""
        return self.viscosity * self.speed / self.load

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
    ) -> Self:
        r"""Return the contact whose :attr:`groups` are ``groups``.

        .. math::

            F_N = \pi \beta^2 R E^* \bar F_N, \quad
            U = \frac{4}{3\pi^2} \frac{\lambda F_N^2}{\eta R E^*}, \quad
            h_\mathrm{rms} = 4 \alpha \beta^2 R \bar h_\mathrm{rms}

        Parameters
        ----------
        groups : Groups
            Groups of one state.
        radius, modulus, viscosity : str or float
            As in :class:`LineContact`.
        alpha, beta, boundary_friction : float
            As in :class:`LineContact`.

        Returns
        -------
        LineContact
            The contact, with load, speed and roughness in SI.

        Raises
        ------
        InputError
            Where the groups hold more than one state, or a value is impossible.
        """
        if groups.shape != ():
            raise InputError(f"groups of shape {groups.shape} hold many states; from_groups takes one, without arrays.")
        R, E_star = quantity("radius", radius), quantity("modulus", modulus)
        eta, beta, alpha = quantity("viscosity", viscosity), quantity("beta", beta), quantity("alpha", alpha)
        F_N = math.pi * beta * beta * R * E_star * float(groups.load)
        return cls(
            radius=R,
            load=F_N,
            viscosity=eta,
            speed=4 / (3 * math.pi**2) * float(groups.speed) * (F_N / eta) * (F_N / R / E_star),
            roughness=4 * alpha * beta * beta * R * float(groups.roughness),
            alpha=alpha,
            beta=beta,
            boundary_friction=boundary_friction,
            modulus=E_star,
            law=groups.law,
        )
