r"""The protocols of a contact law: dimensionless, and scaled to a load and a roughness."""

import math
from collections.abc import Callable
from contextlib import suppress
from typing import Any, Protocol, runtime_checkable
from weakref import WeakValueDictionary

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.contact_laws.exponential import SpectralExponential
from stribeck.numerics.dual import with_slope
from stribeck.quantities.schema import numbers_of
from stribeck.quantities.units import InputError, show


@runtime_checkable
class AsperityLaw(Protocol):
    r"""A contact law without dimensions: a small frozen object that can be hashed.

    .. math:: p_c = \beta E^* \Phi(s), \qquad s = \alpha h/h_\mathrm{rms}
    """

    @property
    def name(self) -> str:
        """Name that outputs print."""

    @property
    def parameters(self) -> dict[str, float | str]:
        """Parameters that distinguish this law from others of its name, for outputs: its numbers."""
        return {name: getattr(self, name) for name in numbers_of(type(self))}

    @property
    def lowest(self) -> float:
        """Separation s below which the law has no value: 0 where it diverges towards full contact, else minus infinity."""
        return -math.inf

    def log_pressure(self, separation: Any) -> Any:
        """Return ln(Phi) at the separation s, falling and finite where Phi itself underflows.

        It is written with functions of numpy, so that its derivative follows.
        """

    def notes(self, separation: float) -> tuple[str, ...]:
        """Return notes on a state with this minimum separation, one sentence each."""
        return ()


@runtime_checkable
class WithArea(AsperityLaw, Protocol):
    """What a law adds that knows the spectrum of its surface."""

    def area_fraction_at(self, pressure: Array) -> Array:
        """Return the real area of contact over the apparent one at the pressure Phi."""


SMALL_PRESSURE = 1e-9  # Contact pressure over beta E* at which the real area is proportional to it


def area_slope(law: WithArea) -> float:
    """Return the real area of contact over the apparent one per pressure Phi where that is small."""
    return float(law.area_fraction_at(np.array([SMALL_PRESSURE]))[0]) / SMALL_PRESSURE


class ContactLaw(Protocol):
    """A contact law as the equations use it."""

    @property
    def name(self) -> str:
        """Name that outputs print."""

    @property
    def decay_length(self) -> Numbers:
        """The unit of separations, kappa [u_Hz]; 0 where there is no contact."""

    @property
    def constant_decay(self) -> bool:
        """Whether the pressure falls by a factor e over the same length at all gaps."""

    def pressure(self, gap: Any) -> Any:
        """Return the contact pressure [p_Hz] at the gap [u_Hz]."""

    def log_pressure(self, gap: Any) -> Any:
        """Return the logarithm of the contact pressure over p_Hz, finite where the pressure itself underflows."""


def local_decay_length(law: ContactLaw, gap: Array) -> Numbers:
    """Return the length over which the pressure falls by a factor e, by its slope at the gap [u_Hz]."""
    if law.constant_decay:
        return law.decay_length
    with np.errstate(divide="ignore"):
        return np.asarray(-1 / with_slope(law.log_pressure, gap)[1])


def is_exponential(law: AsperityLaw | None) -> bool:
    """Return whether a law is the exponential one of the article, whatever a law of a user is called."""
    return law is None or isinstance(law, SpectralExponential)


def largest_load(law: AsperityLaw | None) -> float:
    """Return the load group from which asperities cannot carry the load at a positive gap; infinite if there is none."""
    return 1.0 if is_exponential(law) else math.inf


def own_inputs(law: Any) -> dict[str, float]:
    """Return the alpha of a law, or of a class of laws, that has one of its own."""
    return {"alpha": law.fixed_alpha} if hasattr(law, "fixed_alpha") else {}


def check_alpha(law: AsperityLaw | None, alpha: float) -> None:
    """Refuse the alpha of another law where a law has one of its own."""
    fixed = getattr(law, "fixed_alpha", alpha)
    if law is None or math.isclose(alpha, fixed, rel_tol=1e-9):
        return
    formula = getattr(law, "beta_formula", "")
    raise InputError(
        f"alpha = {alpha:g} is of another contact law: under {law.name} it is {fixed:g}, roughness is the standard deviation "
        f"of the summit heights, and beta is {formula}. Give density, radius and deviation of the summits, in a table "
        f"[asperities] or to sb.{type(law).__name__}.coefficients(...), or alpha = {fixed:g} with the beta of this law."
    )


SLOPE_RTOL = 1e-5  # Largest relative difference between the slope of a user's law and differences of its values.

CHECKED_RANGE = (1e-3, 100.0)  # Separations between which a user's law is checked.


def check_falls(log_pressure: Callable[[Any], Any], low: float, high: float) -> None:
    """Refuse a function that is not ln(Phi), falling, with a derivative that its differences agree with."""
    s = np.geomspace(low, high, 400)
    values = _values("log_pressure", log_pressure, s)
    try:
        slopes = with_slope(log_pressure, s)[1]
    except TypeError as error:
        raise InputError(
            "log_pressure must be written with functions of numpy that have a derivative, such as exp, log, power, maximum "
            f"and where; or give FunctionLaw its derivative too, log_slope. It fails: {error}."
        ) from error
    _refuse("the slope of log_pressure", slopes, ~(slopes < 0), s, "it must be negative everywhere, as the pressure falls")
    step = 1e-5 * s
    ahead, behind = (_values("log_pressure", log_pressure, s + sign * step) for sign in (1, -1))
    wrong = np.abs((ahead - behind) / (2 * step) - slopes) > SLOPE_RTOL * np.abs(slopes) + 1e-10 * np.abs(values) / step
    _refuse("the slope of log_pressure", slopes, wrong, s, "finite differences of log_pressure disagree")


def _values(name: str, function: Callable[[Array], Array], s: Array) -> Array:
    with np.errstate(all="ignore"):
        found = function(s)
    try:
        values = np.asarray(found, dtype=float)
    except (TypeError, ValueError):
        values = np.empty(0)
    if values.shape != s.shape:
        raise InputError(f"{name} must return a number for each separation of an array; it returned {show(found)}.")
    _refuse(name, values, ~np.isfinite(values), s, "it must be finite")
    return values


def _refuse(name: str, values: Array, wrong: Any, s: Array, what: str) -> None:
    if wrong.any():
        i = int(np.argmax(wrong))
        raise InputError(f"{name} is {values[i]:.6g} at separation {s[i]:.6g}; {what}.")


# Laws that passed the check: the law of a curve is one object at all its states.
_ACCEPTED: WeakValueDictionary[int, Any] = WeakValueDictionary()


def as_asperity_law(law: Any) -> AsperityLaw | None:
    """Return a contact law, or None for the exponential one; refuse objects without its methods."""
    if law is None or _ACCEPTED.get(id(law)) is law:
        return law
    if isinstance(law, AsperityLaw) and not isinstance(law, type):
        if not type(law).__module__.startswith("stribeck."):
            check_falls(law.log_pressure, *CHECKED_RANGE)
        with suppress(TypeError):  # what allows no weak reference is looked at again
            _ACCEPTED[id(law)] = law
        return law
    advice = f"write {law.__name__}()" if isinstance(law, type) else "give an object such as GreenwoodWilliamson(), or None"
    raise InputError(f"law = {show(law)} is not a contact law; {advice}.")


def law_attributes(law: AsperityLaw | None, smooth: bool = False) -> dict[str, Any]:
    """Return name and parameters of a contact law as attributes of a dataset."""
    if smooth or law is None:
        return {"contact_law": "smooth" if smooth else "exponential"}
    return {"contact_law": law.name} | {f"contact_law_{name}": value for name, value in law.parameters.items()}
