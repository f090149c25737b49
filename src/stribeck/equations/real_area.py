"""The real area of contact of a line by its contact pressure, over that of the dry smooth contact, 2a per length."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import WithArea, area_slope
from stribeck.contacts.groups import Groups, contact_law
from stribeck.equations.line import LOAD
from stribeck.equations.state import State
from stribeck.numerics.panels import Mesh
from stribeck.numerics.settings import LOG_STEP
from stribeck.quantities.outputs import GROUPS

__all__ = ["area_by_pressure", "area_derivatives", "area_of_state", "real_area"]


def real_area(groups: Groups, mesh: Mesh, stretch: float, contact: Array, load_error: float) -> tuple[float, float]:
    """Return the real area by a contact pressure at the nodes and its absolute error, by that of the load on asperities."""
    law: Any = groups.law
    scale = float(groups.pressure_scale)
    value = area_by_pressure(groups, mesh, stretch, contact)
    # The logarithm of the pressure is smooth; where it is too small for one it carries nothing.
    fine, logs = mesh.refined(2 * mesh.order), np.log(np.maximum(contact, np.finfo(float).tiny))
    missed = abs(area_by_pressure(groups, fine, stretch, np.exp(mesh.to_order(logs, fine.order))) - value)
    # No area grows faster with the load than at small pressure.
    return value, missed + 0.5 * LOAD * area_slope(law) * scale * load_error


def area_of_state(state: State, load_error: float) -> tuple[float, float]:
    """Return the real area of a sliding state and its error; smooth surfaces touch nowhere."""
    if state.groups.roughness == 0:
        return 0.0, 0.0
    contact = state.equations.contact(state.gap)
    return real_area(state.groups, state.mesh, state.cavity_stretch, contact, load_error)


def area_derivatives(state: State, moves: Array) -> Array:
    """Return the derivatives of the real area by the logarithms of the groups, then along changes of the model.

    ``moves`` are those of the unknowns; the area of a law that does not know it is nan, that of smooth surfaces zero.
    """
    groups = state.groups
    if groups.roughness == 0 or not isinstance(groups.law, WithArea):
        return np.full(len(moves), 0.0 if groups.roughness == 0 else math.nan)
    found = []
    for k, move in enumerate(moves):
        # So small a step that no pressure changes by more than the step itself.
        gap = state.equations.layout.gap
        step = LOG_STEP / max(1.0, float(np.abs(move[gap]).max()) / float(groups.relative_roughness))
        ends = [_moved_area(state, move, GROUPS[k] if k < len(GROUPS) else None, each) for each in (step, -step)]
        found.append((ends[0] - ends[1]) / (2 * step))
    return np.array(found)


def _moved_area(state: State, move: Array, group: str | None, step: float) -> float:
    """Return the area of a state after a small step along a direction of its unknowns and of one group."""
    groups, equations, y = state.groups, state.equations, state.y + step * move
    if group is not None:
        groups = replace(groups, **{group: float(getattr(groups, group)) * math.exp(step)})  # type: ignore[arg-type]
    u = equations.fields(y)
    contact = replace(equations, law=contact_law(groups)).contact(u.gap)
    stretch = 1.0 if u.cavity_stretch is None else float(u.cavity_stretch[0])
    return area_by_pressure(groups, state.mesh, stretch, contact)


def area_by_pressure(groups: Groups, mesh: Mesh, stretch: float, contact: Array) -> float:
    """Return the real area by a contact pressure at the nodes."""
    law: Any = groups.law
    return 0.5 * stretch * float(mesh.weights @ law.area_fraction_at(contact * float(groups.pressure_scale)))
