"""The parts of the model that are chosen from lists: geometry, contact law, fluid, cavitation, motion, flow factors, solid.

Each row is a table of a case and one of its keys; the keys of a choice come from the readers of cases.
"""

from __future__ import annotations

import functools
import math
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from stribeck.cases.case import DEFAULT_POINTS_AND_RTOL
from stribeck.cases.law import LAWS, law_of_file
from stribeck.cases.model_parts import FLUID_KINDS
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contact_laws.persson import GAMMA
from stribeck.contact_laws.scaled import named_law
from stribeck.contacts.model import Model
from stribeck.contacts.part_inputs import KINDS
from stribeck.explorer.inputs.carried import LAW_NAMES, contact_of, fluid_table, json_text, tables_of
from stribeck.explorer.inputs.inputs import Inputs, exact_text, with_model
from stribeck.fluids.cavitation import Cavitation
from stribeck.fluids.presets import PRESETS
from stribeck.quantities.formats import format_si
from stribeck.quantities.inputs import INPUT_TABLES, quantity
from stribeck.quantities.schema import numbers_of
from stribeck.quantities.units import InputError
from stribeck.solver.point.solve import check_model

__all__ = ["CHOICES", "Choice", "choose", "state_of", "with_detail"]

Keys = tuple[tuple[str, ...], tuple[str, ...]]  # Keys that a choice needs, and keys that it may have.

NO_KEYS: Keys = ((), ())

# Relative tolerance of the states where the geometry is chosen on the page.
RTOL_BY_GEOMETRY = {geometry: rtol for geometry, (_, rtol) in DEFAULT_POINTS_AND_RTOL.items()}

CHECKS: dict[str, Callable[[Model], None]] = {"point": check_model}
"""What refuses models that the equations of a geometry do not have."""

ROWS = {key: row for kind in KINDS.values() for law in kind.laws.values() for key, row in numbers_of(law).items()}
"""The numbers of all laws."""

TYPICAL: dict[str, Any] = {
    **{key: tomllib.loads(f"value = {row.example}")["value"] for key, row in ROWS.items()},
    "slide_to_roll": 0.5,
    "hurst": 0.8,
    "longest_wavelength": "150 um",
    "shortest_wavelength": "1.5 um",
}
"""First value of a key that is needed."""

# Labels of keys and names that differ from the key.
LABELS: dict[str, str] = {
    **{key: row.label for key, row in ROWS.items()},
    **{name: law.label for kind in KINDS.values() for name, law in kind.laws.items() if hasattr(law, "label")},
    "slide_to_roll": "slide-to-roll ratio",
    "cavity_pressure": "cavity pressure, gauge",
    "hurst": "Hurst exponent",
    "gamma": "coefficient γ",
    "roll_off_wavelength": "roll-off wavelength",
    "roll_off": "roll-off wave number",
    "q0": "wave number q₀",
    "q1": "wave number q₁",
    "newtonian": "Newtonian",
    "exit": "film ends at the exit",
    "reform": "cavity, film re-forms",
}

IF_EMPTY = {
    **{key: format_si(row.default, row.dimension) for key, row in ROWS.items() if row.default is not None},
    "cavity_pressure": "0",
    "layer_thickness": "half-space",
    "roll_off_wavelength": "no roll-off",
    "gamma": str(GAMMA),
}
"""What stands for an optional key that is not given."""


def _label(name: str) -> str:
    return LABELS.get(name, name.replace("_", " ").replace("-", " "))


@dataclass(frozen=True)
class Choice:
    """One list to choose from."""

    name: str  # Its name on the page
    label: str  # What is chosen
    table: str  # The table of the case; empty for a key at the top of the model
    key: str  # The key that is chosen; empty where the table alone is the choice
    options: Mapping[str, tuple[str, Keys]]

    @property
    def first(self) -> str:
        """The choice by default."""
        return next(iter(self.options))


def _keys(law: type | None) -> Keys:
    """Return the numbers that a law needs, and those that it may have."""
    rows = numbers_of(law)
    needed = tuple(key for key, row in rows.items() if row.default is None)
    return needed, tuple(key for key in rows if key not in needed)


def _bodies() -> dict[str, tuple[str, Keys]]:
    """Return the bodies; one with a memory may be a layer too."""
    laws = {name: law for name, law in KINDS["solid"].laws.items() if law is not None}
    shapes = tuple(key for law in laws.values() if not hasattr(law, "base") for key in numbers_of(law))
    found = {KINDS["solid"].nothing: (KINDS["solid"].nothing, NO_KEYS)}
    for name, law in sorted(laws.items(), key=lambda each: hasattr(each[1], "base")):
        needed, optional = _keys(law)
        found[name] = _label(name), (needed, (*optional, *shapes) if hasattr(law, "base") else optional)
    return found


SURFACE_KEYS: Keys = (("hurst", "longest_wavelength", "shortest_wavelength"), ("roll_off_wavelength", "gamma"))

CHOICES = {
    each.name: each
    for each in (
        Choice(
            "geometry", "Geometry", "", "geometry", {"line": ("cylinder on flat", NO_KEYS), "point": ("ball on flat", NO_KEYS)}
        ),
        Choice(
            "law",
            "Contact law",
            "",
            "law",
            {law: (LAW_NAMES[law], SURFACE_KEYS if law == "persson" else NO_KEYS) for law in LAWS},
        ),
        Choice(
            "preset",
            "Fluid preset",
            "",
            "",
            {"": ("choose ...", NO_KEYS)} | {k: (p.label.replace("degC", "°C"), NO_KEYS) for k, p in PRESETS.items()},
        ),
        *(
            Choice(
                kind.key if kind.key != "model" else "fluid",
                kind.label,
                "fluid",
                kind.key,
                {name: (_label(name), _keys(law)) for name, law in kind.laws.items()},
            )
            for kind in FLUID_KINDS.values()
        ),
        Choice(
            "cavitation",
            "Cavitation",
            "cavitation",
            "model",
            {str(each): (_label(each), ((), ("cavity_pressure",)) if each == "reform" else NO_KEYS) for each in Cavitation},
        ),
        Choice(
            "motion",
            "Motion",
            "motion",
            "",
            {"sliding": ("one surface at rest", NO_KEYS), "rolling": ("both surfaces move", (("slide_to_roll",), ()))},
        ),
        Choice(
            "flow_factors",
            "Flow factors",
            "flow_factors",
            "model",
            {name: (_label(name), NO_KEYS) for name in KINDS["flow_factors"].laws},
        ),
        Choice("solid", KINDS["solid"].label, "solid", "", _bodies()),
    )
}
"""The rows, in the order of the page."""


def _where(choice: Choice) -> str:
    """Return the table in which the keys of a choice stand."""
    return "surface" if choice.name == "law" else choice.table


def chosen_value(choice: Choice, tables: Mapping[str, Any]) -> str:
    """Return what is chosen in the tables of a model."""
    if not choice.table and not choice.key:
        return choice.first
    if not choice.key:
        given = tables.get(choice.table, {})
        fits = [name for name, (_, (needed, _)) in choice.options.items() if set(needed) <= given.keys()]
        return fits[-1]
    given = tables.get(choice.table, {}) if choice.table else tables
    if choice.name == "viscosity_law" and "pressure_coefficient" in given:
        return str(given.get(choice.key, "barus"))
    return str(given.get(choice.key, choice.first))


@functools.cache
def available_values(name: str, geometry: str) -> tuple[str, ...]:
    """Return what contacts of a geometry can have of a choice."""
    choice, check = CHOICES[name], CHECKS.get(geometry)
    if check is None or not choice.table:
        return tuple(choice.options)
    if choice.table == "motion":  # of a ball the slide-to-roll ratio is one of its inputs
        return (choice.first,)
    inputs = INPUT_TABLES[geometry]
    numbers = {row.name: None if row.optional else quantity(row.name, _number(row.typical), inputs) for row in inputs.rows}
    found = []
    for value, (_, (needed, _)) in choice.options.items():
        table = {key: TYPICAL[key] for key in needed} | ({choice.key: value} if choice.key else {})
        try:
            check(
                contact_of(json_text({"geometry": geometry} | ({choice.table: table} if table else {})), numbers).groups.model
            )
        except InputError:
            continue
        found.append(value)
    return tuple(found)


def state_of(now: Inputs, name: str) -> dict[str, Any]:
    """Return what a row shows."""
    choice, tables = CHOICES[name], tables_of(now.model)
    value = chosen_value(choice, tables)
    given = tables.get(_where(choice), {})
    needed, optional = choice.options[value][1]
    keys = (*needed, *optional)
    if name == "law" and keys:
        # A measured spectrum has no numbers to change; others keep those with which they came.
        own = [key for key in given if key not in ("h_rms", "wavenumber", "density", "title")]
        keys = () if "wavenumber" in given else tuple(dict.fromkeys((*own, *(() if "q0" in given else keys))))
    details = [[key, _label(key), _text(given.get(key, "")), IF_EMPTY.get(key, "")] for key in keys]
    # A table of a contact law comes from a file only.
    known = [key for key in available_values(name, tables.get("geometry", "line")) if key != "table"]
    options = [[key, label] for key, (label, _) in choice.options.items() if key in known or key == value]
    return {"hidden": len(known) < 2, "value": value, "options": options, "details": details}


def choose(now: Inputs, name: str, value: str) -> Inputs:
    """Return the inputs after something was chosen; what it needs has typical values."""
    choice, tables = CHOICES[name], tables_of(now.model)
    if value not in choice.options:
        raise InputError(f"{name} = {value!r} must be one of {', '.join(map(repr, choice.options))}.")
    if name == "preset":
        if not value:
            return now
        liquid = PRESETS[value]()
        tables["fluid"] = fluid_table(liquid.fluid)
        return _with(now, tables, viscosity=liquid.viscosity)
    old, where = chosen_value(choice, tables), _where(choice)
    if name == "law":
        for each in ("surface", "table"):
            tables.pop(each, None)
        if value == "persson":
            tables["surface"] = {key: TYPICAL[key] for key in SURFACE_KEYS[0]}
            return _of_surface(now, tables | {"law": value})
        return _with(now, {**tables, "law": value}, **_same_pressure(now, named_law(value)))
    if name == "geometry":
        # Of a ball the slide-to-roll ratio is one of its inputs; its states take longer. A headline may name the other one.
        motion = tables.pop("motion", {})
        title = now.title if value == old else ""
        return replace(_with(now, {**tables, name: value}, **motion), rtol=RTOL_BY_GEOMETRY[value], title=title)
    table = dict(tables.get(where, {}))
    for key in (*choice.options[old][1][0], *choice.options[old][1][1]):
        table.pop(key, None)
    table |= {key: TYPICAL[key] for key in choice.options[value][1][0]}
    if choice.key:
        table[choice.key] = value
        if value == choice.first:
            del table[choice.key]
    return _with(now, {**tables, where: table})


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
    choice, tables = CHOICES[name], tables_of(now.model)
    where, text = _where(choice), text.strip()
    table = {each: value for each, value in tables.get(where, {}).items() if each != key}
    if text:
        several = isinstance(TYPICAL.get(key), list)
        table[key] = [_number(each.strip()) for each in text.split(",")] if several else _number(text)
    elif key in choice.options[chosen_value(choice, tables)][1][0]:
        raise InputError(f"{key} is missing, which this choice needs; add {key} = {_text(TYPICAL[key])}.")
    tables[where] = table
    return _of_surface(now, tables) if where == "surface" else _with(now, tables)


def _text(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


def _number(text: str) -> float | str:
    try:
        found = float(text)
    except ValueError:
        return text
    if not math.isfinite(found):
        raise InputError(f"{text} is not a finite number; give one from 1e-300 to 1e300.")
    return found


def _of_surface(now: Inputs, tables: dict[str, Any]) -> Inputs:
    """Return the inputs on the surface of these tables with the present roughness, alpha and beta being those of it."""
    tables["surface"] = tables["surface"] | {"h_rms": exact_text(now, "roughness")}
    found = law_of_file(tables["law"], {}, {"surface": tables["surface"]}, Path())
    return _with(now, tables, alpha=found.coefficients["alpha"], beta=found.coefficients["beta"])


def _with(now: Inputs, tables: Mapping[str, Any], **numbers: float) -> Inputs:
    """Return the inputs with the tables of another model, of which nothing is kept that is as in the article."""
    kept = {name: value for name, value in tables.items() if value and value not in ("line", "exponential")}
    found = with_model(now, json_text(kept), **numbers)
    if found.table.geometry in CHECKS:
        CHECKS[found.table.geometry](found.contact.groups.model)
    return found
