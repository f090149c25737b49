"""What a page holds beside its numbers: the other tables of a case, as JSON, which compares by value and goes into links.

They are ``geometry``, ``law`` with its ``surface`` or ``table``, ``fluid``, ``cavitation``, ``motion``, ``flow_factors`` and
``solid``, and ``curve``, ``fit``, ``check``, ``notes`` and ``errors`` (relative, by input), which the page carries along.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from stribeck.cases.case import Case
from stribeck.cases.law import SOURCES, self_contained
from stribeck.cases.model_parts import FLUID_KINDS, PART_TABLES, preset_facts
from stribeck.cases.reading import check_case
from stribeck.contacts.contact import Contact
from stribeck.contacts.geometries import INPUT_TABLES, check_geometry
from stribeck.contacts.part_inputs import PART_INPUTS
from stribeck.fluids.description import Fluid
from stribeck.quantities.schema import numbers_of
from stribeck.quantities.units import InputError, show

__all__ = ["case_of", "contact_of", "fluid_table", "geometry_of", "json_text", "tables_of", "tables_of_case"]

MODEL_TABLES = ("geometry", "law", "surface", "table", *PART_TABLES)  # Tables and keys of a case that make its model
CARRIED_TABLES = ("curve", "fit", "check", "notes", "errors")  # Tables of a case that the page only carries along
MAX_ERROR = 3.0  # Largest relative error of an input


def tables_of_case(case: Case) -> str:
    """Return the tables of a case, with the numbers of files and of presets that it names."""
    found: dict[str, Any] = self_contained(case.law, case.tables, case.path.parent, case.contact.law)
    if case.law != "exponential" or found:
        found["law"] = case.law
    geometry = case.contact.groups.geometry
    if geometry != "line":
        found["geometry"] = geometry
    for name in PART_TABLES:
        # Of a ball the motion is one of its inputs.
        if name in case.tables and (name, geometry) != ("motion", "point"):
            found[name] = fluid_table(case.contact.fluid) if "preset" in case.tables[name] else case.tables[name]
    if geometry == "line" and "slide_to_roll" in case.tables["contact"]:
        found["motion"] = {"slide_to_roll": case.tables["contact"]["slide_to_roll"]}
    found |= {key: case.tables[key] for key in CARRIED_TABLES if key in case.tables}
    known = preset_facts(case.tables)  # the page keeps the viscosity of a preset, not its name
    if known:
        found["check"] = {**known, **found.get("check", {})}
    found["errors"] = {name: error for name, error in case.errors.items() if name not in PART_INPUTS}
    return json_text({name: value for name, value in found.items() if value not in ({}, "")})


def fluid_table(fluid: Fluid) -> dict[str, Any]:
    """Return a fluid as the table ``[fluid]``, with its numbers in SI units; empty for one that is always the same."""
    found: dict[str, Any] = {}
    for name, kind in FLUID_KINDS.items():
        law = getattr(fluid, name)
        if law is not None:
            found |= {kind.key: law.name} | {each: getattr(law, each) for each in numbers_of(type(law))}
    return found


def tables_of(text: str) -> dict[str, Any]:
    """Return tables, which the caller may change; refuse what no page holds."""
    if not text:
        return {}

    def refuse(_: str) -> Any:
        raise ValueError

    try:
        found = json.loads(text, parse_constant=refuse)
    except (ValueError, RecursionError):
        raise InputError(f"tables = {show(text)} is not valid JSON.") from None
    known = (*MODEL_TABLES, *CARRIED_TABLES)
    if not isinstance(found, dict) or not set(found) <= set(known):
        raise InputError(f"tables = {show(text)} must be an object of {', '.join(known)}.")
    return found


def geometry_of(text: str) -> Any:
    """Return the geometry of tables, ``"line"`` or ``"point"``."""
    return check_geometry(tables_of(text).get("geometry", "line"))


@functools.lru_cache(maxsize=32)
def case_of(text: str) -> Case:
    """Return the case of these tables with typical numbers: it has the same contact law, parts, facts and errors."""
    tables = tables_of(text)
    geometry, errors = check_geometry(tables.pop("geometry", "line")), tables.pop("errors", {})
    if not isinstance(errors, dict) or not all(isinstance(each, float) and 0 < each <= MAX_ERROR for each in errors.values()):
        raise InputError(f"errors = {show(errors)} are no relative errors of inputs.")
    for name, source in SOURCES.items():
        if isinstance(tables.get(name), dict) and source.file in tables[name]:
            raise InputError(f"[{name}] names the file {show(tables[name][source.file])}; a link contains its rows instead.")
    if isinstance(tables.get("surface"), dict):
        tables["surface"] = {**tables["surface"], "shape_only": True}
    numbers = {name: row.typical_value for name, row in INPUT_TABLES[geometry].kept.items() if not row.optional}
    contact = {"geometry": geometry, **numbers, "alpha": 1.0, "law": tables.pop("law", "exponential")}
    found = check_case({"contact": contact, **tables}, Path("tables"))
    return replace(found, errors={**found.errors, **errors})


def contact_of(text: str, numbers: Mapping[str, Any]) -> Contact:
    """Return the contact of these tables and numbers; others are left out."""
    like = case_of(text).contact
    given = {name: numbers[name] for name in like.INPUTS.names if name in numbers}
    return like.of_kept({**like.part_values(), **given}, like.law)


def json_text(value: Any) -> str:
    """Return an object as compact JSON; empty for an empty one."""
    return "" if not value else json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
