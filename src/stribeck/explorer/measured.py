"""Measured curves to draw over the model: read as fits read them, as friction against speed."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from stribeck._types import Array
from stribeck.cases.fit_settings import FitSettings
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction_rules import RULES
from stribeck.explorer.curves import hersey_scale
from stribeck.explorer.inputs.inputs import Abscissa, Inputs
from stribeck.fits.fit import fit
from stribeck.fits.measurements import Measurements
from stribeck.fits.reading import read_measurements
from stribeck.quantities.units import InputError


@dataclass(frozen=True, eq=False)
class Measured:
    """A measured Stribeck curve."""

    name: str  # Name of its file, and of the curve where that holds several
    file: str  # Name of its file
    speed: Array  # Sliding speed, ascending [m/s]
    friction: Array  # Friction coefficient [-]
    source: Measurements  # All that its file holds
    made: Contact  # The contact that was shown when it was loaded, with the inputs that its file gives
    own: tuple[str, ...]

    def places(self, contact: Contact, abscissa: Abscissa) -> Array:
        """Return the speeds at which its points are drawn: their own, or those of the contact with their Hersey number."""
        if abscissa == "speed" or contact.INPUTS.geometry != self.made.INPUTS.geometry:
            return self.speed
        measured = contact.replace(**{name: getattr(self.made, name) for name in self.own})
        return self.speed * (hersey_scale(measured) / hersey_scale(contact))


@dataclass(frozen=True)
class Fitted:
    """What a fit gave."""

    inputs: Inputs  # Those with the fitted values
    report: str  # The values with their errors, in a sentence


def fit_measured(now: Inputs, measured: Measured, on_step: Callable[..., object]) -> Fitted:
    """Fit inputs to the measured curves of a file: those that the case names under ``[fit]``, or the usual ones."""
    settings = now.tables.get("fit", {})
    found = fit(measured.source, now.contact, free=settings.get("free"), intervals=False, on_step=on_step)
    values = {each.name: each.value for each in found.inputs if each.name in now.fields and not each.is_factor}
    after = now.edited(values)
    fitted = ", ".join(f"{now.fields[name].label.lower()} {now.table.text(name, value, 3)}" for name, value in values.items())
    curves = len(measured.source.curves)
    number = "both" if curves == 2 else f"all {curves}"
    target = measured.name if curves == 1 else f"{number} curves of {measured.file}"
    return Fitted(after, f"Fitted to {target}: {fitted}. Undo brings back the values before; intervals: stribeck fit.")


def read_measured(name: str, content: bytes, contact: Contact) -> list[Measured]:
    r"""Return the measured curves of a file, over the speed.

    .. math:: U = \frac{(\eta U)}{\eta}, \qquad U = \mathrm{Hs} \, \frac{F_N}{\eta},
              \qquad U = \mathrm{Hs} \, \frac{F_N}{\eta R} \text{ of a ball}
    """
    with tempfile.TemporaryDirectory(prefix="stribeck-") as folder:
        path = Path(folder) / "curve.csv"  # never under the name that came with it
        path.write_bytes(content)
        try:
            data = read_measurements(path, FitSettings.of(contact))
        except InputError as problem:
            raise InputError(str(problem).replace(str(path), name)) from None
    found, rule = [], RULES[contact.groups.geometry]
    for k, (curve, inputs) in enumerate(zip(data.curves, data.inputs, strict=True)):
        given = {each: value for each, value in inputs.items() if each in rule.hersey_exponents}
        made = contact.replace(**given)
        factor = rule.speed_per(data.abscissa, made)
        own = tuple(given if data.abscissa == "speed" else rule.hersey_exponents)
        mine = data.curve == k
        label = name if len(data.curves) == 1 else f"{name}: {curve}"
        found.append(Measured(label, name, data.values[mine] * factor, data.friction[mine], data, made, own))
    return found
