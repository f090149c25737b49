r"""A path of states along one coordinate whose observables are known with their slopes: Hermite interpolation between them.

Between two states each observable is the polynomial through the values and slopes of the six states around: of its logarithm
if it keeps its sign in all states, of the load shares the logarithm of their ratio.  The error is that of the polynomial
through the four nearest, which is larger.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.numerics.continuation import Path, PathProblem
from stribeck.numerics.hermite import inner_places, weights_through
from stribeck.numerics.settings import (
    MAX_LOG_STEP,
    SAFETY,
    SHARE,
    STEP_GROWTH,
    WINDOW,
)
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome

__all__ = ["HermitePath", "Knot", "KnotProblem"]


@dataclass(frozen=True, eq=False)
class Knot:
    """A solved state: its observables, their derivatives by the coordinate, and their errors in units of the scales."""

    coordinate: float
    values: Array  # over the units of the problem
    slopes: Array  # of these
    errors: Array
    state: Any


class KnotProblem(PathProblem, Protocol):
    """The states of a path."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the observables."""

    @property
    def shares(self) -> tuple[int, int]:
        """Columns of the two load shares, whose sum is one."""

    @property
    def one_signed(self) -> Flags:
        """Which observables never change their sign."""

    @property
    def summands(self) -> tuple[int, int]:
        """Columns of an observable of one sign, and of another one that is smoother in the sum of both."""

    @property
    def controlled(self) -> Flags:
        """Which observables the tolerance holds for."""

    def units(self, s: Array) -> Array:
        """Return what observables are divided by before they are interpolated, shape (len(s), n)."""

    def scales(self, values: Array, s: Array) -> Array:
        """Return the scales of the errors of observables at coordinates, shape (len(s), n)."""


@dataclass(frozen=True, eq=False)
class HermitePath(Path):
    """Solved states along a path, ascending, what lies between them, and how the path ended."""

    problem: Any  # A :class:`KnotProblem`, and what else it offers to who made it
    knots: tuple[Knot, ...]
    outcome: Outcome

    def _propagated(self, first: int, last: int, s: Array) -> Array:
        """Return what errors of states ``first`` to ``last`` leave at places, in units of the scales, shape (len(s), n)."""
        at, _ = weights_through(self.coordinates[first : last + 1], s)
        return np.asarray(np.abs(at) @ np.stack([knot.errors for knot in self.knots[first : last + 1]]))

    def _through(self, first: int, last: int, s: Array) -> Array:
        """Return the observables at places by the polynomials through states ``first`` to ``last``, shape (len(s), n)."""
        knots = self.knots[first : last + 1]
        at, slope = weights_through(self.coordinates[first : last + 1], s)
        values, slopes = (np.stack([getattr(knot, name) for knot in knots]) for name in ("values", "slopes"))
        found = at @ values + slope @ slopes
        same_sign = (values > 0).all(axis=0) | (values < 0).all(axis=0)
        keeps: Flags = np.logical_and(self.problem.one_signed, same_sign)
        with np.errstate(all="ignore"):
            logs = at @ np.log(np.abs(values[:, keeps])) + slope @ (slopes[:, keeps] / values[:, keeps])
            one, other = self.problem.summands
            found[:, other] += found[:, one]
            found[:, keeps] = np.sign(values[0, keeps]) * np.exp(logs)
            found[:, other] -= found[:, one]
            one, other = self.problem.shares
            if keeps[one] and keeps[other]:
                ratio = at @ np.log(values[:, one] / values[:, other])
                ratio = ratio + slope @ (slopes[:, one] / values[:, one] - slopes[:, other] / values[:, other])
                found[:, one], found[:, other] = 1 / (1 + np.exp(-ratio)), 1 / (1 + np.exp(ratio))
        return np.asarray(found * self.problem.units(s))

    def _window(self, k: int, width: int) -> tuple[int, int]:
        """Return the first and the last of the states around interval k, so many if there are."""
        count = len(self.knots)
        first = min(max(k + 1 - width // 2, 0), max(count - width, 0))
        return first, min(first + width, count) - 1

    def interpolation_error(self, k: int) -> Array:
        """Return the error of the interpolation on interval k in units of the scales, over its shape.

        That is the error of the polynomial through two states less, as the whole one shows it.
        """
        # On long intervals the errors of both are alike, so that their difference shows about a half of either.
        apart, shape = self._apart(k)[:2]
        return np.asarray((SAFETY**2 * apart / shape).max(axis=0))

    def _apart(self, k: int) -> tuple[Array, Array, Array]:
        """Return how far both polynomials of interval k are apart, the shape, and how far errors of states set them apart."""
        left, right = self.coordinates[k : k + 2]
        parts = inner_places()
        s = left + parts * (right - left)
        window, narrow = self._window(k, WINDOW), self._window(k, max(2, min(WINDOW, len(self.knots)) - 2))
        best = self._through(*window, s)
        if len(self.knots) > 2:
            less = self._through(*narrow, s)
        else:  # by the slopes alone
            ends = np.stack([self.knots[k].values, self.knots[k + 1].values])
            less = (ends[:1] + parts[:, None] * (ends[1:] - ends[:1])) * self.problem.units(s)
        with np.errstate(all="ignore"):
            apart = np.nan_to_num(np.abs(best - less) / self.problem.scales(best, s), nan=math.inf)
        return apart, _shape(parts)[:, None], self._propagated(*window, s) + self._propagated(*narrow, s)

    @cached_property
    def _between(self) -> Array:
        """Errors of the interpolation on all intervals over their shape."""
        return np.stack([self.interpolation_error(k) for k in range(len(self.knots) - 1)])

    def _evaluated(self, s: Array) -> tuple[Array, Indices, Array]:
        """Return the observables, the interval of each place, and its part of it."""
        if len(self.knots) == 1:
            alone = self.knots[0].values * self.problem.units(s)
            return alone, np.zeros(len(s), dtype=int), np.zeros(len(s))
        where = np.clip(np.searchsorted(self.coordinates, s, side="right") - 1, 0, len(self.knots) - 2)
        found: Array = np.empty((len(s), len(self.knots[0].values)))
        for k in np.unique(where).tolist():
            mine = where == k
            found[mine] = self._through(*self._window(k, WINDOW), s[mine])
        left, right = self.coordinates[where], self.coordinates[where + 1]
        return found, where, (s - left) / (right - left)

    def smooth(self, s: Array) -> Array:
        """Return the observables at coordinates, shape (len(s), n)."""
        return self._evaluated(s)[0]

    def at(self, s: Array) -> tuple[Array, Array]:
        """Return the observables at coordinates, and their errors in units of the scales."""
        found, where, parts = self._evaluated(s)
        if len(self.knots) == 1:
            return found, np.repeat(self.knots[0].errors[None], len(s), axis=0)
        errors = _shape(np.clip(parts, 0.0, 1.0))[:, None] * self._between[where]
        for k in np.unique(where).tolist():
            errors[where == k] += self._propagated(*self._window(k, WINDOW), s[where == k])
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
        return [k for k in tested if self.excess(k, rtol, unexplained=True) > 1.0]

    def excess(self, k: int, rtol: float, unexplained: bool = False) -> float:
        """Return the error of interval k over what is allowed: what its ends leave of the tolerance, or their errors."""
        apart, shape, explained = self._apart(k)
        if unexplained:  # What errors of the states explain grows no smaller with more of them
            apart = np.maximum(apart - explained, 0.0)
        between, ends = SAFETY**2 * apart / shape, np.maximum(self.knots[k].errors, self.knots[k + 1].errors)
        return float((between.max(axis=0) / np.maximum(rtol - ends, ends))[self.problem.controlled].max())


def _shape(parts: Array) -> Array:
    """Return how the error of an interpolation with slopes runs between two states, at most one."""
    return np.asarray(16.0 * (parts * (1.0 - parts)) ** 2)
