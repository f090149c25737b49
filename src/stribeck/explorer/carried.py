"""What a case holds beside its numbers: its contact law, and what the page carries along for the saved case.

Both are kept as compact JSON, which goes into a link as it is and compares by value.
"""

from __future__ import annotations

import functools
import json
import re
from pathlib import Path
from typing import Any

from stribeck.cases.case import Case, check_case
from stribeck.cases.law import self_contained
from stribeck.contact_laws.law import AsperityLaw
from stribeck.quantities.inputs import INPUTS
from stribeck.quantities.units import InputError, show

__all__ = ["check_rest", "law_of_case", "law_words", "rest_of_case", "shape_of", "toml_text"]

LAW_NAMES = {
    "exponential": "exponential",
    "persson": "Persson",
    "greenwood-williamson": "Greenwood and Williamson",
    "greenwood-tripp": "Greenwood and Tripp",
    "table": "a table",
}

REST = ("curve", "fit", "notes")
"""Tables and keys of a case that the page carries along."""

_NUMBERS = dict.fromkeys(INPUTS, 1.0)
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def law_of_case(case: Case) -> str:
    """Return the contact law of a case as JSON: its name, and its table with the numbers of the file that it names.

    Parameters
    ----------
    case : Case
        The case.

    Returns
    -------
    str
        JSON; empty for the exponential law of alpha and beta alone.

    Raises
    ------
    InputError
        If the file of a spectrum cannot be read.
    """
    tables = self_contained(case.law, case.tables, case.path.parent, case.contact.law)
    return "" if case.law == "exponential" and not tables else _json({"law": case.law, **tables})


def rest_of_case(case: Case) -> str:
    """Return as JSON what a case holds that the page does not show; empty where there is nothing."""
    found = {key: case.tables[key] for key in REST if case.tables.get(key)}
    return _json(found) if found else ""


@functools.lru_cache(maxsize=32)
def shape_of(text: str) -> AsperityLaw | None:
    """Return the contact law of its JSON; the same object for the same text.

    Parameters
    ----------
    text : str
        What :func:`law_of_case` returns.

    Returns
    -------
    AsperityLaw or None
        The law; None for the exponential law of alpha and beta alone.

    Raises
    ------
    InputError
        If the text is no such law.
    """
    if not text:
        return None
    tables = _object("law", text, ("law", "surface", "table"))
    if isinstance(tables.get("surface"), dict):
        tables["surface"] = _without_files("law", tables["surface"], "spectrum") | {"shape_only": True}
    if isinstance(tables.get("table"), dict):
        _without_files("law", tables["table"], "file")
    contact = {**_NUMBERS, "law": tables.pop("law", "exponential")}
    return check_case({"contact": contact, **tables}, Path("law")).contact.law


def check_rest(text: str) -> str:
    """Return what a page carries along, in the form of :func:`rest_of_case`; refuse what no case can hold."""
    if not text:
        return ""
    found = _object("rest", text, REST)
    check_case({"contact": _NUMBERS, **found}, Path("rest"))
    return _json(found) if found else ""


def law_words(text: str) -> str:
    """Return the name of a contact law, and what its shape comes from."""
    law: dict[str, Any] = json.loads(text) if text else {"law": "exponential"}
    name = LAW_NAMES[law["law"]]
    if "table" in law:
        return f"{name} of {len(law['table']['separation'])} rows"
    surface = law.get("surface")
    if surface is None:
        return name
    if "wavenumber" in surface:
        return f"{name}, for a spectrum of {len(surface['wavenumber'])} rows"
    values = ", ".join(f"{key.replace('_', ' ')} {value}" for key, value in surface.items())
    return f"{name}, for the surface with {values}"


def toml_text(tables: dict[str, Any], path: tuple[str, ...] = ()) -> str:
    """Return tables as TOML.

    Parameters
    ----------
    tables : dict
        Values and tables of values.
    path : tuple of str
        Names of the tables around them.

    Returns
    -------
    str
        Lines, each with its end.
    """
    values = {key: value for key, value in tables.items() if not isinstance(value, dict)}
    lines = [f"\n[{'.'.join(map(_key, path))}]\n"] if path and (values or not tables) else []
    lines += [f"{_key(key)} = {_value(value)}\n" for key, value in values.items()]
    lines += [toml_text(value, (*path, key)) for key, value in tables.items() if isinstance(value, dict)]
    return "".join(lines)


def _key(name: str) -> str:
    return name if _BARE_KEY.fullmatch(name) else _value(name)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{_key(key)} = {_value(each)}' for key, each in value.items())} }}"
    return repr(value)


def _without_files(name: str, entries: dict[str, Any], key: str) -> dict[str, Any]:
    """Return entries; refuse the name of a file, which a link from elsewhere must not open."""
    if key in entries:
        raise InputError(f"{name} names the file {show(entries[key])}; a link contains its rows instead.")
    return entries


def _object(name: str, text: str, known: tuple[str, ...]) -> dict[str, Any]:
    def refuse(_: str) -> Any:
        raise ValueError

    try:
        found = json.loads(text, parse_constant=refuse)
    except (ValueError, RecursionError):
        raise InputError(f"{name} = {show(text)} is not valid JSON.") from None
    if not isinstance(found, dict) or not set(found) <= set(known):
        raise InputError(f"{name} = {show(text)} must be an object of {', '.join(known)}.")
    return found


def _json(value: Any) -> str:
    return json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
