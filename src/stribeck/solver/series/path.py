r"""A path of states along one coordinate, the logarithm of whatever varies, as a function of it.

A few states are solved and expanded into Taylor series; between two of them each observable is the polynomial that has the
coefficients of both.  A step is as long as their radius of convergence allows; where the polynomial of all orders differs from
that without the highest by more than the tolerance a state is solved in between.  The stated error of an observable is the
larger of those of both ends, and this difference.

What the states are is known to a :class:`Problem` alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from stribeck._types import Array, Flags
from stribeck.numerics.hermite import hermite_weights
from stribeck.quantities.outcome import Outcome

LONGEST_STEP = 4.0
SHORTEST_STEP = 1e-3

REACH = 0.95
"""Largest step over the radius of convergence."""

KNOT_PART = 0.75
"""Part of the tolerance that a solved state must hold: the rest is for what lies between."""

CHECKED = 0.85
"""Part of the tolerance that an interval must hold where it is checked."""

CHECKS = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, 14) / 14)
"""Where an interval is checked, in parts of it."""

LOST = 1e3
"""Value over what its interpolation misses below which a share goes by its logarithm."""

MIDDLE = np.array([0.5])

LONGEST_END = 0.05
"""Longest interval on which an observable may cease to exist."""

DEEPEST = 12
"""Halvings of an interval after which it is left as it is, with the error that it has."""


@dataclass(frozen=True, eq=False)
class Expansion:
    """Taylor coefficients of observables about a solved state, order by order in the first axis.

    Attributes
    ----------
    coordinate : float
        Where the state is.
    point : object
        The state, as its problem knows it.
    series : ndarray, shape (K + 1, n)
        Coefficients of the observables.
    logs : ndarray, shape (K + 1, n)
        Those of their logarithms; nan where there are none.
    errors : ndarray, shape (n,)
        Estimated errors at the state, in units of the scales of :class:`Problem`.
    radius : float
        About the radius of convergence.
    """

    coordinate: float
    point: Any
    series: Array
    logs: Array
    errors: Array
    radius: float

    @property
    def order(self) -> int:
        """K."""
        return len(self.series) - 1


class Problem(Protocol):
    """What a path asks of the states that it follows."""

    @property
    def held(self) -> Flags:
        """Which observables the tolerance holds for."""

    @property
    def signed(self) -> Flags:
        """Which observables may cross zero: absolute errors of the ends count between them, for others relative ones."""

    def solve(self, s: float, near: Sequence[Expansion]) -> Expansion | Outcome:
        """Return the expanded state at ``s``; ``near`` holds none, the last, or both that it lies between.

        A failure is returned as its outcome.
        """

    def scales(self, values: Array, s: Array) -> Array:
        """Return what errors of observables at coordinates s, shape (len(s), n), are relative to."""

    def missed(self, left: Expansion, right: Expansion, values: Array) -> Array:
        """Return by how much the equations contradict ``values`` in the middle between two expansions, in units of the scales.

        Zero where the coefficients are surely right.
        """

    def read(self, left: Expansion, right: Expansion, parts: Array) -> tuple[Array, Array, Sequence[int]]:
        """Return observables that have no series, at parts of an interval: values, errors, and their columns."""


def _hermite(left: Array, right: Array, parts: Array) -> Array:
    of_left, of_right = hermite_weights(len(left) - 1, parts)
    return np.asarray(of_left @ left + of_right @ right)


def _missed(left: Array, right: Array, parts: Array) -> Array:
    r"""Return by how much the interpolation changes with its highest order K, at most.

    The change is :math:`(\tau (1 - \tau))^K` times a linear function, which may vanish anywhere: its larger end counts.
    """
    at = np.array([0.25, 0.75])
    a, b = (_hermite(left, right, at) - _hermite(left[:-1], right[:-1], at)) / (3 / 16) ** (len(left) - 1)
    largest = np.maximum(np.abs(1.5 * a - 0.5 * b), np.abs(1.5 * b - 0.5 * a))
    return np.asarray((parts * (1 - parts))[:, None] ** (len(left) - 1) * largest)


@dataclass(frozen=True, eq=False)
class Interval:
    """What lies between two expansions."""

    problem: Problem
    left: Expansion
    right: Expansion

    @property
    def length(self) -> float:
        """Length, positive."""
        return self.right.coordinate - self.left.coordinate

    @cached_property
    def _forms(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """The coefficients of both ends on an interval of length one: of the observables, and of their logarithms."""
        order = min(self.left.order, self.right.order)
        scale = self.length ** np.arange(order + 1.0)[:, None]
        left, right, log_left, log_right = (
            form[: order + 1] * scale for form in (self.left.series, self.right.series, self.left.logs, self.right.logs)
        )
        return (left, right), (log_left, log_right)

    def _interpolated(self, parts: Array) -> tuple[Array, Array]:
        """Return the observables and what the interpolation misses.

        A share that is lost in that goes by its logarithm, which keeps it positive and its digits.
        """
        plain, logs = self._forms
        found, missed = _hermite(*plain, parts), _missed(*plain, parts.real)
        lost = np.isfinite(logs[0][0] + logs[1][0]) & (found.real < LOST * missed)
        if lost.any():
            with np.errstate(over="ignore", invalid="ignore"):
                tiny = np.exp(_hermite(*logs, parts))
            found = np.where(lost & (np.abs(tiny) < LOST * missed), tiny, found)
        return found, missed

    @cached_property
    def _at_ends(self) -> tuple[Array, Array]:
        """Errors at the ends, the larger: in units of the scales there, and absolute, for what crosses zero between."""
        relative = np.stack([self.left.errors, self.right.errors])
        values = np.stack([self.left.series[0], self.right.series[0]])
        scales = self.problem.scales(values, np.array([self.left.coordinate, self.right.coordinate]))
        return relative.max(axis=0), (relative * scales).max(axis=0)

    @cached_property
    def _in_the_middle(self) -> Array:
        """What the problem itself finds wrong in the middle."""
        return self.problem.missed(self.left, self.right, self.smooth(MIDDLE)[0])

    def smooth(self, parts: Array) -> Array:
        """Return what :meth:`at` does, without errors and without what has no series."""
        return self._interpolated(parts)[0]

    def at(self, parts: Array) -> tuple[Array, Array]:
        """Return the observables at parts of the interval, and their errors in units of the scales, shape (len(parts), n)."""
        found, missed = self._interpolated(parts)
        scales = self.problem.scales(found, self.left.coordinate + parts * self.length)
        relative, absolute = self._at_ends
        errors = self._in_the_middle + np.where(self.problem.signed, absolute / scales, relative) + missed / scales
        values, errors_read, columns = self.problem.read(self.left, self.right, parts)
        found[:, columns], errors[:, columns] = values, errors_read
        return found, errors


@dataclass(frozen=True, eq=False)
class SolvedPath:
    """Expansions along a path, ascending, and how it ended.

    Attributes
    ----------
    problem : Problem
        What was followed.
    expansions : tuple of Expansion
        The solved states; those of neighbours hold what lies between them.
    outcome : Outcome
        CONVERGED if the path reaches the end asked for.
    """

    problem: Problem
    expansions: tuple[Expansion, ...]
    outcome: Outcome

    @cached_property
    def coordinates(self) -> Array:
        """Where the solved states are."""
        return np.array([one.coordinate for one in self.expansions])

    @cached_property
    def intervals(self) -> tuple[Interval, ...]:
        """What lies between them."""
        return tuple(Interval(self.problem, *pair) for pair in zip(self.expansions[:-1], self.expansions[1:], strict=True))

    def smooth(self, s: Array) -> Array:
        """Return what :meth:`at` does, without errors and without what has no series, at complex coordinates too."""
        values = np.empty((len(s), self.expansions[0].series.shape[1]), dtype=s.dtype)
        where = self.interval_of(s.real)
        for k in np.unique(where):
            mine, interval = where == k, self.intervals[k]
            values[mine] = interval.smooth((s[mine] - interval.left.coordinate) / interval.length)
        return values

    def interval_of(self, s: Array) -> Array:
        """Return the number of the interval of each coordinate."""
        return np.clip(np.searchsorted(self.coordinates, s, side="right") - 1, 0, len(self.intervals) - 1)

    def at(self, s: Array) -> tuple[Array, Array]:
        """Return the observables at coordinates, shape (len(s), n), and their errors in units of the scales."""
        values = np.empty((len(s), self.expansions[0].series.shape[1]))
        errors = np.empty_like(values)
        where = self.interval_of(s)
        for k in np.unique(where):
            mine, interval = where == k, self.intervals[k]
            parts = np.clip((s[mine] - interval.left.coordinate) / interval.length, 0.0, 1.0)
            values[mine], errors[mine] = interval.at(parts)
        return values, errors


def follow(
    problem: Problem, start: float, end: float, rtol: float, on_interval: Callable[[float, float], object] | None = None
) -> SolvedPath:
    """Return the path from ``start`` down to ``end``.

    Parameters
    ----------
    problem : Problem
        What is followed.
    start, end : float
        Highest and lowest coordinate.
    rtol : float
        Error allowed, in units of the scales.
    on_interval : callable, optional
        ``on_interval(low, high)`` is called when the path from ``start`` is known down to ``low``.

    Returns
    -------
    SolvedPath
        As far as it was reached.
    """
    found: list[Expansion] = []  # descending
    outcome = Outcome.CONVERGED
    try:
        first = problem.solve(start, [])
        if isinstance(first, Outcome):
            return SolvedPath(problem, (), first)
        found.append(first)
        while (here := found[-1]).coordinate > end:
            left = here.coordinate - end
            step = min(left, LONGEST_STEP, _step(here, rtol))
            if left < 2 * step:  # two like steps rather than a long and a short one
                step = left if left <= step else 0.5 * left
            while isinstance(new := problem.solve(end if step == left else here.coordinate - step, [here]), Outcome):
                step *= 0.5
                if step < SHORTEST_STEP or new is Outcome.INTERRUPTED:
                    return SolvedPath(problem, tuple(found[::-1]), new)
            for one in _refined(problem, new, here, rtol)[::-1]:
                found.append(one)
            if on_interval is not None:
                on_interval(new.coordinate, here.coordinate)
    except KeyboardInterrupt:
        outcome = Outcome.INTERRUPTED
    return SolvedPath(problem, tuple(found[::-1]), outcome)


def _step(here: Expansion, rtol: float) -> float:
    """Return the longest step that the coefficients promise to interpolate within the tolerance."""
    order = here.order
    return here.radius * min(REACH, 2.0 * float((0.1 * rtol) ** (0.5 / max(order, 1))))


def _refined(problem: Problem, left: Expansion, right: Expansion, rtol: float, depth: int = 0) -> list[Expansion]:
    """Return the expansions from ``left`` on, without ``right``, that interpolate within the tolerance."""
    interval = Interval(problem, left, right)
    if depth == DEEPEST:
        return [left]
    exists = [np.isfinite(one.series).all(axis=0) for one in (left, right)]
    ends_between = bool((exists[0] != exists[1]).any()) and interval.length > LONGEST_END  # what exists on one side alone
    if not ends_between and np.nanmax(interval.at(CHECKS)[1][:, problem.held]) <= CHECKED * rtol:
        return [left]
    middle = problem.solve(0.5 * (left.coordinate + right.coordinate), [left, right])
    if isinstance(middle, Outcome):
        return [left]
    return [*_refined(problem, left, middle, rtol, depth + 1), *_refined(problem, middle, right, rtol, depth + 1)]
