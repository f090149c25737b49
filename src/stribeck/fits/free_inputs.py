"""The inputs that a fit is free to change: where they start, their bounds and priors, and whether these data can tell them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from stribeck.cases.fit_settings import FitSettings
from stribeck.contacts.contact import Contact
from stribeck.contacts.parts import PART_INPUTS
from stribeck.fits.measurements import Measurements
from stribeck.quantities.formats import format_si
from stribeck.quantities.units import InputError

DEFAULT_FACTOR = 1e3  # Bounds of a free input without any of its own: this factor below and above its first value


@dataclass(frozen=True)
class FreeInput:
    """An input that is fitted, as the logarithm of a factor on what it starts from."""

    name: str  # Name of the input of the contact
    curves: tuple[int, ...] | None  # The curves that have it for themselves; None where all share it
    start: float  # Value of factor one, in SI units; 1 where curves that share it have different values
    low: float  # Bounds of the logarithm of the factor
    high: float  # Bounds of the logarithm of the factor
    prior: tuple[float, float] | None = None  # Mean and standard deviation of that logarithm before the data
    is_factor: bool = False  # Whether what is fitted is a common factor on values that differ
    also: tuple[str, ...] = ()  # Inputs on which the same factor acts
    owner: str | None = None  # Name of the curve or file that has it for itself

    @property
    def names(self) -> tuple[str, ...]:
        """All inputs on which the factor acts."""
        return (self.name, *self.also)

    def acts_on(self, curve: int) -> bool:
        """Return whether a curve has it."""
        return self.curves is None or curve in self.curves

    def value(self, theta: float) -> float:
        """Return the input in SI units, or the factor, at a logarithm of the factor."""
        return self.start * math.exp(theta)

    def interval(self, low: float, high: float) -> tuple[float, float]:
        """Return an interval of it by those of the logarithm, 0 and infinity where it is open within the bounds."""
        return self.value(low) if low > self.low else 0.0, self.value(high) if high < self.high else math.inf


def free_inputs(contact: Contact, data: Measurements, names: Sequence[str], settings: FitSettings) -> tuple[FreeInput, ...]:
    """Return the inputs to fit, one for each name, or one for each curve or file where the settings say so."""
    found = []
    contacts = [contact.replace(**inputs) for inputs in data.inputs]
    for name in names:
        _check_matters(name, data)
        if name == "alpha" and hasattr(contact.law, "fixed_alpha"):
            raise InputError(f"alpha is free, but this law has only {contact.alpha:g}; free beta or roughness instead.")
        values = {curve: value for curve, each in enumerate(contacts) if (value := getattr(each, name, None)) is not None}
        if not values:
            of = PART_INPUTS[name].of if name in PART_INPUTS else "another contact"
            raise InputError(f"{name} is free, but no curve has one: it belongs to {of}; give it in the case.")
        also = ("beta",) if name == "roughness" and settings.scales_surface and "beta" not in names else ()
        for owner, curves in _owners(name, data, settings).items():
            own = [value for curve, value in values.items() if curves is None or curve in curves]
            if not own:
                continue
            smallest, largest = min(own), max(own)
            differ = largest > smallest
            start = 1.0 if differ else smallest
            if start == 0:
                raise InputError(f"{name} is 0 in the case; a fit looks for factors on it, so give it a first value.")
            low, high = _bounds(name, start, differ, settings, contact)
            if smallest < 0:
                raise InputError(f"{name} is {smallest:g} in the case; a fit looks for factors on it, so it must be positive.")
            low, high = _in_range(name, low, high, smallest, largest)
            given = settings.priors.get(name)
            prior = (math.log(given.value / start), math.log(given.factor)) if given else None
            found.append(FreeInput(name, curves, start, low, high, prior, differ, also, owner))
    return tuple(found)


def _owners(name: str, data: Measurements, settings: FitSettings) -> dict[str | None, tuple[int, ...] | None]:
    """Return the curves or files that have an input for themselves, with their curves; None has all."""
    labels = data.curves if name in settings.per_curve else data.files if name in settings.per_file else ()
    if len(set(labels)) < 2:
        return {None: None}
    return {label: tuple(i for i, each in enumerate(labels) if each == label) for label in labels}


def _in_range(name: str, low: float, high: float, smallest: float, largest: float) -> tuple[float, float]:
    """Return bounds of the logarithm of a factor that leave all values of an input in the range of its law."""
    row = PART_INPUTS.get(name)
    if row is None:
        return low, high
    least, most = row.range
    low = max(low, math.log(least / smallest)) if least > 0 else low
    return low, min(high, math.log(most / largest))


def _bounds(name: str, start: float, is_factor: bool, settings: FitSettings, contact: Contact) -> tuple[float, float]:
    """Return the bounds of the logarithm of a factor, by default far beside its first value."""
    if is_factor and (name in settings.bounds or name in settings.priors):
        raise InputError(
            f"{name} has bounds or a prior in [fit], but its values differ between the curves and share one factor; "
            f"list {name} under per_curve, or leave bounds and prior out."
        )
    if name not in settings.bounds:
        return -math.log(DEFAULT_FACTOR), math.log(DEFAULT_FACTOR)
    ends = settings.bounds[name]
    if not ends[0] <= start <= ends[1]:
        limits = " to ".join(_text(name, end, contact) for end in ends)
        raise InputError(f"{name} starts at {_text(name, start, contact)}, outside its bounds {limits}.")
    return math.log(ends[0] / start), math.log(ends[1] / start)


def _text(name: str, value: float, contact: Contact) -> str:
    return format_si(value, contact.INPUTS.rows[name].dimension)


def _check_matters(name: str, data: Measurements) -> None:
    """Refuse an input on which the predicted friction does not depend, given what friction was measured against."""
    if name == "viscosity" and data.abscissa != "speed":
        against = data.abscissa.replace("_", " times ") if data.abscissa == "speed_viscosity" else "Hersey number"
        raise InputError(
            f"viscosity is free, but friction was measured against {against}, which holds it already: "
            "no value of it changes the prediction. Take it out of free, or give the speeds."
        )
