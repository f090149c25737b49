"""The inputs of a tab: a contact in SI units and as groups, linked both ways, and the unit of each field.

The fields are the rows of the package's tables of inputs. Every change makes new inputs from old ones, or raises the sentence
that the command line prints; nothing is half changed.
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
from stribeck.contacts.geometries import CONTACTS, INPUT_TABLES
from stribeck.contacts.inputs import InputTable
from stribeck.explorer.inputs.tables import case_of, contact_of, geometry_of, tables_of, tables_of_case
from stribeck.quantities.formats import format_si
from stribeck.quantities.schema import Input
from stribeck.quantities.units import DIMENSIONS, InputError, read_number, show, to_si

__all__ = [
    "FIELDS",
    "GROUP_FIELDS",
    "Abscissa",
    "Inputs",
    "NAMES",
    "case_tables",
    "exact_text",
    "from_case",
    "in_unit",
    "number_text",
    "position",
    "read_field",
    "row_of",
    "units_of",
    "value_of",
    "with_slider",
    "with_tables",
    "with_text",
]

Abscissa = Literal["speed", "hersey"]

FRICTION = "boundary_friction"
MAX_FRICTION = 10.0  # Friction coefficient above which the value is probably in per cent.

FIRST_FIELDS = ("speed", "load", "viscosity", "roughness")  # Inputs that are changed most often, shown first.

FIELDS: dict[str, dict[str, Input]] = {
    geometry: {name: table.quantities[name] for name in dict.fromkeys((*FIRST_FIELDS, *table.names))}
    for geometry, table in INPUT_TABLES.items()
}
"""The inputs of each geometry, those changed most often first."""

GROUP_FIELDS = {
    f"{name}_group": Input(label=f"{name} group", symbol=symbol, dimension="number", typical="", source="", usual=usual)
    for name, symbol, usual in (
        ("speed", "λ", (1e-12, 1e4)),
        ("load", "F", (1e-6, 1e4)),
        ("roughness", "h\u0304_rms", (1e-9, 1e3)),
    )
}
"""The groups: moving one moves speed, load and roughness so that the other two stay."""

NAMES = tuple(dict.fromkeys(name for fields in FIELDS.values() for name in fields))
"""The inputs of all geometries."""

GREEK = {"eta": "η", "alpha": "α", "beta": "β", "mu": "µ"}

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
    tables: str = ""  # The other tables of its case, as in :mod:`stribeck.explorer.inputs.tables`

    @property
    def table(self) -> InputTable:
        """The table of its inputs."""
        return self.contact.INPUTS

    @property
    def fields(self) -> dict[str, Input]:
        """Its inputs by name."""
        return FIELDS[self.table.geometry]

    @property
    def errors(self) -> dict[str, float]:
        """Relative standard errors of the inputs that have one."""
        return case_of(self.tables).errors

    @property
    def facts(self) -> dict[str, float]:
        """The facts of its table ``[check]`` in SI units."""
        return case_of(self.tables).facts


def from_case(case: Case) -> Inputs:
    """Return the inputs of a case, each in the unit in which it reads best."""
    tables = tables_of_case(case)
    contact = contact_of(tables, {name: getattr(case.contact, name) for name in case.contact.INPUTS.names})
    check_friction(contact.boundary_friction)
    return Inputs(contact, units_of(contact), case.definition, title=case.title, rtol=case.rtol, tables=tables)


def case_tables(inputs: Inputs) -> dict[str, Any]:
    """Return all tables of the case of inputs: :func:`from_case` gives the same inputs."""
    tables = tables_of(inputs.tables)
    errors = tables.pop("errors", {})
    contact: dict[str, Any] = {name: tables.pop(name) for name in ("geometry", "law") if name in tables}
    # A ball and a disc that both move have the mean of their speeds in a case.
    rolls = inputs.table.geometry == "point" and inputs.contact.slide_to_roll != 2
    for name, row in inputs.fields.items():
        kept, of = ("entrainment_speed", 0.5) if name == "speed" and rolls else (name, 1.0)
        text = exact_text(inputs, name, of)
        if text:
            error = f" +- {100 * errors[name]!r} %" if name in errors else ""
            contact[kept] = f"{text}{error}" if row.units or error else float(text)
    if "surface" in tables:
        tables["surface"] = {"shape_only": True, **tables["surface"]}  # alpha, beta and roughness stand in [contact]
    head = {"title": inputs.title} if inputs.title else {}
    head |= {"notes": tables.pop("notes")} if "notes" in tables else {}
    return head | {"contact": contact} | tables | {"solver": {"rtol": inputs.rtol, "definition": inputs.definition}}


def with_tables(inputs: Inputs, tables: str, **numbers: float | None) -> Inputs:
    """Return the inputs with other tables, and with some of their numbers changed."""
    before, geometry = inputs.contact, geometry_of(tables)
    kept = {name: getattr(before, name) for name in INPUT_TABLES[geometry].names if name in before.INPUTS.names}
    units = dict(inputs.units)
    if geometry != before.INPUTS.geometry:
        R, E, p = before.radius, before.modulus, before.hertz.pressure
        kept["load"] = math.pi**3 * p**3 * R**2 / (6 * E**2) if geometry == "point" else math.pi * R * p**2 / E
        units.pop("load", None)
    contact = contact_of(tables, kept | numbers)
    known = units_of(contact)
    return replace(inputs, contact=contact, tables=tables, units={name: units.get(name, known[name]) for name in known})


def check_friction(value: float) -> None:
    """Refuse a friction coefficient that looks like per cent."""
    if value > MAX_FRICTION:
        raise InputError(
            f"{FRICTION} = {value:g} is above {MAX_FRICTION:g}, the largest the explorer takes; "
            f"write {value / 100:g} for {value:g} %."
        )


def units_of(contact: Contact) -> dict[str, str]:
    """Return for each field with a unit the one in which its value reads best."""
    found = {}
    for name, row in FIELDS[contact.INPUTS.geometry].items():
        if row.units:
            value = getattr(contact, name)
            found[name] = row.units[0] if value is None else format_si(value, row.dimension).partition(" ")[2]
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
    text, row, table = _with_point(name, text.strip()), inputs.fields[name], inputs.table
    if not text and row.optional:
        return row.default, inputs.units.get(name, "")
    _present(name, text)
    if not row.units:
        value = table.checked(name, read_number(name, text))
        if name == FRICTION:
            check_friction(value)
        return value, ""
    unit = inputs.units[name]
    try:
        float(text)
        text = f"{text} {unit}"
    except ValueError:
        pass
    try:
        value = table.checked(name, text)
    except InputError as problem:
        bare = "or a bare number in {}.".format
        raise InputError(str(problem).replace(bare(DIMENSIONS[row.dimension].unit), bare(unit))) from None
    unit = re.sub(r"^[-+\N{MINUS SIGN}0-9.]+([eE][-+]?[0-9]+)?\s*", "", text)
    return value, next((known for known in row.units if known.replace("µ", "u") == unit), unit)


def with_slider(inputs: Inputs, name: str, place: float) -> Inputs:
    """Return the inputs after a slider was moved to ``place``, the logarithm to base ten of its value in SI units."""
    low, high = _row(inputs, name).usual
    value = float(f"{min(max(10.0**place, low), high) / _factor(inputs, name):.{SLIDER_DIGITS}g}")
    return with_text(inputs, name, repr(value))


def in_unit(inputs: Inputs, name: str, unit: str) -> Inputs:
    """Return the inputs with a field shown in another unit, its value kept."""
    _unit_factor(inputs.fields[name].dimension, unit)
    return replace(inputs, units={**inputs.units, name: unit})


def position(inputs: Inputs, name: str) -> float:
    """Return where the slider of a quantity stands: the logarithm to base ten of its value, at the ends where it is beyond."""
    low, high = _row(inputs, name).usual
    return math.log10(min(max(value_of(inputs, name), low), high))


def number_text(inputs: Inputs, name: str, digits: int = 4) -> str:
    """Return the number that stands in a field, in its unit."""
    value = value_of(inputs, name)
    return "" if math.isinf(value) else f"{value / _factor(inputs, name):.{digits}g}"


def row_of(inputs: Inputs, name: str) -> dict[str, Any]:
    """Return what field, unit and slider of a quantity show."""
    row, unit = _row(inputs, name), inputs.units.get(name, "")
    symbol = re.sub(r"\\(eta|alpha|beta|mu)", lambda found: GREEK[found[1]], row.symbol.strip("$"))
    letter, _, index = re.sub(r"\\mathrm|[{}]", "", symbol).replace("^*", "*").partition("_")
    return {
        "name": name,
        "label": row.label[0].upper() + row.label[1:],
        "symbol": letter + (f"<sub>{index}</sub>" if index else ""),
        "ends": [math.log10(end) for end in row.usual],
        "text": number_text(inputs, name),
        "unit": unit,
        "units": list(dict.fromkeys((*row.units, unit))) if unit else [],
        "place": round(position(inputs, name), 4),
    }


def exact_text(inputs: Inputs, name: str, of: float = 1.0) -> str:
    """Return the shortest text that gives back the very value times ``of``, with its unit; empty for what is not there."""
    kept = getattr(inputs.contact, name)
    if kept is None:
        return ""
    value = of * float(kept)
    unit = inputs.units.get(name, "")
    if not unit:
        return repr(value)
    dimension = inputs.fields[name].dimension
    # Through exact numbers, because the quotient of two doubles may not lead back in any number of digits.
    quotient = Fraction(value) / Fraction(repr(_unit_factor(dimension, unit)))
    for digits in range(3, 30):
        number = Context(prec=digits).divide(quotient.numerator, quotient.denominator).normalize()
        text = f"{number:f} {unit}" if -6 < number.adjusted() < 16 else f"{number} {unit}"
        if to_si(text, dimension, name) == value:
            return text
    return f"{value!r} {DIMENSIONS[dimension].unit}"


_COMMA = re.compile(r"([-+\N{MINUS SIGN}]?[0-9]{0,40}),([0-9]{1,40})((?:[eE][-+]?[0-9]+)?(?:\s.*|[^0-9.,].*)?)", re.DOTALL)


def _row(inputs: Inputs, name: str) -> Input:
    """Return the row of a quantity or a group."""
    return GROUP_FIELDS.get(name) or inputs.fields[name]


def _with_group(inputs: Inputs, name: str, value: float) -> Inputs:
    contact, moved = inputs.contact, ("load", "speed", "roughness")
    change: dict[str, Any] = {name.removesuffix("_group"): value}
    groups = replace(contact.groups, **change)
    kept = {key: getattr(contact, key) for key in inputs.table.names if key not in moved}
    found = CONTACTS[inputs.table.geometry].from_groups(groups, **kept)
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


def _factor(inputs: Inputs, name: str) -> float:
    unit = inputs.units.get(name)
    return 1.0 if unit is None else _unit_factor(inputs.fields[name].dimension, unit)


@functools.lru_cache(maxsize=1000)
def _unit_factor(dimension: str, unit: str) -> float:
    return to_si(f"1 {unit}", dimension, "unit")
