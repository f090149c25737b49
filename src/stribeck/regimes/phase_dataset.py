"""A phase diagram as an xarray Dataset: names, units, provenance, and beside the solved transitions those of the formulas."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from stribeck._types import Array
from stribeck.asperity_friction.coulomb import as_asperity_friction
from stribeck.contact_laws.law import law_attributes
from stribeck.contacts.contact import part_attributes
from stribeck.contacts.groups import Groups
from stribeck.contacts.regime import BOUNDARY_FLUID_SHARE, REGIMES
from stribeck.files.datasets import Column, new_dataset
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import GROUPS
from stribeck.regimes.phase_grid import AXES, MARKS, ROW, VARIABLES, Diagram
from stribeck.solver.about import input_attributes

if TYPE_CHECKING:
    import xarray

# Meanings of the variables that are codes.
FLAGS = {
    "regime": {-1: "unknown", **dict(enumerate(REGIMES))},
    "velocity_weakening": {-1: "unknown", 0: "absent", 1: "present"},
    "formula_velocity_weakening": {0: "absent", 1: "present"},
}

# Transitions by formulas, with their long names.
FORMULA_SPEEDS = {
    "formula_speed_at_5_percent_fluid": f"speed at which {MARKS['speed_at_5_percent_fluid']}, by the law of load sharing",
    "formula_speed_at_half_fluid": f"speed at which {MARKS['speed_at_half_fluid']}, by the law of load sharing",
    "formula_speed_boundary_to_mixed": "speed at which the law of [BP] for low speed, corrected, gives all load to the fluid",
    "formula_speed_at_minimum": "speed of the minimum of friction by the law of mixed friction",
    "printed_speed_boundary_to_mixed": "the same as [BP] print it",
    "printed_speed_at_minimum": "the speed of the minimum as [BP] print it",
}


MERGING = "roughness at which the minimum of friction disappears"


def diagram_dataset(diagram: Diagram) -> xarray.Dataset:
    """Return a diagram with units, long names and provenance."""
    groups, speed_groups = _row_groups(diagram)
    speeds = _formula_speeds(diagram, groups, speed_groups)
    speed_unit, roughness_unit = diagram.unit("speed"), diagram.unit("roughness")
    columns: dict[str, Column] = {
        name: (each.dims, diagram.table[name], diagram.unit(each.unit), each.label) for name, each in VARIABLES.items()
    }
    columns |= {name: (ROW, speeds[name], speed_unit, label) for name, label in FORMULA_SPEEDS.items()}
    weakens = np.isfinite(speeds["formula_speed_at_minimum"]).astype(np.int8)
    columns["formula_velocity_weakening"] = (ROW, weakens, "1", "whether friction falls with speed somewhere, by the formula")
    for name, line, label in (
        ("formula_roughness_without_minimum", _formula_merging(diagram, groups), f"{MERGING}, by the law of mixed friction"),
        ("roughness_without_minimum", diagram.merging, f"{MERGING}, on solved states"),
    ):
        if line is not None:
            columns[name] = ("load", line, roughness_unit, label)
    if diagram.contact is not None:
        columns["load_group"] = ("load", np.asarray(groups.load)[:, 0], "1", "load group")
        columns["roughness_group"] = ("roughness", np.asarray(groups.roughness)[0], "1", "roughness group")
        columns["speed_group"] = (("load", "speed"), speed_groups[:, :1] * diagram.axes["speed"], "1", "speed group")
    coords: dict[str, Column] = {}
    for name, values in diagram.axes.items():
        coords[name] = (name, values, diagram.unit(name), f"{name} group" if diagram.contact is None else name)
    complete = diagram.outcome.ok and bool((diagram.table["outcome"] == Outcome.CONVERGED.name).all())
    about = {
        "title": f"Phase diagram of a lubricated rough {groups.geometry} contact",
        "outcome": diagram.outcome.value,
        "complete": int(complete),
        "definition": diagram.definition,
        **law_attributes(groups.law),
        "rtol": diagram.rtol,
        "boundary_friction": getattr(as_asperity_friction(diagram.boundary_friction), "boundary_friction", math.nan),
        "beta": diagram.beta,
        **input_attributes(diagram.contact, *AXES),
        **part_attributes(groups, diagram.contact),
    }
    dataset = new_dataset(columns, coords, about)
    for name, meanings in FLAGS.items():
        values = np.array(sorted(meanings), dtype=np.int8)
        words = " ".join(meanings[int(value)] for value in values)
        dataset[name].attrs |= {"flag_values": values, "flag_meanings": words}
    return dataset


def _row_groups(diagram: Diagram) -> tuple[Groups, Array]:
    """Return the groups of all rows at speed 1 of the axis, and the speed groups for that speed."""
    rows, columns = (len(diagram.axes[name]) for name in AXES[:2])
    states = [[diagram.problem(i, j)[1] for j in range(columns)] for i in range(rows)]
    speed, load, roughness = (np.array([[getattr(g, name) for g in row] for row in states], dtype=float) for name in GROUPS)
    return Groups(speed, load, roughness, **states[0][0].physics), speed


def _formula_speeds(diagram: Diagram, groups: Groups, unit: Array) -> dict[str, Array]:
    """Return the transitions that the formulas give, in the units of the axis; nan where they have none."""
    from stribeck.asymptotics import load_sharing, transitions

    if not diagram.kind.has_formulas:
        return {name: np.full(unit.shape, np.nan) for name in FORMULA_SPEEDS}
    boundary_friction, beta = diagram.coefficient, diagram.beta
    with np.errstate(all="ignore"):
        shares = load_sharing.speed_at_fluid_share.function
        found = {
            "formula_speed_at_5_percent_fluid": shares(groups, BOUNDARY_FLUID_SHARE),
            "formula_speed_at_half_fluid": shares(groups, 0.5),
            "formula_speed_boundary_to_mixed": transitions.speed_boundary_to_mixed.function(groups),
            "formula_speed_at_minimum": transitions.speed_at_minimum.function(groups, boundary_friction, beta),
            "printed_speed_boundary_to_mixed": transitions.speed_boundary_to_mixed.function(groups, printed=True),
            "printed_speed_at_minimum": transitions.speed_at_minimum.function(groups, boundary_friction, beta, printed=True),
        }
        smooth = (np.asarray(groups.roughness) == 0) | (not transitions.speed_at_minimum.holds_for(groups.law))
        return {name: np.where(smooth, np.nan, np.broadcast_to(values, unit.shape) / unit) for name, values in found.items()}


def _formula_merging(diagram: Diagram, groups: Groups) -> Array:
    from stribeck.asymptotics import transitions

    loads = np.asarray(groups.load)[:, 0]
    if not (diagram.kind.has_formulas and transitions.speed_at_minimum.holds_for(groups.law)):
        return np.full(len(loads), np.nan)
    line = np.asarray(transitions.roughness_without_minimum(loads, diagram.coefficient, diagram.beta))
    if diagram.contact is None:
        return line
    return line / float(diagram.contact.replace(roughness=1.0).groups.roughness)
