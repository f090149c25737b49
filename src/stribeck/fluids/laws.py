"""What a film is put together from: laws of viscosity, density, shear rate and flow between rough surfaces.

Each is a frozen class whose numbers are in SI units, and in a film in Hertz units: :meth:`Law.scaled` goes from the first to
the second.  A new law is one class with the members of its protocol.  Its functions are written with those of numpy, so that
they take values, and values with their derivatives (:mod:`stribeck.numerics.dual`): slopes follow.  A law that
somebody else wrote is checked: its derivatives, limits and scaling must agree with its values.
"""

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, Protocol, Self, runtime_checkable

import numpy as np

from stribeck._types import Array
from stribeck.fluids.rheology.tabulated import table_of
from stribeck.numerics.dual import with_slope
from stribeck.quantities.registry import check_user_part, refusal
from stribeck.quantities.schema import numbers_of

AGREEMENT_RTOL = 1e-5  # Largest relative difference of a law from its own differences, which err a thousand times less.

DIFFERENCE_STEP = 1e-4  # Relative step of the central differences.

CHECKED_RATES = np.geomspace(1e-3, 1e4, 36)  # Shear rates times the relaxation time at which a law is checked.

CHECKED_UNITS = (0.1, 10.0)  # Units of time, pressure and length to which a law is scaled in the check.

# Pressures or gaps [SI or Hertz units] searched for the first one that changes a law.
SEARCHED_SIZES = np.geomspace(1e-12, 1e12, 241)

DECAY_LENGTHS = (1e-12, 1.0)  # Decay lengths of the roughness [m]: far below a length of the law's own, and the only length.


class FilmUnits(NamedTuple):
    r"""What the numbers of a law are divided by to be in Hertz units."""

    pressure: float  # `p_\mathrm{Hz}` [Pa]
    time: float
    gap: float  # `u_\mathrm{Hz}` [m]
    viscosity: float  # `\eta_0`, the viscosity at ambient pressure and low rate [Pa s]
    decay_length: float = 0.0  # `h_\mathrm{rms}/\alpha`, which the roughness is where `\alpha = 1` [m]
    alpha: float | None = None  # `\alpha` of the contact; None where a law must know it itself

    @property
    def stress(self) -> float:
        r"""Unit of shear stresses, :math:`p_\mathrm{Hz} u_\mathrm{Hz}/(6 a)` [Pa]."""
        return self.viscosity / self.time


HERTZ_UNITS = FilmUnits(1.0, 1.0, 1.0, 1.0)  # Units of laws that are in Hertz units already.


class Law(Protocol):
    """What all laws have: a name, parameters, and their form in Hertz units."""

    @property
    def name(self) -> str:
        """Name that outputs print and case files have; empty for what does nothing."""
        return ""

    @property
    def parameters(self) -> dict[str, float | str]:
        """What distinguishes this law from others of its name, for outputs: its numbers."""
        return {name: getattr(self, name) for name in numbers_of(type(self))}

    @abstractmethod
    def scaled(self, units: FilmUnits) -> Self:
        """Return the law in Hertz units; a law without numbers that have a unit returns itself."""

    def notes(self, gap: Array, pressure: Array | None) -> tuple[str, ...]:
        """Return sentences on where a state leaves the range of the law, in Hertz units; mostly none."""
        return ()


@runtime_checkable
class ViscosityLaw(Law, Protocol):
    """Viscosity as a function of pressure."""

    @abstractmethod
    def log(self, pressure: Any) -> Any:
        """Return ln(eta/eta0)."""


@runtime_checkable
class DensityLaw(Law, Protocol):
    """Density as a function of pressure."""

    @abstractmethod
    def ratio(self, pressure: Any) -> Any:
        """Return rho/rho0."""


@runtime_checkable
class FlowFactors(Law, Protocol):
    """What roughness does to the flow, as a function of the mean gap."""

    @abstractmethod
    def pressure(self, gap: Any) -> Any:
        """Return the flow under a pressure gradient over that between smooth surfaces, phi_x > 0."""

    @abstractmethod
    def shear(self, gap: Any) -> Any:
        """Return what sliding carries along in valleys, sigma phi_s [u_Hz]."""

    def jump(self, gap: Array, slide: float) -> Array | None:
        """Return by how much ``h + s S``, over phi_x, jumps between each node and the next one, zero mostly; None if never."""
        return None

    def friction(self, gap: Any) -> tuple[Any, Any, Any] | None:
        """Return the factors phi_f, phi_fs and phi_fp of the drag; None where it is that between smooth walls."""
        return None

    @property
    def closed_at(self) -> float | None:
        """Mean gap at which the last path of the flow closes and phi_x turns sharply; None if there is no such gap."""
        return None


@dataclass(frozen=True)
class Smooth(FlowFactors):
    """The flow between smooth surfaces, which a gap many times the roughness is too."""

    def scaled(self, units: FilmUnits) -> Self:
        """Return itself: it has no numbers."""
        return self

    def pressure(self, gap: Any) -> Any:
        """Return one."""
        return np.ones_like(gap)

    def shear(self, gap: Any) -> Any:
        """Return zero."""
        return np.zeros_like(gap)


class Profile(NamedTuple):
    """The flow across the film at many nodes: rates x, stresses g and slopes dg/dx at the walls a and b, and A, B, C."""

    x_a: Array
    x_b: Array
    g_a: Array
    g_b: Array
    slope_a: Array
    slope_b: Array
    by_mean: Array
    mixed: Array
    by_slope: Array

    def change(self, r_0: Array | float, r_1: Array | float) -> tuple[Array, Array]:
        """Return the changes of T and Q for those of both integrals."""
        determinant = self.by_mean * self.by_slope - self.mixed**2
        return (self.by_slope * r_0 - self.mixed * r_1) / determinant, (self.by_mean * r_1 - self.mixed * r_0) / determinant


@runtime_checkable
class RateLaw(Law, Protocol):
    """Shear stress as a function of the shear rate, rising; moments and rate come from a table of it.

    In its methods rates x are times the relaxation time and stresses g times that time over the viscosity; both are >= 0.
    """

    # Natural logarithm of the rate at which the table ends: above it the ratios of the moments have their limits.
    max_log_rate: ClassVar[float] = 30.0

    @property
    @abstractmethod
    def time(self) -> float:
        """One over the rate at which thinning begins."""

    @property
    def plateau(self) -> float:
        """Rate x below which the viscosity is constant up to even powers of it; zero where there is no such rate."""
        return 1.0

    @property
    @abstractmethod
    def shape(self) -> tuple[float, ...]:
        """Its numbers but for the relaxation time, which is the first argument, in the order of its arguments."""

    @abstractmethod
    def smallest(self) -> float:
        """Return the logarithm of the rate below which the law is Newtonian to rounding."""

    @abstractmethod
    def stress(self, rate: Any) -> Any:
        """Return g(x)."""

    def rate(self, stress: Array) -> Array:
        """Return x(g)."""
        return table_of(type(self), *self.shape).rate(stress)

    def moments(self, rate: Array, stress: Array) -> tuple[Array, Array]:
        r"""Return :math:`\int x \, dg` and :math:`\int g x \, dg` from zero to x, where the stress is g."""
        return table_of(type(self), *self.shape).moments(rate, stress)


def joined_names(base: str, *laws: Law) -> str:
    """Return the name of a film: its own and those of its laws that have one."""
    return " + ".join([base, *(law.name for law in laws if law.name)])


def joined_parameters(*laws: Law) -> dict[str, float | str]:
    """Return the parameters of the laws of a film."""
    return {name: value for law in laws for name, value in law.parameters.items()}


def notes_of(*laws: Law, gap: Array, pressure: Array | None) -> tuple[str, ...]:
    """Return the notes of the laws of a film."""
    return tuple(note for law in laws for note in law.notes(gap, pressure))


def check_law(law: Any) -> None:
    """Refuse a law of somebody else's whose members contradict each other."""
    check_user_part("law", law, _check_members)


def _check_members(law: Any) -> None:
    for kind, check in CHECKS.items():
        if isinstance(law, kind):
            check(law)


def _rate_law(law: RateLaw) -> None:
    g, slope = _with_slope(law, "stress", CHECKED_RATES)
    if not (np.diff(g) > 0).all():
        raise refusal("law", law, "the stress must rise with the rate; here it does not.")
    _agree(law, "stress", "its slope", slope, _difference(law.stress, CHECKED_RATES))
    if law.plateau >= CHECKED_RATES[0]:
        low = np.array([1e-3 * law.plateau])
        _agree(law, "stress", "at low rates the rate, as the viscosity there is that of the contact", law.stress(low), low)
    _agree(law, "rate", "the inverse of stress", law.rate(g), CHECKED_RATES)
    for order, what in ((0, "the integral of x dg"), (1, "the integral of g x dg")):
        change = _difference(lambda x, k=order: law.moments(x, law.stress(x))[k], CHECKED_RATES)  # type: ignore[misc]
        _agree(law, "moments", what, change, CHECKED_RATES * slope * g**order)
    for unit in CHECKED_UNITS:
        scaled = law.scaled(FilmUnits(1.0, unit, 1.0, 1.0))
        _agree(law, "scaled", "in units of time: time over the unit", np.array(scaled.time), np.array(law.time / unit))
        _agree(law, "scaled", "the same stress of a rate times the time", scaled.stress(CHECKED_RATES), g)


def _pressure_law(law: Any, member: str, rest: float) -> None:
    def values(each: Any, pressure: Array) -> tuple[Array, Array]:
        return _with_slope(each, member, pressure)

    at_rest, [first] = values(law, np.zeros(1))
    _agree(law, member, f"{rest:g} at ambient pressure", at_rest + 1.0, np.array([rest + 1.0]))
    flat = first == 0 or not np.isfinite(first)
    scale = _first_change(lambda p: values(law, p)[0] - rest, SEARCHED_SIZES) if flat else 1.0 / abs(float(first))
    pressures = scale * np.linspace(0.05, 0.8, 6)
    found, slope = values(law, pressures)
    _agree(law, member, "its slope", slope * scale, _difference(lambda p: values(law, p)[0], pressures) * scale, 1.0)
    for unit in CHECKED_UNITS:
        other, steeper = values(law.scaled(FilmUnits(unit * scale, 1.0, 1.0, 1.0)), pressures / (unit * scale))
        _agree(law, "scaled", "in units of pressure the same values", other, found, 1.0)
        _agree(law, "scaled", "in units of pressure the same slopes", steeper / unit, slope * scale, 1.0)


def _flow_factors(law: FlowFactors) -> None:
    for decay_length in DECAY_LENGTHS:
        first, *others = (law.scaled(FilmUnits(1.0, 1.0, unit, 1.0, decay_length, 1.0)) for unit in (1.0, *CHECKED_UNITS))
        first_gap = _first_change(lambda h, of=first: of.pressure(h) - 1, SEARCHED_SIZES[::-1])  # type: ignore[misc]
        gaps = np.geomspace(1.0, 30.0, 8) * first_gap
        of_first = {member: _with_slope(first, member, gaps) for member in ("pressure", "shear")}
        for unit, scaled in zip(CHECKED_UNITS, others, strict=True):
            for member, (value, _) in of_first.items():
                found, slope = _with_slope(scaled, member, gaps / unit)
                change = _difference(getattr(scaled, member), gaps / unit)
                size = 1.0 if member == "pressure" else unit
                largest = float(np.abs(value).max())
                _agree(law, member, "its slope", slope * size * gaps / unit, change * size * gaps / unit, largest)
                _agree(law, "scaled", f"in units of length the same {member}", found * size, value, largest)


# Check of each kind of law.
CHECKS: dict[type, Callable[[Any], None]] = {
    RateLaw: _rate_law,
    ViscosityLaw: lambda law: _pressure_law(law, "log", 0.0),
    DensityLaw: lambda law: _pressure_law(law, "ratio", 1.0),
    FlowFactors: _flow_factors,
}


def _with_slope(law: Any, member: str, at: Array) -> tuple[Array, Array]:
    """Return values and slopes of a member; raise InputError unless it gives a value at each place, with its derivative."""
    function = getattr(law, member)
    found = function(at)
    if not isinstance(found, np.ndarray) or found.shape != at.shape:
        raise refusal("law", law, f"{member} must return an array, its value at each of those that it is given.")
    try:
        return with_slope(function, at)
    except TypeError as error:
        raise refusal(
            "law",
            law,
            f"{member} must be written with functions of numpy that have a derivative, such as exp, log, power, maximum and "
            f"where, or give it by stribeck.numerics.trace.pointwise; it fails: {error}.",
        ) from error


def _first_change(change: Callable[[Array], Array], sizes: Array) -> float:
    """Return the first size at which a law does something; 1 if it never does."""
    done = np.abs(change(sizes)) > 0.1
    return float(sizes[np.argmax(done)]) if done.any() else 1.0


def _difference(function: Callable[[Array], Array], at: Array) -> Array:
    """Return the derivative of a function by central differences of two steps, extrapolated."""
    coarse, fine = (
        (function(at * (1 + step)) - function(at * (1 - step))) / (2 * step * at)
        for step in (DIFFERENCE_STEP, 0.5 * DIFFERENCE_STEP)
    )
    return np.asarray((4 * fine - coarse) / 3)


def _agree(law: Law, member: str, what: str, found: Array, right: Array, floor: float = 0.0) -> None:
    """Refuse a member whose values are not right."""
    found, right = np.broadcast_arrays(np.asarray(found, dtype=float), np.asarray(right, dtype=float))
    wrong = ~(np.abs(found - right) <= AGREEMENT_RTOL * np.maximum(np.abs(right), floor))
    if wrong.any():
        i = int(np.argmax(wrong))
        raise refusal(
            "law", law, f"{member} does not agree with {what}: {found.flat[i]:.6g} where it must be {right.flat[i]:.6g}."
        )
