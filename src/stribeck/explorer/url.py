"""The state of a tab as the query string of its address, and back: what is sent to somebody else opens as it was left."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, get_args
from urllib.parse import quote, urlencode

from stribeck.contacts.friction import Definition, check_definition
from stribeck.contacts.line import LineContact
from stribeck.explorer.carried import check_rest, shape_of
from stribeck.explorer.inputs import FIELDS, Abscissa, Inputs, exact_text, typed
from stribeck.quantities.units import InputError, read_number, show
from stribeck.solver.solve import check_rtol

__all__ = ["Opened", "Pin", "check_length", "decode", "encode"]

SEPARATOR = "~"
LONGEST = 60_000
"""Characters of an address that the server and all browsers take."""

MOST_PINS = 6


@dataclass(frozen=True)
class Pin:
    """A curve that was kept for comparison.

    Attributes
    ----------
    name : str
        What it is called.
    contact : LineContact
        Its contact.
    definition : {"balanced", "published"}
        Its friction.
    law : str
        Its contact law, as in :mod:`stribeck.explorer.carried`.
    """

    name: str
    contact: LineContact
    definition: Definition
    law: str = ""


@dataclass(frozen=True)
class Opened:
    """What an address asks for.

    Attributes
    ----------
    inputs : Inputs
        The inputs; where the address is wrong, those that it should have changed.
    pins : tuple of Pin
        The pinned curves.
    problems : dict of str to tuple of str
        What is wrong: for each key the text received and the sentence about it.
    """

    inputs: Inputs
    pins: tuple[Pin, ...]
    problems: dict[str, tuple[str, str]]


def encode(inputs: Inputs, pins: Sequence[Pin] = ()) -> str:
    """Return the query string, without question mark, that :func:`decode` reads back to the same values.

    Parameters
    ----------
    inputs : Inputs
        What is shown.
    pins : sequence of Pin
        The pinned curves.

    Returns
    -------
    str
        The keys of a case file with their values, ``definition``, ``abscissa``, ``title`` and a ``pin`` for each pinned curve.
    """
    items = [(name, exact_text(inputs, name)) for name in FIELDS]
    items += [("definition", inputs.definition), ("abscissa", inputs.abscissa), ("rtol", repr(inputs.rtol))]
    # Empty ones too: whoever opens the link may have started with a case that has them.
    items += [(name, getattr(inputs, name)) for name in ("title", "law", "rest")]
    laws = list(dict.fromkeys(pin.law for pin in pins if pin.law))
    items += [("pinlaw", law) for law in laws]
    for pin in pins:
        values = [repr(float(getattr(pin.contact, name))) for name in FIELDS]
        law = f"@{laws.index(pin.law)}" if pin.law else ""
        items.append(("pin", SEPARATOR.join([*values, pin.definition + law, pin.name])))
    return urlencode(items, safe=",:/*", quote_via=quote)


def check_length(inputs: Inputs, pins: Sequence[Pin] = ()) -> None:
    """Refuse what no address can hold.

    Parameters
    ----------
    inputs : Inputs
        What would be shown.
    pins : sequence of Pin
        The pinned curves.

    Raises
    ------
    InputError
        If its address would be longer than browsers take.
    """
    length = len(encode(inputs, pins))
    if length > LONGEST:
        parts = {"the title": inputs.title, "the contact law": inputs.law, "notes and [fit]": inputs.rest}
        parts["the pinned curves"] = "".join(pin.law for pin in pins)
        most = max(parts, key=lambda name: len(parts[name]))
        raise InputError(
            f"the address of this state would have {length} characters, but at most {LONGEST} are "
            f"possible; most come from {most}. "
            "Shorten them: a contact law or spectrum needs some hundred rows at most."
        )


def decode(items: Iterable[tuple[str, str]], start: Inputs) -> Opened:
    """Return what a query string asks for, beginning with ``start``.

    Parameters
    ----------
    items : iterable of (str, str)
        Keys and values, unquoted.
    start : Inputs
        What holds where nothing is said.

    Returns
    -------
    Opened
        Inputs, pins, and a sentence for each value that cannot be used.
    """
    inputs, pins, laws = start, [], []
    problems: dict[str, tuple[str, str]] = {}
    for key, text in items:
        try:
            if key == "pinlaw":
                shape_of(text)
                laws.append(text)
            elif key == "pin":
                pins.append(_pin(text, laws))
            else:
                inputs = _changed(inputs, key, text)
        except InputError as problem:
            problems[key] = (text, str(problem))
    return Opened(inputs, tuple(pins[:MOST_PINS]), problems)


def _changed(inputs: Inputs, key: str, text: str) -> Inputs:
    if key in FIELDS:
        return typed(inputs, key, text)
    if key == "definition":
        return replace(inputs, definition=check_definition(text))
    if key == "abscissa":
        return replace(inputs, abscissa=_abscissa(text))
    if key == "title":
        return replace(inputs, title=text)
    if key == "law":
        return replace(inputs, contact=inputs.contact.replace(law=shape_of(text)), law=text)
    if key == "rest":
        return replace(inputs, rest=check_rest(text))
    if key == "rtol":
        rtol = read_number("rtol", text)
        check_rtol(rtol)
        return replace(inputs, rtol=rtol)
    known = ", ".join([*FIELDS, "definition", "abscissa", "rtol", "title", "law", "rest", "pinlaw", "pin"])
    raise InputError(f"{show(key)[1:-1]} = {show(text)} is not a known key; known are {known}.")


def _abscissa(text: str) -> Abscissa:
    for known in get_args(Abscissa):
        if text == known:
            return known  # type: ignore[no-any-return]
    raise InputError(f"abscissa = {show(text)}; it must be 'speed' or 'hersey'.")


def _pin(text: str, laws: Sequence[str]) -> Pin:
    parts = text.split(SEPARATOR, len(FIELDS) + 1)
    if len(parts) != len(FIELDS) + 2:
        raise InputError(f"pin = {show(text)} must hold {len(FIELDS)} numbers, the definition and a name.")
    *values, kind, name = parts
    numbers: dict[str, Any] = {}
    for key, value in zip(FIELDS, values, strict=True):
        try:
            numbers[key] = float(value)
        except ValueError:
            raise InputError(f"in pin, {key} = {show(value)} is not a number.") from None
    definition, mark, number = kind.partition("@")
    if mark and number not in map(str, range(len(laws))):
        raise InputError(f"in pin, {show(kind)} names a contact law that the address does not contain.")
    law = laws[int(number)] if mark else ""
    return Pin(name, LineContact(**numbers, law=shape_of(law)), check_definition(definition), law)
