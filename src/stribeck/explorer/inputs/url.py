"""The state of a tab as the query string of its address, and back: a shared link opens the same state."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, get_args
from urllib.parse import quote, urlencode

from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import DEFINITIONS, Definition, check_definition
from stribeck.explorer.inputs.carried import check_rest, contact_of, geometry_of, json_text
from stribeck.explorer.inputs.inputs import FIELDS, NAMES, Abscissa, Inputs, exact_text, read_field, with_model
from stribeck.quantities.units import InputError, read_number, show
from stribeck.solver.solve import check_rtol

__all__ = ["Opened", "Pin", "check_length", "decode", "encode"]

SEPARATOR = "~"
MAX_URL_LENGTH = 60_000  # Characters of an address that the server and all browsers take.

MAX_PINS = 6  # Pinned contacts of a page.


@dataclass(frozen=True)
class Pin:
    """A curve that was kept for comparison."""

    name: str  # What it is called
    contact: Contact  # Its contact
    definition: Definition  # Its friction
    model: str = ""  # Its model, as in :mod:`stribeck.explorer.inputs.carried`


@dataclass(frozen=True)
class Opened:
    """What an address asks for."""

    inputs: Inputs  # The inputs; where the address is wrong, those that it should have changed
    pins: tuple[Pin, ...]  # The pinned curves
    problems: dict[str, tuple[str, str]]  # What is wrong: for each key the text received and the sentence about it


def encode(inputs: Inputs, pins: Sequence[Pin] = ()) -> str:
    """Return the query string, without question mark, that :func:`decode` reads back to the same values."""
    # Empty ones too: whoever opens the link may have started with a case that has them.
    items = [(name, getattr(inputs, name)) for name in ("model", "title", "rest")]
    items += [(name, exact_text(inputs, name)) for name in inputs.fields]
    items += [("definition", inputs.definition), ("abscissa", inputs.abscissa), ("rtol", repr(inputs.rtol))]
    models = list(dict.fromkeys(pin.model for pin in pins if pin.model))
    items += [("pinmodel", model) for model in models]
    for pin in pins:
        values = [getattr(pin.contact, name) for name in FIELDS[pin.contact.INPUTS.geometry]]
        texts = ["" if value is None else repr(float(value)) for value in values]
        model = f"@{models.index(pin.model)}" if pin.model else ""
        items.append(("pin", SEPARATOR.join([*texts, pin.definition + model, pin.name])))
    return urlencode(items, safe=",:/*", quote_via=quote)


def check_length(inputs: Inputs, pins: Sequence[Pin] = ()) -> None:
    """Refuse what no address can hold."""
    length = len(encode(inputs, pins))
    if length > MAX_URL_LENGTH:
        parts = {"the title": inputs.title, "the contact law": inputs.model, "notes and [fit]": inputs.rest}
        parts["the pinned curves"] = "".join(pin.model for pin in pins)
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
    pins: list[Pin] = []
    models: list[str] = []
    numbers: dict[str, Any] = {}
    inputs, model = start, dict(given).get("model", start.model)
    try:
        if geometry_of(model) != start.table.geometry:
            inputs = with_model(start, json_text({"geometry": geometry_of(model)}))
    except InputError as problem:
        problems["model"], model = (model, str(problem)), start.model
    for key, text in given:
        try:
            if key in NAMES:
                if key not in inputs.fields:
                    raise InputError(f"{key} = {show(text)}: {inputs.table.contact} has no such input.")
                numbers[key], unit = read_field(inputs, key, text)
                inputs = replace(inputs, units={**inputs.units, key: unit}) if unit else inputs
            elif key == "pinmodel":
                geometry_of(text)
                models.append(text)
            elif key == "pin":
                pins.append(_pin(text, models))
            elif key != "model":
                inputs = _changed(inputs, key, text)
        except InputError as problem:
            problems[key] = (text, str(problem))
    try:
        # All together: some alone may not go with what the start has.
        inputs = with_model(inputs, model, **numbers) if numbers or model != inputs.model else inputs
    except InputError as problem:
        problems["state" if model == start.model else "model"] = (model, str(problem))
    return Opened(inputs, tuple(pins[:MAX_PINS]), problems)


def _changed(inputs: Inputs, key: str, text: str) -> Inputs:
    if key == "definition":
        return replace(inputs, definition=check_definition(text))
    if key == "abscissa":
        return replace(inputs, abscissa=_abscissa(text))
    if key == "title":
        return replace(inputs, title=text)
    if key == "rest":
        return replace(inputs, rest=check_rest(text))
    if key == "rtol":
        rtol = read_number("rtol", text)
        rtol = check_rtol(rtol)
        return replace(inputs, rtol=rtol)
    known = ", ".join([*NAMES, "definition", "abscissa", "rtol", "title", "model", "rest", "pinmodel", "pin"])
    raise InputError(f"{show(key)[1:-1]} = {show(text)} is not a known key; known are {known}.")


def _abscissa(text: str) -> Abscissa:
    for known in get_args(Abscissa):
        if text == known:
            return known  # type: ignore[no-any-return]
    raise InputError(f"abscissa = {show(text)}; it must be 'speed' or 'hersey'.")


def _pin(text: str, models: Sequence[str]) -> Pin:
    kind = next((part for part in text.split(SEPARATOR) if part.partition("@")[0] in DEFINITIONS), "")
    definition, mark, number = kind.partition("@")
    if mark and number not in map(str, range(len(models))):
        raise InputError(f"in pin, {show(kind)} names a model that the address does not contain.")
    model = models[int(number)] if mark else ""
    names = FIELDS[geometry_of(model)]
    parts = text.split(SEPARATOR, len(names) + 1)
    if len(parts) != len(names) + 2:
        raise InputError(f"pin = {show(text)} must hold {len(names)} numbers, the definition and a name.")
    *values, _, name = parts
    numbers: dict[str, Any] = {}
    for key, value in zip(names, values, strict=True):
        try:
            numbers[key] = float(value) if value else None
        except ValueError:
            raise InputError(f"in pin, {key} = {show(value)} is not a number.") from None
    return Pin(name, contact_of(model, numbers), check_definition(definition), model)
