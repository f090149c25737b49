"""Measured curves to draw over the model: read as fits read them, as friction against speed."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path, PurePath
from typing import Any

from stribeck._types import Array
from stribeck.cases.fit_settings import DEFAULT_FREE, FREE_INPUTS, FitSettings, check_fit_table
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction_rules import RULES
from stribeck.explorer.curves import hersey_scale
from stribeck.explorer.inputs.inputs import Abscissa, Inputs
from stribeck.files.table_reading import read_table
from stribeck.fits.fit import fit
from stribeck.fits.measurements import Measurements
from stribeck.fits.reading import read_measurements
from stribeck.fits.result import Fit
from stribeck.fits.table.columns import ABSCISSAS, known_name
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
    report: str  # The values, in a sentence
    found: Fit  # The values with their intervals, the residuals and what is to be known of them


# What a column of a file may be.
MEANINGS = (*ABSCISSAS, "entrainment_speed", "friction", "friction_force", "normal_force", "error", "curve")


def free_inputs(now: Inputs) -> list[tuple[str, str, bool]]:
    """Return the inputs that a fit may free, with their labels, and whether ``[fit]`` or the default frees them."""
    chosen = now.tables.get("fit", {}).get("free", DEFAULT_FREE)
    return [(name, now.fields[name].label, name in chosen) for name in FREE_INPUTS if name in now.fields]


def fit_measured(now: Inputs, measured: Measured, on_step: Callable[..., object], free: Sequence[str] = ()) -> Fitted:
    """Fit inputs to the measured curves of a file: those named, or of the case under ``[fit]``, or the usual ones."""
    free = free or now.tables.get("fit", {}).get("free") or DEFAULT_FREE
    found = fit(measured.source, now.contact, free=free, on_step=on_step)
    values = {each.name: each.value for each in found.inputs if each.name in now.fields and not each.is_factor}
    after = now.edited(values)
    fitted = ", ".join(f"{now.fields[name].label.lower()} {now.table.text(name, value, 3)}" for name, value in values.items())
    curves = len(measured.source.curves)
    number = "both" if curves == 2 else f"all {curves}"
    target = measured.name if curves == 1 else f"{number} curves of {measured.file}"
    return Fitted(after, f"Fitted to {target}: {fitted}. Undo brings back the values before.", found)


@contextmanager
def lent_file(name: str, content: bytes) -> Iterator[Path]:
    """Lend a file with a content, never under the name that came with it but in sentences."""
    with tempfile.TemporaryDirectory(prefix="stribeck-") as folder:
        path = Path(folder) / f"file{PurePath(name).suffix}"
        path.write_bytes(content)
        try:
            yield path
        except InputError as problem:
            raise InputError(str(problem).replace(str(path), name)) from None


def headers_of(name: str, content: bytes) -> list[str]:
    """Return the names of the columns of a file."""
    with lent_file(name, content) as path:
        return list(read_table(path, knows=known_name).written)


def read_measured(name: str, content: bytes, contact: Contact, asked: Mapping[str, Any] | None = None) -> list[Measured]:
    r"""Return the measured curves of a file, over the speed; a table ``[fit]`` may say what its columns are.

    .. math:: U = \frac{(\eta U)}{\eta}, \qquad U = \mathrm{Hs} \, \frac{F_N}{\eta},
              \qquad U = \mathrm{Hs} \, \frac{F_N}{\eta R} \text{ of a ball}
    """
    settings = FitSettings.of(contact)
    settings = replace(check_fit_table(dict(asked or {}), settings.geometry), slide_to_roll=settings.slide_to_roll)
    with lent_file(name, content) as path:
        data = read_measurements(path, settings)
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
