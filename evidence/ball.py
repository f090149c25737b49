"""The solver of the ball as the reference for its formulas: states, rows of them over the speed, and their observables.

Source: none; the counterpart of :mod:`evidence.formulas` for the point geometry.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups
from stribeck.solver.point.solve import solve_cold, solve_from
from stribeck.solver.point.state import PointObservables, PointState

REFERENCE_RTOL = 1e-5  # Relative tolerance of the reference states.

MIN_FLUID_SHARE = 1e-5  # Share of the fluid below which the solver is no reference: the errors of shares are absolute.


@lru_cache(maxsize=1024)
def state(groups: Groups) -> PointState:
    """Return the state of the ball, solved from cold."""
    return _sound(solve_cold(groups, REFERENCE_RTOL))


def row(states: list[Groups]) -> list[PointState | None]:
    """Return states of one load and roughness at ascending speeds; None where none was found."""
    # Rough states are solved from their neighbour, smooth ones from cold: at the same cost their minima err less.
    found: list[PointState | None] = []
    before: PointState | None = None
    for groups in states:
        try:
            begun = before if groups.roughness else None
            before = state(groups) if begun is None else _sound(solve_from(begun, groups, REFERENCE_RTOL))
            found.append(before)
        except RuntimeError:
            found.append(None)
    return found


def _sound(found: PointState) -> PointState:
    if not found.outcome.ok:
        raise RuntimeError(f"{found.groups}: {found.outcome.value}")
    return found


def _fluid_share(found: PointState, _: dict[str, Any]) -> float:
    share = found.values["fluid_load_share"]
    return share if share >= MIN_FLUID_SHARE or found.groups.speed == 0 else math.nan


def _viscous(found: PointState, options: dict[str, Any]) -> float:
    """Return the viscous friction of a whole sphere, or up to the wetted radius in the options."""
    observables = replace(PointObservables.of(found, None), _wetted_radius=options.get("wetted_radius"))
    return observables.viscous_friction(options.get("beta", 1.0), options.get("definition", "balanced"))


def _friction(found: PointState, options: dict[str, Any]) -> float:
    return float(options.get("boundary_friction", 1.0) * found.values["contact_load_share"] + _viscous(found, options))


# Quantities of one state of the ball, with the options of the formula.
OBSERVED: dict[str, Callable[[PointState, dict[str, Any]], float]] = {
    **{
        name: lambda found, _, name=name: found.values[name]  # type: ignore[misc]
        for name in ("central_gap", "minimum_gap", "minimum_gap_on_axis", "offset", "contact_load_share")
    },
    "fluid_load_share": _fluid_share,
    "viscous_friction": _viscous,
    "friction": _friction,
}


def along_the_middle(found: PointState, field: str, x: Array) -> Array:
    """Return a field at positions on the middle line, by the names of the line's profiles."""
    fields = found.fields(x, np.zeros_like(x))
    if field == "pressure":
        return np.asarray(fields.contact_pressure + fields.fluid_pressure)
    return np.asarray(getattr(fields, field))
