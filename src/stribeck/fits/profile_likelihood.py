r"""Intervals by profile likelihood: how far an input can be moved, the others fitted anew, until noise cannot explain it.

An end of the interval is where :math:`\min_{\theta: \theta_i \text{ fixed}} q - \min q = t^2`, with t the quantile of
Student's distribution where the size of the noise comes from the residuals, else of the normal one; for the robust loss times
:math:`\langle \psi^2 \rangle / \langle \psi' \rangle` (Heritier and Ronchetti, J. Am. Stat. Assoc. 89 (1994) 897).
Source: Venzon and Moolgavkar, Appl. Stat. 37 (1988) 87.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.fits.least_squares import Minimum, minimise
from stribeck.quantities.units import InputError
from stribeck.solver.solve_error import SolveError

__all__ = ["BetterMinimumError", "Ends", "profile_ends"]

ACCURACY = 0.015  # What an end may miss, in standard errors

ENOUGH = 1e-5  # Relative change of q at which a point of a profile is good enough for that

# Square root of the fall of q that is left at a point of a profile up to which its derivatives say how far it falls: on
# profiles of cylinders and balls that cost an end less than a thousandth of a standard error.
CLOSE = 0.15

MOST_TRIALS = 25

BETTER = 1e-3  # How much lower q may be elsewhere before the minimum was none

LONGEST = 2.0  # Longest first step of a logarithm


class BetterMinimumError(Exception):
    """The search along a profile found a better fit than that it began from."""

    def __init__(self, theta: Array) -> None:
        super().__init__("a better minimum")
        self.theta = theta


@dataclass(frozen=True)
class Ends:
    """An interval of the logarithm of a factor; infinite where it is open within the bounds."""

    low: float
    high: float


def profile_ends(
    at: Minimum, i: int, covariance: Array, thresholds: list[float], on_point: Callable[[], object] | None = None
) -> list[Ends]:
    """Return the intervals of one free input."""
    sides = [_side(at, i, sign, covariance, thresholds, on_point) for sign in (-1.0, 1.0)]
    return [Ends(low, high) for low, high in zip(*sides, strict=True)]


def _side(
    at: Minimum, i: int, sign: float, covariance: Array, thresholds: list[float], on_point: Callable[[], object] | None
) -> list[float]:
    bounds = at.objective.bounds
    limit = float(bounds[0][i] if sign < 0 else bounds[1][i])
    reach = abs(limit - float(at.theta[i]))
    width = math.sqrt(max(float(covariance[i, i]), 0.0))
    follow = covariance[:, i] / covariance[i, i] if covariance[i, i] > 0 else np.eye(len(at.theta))[i]
    known: list[tuple[float, float, Array]] = [(0.0, 0.0, at.theta)]

    def root_excess(distance: float) -> float:
        """Return the square root of what q is above its minimum, at a distance from the fit."""
        near = min(known, key=lambda point: abs(point[0] - distance))
        fixed = {i: float(at.theta[i]) + sign * distance}
        # Where the others do not follow as they should, they may be led beyond what the model holds for.
        for guess in (near[2] + sign * (distance - near[0]) * follow, near[2]):
            try:
                inside = np.clip(guess, bounds[0] + 1e-9, bounds[1] - 1e-9)
                found = minimise(at.objective, inside, fixed, tolerance=ENOUGH, near=CLOSE)
                break
            except (SolveError, InputError):
                continue
        else:
            return math.inf
        if found.value < at.value - BETTER:
            raise BetterMinimumError(found.theta)
        excess = math.sqrt(max(0.0, found.value - found.fall - at.value))
        known.append((distance, excess, found.theta))
        if on_point is not None:
            on_point()
        return excess

    ends = []
    for threshold in thresholds:
        target = math.sqrt(threshold)
        ends.append(float(at.theta[i]) + sign * _crossing(root_excess, known, target, width, reach))
    return ends


def _crossing(
    function: Callable[[float], float], known: list[tuple[float, float, Array]], target: float, width: float, reach: float
) -> float:
    """Return where a function that rises nearly linearly from zero crosses a target; infinity if not within ``reach``.

    The function may be infinite beyond some distance.
    """
    low, low_value = max(((d, v) for d, v, _ in known if v <= target), default=(0.0, 0.0))
    above = [(d, v) for d, v, _ in known if v > target]
    high, high_value = min(above, default=(math.inf, math.inf))
    slope = 1 / width if width > 0 else 1.0
    for _ in range(MOST_TRIALS):
        if math.isinf(high):
            if low >= reach * (1 - 1e-9):
                return math.inf
            rate = low_value / low if low > 0 and low_value > 0 else slope
            trial = min(reach, max(target / rate, 1.02 * low), low + LONGEST)
        else:
            # The straight line between the ends, kept away from both; the middle where the farther one cannot be solved.
            part = (target - low_value) / (high_value - low_value) if math.isfinite(high_value) else 0.5
            trial = low + (high - low) * min(0.95, max(0.05, part))
        value = function(trial)
        if abs(value - target) < ACCURACY:
            return trial
        if value <= target:
            low, low_value = trial, value
        else:
            high, high_value = trial, value
        if high - low < 1e-6 * max(high, 1e-3):
            break
    return high if math.isfinite(high_value) else math.inf
