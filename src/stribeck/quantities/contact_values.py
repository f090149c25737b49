"""The inputs that a contact keeps, from those that were given: alternatives, and what is wrong."""

from __future__ import annotations

import difflib
import inspect
from collections.abc import Mapping
from typing import Any

from stribeck.quantities.inputs import LINE, InputTable, quantity
from stribeck.quantities.units import InputError, show

__all__ = ["check_alternatives", "contact_values", "replace_inputs", "signature_of"]


def contact_values(given: Mapping[str, Any], table: InputTable = LINE) -> dict[str, float | None]:
    """Return the inputs that a contact keeps, in SI units, from those that were given."""
    values = {name: value for name, value in given.items() if value is not None or name not in table.choices}
    for name in values:
        if name not in table.quantities:
            near = difflib.get_close_matches(name, table.quantities, n=1)
            known = f"did you mean {near[0]}?" if near else f"known are {', '.join(table.quantities)}."
            raise InputError(f"{name} = {show(values[name])} is not an input of {table.contact}; {known}")
    check_alternatives(values, table)
    for other in table.alternatives:
        if other.of not in values:
            used = (*other.inputs, *(name for name in other.other if name in values))
            values[other.of] = other.value(*(quantity(name, values.pop(name), table) for name in used))
    if "radius_2" in values and "radius" in values:
        R, R_2 = (quantity(name, values.pop(name), table) for name in ("radius", "radius_2"))
        values["radius"] = 1 / (1 / R + 1 / R_2)
    found: dict[str, float | None] = {row.name: row.default for row in table.rows if row.optional and not row.derived}
    missing = [name for name in table.names if name not in values and name not in found]
    if missing:
        needed = (name for name in table.names if name not in found)
        raise InputError(f"{', '.join(missing)} missing; a contact needs {', '.join(needed)}.")
    return {name: quantity(name, values[name], table) if name in values else found[name] for name in table.names}


def signature_of(table: InputTable) -> inspect.Signature:
    """Return the signature of a contact that takes the inputs of a table, and a contact law."""
    keyword = inspect.Parameter.KEYWORD_ONLY
    default = {row.name: row.default for row in table.rows if row.name in table.choices}
    inputs = [
        inspect.Parameter(row.name, keyword, default=default.get(row.name, inspect.Parameter.empty)) for row in table.rows
    ]
    return inspect.Signature([*inputs, inspect.Parameter("law", keyword, default=None)])


def check_alternatives(given: Mapping[str, Any], table: InputTable = LINE) -> None:
    """Check that an input with alternatives is given once: by itself, or by all of those that stand for it."""
    for other in table.alternatives:
        values = {name: given.get(name) for name in other.inputs}
        second = {name: given[name] for name in other.other if given.get(name) is not None}
        there = [f"{name} = {show(value)}" for name, value in (values | second).items() if value is not None]
        missing = [name for name, value in values.items() if value is None]
        kept, instead = given.get(other.of), " and ".join(other.inputs)
        if kept is not None and there:
            raise InputError(
                f"{other.of} = {show(kept)} ({other.meaning}) and {' and '.join(there)} are given; "
                f"give either {other.of}, or {instead}."
            )
        if kept is None and not there:
            together = " together" if len(other.inputs) > 1 else ""
            raise InputError(f"{other.of} ({other.meaning}) is missing; give it, or {instead}{together}.")
        if kept is None and not missing and 0 < len(second) < len(other.other):
            raise InputError(
                f"of the other body {' and '.join(second)} alone is given; give {' and '.join(other.other)}, or none."
            )
        if kept is None and missing:
            typical = f" {other.hint}" if missing == [other.inputs[-1]] else ""
            raise InputError(
                f"{missing[0]} is missing beside {there[0]}; give both, or {other.of} ({other.meaning}) alone.{typical}"
            )


def replace_inputs(kept: Mapping[str, Any], changes: Mapping[str, Any], table: InputTable = LINE) -> dict[str, Any]:
    """Return inputs with some changed; an alternative among the changes takes the place of what it stands for."""
    found = dict(kept)
    if "radius_2" in changes and "radius" not in changes:
        raise InputError("radius_2 is given without radius; give both radii, as a contact keeps only their combination.")
    for other in table.alternatives:
        if any(name in changes for name in other.inputs):
            del found[other.of]
    return found | dict(changes)
