"""The parts of a case beside its numbers: its model, and what the page keeps for the saved case.

Both are kept as compact JSON, which goes into a link as it is and compares by value.  The model is the tables of a case:
``geometry``, ``law`` with its ``surface`` or ``table``, ``fluid``, ``cavitation``, ``motion``, ``flow_factors``, ``solid``.
"""

from __future__ import annotations

import functools
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stribeck.cases.case import Case
from stribeck.cases.law import LAWS, self_contained
from stribeck.cases.model_parts import FLUID_KINDS, KEYS, preset_facts, take_parts
from stribeck.cases.reading import check_case
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact
from stribeck.contacts.geometries import CONTACTS, check_geometry
from stribeck.contacts.part_inputs import PART_INPUTS, PART_LETTERS
from stribeck.fluids.description import Fluid
from stribeck.quantities.facts import FACTS, fact_values
from stribeck.quantities.inputs import INPUT_TABLES
from stribeck.quantities.schema import numbers_of
from stribeck.quantities.uncertain import has_error, split_error
from stribeck.quantities.units import InputError, show

__all__ = [
    "check_rest",
    "contact_of",
    "errors_of",
    "facts_of",
    "fluid_table",
    "geometry_of",
    "json_text",
    "law_text",
    "model_changes",
    "model_of_case",
    "model_lines",
    "rest_of_case",
    "shape_of",
    "tables_of",
    "toml_text",
]

LAW_NAMES = {law: " and ".join(map(str.capitalize, law.split("-"))) for law in LAWS}

LAW_TABLES = ("law", "surface", "table")
MODEL_TABLES = ("geometry", *LAW_TABLES, *KEYS)  # Tables and keys of a case that make its model.
CARRIED_TABLES = ("curve", "fit", "check", "notes", "errors")  # Tables of a case that the page only carries along.

_NUMBERS = dict.fromkeys(INPUT_TABLES["line"].names, 1.0)
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def model_of_case(case: Case) -> str:
    """Return the model of a case as JSON: its parts by name, with the numbers of files and of presets that it names."""
    found: dict[str, Any] = self_contained(case.law, case.tables, case.path.parent, case.contact.law)
    if case.law != "exponential" or found:
        found["law"] = case.law
    if case.contact.groups.geometry != "line":
        found["geometry"] = case.contact.groups.geometry
    for name in KEYS:
        # Of a ball the motion is one of its inputs.
        if name in case.tables and (name, case.contact.groups.geometry) != ("motion", "point"):
            given = {key: _without_error(key, value) for key, value in case.tables[name].items()}
            found[name] = fluid_table(case.contact.fluid) if "preset" in given else given
    if case.contact.groups.geometry == "line" and "slide_to_roll" in case.tables["contact"]:
        found["motion"] = {"slide_to_roll": case.tables["contact"]["slide_to_roll"]}
    return json_text({name: value for name, value in found.items() if value != {}})


def _without_error(key: str, value: Any) -> Any:
    """Return a number of a law without the error that a case gives it."""
    row = PART_INPUTS.get(PART_LETTERS.get(key, key))
    return value if row is None or not has_error(value) else split_error(key, value, row.dimension, row.typical)[0]


def tables_of(model: str) -> dict[str, Any]:
    """Return the tables of a model, which the caller may change."""
    return json.loads(model) if model else {}


def geometry_of(model: str) -> Any:
    """Return the geometry of a model, ``"line"`` or ``"point"``."""
    return check_geometry(_object("model", model, MODEL_TABLES).get("geometry", "line")) if model else "line"


def fluid_table(fluid: Fluid) -> dict[str, Any]:
    """Return a fluid as the table ``[fluid]``, with its numbers in SI units; empty for one that is always the same."""
    found: dict[str, Any] = {}
    for name, kind in FLUID_KINDS.items():
        law = getattr(fluid, name)
        if law is not None:
            found |= {kind.key: law.name} | {each: getattr(law, each) for each in numbers_of(type(law))}
    return found


def contact_of(model: str, numbers: Mapping[str, Any]) -> Contact:
    """Return the contact of a model and of its numbers."""
    shape = shape_of(model)
    tables = _object("model", model, MODEL_TABLES) if model else {}
    geometry = check_geometry(tables.get("geometry", "line"))
    _, parts, problems = take_parts({name: tables[name] for name in KEYS if name in tables}, geometry)
    if problems:
        raise InputError("\n".join(problems))
    table = INPUT_TABLES[geometry]
    given = {name: value for name, value in numbers.items() if name in table.names}
    return CONTACTS[geometry].of_kept({**given, **parts}, shape)


def rest_of_case(case: Case) -> str:
    """Return as JSON what the page does not show of a case; empty if there is nothing."""
    found = {key: case.tables[key] for key in CARRIED_TABLES if case.tables.get(key)}
    known = preset_facts(case.tables)  # the page keeps the viscosity of a preset, not its name
    if known:
        found["check"] = {**known, **found.get("check", {})}
    return json_text(found | ({"errors": case.errors} if case.errors else {}))


def shape_of(model: str) -> AsperityLaw | None:
    """Return the contact law of a model; the same object for the same law."""
    if not model:
        return None
    tables = _object("model", model, MODEL_TABLES)
    return _shape(json_text({name: tables[name] for name in LAW_TABLES if name in tables}))


@functools.lru_cache(maxsize=32)
def _shape(text: str) -> AsperityLaw | None:
    tables = json.loads(text) if text else {}
    if isinstance(tables.get("surface"), dict):
        tables["surface"] = _without_files("model", tables["surface"], "spectrum") | {"shape_only": True}
    if isinstance(tables.get("table"), dict):
        _without_files("model", tables["table"], "file")
    contact = {**_NUMBERS, "law": tables.pop("law", "exponential")}
    return check_case({"contact": contact, **tables}, Path("model")).contact.law


def check_rest(text: str) -> str:
    """Return what a page keeps for the saved case, in the form of :func:`rest_of_case`; refuse what no case can hold."""
    if not text:
        return ""
    found = _object("rest", text, CARRIED_TABLES)
    errors = found.get("errors", {})
    if not isinstance(errors, dict) or not all(isinstance(each, float) and 0 < each <= 3 for each in errors.values()):
        raise InputError(f"rest holds errors = {show(errors)}, which are no relative errors of inputs.")
    check_case({"contact": _NUMBERS, **{key: value for key, value in found.items() if key != "errors"}}, Path("rest"))
    return json_text(found)


@functools.lru_cache(maxsize=32)
def facts_of(rest: str) -> dict[str, float]:
    """Return the facts of the table ``[check]`` in what the page carries along, in SI units."""
    given = json.loads(rest).get("check", {}) if rest else {}
    return fact_values({name: value for name, value in given.items() if name in FACTS})


def errors_of(rest: str) -> dict[str, float]:
    """Return the relative standard errors of inputs in what the page carries along."""
    return json.loads(rest).get("errors", {}) if rest else {}


def law_text(model: str) -> str:
    """Return the name of the contact law, and what its shape comes from."""
    tables = tables_of(model)
    name = LAW_NAMES[tables.get("law", "exponential")]
    if "table" in tables:
        return f"{name} of {len(tables['table']['separation'])} rows"
    surface = tables.get("surface")
    if surface is None:
        return name
    if "wavenumber" in surface:
        return f"{name}, for a spectrum of {len(surface['wavenumber'])} rows"
    values = ", ".join(f"{key.replace('_', ' ')} {value}" for key, value in surface.items() if key != "h_rms")
    return f"{name}, for the surface with {values}"


def model_lines(model: str) -> list[str]:
    """Return a line for each part of the model that differs from the article's."""
    tables = tables_of(model)
    lines = [f"contact law: {law_text(model)}"]
    for name in KEYS:
        if name in tables:
            values = ", ".join(f"{key.replace('_', ' ')} {value}" for key, value in tables[name].items())
            lines.append(f"{name.replace('_', ' ')}: {values}")
    return lines


def model_changes(model: str, start: str) -> list[str]:
    """Return in words the parts in which a model differs from another."""
    one, two = tables_of(model), tables_of(start)
    found = []
    for name in MODEL_TABLES:
        if name not in ("surface", "table") and one.get(name) != two.get(name):
            value = one.get(name, "none")
            if isinstance(value, dict):
                value = " ".join(str(each) for each in value.values())
            found.append({"point": "ball", "line": "cylinder"}.get(value, f"{name.replace('_', ' ')} {value}"))
    return found


def toml_text(tables: dict[str, Any], path: tuple[str, ...] = ()) -> str:
    """Return tables as TOML."""
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


def json_text(value: Any) -> str:
    """Return an object as compact JSON; empty for an empty one."""
    return "" if not value else json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
