"""The tables of a case file that describe parts of a contact: ``[fluid]``, ``[solid]``, ``[asperity_friction]`` and others."""

import itertools
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from stribeck.cases.tables import AS_GIVEN, noted, one_of, read_tables
from stribeck.contacts.geometries import INPUT_TABLES
from stribeck.contacts.parts import KINDS, LAW_NUMBERS, Kind
from stribeck.fluids.description import Fluid
from stribeck.fluids.measured_viscosity import read_flow_curve
from stribeck.fluids.presets import PRESETS
from stribeck.quantities.formats import format_si
from stribeck.quantities.schema import arguments_of, made_of, needed_of, numbers_of
from stribeck.quantities.units import InputError, show
from stribeck.solids.prony_fit import from_master_curve

# Argument of the fluid -> the laws that a key of ``[fluid]`` names.
FLUID_KINDS = {name: KINDS[name] for name in ("rheology", "viscosity", "density")}

# Table and key of each file that a case may name.
FILES = (("surface", "spectrum"), ("table", "file"), ("fluid", "flow_curve"), ("solid", "master_curve"), ("profile", "x"))

CONDITIONS = tuple(dict.fromkeys(name for preset in PRESETS.values() for name in preset.conditions))

# Keys of [fluid] that bring the viscosity of the contact along -> the keys that go with them.
SOURCES_OF_VISCOSITY = {"preset": CONDITIONS, "flow_curve": ("model",)}


def _keys(*kinds: Kind) -> tuple[str, ...]:
    """Return the keys of a table that names laws of these kinds."""
    numbers = (key for kind in kinds for law in kind.laws.values() for key in arguments_of(law))
    return tuple(dict.fromkeys((*(kind.key for kind in kinds), *numbers)))


@dataclass
class ReadParts:
    """What the tables of the model say."""

    contact: Any  # The table of the contact, which takes a viscosity or modulus that they bring along
    folder: Path | None  # Of files; None where these are not known
    rest: dict[str, Any]  # The other tables
    parts: dict[str, Any] = field(default_factory=dict)  # Arguments of a contact
    facts: dict[str, float] = field(default_factory=dict)  # Facts for checks, in SI units
    sentences: list[str] = field(default_factory=list)  # Where a viscosity or a modulus is from
    problems: list[str] = field(default_factory=list)


class PartTable(NamedTuple):
    """A table of a case that describes a part of a contact."""

    keys: tuple[str, ...]
    read: Callable[[dict[str, Any], ReadParts], dict[str, Any]]  # Arguments of a contact from the table
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


def take_parts(tables: dict[str, Any], folder: Path | None = None) -> ReadParts:
    """Return what the tables of the model say, the other tables, and what is wrong."""
    rest = {name: value for name, value in tables.items() if name not in PART_TABLES}
    if isinstance(rest.get("contact"), dict):
        rest["contact"] = dict(rest["contact"])
    elsewhere = {"contact": dict.fromkeys((*INPUT_TABLES["point"].quantities, "geometry"), AS_GIVEN)}
    found = ReadParts(rest.get("contact"), folder, rest)
    for name, part in PART_TABLES.items():
        wrong: list[str] = []
        given = {name: tables[name]} if name in tables else {}
        read = read_tables(given, {name: dict.fromkeys(part.keys, AS_GIVEN), **elsewhere}, wrong)
        if given and not wrong:
            with noted(wrong, name):
                if part.missing and part.keys[0] not in read[name]:
                    raise InputError(f"{part.keys[0]} is missing; {part.missing}.")
                found.parts |= part.read(read[name], found)
        found.problems += wrong
    return found


def _refuse_other_keys(table: dict[str, Any], keys: tuple[str, ...], of: str) -> None:
    """Refuse keys that another choice would need."""
    for key in table:
        if key not in keys:
            raise InputError(f"{key} = {show(table[key])} is given, but {of} has no such key; remove it.")


def _fluid(table: dict[str, Any], found: ReadParts) -> dict[str, Any]:
    source = next((key for key in SOURCES_OF_VISCOSITY if key in table), None)
    if source is not None:
        return _with_viscosity(table, source, found)
    _refuse_other_keys(table, _keys(*FLUID_KINDS.values()), "a fluid without preset")
    given = {"viscosity_law": "barus"} | table if "pressure_coefficient" in table else table
    return {"fluid": Fluid(**{name: _law(given, kind) for name, kind in FLUID_KINDS.items()})}


def _law(table: dict[str, Any], kind: Kind) -> Any:
    """Return the law that a table names, with its numbers; None for the one that does nothing."""
    name = one_of(*kind.laws)(kind.key, table.get(kind.key, kind.nothing))
    given = {key: table[key] for key in _keys(kind) if key in table and key != kind.key}
    return made_of(kind.laws[name], f"{kind.key} = {name!r}", given)


def _with_viscosity(table: dict[str, Any], source: str, found: ReadParts) -> dict[str, Any]:
    """Return a fluid that has a viscosity, which becomes that of the contact."""
    contact = found.contact if isinstance(found.contact, dict) else {}
    doubled = "viscosity" in contact
    if not doubled:
        contact["viscosity"] = 1.0  # stands for that of the liquid, so that a wrong condition is no lack of a viscosity
    if source == "preset":
        one_of(*PRESETS)("preset", table["preset"])
    _refuse_other_keys(table, (source, *SOURCES_OF_VISCOSITY[source]), f"a {source.replace('_', ' ')}")
    liquid: Any
    if source == "preset":
        preset = PRESETS[table[source]]
        given = {key: table[key] for key in CONDITIONS if key in table}
        liquid = preset(**given)
        conditions = {source: table[source], **preset.conditions, **given}
        words = " and ".join(f"{name} = {show(value)}" for name, value in conditions.items())
        said = f"{words}: {preset.source} ({preset.range})."
        found.facts |= {} if liquid.thinning_rate is None else {"thinning_rate": liquid.thinning_rate}
    else:
        place = "[fluid] of a case; give the viscosity and the law here"
        liquid = read_flow_curve(_file_of(source, table, found.folder, place), law=table.get("model"))
        said = f"flow_curve = {show(table[source])}: {' '.join([liquid.headline, *liquid.notes])}"
    if doubled:
        raise InputError(
            f"{source} = {show(table[source])} and viscosity = {show(contact['viscosity'])} in [contact] are both given; "
            "remove one of them."
        )
    contact["viscosity"] = liquid.viscosity
    found.sentences.append(f"viscosity = {format_si(liquid.viscosity, 'viscosity', 4)} from {said}")
    return {"fluid": liquid.fluid}


def fluid_table(fluid: Fluid) -> dict[str, Any]:
    """Return a fluid as the table ``[fluid]``, with its numbers in SI units; empty for one that is always the same."""
    found: dict[str, Any] = {}
    for name, kind in FLUID_KINDS.items():
        law = getattr(fluid, name)
        if law is not None:
            found |= {kind.key: law.name} | {each: getattr(law, each) for each in numbers_of(type(law))}
    return found


def _file_of(key: str, table: dict[str, Any], folder: Path | None, place: str) -> Path:
    """Return the path of the file that a key names."""
    if folder is None:
        raise InputError(f"{key} = {show(table[key])} stands in {place}.")
    if not isinstance(table[key], str):
        raise InputError(f"{key} = {show(table[key])} must be text in quotes, the name of a file.")
    return folder / str(table[key])


def gives_modulus(contact: Any) -> bool:
    """Return whether a table of a contact has its modulus, in any form."""
    stands_for = INPUT_TABLES["point"].stands_for
    return isinstance(contact, dict) and any(stands_for.get(key, key) == "modulus" for key in contact)


def _solid(table: dict[str, Any], found: ReadParts) -> dict[str, Any]:
    """Return the body of a table: a layer, a memory, or a layer that has one; its numbers say which."""
    if "master_curve" in table:
        table = _with_relaxation(table, found)
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


def _with_relaxation(table: dict[str, Any], found: ReadParts) -> dict[str, Any]:
    """Return the table with the relaxation of a measured curve, whose modulus becomes that of a contact without one."""
    doubled = next((key for key in ("relaxation_times", "moduli") if key in table), None)
    if doubled:
        raise InputError(f"master_curve and {doubled} are two descriptions of the same; give one of them.")
    place = "[solid] of a case; give relaxation_times and moduli here"
    curve = from_master_curve(_file_of("master_curve", table, found.folder, place))
    what = "the relaxed modulus of the series is" if gives_modulus(found.contact) else "modulus ="
    found.sentences.append(
        f"{what} {format_si(curve.modulus, 'pressure', 4)} with Poisson's ratio {curve.poisson_ratio:g}, from master_curve = "
        f"{show(table['master_curve'])}: {' '.join([curve.headline, *curve.notes])}"
    )
    if isinstance(found.contact, dict) and not gives_modulus(found.contact):
        found.contact["modulus"] = curve.modulus
    series = {"relaxation_times": list(curve.solid.relaxation_times), "moduli": list(curve.solid.moduli)}
    return {key: value for key, value in table.items() if key != "master_curve"} | series


def _profile(table: dict[str, Any], found: ReadParts) -> dict[str, Any]:
    """Return the shape of a table."""
    kind = KINDS["profile"]
    name = one_of(*kind.laws)("shape", table["shape"])
    given = {key: value for key, value in table.items() if key != "shape"}
    if found.folder is not None and isinstance(given.get("x"), str):  # the name of a file
        given["x"] = str(found.folder / given["x"])
    return {"profile": made_of(kind.laws[name], f"shape = {name!r}", given)}


def _one_law(name: str, read: Callable[..., dict[str, Any]] | None = None) -> PartTable:
    """Return the table of a part that is one law."""
    kind = KINDS[name]
    return PartTable(
        _keys(kind),
        read or (lambda table, found: {name: _law(table, kind)}),
        f"add {kind.key} = {' or '.join(map(json.dumps, kind.laws))}",
    )


PART_TABLES = {
    "fluid": PartTable((*_keys(*FLUID_KINDS.values()), *SOURCES_OF_VISCOSITY, *CONDITIONS), _fluid),
    "cavitation": PartTable(
        ("model", "cavity_pressure"),
        lambda table, found: {"cavitation" if key == "model" else key: value for key, value in table.items()},
        'add model = "exit", "reform" or "none"',
    ),
    "flow_factors": _one_law("flow_factors"),
    "solid": PartTable((*_keys(KINDS["solid"]), "master_curve"), _solid),
    "profile": _one_law("profile", _profile),
    "asperity_friction": _one_law("asperity_friction"),
}
