"""A state of a ball from a neighbour, from cold where there is none or that fails."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from stribeck.contacts.groups import Groups
from stribeck.equations.point.system import Unknowns
from stribeck.solver.point.refinement import Pair
from stribeck.solver.point.solve import solve_cold, solve_from
from stribeck.solver.point.state import PointState

__all__ = ["next_state", "without_factors"]


def without_factors(state: PointState) -> PointState:
    """Return a state without the factors that fill the memory, from which neighbours may still start."""
    pair = state.work
    if not isinstance(pair, Pair):
        return state
    return replace(state, work=replace(pair, coarse=pair.coarse.without_operators(), fine=pair.fine.without_operators()))


def next_state(
    start: PointState | None,
    groups: Groups,
    rtol: float,
    line: Sequence[tuple[float, PointState]] = (),
    predicted: Unknowns | None = None,
) -> PointState:
    """Return the state of ``groups`` from a neighbour, or from cold without one or if it fails."""
    # ``line`` holds weights and states whose sum predicts this one; ``predicted`` lies on the neighbour's finer mesh.
    if start is None:
        return solve_cold(groups, rtol)
    state = solve_from(start, groups, rtol, line, predicted)
    if state.outcome.ok:
        return state
    cold = solve_cold(groups, rtol)
    return cold if cold.outcome.ok else state
