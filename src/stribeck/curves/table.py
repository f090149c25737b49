"""A Stribeck curve as an xarray dataset, with units, names and provenance."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.contact_laws.law import WithArea, law_attributes
from stribeck.contacts.contact import part_attributes
from stribeck.contacts.friction import DEFINITIONS
from stribeck.contacts.friction_rules import RULES
from stribeck.files.datasets import Column, new_dataset
from stribeck.quantities.inputs import unit_of
from stribeck.quantities.outputs import AREA_ROWS, GROUPS, OUTPUT_TABLES
from stribeck.solver.base_solution import si_films

if TYPE_CHECKING:
    import xarray

__all__ = ["curve_dataset"]


def curve_dataset(curve: Any, title: str = "") -> xarray.Dataset:
    """Return a Stribeck curve as an xarray Dataset."""
    over = curve.over
    unit, what = ("1", f"{over} group") if curve.contact is None else (unit_of(over, curve.contact.INPUTS), over)
    columns: dict[str, Column] = {name: (over, *column) for name, column in _columns(curve).items()}
    return new_dataset(columns, {over: (over, curve.values, unit, f"{what}, what varies")}, _attributes(curve, title))


def _columns(curve: Any) -> dict[str, tuple[Any, str, str]]:
    """Return values, unit and long name of each variable."""
    columns: dict[str, tuple[Any, str, str]] = {
        "friction": (curve.friction, "1", f"friction coefficient, definition {curve.definition}"),
        "friction_contact": (curve.friction_contact, "1", "contribution of asperities to the friction coefficient"),
        "friction_viscous": (curve.friction_viscous, "1", "contribution of the fluid to the friction coefficient"),
        "friction_error": (curve.friction_error, "1", "estimated absolute error of the friction coefficient"),
        "regime": (np.array(curve.regimes, dtype=object), "1", "lubrication regime"),
        "hersey_number": (curve.hersey_number, "1", RULES[curve.groups.geometry].hersey_name),
        "hydrodynamic_friction": (
            curve.hydrodynamic_friction,
            "1",
            "friction coefficient of smooth surfaces by the law of the hydrodynamic branch",
        ),
    }
    solutions = curve.solutions
    table = solutions[0].outputs if solutions else OUTPUT_TABLES[curve.groups.geometry]
    for name, (unit, label) in table.listed.items():
        if solutions or name in curve.observables:
            columns[name] = (curve.observable(name), unit, label)
    for name in GROUPS:
        columns[f"{name}_group"] = (np.asarray(getattr(curve.groups, name)), "1", f"{name} group")
    for definition in DEFINITIONS:
        found, name, label = curve.friction(definition=definition), f"friction_{definition}", f"definition {definition}"
        columns[name] = (found.total, "1", f"friction coefficient, {label}")
        columns[f"{name}_viscous"] = (found.viscous, "1", f"friction coefficient, {label}: contribution of the fluid")
        columns[f"{name}_error"] = (found.error, "1", f"friction coefficient, {label}: estimated absolute error")
    if isinstance(curve.law, WithArea) and solutions:
        for name, (unit, label) in AREA_ROWS.items():
            columns[name] = (curve.observable(name), unit, label)
    films = [si_films(solution) for solution in solutions]
    for name, (_, unit, label) in (films[0] if films else {}).items():
        columns[name] = (np.array([film[name][0] for film in films]), unit, label)
    outcomes = np.array([s.outcome.name for s in solutions] or [curve.outcome.name] * len(curve), dtype=object)
    columns["outcome"] = (outcomes, "1", "how the solve of the point ended")
    return columns


def _attributes(curve: Any, title: str) -> dict[str, Any]:
    """Return what belongs to the whole curve: provenance, inputs, settings, landmarks, outcome."""
    finished = curve.outcome.ok and len(curve) == curve.requested
    found: dict[str, Any] = {
        "title": title or f"Stribeck curve of a lubricated rough {curve.groups.geometry} contact",
        "outcome": curve.outcome.value,
        "complete": int(finished),
        "points": len(curve),
        "requested_points": curve.requested,
        "over": curve.over,
        "geometry": curve.groups.geometry,
        "definition": curve.definition,
        **law_attributes(curve.law, bool(curve.solutions) and curve.solutions[0].law == "smooth"),
        **part_attributes(curve.groups, curve.contact),
        "rtol": curve.rtol,
        "error_estimate": curve.error_estimate,
        "boundary_friction": curve.boundary_friction,
        "beta": curve.beta,
    }
    if curve.contact is not None:
        inputs = {name: value for name, value in curve.contact.inputs() if name != curve.over}
        found |= {f"input_{name}": value for name, value in inputs.items()}
        found["input_units"] = ", ".join(f"{name} {unit_of(name, curve.contact.INPUTS)}" for name in inputs)
    for name in GROUPS:
        values = np.asarray(getattr(curve.groups, name))
        if len(values) and np.ptp(values) <= 1e-12 * values[0]:
            found[f"{name}_group"] = float(values[0])
    found |= _landmark_attributes(curve)
    found["notes"] = "\n".join(curve.notes)
    return found


def _landmark_attributes(curve: Any) -> dict[str, Any]:
    """Return where minimum and transitions lie, nan where the curve holds no minimum."""
    minimum, marks = curve.minimum, curve.transitions
    return {
        f"minimum_{curve.over}": minimum.value if minimum else math.nan,
        "minimum_friction": minimum.friction if minimum else math.nan,
        "transition_names": "; ".join(mark.name for mark in marks),
        f"transition_{curve.over}": np.array([mark.value for mark in marks]),
        "transition_friction": np.array([mark.friction for mark in marks]),
    }
