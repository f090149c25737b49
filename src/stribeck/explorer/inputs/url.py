"""The state of a tab as the query string of its address, and back: a shared link opens the same state."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, get_args
from urllib.parse import parse_qsl, quote, urlencode

from stribeck.contacts.friction import check_definition
from stribeck.explorer.inputs.inputs import NAMES, Abscissa, Inputs, exact_text, read_field, with_tables
from stribeck.explorer.inputs.tables import geometry_of, json_text
from stribeck.quantities.units import InputError, checked_word, read_number, show
from stribeck.solver.solve import check_rtol

__all__ = ["MAX_PINS", "MAX_URL_LENGTH", "Opened", "check_length", "decode", "encode"]

MAX_URL_LENGTH = 60_000  # Characters of an address that the server and all browsers take.
MAX_PINS = 6  # Pinned contacts of a page.

# Keys of an address beside the inputs, tables and pins, and what reads them.
OTHERS: dict[str, Callable[[str], Any]] = {
    "definition": check_definition,
    "abscissa": lambda text: checked_word("abscissa", text, get_args(Abscissa)),
    "rtol": lambda text: check_rtol(read_number("rtol", text)),
    "title": str,
}


@dataclass(frozen=True)
class Opened:
    """What an address asks for."""

    inputs: Inputs  # The inputs; where the address is wrong, those that it should have changed
    pins: tuple[Inputs, ...]  # The pinned contacts, with their names as titles
    problems: dict[str, tuple[str, str]]  # What is wrong: for each key the text received and the sentence about it


def encode(inputs: Inputs, pins: Sequence[Inputs] = ()) -> str:
    """Return the query string, without question mark, that :func:`decode` reads back to the same values."""
    # Empty ones too: whoever opens the link may have started with a case that has them.
    items = [("tables", inputs.tables), ("title", inputs.title)]
    items += [(name, exact_text(inputs, name)) for name in inputs.fields]
    items += [("definition", inputs.definition), ("abscissa", inputs.abscissa), ("rtol", repr(inputs.rtol))]
    items += [("pin", encode(pin)) for pin in pins]
    return urlencode(items, safe=",:/*", quote_via=quote)


def check_length(inputs: Inputs, pins: Sequence[Inputs] = ()) -> None:
    """Refuse what no address can hold."""
    length = len(encode(inputs, pins))
    if length > MAX_URL_LENGTH:
        parts = {"the title": inputs.title, "the contact law and other tables": inputs.tables}
        parts["the pinned curves"] = "".join(pin.tables for pin in pins)
        most = max(parts, key=lambda name: len(parts[name]))
        raise InputError(
            f"the address of this state would have {length} characters, but at most {MAX_URL_LENGTH} are "
            f"possible; most come from {most}. "
            "Shorten them: a contact law or spectrum needs some hundred rows at most."
        )


def decode(items: Iterable[tuple[str, str]], start: Inputs) -> Opened:
    """Return what a query string asks for, beginning with ``start``."""
    given = list(items)
    problems: dict[str, tuple[str, str]] = {}
    pins: list[Inputs] = []
    numbers: dict[str, Any] = {}
    inputs, tables = start, dict(given).get("tables", start.tables)
    try:
        if geometry_of(tables) != start.table.geometry:
            inputs = with_tables(start, json_text({"geometry": geometry_of(tables)}))
    except InputError as problem:
        problems["tables"], tables = (tables, str(problem)), start.tables
    for key, text in given:
        try:
            if key in NAMES:
                if key not in inputs.fields:
                    raise InputError(f"{key} = {show(text)}: {inputs.table.contact} has no such input.")
                numbers[key], unit = read_field(inputs, key, text)
                inputs = replace(inputs, units={**inputs.units, key: unit}) if unit else inputs
            elif key == "pin":
                pins.append(_pin(text, start))
            elif key in OTHERS:
                changed: dict[str, Any] = {key: OTHERS[key](text)}
                inputs = replace(inputs, **changed)
            elif key != "tables":
                known = ", ".join([*NAMES, *OTHERS, "tables", "pin"])
                raise InputError(f"{show(key)[1:-1]} = {show(text)} is not a known key; known are {known}.")
        except InputError as problem:
            problems[key] = (text, str(problem))
    try:
        # All together: some alone may not go with what the start has.
        inputs = with_tables(inputs, tables, **numbers) if numbers or tables != inputs.tables else inputs
    except InputError as problem:
        problems["state" if tables == start.tables else "tables"] = (tables, str(problem))
    return Opened(inputs, tuple(pins[:MAX_PINS]), problems)


def _pin(text: str, start: Inputs) -> Inputs:
    """Return a pinned contact, which is the address of a state within that of the page."""
    found = decode(((key, value) for key, value in parse_qsl(text, keep_blank_values=True) if key != "pin"), start)
    for _, sentence in found.problems.values():
        raise InputError(f"in pin, {sentence}")
    return found.inputs
