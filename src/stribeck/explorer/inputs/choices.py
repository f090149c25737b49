"""The parts of the model that are chosen from lists: geometry, contact law, fluid, cavitation, motion, flow factors, solid.

Each list is a table of a case and one of its keys; laws and their numbers are those that the package knows by name.
"""

import functools
import json
import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from stribeck.cases.case import DEFAULT_POINTS_AND_RTOL
from stribeck.cases.law import LAWS, SOURCES, SURFACE, law_of_file
from stribeck.cases.model_parts import FLUID_KINDS
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contact_laws.persson import GAMMA_INPUT
from stribeck.contact_laws.scaled import named_law
from stribeck.contacts.contact import IN_PLACE_OF
from stribeck.contacts.geometries import INPUT_TABLES
from stribeck.contacts.parts import KINDS, LAW_NUMBERS
from stribeck.explorer.inputs.inputs import Inputs, exact_text, plain_words, with_liquid, with_text
from stribeck.explorer.inputs.typed import liquid_of, with_point
from stribeck.fluids.fluid import Cavitation
from stribeck.fluids.presets import PRESETS
from stribeck.quantities.schema import needed_of, numbers_of
from stribeck.quantities.units import InputError, checked_word, number_or_text
from stribeck.solver.point.solve import check_model


class Option(NamedTuple):
    """What may be chosen."""

    label: str  # What it is called
    needed: tuple[str, ...] = ()  # Keys that it needs
    optional: tuple[str, ...] = ()  # Keys that it may have
    unshown: tuple[str, ...] = ()  # Keys that it may have and no field shows

    @property
    def keys(self) -> tuple[str, ...]:
        """All its keys."""
        return (*self.needed, *self.optional)


# The numbers of laws and surfaces, which are the keys of options.
NUMBERS = LAW_NUMBERS | SURFACE.quantities | {"gamma": GAMMA_INPUT}

OF_SURFACE = (
    ("hurst", "longest_wavelength", "shortest_wavelength"),
    ("roll_off_wavelength", "gamma"),
)  # Needed and optional keys
NO_DETAILS = ("h_rms", "wavenumber", "density", "title", "shape_only")  # Keys of a surface that no field shows


@dataclass(frozen=True)
class Choice:
    """One list to choose from."""

    name: str  # Its name on the page
    label: str  # What is chosen
    table: str  # The table of the case; empty for what becomes other tables
    key: str  # The key that is chosen; empty where the table alone is the choice
    options: Mapping[str, Option]

    @property
    def first(self) -> str:
        """The choice by default."""
        return next(iter(self.options))

    @property
    def where(self) -> str:
        """The table in which the keys of its options stand."""
        return "surface" if self.name == "law" else self.table


def _of_kind(name: str) -> Choice:
    """Return the list of the laws of a kind; a body with a memory may have the numbers of one without it too."""
    kind, names = KINDS[name], {"rheology": "fluid", "viscosity": "viscosity_law", "profile": "shape"}
    laws = sorted(kind.laws.items(), key=lambda each: hasattr(each[1], "base"))
    shapes = [key for _, law in laws if not hasattr(law, "base") for key in numbers_of(law)]
    options = {}
    for each, law in laws:
        words = each.capitalize() if each in ("newtonian", "coulomb") else each if law is None else each.replace("-", " ")
        keys = (*numbers_of(law), *(shapes if hasattr(law, "base") else ()))
        needed = needed_of(law)
        others = tuple(own.name for own in fields(law) if own.name not in keys) if is_dataclass(law) else ()
        options[each] = Option(getattr(law, "label", words), needed, tuple(key for key in keys if key not in needed), others)
    # Which body it is, its numbers say.
    return Choice(names.get(name, name), kind.label, kind.table, "" if name == "solid" else kind.key, options)


GEOMETRIES = {"line": Option("cylinder on flat"), "point": Option("ball on flat")}
ASPERITY_LAWS = {
    law: Option(" and ".join(map(str.capitalize, law.split("-"))), *(OF_SURFACE if law == "persson" else ())) for law in LAWS
}
LIQUIDS = {"": Option("choose ...")} | {name: Option(each.label.replace("degC", "°C")) for name, each in PRESETS.items()}
ENDS_OF_FILM = {
    str(Cavitation.NONE): Option("none"),
    str(Cavitation.EXIT): Option("film ends at the exit"),
    str(Cavitation.REFORM): Option("cavity, film re-forms", (), ("cavity_pressure",)),
}
MOTIONS = {"sliding": Option("one surface at rest"), "rolling": Option("both surfaces move", ("slide_to_roll",))}

LISTS = (
    Choice("geometry", "Geometry", "contact", "geometry", GEOMETRIES),
    Choice("law", "Contact law", "contact", "law", ASPERITY_LAWS),
    Choice("preset", "Fluid preset", "", "", LIQUIDS),
    *map(_of_kind, FLUID_KINDS),
    Choice("cavitation", "Cavitation", "cavitation", "model", ENDS_OF_FILM),
    Choice("motion", "Motion", "contact", "", MOTIONS),
    *map(_of_kind, ("flow_factors", "solid", "profile", "asperity_friction")),
)

CHOICES = {each.name: each for each in LISTS}
"""The lists, in the order of the page."""


def chosen_value(choice: Choice, tables: Mapping[str, Any]) -> str:
    """Return what is chosen in tables."""
    given = tables.get(choice.table, {})
    if not choice.key:
        return [name for name, option in choice.options.items() if set(option.needed) <= given.keys()][
            -1 if choice.table else 0
        ]
    implied = "barus" if choice.name == "viscosity_law" and "pressure_coefficient" in given else choice.first
    return str(given.get(choice.key, implied))


@functools.cache
def typical(geometry: str) -> Inputs:
    """Return the inputs of a contact that has the typical value of each."""
    numbers = {key: row.typical_value for key, row in INPUT_TABLES[geometry].kept.items() if not row.optional}
    return Inputs.of({"contact": {"geometry": geometry, **numbers}})


@functools.cache
def available_values(name: str, geometry: str) -> tuple[str, ...]:
    """Return what contacts of a geometry can have of a choice."""
    choice = CHOICES[name]
    if name == "motion" and "slide_to_roll" in INPUT_TABLES[geometry].names:  # which has a field
        return (choice.first,)
    if geometry != "point" or choice.table in ("", "contact", "asperity_friction"):
        return tuple(choice.options)
    found = []
    for value in choice.options:
        with suppress(InputError):
            choose(typical(geometry), name, value)
            found.append(value)
    return tuple(found)


def first_value(key: str) -> Any:
    """Return the first value of a key that a choice needs."""
    return json.loads(NUMBERS[key].example)


def list_of(now: Inputs, name: str) -> dict[str, Any]:
    """Return what a list and the fields of its choice show."""
    choice, tables = CHOICES[name], now.tables
    value, given = chosen_value(choice, tables), tables.get(choice.where, {})
    keys = choice.options[value].keys
    if name == "law" and keys:
        # A measured spectrum has no numbers to change; others keep those with which they came.
        own = [key for key in given if key not in NO_DETAILS]
        keys = () if "wavenumber" in given else tuple(dict.fromkeys((*own, *(() if "q0" in given else keys))))
    details = [[key, NUMBERS[key].label, _text(given.get(key, "")), NUMBERS[key].without_it] for key in keys]
    # A table of a contact law comes from a file only.
    known = [key for key in available_values(name, now.table.geometry) if key != "table"]
    options = [[key, option.label] for key, option in choice.options.items() if key in known or key == value]
    shown = {"name": name, "label": choice.label, "value": value, "options": options, "details": details}
    return shown | {"help": help_of_choice(name, keys)} | ({"hidden": True} if len(known) < 2 else {})


# What each list is about.
ROLES = {
    "geometry": "The harder body, on a flat soft one or the other way round.",
    "law": "How hard asperities press at a given gap: the exponential law for soft contacts, Persson's under any load.",
    "preset": "A liquid: it sets the viscosity, and how that changes.",
    "fluid": "How the fluid thins as it is sheared.",
    "viscosity_law": "How the viscosity rises with the pressure, which oils do above some 10 MPa.",
    "density": "How the fluid is compressed.",
    "cavitation": "What becomes of the film where its pressure would fall below that of the surroundings.",
    "motion": "Whether the second surface moves too, as in rolling.",
    "flow_factors": "How summits hinder the flow, beside the mean gap.",
    "solid": "Whether the soft body is thick, a layer on a hard one, or slow to recover.",
    "shape": "The undeformed shape of the body.",
    "asperity_friction": "Friction where asperities touch: a coefficient, or a shear stress on the real area of contact.",
}


@functools.cache
def help_of_choice(name: str, keys: tuple[str, ...]) -> str:
    """Return what a list is about, where a case file has that, and what the numbers of a choice are."""
    choice = CHOICES[name]
    where = f"In a case file it stands in [{choice.table}]{choice.key and f' as {choice.key}'}." if choice.table else ""
    return " ".join(filter(None, [ROLES[name], where, *(plain_words(NUMBERS[key]) for key in keys)]))


def choose(now: Inputs, name: str, value: str) -> Inputs:
    """Return the inputs after something was chosen; what it needs has typical values."""
    choice, tables = CHOICES[name], now.tables
    checked_word(name, value, choice.options)
    if name == "preset":
        if not value:
            return now
        return _solvable(with_liquid(now, PRESETS[value]()))
    old = chosen_value(choice, tables)
    needed = {key: first_value(key) for key in choice.options[value].needed}
    contact = tables["contact"]
    if name == "law":
        tables = {key: table for key, table in tables.items() if key not in SOURCES} | {"contact": contact | {"law": value}}
        if needed:
            return _of_surface(now, tables | {"surface": needed})
        return _with(now, tables, **_same_pressure(now, named_law(value)))
    if name == "geometry":
        if value == old:
            return now
        # Of a ball the slide-to-roll ratio is one of its inputs; its states take longer. A headline may name the other one.
        known, before = INPUT_TABLES[value].quantities, now.contact
        contact = {key: each for key, each in contact.items() if key in known} | {name: value}
        solver = tables.pop("solver", {}) | {"rtol": DEFAULT_POINTS_AND_RTOL[value][1]}
        tables.pop("title", None)
        R, E, p = before.radius, before.modulus, before.hertz.pressure
        load = math.pi**3 * p**3 * R**2 / (6 * E**2) if value == "point" else math.pi * R * p**2 / E
        numbers = {"load": load} | ({"speed": before.speed} if value == "line" else {})
        return _with(now, tables | {"contact": contact, "solver": solver}, **numbers)
    gone = {*choice.options[old].keys, *choice.options[old].unshown} - {*choice.options[value].unshown}
    kept = {key: each for key, each in tables.get(choice.where, {}).items() if key not in gone}
    if choice.key:
        kept |= {choice.key: value}
    if value == choice.first:
        kept.pop(choice.key, None)
    return _with(now, tables | {choice.where: kept | needed}, **_replaced(now, choice, bool(needed)))


def _replaced(now: Inputs, choice: Choice, is_given: bool) -> dict[str, float | None]:
    """Return the input in whose place a choice stands: none beside it, and its present or typical value without it."""
    name = IN_PLACE_OF.get(choice.table)
    if name is None:
        return {}
    value = getattr(now.contact, name, None)
    return {name: None if is_given else value or now.table.quantities[name].typical_value}


def _same_pressure(now: Inputs, law: AsperityLaw | None) -> dict[str, float]:
    """Return alpha and beta with which another law presses as the present one does at a gap of one h_rms."""
    old = now.contact.law
    if not (hasattr(law, "fixed_alpha") or hasattr(old, "fixed_alpha")):
        return {}
    alpha = getattr(law, "fixed_alpha", float(now.table.quantities["alpha"].typical))

    def log_pressure(of: AsperityLaw | None, separation: float) -> float:
        return -separation if of is None else float(of.log_pressure(np.array([separation]))[0])

    beta = now.contact.beta * math.exp(log_pressure(old, now.contact.alpha) - log_pressure(law, alpha))
    return {"alpha": alpha, "beta": beta}


def with_detail(now: Inputs, name: str, key: str, text: str) -> Inputs:
    """Return the inputs after ``text`` was typed for a key of a choice."""
    choice, tables, text = CHOICES[name], now.tables, text.strip()
    table = {each: value for each, value in tables.get(choice.where, {}).items() if each != key}
    if text:
        several = isinstance(first_value(key), list)
        numbers = [_number(key, each.strip()) for each in (text.split(",") if several else [with_point(key, text)])]
        table[key] = numbers if several else numbers[0]
    elif key in choice.options[chosen_value(choice, tables)].needed:
        raise InputError(f"{key} is missing, which this choice needs; add {key} = {_text(first_value(key))}.")
    tables[choice.where] = table
    return _of_surface(now, tables) if choice.where == "surface" else _with(now, tables)


def _text(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


def _number(key: str, text: str) -> float | str:
    found = number_or_text(text)
    if isinstance(found, float) and not math.isfinite(found):
        raise InputError(f"{key} = {text} is not a finite number; give one from 1e-300 to 1e300.")
    return found


def _of_surface(now: Inputs, tables: dict[str, Any]) -> Inputs:
    """Return the inputs on the surface of these tables with the present roughness, alpha and beta being those of it."""
    surface = {key: value for key, value in tables["surface"].items() if key != "shape_only"}
    surface["h_rms"] = exact_text(now.contact.roughness, "length", now.units["roughness"])
    _, found = law_of_file(tables["contact"]["law"], {}, {"surface": dict(surface)}, Path())
    return _with(now, tables | {"surface": surface | {"shape_only": True}}, alpha=found["alpha"], beta=found["beta"])


def typed(now: Inputs, name: str, text: str) -> Inputs:
    """Return the inputs after ``text`` was typed into a field: a number, or words, of the viscosity a liquid too."""
    liquid = liquid_of(with_point(name, text)) if name == "viscosity" else None
    return with_text(now, name, text) if liquid is None else _solvable(with_liquid(now, liquid))


def _with(now: Inputs, tables: dict[str, Any], **numbers: float | None) -> Inputs:
    """Return the inputs with other tables and numbers, if the equations of their geometry have such a model."""
    return _solvable(now.edited(numbers, tables))


def _solvable(found: Inputs) -> Inputs:
    """Return inputs whose model the equations of their geometry have."""
    if found.table.geometry == "point":
        check_model(found.contact.groups.model)
    return found
