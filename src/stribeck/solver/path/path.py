r"""A path of states along one coordinate, the logarithm of the quantity that varies, as a function of it.

A few states are solved and expanded into Taylor series; between two of them each observable is the polynomial with the
coefficients of both.  A step is as long as their radius of convergence allows.  If the polynomial of all orders differs from
that without the highest by more than half the tolerance, a state is solved in between.  The stated error of an observable is
the larger of those at both ends, plus twice this difference.

Only a :class:`Problem` knows what the states are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.numerics.hermite import chebyshev_basis, chebyshev_form, chebyshev_nodes, hermite_form, missed_by
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome

LONGEST_STEP = 7.0
SHORTEST_STEP = 1e-3

SHORTER = 0.75
"""Length of the next step after one that failed, over that one."""

REACH = 1.2
"""Largest step over the radius of convergence."""

FIRST = 0.83
"""Length of the first step over that of others: a path begins where the radius is large, and it falls from there."""

KNOT_PART = 0.75
"""Part of the tolerance that a solved state must hold: the rest is for the interpolation."""

APART = 1.0
"""Distance from both ends of an interval and error, in units of the scales, from which on a path ends there."""

CHECKED = 0.85
"""Part of the tolerance that an interval must hold at the places where it is checked."""

REDUCIBLE = 0.25
"""Interpolation error over the tolerance above which a shorter interval helps."""

READ_AT = 24
"""Places of an interval at which observables without a series are read, for a polynomial, and at which this is checked."""

TAIL = 3.0
"""Error of a polynomial over the largest of its last three coefficients."""

BEYOND = 2.0
"""Interpolation error over the change of the polynomial by its highest order: the orders beyond it count about as much."""

LOST = 1e3
"""Value over its interpolation error below which a share is interpolated by its logarithm."""

TINY = 1e-300

INSIDE = np.array([0.25, 0.5, 0.75])
"""Where the equations are checked, in parts of an interval: several, as a law with kinks may agree at one by chance."""

LONGEST_END = 0.05
"""Longest interval on which an observable may cease to exist."""

SHORTEST_INTERVAL = 0.01
"""Length below which an interval keeps its error: where a film ruptures no series converges."""

NOISY, PROGRESS = 0.4, 0.6
"""Length below which halving an interval must reduce its error to this part, or the error is rounding."""

SHORTEST_AT_ROUNDING = 0.2
"""Length of a step below which a path ends where rounding leaves more than the tolerance: what is beyond is no better."""

MOST_INTERVALS = 500
"""Intervals after which a path ends."""


@dataclass(frozen=True, eq=False)
class Expansion:
    """Taylor coefficients of observables about a solved state, order by order in the first axis."""

    coordinate: float  # Where the state is
    point: Any  # The state, as its problem knows it
    series: Array  # Coefficients of the observables
    logs: Array  # Coefficients of their logarithms; nan where there are none
    errors: Array  # Estimated errors at the state, in units of the scales of :class:`Problem`
    radius: float  # Estimate of the radius of convergence

    @property
    def order(self) -> int:
        """K."""
        return len(self.series) - 1


def rate(left: Expansion, right: Expansion) -> float:
    """Return by how much the change by an order exceeds that by the one before, as :func:`missed_by` takes it."""
    return (right.coordinate - left.coordinate) ** 2 / (left.radius * right.radius)


class Problem(Protocol):
    """The states that a path follows, as the path needs them."""

    @property
    def held(self) -> Flags:
        """Which observables the tolerance holds for."""

    @property
    def signed(self) -> Flags:
        """Which observables may cross zero: between states their absolute errors count, those of others relatively."""

    def solve(self, s: float, near: Sequence[Expansion]) -> Expansion | Outcome:
        """Return the expanded state at ``s``; ``near`` holds no neighbour, the last one, or both.

        A failure is returned as its outcome.
        """

    def scales(self, values: Array, s: Array) -> Array:
        """Return the scales of the errors of observables at coordinates s, shape (len(s), n)."""

    @property
    def negligible(self) -> float:
        """Error in units of the scales that a polynomial for observables without a series may add to theirs."""

    def read_scales(self, values: Array) -> Array:
        """Return the same for observables without a series."""

    def missed(self, left: Expansion, right: Expansion, parts: Array, values: Callable[[], Array]) -> Array:
        """Return the largest difference of ``values()`` from the equations at parts of an interval, in units of the scales.

        Zero where the coefficients are surely right.
        """

    def read(self, left: Expansion, right: Expansion, parts: Array) -> tuple[Array, Array, Sequence[int]]:
        """Return observables that have no series, at parts of an interval: values, errors, and their columns."""


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

    @property
    def order(self) -> int:
        """K, that both ends have."""
        return min(self.left.order, self.right.order)

    @cached_property
    def ends(self) -> Array:
        """Coefficients at both ends, one under the other, of the observables and of their logarithms."""
        scale = self.length ** np.arange(self.order + 1.0)[:, None]
        return np.vstack([np.hstack([end.series, end.logs])[: self.order + 1] * scale for end in (self.left, self.right)])

    @cached_property
    def form(self) -> Array:
        """Coefficients of Chebyshev polynomials of the observables and of their logarithms."""
        return hermite_form(self.order) @ self.ends

    @cached_property
    def missed(self) -> Array:
        """Error of the interpolated observables by their highest orders, over ``(tau (1 - tau))**K``."""
        return BEYOND * missed_by(self.order, self.ends[:, : self.left.series.shape[1]], rate(self.left, self.right))

    @cached_property
    def at_ends(self) -> Array:
        """The larger errors of both ends: in units of the scales there, and absolute for what crosses zero between."""
        relative = np.stack([self.left.errors, self.right.errors])
        values = np.stack([self.left.series[0], self.right.series[0]])
        scales = self.problem.scales(values, np.array([self.left.coordinate, self.right.coordinate]))
        return np.stack([relative.max(axis=0), (relative * scales).max(axis=0)])

    @cached_property
    def _alone(self) -> _Pieces:
        return _Pieces([self])

    @cached_property
    def inside(self) -> Array:
        """Error that the equations find between the ends."""

        def values() -> Array:
            where = np.zeros(len(INSIDE), dtype=int)
            found, _, basis = self._alone.smooth(where, INSIDE)
            self._alone.read(found, where, INSIDE, basis)
            return found

        return self.problem.missed(self.left, self.right, INSIDE, values)

    @cached_property
    def read(self) -> tuple[Array, Array, Sequence[int], bool]:
        """Polynomials for observables without a series, their errors and columns, and whether they are good enough."""
        values, errors, columns = self.problem.read(self.left, self.right, chebyshev_nodes(READ_AT))
        with np.errstate(invalid="ignore"):  # of values that are not finite no polynomial is good enough
            form = chebyshev_form(values)
        tails = TAIL * np.abs(form[-3:]).max(axis=0, initial=0.0)
        largest = errors.max(axis=0, initial=0.0)
        scales = self.problem.read_scales(values)
        missed = np.divide(tails, scales, out=np.full_like(tails, math.inf), where=scales > 0)
        return form, largest + missed, columns, bool((missed <= np.maximum(0.5 * largest, self.problem.negligible)).all())

    @cached_property
    def checked(self) -> tuple[Array, Array]:
        """The observables and their errors at the places where the interval is checked."""
        return self.at(chebyshev_nodes(READ_AT))

    def at(self, parts: Array) -> tuple[Array, Array]:
        """Return the observables at parts of the interval, and their errors in units of the scales, shape (len(parts), n)."""
        return self._alone.at(np.zeros(len(parts), dtype=int), parts)


class _Pieces:
    """Intervals side by side, to be evaluated at many places at once."""

    def __init__(self, intervals: Sequence[Interval]) -> None:
        self.intervals, self.problem = intervals, intervals[0].problem
        self.count = intervals[0].left.series.shape[1]
        self.orders = np.array([one.order for one in intervals])
        self.degree = max(READ_AT, 2 * int(self.orders.max()) + 2)
        self.forms = [one.form for one in intervals]
        self.missed = np.stack([one.missed for one in intervals])
        with_logs = np.stack([np.isfinite(form[:, self.count :]).all(axis=0) for form in self.forms])
        self.starts = np.array([one.left.coordinate for one in intervals])
        self.lengths = np.array([one.length for one in intervals])
        self.logs = np.nonzero(with_logs.any(axis=0))[0].tolist()

    def smooth(self, where: Array, parts: Array) -> tuple[Array, Array, Array]:
        """Return the observables at parts of the intervals of these numbers, their interpolation errors, and the basis.

        A share below that error is interpolated by its logarithm, which keeps its sign and its digits.
        """
        basis = chebyshev_basis(parts, self.degree)
        both = np.empty((len(parts), 2 * self.count), dtype=parts.dtype)
        for k in np.unique(where).tolist() if len(where) > 1 else where.tolist():
            mine, form = slice(None) if len(where) == 1 else where == k, self.forms[k]
            both[mine] = basis[mine, : len(form)] @ form
        found = both[:, : self.count]
        missed = self.missed[where] * ((parts.real * (1 - parts.real)) ** self.orders[where])[:, None]
        if self.logs:
            shares, limit = found[:, self.logs], LOST * missed[:, self.logs]
            lost = shares.real < limit
            if lost.any():
                with np.errstate(all="ignore"):
                    tiny = np.exp(both[:, [self.count + column for column in self.logs]])
                found[:, self.logs] = np.where(lost & (np.abs(tiny) < limit), tiny, shares)
        return found, missed, basis

    @cached_property
    def _errors(self) -> tuple[Array, Array]:
        """Errors of the intervals at any place: relative ones, and absolute ones of what may cross zero."""
        ends, inside = np.stack([one.at_ends for one in self.intervals]), [one.inside for one in self.intervals]
        signed = self.problem.signed
        return np.where(signed, 0.0, ends[:, 0]) + np.stack(inside), np.where(signed, ends[:, 1], 0.0)

    def at(self, where: Array, parts: Array) -> tuple[Array, Array]:
        """Return the observables at parts of the intervals of these numbers, and their errors in units of the scales."""
        found, missed, basis = self.smooth(where, parts)
        scales = self.problem.scales(found, self.starts[where] + parts * self.lengths[where])
        relative, absolute = self._errors
        errors = relative[where] + (absolute[where] + missed) / scales
        for mine, columns, of_read in self.read(found, where, parts, basis):
            errors[mine, columns] = of_read + self.intervals[where[mine[0, 0]]].inside[columns]
        unknown = np.isnan(found) & self._expected[where]
        return found, np.where(unknown, np.inf, errors)

    @cached_property
    def _expected(self) -> Flags:
        """Which observables both states of an interval have; where a film ruptures a series may lead to no other state."""
        return np.stack([np.isfinite([one.left.series[0], one.right.series[0]]).all(axis=0) for one in self.intervals])

    def read(self, found: Array, where: Array, parts: Array, basis: Array) -> list[tuple[Indices, Sequence[int], Array]]:
        """Write observables without a series into ``found``; return rows and columns of each interval, and errors."""
        written = []
        for k in np.unique(where).tolist() if len(where) > 1 else where.tolist():
            one = self.intervals[k]
            form, errors, columns, is_smooth = one.read
            if not len(columns):
                continue
            mine = np.nonzero(where == k)[0][:, None]
            if is_smooth:
                found[mine, columns] = basis[mine[:, 0], :READ_AT] @ form
            else:
                found[mine, columns], errors, _ = self.problem.read(one.left, one.right, parts[mine[:, 0]])
            written.append((mine, columns, errors))
        return written


@dataclass(frozen=True, eq=False)
class SolvedPath:
    """What lies along a path, ascending, and how it ended."""

    problem: Problem  # What was followed
    intervals: tuple[Interval, ...]  # Between neighbouring solved states; of a single state, from it to itself
    outcome: Outcome  # CONVERGED if the path reaches the end asked for

    @cached_property
    def expansions(self) -> tuple[Expansion, ...]:
        """The solved states."""
        found = [self.intervals[0].left] if self.intervals else []
        return (*found, *(one.right for one in self.intervals if one.right is not one.left))

    @cached_property
    def coordinates(self) -> Array:
        """Where the solved states are."""
        return np.array([one.coordinate for one in self.expansions])

    def joined(self, other: SolvedPath) -> SolvedPath:
        """Return this path and another, which goes on at one of its ends."""
        more = tuple(one for one in other.intervals if one.length > 0)
        mine = tuple(one for one in self.intervals if one.length > 0 or not more)
        return SolvedPath(self.problem, _ascending([*mine, *more]), other.outcome)

    @cached_property
    def _pieces(self) -> _Pieces:
        return _Pieces(self.intervals)

    def interval_of(self, s: Array) -> Array:
        """Return the number of the interval of each coordinate."""
        return np.clip(np.searchsorted(self.coordinates, s, side="right") - 1, 0, len(self.intervals) - 1)

    def _parts(self, s: Array) -> tuple[Array, Array]:
        """Return the interval of each coordinate, and its place in it."""
        where = self.interval_of(s.real)
        return where, (s - self._pieces.starts[where]) / np.fmax(self._pieces.lengths[where], TINY)

    def smooth(self, s: Array) -> Array:
        """Return the values of :meth:`at` that have a series, without errors, at real or complex coordinates."""
        return self._pieces.smooth(*self._parts(s))[0]

    def at(self, s: Array) -> tuple[Array, Array]:
        """Return the observables at coordinates, shape (len(s), n), and their errors in units of the scales."""
        where, parts = self._parts(s)
        return self._pieces.at(where, np.clip(parts, 0.0, 1.0))


def follow(
    problem: Problem,
    start: float | Expansion,
    end: float,
    rtol: float,
    on_interval: Callable[[float, float], object] | None = None,
    until: Callable[[Expansion], bool] | None = None,
) -> SolvedPath:
    """Return the path between ``start`` and ``end``."""
    found: list[Interval] = []  # in the order of the march
    alone: tuple[Interval, ...] = ()
    outcome = Outcome.CONVERGED
    try:
        here = start if isinstance(start, Expansion) else problem.solve(start, [])
        if isinstance(here, Outcome):
            return SolvedPath(problem, (), here)
        alone = (Interval(problem, here, here),)
        upwards = end > here.coordinate
        while (left := abs(here.coordinate - end)) > 0 and not (until is not None and until(here)):
            if len(found) >= MOST_INTERVALS:
                return SolvedPath(problem, _ascending(found), Outcome.STATE_LIMIT)
            step = min(left, LONGEST_STEP, max(SHORTEST_INTERVAL, _step(here, rtol) * (1.0 if found else FIRST)))
            if left < 2 * step:  # two equal steps rather than a long and a short one
                step = left if left <= step else 0.5 * left
            while isinstance(new := problem.solve(_beyond(here, end, step if upwards else -step), [here]), Outcome):
                step *= SHORTER
                shortest = SHORTEST_AT_ROUNDING if new is Outcome.ROUNDING else SHORTEST_STEP
                if step < shortest or new is Outcome.INTERRUPTED:
                    return SolvedPath(problem, _ascending(found) or alone, new)
            low, high = (here, new) if upwards else (new, here)
            parts = _refined(Interval(problem, low, high), rtol)
            for part in parts if upwards else parts[::-1]:
                if _is_lost(part):
                    return SolvedPath(problem, _ascending(found) or alone, Outcome.PATH_LOST)
                found.append(part)
            if on_interval is not None:
                on_interval(low.coordinate, high.coordinate)
            here = new
    except KeyboardInterrupt:
        outcome = Outcome.INTERRUPTED
    return SolvedPath(problem, _ascending(found) or alone, outcome)


def _is_lost(interval: Interval) -> bool:
    """Return whether what is read between two states is far from both: they are of two branches."""
    ends = np.stack([interval.left.series[0], interval.right.series[0]])
    scales = interval.problem.scales(ends, np.array([interval.left.coordinate, interval.right.coordinate])).max(axis=0)
    values, errors = interval.checked
    far = np.maximum(values - ends.max(axis=0), ends.min(axis=0) - values) > APART * scales
    return bool((far & (errors > APART))[:, interval.problem.held].any())


def _beyond(here: Expansion, end: float, step: float) -> float:
    """Return the coordinate one step further, or exactly the end."""
    return end if abs(step) == abs(here.coordinate - end) else here.coordinate + step


def _ascending(intervals: Sequence[Interval]) -> tuple[Interval, ...]:
    return tuple(sorted(intervals, key=lambda one: one.left.coordinate))


def _step(here: Expansion, rtol: float) -> float:
    """Return the longest step on which the coefficients should interpolate within the tolerance."""
    order = here.order
    return here.radius * min(REACH, 2.0 * float((0.1 * rtol) ** (0.5 / max(order, 1))))


def _refined(interval: Interval, rtol: float, before: float = math.inf) -> list[Interval]:
    """Return an interval split until it interpolates within the tolerance, ascending."""
    if interval.length < SHORTEST_INTERVAL:
        return [interval]
    problem, left, right = interval.problem, interval.left, interval.right
    exists = [np.isfinite(one.series).all(axis=0) for one in (left, right)]
    ends_between = bool((exists[0] != exists[1]).any()) and interval.length > LONGEST_END  # something exists on one side alone
    values, errors = interval.checked
    # The errors of the ends do not fall with the length.
    scales = problem.scales(values, left.coordinate + chebyshev_nodes(READ_AT) * interval.length)
    with np.errstate(over="ignore"):  # series that lead to no number count as wrong
        of_ends = np.where(problem.signed, interval.at_ends[1] / scales, interval.at_ends[0])
    excess = errors - of_ends > REDUCIBLE * rtol
    if not ends_between and not ((errors > CHECKED * rtol) & excess)[:, problem.held].any():
        return [interval]
    worst = float(np.nanmax(errors[:, problem.held]))
    if interval.length < NOISY and worst > PROGRESS * before:  # rounding, which halving does not remove
        return [interval]
    at = 0.5 * (left.coordinate + right.coordinate)
    for near in ([left, right], [max(left, right, key=lambda end: end.radius)]):  # a series may be good on one side alone
        middle = problem.solve(at, near)
        if not isinstance(middle, Outcome) or middle is Outcome.ROUNDING:
            break
    if isinstance(middle, Outcome):
        return [interval]
    halves = Interval(problem, left, middle), Interval(problem, middle, right)
    return [part for half in halves for part in _refined(half, rtol, worst)]
