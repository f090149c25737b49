"""What a tab shows: a contact in SI units and as groups, linked both ways, and the unit of each field.

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
from stribeck.contacts.friction import Definition
from stribeck.contacts.line import LineContact
from stribeck.explorer.carried import law_of_case, rest_of_case, shape_of
from stribeck.quantities.inputs import INPUTS, QUANTITIES, quantity
from stribeck.quantities.units import DIMENSIONS, InputError, format_si, read_number, show, to_si

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

GREEK = {"eta": "η", "alpha": "α", "beta": "β", "mu": "µ"}


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


FRICTION = "boundary_friction"
LARGEST_FRICTION = 10.0
"""Friction coefficient above which per cent are suspected."""


def _html(symbol: str) -> str:
    """Return a symbol of TeX, a letter with at most one index, as HTML."""
    letter, _, index = re.sub(r"\\(eta|alpha|beta|mu)", lambda m: GREEK[m[1]], symbol.strip("$")).partition("_")
    index = re.sub(r"\\mathrm|[{}]", "", index)
    return letter.replace("^*", "*") + (f"<sub>{index}</sub>" if index else "")


MOST_CHANGED = ("speed", "load", "viscosity", "roughness")
"""The inputs that one changes most, which stand first."""

FIELDS = {
    name: Field(row.label[0].upper() + row.label[1:], _html(row.symbol), *row.usual, row.units)
    for name, row in ((name, QUANTITIES[name]) for name in dict.fromkeys((*MOST_CHANGED, *INPUTS)))
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
        The friction by which curves, regimes and margins go.
    abscissa : {"speed", "hersey"}
        What the curve is drawn over.
    title : str
        Headline.
    rtol : float
        Relative tolerance of the states.
    law, rest : str
        The contact law of the contact, and what the page carries along, as in :mod:`stribeck.explorer.carried`.
    """

    contact: LineContact
    units: Mapping[str, str] = field(default_factory=dict)
    definition: Definition = "balanced"
    abscissa: Abscissa = "speed"
    title: str = ""
    rtol: float = 1e-6
    law: str = ""
    rest: str = ""


def from_case(case: Case) -> Inputs:
    """Return the inputs of a case, each in the unit in which it reads best.

    Parameters
    ----------
    case : Case
        The case.

    Returns
    -------
    Inputs
        All that the case holds.

    Raises
    ------
    InputError
        If the case holds something that the page cannot show.
    """
    if not isinstance(case.contact, LineContact):
        raise InputError("the page shows cylinders; solve this ball with stribeck solve, curve or regimes.")
    law = law_of_case(case)
    contact = case.contact.replace(law=shape_of(law))
    check_friction(FRICTION, getattr(contact, FRICTION))
    return Inputs(
        contact, units_of(contact), case.definition, title=case.title, rtol=case.rtol, law=law, rest=rest_of_case(case)
    )


def check_friction(name: str, value: float) -> None:
    """Refuse a friction coefficient that looks like per cent."""
    if value > LARGEST_FRICTION:
        raise InputError(
            f"{name} = {value:g} is above {LARGEST_FRICTION:g}, the largest the explorer takes; "
            f"write {value / 100:g} for {value:g} %."
        )


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
    text = _with_point(name, text.strip())
    if name in GROUP_FIELDS:
        return _with_group(inputs, name, read_number(name.removesuffix("_group"), text))
    if not FIELDS[name].units:
        contact = inputs.contact.replace(**{name: _bare(text)})
        if name == FRICTION:
            check_friction(name, getattr(contact, name))
        return replace(inputs, contact=contact)
    unit = inputs.units[name]
    if isinstance(_bare(text), float):
        text = f"{text} {unit}"
    try:
        value = quantity(name, text)
    except InputError as problem:
        si = DIMENSIONS[QUANTITIES[name].dimension].unit
        said = str(problem)
        if said.endswith(f"or a bare number in {si}."):
            said = f"{said.removesuffix(f'{si}.')}{unit}."
        raise InputError(said) from None
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
    if not unit:
        return repr(value)
    # Through exact numbers, because the quotient of two doubles may not lead back in any number of digits.
    quotient = Fraction(value) / Fraction(repr(_unit_factor(name, unit)))
    for digits in range(3, 30):
        number = Context(prec=digits).divide(quotient.numerator, quotient.denominator).normalize()
        text = f"{number:f} {unit}" if -6 < number.adjusted() < 16 else f"{number} {unit}"
        if quantity(name, text) == value:
            return text
    return f"{value!r} {DIMENSIONS[QUANTITIES[name].dimension].unit}"


_COMMA = re.compile(r"([-+\N{MINUS SIGN}]?[0-9]{0,40}),([0-9]{1,40})((?:[eE][-+]?[0-9]+)?(?:\s.*|[^0-9.,].*)?)", re.DOTALL)


def _with_group(inputs: Inputs, name: str, value: float) -> Inputs:
    contact = inputs.contact
    change: dict[str, Any] = {name.removesuffix("_group"): value}
    groups = replace(contact.groups, **change)
    kept = [input_name for input_name in INPUTS if input_name not in ("load", "speed", "roughness")]
    moved = LineContact.from_groups(groups, **{key: getattr(contact, key) for key in kept})
    return replace(inputs, contact=moved)


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
