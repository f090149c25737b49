r"""A path of states along one coordinate, the logarithm of the quantity that varies, as a function of it.

A few states are solved and expanded into Taylor series; between two of them each observable is the polynomial with the
coefficients of both.  A step is as long as their radius of convergence allows.  If the polynomial of all orders differs from
that without the highest by more than half the tolerance, a state is solved in between.  The stated error of an observable is
the larger of those at both ends, plus twice this difference.

Only their problem knows what the states are.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.numerics.continuation import ReadablePath
from stribeck.numerics.dual import value_of
from stribeck.numerics.hermite import chebyshev_basis, chebyshev_form, chebyshev_nodes, hermite_form, missed_by
from stribeck.numerics.settings import (
    MAX_DEGREE,
    NEGLIGIBLE,
    SAFETY,
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
    errors: Array  # Estimated errors at the state, in units of the scales of the problem
    radius: float  # Estimate of the radius of convergence

    @property
    def order(self) -> int:
        """Order of the series."""
        return len(self.series) - 1

    @property
    def state(self) -> Any:
        """The state as it was refined."""
        return self.point.refined

    @property
    def values(self) -> Array:
        """The observables."""
        return np.asarray(self.series[0])

    @property
    def slopes(self) -> Array:
        """Derivatives of the observables by the coordinate, unknown of a series without a first order."""
        return np.asarray(self.series[1]) if self.order else np.full(self.series.shape[1], np.inf)


def change_ratio(left: Expansion, right: Expansion) -> float:
    """Return the ratio of the changes by one order of a two-point series and by the order before."""
    return (right.coordinate - left.coordinate) ** 2 / (left.radius * right.radius)


@dataclass(frozen=True, eq=False)
class Interval:
    """The observables between two neighbouring expansions."""

    problem: Any
    left: Expansion
    right: Expansion
    before: float = math.inf  # Largest error of the interval of which this is half

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
    def checked_error(self) -> Array:
        """Error that neither end shows."""
        return np.asarray(self.problem.checked_error(self.left, self.right))

    @cached_property
    def read(self) -> tuple[Array, Array, Sequence[int], bool]:
        """Polynomials of observables without a series, their errors and columns, and whether they are accurate enough."""
        values, errors, columns = self.problem.read(self.left, self.right, chebyshev_nodes(MAX_DEGREE))
        largest = errors.max(axis=0, initial=0.0)
        scales = self.problem.read_scales(values)
        with np.errstate(invalid="ignore", over="ignore"):  # of values that are not finite no polynomial is good enough
            form = chebyshev_form(values)
            tails = SAFETY * np.abs(form[-3:]).max(axis=0, initial=0.0)
            missed = np.divide(tails, scales, out=np.full_like(tails, math.inf), where=scales > 0)
        return form, largest + missed, columns, bool((missed <= np.maximum(0.5 * largest, self.problem.negligible)).all())

    @cached_property
    def values_at_checks(self) -> tuple[Array, Array]:
        """Observables and their errors at the checked places."""
        return self.at(chebyshev_nodes(MAX_DEGREE))

    @cached_property
    def largest_error(self) -> float:
        """The largest error of the observables that the tolerance limits."""
        return float(np.nanmax(self.values_at_checks[1][:, self.problem.controlled]))

    @cached_property
    def _beyond_ends(self) -> Array:
        """How far errors exceed those of the ends, which do not fall with the length."""
        values, errors = self.values_at_checks
        scales = self.problem.scales(values, self.left.coordinate + chebyshev_nodes(MAX_DEGREE) * self.length)
        with np.errstate(over="ignore"):  # series that lead to no number count as wrong
            return np.asarray(errors - np.where(self.problem.sign_changing, self.at_ends[1] / scales, self.at_ends[0]))

    def is_poor(self, rtol: float) -> bool:
        """Return whether it does not interpolate within the tolerance, and a shorter interval might."""
        exists = [np.isfinite(one.series).all(axis=0) for one in (self.left, self.right)]
        if (exists[0] != exists[1]).any():  # something exists on one side alone
            return True
        wrong = (self.values_at_checks[1] > (1 - NEGLIGIBLE) * rtol) & (self._beyond_ends > NEGLIGIBLE * rtol)
        if not wrong[:, self.problem.controlled].any():
            return False
        # Of rounding, or of a film that ruptures, a shorter interval has no less.
        return not self.largest_error > self.before / STEP_GROWTH

    def smooth(self, parts: Any) -> tuple[Any, Array, Any]:
        """Return observables at parts of the interval, their interpolation errors, and the Chebyshev basis."""
        basis, at, count = chebyshev_basis(parts, max(MAX_DEGREE, len(self.form))), value_of(parts), self.left.series.shape[1]
        both = basis[:, : len(self.form)] @ self.form
        found = both[:, :count]
        missed = self.interpolation_error * ((at * (1 - at)) ** self.order)[:, None]
        limit, with_logs = missed / NEGLIGIBLE, np.isfinite(self.form[:, count:]).all(axis=0)
        if (value_of(found) < limit)[:, with_logs].any():
            # A share below its error is interpolated by its logarithm, which keeps sign and digits.
            with np.errstate(all="ignore"):
                tiny = np.exp(both[:, count:])
                found = np.where((found < limit) & (tiny < limit), tiny, found)
        return found, missed, basis

    def at(self, parts: Array) -> tuple[Array, Array]:
        """Return the observables at parts of the interval, and their errors in units of the scales, shape (len(parts), n)."""
        found, missed, basis = self.smooth(parts)
        scales, may_vanish = self.problem.scales(found, self.left.coordinate + parts * self.length), self.problem.sign_changing
        relative, absolute = np.where(may_vanish, 0.0, self.at_ends[0]), np.where(may_vanish, self.at_ends[1], 0.0)
        errors = relative + self.checked_error + (absolute + missed) / scales
        form, of_read, columns, is_smooth = self.read
        if len(columns):
            if is_smooth:
                found[:, columns] = basis[:, :MAX_DEGREE] @ form
            else:
                found[:, columns], of_read, _ = self.problem.read(self.left, self.right, parts)
            errors[:, columns] = of_read + self.checked_error[columns]
        expected = np.isfinite([self.left.series[0], self.right.series[0]]).all(axis=0)
        return found, np.where(np.isnan(found) & expected, np.inf, errors)

    def parts(self, s: Any) -> Any:
        """Return the places of coordinates in the interval."""
        return (s - self.left.coordinate) / max(self.length, np.finfo(float).tiny)


@dataclass(frozen=True, eq=False)
class SolvedPath(ReadablePath):
    """The intervals of a path in ascending order, and its outcome."""

    problem: Any  # A `LineProblem`, or what else solves, scales, checks and reads states as that does
    intervals: tuple[Interval, ...]  # Between neighbouring solved states; of a single state, from it to itself
    outcome: Outcome  # CONVERGED if the path reaches the end asked for

    @cached_property
    def expansions(self) -> tuple[Expansion, ...]:
        """The solved states."""
        found = [self.intervals[0].left] if self.intervals else []
        return (*found, *(one.right for one in self.intervals if one.right is not one.left))

    def with_state(self, new: Expansion) -> SolvedPath:
        """Return the path with one more state, beyond its ends or between others."""
        states, problem = self.expansions, self.problem
        if not states:
            return replace(self, intervals=(Interval(problem, new, new),))
        known = [one for one in self.intervals if one.length > 0]
        k = int(np.searchsorted(self.coordinates, new.coordinate))
        if k == 0:
            known.insert(0, Interval(problem, new, states[0]))
        elif k == len(states):
            known.append(Interval(problem, states[-1], new))
        else:
            before = known[k - 1].largest_error
            known[k - 1 : k] = [Interval(problem, states[k - 1], new, before), Interval(problem, new, states[k], before)]
        return replace(self, intervals=tuple(known))

    def step_length(self, upwards: bool, rtol: float) -> float:
        """Return the longest step on which the coefficients should interpolate within the tolerance."""
        here = self.expansions[-1 if upwards else 0]
        return here.radius * 2.0 * float((NEGLIGIBLE * rtol) ** (0.5 / max(here.order, 1)))

    def intervals_to_halve(self, rtol: float, is_whole: bool) -> list[int]:
        """Return the numbers of the intervals that do not interpolate within the tolerance, and of which half might."""
        return [k for k, one in enumerate(self.intervals) if one.length > 0 and one.is_poor(rtol)]

    def on_interval(self, k: int, s: Any) -> Any:
        """Return the observables with a series on interval k, at coordinates that may bring their derivatives."""
        return self.intervals[k].smooth(self.intervals[k].parts(s))[0]

    def at(self, s: Array) -> tuple[Array, Array]:
        """Return the observables at coordinates, shape (len(s), n), and their errors in units of the scales."""
        found, errors = np.empty((2, len(s), len(self.expansions[0].values)))
        for k, mine in self.pieces(s):
            parts = np.clip(self.intervals[k].parts(s[mine]), 0.0, 1.0)
            found[mine], errors[mine] = self.intervals[k].at(parts)
        return found, errors
