r"""The three dimensionless groups and the parts of the model that they carry: all that the equations see.

.. math::

    \frac{p_\mathrm{Hz}}{\beta E^*} = \bar F_N^{e}, \qquad \kappa = \frac{h_\mathrm{rms}}{\alpha u}
    = \frac{\bar h_\mathrm{rms}}{\bar F_N^{2e}}, \qquad \frac{a}{R} = c \, \beta \bar F_N^{e}
    = \left(\frac{k F_N}{R^r E^*}\right)^{e}

with r = 1, e = 1/2, c = 2 and k = 4/pi on the line, and r = 2, e = 1/3, c = pi/2 and k = 3/4 on the ball.
"""

import math
from dataclasses import dataclass, field
from typing import Any, Literal, TypedDict, cast

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.exponential import ExponentialLaw, NoContact
from stribeck.contact_laws.law import AsperityLaw, ContactLaw, is_exponential
from stribeck.contact_laws.scaled import ScaledLaw, law_of
from stribeck.fluids.fluid import Cavitation, Film
from stribeck.fluids.newtonian import Newtonian
from stribeck.profiles.profile import Undeformed
from stribeck.quantities.schema import Input
from stribeck.quantities.units import InputError, checked_word, real_array, show
from stribeck.solids.half_plane import HalfPlane, as_solid
from stribeck.solids.solid import Solid


@dataclass(frozen=True)
class Model:
    """Film, cavitation, bodies and their shape, by default of the article."""

    film: Film = Newtonian()  # The fluid, in Hertz units
    cavitation: Cavitation = Cavitation.NONE  # How the film ends behind the contact
    solid: Solid = HalfPlane()  # The soft body, in Hertz units
    cavity_pressure: float = 0.0  # Rupture pressure of a film that reforms, above the ambient one, at most zero [p_Hz]
    profile: Undeformed = Undeformed()  # The undeformed gap, in Hertz units

    def __post_init__(self) -> None:
        """Refuse films and cavitation of other types, and bodies that contradict themselves."""
        if not type(self.film).__module__.startswith("stribeck."):
            raise InputError(
                f"film = {show(self.film)}; films are those of the package. A fluid of your own is a law of shear, viscosity "
                "or density, given as fluid = ... to a contact or to solve: see Add a fluid in for_developers.md."
            )
        checked_word("cavitation", self.cavitation, Cavitation)
        as_solid("solid", self.solid)
        if self.cavitation is Cavitation.REFORM and not self.profile.is_parabola:
            raise InputError(
                f"cavitation = 'reform' with profile = {self.profile.name}: a film that re-forms is solved on a cylinder "
                "alone; take cavitation = 'exit', whose film ends behind the contact, or 'none'."
            )


BASE_MODEL = Model()  # A Newtonian fluid that never cavitates, on a half-plane


MIN_GROUP = 1e-300  # Smallest group that is not zero: products and squares of the groups stay in double precision
MAX_GROUP = 1e300  # Largest group: products and squares of the groups stay in double precision

# Relative excess of a group over its bound that rounding explains: the exponential of its logarithm has some
BOUND_RTOL = 1e-9

Geometry = Literal["line", "point"]  # A cylinder or a ball


@dataclass(frozen=True)
class Scaling:
    """How the groups of one geometry scale."""

    name: Geometry  # Name of the geometry
    body: str  # What it is of
    dimensions: int  # r, directions in which the contact is small
    slope_factor: float  # c
    hertz_factor: float  # k
    hertz_pressure: float  # Largest Hertz pressure over the mean one
    hersey_power: int  # Power of a/R in the Hersey number over the speed group
    hersey_divisor: float  # Divisor of the Hersey number
    pressure_exponent: float = field(init=False)  # e
    roughness_exponent: float = field(init=False)  # 2e

    def __post_init__(self) -> None:
        """Set the exponents, which every group asks for."""
        object.__setattr__(self, "pressure_exponent", 1 / (1 + self.dimensions))
        object.__setattr__(self, "roughness_exponent", 2 / (1 + self.dimensions))

    @property
    def exponents(self) -> dict[str, tuple[float, float, float]]:
        """Exponents with which inputs of a contact enter the groups of speed, load and roughness."""
        r, shift = self.dimensions, self.pressure_exponent * self.hersey_power
        return {
            "radius": (r - 1 + r * shift, -r, -1),
            "modulus": (shift, -1, 0),
            "load": (-1 - shift, 1, 0),
            "viscosity": (1, 0, 0),
            "speed": (1, 0, 0),
            "roughness": (0, 0, 1),
            "alpha": (0, 0, -1),
            "beta": (0, -1 - r, -2),
        }


# The geometries by name: a cylinder, whose load is per unit length, and a ball.
SCALINGS: dict[Geometry, Scaling] = {
    "line": Scaling("line", "cylinder", 1, 2.0, 4 / math.pi, 4 / math.pi, 2, 3 * math.pi),
    "point": Scaling("point", "ball", 2, 0.5 * math.pi, 0.75, 1.5, 1, 4 * math.pi),
}

BETA = Input(
    name="beta",
    label="contact-law beta",
    symbol=r"$\beta$",
    dimension="number",
    typical="0.06",
    source="about 1.4 q0 h_rms by Persson's theory: 1 um and 150 um for the longest wave",
    usual=(1e-3, 2.0),
    follows_surface=True,
    known=2,
    typical_error=0.3,
)


# The groups as inputs: bare numbers, each with the range of its slider.
GROUP_INPUTS = {
    name: Input(name=name, label=f"{name} group", symbol=symbol, dimension="number", typical="1.0", usual=usual, zero=zero)
    for name, symbol, usual, zero in (
        ("speed", "λ", (1e-12, 1e4), True),
        ("load", "F", (1e-6, 1e4), False),
        ("roughness", "h\u0304_rms", (1e-9, 1e3), True),
    )
}


class Physics(TypedDict):
    """All of :class:`Groups` but the numbers: what states of one curve, sweep or diagram have in common."""

    law: AsperityLaw | None
    geometry: Geometry
    model: Model


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
        :math:`\lambda \ge 0` [-], :math:`U` being the sum of the surface speeds, twice their mean; zero is the contact
        at rest, else 1e-300 to 1e300.
    load : float or array_like
        :math:`\bar F_N > 0` [-]; 1e-300 to 1e300.  From one on, the exponential contact law is outside its range.
    roughness : float or array_like
        :math:`\bar h_\mathrm{rms} \ge 0` [-]; zero is the smooth contact, else 1e-300 to 1e300, as its ratio to the load.
    law : AsperityLaw, optional
        Contact law :math:`\Phi`, the pressure over :math:`\beta E^*` at the separation :math:`\alpha h/h_\mathrm{rms}`; the
        exponential law of the paper by default.
    geometry : {"line", "point"}
        A cylinder, for which the definitions above hold, or a ball, for which

        .. math::

            \lambda = \frac{3 \pi \eta U R^3}{E^* a^4}, \quad \bar F_N = \frac{6 F_N}{\pi^3 \beta^3 R^2 E^*}, \quad
            \bar h_\mathrm{rms} = \frac{4 h_\mathrm{rms}}{\pi^2 \alpha \beta^2 R}, \qquad
            a = \left(\frac{3 F_N R}{4 E^*}\right)^{1/3}
    model : Model
        Fluid, cavitation, solid and motion, in Hertz units; those of the article by default.

    Raises
    ------
    InputError
        Where a group or the relative roughness is no real number, not finite or out of range, or the three shapes do not
        broadcast, or the law is none.

    Notes
    -----
    Arrays are kept as read-only float64 copies, each in its own shape. Friction needs the coefficient
    :math:`\beta` of the contact law too, see :meth:`hersey_number` and :meth:`slope`.

    Source: [Bertin & Pouliquen] Section "Dimensional analysis".
    """

    speed: float | Array
    load: float | Array
    roughness: float | Array
    law: AsperityLaw | None = field(default=None, kw_only=True)
    geometry: Geometry = field(default="line", kw_only=True)
    model: Model = field(default=BASE_MODEL, kw_only=True)

    def __post_init__(self) -> None:
        """Check the groups and make them floats or read-only arrays."""
        if self.law is not None:
            object.__setattr__(self, "law", law_of(self.law))
        if not (isinstance(self.geometry, str) and self.geometry in SCALINGS):
            check_geometry(self.geometry)
        if not isinstance(self.model, Model):
            raise InputError(f"model = {show(self.model)}; it must be a stribeck.contacts.groups.Model.")
        if self.geometry != "line" and not self.model.profile.is_parabola:
            raise InputError(f"profile = {self.model.profile.name}: profiles are those of a line contact; a ball is round.")
        for name, positive in (("speed", False), ("load", True), ("roughness", False)):
            object.__setattr__(self, name, _group(name, getattr(self, name), positive))
        try:
            _ = self.shape
        except ValueError:
            shapes = ", ".join(f"{name} {np.shape(getattr(self, name))}" for name in ("speed", "load", "roughness"))
            raise InputError(f"the shapes of the groups do not broadcast: {shapes}.") from None
        relative = self.relative_roughness
        if not isinstance(relative, float) or not (self.roughness == 0.0 or MIN_GROUP <= relative <= MAX_GROUP):
            ratio = np.atleast_1d(np.where(np.equal(self.roughness, 0), 0.0, relative))  # of a smooth surface it may be lost
            _refuse_out_of_range("the relative roughness", ratio, ratio)

    @property
    def scaling(self) -> Scaling:
        """How the groups of this geometry scale."""
        return SCALINGS[self.geometry]

    @property
    def physics(self) -> Physics:
        """Law, geometry and model, as keywords of other groups that share them."""
        return {"law": self.law, "geometry": self.geometry, "model": self.model}

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the three groups broadcast together; ``()`` for one state."""
        if isinstance(self.speed, float) and isinstance(self.load, float) and isinstance(self.roughness, float):
            return ()
        return np.broadcast_shapes(np.shape(self.speed), np.shape(self.load), np.shape(self.roughness))

    @property
    def is_hertzian(self) -> bool:
        """Whether all states are dry and smooth, speed and roughness zero: the contact of Hertz, in closed form."""
        return not (np.any(self.speed) or np.any(self.roughness))

    @property
    def relative_roughness(self) -> float | Array:
        r"""Roughness over Hertz indentation [-], :math:`\kappa = h_\mathrm{rms}/\alpha u_\mathrm{Hz}`.

        :math:`\bar h_\mathrm{rms}/\bar F_N` on the line, :math:`\bar h_\mathrm{rms}/\bar F_N^{2/3}` on the ball.
        """
        with np.errstate(all="ignore"):
            return self.roughness / self.load**self.scaling.roughness_exponent

    @property
    def pressure_scale(self) -> float | Array:
        r"""The largest Hertz pressure over that of the contact law [-], :math:`p_\mathrm{Hz}/\beta E^*`."""
        return self.load**self.scaling.pressure_exponent

    def hersey_number(self, beta: float = 1.0) -> float | Array:
        r"""Return the Hersey number.

        .. math::

            \frac{\eta U}{F_N} = \frac{4 \beta^2 \bar F_N \lambda}{3 \pi} \text{ on the line}, \qquad
            \frac{\eta U R}{F_N} = \frac{\lambda}{4 \pi} \frac{a}{R} \text{ on the ball}

        Parameters
        ----------
        beta : float
            Coefficient :math:`\beta` of the contact law [-].

        Returns
        -------
        float or ndarray
            Hersey number [-], of the broadcast shape; U is the sum of the surface speeds, as in :class:`stribeck.LineContact`.

        Raises
        ------
        InputError
            Where ``beta`` is not a positive number.
        """
        with np.errstate(all="ignore"):
            return self.speed * self.slope(beta) ** self.scaling.hersey_power / self.scaling.hersey_divisor

    def slope(self, beta: float = 1.0) -> float | Array:
        r"""Return the slope of the cylinder or ball at the edge of the Hertz contact.

        .. math::

            \frac{a}{R} = 2 \beta \bar F_N^{1/2} \text{ on the line}, \qquad
            \frac{a}{R} = \frac{\pi}{2} \beta \bar F_N^{1/3} \text{ on the ball}

        Parameters
        ----------
        beta : float
            Coefficient :math:`\beta` of the contact law [-].

        Returns
        -------
        float or ndarray
            Half-width of the Hertz contact, or its radius, over the radius of curvature [-], of the shape of ``load``.

        Raises
        ------
        InputError
            Where ``beta`` is not a positive number.
        """
        return self.scaling.slope_factor * BETA.checked(beta) * self.pressure_scale

    def __eq__(self, other: object) -> bool:
        """Return whether the groups have the same shapes and values."""
        if not isinstance(other, Groups):
            return NotImplemented
        names = ("speed", "load", "roughness")
        same = all(np.array_equal(getattr(self, name), getattr(other, name)) for name in names)
        return same and self.physics == other.physics

    def __hash__(self) -> int:
        """Hash by value."""
        values = (np.asarray(value) for value in (self.speed, self.load, self.roughness))
        return hash((*((value.shape, value.tobytes()) for value in values), *self.physics.values()))

    def __repr__(self) -> str:
        """Return the groups, and law, geometry and model if they are not those of the article."""
        own = {"law": None, "geometry": "line", "model": BASE_MODEL}
        others = "".join(f", {name}={value!r}" for name, value in self.physics.items() if value != own[name])
        return f"Groups(speed={self.speed!r}, load={self.load!r}, roughness={self.roughness!r}{others})"


def _group(name: str, value: Any, positive: bool) -> float | Array:
    if type(value) is float and (MIN_GROUP <= value <= MAX_GROUP or (value == 0.0 and not positive)):
        return value + 0.0
    array = real_array(name, value) + 0.0  # no negative zero, which would hash apart from zero
    wrong = ~np.isfinite(array) | (array <= 0 if positive else array < 0)
    _refuse(name, value, wrong, f"finite and {'' if positive else 'zero or '}positive")
    _refuse_out_of_range(name, value, array, "" if positive else "zero or ")
    if array.ndim == 0:
        return float(array)
    array.setflags(write=False)
    return array


def _refuse_out_of_range(name: str, value: Any, array: Array, zero: str = "zero or ") -> None:
    wrong = (array != 0) & ((array < MIN_GROUP * (1 - BOUND_RTOL)) | (array > MAX_GROUP * (1 + BOUND_RTOL)))
    _refuse(name, value, wrong, f"{zero}from {MIN_GROUP:g} to {MAX_GROUP:g}; check the units of the inputs")


def _refuse(name: str, value: Any, wrong: Any, allowed: str) -> None:
    """Refuse the first of the values that are wrong."""
    if np.any(wrong):
        received = f"= {show(value)}" if np.ndim(wrong) == 0 else f"has the value {np.asarray(value)[wrong].flat[0]:g} and"
        raise InputError(f"{name} {received} must be {allowed}.")


def contact_law(groups: Groups) -> ContactLaw:
    """Return the contact law of a state, or of stacked states from groups that are columns."""
    # None or all of stacked states are smooth.
    if not np.any(groups.roughness):
        return NoContact()
    if groups.law is None or is_exponential(groups.law):
        return ExponentialLaw(groups.load, groups.relative_roughness, groups.scaling.pressure_exponent)
    return ScaledLaw(groups.law, groups.load, groups.relative_roughness, groups.scaling.pressure_exponent)


def check_geometry(geometry: Any) -> Geometry:
    """Return the name of a geometry; refuse what is none."""
    return cast(Geometry, checked_word("geometry", geometry, SCALINGS, ": a cylinder or a ball"))
