"""The inputs of a tab: a contact in SI units and as groups, linked both ways, and the unit of each field.

Every change makes new inputs from old ones, or raises the sentence that the command line prints; nothing is half changed.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from decimal import Context
from fractions import Fraction
from typing import Any, Literal

from stribeck.cases.case import Case
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.geometries import CONTACTS
from stribeck.contacts.groups import Geometry
from stribeck.explorer.inputs.carried import contact_of, model_of_case, rest_of_case, tables_of
from stribeck.quantities.formats import format_si
from stribeck.quantities.inputs import INPUT_TABLES, InputTable, quantity
from stribeck.quantities.schema import Input
from stribeck.quantities.units import DIMENSIONS, InputError, read_number, show, to_si

__all__ = [
    "FIELDS",
    "GROUP_FIELDS",
    "Abscissa",
    "Field",
    "Inputs",
    "exact_text",
    "from_case",
    "in_unit",
    "NAMES",
    "number_text",
    "position",
    "read_field",
    "with_slider",
    "with_text",
    "units_of",
    "value_of",
    "with_model",
]

Abscissa = Literal["speed", "hersey"]

GREEK = {"eta": "η", "alpha": "α", "beta": "β", "mu": "µ"}


@dataclass(frozen=True)
class Field:
    """A quantity as the page shows it."""

    label: str  # What it is called; the symbol as HTML
    symbol: str  # What it is called; the symbol as HTML
    low: float  # Ends of its slider, which is logarithmic [SI]
    high: float  # Ends of its slider, which is logarithmic [SI]
    units: tuple[str, ...] = ()  # Units to choose from; empty for a bare number
    optional: bool = False  # Whether its field may be empty


FRICTION = "boundary_friction"
MAX_FRICTION = 10.0  # Friction coefficient above which the value is probably in per cent.


def _html(symbol: str) -> str:
    """Return a symbol of TeX, a letter with at most one index, as HTML."""
    letter, _, index = re.sub(r"\\(eta|alpha|beta|mu)", lambda m: GREEK[m[1]], symbol.strip("$")).partition("_")
    index = re.sub(r"\\mathrm|[{}]", "", index)
    return letter.replace("^*", "*") + (f"<sub>{index}</sub>" if index else "")


FIRST_FIELDS = ("speed", "load", "viscosity", "roughness")  # Inputs that are changed most often, shown first.


def _field(row: Input) -> Field:
    return Field(row.label[0].upper() + row.label[1:], _html(row.symbol), *row.usual, row.units, row.optional)


FIELDS: dict[str, dict[str, Field]] = {
    geometry: {name: _field(table.quantities[name]) for name in dict.fromkeys((*FIRST_FIELDS, *table.names))}
    for geometry, table in INPUT_TABLES.items()
}
"""The inputs of each geometry, those changed most often first."""

GROUP_FIELDS = {
    "speed_group": Field("Speed group", "λ", 1e-12, 1e4),
    "load_group": Field("Load group", "F", 1e-6, 1e4),
    "roughness_group": Field("Roughness group", "h\u0304<sub>rms</sub>", 1e-9, 1e3),
}
"""The groups: moving one moves speed, load and roughness so that the other two stay."""

NAMES = tuple(dict.fromkeys(name for fields in FIELDS.values() for name in fields))
"""The inputs of all geometries."""

SLIDER_DIGITS = 3  # Digits to which a slider rounds, so that its value can be read and typed.


@dataclass(frozen=True)
class Inputs:
    """What a tab shows."""

    contact: Contact  # The contact
    units: Mapping[str, str] = field(default_factory=dict)  # The unit of each field that has one
    definition: Definition = "balanced"  # The friction by which curves, regimes and margins go
    abscissa: Abscissa = "speed"  # What the curve is drawn over
    title: str = ""  # Headline
    rtol: float = 1e-6  # Relative tolerance of the states
    model: str = ""  # The model of the contact, and what the page carries along, as in :mod:`stribeck.explorer.inputs.carried`
    rest: str = ""  # The model of the contact, and what the page carries along, as in :mod:`stribeck.explorer.inputs.carried`

    @property
    def table(self) -> InputTable:
        """The table of its inputs."""
        return self.contact.INPUTS

    @property
    def fields(self) -> dict[str, Field]:
        """Its fields by name."""
        return FIELDS[self.table.geometry]

    def shown_as(self, name: str) -> Field:
        """Return the format of a quantity or a group."""
        return GROUP_FIELDS.get(name) or self.fields[name]


def from_case(case: Case) -> Inputs:
    """Return the inputs of a case, each in the unit in which it reads best."""
    model = model_of_case(case)
    numbers = {name: getattr(case.contact, name) for name in case.contact.INPUTS.names}
    contact = contact_of(model, numbers)
    check_friction(FRICTION, getattr(contact, FRICTION))
    return Inputs(
        contact, units_of(contact), case.definition, title=case.title, rtol=case.rtol, model=model, rest=rest_of_case(case)
    )


def with_model(inputs: Inputs, model: str, **numbers: float | None) -> Inputs:
    """Return the inputs with another model, and with some of their numbers changed."""
    geometry: Geometry = tables_of(model).get("geometry", "line")
    before = inputs.contact
    table = INPUT_TABLES[geometry]
    kept = {name: getattr(before, name) for name in table.names if name in before.INPUTS.names}
    if geometry != before.INPUTS.geometry:
        R, E, p = before.radius, before.modulus, before.hertz.pressure
        kept["load"] = math.pi**3 * p**3 * R**2 / (6 * E**2) if geometry == "point" else math.pi * R * p**2 / E
    contact = contact_of(model, kept | numbers)
    units = units_of(contact) | {name: unit for name, unit in inputs.units.items() if name != "load" or "load" in kept}
    if geometry != before.INPUTS.geometry:
        units["load"] = units_of(contact)["load"]
    return replace(inputs, contact=contact, model=model, units={name: units[name] for name in units_of(contact)})


def check_friction(name: str, value: float) -> None:
    """Refuse a friction coefficient that looks like per cent."""
    if value > MAX_FRICTION:
        raise InputError(
            f"{name} = {value:g} is above {MAX_FRICTION:g}, the largest the explorer takes; "
            f"write {value / 100:g} for {value:g} %."
        )


def units_of(contact: Contact) -> dict[str, str]:
    """Return for each field with a unit the one in which its value reads best."""
    found = {}
    table = contact.INPUTS
    for name, shown in FIELDS[table.geometry].items():
        if shown.units:
            value = getattr(contact, name)
            found[name] = shown.units[0]
            if value is not None:
                _, _, found[name] = format_si(value, table.quantities[name].dimension).partition(" ")
    return found


def value_of(inputs: Inputs, name: str) -> float:
    """Return a quantity in SI units, or a group; infinite if the contact does without it."""
    if name in GROUP_FIELDS:
        return float(getattr(inputs.contact.groups, name.removesuffix("_group")))
    value = getattr(inputs.contact, name)
    return math.inf if value is None else float(value)


def with_text(inputs: Inputs, name: str, text: str) -> Inputs:
    """Return the inputs after ``text`` was typed into a field."""
    if name in GROUP_FIELDS:
        return _with_group(inputs, name, read_number(name, _with_point(name, _present(name, text))))
    value, unit = read_field(inputs, name, text)
    units = {**inputs.units, name: unit} if unit else inputs.units
    return replace(inputs, contact=inputs.contact.replace(**{name: value}), units=units)


def read_field(inputs: Inputs, name: str, text: str) -> tuple[float | None, str]:
    """Return the value in SI units of what was typed into a field, and its unit."""
    text, shown, table = _with_point(name, text.strip()), inputs.fields[name], inputs.table
    if not text and shown.optional:
        return table.quantities[name].default, inputs.units.get(name, "")
    _present(name, text)
    if not shown.units:
        value = quantity(name, read_number(name, text), table)
        if name == FRICTION:
            check_friction(name, value)
        return value, ""
    unit = inputs.units[name]
    if isinstance(_bare(text), float):
        text = f"{text} {unit}"
    try:
        value = quantity(name, text, table)
    except InputError as problem:
        si = DIMENSIONS[table.quantities[name].dimension].unit
        message = str(problem)
        if message.endswith(f"or a bare number in {si}."):
            message = f"{message.removesuffix(f'{si}.')}{unit}."
        raise InputError(message) from None
    unit = re.sub(r"^[-+\N{MINUS SIGN}0-9.]+([eE][-+]?[0-9]+)?\s*", "", text)
    return value, next((known for known in shown.units if known.replace("µ", "u") == unit), unit)


def with_slider(inputs: Inputs, name: str, place: float) -> Inputs:
    """Return the inputs after a slider was moved to ``place``, the logarithm to base ten of its value in SI units."""
    shown = inputs.shown_as(name)
    factor = _factor(inputs, name)
    value = float(f"{min(max(10.0**place, shown.low), shown.high) / factor:.{SLIDER_DIGITS}g}")
    if name in GROUP_FIELDS:
        return _with_group(inputs, name, value)
    if shown.units:
        # By way of text, so that it is the number which typing it would give.
        value = quantity(name, f"{value!r} {inputs.units[name]}", inputs.table)
    return replace(inputs, contact=inputs.contact.replace(**{name: value}))


def in_unit(inputs: Inputs, name: str, unit: str) -> Inputs:
    """Return the inputs with a field shown in another unit, its value kept."""
    _unit_factor(inputs.table.quantities[name].dimension, unit)
    return replace(inputs, units={**inputs.units, name: unit})


def position(inputs: Inputs, name: str) -> float:
    """Return where the slider of a quantity stands: the logarithm to base ten of its value, at the ends where it is beyond."""
    shown = inputs.shown_as(name)
    return math.log10(min(max(value_of(inputs, name), shown.low), shown.high))


def number_text(inputs: Inputs, name: str, digits: int = 4) -> str:
    """Return the number that stands in a field, in its unit."""
    value = value_of(inputs, name)
    return "" if math.isinf(value) else f"{value / _factor(inputs, name):.{digits}g}"


def exact_text(inputs: Inputs, name: str, of: float = 1.0) -> str:
    """Return the shortest text that gives back the very value times ``of``, with its unit; empty for what is not there."""
    kept = getattr(inputs.contact, name)
    if kept is None:
        return ""
    value = of * float(kept)
    unit = inputs.units.get(name, "")
    if not unit:
        return repr(value)
    dimension = inputs.table.quantities[name].dimension
    # Through exact numbers, because the quotient of two doubles may not lead back in any number of digits.
    quotient = Fraction(value) / Fraction(repr(_unit_factor(dimension, unit)))
    for digits in range(3, 30):
        number = Context(prec=digits).divide(quotient.numerator, quotient.denominator).normalize()
        text = f"{number:f} {unit}" if -6 < number.adjusted() < 16 else f"{number} {unit}"
        if to_si(text, dimension, name) == value:
            return text
    return f"{value!r} {DIMENSIONS[dimension].unit}"


_COMMA = re.compile(r"([-+\N{MINUS SIGN}]?[0-9]{0,40}),([0-9]{1,40})((?:[eE][-+]?[0-9]+)?(?:\s.*|[^0-9.,].*)?)", re.DOTALL)


def _with_group(inputs: Inputs, name: str, value: float) -> Inputs:
    contact, moved = inputs.contact, ("load", "speed", "roughness")
    change: dict[str, Any] = {name.removesuffix("_group"): value}
    groups = replace(contact.groups, **change)
    kept = {key: getattr(contact, key) for key in inputs.table.names if key not in moved}
    found = CONTACTS[inputs.table.geometry].from_groups(groups, **kept)  # type: ignore[index, attr-defined]
    return replace(inputs, contact=contact.replace(**{key: getattr(found, key) for key in moved}))


def _with_point(name: str, text: str) -> str:
    """Return text with a decimal point for its decimal comma; refuse a comma that may part thousands."""
    found = _COMMA.fullmatch(text)
    if not found:
        return text
    whole, part, rest = found.groups()
    if len(part) == 3 and whole.lstrip("+-\N{MINUS SIGN}0"):
        number = f"{whole}{part}"
        raise InputError(f"{name} = {show(text)} may be {whole}.{part} or {number}; write one of them, without a comma.")
    return f"{whole or 0}.{part}{rest}"


def _present(name: str, text: str) -> str:
    """Return the text of a field that must hold a number."""
    if not text.strip():
        raise InputError(f"{name} is empty; type a number, or press Escape for the one before.")
    return text.strip()


def _bare(text: str) -> float | str:
    """Return a bare number as such; other text as it is."""
    try:
        return float(text)
    except ValueError:
        return text


def _factor(inputs: Inputs, name: str) -> float:
    unit = inputs.units.get(name)
    return 1.0 if unit is None else _unit_factor(inputs.table.quantities[name].dimension, unit)


@functools.lru_cache(maxsize=1000)
def _unit_factor(dimension: str, unit: str) -> float:
    return to_si(f"1 {unit}", dimension, "unit")
