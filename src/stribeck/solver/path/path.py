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
from stribeck.numerics.settings import (
    INNER_PLACES,
    MAX_LOG_STEP,
    MAX_PATH_STATES,
    MIN_LOG_STEP,
    NEGLIGIBLE,
    SAFETY,
    SERIES_ORDER,
    STEP_GROWTH,
)
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome


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
        """Order of the series."""
        return len(self.series) - 1


def change_ratio(left: Expansion, right: Expansion) -> float:
    """Return the ratio of the changes by one order of a two-point series and by the order before."""
    return (right.coordinate - left.coordinate) ** 2 / (left.radius * right.radius)


class Problem(Protocol):
    """The states along a path: how each is solved, scaled, checked and read."""

    @property
    def controlled(self) -> Flags:
        """Which observables the tolerance limits."""

    @property
    def sign_changing(self) -> Flags:
        """Which observables may cross zero, so that their errors between states are absolute."""

    def solve(self, s: float, near: Sequence[Expansion]) -> Expansion | Outcome:
        """Return the expanded state at ``s``, from no, one or two neighbours ``near``, or the outcome of the failure."""

    def scales(self, values: Array, s: Array) -> Array:
        """Return the scales of the errors of observables at coordinates s, shape (len(s), n)."""

    @property
    def negligible(self) -> float:
        """Error in units of the scales that a polynomial for observables without a series may add to theirs."""

    def read_scales(self, values: Array) -> Array:
        """Return the scales of observables without a series."""

    def checked_error(self, left: Expansion, right: Expansion, parts: Array, values: Callable[[], Array]) -> Array:
        """Return the largest scaled difference of ``values()`` from the equations, zero where series are surely right."""

    def read(self, left: Expansion, right: Expansion, parts: Array) -> tuple[Array, Array, Sequence[int]]:
        """Return values, errors and columns of observables without a series at parts of an interval."""


@dataclass(frozen=True, eq=False)
class Interval:
    """The observables between two neighbouring expansions."""

    problem: Problem
    left: Expansion
    right: Expansion

    @property
    def length(self) -> float:
        """Length, positive; zero where a single state is both ends."""
        return self.right.coordinate - self.left.coordinate

    @property
    def order(self) -> int:
        """Order of the series, the smaller of those at both ends."""
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
    def interpolation_error(self) -> Array:
        """Error of the interpolated observables by their highest orders, over ``(tau (1 - tau))**K``."""
        return SAFETY * missed_by(self.order, self.ends[:, : self.left.series.shape[1]], change_ratio(self.left, self.right))

    @cached_property
    def at_ends(self) -> Array:
        """The larger errors of both ends, in scales and absolute."""
        relative = np.stack([self.left.errors, self.right.errors])
        values = np.stack([self.left.series[0], self.right.series[0]])
        scales = self.problem.scales(values, np.array([self.left.coordinate, self.right.coordinate]))
        return np.stack([relative.max(axis=0), (relative * scales).max(axis=0)])

    @cached_property
    def _alone(self) -> _Pieces:
        return _Pieces([self])

    @cached_property
    def checked_error(self) -> Array:
        """Largest difference of the interpolant from the equations within the interval."""

        def values() -> Array:
            where = np.zeros(len(places), dtype=int)
            found, _, basis = self._alone.smooth(where, places)
            self._alone.read(found, where, places, basis)
            return found

        places = np.array(INNER_PLACES)
        return self.problem.checked_error(self.left, self.right, places, values)

    @cached_property
    def read(self) -> tuple[Array, Array, Sequence[int], bool]:
        """Polynomials of observables without a series, their errors and columns, and whether they are accurate enough."""
        values, errors, columns = self.problem.read(self.left, self.right, chebyshev_nodes(SERIES_ORDER))
        with np.errstate(invalid="ignore"):  # of values that are not finite no polynomial is good enough
            form = chebyshev_form(values)
        tails = SAFETY * np.abs(form[-3:]).max(axis=0, initial=0.0)
        largest = errors.max(axis=0, initial=0.0)
        scales = self.problem.read_scales(values)
        missed = np.divide(tails, scales, out=np.full_like(tails, math.inf), where=scales > 0)
        return form, largest + missed, columns, bool((missed <= np.maximum(0.5 * largest, self.problem.negligible)).all())

    @cached_property
    def values_at_checks(self) -> tuple[Array, Array]:
        """Observables and their errors at the checked places."""
        return self.at(chebyshev_nodes(SERIES_ORDER))

    def at(self, parts: Array) -> tuple[Array, Array]:
        """Return the observables at parts of the interval, and their errors in units of the scales, shape (len(parts), n)."""
        return self._alone.at(np.zeros(len(parts), dtype=int), parts)


class _Pieces:
    """Neighbouring intervals evaluated at many places at once."""

    def __init__(self, intervals: Sequence[Interval]) -> None:
        self.intervals, self.problem = intervals, intervals[0].problem
        self.count = intervals[0].left.series.shape[1]
        self.orders = np.array([one.order for one in intervals])
        self.degree = max(SERIES_ORDER, 2 * int(self.orders.max()) + 2)
        self.forms = [one.form for one in intervals]
        self.interpolation_error = np.stack([one.interpolation_error for one in intervals])
        with_logs = np.stack([np.isfinite(form[:, self.count :]).all(axis=0) for form in self.forms])
        self.starts = np.array([one.left.coordinate for one in intervals])
        self.lengths = np.array([one.length for one in intervals])
        self.logs = np.nonzero(with_logs.any(axis=0))[0].tolist()

    def smooth(self, where: Array, parts: Array) -> tuple[Array, Array, Array]:
        """Return observables at parts of numbered intervals, their interpolation errors, and the Chebyshev basis."""
        basis = chebyshev_basis(parts, self.degree)
        both = np.empty((len(parts), 2 * self.count), dtype=parts.dtype)
        for k in np.unique(where).tolist() if len(where) > 1 else where.tolist():
            mine, form = slice(None) if len(where) == 1 else where == k, self.forms[k]
            both[mine] = basis[mine, : len(form)] @ form
        found = both[:, : self.count]
        missed = self.interpolation_error[where] * ((parts.real * (1 - parts.real)) ** self.orders[where])[:, None]
        if self.logs:  # a share below its error is interpolated by its logarithm, which keeps sign and digits
            shares, limit = found[:, self.logs], missed[:, self.logs] / NEGLIGIBLE
            lost = shares.real < limit
            if lost.any():
                with np.errstate(all="ignore"):
                    tiny = np.exp(both[:, [self.count + column for column in self.logs]])
                found[:, self.logs] = np.where(lost & (np.abs(tiny) < limit), tiny, shares)
        return found, missed, basis

    @cached_property
    def _errors(self) -> tuple[Array, Array]:
        """Errors of each interval, relative for most observables and absolute for those that may cross zero."""
        ends, inside = np.stack([one.at_ends for one in self.intervals]), [one.checked_error for one in self.intervals]
        sign_changing = self.problem.sign_changing
        return np.where(sign_changing, 0.0, ends[:, 0]) + np.stack(inside), np.where(sign_changing, ends[:, 1], 0.0)

    def at(self, where: Array, parts: Array) -> tuple[Array, Array]:
        """Return observables at parts of numbered intervals, and their scaled errors."""
        found, missed, basis = self.smooth(where, parts)
        scales = self.problem.scales(found, self.starts[where] + parts * self.lengths[where])
        relative, absolute = self._errors
        errors = relative[where] + (absolute[where] + missed) / scales
        for mine, columns, of_read in self.read(found, where, parts, basis):
            errors[mine, columns] = of_read + self.intervals[where[mine[0, 0]]].checked_error[columns]
        unknown = np.isnan(found) & self._expected[where]
        return found, np.where(unknown, np.inf, errors)

    @cached_property
    def _expected(self) -> Flags:
        """Which observables exist at both ends of an interval."""
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
                found[mine, columns] = basis[mine[:, 0], :SERIES_ORDER] @ form
            else:
                found[mine, columns], errors, _ = self.problem.read(one.left, one.right, parts[mine[:, 0]])
            written.append((mine, columns, errors))
        return written


@dataclass(frozen=True, eq=False)
class SolvedPath:
    """The intervals of a path in ascending order, and its outcome."""

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
        """Return the path continued by another one from one of its ends."""
        more = tuple(one for one in other.intervals if one.length > 0)
        mine = tuple(one for one in self.intervals if one.length > 0 or not more)
        return SolvedPath(self.problem, _sorted_intervals([*mine, *more]), other.outcome)

    @cached_property
    def _pieces(self) -> _Pieces:
        return _Pieces(self.intervals)

    def continued(
        self,
        end: float,
        rtol: float,
        on_interval: Callable[[float, float], object] | None = None,
        until: Callable[[SolvedPath], bool] | None = None,
    ) -> SolvedPath:
        """Return the path from the nearer end of this one to ``end``, or as far as ``until`` holds of it."""
        here = min(self.expansions[0], self.expansions[-1], key=lambda one: abs(one.coordinate - end))
        return follow(self.problem, here, end, rtol, on_interval, until)

    def places(self, parts: Array) -> Array:
        """Return coordinates at parts of all intervals, and the last one."""
        inside = [interval.left.coordinate + parts * interval.length for interval in self.intervals]
        return np.append(np.concatenate(inside), self.coordinates[-1])

    def interval_of(self, s: Array) -> Array:
        """Return the number of the interval of each coordinate."""
        return np.clip(np.searchsorted(self.coordinates, s, side="right") - 1, 0, len(self.intervals) - 1)

    def _parts(self, s: Array) -> tuple[Array, Array]:
        """Return the interval of each coordinate, and its place in it."""
        where = self.interval_of(s.real)
        return where, (s - self._pieces.starts[where]) / np.fmax(self._pieces.lengths[where], np.finfo(float).tiny)

    def smooth(self, s: Array) -> Array:
        """Return observables with a series, without errors, at real or complex coordinates."""
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
    until: Callable[[SolvedPath], bool] | None = None,
) -> SolvedPath:
    """Return the path between ``start`` and ``end``, or as far as ``until`` holds of it."""
    found: list[Interval] = []  # in the order of the march
    alone: tuple[Interval, ...] = ()
    outcome = Outcome.CONVERGED
    try:
        here = start if isinstance(start, Expansion) else problem.solve(start, [])
        if isinstance(here, Outcome):
            return SolvedPath(problem, (), here)
        alone = (Interval(problem, here, here),)
        upwards = end > here.coordinate
        while (left := abs(here.coordinate - end)) > 0:
            if until is not None and until(SolvedPath(problem, _sorted_intervals(found) or alone, outcome)):
                break
            if len(found) >= MAX_PATH_STATES:
                return SolvedPath(problem, _sorted_intervals(found), Outcome.STATE_LIMIT)
            step = min(left, MAX_LOG_STEP, max(MIN_LOG_STEP, _step_length(here, rtol)))
            if left < 2 * step:  # two equal steps rather than a long and a short one
                step = left if left <= step else 0.5 * left
            while isinstance(new := problem.solve(_next_coordinate(here, end, step if upwards else -step), [here]), Outcome):
                step /= STEP_GROWTH
                if step < MIN_LOG_STEP:
                    return SolvedPath(problem, _sorted_intervals(found) or alone, new)
            low, high = (here, new) if upwards else (new, here)
            parts = _split_until_accurate(Interval(problem, low, high), rtol)
            for part in parts if upwards else parts[::-1]:
                if _joins_two_branches(part):
                    return SolvedPath(problem, _sorted_intervals(found) or alone, Outcome.PATH_LOST)
                found.append(part)
            if on_interval is not None:
                on_interval(low.coordinate, high.coordinate)
            here = new
    except KeyboardInterrupt:
        outcome = Outcome.INTERRUPTED
    return SolvedPath(problem, _sorted_intervals(found) or alone, outcome)


def _joins_two_branches(interval: Interval) -> bool:
    """Return whether the interpolant leaves the range of both ends, which then lie on two branches."""
    ends = np.stack([interval.left.series[0], interval.right.series[0]])
    scales = interval.problem.scales(ends, np.array([interval.left.coordinate, interval.right.coordinate])).max(axis=0)
    values, errors = interval.values_at_checks
    far = np.maximum(values - ends.max(axis=0), ends.min(axis=0) - values) > scales
    return bool((far & (errors > 1))[:, interval.problem.controlled].any())


def _next_coordinate(here: Expansion, end: float, step: float) -> float:
    """Return the coordinate one step further, or exactly the end."""
    return end if abs(step) == abs(here.coordinate - end) else here.coordinate + step


def _sorted_intervals(intervals: Sequence[Interval]) -> tuple[Interval, ...]:
    return tuple(sorted(intervals, key=lambda one: one.left.coordinate))


def _step_length(here: Expansion, rtol: float) -> float:
    """Return the longest step on which the coefficients should interpolate within the tolerance."""
    order = here.order
    return here.radius * 2.0 * float((NEGLIGIBLE * rtol) ** (0.5 / max(order, 1)))


def _split_until_accurate(interval: Interval, rtol: float, before: float = math.inf) -> list[Interval]:
    """Return an interval split until it interpolates within the tolerance, ascending."""
    if interval.length < 2 * MIN_LOG_STEP:
        return [interval]
    problem, left, right = interval.problem, interval.left, interval.right
    exists = [np.isfinite(one.series).all(axis=0) for one in (left, right)]
    ends_between = bool((exists[0] != exists[1]).any())  # something exists on one side alone
    values, errors = interval.values_at_checks
    # The errors of the ends do not fall with the length.
    scales = problem.scales(values, left.coordinate + chebyshev_nodes(SERIES_ORDER) * interval.length)
    with np.errstate(over="ignore"):  # series that lead to no number count as wrong
        of_ends = np.where(problem.sign_changing, interval.at_ends[1] / scales, interval.at_ends[0])
    excess = errors - of_ends > NEGLIGIBLE * rtol
    if not ends_between and not ((errors > (1 - NEGLIGIBLE) * rtol) & excess)[:, problem.controlled].any():
        return [interval]
    worst = float(np.nanmax(errors[:, problem.controlled]))
    if worst > before / STEP_GROWTH and not ends_between:  # rounding, or a film that ruptures: no shorter interval has less
        return [interval]
    at = 0.5 * (left.coordinate + right.coordinate)
    for near in ([left, right], [max(left, right, key=lambda end: end.radius)]):  # a series may be good on one side alone
        middle = problem.solve(at, near)
        if not isinstance(middle, Outcome) or middle is Outcome.ROUNDING:
            break
    if isinstance(middle, Outcome):
        return [interval]
    halves = Interval(problem, left, middle), Interval(problem, middle, right)
    return [part for half in halves for part in _split_until_accurate(half, rtol, worst)]
