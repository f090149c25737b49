"""The tables ``[fluid]``, ``[cavitation]``, ``[motion]``, ``[flow_factors]`` and ``[solid]`` of a case file.

Each becomes one or two arguments of the contact; what a number may be is checked by the law that it goes into.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable
from typing import Any, NamedTuple

from stribeck.fluids.description import Fluid
from stribeck.fluids.effective_medium import EffectiveMedium
from stribeck.fluids.flow_factors import PatirCheng
from stribeck.fluids.presets import PRESETS, Liquid
from stribeck.fluids.rheology.eyring import Eyring
from stribeck.fluids.rheology.rate_laws import Carreau, Cross, PowerLaw
from stribeck.fluids.rheology.viscosity import Barus, DowsonHigginson, Roelands
from stribeck.quantities.conversions import GIVEN
from stribeck.quantities.formats import format_si
from stribeck.quantities.inputs import INPUT_TABLES
from stribeck.quantities.units import InputError, show
from stribeck.solids.layer import Layer
from stribeck.solids.viscoelastic import Prony, StandardLinearSolid

__all__ = ["KEYS", "in_file", "preset_facts", "preset_source_text", "take_parts"]


class Part(NamedTuple):
    """A law that a case may name."""

    law: Callable[..., Any] | None = None  # `law(*needed, **optional)`; None for the one that does nothing
    needed: dict[str, str] = {}  # Key that it must have -> an example
    optional: tuple[str, ...] = ()  # Keys that it may have

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys."""
        return (*self.needed, *self.optional)


RELAXATION = {"relaxation_time": '"1 ms"', "exponent": "0.5"}
PRESSURE = {"pressure_viscosity": '"15 1/GPa"'}

RHEOLOGIES = {
    "newtonian": Part(),
    "carreau": Part(Carreau, RELAXATION, ("infinite_viscosity",)),
    "cross": Part(Cross, RELAXATION, ("infinite_viscosity",)),
    "eyring": Part(Eyring, {"stress": '"5 MPa"'}),
    "power-law": Part(PowerLaw, RELAXATION),
}
VISCOSITY_LAWS = {
    "constant": Part(),
    "barus": Part(Barus, PRESSURE),
    "roelands": Part(Roelands, PRESSURE, ("reference_pressure", "reference_viscosity")),
}
DENSITIES = {"incompressible": Part(), "dowson-higginson": Part(DowsonHigginson)}
# Key of ``[fluid]`` -> the laws that the key names; the first law does nothing.
FLUID_LAWS = {"model": RHEOLOGIES, "viscosity_law": VISCOSITY_LAWS, "density": DENSITIES}

# What ``[flow_factors]`` may name.
FLOW_FACTORS: dict[str, Callable[..., Any] | None] = {
    "none": None,
    "patir-cheng": PatirCheng,
    "effective-medium": EffectiveMedium,
}

CONDITIONS = ("weight_fraction", "temperature", "grade")
KEYS_OF_NAME = ("name", "type", "kind", "law", "fluid", "liquid")  # Keys that people write for the one that says which

# Table -> its keys.
KEYS = {
    "fluid": (
        *FLUID_LAWS,
        *dict.fromkeys(key for laws in FLUID_LAWS.values() for part in laws.values() for key in part.keys),
        "preset",
        *CONDITIONS,
    ),
    "cavitation": ("model", "pressure"),
    "motion": ("slide_to_roll",),
    "flow_factors": ("model", "gamma", "substrate_share", "friction_factors", "argument"),
    "solid": ("layer_thickness", "poisson_ratio", "retardation_time", "modulus_ratio", "relaxation_times", "moduli"),
}


# Keys of ``[contact]``, for those who write them below another table.
CONTACT_KEYS = {*INPUT_TABLES["point"].quantities, *GIVEN, "geometry"}


# Argument in Python, with which the sentence of a problem may begin -> table and key of a case.
ARGUMENTS = {
    "cavitation": ("cavitation", "model"),
    "cavity_pressure": ("cavitation", "pressure"),
    "eyring_stress": ("fluid", "stress"),
    "infinite_viscosity": ("fluid", "infinite_viscosity"),
    "pressure_coefficient": ("fluid", "pressure_viscosity"),
    "ratio": ("solid", "modulus_ratio"),
    "reference_viscosity": ("fluid", "reference_viscosity"),
    "thickness": ("solid", "layer_thickness"),
    "time": ("solid", "retardation_time"),
    "times": ("solid", "relaxation_times"),
}


def in_file(problem: str, table: str) -> str:
    """Return a sentence on a problem with its place in a case: ``table``, or that of the argument it begins with."""
    name, space, rest = problem.partition(" ")
    place, key = ARGUMENTS.get(name, (table, name))
    return f"[{place}] {key}{space}{rest}"


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
        table = tables[name]
        try:
            if not isinstance(table, dict):
                raise InputError(f"{name} = {show(table)} must be a table, [{name}].")
            unknown = [f"[{name}] {_unknown(key, table[key], KEYS[name])}" for key in table if key not in KEYS[name]]
            if unknown:
                problems += unknown
                continue
            parts |= read(table, rest.get("contact"))
        except InputError as problem:
            problems += [in_file(line, name) for line in str(problem).split("\n")]
    problems += _slide_to_roll(rest.get("contact"), parts, geometry)
    return rest, parts, problems


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
    named = ARGUMENTS.get(key, ("", ""))[1]  # as in Python
    near = [named] if named in known else difflib.get_close_matches(key, known, n=1, cutoff=0.8)
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
    given = {"viscosity_law": "barus"} | table if PRESSURE.keys() & table.keys() else table
    return {"fluid": Fluid(*(_law(given, key) for key in FLUID_LAWS))}


def _law(table: dict[str, Any], kind: str) -> Any:
    """Return the law that a table names, with its numbers; None for the one that does nothing."""
    laws = FLUID_LAWS[kind]
    name = _one_of(table, kind, tuple(laws), next(iter(laws)))
    part = laws[name]
    for key in dict.fromkeys(key for other in laws.values() for key in other.keys):
        if key in table and key not in part.keys:
            instead = f"it has {', '.join(part.keys)}" if part.keys else "remove it"
            raise InputError(f"{key} = {show(table[key])} is given, but {kind} = {name!r} has no such key; {instead}.")
    for key, example in part.needed.items():
        if key not in table:
            raise InputError(f"{key} is missing, which {kind} = {name!r} needs; add {key} = {example}.")
    if part.law is None:
        return None
    return part.law(*(table[key] for key in part.needed), **{key: table[key] for key in part.optional if key in table})


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
    found = {"cavitation": table["model"]}
    return found | ({"cavity_pressure": table["pressure"]} if "pressure" in table else {})


def _motion(table: dict[str, Any], contact: Any) -> dict[str, Any]:
    if "slide_to_roll" not in table:
        raise InputError("slide_to_roll is missing; 2 is pure sliding with the cylinder at rest, 0 pure rolling.")
    return {"slide_to_roll": table["slide_to_roll"]}


def _flow_factors(table: dict[str, Any], contact: Any) -> dict[str, Any]:
    if "model" not in table:
        raise InputError('model is missing; add model = "patir-cheng", "effective-medium" or "none".')
    model = _one_of(table, "model", tuple(FLOW_FACTORS), "")
    made, rest = FLOW_FACTORS[model], {key: value for key, value in table.items() if key != "model"}
    if made is not PatirCheng:
        _refuse_other_keys(rest, (), f"model = {model!r}")
    return {"flow_factors": None if made is None else made(**rest)}


# Viscoelastic bodies, and their keys with examples.
MEMORIES: tuple[tuple[type[Any], dict[str, str]], ...] = (
    (StandardLinearSolid, {"retardation_time": '"10 ms"', "modulus_ratio": "3.0"}),
    (Prony, {"relaxation_times": '["1 ms", "10 ms"]', "moduli": "[1.0, 0.5]"}),
)


def _solid(table: dict[str, Any], contact: Any) -> dict[str, Any]:
    base = _layer(table)
    given = [(kind, keys) for kind, keys in MEMORIES if keys.keys() & table.keys()]
    if not given:
        if base is None:
            raise InputError(
                'layer_thickness is missing; add it as "2 mm", or retardation_time and modulus_ratio of a viscoelastic body, '
                "or leave the table out for a half-space."
            )
        return {"solid": base}
    if len(given) > 1:
        raise InputError("retardation_time and relaxation_times are two descriptions of the same; give one of them.")
    [(kind, keys)] = given
    there = next(key for key in keys if key in table)
    for key, example in keys.items():
        if key not in table:
            raise InputError(f"{key} is missing beside {there}; add {key} = {example}.")
    return {"solid": kind(*(table[key] for key in keys), base)}


def _layer(table: dict[str, Any]) -> Layer | None:
    """Return the layer that a table has; None where the body is a half-space."""
    if "layer_thickness" not in table:
        if "poisson_ratio" in table:
            raise InputError('layer_thickness is missing beside poisson_ratio; add it as "2 mm".')
        return None
    ratio = {"poisson_ratio": table["poisson_ratio"]} if "poisson_ratio" in table else {}
    return Layer(table["layer_thickness"], **ratio)


# Table -> what makes arguments of a contact of it.
READERS: dict[str, Callable[[dict[str, Any], Any], dict[str, Any]]] = {
    "fluid": _fluid,
    "cavitation": _cavitation,
    "motion": _motion,
    "flow_factors": _flow_factors,
    "solid": _solid,
}
