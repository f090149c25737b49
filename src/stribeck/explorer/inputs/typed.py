"""What people type: a number of a data sheet in its own words becomes the input that the package converts.

The words are those of the rows: "70 Shore A", "Ra 0.4 um", "46 cSt", "1500 rpm, 30 mm", "stroke 50 mm, 2 Hz". A liquid is
named as in the table of presets, with its conditions: "ISO VG 46 at 60 degC".
"""

import functools
import re
from collections.abc import Iterator
from contextlib import suppress

from stribeck.contacts.forms import FORMS, Form
from stribeck.contacts.inputs import InputTable
from stribeck.fluids.description import Liquid
from stribeck.fluids.presets import PRESETS
from stribeck.quantities.schema import Input
from stribeck.quantities.units import InputError, number_or_text, show

Entries = dict[str, str | float]

_PARTS = re.compile(r"\s*(?:;|,\s|\b(?:and|with|on|at)\b)\s*")
_COMMA = re.compile(r"(?<![\w.,])([-+\N{MINUS SIGN}]?[0-9]{0,40}),([0-9]{1,40})(?![0-9.,])")
# A condition of a liquid, which is a number with its unit or a viscosity index, and what may stand between two.
_CONDITION = re.compile(
    r"(VI\s*)?([-+\N{MINUS SIGN}]?[0-9]+(?:\.[0-9]+)?)\s*(%|°\s?\w+|(?!(?:at|and|with|on|VI)\b)[a-z][^\s,;]*(?: ?[CFK]\b)?)?",
    re.IGNORECASE,
)
_BETWEEN = re.compile(r"(?:[\s,;]|\b(?:at|and|with|on)\b)*", re.IGNORECASE)
_OF_TEMPERATURE = re.compile(r"(?:°|deg(?:rees?)?)?\s?([CFK])", re.IGNORECASE)


def with_point(name: str, text: str) -> str:
    """Return text with points for its decimal commas; refuse a comma that may part thousands."""

    def point(found: re.Match[str]) -> str:
        whole, part = found.groups()
        if len(part) == 3 and whole.lstrip("+-\N{MINUS SIGN}0"):
            said = f"may be {whole}.{part} or {whole}{part}; write one of them, without a comma"
            raise InputError(f"{name} = {show(text)} {said}.")
        return f"{whole or 0}.{part}"

    return _COMMA.sub(point, text)


def forms_of(table: InputTable, name: str) -> list[Form]:
    """Return the forms in which an input may be given in other words."""
    return [each for each in FORMS if each in table.forms and table.stands_for.get(each.of, each.of) == name]


def examples(table: InputTable, name: str) -> Iterator[str]:
    """Yield how an input may be typed in other words."""
    for form in forms_of(table, name):
        if not form.joins:
            said = [f"{each.letters[-1]} {each.typical}" if each.letters else each.typical for each in form.inputs]
            alone = [each for each in form.inputs if each.dimension in (table.quantities[name].dimension, "pressure")]
            yield ", ".join([f"{(alone[0].label, *alone[0].letters)[-1]} {alone[0].typical}"] if alone else said)
    if name == "viscosity":
        yield "ISO VG 46 at 60 °C"


def entries_of(table: InputTable, name: str, text: str) -> Entries | None:
    """Return the inputs that a text in words means, or None where it is a number in units of the input itself."""
    own, found = table.quantities[name], Entries()
    with suppress(InputError):
        own.checked(text)
        return None
    forms = forms_of(table, name)
    rows = [own, *(each for form in forms for each in (*form.inputs, *form.second))]
    for part in filter(None, _PARTS.split(text)):
        named = _named(rows, part) or _by_unit(rows, part)
        if named is None:
            return None  # which its own row then refuses
        if named[0].name in found:
            raise InputError(f"{name} = {show(text)} has two values of {named[0].name}; type one.")
        found |= {named[0].name: _plain(*named)}
    begun = [form for form in forms if not form.joins and not found.keys().isdisjoint(each.name for each in form.inputs)]
    if len({form.of for form in begun}) < len(begun):
        raise InputError(f"{name} = {show(text)} mixes two ways to give it; type one of {'; '.join(examples(table, name))}.")
    for form in forms:
        if not form.joins and form.names[0] in found:
            for each in form.inputs:
                # A typical value of materials stands for one that is left out; the sentence of the conversion names it.
                if each.name not in found and each.source and each.name != form.names[0]:
                    found[each.name] = each.typical if each.units or each.dimension != "number" else float(each.typical)
    return found or None


def _named(rows: list[Input], part: str) -> tuple[Input, str] | None:
    """Return the row whose words begin or end a text, and the rest of it; the longest words first."""
    called = ((word, row) for row in rows for word in (row.label, row.name, *row.letters))
    words = sorted(called, key=lambda each: -len(each[0]))
    for word, row in words:
        sign = re.escape(word).replace("_", "[ _]")
        found = re.fullmatch(rf"(?:{sign}\b\s*[=:]?\s*(.+)|(.+?)\s*\b{sign})", part, re.IGNORECASE if len(word) > 1 else 0)
        if found:
            return row, found[1] or found[2]
    return None


def _by_unit(rows: list[Input], part: str) -> tuple[Input, str] | None:
    """Return the row whose kind a unit is of."""
    for row in rows:
        if row.dimension != "number" and re.search(r"[^\d.eE+\- ]", part):
            with suppress(InputError):
                row.checked(part)
                return row, part
    return None


def _plain(row: Input, text: str) -> str | float:
    """Return the value of a row from its text, a number without a unit as such."""
    number = number_or_text(text)
    if isinstance(number, str):
        return text
    if row.dimension != "number":
        raise InputError(f"{row.name} = {show(text)} has no unit; write, for example, {row.typical}.")
    return int(number) if number.is_integer() else number


@functools.lru_cache(maxsize=64)
def liquid_of(text: str) -> Liquid | None:
    """Return the liquid that a text names with its conditions, or None where it names none."""
    text = text.strip()
    for name, preset in sorted(PRESETS.items(), key=lambda each: not text.lower().startswith(each[0].partition("-")[0])):
        first, _, rest = name.partition("-")
        begins = re.match(rf"(?:{first}\b(?:(?: in)?[ -]{rest}\b)?|{rest or first}\b)-?", text, re.IGNORECASE)
        if begins:
            return preset(**_conditions(text, text[begins.end() :], list(preset.conditions)))
    return None


def _conditions(text: str, said: str, names: list[str]) -> dict[str, str | float]:
    """Return the conditions of a liquid that has these; a number in another unit than theirs is refused with its name."""
    other = _CONDITION.sub("", said)
    if not _BETWEEN.fullmatch(other):
        left = f"{show(other.strip())} is not understood"
        raise InputError(f"viscosity = {show(text)}: {left}; type, for example, ISO VG 46 at 60 °C, or a number.")
    given: dict[str, str | float] = {}
    value: str | float
    for index, number, unit in _CONDITION.findall(said.replace("\N{MINUS SIGN}", "-")):
        of_temperature = _OF_TEMPERATURE.fullmatch(unit)
        if index:
            name, value = "viscosity_index", float(number)
        elif unit.endswith("%"):
            name, value = "weight_fraction", float(number) / 100
        elif of_temperature:
            letter = of_temperature[1].upper()
            name, value = "temperature", f"{number} {letter if letter == 'K' else f'deg{letter}'}"
        else:  # in their order, of which the temperature is the last
            name = next((each for each in names if each == "temperature" or each not in given), "temperature")
            value = f"{number} {unit}" if unit else float(number)
        if name in given:
            raise InputError(f"viscosity = {show(text)} has two values of {name}; type one.")
        given[name] = value
    return given
