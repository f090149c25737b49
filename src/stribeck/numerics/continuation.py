r"""Continuation: following the solutions of F(x, p) = 0 while a coordinate or a parameter moves.

:func:`march` chooses the steps: it knows a scalar coordinate and a function that corrects a state there, so that states
may live on meshes that change. The module knows no physics.

Source: [Allgower & Georg 1990] Numerical Continuation Methods, chapter 6 (step length from the effort of the
corrector).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from stribeck._types import Array
from stribeck.numerics.settings import MAX_STATES, STEP_GROWTH
from stribeck.quantities.outcome import Outcome


class State(Protocol):
    """A state of :func:`march`: how its solve ended, and how many factorisations that took."""

    @property
    def outcome(self) -> Outcome: ...  # noqa: D102

    @property
    def effort(self) -> float: ...  # noqa: D102


S = TypeVar("S", bound=State)


@dataclass(frozen=True, eq=False)
class Path(Generic[S]):
    """The points that a march accepted, in its order, and how it ended."""

    coordinates: tuple[float, ...]  # Where the accepted states lie
    states: tuple[S, ...]  # The accepted states
    outcome: Outcome  # CONVERGED at the end asked for, PATH_LOST, or that of the first state if this failed
    failure: S | None  # The last state that failed; where the path was lost, its outcome says why


@dataclass(frozen=True)
class Steps:
    """How long the steps of a march are."""

    first: float  # Length of the first step, > 0
    longest: float  # Length of the longest step, > 0
    shortest: float  # Length of the shortest step, > 0
    order: int = 3  # Degree of the prediction: the corrector sees at most `order + 1` points
    aim: float = 4  # Effort at which the step length is kept; two less doubles it, two more halves it

    def __post_init__(self) -> None:
        """Refuse lengths that are not in order."""
        if not 0 < self.shortest <= self.first <= self.longest < math.inf:
            raise ValueError(
                f"shortest = {self.shortest!r}, first = {self.first!r}, longest = {self.longest!r}; "
                "they must be positive and in this order"
            )


def march(
    correct: Callable[[float, Sequence[tuple[float, S]]], S | None],
    start: float,
    stop: float,
    steps: Steps,
    *,
    history: Sequence[tuple[float, S]] = (),
) -> Path[S]:
    """Follow states from one coordinate to another in steps that adapt to the effort of the corrector."""
    if not (math.isfinite(start) and math.isfinite(stop)):
        raise ValueError(f"start = {start!r}, stop = {stop!r}; both must be finite")
    if history and history[-1][0] != start:
        raise ValueError(f"history ends at {history[-1][0]!r}; its last point must lie at start = {start!r}")
    sign = 1.0 if stop >= start else -1.0
    points = list(history)
    failure: S | None = None
    length, may_grow = steps.first, True

    def path(outcome: Outcome) -> Path[S]:
        return Path(tuple(s for s, _ in points), tuple(state for _, state in points), outcome, failure)

    if not points:
        state = correct(start, [])
        if state is None or not state.outcome.ok:
            failure = state
            return path(Outcome.PATH_LOST if state is None else state.outcome)
        points.append((start, state))
    for _ in range(MAX_STATES):
        here = points[-1][0]
        if here == stop:
            return path(Outcome.CONVERGED)
        left = abs(stop - here)
        step = left if left <= length else min(length, 0.5 * left)
        s = stop if step == left else here + sign * step
        state = correct(s, points[-steps.order - 1 :]) if s != here else None
        if state is None or not state.outcome.ok:
            failure = failure if state is None else state
            length, may_grow = 0.5 * step, False
            if length < steps.shortest:
                return path(Outcome.PATH_LOST)
            continue
        points.append((s, state))
        factor = min(STEP_GROWTH, max(1.0 / STEP_GROWTH, 2.0 ** (0.5 * (steps.aim - state.effort))))
        if factor < 1.0:
            length = max(steps.shortest, factor * step)
        elif may_grow:
            length = min(steps.longest, factor * step)
        may_grow = True
    return path(Outcome.PATH_LOST)


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
