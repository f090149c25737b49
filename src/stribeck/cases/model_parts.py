"""The tables ``[fluid]``, ``[cavitation]``, ``[motion]``, ``[flow_factors]`` and ``[solid]`` of a case file.

Each becomes one or two arguments of the contact; what a number may be is checked by the law that it goes into.
"""

from __future__ import annotations

import difflib
import inspect
import json
from collections.abc import Callable
from typing import Any

from stribeck.contacts.part_inputs import KINDS, PART_LETTERS, Kind
from stribeck.fluids.description import Fluid
from stribeck.fluids.presets import PRESETS, Liquid
from stribeck.quantities.conversions import GIVEN
from stribeck.quantities.formats import format_si
from stribeck.quantities.inputs import INPUT_TABLES
from stribeck.quantities.schema import numbers_of
from stribeck.quantities.units import InputError, show

__all__ = ["KEYS", "in_file", "preset_facts", "preset_source_text", "take_parts"]


# Argument of the fluid -> the laws that a key of ``[fluid]`` names.
FLUID_KINDS = {name: KINDS[name] for name in ("rheology", "viscosity", "density")}

CONDITIONS = ("weight_fraction", "temperature", "grade")
KEYS_OF_NAME = ("name", "type", "kind", "law", "fluid", "liquid")  # Keys that people write for the one that says which


def keywords_of(law: Any) -> tuple[str, ...]:
    """Return the arguments of a law in the table that names it; none of what does nothing."""
    return () if law is None else tuple(inspect.signature(law).parameters)


# Table -> its keys.
KEYS = {
    "fluid": (
        *(kind.key for kind in FLUID_KINDS.values()),
        *dict.fromkeys(key for kind in FLUID_KINDS.values() for law in kind.laws.values() for key in numbers_of(law)),
        "preset",
        *CONDITIONS,
    ),
    "cavitation": ("model", "cavity_pressure"),
    "motion": ("slide_to_roll",),
    "flow_factors": ("model", *dict.fromkeys(key for law in KINDS["flow_factors"].laws.values() for key in keywords_of(law))),
    "solid": ("model", *dict.fromkeys(key for law in KINDS["solid"].laws.values() for key in numbers_of(law))),
}


# Keys of ``[contact]``, for those who write them below another table.
CONTACT_KEYS = {*INPUT_TABLES["point"].quantities, *GIVEN, "geometry"}


# Other keys of a table, as they stood in former files -> the key.
LETTERS = {"pressure": "cavity_pressure", **PART_LETTERS}

# Argument with which the sentence of a problem may begin -> its table of a case, where no table is being read.
TABLE_OF = {key: table for table, keys in KEYS.items() for key in keys if key != "model"} | {"cavitation": "cavitation"}


def in_file(problem: str, table: str) -> str:
    """Return a sentence on a problem with its place in a case: ``table``, or that of the argument it begins with."""
    name, space, rest = problem.partition(" ")
    key = "model" if name == "cavitation" else name
    return f"[{TABLE_OF.get(name, table)}] {key}{space}{rest}"


def take_parts(tables: dict[str, Any], geometry: str) -> tuple[dict[str, Any], dict[str, Any], list[str]]:
    """Return the tables without those of the model, what these say, and what is wrong with them."""
    rest = {name: value for name, value in tables.items() if name not in KEYS}
    parts: dict[str, Any] = {}
    problems: list[str] = []
    if isinstance(rest.get("contact"), dict):
        rest["contact"] = dict(rest["contact"])
    for name, read in READERS.items():
        if name not in tables:
            continue
        table, letters = tables[name], dict[str, str]()
        try:
            if not isinstance(table, dict):
                raise InputError(f"{name} = {show(table)} must be a table, [{name}].")
            letters = {LETTERS[key]: key for key in table if LETTERS.get(key) in KEYS[name]}
            for key, written in letters.items():
                if key in table:
                    raise InputError(f"{written} = {show(table[written])} is {key}, which is given too; remove one of them.")
            table = {LETTERS[key] if key in letters.values() else key: value for key, value in table.items()}
            unknown = [f"[{name}] {_unknown(key, table[key], KEYS[name])}" for key in table if key not in KEYS[name]]
            if unknown:
                problems += unknown
                continue
            parts |= read(table, rest.get("contact"))
        except InputError as problem:
            problems += [_as_written(in_file(line, name), letters) for line in str(problem).split("\n")]
    problems += _slide_to_roll(rest.get("contact"), parts, geometry)
    return rest, parts, problems


def _as_written(problem: str, letters: dict[str, str]) -> str:
    """Return a sentence with the keys that a table has for those that it stands for."""
    for key, written in letters.items():
        problem = problem.replace(f"] {key} ", f"] {written} ")
    return problem


def _slide_to_roll(contact: Any, parts: dict[str, Any], geometry: str) -> list[str]:
    """Take the ratio from ``[contact]`` or ``[motion]``, whichever has it: of a ball it is an input, of a cylinder a part."""
    if not isinstance(contact, dict):
        return []
    if "slide_to_roll" in contact and "slide_to_roll" in parts:
        given = show(contact.pop("slide_to_roll")), show(parts["slide_to_roll"])
        return [f"slide_to_roll = {given[0]} in [contact] and {given[1]} in [motion] are both given; remove one of them."]
    source, target = (parts, contact) if geometry == "point" else (contact, parts)
    if "slide_to_roll" in source:
        target["slide_to_roll"] = source.pop("slide_to_roll")
    return []


def _unknown(key: str, value: Any, known: tuple[str, ...]) -> str:
    near = difflib.get_close_matches(key, known, n=1, cutoff=0.8)
    meant = near or [each for each in ("preset", "model") if key in KEYS_OF_NAME and each in known]
    advice = f"did you mean {' or '.join(meant)}" if meant else f"known are {', '.join(known)}"
    if key in CONTACT_KEYS:
        advice = "it belongs in the table [contact]: keys go to the last [table] above them"
    return f"{key if key.isprintable() else repr(key)} = {show(value)} is not a known key; {advice}."


def _one_of(table: dict[str, Any], key: str, known: tuple[str, ...], default: str) -> str:
    value = table.get(key, default)
    if value not in known:
        raise InputError(f"{key} = {show(value)} must be one of {', '.join(map(repr, known))}.")
    return str(value)


def _refuse_other_keys(table: dict[str, Any], keys: tuple[str, ...], of: str) -> None:
    """Refuse keys that another choice would need."""
    for key in table:
        if key not in keys:
            raise InputError(f"{key} = {show(table[key])} is given, but {of} has no such key; remove it.")


def _fluid(table: dict[str, Any], contact: Any) -> dict[str, Any]:
    if "preset" in table:
        return _preset(table, contact)
    _refuse_other_keys(table, tuple(key for key in KEYS["fluid"] if key not in CONDITIONS), "a fluid without preset")
    given = {"viscosity_law": "barus"} | table if "pressure_coefficient" in table else table
    return {"fluid": Fluid(**{name: _law(given, kind) for name, kind in FLUID_KINDS.items()})}


def _law(table: dict[str, Any], kind: Kind) -> Any:
    """Return the law that a table names, with its numbers; None for the one that does nothing."""
    laws, key = kind.laws, kind.key
    name = _one_of(table, key, tuple(laws), kind.nothing)
    numbers = numbers_of(laws[name])
    for other in dict.fromkeys(each for law in laws.values() for each in numbers_of(law)):
        if other in table and other not in numbers:
            instead = f"it has {', '.join(numbers)}" if numbers else "remove it"
            raise InputError(f"{other} = {show(table[other])} is given, but {key} = {name!r} has no such key; {instead}.")
    for row in numbers.values():
        if row.name not in table and row.default is None:
            raise InputError(f"{row.name} is missing, which {key} = {name!r} needs; add {row.name} = {row.example}.")
    return None if laws[name] is None else laws[name](**{each: table[each] for each in numbers if each in table})


def _preset(table: dict[str, Any], contact: Any) -> dict[str, Any]:
    doubled = isinstance(contact, dict) and "viscosity" in contact
    if isinstance(contact, dict) and not doubled:
        contact["viscosity"] = 1.0  # stands for that of the liquid, so that a wrong condition is no lack of a viscosity
    name = _one_of(table, "preset", tuple(PRESETS), "")
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


def _cavitation(table: dict[str, Any], contact: Any) -> dict[str, Any]:
    if "model" not in table:
        raise InputError('model is missing; add model = "exit", "reform" or "none".')
    return {"cavitation" if key == "model" else key: value for key, value in table.items()}


def _motion(table: dict[str, Any], contact: Any) -> dict[str, Any]:
    if "slide_to_roll" not in table:
        raise InputError("slide_to_roll is missing; 2 is pure sliding with the cylinder at rest, 0 pure rolling.")
    return {"slide_to_roll": table["slide_to_roll"]}


def _flow_factors(table: dict[str, Any], contact: Any) -> dict[str, Any]:
    laws = KINDS["flow_factors"].laws
    if "model" not in table:
        raise InputError(f"model is missing; add model = {' or '.join(map(json.dumps, laws))}.")
    name = _one_of(table, "model", tuple(laws), "")
    made, rest = laws[name], {key: value for key, value in table.items() if key != "model"}
    _refuse_other_keys(rest, keywords_of(made), f"model = {name!r}")
    return {"flow_factors": None if made is None else made(**rest)}


def _solid(table: dict[str, Any], contact: Any) -> dict[str, Any]:
    laws = {name: law for name, law in KINDS["solid"].laws.items() if law is not None}
    numbers = {name: {key: row for key, row in numbers_of(law).items()} for name, law in laws.items()}
    own = {name: [key for key, row in rows.items() if row.default is None] for name, rows in numbers.items()}
    given = [name for name, keys in own.items() if set(keys) & table.keys()]
    if "model" in table:
        given = list(dict.fromkeys([*given, _one_of(table, "model", tuple(KINDS["solid"].laws), "")]))
        if given[-1] not in laws and len(table) > 1:
            other = next(key for key in table if key != "model")
            raise InputError(f"{other} = {show(table[other])} is given, but model = {given[-1]!r} has no such key; remove it.")
        given = [name for name in given if name in laws]
        if not given:
            return {"solid": None}
    if not given:
        given = [name for name, rows in numbers.items() if rows.keys() & table.keys()][:1]
    if not given:
        first, *others = own.values()
        raise InputError(
            f"{first[0]} is missing; add {first[0]} = {numbers[next(iter(own))][first[0]].example}, or "
            f"{', or '.join(' and '.join(keys) for keys in others)} of a viscoelastic body, or leave the table out for a "
            "half-space."
        )
    bases = [name for name in given if not hasattr(laws[name], "base")]
    memories = [name for name in given if hasattr(laws[name], "base")]
    for several in (bases, memories):
        if len(several) > 1:
            keys = " and ".join(own[name][0] for name in several)
            raise InputError(f"{keys} are two descriptions of the same; give one of them.")
    for name in given:
        for key in own[name]:
            if key not in table:
                there = next((each for each in numbers[name] if each in table), f"model = {name!r}")
                raise InputError(f"{key} is missing beside {there}; add {key} = {numbers[name][key].example}.")
    known = {key for name in given for key in numbers[name]}
    _refuse_other_keys({key: table[key] for key in table if key != "model"}, tuple(known), f"model = {given[0]!r}")
    body = None
    for name in (*bases, *memories):
        values = {key: table[key] for key in numbers[name] if key in table}
        body = laws[name](**values) if body is None else laws[name](**values, base=body)
    return {"solid": body}


# Table -> what makes arguments of a contact of it.
READERS: dict[str, Callable[[dict[str, Any], Any], dict[str, Any]]] = {
    "fluid": _fluid,
    "cavitation": _cavitation,
    "motion": _motion,
    "flow_factors": _flow_factors,
    "solid": _solid,
}
