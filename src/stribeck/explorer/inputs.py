"""What a tab shows: a contact in SI units and as groups, linked both ways, and the unit of each field.

Every change makes new inputs from old ones, or raises the sentence that the command line prints; nothing is half changed.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from stribeck.cases.case import Case
from stribeck.contacts.friction import Definition
from stribeck.contacts.line import LineContact
from stribeck.quantities.inputs import QUANTITIES, quantity
from stribeck.quantities.units import format_si, read_number, to_si

__all__ = [
    "FIELDS",
    "GROUP_FIELDS",
    "Abscissa",
    "Field",
    "Inputs",
    "exact_text",
    "from_case",
    "in_unit",
    "number_text",
    "position",
    "slid",
    "typed",
    "value_of",
]

Abscissa = Literal["speed", "hersey"]


@dataclass(frozen=True)
class Field:
    """A quantity as the page shows it.

    Attributes
    ----------
    label, symbol : str
        What it is called; the symbol as HTML.
    low, high : float
        Ends of its slider, which is logarithmic [SI].
    units : tuple of str
        Units to choose from; empty for a bare number.
    """

    label: str
    symbol: str
    low: float
    high: float
    units: tuple[str, ...] = ()


FIELDS = {
    "speed": Field("Speed", "U", 1e-8, 10.0, ("µm/s", "mm/s", "m/s")),
    "load": Field("Load", "F<sub>N</sub>", 0.1, 1e5, ("N/m", "kN/m", "N/mm")),
    "viscosity": Field("Viscosity", "η", 1e-4, 1e3, ("mPa*s", "Pa*s", "cP")),
    "roughness": Field("Roughness", "h<sub>rms</sub>", 1e-9, 1e-4, ("nm", "µm", "mm")),
    "radius": Field("Radius", "R", 1e-4, 1.0, ("mm", "cm", "m")),
    "modulus": Field("Modulus", "E*", 1e4, 1e12, ("kPa", "MPa", "GPa")),
    "boundary_friction": Field("Dry friction", "µ<sub>0</sub>", 0.01, 2.0),
    "alpha": Field("Law decay", "α", 0.5, 5.0),
    "beta": Field("Law strength", "β", 1e-3, 2.0),
}
"""The inputs of a contact, those first that one changes most."""

GROUP_FIELDS = {
    "speed_group": Field("Speed group", "λ", 1e-12, 1e4),
    "load_group": Field("Load group", "F", 1e-5, 10.0),
    "roughness_group": Field("Roughness group", "h\u0304<sub>rms</sub>", 1e-9, 10.0),
}
"""The groups: moving one moves speed, load and roughness so that the other two stay."""

DIGITS = 3
"""Digits to which a slider rounds, so that what it chose can be read and typed."""


@dataclass(frozen=True)
class Inputs:
    """What a tab shows.

    Attributes
    ----------
    contact : LineContact
        The contact.
    units : mapping of str to str
        The unit of each field that has one.
    definition : {"balanced", "published"}
        The friction by which curves, regimes and distances go.
    abscissa : {"speed", "hersey"}
        What the curve is drawn over.
    title : str
        Headline.
    """

    contact: LineContact
    units: Mapping[str, str] = field(default_factory=dict)
    definition: Definition = "balanced"
    abscissa: Abscissa = "speed"
    title: str = ""


def from_case(case: Case) -> Inputs:
    """Return the inputs of a case, each in the unit in which it reads best."""
    return Inputs(case.contact, units_of(case.contact), case.definition, title=case.title)


def units_of(contact: LineContact) -> dict[str, str]:
    """Return for each field with a unit the one in which its value reads best."""
    found = {}
    for name, shown in FIELDS.items():
        if shown.units:
            _, _, unit = format_si(getattr(contact, name), QUANTITIES[name].dimension).partition(" ")
            found[name] = unit
    return found


def value_of(inputs: Inputs, name: str) -> float:
    """Return a quantity in SI units, or a group."""
    if name in GROUP_FIELDS:
        return float(getattr(inputs.contact.groups, name.removesuffix("_group")))
    return float(getattr(inputs.contact, name))


def typed(inputs: Inputs, name: str, text: str) -> Inputs:
    """Return the inputs after ``text`` was typed into a field.

    Parameters
    ----------
    inputs : Inputs
        Those before.
    name : str
        Key of :data:`FIELDS` or :data:`GROUP_FIELDS`.
    text : str
        A number, which is in the unit of the field, or a number with a unit, which the field then takes.

    Returns
    -------
    Inputs
        Those after.

    Raises
    ------
    InputError
        The sentence that the command line prints for such a value.
    """
    text = text.strip()
    if name in GROUP_FIELDS:
        return _with_group(inputs, name, read_number(name.removesuffix("_group"), text))
    if not FIELDS[name].units:
        return replace(inputs, contact=inputs.contact.replace(**{name: _bare(text)}))
    unit = inputs.units[name]
    if isinstance(_bare(text), float):
        text = f"{text} {unit}"
    value = quantity(name, text)
    unit = re.sub(r"^[-+\N{MINUS SIGN}0-9.]+([eE][-+]?[0-9]+)?\s*", "", text)
    return replace(inputs, contact=inputs.contact.replace(**{name: value}), units={**inputs.units, name: unit})


def slid(inputs: Inputs, name: str, place: float) -> Inputs:
    """Return the inputs after a slider was moved to ``place``, the logarithm to base ten of its value in SI units."""
    shown = GROUP_FIELDS.get(name) or FIELDS[name]
    factor = _unit_factor(name, inputs.units[name]) if shown.units else 1.0
    value = float(f"{min(max(10.0**place, shown.low), shown.high) / factor:.{DIGITS}g}")
    if name in GROUP_FIELDS:
        return _with_group(inputs, name, value)
    if shown.units:
        # By way of text, so that it is the number which typing it would give.
        value = quantity(name, f"{value!r} {inputs.units[name]}")
    return replace(inputs, contact=inputs.contact.replace(**{name: value}))


def in_unit(inputs: Inputs, name: str, unit: str) -> Inputs:
    """Return the inputs with a field shown in another unit, its value kept."""
    _unit_factor(name, unit)
    return replace(inputs, units={**inputs.units, name: unit})


def position(inputs: Inputs, name: str) -> float:
    """Return where the slider of a quantity stands: the logarithm to base ten of its value, at the ends where it is beyond."""
    shown = GROUP_FIELDS.get(name) or FIELDS[name]
    return math.log10(min(max(value_of(inputs, name), shown.low), shown.high))


def number_text(inputs: Inputs, name: str, digits: int = 4) -> str:
    """Return the number that stands in a field, in its unit."""
    return f"{value_of(inputs, name) / _factor(inputs, name):.{digits}g}"


def exact_text(inputs: Inputs, name: str) -> str:
    """Return the shortest text that gives back the very value, with its unit."""
    value = float(getattr(inputs.contact, name))
    unit = inputs.units.get(name, "")
    for digits in range(3, 18):
        text = f"{value / _factor(inputs, name):.{digits}g} {unit}".rstrip()
        if (quantity(name, text) if unit else float(text)) == value:
            return text
    return f"{value!r} {QUANTITIES_SI[name]}"


QUANTITIES_SI = {"speed": "m/s", "load": "N/m", "viscosity": "Pa*s", "roughness": "m", "radius": "m", "modulus": "Pa"}


def _with_group(inputs: Inputs, name: str, value: float) -> Inputs:
    contact = inputs.contact
    change: dict[str, Any] = {name.removesuffix("_group"): value}
    groups = replace(contact.groups, **change)
    kept = ("radius", "modulus", "viscosity", "alpha", "beta", "boundary_friction")
    moved = LineContact.from_groups(groups, **{key: getattr(contact, key) for key in kept})
    return replace(inputs, contact=moved)


def _bare(text: str) -> float | str:
    """Return a bare number as such; other text as it is."""
    try:
        return float(text)
    except ValueError:
        return text


def _factor(inputs: Inputs, name: str) -> float:
    unit = inputs.units.get(name)
    return 1.0 if unit is None else _unit_factor(name, unit)


@functools.lru_cache(maxsize=1000)
def _unit_factor(name: str, unit: str) -> float:
    return to_si(f"1 {unit}", QUANTITIES[name].dimension, name)
