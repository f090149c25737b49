"""Derivatives of the observables of a solved ball with respect to its groups, and to numbers of its fluid and solid."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups
from stribeck.equations.cavities.capacitance import Capacitance
from stribeck.equations.cavities.system import CavitatedLinear
from stribeck.equations.point.observables import observables
from stribeck.equations.point.preconditioner import BandedModes
from stribeck.equations.point.sensitivity import Direction, Measure, log_derivatives
from stribeck.equations.point.system import Linear
from stribeck.numerics.krylov import Apply
from stribeck.numerics.settings import EPSILON, MAX_BAND
from stribeck.quantities.outputs import GROUPS
from stribeck.solver.point.estimate import Pair
from stribeck.solver.point.state import PointState

__all__ = ["GROUPS", "derivatives_along", "state_derivatives"]


def state_derivatives(
    state: PointState, by: Sequence[str] = GROUPS, measure: Measure = observables, tolerance: float = EPSILON
) -> dict[str, Array]:
    """Return the derivatives of all observables with respect to ln(speed), ln(load) and ln(roughness)."""
    groups = state.groups
    alive = {name: partial(_moved, groups, name) for name in GROUPS if name in by and float(getattr(groups, name)) > 0}
    if not alive:
        return {name: np.zeros(len(GROUPS)) for name in state.values}
    found = derivatives_along(state, alive, measure, tolerance)
    zero = np.array([name not in alive for name in GROUPS])
    columns = np.cumsum(~zero) - 1
    return {name: np.where(zero, 0.0, column[columns]) for name, column in found.items()}


def derivatives_along(
    state: PointState, directions: Mapping[str, Direction], measure: Measure = observables, tolerance: float = EPSILON
) -> dict[str, Array]:
    """Return the derivatives of all observables along directions, to a relative tolerance."""
    pair = state.work
    assert isinstance(pair, Pair)
    level = pair.fine

    def preconditioner(linear: Linear, kept: Any) -> Apply:
        if not isinstance(linear, CavitatedLinear):
            return BandedModes(linear, MAX_BAND) if kept is None else kept
        found = Capacitance(BandedModes(linear, MAX_BAND), level.mesh, linear.cavitated.shape) if kept is None else kept
        return found.of(linear)

    kept = level.iterated.preconditioner
    return log_derivatives(level.equations, level.unknowns, directions, preconditioner, kept, measure, tolerance)


def _moved(groups: Groups, name: str, step: float) -> Groups:
    return replace(groups, **{name: float(getattr(groups, name)) * math.exp(step)})  # type: ignore[arg-type]
