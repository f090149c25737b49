"""The fields of a ball around the contact as an xarray dataset, with units, names and provenance."""

from __future__ import annotations

import math
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.contact_laws.law import law_attributes
from stribeck.files.writing import MissingExtraError
from stribeck.quantities.inputs import unit_of
from stribeck.quantities.outputs import GROUPS
from stribeck.quantities.units import InputError, show

if TYPE_CHECKING:
    import xarray

    from stribeck.solver.point.solution import PointSolution

MOST_POINTS = 2001


def field_dataset(solution: PointSolution, points: int, reach: float) -> xarray.Dataset:
    """Return the fields on a square of ``points`` by ``points`` that reaches ``reach`` Hertz radii from the centre."""
    if isinstance(points, bool) or not isinstance(points, int) or not 2 <= points <= MOST_POINTS:
        raise InputError(f"points = {show(points)}; it must be a whole number from 2 to {MOST_POINTS}.")
    if isinstance(reach, bool) or not isinstance(reach, int | float) or not (reach > 0 and math.isfinite(reach)):
        raise InputError(f"reach = {show(reach)}; it must be a positive number of Hertz radii.")
    try:
        import xarray
    except ImportError:
        raise MissingExtraError("a dataset", "data", "xarray") from None

    along = np.linspace(-reach, reach, points)
    found = solution.field(along, along[:, None])
    contact = solution.contact
    hertz = None if contact is None else contact.hertz
    length, gap, pressure = (1.0, 1.0, 1.0) if hertz is None else (hertz.half_width, hertz.indentation, hertz.pressure)
    metre, pascal = ("1", "1") if hertz is None else ("m", "Pa")
    unit = "" if hertz is not None else ", in Hertz units"

    def plane(values: Any, units: str, name: str) -> tuple[tuple[str, str], Any, dict[str, str]]:
        return ("y", "x"), values, {"units": units, "long_name": name + unit}

    return xarray.Dataset(
        {
            "gap": plane(found.gap * gap, metre, "gap"),
            "contact_pressure": plane(found.contact_pressure * pressure, pascal, "contact pressure"),
            "fluid_pressure": plane(found.fluid_pressure * pressure, pascal, "fluid pressure"),
        },
        coords={
            "x": ("x", along * length, {"units": metre, "long_name": "position along the motion, inlet at x < 0" + unit}),
            "y": ("y", along * length, {"units": metre, "long_name": "position across the motion" + unit}),
        },
        attrs=_attributes(solution),
    )


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
