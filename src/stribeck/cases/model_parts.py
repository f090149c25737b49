"""The tables of a case file that describe parts of a contact: ``[fluid]``, ``[solid]``, ``[asperity_friction]`` and others.

Each becomes one or two arguments of the contact; what a number may be is checked by the law that it goes into.
"""

from __future__ import annotations

import functools
import itertools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from stribeck.cases.tables import AS_GIVEN, noted, one_of, read_tables
from stribeck.contacts.geometries import INPUT_TABLES
from stribeck.contacts.parts import KINDS, LAW_NUMBERS, Kind
from stribeck.fluids.description import Fluid
from stribeck.fluids.liquids import Liquid
from stribeck.fluids.measured_viscosity import FlowCurve, read_flow_curve
from stribeck.fluids.presets import PRESETS
from stribeck.quantities.formats import format_si
from stribeck.quantities.schema import arguments_of, made_of, needed_of, numbers_of
from stribeck.quantities.units import InputError, show
from stribeck.solids.prony_fit import PronyFit, from_master_curve

# Argument of the fluid -> the laws that a key of ``[fluid]`` names.
FLUID_KINDS = {name: KINDS[name] for name in ("rheology", "viscosity", "density")}

CONDITIONS = tuple(dict.fromkeys(name for preset in PRESETS.values() for name in preset.conditions))

# Keys of [fluid] that bring the viscosity of the contact along -> the keys that go with them.
SOURCES_OF_VISCOSITY = {"preset": CONDITIONS, "flow_curve": ("model",)}


def _keys(*kinds: Kind) -> tuple[str, ...]:
    """Return the keys of a table that names laws of these kinds."""
    numbers = (key for kind in kinds for law in kind.laws.values() for key in arguments_of(law))
    return tuple(dict.fromkeys((*(kind.key for kind in kinds), *numbers)))


class PartTable(NamedTuple):
    """A table of a case that describes a part of a contact."""

    keys: tuple[str, ...]
    # Arguments of a contact from the table, that of the contact, and the folder of files; None where files are not known
    read: Callable[[dict[str, Any], Any, Path | None], dict[str, Any]]
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


def take_parts(tables: dict[str, Any], folder: Path | None = None) -> tuple[dict[str, Any], dict[str, Any], list[str]]:
    """Return the tables without those of the model, what these say, and what is wrong with them; files are in a folder."""
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
                parts |= part.read(read[name], rest.get("contact"), folder)
        problems += wrong
    return rest, parts, problems


def _refuse_other_keys(table: dict[str, Any], keys: tuple[str, ...], of: str) -> None:
    """Refuse keys that another choice would need."""
    for key in table:
        if key not in keys:
            raise InputError(f"{key} = {show(table[key])} is given, but {of} has no such key; remove it.")


def _fluid(table: dict[str, Any], contact: Any, folder: Path | None) -> dict[str, Any]:
    source = next((key for key in SOURCES_OF_VISCOSITY if key in table), None)
    if source is not None:
        return _with_viscosity(table, contact, source, folder)
    _refuse_other_keys(table, _keys(*FLUID_KINDS.values()), "a fluid without preset")
    given = {"viscosity_law": "barus"} | table if "pressure_coefficient" in table else table
    return {"fluid": Fluid(**{name: _law(given, kind) for name, kind in FLUID_KINDS.items()})}


def _law(table: dict[str, Any], kind: Kind) -> Any:
    """Return the law that a table names, with its numbers; None for the one that does nothing."""
    name = one_of(*kind.laws)(kind.key, table.get(kind.key, kind.nothing))
    given = {key: table[key] for key in _keys(kind) if key in table and key != kind.key}
    return made_of(kind.laws[name], f"{kind.key} = {name!r}", given)


def _with_viscosity(table: dict[str, Any], contact: Any, source: str, folder: Path | None) -> dict[str, Any]:
    """Return a fluid that has a viscosity, which becomes that of the contact."""
    doubled = isinstance(contact, dict) and "viscosity" in contact
    if isinstance(contact, dict) and not doubled:
        contact["viscosity"] = 1.0  # stands for that of the liquid, so that a wrong condition is no lack of a viscosity
    if source == "preset":
        one_of(*PRESETS)("preset", table["preset"])
    _refuse_other_keys(table, (source, *SOURCES_OF_VISCOSITY[source]), f"a {source.replace('_', ' ')}")
    liquid = _liquid(table, folder)
    if doubled:
        raise InputError(
            f"{source} = {show(table[source])} and viscosity = {show(contact['viscosity'])} in [contact] are both given; "
            "remove one of them."
        )
    if isinstance(contact, dict):
        contact["viscosity"] = liquid.viscosity
    return {"fluid": liquid.fluid}


def _liquid(table: dict[str, Any], folder: Path | None) -> Liquid | FlowCurve:
    if "preset" in table:
        return PRESETS[table["preset"]](**{key: table[key] for key in CONDITIONS if key in table})
    path, changed = _file_of("flow_curve", table, folder, "[fluid] of a case; give the viscosity and the law here")
    return _flow_curve(path, changed, table.get("model"))


def _master_curve(table: dict[str, Any], folder: Path | None) -> PronyFit:
    return _curve_of_file(*_file_of("master_curve", table, folder, "[solid] of a case; give relaxation_times and moduli here"))


def _file_of(key: str, table: dict[str, Any], folder: Path | None, place: str) -> tuple[Path, int]:
    """Return the path of the file that a key names, and when it changed."""
    if folder is None:
        raise InputError(f"{key} = {show(table[key])} stands in {place}.")
    if not isinstance(table[key], str):
        raise InputError(f"{key} = {show(table[key])} must be text in quotes, the name of a file.")
    path = folder / table[key]
    return path, path.stat().st_mtime_ns if path.is_file() else 0


# A fit takes a quarter of a second, and a case reads its fluid for the contact and for what it says of it.
@functools.lru_cache(maxsize=16)
def _flow_curve(path: Path, changed: int, law: str | None) -> FlowCurve:
    return read_flow_curve(path, law=law)


@functools.lru_cache(maxsize=16)
def _curve_of_file(path: Path, changed: int) -> PronyFit:
    return from_master_curve(path)


def preset_facts(tables: dict[str, Any]) -> dict[str, float]:
    """Return the facts for checks that a preset holds, in SI units."""
    table = tables.get("fluid")
    rate = getattr(_liquid(table, None), "thinning_rate", None) if isinstance(table, dict) and "preset" in table else None
    return {} if rate is None else {"thinning_rate": rate}


def viscosity_source_text(tables: dict[str, Any], viscosity: float, folder: Path) -> tuple[str, ...]:
    """Return where the viscosity of a fluid is from, in a sentence; nothing where the case gives it."""
    table = tables.get("fluid")
    if not isinstance(table, dict):
        return ()
    source = next((key for key in SOURCES_OF_VISCOSITY if key in table), None)
    if source is None:
        return ()
    text = f"viscosity = {format_si(viscosity, 'viscosity', 4)} from "
    if source == "flow_curve":
        found = _liquid(table, folder)
        assert isinstance(found, FlowCurve)
        return (f"{text}flow_curve = {show(table[source])}: {' '.join([found.headline, *found.notes])}",)
    preset = PRESETS[table[source]]
    conditions = {**preset.conditions, **{key: table[key] for key in CONDITIONS if key in table}}
    given = " and ".join(f"{name} = {show(value)}" for name, value in {source: table[source], **conditions}.items())
    return (f"{text}{given}: {preset.source} ({preset.range}).",)


def gives_modulus(contact: Any) -> bool:
    """Return whether a table of a contact has its modulus, in any form."""
    stands_for = INPUT_TABLES["point"].stands_for
    return isinstance(contact, dict) and any(stands_for.get(key, key) == "modulus" for key in contact)


def body_source_text(tables: dict[str, Any], folder: Path) -> tuple[str, ...]:
    """Return where the relaxation of a body is from, in a sentence; nothing where the case gives it."""
    table = tables.get("solid")
    if not isinstance(table, dict) or "master_curve" not in table:
        return ()
    found = _master_curve(table, folder)
    relaxed = format_si(found.modulus, "pressure", 4)
    what = "the relaxed modulus of the series is" if gives_modulus(tables.get("contact")) else "modulus ="
    text = f"{what} {relaxed} with Poisson's ratio {found.poisson_ratio:g}, from master_curve = {show(table['master_curve'])}"
    return (f"{text}: {' '.join([found.headline, *found.notes])}",)


def _solid(table: dict[str, Any], contact: Any, folder: Path | None) -> dict[str, Any]:
    """Return the body of a table: a layer, a memory, or a layer that has one; its numbers say which."""
    if "master_curve" in table:
        doubled = next((key for key in ("relaxation_times", "moduli") if key in table), None)
        if doubled:
            raise InputError(f"master_curve and {doubled} are two descriptions of the same; give one of them.")
        curve = _master_curve(table, folder)
        if isinstance(contact, dict) and not gives_modulus(contact):
            contact["modulus"] = curve.modulus
        table = {key: value for key, value in table.items() if key != "master_curve"}
        table |= {"relaxation_times": list(curve.solid.relaxation_times), "moduli": list(curve.solid.moduli)}
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


def _profile(table: dict[str, Any], contact: Any, folder: Path | None) -> dict[str, Any]:
    """Return the shape of a table."""
    kind = KINDS["profile"]
    name = one_of(*kind.laws)("shape", table["shape"])
    given = {key: value for key, value in table.items() if key != "shape"}
    if folder is not None and isinstance(given.get("x"), str):  # the name of a file
        given["x"] = str(folder / given["x"])
    return {"profile": made_of(kind.laws[name], f"shape = {name!r}", given)}


PART_TABLES = {
    "fluid": PartTable((*_keys(*FLUID_KINDS.values()), *SOURCES_OF_VISCOSITY, *CONDITIONS), _fluid),
    "cavitation": PartTable(
        ("model", "cavity_pressure"),
        lambda table, contact, folder: {"cavitation" if key == "model" else key: value for key, value in table.items()},
        'add model = "exit", "reform" or "none"',
    ),
    "flow_factors": PartTable(
        _keys(KINDS["flow_factors"]),
        lambda table, contact, folder: {"flow_factors": _law(table, KINDS["flow_factors"])},
        f"add model = {' or '.join(map(json.dumps, KINDS['flow_factors'].laws))}",
    ),
    "solid": PartTable((*_keys(KINDS["solid"]), "master_curve"), _solid),
    "profile": PartTable(
        _keys(KINDS["profile"]),
        _profile,
        f"add shape = {' or '.join(map(json.dumps, KINDS['profile'].laws))}",
    ),
    "asperity_friction": PartTable(
        _keys(KINDS["asperity_friction"]),
        lambda table, contact, folder: {"asperity_friction": _law(table, KINDS["asperity_friction"])},
        f"add model = {' or '.join(map(json.dumps, KINDS['asperity_friction'].laws))}",
    ),
}
