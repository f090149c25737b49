"""The state of a tab as the query string of its address, and back: what is sent to somebody else opens as it was left."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, get_args
from urllib.parse import urlencode

from stribeck.contacts.friction import Definition, check_definition
from stribeck.contacts.line import LineContact
from stribeck.explorer.inputs import FIELDS, Abscissa, Inputs, exact_text, typed
from stribeck.quantities.units import InputError, show

__all__ = ["Opened", "Pin", "decode", "encode"]

SEPARATOR = "~"
LONGEST_TITLE = 80
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
    """

    name: str
    contact: LineContact
    definition: Definition


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
    items += [("definition", inputs.definition), ("abscissa", inputs.abscissa)]
    if inputs.title:
        items.append(("title", inputs.title))
    for pin in pins:
        values = [repr(float(getattr(pin.contact, name))) for name in FIELDS]
        items.append(("pin", SEPARATOR.join([*values, pin.definition, pin.name])))
    return urlencode(items)


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
    inputs, pins = start, []
    problems: dict[str, tuple[str, str]] = {}
    for key, text in items:
        try:
            if key == "pin":
                pins.append(_pin(text))
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
        return replace(inputs, title=" ".join(text.split())[:LONGEST_TITLE])
    known = ", ".join([*FIELDS, "definition", "abscissa", "title", "pin"])
    raise InputError(f"{show(key)[1:-1]} = {show(text)} is not a known key; known are {known}.")


def _abscissa(text: str) -> Abscissa:
    for known in get_args(Abscissa):
        if text == known:
            return known  # type: ignore[no-any-return]
    raise InputError(f"abscissa = {show(text)}; it must be 'speed' or 'hersey'.")


def _pin(text: str) -> Pin:
    *values, definition, name = text.split(SEPARATOR, len(FIELDS) + 1)
    if len(values) != len(FIELDS):
        raise InputError(f"pin = {show(text)} must hold {len(FIELDS)} numbers, the definition and a name.")
    numbers: dict[str, Any] = {}
    for key, value in zip(FIELDS, values, strict=True):
        try:
            numbers[key] = float(value)
        except ValueError:
            raise InputError(f"in pin, {key} = {show(value)} is not a number.") from None
    return Pin(" ".join(name.split())[:LONGEST_TITLE], LineContact(**numbers), check_definition(definition))
