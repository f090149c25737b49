r"""A path of states along one coordinate whose observables are known with their slopes: Hermite interpolation between them.

Between two states each observable is the polynomial through the values and slopes of the six states around: of its logarithm
if it keeps its sign in all states, of the load shares the logarithm of their ratio.  The error is that of the polynomial
through the four nearest, which is larger.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from stribeck._types import Array, Flags
from stribeck.numerics.continuation import ReadablePath
from stribeck.numerics.dual import Dual, value_of
from stribeck.numerics.hermite import inner_places, slope_noise, weights_through
from stribeck.numerics.settings import (
    MAX_AMPLIFICATION,
    MAX_LOG_STEP,
    SAFETY,
    SHARE,
    STEP_GROWTH,
    WINDOW,
)
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome


@dataclass(frozen=True, eq=False)
class Knot:
    """A solved state: its observables, their derivatives by the coordinate, and their errors in units of the scales."""

    coordinate: float
    values: Array  # over the units of the problem
    slopes: Array  # of these
    errors: Array
    state: Any
    kind: Any = field(default=None, kw_only=True)  # Where it changes from a state to the next, observables have a kink


@dataclass(frozen=True, eq=False)
class HermitePath(ReadablePath):
    """Solved states along a path, ascending, what lies between them, and how the path ended."""

    problem: Any  # A `LineKnots` or `BallKnots`
    knots: tuple[Knot, ...]
    outcome: Outcome

    def _propagated(self, first: int, last: int, s: Array) -> Array:
        """Return what errors of states ``first`` to ``last`` leave at places, in units of the scales, shape (len(s), n)."""
        at, _ = weights_through(self.coordinates[first : last + 1], s)
        return np.asarray(np.abs(at) @ np.stack([knot.errors for knot in self.knots[first : last + 1]]))

    def _through(self, first: int, last: int, s: Any) -> Any:
        """Return the observables at places by the polynomials through states ``first`` to ``last``, shape (len(s), n)."""
        (values, slopes), (logs, growth), keeps = self._interpolated(first, last)
        at, slope = weights_through(self.coordinates[first : last + 1], s)
        with np.errstate(all="ignore"):
            straight = at @ values + slope @ slopes
            growing = np.sign(values[0]) * np.exp(at @ logs + slope @ growth)
            found = np.where(keeps, growing, straight)
            column = np.arange(len(keeps))
            for one, other in self.problem.summands:
                found = found + (straight[:, [one]] - found[:, [one]]) * (column == other)
            one, other = self.problem.shares
            if self._share_odds(values, keeps):
                ratio = at @ (logs[:, [one]] - logs[:, [other]]) + slope @ (growth[:, [one]] - growth[:, [other]])
                found = np.where(column == one, 1 / (1 + np.exp(-ratio)), found)
                found = np.where(column == other, 1 / (1 + np.exp(ratio)), found)
        return found * self._units(s)

    def _interpolated(self, first: int, last: int) -> tuple[tuple[Array, Array], tuple[Array, Array], Flags]:
        """Return values and slopes of the observables of states, those of their logarithms, and which have these."""
        knots = self.knots[first : last + 1]
        values, slopes = (np.stack([getattr(knot, of) for knot in knots]) for of in ("values", "slopes"))
        same_sign = (values > 0).all(axis=0) | (values < 0).all(axis=0)
        keeps: Flags = np.logical_and(self.problem.one_signed, same_sign)
        sizes = np.where(keeps, values, 1.0)
        return (values, slopes), (np.log(np.abs(sizes)), np.where(keeps, slopes / sizes, 0.0)), keeps

    def _share_odds(self, values: Array, keeps: Flags) -> bool:
        """Return whether the load shares have odds in all states: a fluid that sucks carries less than nothing."""
        shares = list(self.problem.shares)
        return bool(keeps[shares].all() and (values[0, shares] > 0).all())

    def _slope_noise(self, first: int, last: int, s: Array, found: Array) -> Array:
        """Return how far errors of slopes set the observables at places off, shape (len(s), n)."""
        straight, logs, keeps = self._interpolated(first, last)
        nodes, units = self.coordinates[first : last + 1], self._units(self.coordinates[first : last + 1])
        scales = self.problem.scales(straight[0] * units, nodes) / units
        errors = np.stack([knot.errors for knot in self.knots[first : last + 1]]) * scales
        of_logs = np.divide(errors, np.abs(straight[0]), out=np.zeros_like(errors), where=keeps)
        values, slopes, wrong = (each.copy() for each in (*straight, errors))
        for one, other in self.problem.summands:
            for each in (values, slopes, wrong):
                each[:, other] += each[:, one]
        of_values = slope_noise(nodes, values, slopes, wrong, s) * self._units(s)
        noise = np.where(keeps, np.abs(found) * slope_noise(nodes, *logs, of_logs, s), of_values)
        for one, other in self.problem.summands:
            noise[:, other] += noise[:, one]
        one, other = self.problem.shares
        if self._share_odds(straight[0], keeps):
            ratio, growth = (each[:, [one]] - each[:, [other]] for each in logs)
            of_ratio = slope_noise(nodes, ratio, growth, of_logs[:, [one]] + of_logs[:, [other]], s)
            noise[:, [one, other]] = found[:, [one]] * found[:, [other]] * of_ratio
        return np.asarray(noise)

    def _units(self, s: Any) -> Any:
        """Return the units of the observables at places, powers of what varies."""
        at = value_of(s)
        found = self.problem.units(at)
        if not isinstance(s, Dual):
            return found
        growth = 0.5 * np.log(self.problem.units(at + 1.0) / self.problem.units(at - 1.0))
        return Dual(found, np.reshape(s.slope, (-1, 1)) * growth * found)

    def _window(self, k: int, width: int) -> tuple[int, int]:
        """Return the first and the last of the states around interval k, of its kind, at most so many.

        Fewer are taken where errors of states would grow between them, as they do on an interval much longer than the next.
        """
        low, high = self._runs[k]
        places = self.coordinates[k] + inner_places() * (self.coordinates[k + 1] - self.coordinates[k])
        while True:
            first = min(max(k + 1 - width // 2, low), max(high + 1 - width, low))
            last = min(first + width - 1, high)
            at, _ = weights_through(self.coordinates[first : last + 1], places)
            if last - first < 2 or np.abs(at).sum(axis=1).max() <= MAX_AMPLIFICATION:
                return first, last
            width = max(2, last - first - 1)

    @cached_property
    def _runs(self) -> list[tuple[int, int]]:
        """First and last state of the kind of each interval; its ends alone where it joins two kinds."""
        kinks = [k for k, (one, other) in enumerate(pairwise(self.knots)) if one.kind != other.kind]
        found, ends = [], [-1, *kinks, len(self.knots) - 1]
        for before, after in pairwise(ends):
            found += [(before + 1, after)] * (after - before - 1)
            found += [(after, after + 1)] * (after in kinks)
        return found

    def _apart(self, k: int) -> tuple[Array, Array, Array]:
        """Return how far both polynomials of interval k are apart, the shape, and how far errors of states set them apart."""
        left, right = self.coordinates[k : k + 2]
        parts = inner_places()
        s = left + parts * (right - left)
        window = self._window(k, WINDOW)
        states = window[1] - window[0] + 1
        narrow = self._window(k, max(2, states - 2))
        best = self._through(*window, s)
        if states > 2:
            less = self._through(*narrow, s)
        else:  # by the slopes alone
            ends = np.stack([self.knots[k].values, self.knots[k + 1].values])
            less = (ends[:1] + parts[:, None] * (ends[1:] - ends[:1])) * self.problem.units(s)
        with np.errstate(all="ignore"):
            wrong = np.maximum(np.abs(best - less), self._slope_noise(*window, s, best))
            apart = np.nan_to_num(wrong / self.problem.scales(best, s), nan=math.inf)
        apart[:, np.isnan(best).all(axis=0)] = 0.0  # what these states do not have
        return apart, _shape(parts)[:, None], self._propagated(*window, s) + self._propagated(*narrow, s)

    @cached_property
    def _between(self) -> Array:
        """Errors of the interpolation on all intervals in units of the scales, over their shape.

        Each is the error of the polynomial through two states less, as the whole one shows it, or that by errors of slopes.
        """
        # On long intervals the errors of both are alike, so that their difference shows about a half of either.
        parts = (self._apart(k)[:2] for k in range(len(self.knots) - 1))
        return np.stack([(SAFETY**2 * apart / shape).max(axis=0) for apart, shape in parts])

    def on_interval(self, k: int, s: Any) -> Any:
        """Return the observables on interval k, at coordinates that may bring their derivatives."""
        if len(self.knots) == 1:
            return self.knots[0].values * self._units(value_of(s))
        return self._through(*self._window(k, WINDOW), s)

    def at(self, s: Array) -> tuple[Array, Array]:
        """Return the observables at coordinates, and their errors in units of the scales."""
        if len(self.knots) == 1:
            return self.smooth(s), np.repeat(self.knots[0].errors[None], len(s), axis=0)
        found = self.smooth(s)
        errors = np.empty_like(found)
        for k, mine in self.pieces(s):
            left, right = self.coordinates[k : k + 2]
            parts = np.clip((s[mine] - left) / (right - left), 0.0, 1.0)
            of_states = self._propagated(*self._window(k, WINDOW), s[mine])
            errors[mine] = _shape(parts)[:, None] * self._between[k] + of_states
        return found, errors

    @property
    def expansions(self) -> tuple[Knot, ...]:
        """The solved states."""
        return self.knots

    def last_states(self, upwards: bool) -> Sequence[Knot]:
        """Return the last two states, whose slopes predict the next as well as four states would."""
        return self.knots[-2:] if upwards else self.knots[:2]

    def with_state(self, new: Knot) -> HermitePath:
        """Return the path with one more state, beyond its ends or between others."""
        return replace(self, knots=tuple(sorted([*self.knots, new], key=lambda knot: knot.coordinate)))

    def step_length(self, upwards: bool, rtol: float) -> float:
        """Return the step after which the last interval with states on both sides would have its share of the error."""
        lengths = np.diff(self.coordinates)
        if len(self.knots) < WINDOW:
            return float(min(MAX_LOG_STEP / WINDOW, lengths.min(initial=math.inf)))
        k = len(lengths) - 2 if upwards else 1
        excess = self.excess(k, rtol)
        # A shorter step costs less than an interval that is halved.
        growth = (SHARE / excess) ** (0.5 / (WINDOW - 2)) if excess > 0 else STEP_GROWTH
        return float(lengths[k]) * min(max(growth, 1 / STEP_GROWTH), STEP_GROWTH)

    def intervals_to_halve(self, rtol: float, is_whole: bool) -> list[int]:
        """Return the numbers of the intervals whose error is larger than allowed, once states on both sides are there."""
        count = len(self.knots) - 1
        tested = range(count) if is_whole else sorted({1, count - 2}) if count >= WINDOW else []
        return [k for k in tested if self.excess(k, rtol) > 1.0]

    def excess(self, k: int, rtol: float) -> float:
        """Return the error of interval k over what is allowed: what its ends leave of the tolerance, or their errors."""
        apart, shape, explained = self._apart(k)
        # What errors of the states explain grows no smaller with more of them.
        unexplained = np.maximum(apart - explained, 0.0)
        between, ends = SAFETY**2 * unexplained / shape, np.maximum(self.knots[k].errors, self.knots[k + 1].errors)
        return float((between.max(axis=0) / np.maximum(rtol - ends, ends))[self.problem.controlled].max())


def _shape(parts: Array) -> Array:
    """Return how the error of an interpolation with slopes runs between two states, at most one."""
    return np.asarray(16.0 * (parts * (1.0 - parts)) ** 2)
