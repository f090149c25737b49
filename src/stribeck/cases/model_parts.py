"""The tables ``[fluid]``, ``[cavitation]``, ``[flow_factors]`` and ``[solid]`` of a case file.

Each becomes one or two arguments of the contact; what a number may be is checked by the law that it goes into.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable
from typing import Any, NamedTuple

from stribeck.cases.tables import AS_GIVEN, noted, one_of, read_tables
from stribeck.contacts.geometries import INPUT_TABLES
from stribeck.contacts.parts import KINDS, LAW_NUMBERS, Kind
from stribeck.fluids.description import Fluid
from stribeck.fluids.liquids import Liquid
from stribeck.fluids.presets import PRESETS
from stribeck.quantities.formats import format_si
from stribeck.quantities.schema import arguments_of, made_of, needed_of, numbers_of
from stribeck.quantities.units import InputError, show

# Argument of the fluid -> the laws that a key of ``[fluid]`` names.
FLUID_KINDS = {name: KINDS[name] for name in ("rheology", "viscosity", "density")}

CONDITIONS = tuple(dict.fromkeys(name for preset in PRESETS.values() for name in preset.conditions))


def _keys(*kinds: Kind) -> tuple[str, ...]:
    """Return the keys of a table that names laws of these kinds."""
    numbers = (key for kind in kinds for law in kind.laws.values() for key in arguments_of(law))
    return tuple(dict.fromkeys((*(kind.key for kind in kinds), *numbers)))


class PartTable(NamedTuple):
    """A table of a case that describes a part of a contact."""

    keys: tuple[str, ...]
    read: Callable[[dict[str, Any], Any], dict[str, Any]]  # Arguments of a contact from the table and that of the contact
    missing: str = ""  # What to say where the first of its keys is missing; empty if none is needed


def in_file(problem: str, table: str) -> str:
    """Return a sentence on a problem with its place in a case: its own, that of the argument it begins with, or ``table``."""
    if problem.startswith(("[", "the table")):
        return problem
    name, space, rest = problem.partition(" ")
    if name == "cavitation":
        return f"[cavitation] model{space}{rest}"
    own = (each for each, part in PART_TABLES.items() if name in part.keys and name != "model")
    return f"[{next(own, table)}] {problem}"


def take_parts(tables: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any], list[str]]:
    """Return the tables without those of the model, what these say, and what is wrong with them."""
    rest = {name: value for name, value in tables.items() if name not in PART_TABLES}
    if isinstance(rest.get("contact"), dict):
        rest["contact"] = dict(rest["contact"])
    elsewhere = {"contact": dict.fromkeys((*INPUT_TABLES["point"].quantities, "geometry"), AS_GIVEN)}
    parts: dict[str, Any] = {}
    problems: list[str] = []
    for name, part in PART_TABLES.items():
        wrong: list[str] = []
        given = {name: tables[name]} if name in tables else {}
        read = read_tables(given, {name: dict.fromkeys(part.keys, AS_GIVEN), **elsewhere}, wrong)
        if given and not wrong:
            with noted(wrong, name):
                if part.missing and part.keys[0] not in read[name]:
                    raise InputError(f"{part.keys[0]} is missing; {part.missing}.")
                parts |= part.read(read[name], rest.get("contact"))
        problems += wrong
    return rest, parts, problems


def _refuse_other_keys(table: dict[str, Any], keys: tuple[str, ...], of: str) -> None:
    """Refuse keys that another choice would need."""
    for key in table:
        if key not in keys:
            raise InputError(f"{key} = {show(table[key])} is given, but {of} has no such key; remove it.")


def _fluid(table: dict[str, Any], contact: Any) -> dict[str, Any]:
    if "preset" in table:
        return _preset(table, contact)
    _refuse_other_keys(table, (*_keys(*FLUID_KINDS.values()), "preset"), "a fluid without preset")
    given = {"viscosity_law": "barus"} | table if "pressure_coefficient" in table else table
    return {"fluid": Fluid(**{name: _law(given, kind) for name, kind in FLUID_KINDS.items()})}


def _law(table: dict[str, Any], kind: Kind) -> Any:
    """Return the law that a table names, with its numbers; None for the one that does nothing."""
    name = one_of(*kind.laws)(kind.key, table.get(kind.key, kind.nothing))
    given = {key: table[key] for key in _keys(kind) if key in table and key != kind.key}
    return made_of(kind.laws[name], f"{kind.key} = {name!r}", given)


def _preset(table: dict[str, Any], contact: Any) -> dict[str, Any]:
    doubled = isinstance(contact, dict) and "viscosity" in contact
    if isinstance(contact, dict) and not doubled:
        contact["viscosity"] = 1.0  # stands for that of the liquid, so that a wrong condition is no lack of a viscosity
    name = one_of(*PRESETS)("preset", table["preset"])
    _refuse_other_keys(table, ("preset", *CONDITIONS), "a preset")
    liquid = _liquid(table)
    if doubled:
        raise InputError(
            f"preset = {name!r} and viscosity = {show(contact['viscosity'])} in [contact] are both given; remove one of them."
        )
    if isinstance(contact, dict):
        contact["viscosity"] = liquid.viscosity
    return {"fluid": liquid.fluid}


def _liquid(table: dict[str, Any]) -> Liquid:
    return PRESETS[table["preset"]](**{key: table[key] for key in CONDITIONS if key in table})


def preset_facts(tables: dict[str, Any]) -> dict[str, float]:
    """Return the facts for checks that a preset holds, in SI units."""
    table = tables.get("fluid")
    rate = _liquid(table).thinning_rate if isinstance(table, dict) and "preset" in table else None
    return {} if rate is None else {"thinning_rate": rate}


def preset_source_text(tables: dict[str, Any], viscosity: float) -> tuple[str, ...]:
    """Return where the viscosity of a preset is from, in a sentence; nothing where no liquid is named."""
    table = tables.get("fluid")
    if not isinstance(table, dict) or "preset" not in table:
        return ()
    preset = PRESETS[table["preset"]]
    conditions = {**preset.conditions, **{key: table[key] for key in CONDITIONS if key in table}}
    given = " and ".join(f"{name} = {show(value)}" for name, value in {"preset": table["preset"], **conditions}.items())
    return (f"viscosity = {format_si(viscosity, 'viscosity', 4)} from {given}: {preset.source} ({preset.range}).",)


def _solid(table: dict[str, Any], contact: Any) -> dict[str, Any]:
    """Return the body of a table: a layer, a memory, or a layer that has one; its numbers say which."""
    kind = KINDS["solid"]
    laws = {name: law for name, law in kind.laws.items() if law is not None}
    named = one_of(*kind.laws)("model", table.get("model", next(iter(laws))))
    if named == kind.nothing:
        return {"solid": _law(table, kind)}
    chosen = {name: law for name, law in laws.items() if not table.keys().isdisjoint(needed_of(law))}
    if "model" in table or not table.keys().isdisjoint(numbers_of(laws[named])) and not chosen:
        chosen[named] = laws[named]
    if not chosen:
        first, *others = map(needed_of, laws.values())
        memories = ", ".join(" and ".join(keys) for keys in others)
        advice = (
            f"{LAW_NUMBERS[first[0]].advice}, or {memories} of a viscoelastic body, or leave the table out for a half-space"
        )
        raise InputError(f"{first[0]} is missing; {advice}.")
    bodies = sorted(chosen.items(), key=lambda each: hasattr(each[1], "base"))  # what the memory is of first
    for (_, one), (_, other) in itertools.pairwise(bodies):
        if hasattr(one, "base") == hasattr(other, "base"):
            keys = " and ".join(needed_of(law)[0] for law in (one, other))
            raise InputError(f"{keys} are two descriptions of the same; give one of them.")
    known = [key for law in chosen.values() for key in arguments_of(law)]
    _refuse_other_keys(table, ("model", *known), f"model = {bodies[0][0]!r}")
    base: dict[str, Any] = {}
    for name, law in bodies:
        given = {key: table[key] for key in arguments_of(law) if key in table}
        base = {"base": made_of(law, f"model = {name!r}", given, **base)}
    return {"solid": base["base"]}


PART_TABLES = {
    "fluid": PartTable((*_keys(*FLUID_KINDS.values()), "preset", *CONDITIONS), _fluid),
    "cavitation": PartTable(
        ("model", "cavity_pressure"),
        lambda table, contact: {"cavitation" if key == "model" else key: value for key, value in table.items()},
        'add model = "exit", "reform" or "none"',
    ),
    "flow_factors": PartTable(
        _keys(KINDS["flow_factors"]),
        lambda table, contact: {"flow_factors": _law(table, KINDS["flow_factors"])},
        f"add model = {' or '.join(map(json.dumps, KINDS['flow_factors'].laws))}",
    ),
    "solid": PartTable(_keys(KINDS["solid"]), _solid),
}
