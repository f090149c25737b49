"""Following a path: states are solved along one coordinate, in steps as long as what lies between them is known well.

What lies between two states, and how long a step may be, only the path knows: one of Taylor series, or of values and slopes.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Protocol, Self

import numpy as np

from stribeck._types import Array
from stribeck.numerics.settings import HALF_DIGITS, MAX_LOG_STEP, MAX_STATES, MIN_LOG_STEP, STEP_GROWTH
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome

__all__ = ["PathProblem", "Path", "follow"]

OnInterval = Callable[[float, float], object]
"""What is called with the ends of each step."""


class PathProblem(Protocol):
    """The states along a coordinate."""

    @property
    def path(self) -> Callable[..., Any]:
        """What makes the :class:`Path` of a problem, of no state as yet, with an outcome."""

    def solve(self, s: float, near: Sequence[Any]) -> Any | Outcome:
        """Return the state at ``s``, from no, one or two neighbours ``near``, or the outcome of the failure."""


class Path(ABC):
    """Solved states along a coordinate, ascending, what lies between them, and how the path ended."""

    problem: Any
    outcome: Outcome  # CONVERGED if the path reaches the end asked for

    @property
    @abstractmethod
    def expansions(self) -> tuple[Any, ...]:
        """The solved states."""

    @abstractmethod
    def with_state(self, new: Any) -> Self:
        """Return the path with one more state, beyond its ends or between others."""

    @abstractmethod
    def step_length(self, upwards: bool, rtol: float) -> float:
        """Return how long the next step should be."""

    @abstractmethod
    def intervals_to_halve(self, rtol: float, is_whole: bool) -> Sequence[int]:
        """Return the numbers of the intervals to be halved, of a path that is whole or still grows."""

    def on_branch(self, upwards: bool) -> Self:
        """Return the path as far as its states lie on one branch of solutions, by default the whole."""
        return self

    @cached_property
    def coordinates(self) -> Array:
        """Where the solved states are."""
        return np.array([one.coordinate for one in self.expansions])

    def nearest(self, s: float) -> Any:
        """Return the solved state that is nearest to a coordinate."""
        return self.expansions[int(np.argmin(np.abs(self.coordinates - s)))]

    def nearer_end(self, s: float) -> Any:
        """Return the first or the last state, whichever is nearer to a coordinate."""
        first, *_, last = self.expansions[0], *self.expansions
        return min(first, last, key=lambda one: float(abs(one.coordinate - s)))

    def last_states(self, upwards: bool) -> Sequence[Any]:
        """Return the states from which the path grows."""
        return [self.expansions[-1 if upwards else 0]]

    def places(self, parts: Array) -> Array:
        """Return coordinates at parts of all intervals, and the last one."""
        starts, lengths = self.coordinates[:-1], np.diff(self.coordinates)
        return np.append((starts[:, None] + parts * lengths[:, None]).ravel(), self.coordinates[-1])

    def continued(
        self,
        end: float,
        rtol: float,
        on_interval: OnInterval | None = None,
        until: Callable[[Self], bool] | None = None,
    ) -> Self:
        """Return the path from the nearer end of this one to ``end``, or as far as ``until`` holds of it."""
        found: Self = follow(self.problem, self.nearer_end(end), end, rtol, on_interval, until)
        return found


def follow(
    problem: PathProblem,
    start: Any,
    end: float,
    rtol: float,
    on_interval: OnInterval | None = None,
    until: Callable[[Any], bool] | None = None,
) -> Any:
    """Return the path from a coordinate, a state or a path to ``end``, or as far as ``until`` holds of it."""
    outcome = Outcome.CONVERGED
    path: Any = problem.path(problem, (), outcome)
    refused: set[float] = set()
    try:
        if isinstance(start, Path):
            path, here = start, start.nearer_end(end)
        else:
            here = problem.solve(start, []) if isinstance(start, float) else start
            if isinstance(here, Outcome):
                return replace(path, outcome=here)
            path = path.with_state(here)
        upwards = end > here.coordinate
        while (left := abs(end - here.coordinate)) > 0 and not (until is not None and until(path)):
            if len(path.expansions) >= MAX_STATES:
                outcome = Outcome.STATE_LIMIT
                break
            step = min(left, MAX_LOG_STEP, max(MIN_LOG_STEP, path.step_length(upwards, rtol)))
            if left < 2 * step:  # two equal steps rather than a long and a short one
                step = left if left <= (1 + HALF_DIGITS) * step else 0.5 * left
            while isinstance(
                new := problem.solve(_next_coordinate(here, end, step, upwards), path.last_states(upwards)), Outcome
            ):
                step /= STEP_GROWTH
                if step < MIN_LOG_STEP:
                    break
            if isinstance(new, Outcome):
                outcome = new
                break
            longer = _halve_intervals(path.with_state(new), rtol, False, upwards, refused)
            path = longer.on_branch(upwards)
            if path is not longer:
                outcome = Outcome.PATH_LOST
                break
            if on_interval is not None:
                on_interval(*sorted((here.coordinate, new.coordinate)))
            here = new
        path = _halve_intervals(path, rtol, True, upwards, refused)
    except KeyboardInterrupt:
        outcome = Outcome.INTERRUPTED
    return replace(path, outcome=outcome)


def _next_coordinate(here: Any, end: float, step: float, upwards: bool) -> float:
    """Return the coordinate one step further, or exactly the end."""
    there: float = here.coordinate + (step if upwards else -step)
    return end if step == abs(end - here.coordinate) else there


def _halve_intervals(path: Path, rtol: float, is_whole: bool, upwards: bool, refused: set[float]) -> Path:
    """Return a path whose poor intervals are halved, but those whose middle was ``refused`` by the solver."""
    while len(path.expansions) < MAX_STATES:
        states = path.expansions
        ends = [(states[k], states[k + 1]) for k in path.intervals_to_halve(rtol, is_whole)]
        middles = {0.5 * (left.coordinate + right.coordinate): (left, right) for left, right in ends}
        wanted = [s for s, (left, right) in middles.items() if s not in refused and right.coordinate - s > MIN_LOG_STEP]
        if not wanted:
            break
        for s in wanted[::-1] if upwards else wanted:
            new = path.problem.solve(s, middles[s])
            if isinstance(new, Outcome):
                refused.add(s)
            else:
                path = path.with_state(new)
    return path
