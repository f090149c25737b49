"""States of a ball along one coordinate: each from the nearest one that is solved, from cold where there is none."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from stribeck.contacts.groups import Groups
from stribeck.equations.point.system import Unknowns
from stribeck.numerics.continuation import extrapolation_weights
from stribeck.solver.point.refinement import Pair
from stribeck.solver.point.solve import solve_cold, solve_from
from stribeck.solver.point.state import PointState

__all__ = ["NeighbourSolver", "next_state", "without_factors"]

PREDICTION_ORDER = 2  # Degree of the polynomial that predicts a state from its neighbours
MAX_WEIGHT_SUM = 8.0  # A prediction with larger weights amplifies the neighbours' errors and is not used
MAX_LOG_DISTANCE = 3.5  # A neighbour farther than this in the logarithms of its groups is no useful start


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


class NeighbourSolver:
    """Solves states along a coordinate in any order, each from the nearest one, and keeps them."""

    def __init__(self, groups_at: Callable[[float], Groups], rtol: float) -> None:
        self.groups_at, self.rtol = groups_at, rtol
        self.states: dict[float, PointState] = {}
        self._last: tuple[float, PointState] | None = None

    def __call__(self, s: float) -> PointState:
        """Return the state at ``s``; a failure is in its outcome."""
        if s in self.states:
            return self.states[s]
        state = next_state(self._start(s), self.groups_at(s), self.rtol, self._line(s))
        if state.outcome.ok:
            self._last = s, state
            self.states[s] = without_factors(state)
        return state

    def release(self) -> None:
        """Forget the factors of the last state, which fill the memory."""
        self._last = None

    def _start(self, s: float) -> PointState | None:
        """Return the nearest solved state, preferably the last one with its factors, or None."""
        near = [(abs(c - s), state) for c, state in self.states.items() if abs(c - s) <= MAX_LOG_DISTANCE]
        if not near:
            return None
        distance, state = min(near, key=lambda pair: pair[0])
        if self._last is not None and abs(self._last[0] - s) <= 1.01 * distance:
            return self._last[1]
        return state

    def _line(self, s: float) -> list[tuple[float, PointState]]:
        """Return the nearest sliding states with the weights that extrapolate them."""
        moving = [c for c, state in self.states.items() if isinstance(state.work, Pair)]
        near = sorted((abs(c - s), c) for c in moving if abs(c - s) <= MAX_LOG_DISTANCE)
        places = [c for _, c in near[: PREDICTION_ORDER + 1]]
        if len(places) < 2:
            return []
        weights = extrapolation_weights(places, s).tolist()
        if sum(abs(weight) for weight in weights) > MAX_WEIGHT_SUM:
            return []
        return [(weight, self.states[c]) for weight, c in zip(weights, places, strict=True)]
