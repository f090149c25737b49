r"""A path of states along one coordinate, the logarithm of whatever varies, as a function of it.

A few states are solved and expanded into Taylor series; between two of them each observable is the polynomial that has the
coefficients of both.  A step is as long as their radius of convergence allows; where the polynomial of all orders differs from
that without the highest by more than the tolerance a state is solved in between.  The stated error of an observable is the
larger of those of both ends, and this difference.

What the states are is known to a :class:`Problem` alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from stribeck._types import Array, Flags
from stribeck.numerics.hermite import chebyshev_basis, chebyshev_form, chebyshev_nodes, hermite
from stribeck.quantities.outcome import Outcome

LONGEST_STEP = 4.0
SHORTEST_STEP = 1e-3

REACH = 0.95
"""Largest step over the radius of convergence."""

KNOT_PART = 0.75
"""Part of the tolerance that a solved state must hold: the rest is for what lies between."""

CHECKED = 0.85
"""Part of the tolerance that an interval must hold where it is checked."""

REDUCIBLE = 0.25
"""Part of the tolerance that interpolation must miss for a shorter interval to help."""

READ_AT = 16
"""Places of an interval at which what has no series is read, for a polynomial between them."""

TAIL = 3.0
"""What a polynomial is wrong by, over the largest of its last three coefficients."""

CHECKS = 0.5 - 0.5 * np.cos(np.pi * np.arange(1, 30) / 30)
"""Where an interval is checked, in parts of it."""

LOST = 1e3
"""Value over what its interpolation misses below which a share goes by its logarithm."""

MIDDLE = np.array([0.5])

LONGEST_END = 0.05
"""Longest interval on which an observable may cease to exist."""

SHORTEST_INTERVAL = 0.01
"""Length below which an interval is left as it is, with the error that it has: where a film ruptures no series converges."""

NOISY, PROGRESS = 0.2, 0.8
"""Length below which halving an interval has to take its error to this part of what it was, or the error is rounding."""


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

    def read_scales(self, values: Array) -> Array:
        """Return the same for what has no series."""

    def missed(self, left: Expansion, right: Expansion, values: Array) -> Array:
        """Return by how much the equations contradict ``values`` in the middle between two expansions, in units of the scales.

        Zero where the coefficients are surely right.
        """

    def read(self, left: Expansion, right: Expansion, parts: Array) -> tuple[Array, Array, Sequence[int]]:
        """Return observables that have no series, at parts of an interval: values, errors, and their columns."""


def _missed(left: Array, right: Array) -> Array:
    r"""Return by how much the interpolation changes with its highest order K, at most, over :math:`(\tau (1 - \tau))^K`.

    The change is that times a linear function, which may vanish anywhere: its larger end counts.
    """
    at = np.array([0.25, 0.75])
    a, b = (hermite(left, right, 1.0, at) - hermite(left[:-1], right[:-1], 1.0, at)) / (3 / 16) ** (len(left) - 1)
    return np.asarray(np.maximum(np.abs(1.5 * a - 0.5 * b), np.abs(1.5 * b - 0.5 * a)))


@dataclass(frozen=True, eq=False)
class Interval:
    """What lies between two expansions."""

    problem: Problem
    left: Expansion
    right: Expansion

    @property
    def length(self) -> float:
        """Length, positive; zero where a single state is both ends."""
        return self.right.coordinate - self.left.coordinate

    def parts(self, s: Array) -> Array:
        """Return coordinates as parts of the interval."""
        return np.asarray((s - self.left.coordinate) / (self.length or 1.0))

    @property
    def order(self) -> int:
        """K, that both ends have."""
        return min(self.left.order, self.right.order)

    @cached_property
    def _forms(self) -> tuple[Array, Array, Array, list[int]]:
        """The polynomials of the observables and what they miss, those of logarithms, and the columns that these are for."""
        scale = self.length ** np.arange(self.order + 1.0)[:, None]
        ends = self.left.series, self.right.series, self.left.logs, self.right.logs
        left, right, log_left, log_right = (form[: self.order + 1] * scale for form in ends)
        columns = np.nonzero(np.isfinite(log_left + log_right).all(axis=0))[0].tolist()
        nodes = chebyshev_nodes(2 * self.order + 2)
        logs = hermite(log_left[:, columns], log_right[:, columns], 1.0, nodes)
        return chebyshev_form(hermite(left, right, 1.0, nodes)), _missed(left, right), chebyshev_form(logs), columns

    def _interpolated(self, parts: Array) -> tuple[Array, Array]:
        """Return the observables and what the interpolation misses.

        A share that is lost in that goes by its logarithm, which keeps it positive and its digits.
        """
        form, size, logs, columns = self._forms
        basis = chebyshev_basis(parts, len(form))
        found, missed = basis @ form, (parts.real * (1 - parts.real))[:, None] ** self.order * size
        if columns:
            shares, limit = found[:, columns], LOST * missed[:, columns]
            lost = shares.real < limit
            if lost.any():
                with np.errstate(over="ignore", invalid="ignore"):
                    tiny = np.exp(basis @ logs)
                found[:, columns] = np.where(lost & (np.abs(tiny) < limit), tiny, shares)
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

    @cached_property
    def _read(self) -> tuple[Array, Array, Sequence[int], bool]:
        """Polynomials of what has no series, their errors and columns, and whether they are good enough."""
        nodes = chebyshev_nodes(READ_AT)
        values, errors, columns = self.problem.read(self.left, self.right, nodes)
        form = chebyshev_form(values)
        tails = TAIL * np.abs(form[-3:]).max(axis=0, initial=0.0)
        largest = errors.max(axis=0, initial=0.0)
        scales = self.problem.read_scales(values)
        return form, largest + tails / scales, columns, bool((tails <= 0.5 * largest * scales).all())

    def smooth(self, parts: Array) -> Array:
        """Return what :meth:`at` does, without errors and without what has no series."""
        return self._interpolated(parts)[0]

    def at(self, parts: Array) -> tuple[Array, Array]:
        """Return the observables at parts of the interval, and their errors in units of the scales, shape (len(parts), n)."""
        found, missed = self._interpolated(parts)
        scales = self.problem.scales(found, self.left.coordinate + parts * self.length)
        relative, absolute = self._at_ends
        errors = self._in_the_middle + np.where(self.problem.signed, absolute / scales, relative) + missed / scales
        form, largest, columns, is_smooth = self._read
        if is_smooth:
            found[:, columns], errors[:, columns] = chebyshev_basis(parts, len(form)) @ form, largest
        else:
            found[:, columns], errors[:, columns], _ = self.problem.read(self.left, self.right, parts)
        return found, errors


@dataclass(frozen=True, eq=False)
class SolvedPath:
    """What lies along a path, ascending, and how it ended.

    Attributes
    ----------
    problem : Problem
        What was followed.
    intervals : tuple of Interval
        Between neighbouring solved states; of a single state, from it to itself.
    outcome : Outcome
        CONVERGED if the path reaches the end asked for.
    """

    problem: Problem
    intervals: tuple[Interval, ...]
    outcome: Outcome

    @cached_property
    def expansions(self) -> tuple[Expansion, ...]:
        """The solved states."""
        found = [self.intervals[0].left] if self.intervals else []
        return (*found, *(one.right for one in self.intervals if one.right is not one.left))

    @cached_property
    def coordinates(self) -> Array:
        """Where the solved states are."""
        return np.array([one.coordinate for one in self.expansions])

    def smooth(self, s: Array) -> Array:
        """Return what :meth:`at` does, without errors and without what has no series, at complex coordinates too."""
        values = np.empty((len(s), self.expansions[0].series.shape[1]), dtype=s.dtype)
        for interval, mine in self._shared(s.real):
            values[mine] = interval.smooth(interval.parts(s[mine]))
        return values

    def interval_of(self, s: Array) -> Array:
        """Return the number of the interval of each coordinate."""
        return np.clip(np.searchsorted(self.coordinates, s, side="right") - 1, 0, len(self.intervals) - 1)

    def _shared(self, s: Array) -> list[tuple[Interval, Any]]:
        """Return the intervals that hold coordinates, each with the indices of its own."""
        where = self.interval_of(s)
        if len(where) == 1:
            return [(self.intervals[int(where[0])], slice(None))]
        return [(self.intervals[k], np.nonzero(where == k)[0]) for k in np.unique(where).tolist()]

    def at(self, s: Array) -> tuple[Array, Array]:
        """Return the observables at coordinates, shape (len(s), n), and their errors in units of the scales."""
        values = np.empty((len(s), self.expansions[0].series.shape[1]))
        errors = np.empty_like(values)
        for interval, mine in self._shared(s):
            values[mine], errors[mine] = interval.at(np.clip(interval.parts(s[mine]), 0.0, 1.0))
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
    found: list[Interval] = []  # descending
    alone: tuple[Interval, ...] = ()
    outcome = Outcome.CONVERGED
    try:
        here = problem.solve(start, [])
        if isinstance(here, Outcome):
            return SolvedPath(problem, (), here)
        alone = (Interval(problem, here, here),)
        while here.coordinate > end:
            left = here.coordinate - end
            step = min(left, LONGEST_STEP, max(SHORTEST_INTERVAL, _step(here, rtol)))
            if left < 2 * step:  # two like steps rather than a long and a short one
                step = left if left <= step else 0.5 * left
            while isinstance(new := problem.solve(end if step == left else here.coordinate - step, [here]), Outcome):
                step *= 0.5
                if step < SHORTEST_STEP or new is Outcome.INTERRUPTED:
                    return SolvedPath(problem, tuple(found[::-1]) or alone, new)
            found += _refined(Interval(problem, new, here), rtol)[::-1]
            if on_interval is not None:
                on_interval(new.coordinate, here.coordinate)
            here = new
    except KeyboardInterrupt:
        outcome = Outcome.INTERRUPTED
    return SolvedPath(problem, tuple(found[::-1]) or alone, outcome)


def _step(here: Expansion, rtol: float) -> float:
    """Return the longest step that the coefficients promise to interpolate within the tolerance."""
    order = here.order
    return here.radius * min(REACH, 2.0 * float((0.1 * rtol) ** (0.5 / max(order, 1))))


def _refined(interval: Interval, rtol: float, before: float = math.inf) -> list[Interval]:
    """Return the intervals that an interval becomes where it does not interpolate within the tolerance, ascending."""
    if interval.length < SHORTEST_INTERVAL:
        return [interval]
    problem, left, right = interval.problem, interval.left, interval.right
    exists = [np.isfinite(one.series).all(axis=0) for one in (left, right)]
    ends_between = bool((exists[0] != exists[1]).any()) and interval.length > LONGEST_END  # what exists on one side alone
    errors = interval.at(CHECKS)[1]
    # What the ends are wrong by does not fall with the length.
    excess = errors - np.fmax(left.errors, right.errors) > REDUCIBLE * rtol
    if not ends_between and not ((errors > CHECKED * rtol) & excess)[:, problem.held].any():
        return [interval]
    worst = float(np.nanmax(errors[:, problem.held]))
    if interval.length < NOISY and worst > PROGRESS * before:  # rounding, which halving does not take away
        return [interval]
    middle = problem.solve(0.5 * (left.coordinate + right.coordinate), [left, right])
    if isinstance(middle, Outcome):
        return [interval]
    halves = Interval(problem, left, middle), Interval(problem, middle, right)
    return [part for half in halves for part in _refined(half, rtol, worst)]
