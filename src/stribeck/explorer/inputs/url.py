"""The state of a tab as the query string of its address, and back: a shared link opens the same state.

The keys are those of a case, ``speed`` of the table ``[contact]`` and ``fluid.model`` of another; text that is JSON is JSON.
An address that says its ``geometry`` is a whole case; another one changes the case with which the page began.
"""

import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, get_args
from urllib.parse import parse_qsl, quote, urlencode

from stribeck.cases.tables import HEAD
from stribeck.contacts.contact import IN_PLACE_OF
from stribeck.contacts.geometries import INPUT_TABLES
from stribeck.explorer.inputs.inputs import Abscissa, Inputs, refuse_files
from stribeck.quantities.units import InputError, checked_word

MAX_URL_LENGTH = 60_000  # Characters of an address that the server and all browsers take.
MAX_PINS = 6  # Pinned contacts of a page.

_PLACE = re.compile(r"(?:\[(\w+)[^\]]*\] )?(?:(\w+)\b)?")  # Of a sentence about a case: table and key

Given = dict[str, str]  # Keys and texts of an address


@dataclass(frozen=True)
class Opened:
    """What an address asks for."""

    inputs: Inputs  # The inputs; where the address is wrong, those that it should have changed
    pins: tuple[Inputs, ...]  # The pinned contacts, with their names as titles
    problems: dict[str, tuple[str, str]]  # What is wrong: for each key the text received and the sentence about it


def encode(inputs: Inputs, pins: Sequence[Inputs] = ()) -> str:
    """Return the query string, without question mark, that :func:`decode` reads back to the same values."""
    items: list[tuple[str, str]] = [("geometry", inputs.table.geometry), ("abscissa", inputs.abscissa)]
    for name, table in inputs.tables.items():
        keys = table if isinstance(table, dict) else {name: table}
        prefix = f"{name}." if isinstance(table, dict) and name != "contact" else ""
        items += [(prefix + key, _text(value)) for key, value in keys.items() if key != "geometry"]
    items += [("pin", encode(pin)) for pin in pins]
    return urlencode(items, safe=",:/*", quote_via=quote)


def _text(value: Any) -> str:
    """Return a value as the text of a key; text that could be taken for JSON is written as such."""
    return value if isinstance(value, str) and _value(value) is value else json.dumps(value, ensure_ascii=False)


def _value(text: str) -> Any:
    """Return the value that the text of a key stands for."""

    def refuse(_: str) -> Any:  # nan and inf are no JSON
        raise ValueError

    try:
        return json.loads(text, parse_constant=refuse)
    except (ValueError, RecursionError):
        return text


def check_length(inputs: Inputs, pins: Sequence[Inputs] = ()) -> None:
    """Refuse what no address can hold."""
    length = len(encode(inputs, pins))
    if length > MAX_URL_LENGTH:
        parts = {"the title": inputs.case.title, "the pinned curves": "".join(pin.text for pin in pins)}
        parts["the contact law and other tables"] = inputs.text.replace(inputs.case.title, "")
        most = max(parts, key=lambda name: len(parts[name]))
        raise InputError(
            f"the address of this state would have {length} characters, but at most {MAX_URL_LENGTH} are "
            f"possible; most come from {most}. "
            "Shorten them: a contact law or spectrum needs some hundred rows at most."
        )


def decode(items: Iterable[tuple[str, str]], start: Inputs) -> Opened:
    """Return what a query string asks for, beginning with ``start``; what it cannot mean is left out and told."""
    given = list(items)
    problems: dict[str, tuple[str, str]] = {}
    left, pins = {key: text for key, text in given if key != "pin"}, []
    for text in (text for key, text in given if key == "pin"):
        try:
            pins.append(_pin(text, start))
        except InputError as problem:
            problems["pin"] = text, str(problem)
    abscissa = left.pop("abscissa", start.abscissa)
    try:
        checked_word("abscissa", abscissa, get_args(Abscissa))
    except InputError as problem:
        problems["abscissa"] = abscissa, str(problem)
        abscissa = start.abscissa
    inputs = start
    while left:
        try:
            tables = _tables(left, start)
            refuse_files(tables, "a link contains its rows instead")
            inputs = Inputs.of(tables)
            break
        except InputError as problem:
            wrong = _wrong(str(problem), left)
            problems |= wrong
            left = {key: text for key, text in left.items() if key not in wrong}
            if "state" in wrong:
                break
    drawn: Any = {"abscissa": abscissa}
    return Opened(replace(inputs, **drawn), tuple(pins[:MAX_PINS]), problems)


def _tables(given: Given, start: Inputs) -> dict[str, Any]:
    """Return the tables of a case that keys change or make."""
    tables, known = start.tables, INPUT_TABLES["point"]
    if "geometry" in given:  # numbers that are left out stay as they were
        needed = {name: row for name, row in known.kept.items() if not row.optional}
        typical = {name: row.typical_value for name, row in needed.items()}
        kept = {key: value for key, value in tables["contact"].items() if known.stands_for.get(key, key) in needed}
        tables = {"contact": kept if given["geometry"] == start.table.geometry else typical}
    for key, text in given.items():
        table, _, name = key.rpartition(".")
        if not table and name in HEAD:
            tables[name] = _value(text) if name == "title" and isinstance(_value(text), str) else text
            continue
        own = tables.setdefault(table or "contact", {})
        if not isinstance(own, dict):
            raise InputError(f"{key} = {text!r} is not a known key.")
        if not table:  # in the place of another form of the same input
            for other in [each for each in own if known.stands_for.get(each, each) == known.stands_for.get(name, name)]:
                if other not in given:
                    del own[other]
        own[name] = _value(text)
    gone = {name for part, name in IN_PLACE_OF.items() if part in tables} - given.keys()
    if isinstance(tables["contact"], dict):
        tables["contact"] = {key: each for key, each in tables["contact"].items() if key not in gone}
    return tables


def _wrong(sentences: str, given: Given) -> dict[str, tuple[str, str]]:
    """Return the keys that sentences about a case are about, with their texts; all of it where none is."""
    found: dict[str, tuple[str, str]] = {}
    for line in sentences.splitlines():
        table, name = _PLACE.match(line).groups()  # type: ignore[union-attr]
        of_table = [key for key in given if table not in (None, "contact") and key.startswith(f"{table}.")]
        keys = [f"{table}.{name}"] if f"{table}.{name}" in given else [name] if name in given else of_table
        found |= {key: (given[key], line) for key in keys}
    return found or {"state": ("", sentences)}


def _pin(text: str, start: Inputs) -> Inputs:
    """Return a pinned contact, which is the address of a state within that of the page."""
    found = decode(((key, value) for key, value in parse_qsl(text, keep_blank_values=True) if key != "pin"), start)
    for _, sentence in found.problems.values():
        raise InputError(f"in pin, {sentence}")
    return found.inputs
