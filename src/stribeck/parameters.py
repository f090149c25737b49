r"""The three dimensionless groups of the model and the line contact in SI units that they come from.

:class:`Groups` is all that the equations see. :class:`LineContact` is what a tribologist knows; it turns into
groups and back, and gives the Hertz scales with which results return to SI. No equation is solved here.

Source: [Bertin & Pouliquen] Eq. (Hertz_scales) and the definitions of :math:`\lambda`, :math:`\bar F_N` and
:math:`\bar h_\mathrm{rms}` below it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np

from ._types import Array, LawShape
from .units import InputError, show, to_si

__all__ = [
    "QUANTITIES",
    "Groups",
    "HertzScales",
    "INPUTS",
    "InputError",
    "LineContact",
    "check_law",
    "check_modulus_choice",
    "quantity",
]


@dataclass(frozen=True, eq=False, repr=False)
class Groups:
    r"""The dimensionless groups of the model: one state, or arrays of states that broadcast.

    .. math::

        \lambda = \frac{3\pi^2}{4} \frac{\eta U R E^*}{F_N^2}, \quad
        \bar F_N = \frac{F_N}{\pi \beta^2 R E^*}, \quad
        \bar h_\mathrm{rms} = \frac{h_\mathrm{rms}}{4 \alpha \beta^2 R}

    Parameters
    ----------
    speed : float or array_like
        :math:`\lambda \ge 0` [-]; zero is the quasistatic contact.
    load : float or array_like
        :math:`\bar F_N > 0` [-]; from one on, the exponential contact law is outside its range.
    roughness : float or array_like
        :math:`\bar h_\mathrm{rms} \ge 0` [-]; zero is the smooth contact.
    law : LawShape, optional
        Contact law :math:`\Phi`, the pressure over :math:`\beta E^*` at the separation :math:`\alpha h/h_\mathrm{rms}`; the
        exponential law of the paper by default.

    Raises
    ------
    InputError
        Where a group is no real number, not finite or out of range, or the three shapes do not broadcast, or the law is none.

    Notes
    -----
    Arrays are kept as read-only float64 copies, each in its own shape. Friction needs the coefficient
    :math:`\beta` of the contact law too, see :meth:`hersey_number` and :meth:`slope`.

    Source: [Bertin & Pouliquen] Section "Dimensional analysis".
    """

    speed: float | Array
    load: float | Array
    roughness: float | Array
    law: LawShape | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        """Check the groups and make them floats or read-only arrays."""
        check_law(self.law)
        for name, positive in (("speed", False), ("load", True), ("roughness", False)):
            object.__setattr__(self, name, _group(name, getattr(self, name), positive))
        try:
            _ = self.shape
        except ValueError:
            shapes = ", ".join(f"{name} {np.shape(getattr(self, name))}" for name in ("speed", "load", "roughness"))
            raise InputError(f"the shapes of the groups do not broadcast: {shapes}.") from None

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the three groups broadcast together; ``()`` for one state."""
        if isinstance(self.speed, float) and isinstance(self.load, float) and isinstance(self.roughness, float):
            return ()
        return np.broadcast_shapes(np.shape(self.speed), np.shape(self.load), np.shape(self.roughness))

    @property
    def relative_roughness(self) -> float | Array:
        r"""Roughness over Hertz indentation, :math:`\kappa = \bar h_\mathrm{rms}/\bar F_N` [-]."""
        with np.errstate(all="ignore"):
            return self.roughness / self.load

    def hersey_number(self, beta: float = 1.0) -> float | Array:
        r"""Return the Hersey number.

        .. math:: \frac{\eta U}{F_N} = \frac{4 \beta^2 \bar F_N \lambda}{3 \pi}

        Parameters
        ----------
        beta : float
            Coefficient :math:`\beta` of the contact law [-].

        Returns
        -------
        float or ndarray
            Hersey number [-], of the broadcast shape.

        Raises
        ------
        InputError
            Where ``beta`` is not a positive number.
        """
        beta = quantity("beta", beta)
        with np.errstate(all="ignore"):
            return 4 * beta * beta * self.load * self.speed / (3 * math.pi)

    def slope(self, beta: float = 1.0) -> float | Array:
        r"""Return the slope of the cylinder at the edge of the Hertz contact.

        .. math:: \frac{a}{R} = 2 \beta \bar F_N^{1/2}

        Parameters
        ----------
        beta : float
            Coefficient :math:`\beta` of the contact law [-].

        Returns
        -------
        float or ndarray
            Half-width of the Hertz contact over the radius [-], of the shape of ``load``.

        Raises
        ------
        InputError
            Where ``beta`` is not a positive number.
        """
        return 2 * quantity("beta", beta) * self.load**0.5

    def __eq__(self, other: object) -> bool:
        """Tell whether the groups have the same shapes and values."""
        if not isinstance(other, Groups):
            return NotImplemented
        names = ("speed", "load", "roughness")
        same = all(np.array_equal(getattr(self, name), getattr(other, name)) for name in names)
        return same and self.law == other.law

    def __hash__(self) -> int:
        """Hash by value."""
        values = (np.asarray(value) for value in (self.speed, self.load, self.roughness))
        return hash((*((value.shape, value.tobytes()) for value in values), self.law))

    def __repr__(self) -> str:
        """Return the groups, and the law where it is not the exponential one."""
        law = "" if self.law is None else f", law={self.law!r}"
        return f"Groups(speed={self.speed!r}, load={self.load!r}, roughness={self.roughness!r}{law})"


@dataclass(frozen=True)
class HertzScales:
    r"""Scales of the dry contact of a smooth cylinder, in SI units.

    .. math::

        a = \left(\frac{4 F_N R}{\pi E^*}\right)^{1/2}, \quad u_\mathrm{Hz} = \frac{a^2}{R}, \quad
        p_\mathrm{Hz} = \frac{2 F_N}{\pi a}

    Parameters
    ----------
    half_width : float
        :math:`a`, the scale of lengths along the contact [m].
    indentation : float
        :math:`u_\mathrm{Hz}`, the scale of gaps [m].
    pressure : float
        :math:`p_\mathrm{Hz}`, the largest pressure of the dry contact and the scale of pressures [Pa].

    Notes
    -----
    Source: [Bertin & Pouliquen] Eq. (Hertz_scales).
    """

    half_width: float
    indentation: float
    pressure: float


@dataclass(frozen=True)
class Quantity:
    """Dimension and lower bound of one input; ``zero`` tells whether the bound zero itself is allowed."""

    dimension: str
    zero: bool = False
    highest: float = math.inf


QUANTITIES = {
    "radius": Quantity("length"),
    "load": Quantity("load"),
    "viscosity": Quantity("viscosity"),
    "speed": Quantity("speed", zero=True),
    "roughness": Quantity("length", zero=True),
    "alpha": Quantity("number"),
    "beta": Quantity("number"),
    "friction_coefficient": Quantity("number", zero=True),
    "modulus": Quantity("pressure"),
    "youngs_modulus": Quantity("pressure"),
    "poisson_ratio": Quantity("number", zero=True, highest=0.5),
}


INPUTS = ("radius", "load", "viscosity", "speed", "roughness", "alpha", "beta", "friction_coefficient", "modulus")
"""The quantities of :class:`LineContact`, in its order."""


@dataclass(frozen=True, init=False)
class LineContact:
    r"""A rigid rough cylinder sliding on a lubricated elastic half-space, in SI units.

    Every quantity is text with a unit (``"10 mm"``) or a bare number in SI units; floats in SI are kept.

    Parameters
    ----------
    radius : str or float
        Radius :math:`R > 0` of the cylinder [m].
    load : str or float
        Normal load per unit length :math:`F_N > 0` [N/m].
    viscosity : str or float
        Viscosity :math:`\eta > 0` of the fluid [Pa s].
    speed : str or float
        Sliding speed :math:`U \ge 0` [m/s].
    roughness : str or float
        Root-mean-square roughness :math:`h_\mathrm{rms} \ge 0` [m].
    alpha : float
        Coefficient :math:`\alpha > 0` of the contact law
        :math:`p_c = \beta E^* \exp(-\alpha h/h_\mathrm{rms})` [-]; about 2 for self-affine surfaces.
    beta : float
        Coefficient :math:`\beta > 0` of the same law [-]; about the wave number of the longest roughness
        times :math:`h_\mathrm{rms}`, so 1e-3 to 1e-1 for real surfaces.
    friction_coefficient : float
        Friction coefficient :math:`\mu_0 \ge 0` of the solid contact [-].
    modulus : str or float, optional
        Effective modulus :math:`E^* = E/(1 - \nu^2) > 0` [Pa]; or give the next two.
    youngs_modulus : str or float, optional
        Young's modulus :math:`E > 0` of the half-space [Pa].
    poisson_ratio : float, optional
        Poisson ratio :math:`0 \le \nu \le 1/2` of the half-space [-].
    law : LawShape, optional
        Contact law :math:`p_c = \beta E^* \Phi(\alpha h/h_\mathrm{rms})`; :math:`\Phi(s) = \exp(-s)` by default.

    Attributes
    ----------
    groups : Groups
        The dimensionless groups.
    hertz : HertzScales
        The scales with which dimensionless results return to SI.
    hersey_number : float
        :math:`\eta U/F_N` [-].

    Raises
    ------
    InputError
        Where a value is impossible, a unit is wrong, or the modulus is given twice or not at all.

    Notes
    -----
    ``modulus`` always holds :math:`E^*` afterwards; ``youngs_modulus`` and ``poisson_ratio`` are not kept.

    Source: [Bertin & Pouliquen] Eq. (contact_pressure) for the contact law, Section "Dimensional analysis"
    for the groups. The paper calls :math:`\beta` a number of order unity; for real surfaces it is small.

    Examples
    --------
    >>> contact = LineContact(radius="10 mm", modulus="2.1 MPa", load="50 N/m", viscosity="1 mPa*s",
    ...                       speed="0.1 m/s", roughness="1 um", alpha=2.0, beta=0.05,
    ...                       friction_coefficient=0.8)
    >>> round(contact.groups.load, 3)
    0.303
    """

    radius: float
    load: float
    viscosity: float
    speed: float
    roughness: float
    alpha: float
    beta: float
    friction_coefficient: float
    modulus: float
    law: LawShape | None

    def __init__(
        self,
        *,
        radius: str | float,
        load: str | float,
        viscosity: str | float,
        speed: str | float,
        roughness: str | float,
        alpha: float,
        beta: float,
        friction_coefficient: float,
        modulus: str | float | None = None,
        youngs_modulus: str | float | None = None,
        poisson_ratio: float | None = None,
        law: LawShape | None = None,
    ) -> None:
        check_modulus_choice(modulus, youngs_modulus, poisson_ratio)
        if modulus is None:
            modulus = quantity("youngs_modulus", youngs_modulus) / (1 - quantity("poisson_ratio", poisson_ratio) ** 2)
        given = {
            "radius": radius,
            "load": load,
            "viscosity": viscosity,
            "speed": speed,
            "roughness": roughness,
            "alpha": alpha,
            "beta": beta,
            "friction_coefficient": friction_coefficient,
            "modulus": modulus,
        }
        for name, value in given.items():
            object.__setattr__(self, name, quantity(name, value))
        object.__setattr__(self, "law", check_law(law))
        self._check_scales()

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
        )

    @property
    def hertz(self) -> HertzScales:
        """The Hertz scales, see :class:`HertzScales`."""
        R, E_star, F_N = self.radius, self.modulus, self.load
        a = math.sqrt(F_N / E_star) * math.sqrt(4 * R / math.pi)
        return HertzScales(half_width=a, indentation=4 * F_N / E_star / math.pi, pressure=2 * F_N / a / math.pi)

    @property
    def hersey_number(self) -> float:
        r"""The Hersey number :math:`\eta U/F_N` [-]."""
        return self.viscosity * self.speed / self.load

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some of the inputs changed.

        Parameters
        ----------
        **changes : str or float
            Arguments of :class:`LineContact`; ``youngs_modulus`` and ``poisson_ratio`` together replace the
            modulus.

        Returns
        -------
        LineContact
            The changed contact.

        Raises
        ------
        InputError
            Where a value is impossible, as in :class:`LineContact`.
        """
        kept: dict[str, Any] = {name: getattr(self, name) for name in self.__dataclass_fields__}
        if "youngs_modulus" in changes or "poisson_ratio" in changes:
            del kept["modulus"]
        return type(self)(**(kept | changes))

    @classmethod
    def from_groups(
        cls,
        groups: Groups,
        *,
        radius: str | float,
        modulus: str | float,
        viscosity: str | float,
        alpha: float,
        beta: float,
        friction_coefficient: float,
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
        alpha, beta, friction_coefficient : float
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
            friction_coefficient=friction_coefficient,
            modulus=E_star,
            law=groups.law,
        )

    def _check_scales(self) -> None:
        """Refuse values, each possible alone, whose groups leave the range of double precision."""
        try:
            _ = self.groups, self.hertz
        except (InputError, ZeroDivisionError):
            values = ", ".join(f"{name} = {getattr(self, name):g}" for name in INPUTS)
            raise InputError(
                f"the dimensionless groups of this contact leave the range of double precision; check {values} (all in SI)."
            ) from None


def quantity(name: str, value: Any) -> float:
    """Return one input of :class:`LineContact` in SI units, checked.

    Parameters
    ----------
    name : str
        One of the keys of :data:`QUANTITIES`.
    value : str or float
        Text with a unit, or a bare number in SI units.

    Returns
    -------
    float
        The value in SI units.

    Raises
    ------
    InputError
        Where the value is impossible or its unit is wrong.
    """
    wanted = QUANTITIES[name]
    result = to_si(value, wanted.dimension, name)
    if wanted.highest < math.inf and not 0 <= result <= wanted.highest:
        raise InputError(f"{name} = {show(value)} must be between 0 and {wanted.highest:g}.")
    if result < 0 or (result == 0 and not wanted.zero):
        allowed = "zero or positive" if wanted.zero else "positive"
        raise InputError(f"{name} = {show(value)} must be {allowed}.")
    return result


def check_law(law: Any) -> LawShape | None:
    """Return a contact law, or None for the exponential one; refuse what has not the methods of one."""
    if law is None or (isinstance(law, LawShape) and not isinstance(law, type)):
        return law
    advice = f"write {law.__name__}()" if isinstance(law, type) else "give an object such as GreenwoodWilliamson(), or None"
    raise InputError(f"law = {show(law)} is no contact law; {advice}.")


def check_modulus_choice(modulus: Any, youngs_modulus: Any, poisson_ratio: Any) -> None:
    """Check that the elasticity is given once: E* alone, or E and nu together.

    Parameters
    ----------
    modulus, youngs_modulus, poisson_ratio : object
        The inputs, None where not given.

    Raises
    ------
    InputError
        Where it is given twice, in part or not at all.
    """
    pair = {"youngs_modulus": youngs_modulus, "poisson_ratio": poisson_ratio}
    given = [f"{name} = {show(value)}" for name, value in pair.items() if value is not None]
    missing = [name for name, value in pair.items() if value is None]
    if modulus is not None and given:
        raise InputError(
            f"modulus = {show(modulus)} (which is E*) and {' and '.join(given)} are given; "
            "give either modulus, or youngs_modulus and poisson_ratio."
        )
    if modulus is None and not given:
        raise InputError("modulus (which is E*) is missing; give it, or youngs_modulus and poisson_ratio together.")
    if modulus is None and missing:
        typical = " The Poisson ratio of rubber and gels is close to 0.5." if missing == ["poisson_ratio"] else ""
        raise InputError(f"{missing[0]} is missing beside {given[0]}; give both, or modulus (which is E*) alone.{typical}")


def _group(name: str, value: Any, positive: bool) -> float | Array:
    if type(value) is float and (0.0 < value < math.inf or (value == 0.0 and not positive)):
        return value + 0.0
    try:
        raw = np.asarray(value)
    except ValueError:  # ragged lists
        raw = np.asarray(None)
    if raw.dtype.kind not in "iuf":
        raise InputError(
            f"{name} = {show(value)} is not a real number; groups are bare numbers or arrays of them, "
            "for values with units use LineContact."
        )
    with np.errstate(over="ignore"):
        # The sum makes a copy, and no negative zero, which would hash apart from zero.
        array = np.asarray(raw, dtype=np.float64) + 0.0
    wrong = ~np.isfinite(array) | (array <= 0 if positive else array < 0)
    if np.any(wrong):
        received = f"= {show(value)}" if array.ndim == 0 else f"has the value {array[wrong].flat[0]:g} and"
        allowed = "positive" if positive else "zero or positive"
        raise InputError(f"{name} {received} must be finite and {allowed}.")
    if array.ndim == 0:
        return float(array)
    array.setflags(write=False)
    return array
