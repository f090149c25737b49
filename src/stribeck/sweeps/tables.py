"""What the tables of a sweep file may hold: what stays fixed, what varies, and the sentences for what cannot be."""

import math
from collections.abc import Callable
from typing import Any, get_args

from stribeck.cases.case import Case
from stribeck.cases.hints import advice_on
from stribeck.cases.law import KEYS_OF_SURFACES, LAW_KEY
from stribeck.cases.tables import HEAD, Key, Keys, one_of, tolerance, whole
from stribeck.contacts.geometries import INPUT_TABLES
from stribeck.contacts.groups import Groups
from stribeck.contacts.inputs import InputTable, ReadInputs, apply_forms, note_missing
from stribeck.quantities.outputs import GROUPS
from stribeck.quantities.units import InputError, show
from stribeck.sweeps.points import KINDS, RANDOM_KINDS, Axis, Kind

__all__ = ["COEFFICIENTS", "axis_of", "design_problems", "keys_of_sweep", "kind_of", "missing"]

MAX_STATES = 1_000_000

COEFFICIENTS = ("boundary_friction", "beta")  # Inputs of friction beside groups


def keys_of_sweep(inputs: InputTable) -> dict[str, Keys]:
    """Return what the tables of a sweep file may have; its reader checks what varies."""
    groups = dict.fromkeys((*GROUPS, *COEFFICIENTS), Key(_group))
    return {
        "contact": {**dict.fromkeys(inputs.quantities, Key(inputs.checked)), "law": LAW_KEY},
        "groups": {**groups, "law": LAW_KEY},
        "design": {
            "kind": Key(one_of(*KINDS), "grid"),
            "points": Key(whole(1, MAX_STATES)),
            "seed": Key(whole(0, 2**63 - 1, "a whole number, zero or positive")),
        },
        "solver": {"rtol": tolerance(Case.rtol)},
        **KEYS_OF_SURFACES,
        "": HEAD,
    }


def kind_of(table: dict[str, Any]) -> Kind | None:
    """Return the kind of design that a file asks for, None if there is none such."""
    design = table.get("design", {})
    kind = design.get("kind", "grid") if isinstance(design, dict) else None
    return next((known for known in get_args(Kind) if known == kind), None)


def axis_of(name: str, entry: Any, kind: Kind, si: bool, inputs: InputTable) -> Axis:
    """Return what one entry of ``[vary]`` says."""
    known = tuple(inputs.quantities) if si else (*GROUPS, *COEFFICIENTS)
    if name not in known:
        hint = advice_on(name, known) or f"known are {', '.join(known)}"
        raise InputError(f"{show(name)} cannot vary; {hint}.")
    check: Callable[[str, Any], float] = inputs.checked if si else _group
    if isinstance(entry, list):
        if not entry:
            raise InputError(f"{name} = [] is empty; list its values.")
        return Axis(name, values=tuple(check(name, value) for value in entry))
    if kind == "list" or not isinstance(entry, dict):
        ranges = "" if kind == "list" else ", or a range as in { range = [1, 10], points = 11 }"
        raise InputError(f"{name} = {show(entry)} must be a list of values{ranges}.")
    extra = [key for key in entry if key not in ("range", "points", "spacing")]
    if extra:
        raise InputError(f"{name} has the unknown key {show(extra[0])}; known are range, points and spacing.")
    ends, spacing, points = entry.get("range"), entry.get("spacing", "log"), entry.get("points")
    if not isinstance(ends, list) or len(ends) != 2:
        raise InputError(f"{name}: range = {show(ends)} must be a list of two values, the lowest and the highest.")
    low, high = (check(name, end) for end in ends)
    if not low < high:
        raise InputError(f"{name}: range = {show(ends)} must increase; write the lowest value first.")
    if spacing not in ("log", "linear"):
        raise InputError(f"{name}: spacing = {show(spacing)} must be 'log' or 'linear'.")
    if spacing == "log" and low == 0:
        raise InputError(f"{name}: range = {show(ends)} begins at zero; add spacing = 'linear', or list the values.")
    if kind in RANDOM_KINDS:
        if points is not None:
            raise InputError(f"{name}: points = {show(points)} is for grids; with kind = '{kind}' it belongs in [design].")
        return Axis(name, low=low, high=high, spacing=spacing)
    if isinstance(points, bool) or not isinstance(points, int) or not 2 <= points <= MAX_STATES:
        raise InputError(f"{name}: points = {show(points)} must be a whole number from 2 to {MAX_STATES}.")
    return Axis(name, low=low, high=high, points=points, spacing=spacing)


def design_problems(design: dict[str, Any], axes: list[Axis]) -> list[str]:
    """Return what in ``[design]`` does not go with its kind or with the axes."""
    kind, points = design["kind"], design.get("points")
    problems = []
    if kind in RANDOM_KINDS:
        if points is None:
            problems.append(f"[design] points is missing; set how many states kind = '{kind}' draws, as in points = 256.")
        elif kind == "sobol" and points & (points - 1):
            near = 2 ** round(math.log2(points))
            problems.append(f"[design] points = {points} must be a power of two for kind = 'sobol', such as {near}.")
        return problems
    for key in ("points", "seed"):
        if key in design:
            problems.append(
                f"[design] {key} = {design[key]} is for {', '.join(RANDOM_KINDS)}; kind = '{kind}' does not use it."
            )
    sizes = {axis.name: len(axis) for axis in axes}
    if kind == "list" and len(set(sizes.values())) > 1:
        counts = ", ".join(f"{name} has {size}" for name, size in sizes.items())
        problems.append(f"[vary] the lists must have the same length with kind = 'list': {counts}.")
    states = math.prod(sizes.values()) if kind == "grid" else max(sizes.values())
    if states > MAX_STATES:
        problems.append(f"[vary] makes {states} states; at most {MAX_STATES} are possible in one sweep.")
    return problems


def missing(
    fixed: dict[str, Any], varied: dict[str, Any], si: bool, by_tables: tuple[str, ...], inputs: InputTable
) -> list[str]:
    """Return what is given twice or not at all; ``by_tables`` are the inputs that the surface gives."""
    table = "contact" if si else "groups"
    problems = []
    for name in varied:
        if name in fixed:
            problems.append(f"[{table}] {name} = {show(fixed[name])} also stands in [vary]; keep one of them.")
    given = {**fixed, **varied}
    if not si:
        return problems + [f"[groups] {name} is missing; add it there or to [vary]." for name in GROUPS if name not in given]
    found = ReadInputs({name: inputs.quantities[name].typical_value for name in given if name in inputs.quantities})
    apply_forms(found, given, inputs)
    note_missing(found, inputs, by_tables, ", or let it vary in [vary]")
    return problems + [f"[contact] {problem}" for problem in found.problems]


def _group(name: str, value: Any) -> float:
    """Return a group or a coefficient, checked."""
    if name in COEFFICIENTS:
        return INPUT_TABLES["line"].checked(name, value)
    if isinstance(value, str):
        raise InputError(f"{name} = {show(value)} is text; groups are bare numbers, for values with units use [contact].")
    return float(getattr(Groups(**{**dict.fromkeys(GROUPS, 1.0), name: value}), name))
