r"""Continuation: states are solved along one coordinate, in steps as long as what is wanted of them allows.

What lies between two states, and how long a step may be, only the path knows: one of Taylor series, one of values and slopes,
or one that only leads to its last state, :class:`StepPath`.  The module knows no physics.

Source: [Allgower & Georg 1990] Numerical Continuation Methods, chapter 6 (step length from the effort of the
corrector).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Generic, Protocol, Self, TypeVar

import numpy as np
import numpy.typing as npt

from stribeck._types import Array, Flags, Indices
from stribeck.numerics.dual import Dual, slope_of, value_of
from stribeck.numerics.settings import HALF_DIGITS, MAX_LOG_STEP, MAX_STATES, MIN_LOG_STEP, NEGLIGIBLE, STEP_GROWTH
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome

OnInterval = Callable[[float, float], object]
"""What is called with the ends of each step."""


class PathProblem(Protocol):
    """The states along a coordinate."""

    @property
    def path(self) -> Callable[..., Any]:
        """What makes the :class:`Path` of a problem, of no state as yet, with an outcome."""

    def solve(self, s: float, near: Sequence[Any]) -> Any | Outcome:
        """Return the state at ``s``, from neighbours, the first from none, or the outcome of the failure."""


class Path(ABC):
    """Solved states along a coordinate, ascending, what lies between them, and how the path ended."""

    shortest: ClassVar[float] = MIN_LOG_STEP  # A path that needs a shorter step ends
    keeps_interrupted: ClassVar[bool] = True  # Whether an interrupt ends the path with the states so far
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

    def around(self, s: float) -> tuple[Any, Any]:
        """Return the solved states on both sides of a coordinate."""
        k = int(self._interval_of(np.array([s]))[0])
        return self.expansions[k], self.expansions[min(k + 1, len(self.expansions) - 1)]

    def _interval_of(self, s: Array) -> Indices:
        """Return the number of the interval of each coordinate."""
        return np.clip(np.searchsorted(self.coordinates, s, side="right") - 1, 0, max(len(self.coordinates) - 2, 0))

    def pieces(self, s: Array) -> Iterator[tuple[int, Flags]]:
        """Yield the numbers of the intervals in which coordinates lie, and which lie there."""
        where = self._interval_of(s)
        for k in np.unique(where).tolist():
            yield k, where == k

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
            step = min(left, MAX_LOG_STEP, max(path.shortest, path.step_length(upwards, rtol)))
            if left < 2 * step:  # two equal steps rather than a long and a short one
                step = left if left <= (1 + HALF_DIGITS) * step else 0.5 * left
            while isinstance(
                new := problem.solve(_next_coordinate(here, end, step, upwards), path.last_states(upwards)), Outcome
            ):
                step /= STEP_GROWTH
                if step < path.shortest:
                    break
            if isinstance(new, Outcome):
                outcome = new
                break
            path = _halve_intervals(path.with_state(new), rtol, False, upwards, refused)
            if on_interval is not None:
                on_interval(*sorted((here.coordinate, new.coordinate)))
            here = new
        path = _halve_intervals(path, rtol, True, upwards, refused)
    except KeyboardInterrupt:
        if not path.keeps_interrupted:
            raise
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


class Steered(Protocol):
    """A state that is solved on the way to another: how its solve ended, and how much work that took."""

    @property
    def outcome(self) -> Outcome: ...  # noqa: D102

    @property
    def effort(self) -> float: ...  # noqa: D102


S = TypeVar("S", bound=Steered)


class ReadablePath(Path):
    """A path that gives the observables between its states, too."""

    @abstractmethod
    def on_interval(self, k: int, s: Any) -> Any:
        """Return the observables on interval k, at coordinates that may bring their derivatives."""

    def smooth(self, s: Any) -> Any:
        """Return the observables, without errors, at coordinates that may bring their derivatives, shape (len(s), n)."""
        places = value_of(s)
        found = np.empty((2, len(places), len(self.expansions[0].values)))
        for k, mine in self.pieces(places):
            here = self.on_interval(k, s[mine])
            found[0, mine], found[1, mine] = value_of(here), slope_of(here)
        return Dual(*found) if isinstance(s, Dual) else found[0]


@dataclass(frozen=True)
class Step(Generic[S]):
    """A state on the way to another."""

    coordinate: float
    state: S
    growth: float = 1.0  # Ratio of the next step to the one that led here


@dataclass(frozen=True, eq=False)
class StepPath(Path, Generic[S]):
    """The states on the way to another; each step is as long as the effort of the one before allows."""

    shortest: ClassVar[float] = NEGLIGIBLE**2 * MIN_LOG_STEP
    keeps_interrupted: ClassVar[bool] = False  # Nobody asked for a part of the way
    problem: Steps[S]
    steps: tuple[Step[S], ...]  # In their order, which descends where the path goes down
    outcome: Outcome

    @property
    def expansions(self) -> tuple[Step[S], ...]:
        """The steps."""
        return self.steps

    @property
    def states(self) -> tuple[S, ...]:
        """The states in the order of the steps."""
        return tuple(each.state for each in self.steps)

    def with_state(self, new: Step[S]) -> StepPath[S]:
        """Return the path with one more step."""
        return replace(self, steps=(*self.steps, new))

    def last_states(self, upwards: bool) -> Sequence[Step[S]]:
        """Return the last states, as many as predict the next."""
        return self.steps[-self.problem.order - 1 :]

    def nearer_end(self, s: float) -> Step[S]:
        """Return the last state."""
        return self.steps[-1]

    def step_length(self, upwards: bool, rtol: float) -> float:
        """Return the length of the next step by the effort of the last."""
        if len(self.steps) < 2:
            return self.problem.first
        before, last = self.steps[-2:]
        return last.growth * abs(last.coordinate - before.coordinate)

    def intervals_to_halve(self, rtol: float, is_whole: bool) -> Sequence[int]:
        """Return no interval: what lies between the states is not asked for."""
        return ()


class Steps(Generic[S]):
    """The problem of a path to a state: each is corrected from those before it."""

    path = StepPath
    order = 3  # Degree of the prediction
    aim = 4.0  # Effort at which the step is kept; two less doubles it, two more halve it

    def __init__(
        self, correct: Callable[[float, Sequence[tuple[float, S]]], S | None], first: float = NEGLIGIBLE * MAX_LOG_STEP
    ) -> None:
        self.correct, self.first = correct, first  # ``first`` is the length of the first step
        self._failed, self._tries = False, 0

    def solve(self, s: float, near: Sequence[Step[S]]) -> Step[S] | Outcome:
        """Return the state at ``s``, corrected from those before it, or the outcome of the failure."""
        self._tries += 1
        if self._tries > MAX_STATES:
            return Outcome.PATH_LOST
        state = self.correct(s, [(each.coordinate, each.state) for each in near])
        if state is None or not state.outcome.ok:
            self._failed = True
            return Outcome.PATH_LOST if near or state is None else state.outcome
        # The step after one that failed is no longer than this.
        longest, self._failed = 1.0 if self._failed else STEP_GROWTH, False
        return Step(s, state, min(longest, max(1.0 / STEP_GROWTH, 2.0 ** (0.5 * (self.aim - state.effort)))))

    def to(self, end: float, start: float | tuple[float, S]) -> StepPath[S]:
        """Return the path to ``end``, from a coordinate or from a state at one."""
        found: StepPath[S] = follow(self, start if isinstance(start, float) else Step(*start), end, 0.0)
        return found


def extrapolation_weights(coordinates: npt.ArrayLike, s: float) -> Array:
    r"""Return the weights of the polynomial through given points at s: :math:`\prod_{j \ne i} (s - s_j)/(s_i - s_j)`."""
    c = np.asarray(coordinates, dtype=np.float64)
    others = ~np.eye(c.size, dtype=bool)
    top = np.where(others, s - c[None, :], 1.0)
    bottom = np.where(others, c[:, None] - c[None, :], 1.0)
    weights: Array = np.prod(top / bottom, axis=1)
    return weights


def steady_weights(coordinates: npt.ArrayLike, s: float, limit: float) -> Array:
    """Return the weights of the last points whose polynomial amplifies their errors at s by at most a limit, one at least."""
    c = np.asarray(coordinates, dtype=np.float64)
    for first in range(c.size - 1):
        weights = extrapolation_weights(c[first:], s)
        if np.abs(weights).sum() <= limit:
            return weights
    return np.ones(1)
