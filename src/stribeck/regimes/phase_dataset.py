"""A phase diagram as an xarray Dataset: names, units, provenance, and beside the solved transitions those of the formulas."""

from __future__ import annotations

from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import law_attributes
from stribeck.contacts.groups import Groups
from stribeck.contacts.regime import REGIMES
from stribeck.curves.regime import BOUNDARY_FLUID_SHARE
from stribeck.files.datasets import import_xarray
from stribeck.quantities.outputs import COLUMNS, GROUPS, LINE
from stribeck.regimes.phase_grid import AXES, MARKS, Diagram
from stribeck.solver.about import input_attributes

if TYPE_CHECKING:
    import xarray

FLAGS = {
    "regime": (COLUMNS["regime"][1], {-1: "unknown", **dict(enumerate(REGIMES))}),
    "velocity_weakening": ("whether friction falls with speed somewhere", {-1: "unknown", 0: "absent", 1: "present"}),
    "formula_velocity_weakening": ("the same by the formula", {0: "absent", 1: "present"}),
}
"""Long names and meanings of the variables that are codes."""

LABELS = {
    **{name: COLUMNS[name][1] for name in ("friction", "friction_error", "contact_friction_share")},
    **{name: LINE.listed[name][1] for name in ("fluid_load_share", "central_gap", "lambda_ratio", "error_estimate")},
    **{variable: f"speed at which {name}, on solved states" for variable, name in MARKS.items()},
    "speed_at_minimum": "speed of the minimum of friction, on solved states",
    "friction_at_minimum": "friction coefficient there",
    "formula_speed_at_5_percent_fluid": f"speed at which {MARKS['speed_at_5_percent_fluid']}, by the law of load sharing",
    "formula_speed_at_half_fluid": f"speed at which {MARKS['speed_at_half_fluid']}, by the law of load sharing",
    "formula_speed_boundary_to_mixed": "speed at which the law of [BP] for low speed, corrected, gives all load to the fluid",
    "formula_speed_at_minimum": "speed of the minimum of friction by the law of mixed friction",
    "printed_speed_boundary_to_mixed": "the same as [BP] print it",
    "printed_speed_at_minimum": "the speed of the minimum as [BP] print it",
    "roughness_without_minimum": "roughness at which the minimum of friction disappears, on solved states",
    "formula_roughness_without_minimum": "the same by the law of mixed friction",
}
"""Long names of the numbers."""


def diagram_dataset(diagram: Diagram) -> xarray.Dataset:
    """Return a diagram with units, long names and provenance."""
    library = import_xarray()
    plane = AXES[:2]
    speed_unit, roughness_unit = (_unit(diagram, name) for name in ("speed", "roughness"))
    found: dict[str, Any] = {"regime": (AXES, diagram.regime, _flags("regime"))}
    for name, values in diagram.fields.items():
        found[name] = (AXES, values, {"units": "1", "long_name": LABELS[name]})
    found["outcome"] = (AXES, diagram.outcomes, {"units": "1", "long_name": COLUMNS["outcome"][1]})
    for name, values in (diagram.lines | _formula_speeds(diagram)).items():
        unit = "1" if name.startswith("friction") else speed_unit
        found[name] = (plane, values, {"units": unit, "long_name": LABELS[name]})
    found["velocity_weakening"] = (plane, diagram.velocity_weakening, _flags("velocity_weakening"))
    weakens = np.isfinite(found["formula_speed_at_minimum"][1]).astype(np.int8)
    found["formula_velocity_weakening"] = (plane, weakens, _flags("formula_velocity_weakening"))
    found["message"] = (
        plane,
        diagram.messages,
        {"units": "1", "long_name": "why results of the row are missing, if they are"},
    )
    merging = {"formula_roughness_without_minimum": _formula_merging(diagram)}
    if diagram.merging is not None:
        merging["roughness_without_minimum"] = diagram.merging
    for name, values in merging.items():
        found[name] = (("load",), values, {"units": roughness_unit, "long_name": LABELS[name]})
    found |= _group_axes(diagram)
    dataset: xarray.Dataset = library.Dataset(
        found,
        coords={name: (name, values, _axis_attributes(diagram, name)) for name, values in diagram.axes.items()},
        attrs=_attributes(diagram),
    )
    return dataset


def _unit(diagram: Diagram, name: str) -> str:
    return "1" if diagram.contact is None else diagram.contact.INPUTS.unit(name)


def _axis_attributes(diagram: Diagram, name: str) -> dict[str, str]:
    return {"units": _unit(diagram, name), "long_name": name if diagram.contact is not None else f"{name} group"}


def _flags(name: str) -> dict[str, Any]:
    label, meanings = FLAGS[name]
    values = np.array(sorted(meanings), dtype=np.int8)
    return {
        "units": "1",
        "long_name": label,
        "flag_values": values,
        "flag_meanings": " ".join(meanings[int(value)] for value in values),
    }


def _group_axes(diagram: Diagram) -> dict[str, Any]:
    """Return the groups that axes in SI units stand for."""
    if diagram.contact is None:
        return {}
    groups, units = _row_groups(diagram)
    found = {
        "load_group": (("load",), np.asarray(groups.load)[:, 0]),
        "roughness_group": (("roughness",), np.asarray(groups.roughness)[0]),
        "speed_group": (("load", "speed"), units[:, :1] * diagram.axes["speed"]),
    }
    return {
        name: (axes, values, {"units": "1", "long_name": name.replace("_", " ")}) for name, (axes, values) in found.items()
    }


def _row_groups(diagram: Diagram) -> tuple[Groups, Array]:
    """Return the groups of all rows at speed 1 of the axis, and the speed groups for that speed."""
    rows, columns = (len(diagram.axes[name]) for name in AXES[:2])
    states = [[diagram.problem(i, j)[1] for j in range(columns)] for i in range(rows)]
    speed, load, roughness = (np.array([[getattr(g, name) for g in row] for row in states], dtype=float) for name in GROUPS)
    return Groups(speed, load, roughness, **states[0][0].physics), speed


def _formula_speeds(diagram: Diagram) -> dict[str, Array]:
    """Return the transitions that the formulas give, in the units of the axis; nan where they have none."""
    from stribeck.asymptotics.rough import load_sharing, transitions

    groups, unit = _row_groups(diagram)
    if not diagram.kind.has_formulas:
        return {name: np.full(unit.shape, np.nan) for name in LABELS if name.startswith(("formula_speed", "printed_speed"))}
    boundary_friction, beta = diagram.boundary_friction, diagram.beta
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


def _formula_merging(diagram: Diagram) -> Array:
    from stribeck.asymptotics.rough import transitions

    groups, _ = _row_groups(diagram)
    loads = np.asarray(groups.load)[:, 0]
    if not (diagram.kind.has_formulas and transitions.speed_at_minimum.holds_for(groups.law)):
        return np.full(len(loads), np.nan)
    line = np.asarray(transitions.roughness_without_minimum(loads, diagram.boundary_friction, diagram.beta))
    if diagram.contact is None:
        return line
    return line / float(diagram.contact.replace(roughness=1.0).groups.roughness)


def _attributes(diagram: Diagram) -> dict[str, Any]:
    complete = diagram.outcome.ok and bool((diagram.outcomes == "CONVERGED").all())
    return {
        "title": f"Phase diagram of a lubricated rough {diagram.physics['geometry']} contact",
        "source": f"stribeck {version('stribeck')}",
        "outcome": diagram.outcome.value,
        "complete": int(complete),
        "definition": diagram.definition,
        **law_attributes(_row_groups(diagram)[0].law),
        "rtol": diagram.rtol,
        "boundary_friction": diagram.boundary_friction,
        "beta": diagram.beta,
        **input_attributes(diagram.contact, *AXES),
    }
