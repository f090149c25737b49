"""The inputs that a fit is free to change: where they start, their bounds and priors, and whether these data can tell them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from stribeck.cases.fit_settings import FitSettings
from stribeck.contacts.contact import Contact
from stribeck.contacts.parts import PART_INPUTS
from stribeck.fits.measurements import Measurements
from stribeck.quantities.formats import format_si
from stribeck.quantities.units import InputError

__all__ = ["FreeInput", "free_inputs"]

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
            raise InputError(f"{name} is free, but no curve has one: it belongs to {_owner(name)}; give it in the case.")
        for owner, curves in _owners(name, data, settings).items():
            own = [value for curve, value in values.items() if curves is None or curve in curves]
            if not own:
                continue
            differ = max(own) > min(own)
            start = 1.0 if differ else own[0]
            if start == 0:
                raise InputError(f"{name} is 0 in the case; a fit looks for factors on it, so give it a first value.")
            each_free = replace(_free_input(name, curves, start, differ, settings, contact), owner=owner)
            if min(own) < 0:
                raise InputError(f"{name} is {min(own):g} in the case; a fit looks for factors on it, so it must be positive.")
            smallest, largest = min(own), max(own)
            if name == "roughness" and settings.scales_surface and "beta" not in names:
                each_free = replace(each_free, also=("beta",))
            found.append(_in_range(each_free, smallest, largest))
    return tuple(found)


def _owners(name: str, data: Measurements, settings: FitSettings) -> dict[str | None, tuple[int, ...] | None]:
    """Return the curves or files that have an input for themselves, with their curves; None has all."""
    labels = data.curves if name in settings.per_curve else data.files if name in settings.per_file else ()
    if len(set(labels)) < 2:
        return {None: None}
    return {label: tuple(i for i, each in enumerate(labels) if each == label) for label in labels}


def _owner(name: str) -> str:
    """Return the part of the contact that has a parameter of this name."""
    return PART_INPUTS[name].of if name in PART_INPUTS else "another contact"


def _in_range(free: FreeInput, smallest: float, largest: float) -> FreeInput:
    """Return a free input whose bounds leave all its values in the range of its law."""
    row = PART_INPUTS.get(free.name)
    if row is None:
        return free
    low, high = row.range
    low = max(free.low, math.log(low / smallest)) if low > 0 else free.low
    return replace(free, low=low, high=min(free.high, math.log(high / largest)))


def _free_input(
    name: str, curves: tuple[int, ...] | None, start: float, is_factor: bool, settings: FitSettings, contact: Contact
) -> FreeInput:
    low, high = -math.log(DEFAULT_FACTOR), math.log(DEFAULT_FACTOR)
    prior = settings.priors.get(name)
    if is_factor and (name in settings.bounds or prior):
        raise InputError(
            f"{name} has bounds or a prior in [fit], but its values differ between the curves and share one factor; "
            f"list {name} under per_curve, or leave bounds and prior out."
        )
    if name in settings.bounds:
        ends = settings.bounds[name]
        if not ends[0] <= start <= ends[1]:
            limits = " to ".join(_text(name, end, contact) for end in ends)
            raise InputError(f"{name} starts at {_text(name, start, contact)}, outside its bounds {limits}.")
        low, high = math.log(ends[0] / start), math.log(ends[1] / start)
    mean_and_width = (math.log(prior.value / start), math.log(prior.factor)) if prior else None
    return FreeInput(name, curves, start, low, high, mean_and_width, is_factor)


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
