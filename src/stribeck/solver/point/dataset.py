"""The fields of a ball around the contact as an xarray dataset, with units, names and provenance."""

from __future__ import annotations

import math
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.contact_laws.law import law_attributes
from stribeck.quantities.inputs import unit_of
from stribeck.quantities.outputs import GROUPS
from stribeck.quantities.units import InputError, show

if TYPE_CHECKING:
    import xarray

    from stribeck.solver.point.solution import PointSolution

MAX_POINTS = 2001  # Points along a side: a file of more would take gigabytes


def field_dataset(solution: PointSolution, points: int, reach: float) -> xarray.Dataset:
    """Return the fields on a square of ``points`` by ``points`` that reaches ``reach`` Hertz radii from the centre."""
    if isinstance(points, bool) or not isinstance(points, int) or not 2 <= points <= MAX_POINTS:
        raise InputError(f"points = {show(points)}; it must be a whole number from 2 to {MAX_POINTS}.")
    if isinstance(reach, bool) or not isinstance(reach, int | float) or not (reach > 0 and math.isfinite(reach)):
        raise InputError(f"reach = {show(reach)}; it must be a positive number of Hertz radii.")
    along = np.linspace(-reach, reach, points)
    if solution.contact is not None:
        along = along * solution.contact.hertz.half_width
    found = solution.field if solution.contact is None else solution.to_si
    return found(along, along[:, None]).to_dataset().assign_attrs(_attributes(solution))


def _attributes(solution: PointSolution) -> dict[str, Any]:
    """Return what belongs to the whole state: provenance, groups, inputs, observables, outcome."""
    found: dict[str, Any] = {
        "title": "State of a lubricated rough ball on a flat",
        "source": f"stribeck {version('stribeck')}",
        "geometry": solution.groups.geometry,
        "outcome": solution.outcome.value,
        "rtol": solution.rtol,
        **law_attributes(solution.groups.law, solution.law == "smooth"),
    }
    found |= {f"{name}_group": float(getattr(solution.groups, name)) for name in GROUPS}
    if solution.contact is not None:
        inputs, table = dict(solution.contact.inputs()), solution.contact.INPUTS
        found |= {f"input_{name}": value for name, value in inputs.items()}
        found["input_units"] = ", ".join(f"{name} {unit_of(name, table)}" for name in inputs)
    found |= {row.name: getattr(solution, row.name) for row in solution.outputs.rows if row.listed}
    friction = solution.friction()
    found |= {"friction": friction.total, "friction_contact": friction.contact, "friction_viscous": friction.viscous}
    found["notes"] = "\n".join(solution.notes)
    return found
