r"""Intervals of a fit, by its covariance or by profile likelihood.

The latter is how far an input can be moved, the others fitted anew, until noise cannot explain it.  An end of the interval is
where :math:`\min_{\theta: \theta_i \text{ fixed}} q - \min q = t^2`, with t the quantile of Student's distribution where the
size of the noise comes from the residuals, as for the robust loss, else of the normal one; for the robust loss times
:math:`\langle \psi^2 \rangle / \langle \psi' \rangle` (Heritier and Ronchetti, J. Am. Stat. Assoc. 89 (1994) 897).
Source: Venzon and Moolgavkar, Appl. Stat. 37 (1988) 87.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from stribeck._types import Array
from stribeck.fits.diagnosis import excess_of
from stribeck.fits.least_squares import Minimum, effective_parameters, minimise, settle
from stribeck.quantities.units import InputError
from stribeck.solver.solve_error import SolveError

LEVELS = (0.682689492137086, 0.95)  # Probabilities of the two intervals

RESTARTS = 4  # Better minima on profiles that are followed before the fit counts as lost

NOTHING = 1e-13  # Eigenvalue of the information, over the largest, below which it is rounding

WIDEST = 600.0  # Half-width of an interval of a logarithm from which it is open

ACCURACY = 0.015  # What an end may miss, in standard errors

ENOUGH = 1e-5  # Relative change of q at which a point of a profile is good enough for that

# Square root of the fall of q that is left at a point of a profile up to which its derivatives say how far it falls: on
# profiles of cylinders and balls that cost an end less than a thousandth of a standard error.
CLOSE = 0.15

MOST_TRIALS = 25

BETTER = 1e-3  # How much lower q may be elsewhere before the minimum was none

LONGEST = 2.0  # Longest first step of a logarithm


class _BetterMinimumError(Exception):
    """The search along a profile found a better fit than that it began from."""

    def __init__(self, theta: Array) -> None:
        super().__init__("a better minimum")
        self.theta = theta


def ends_beside(ends: Array, old: Array, new: Array, half: Array) -> Array:
    """Return the ends of a new fit: each goes as far in its distance from the old fit as this in a half-width."""
    # All of that distance at most: a fit that goes farther than its interval says nothing about the ends.
    part = np.clip(np.nan_to_num((new - old)[:, None] / half), -1.0, 1.0)
    away = np.where(np.isfinite(ends), np.abs(ends - old[:, None, None]), 0.0)
    low, high = np.moveaxis(ends + part[..., None] * away, -1, 0)
    return np.stack([np.minimum(low, new[:, None]), np.maximum(high, new[:, None])], axis=-1)


def information_of(at: Minimum) -> tuple[Array, float, float]:
    """Return the information on the logarithms, the factor by which errors inflate its inverse, and the degrees of freedom."""
    rows, _ = at.objective.priors
    psi, slope = at.objective.influence(at.residuals)
    freedom = max(len(at.residuals) - effective_parameters(at), 1.0)
    # Huber's sandwich for the robust loss, with averages over the rows so that no weight is negative.
    weight = max(float(slope.mean()), 0.1) if at.objective.robust else 1.0
    given = at.objective.sigma is not None
    excess = excess_of(float(at.residuals @ at.residuals), freedom) if given else 1.0
    inflation = float((psi @ psi) / freedom / weight) if at.objective.robust else excess
    return weight * (at.jacobian.T @ at.jacobian) + rows.T @ rows, inflation, freedom


def covariance_of(at: Minimum) -> tuple[Array, list[float], float]:
    """Return the covariance of the logarithms, the squared quantiles of both levels, and how much the loss inflates them."""
    # Inputs at a bound have nan, and inputs that nothing determines infinity on the diagonal and nan beside it.
    from scipy.stats import norm, t

    free = np.nonzero(np.logical_not(at.at_bound))[0]
    information, inflation, freedom = information_of(at)
    p = len(information)
    values, vectors = np.linalg.eigh(information[np.ix_(free, free)])
    seen = values > NOTHING * max(float(values.max(initial=0.0)), 1e-300)
    inner = (vectors[:, seen] / values[seen]) @ vectors[:, seen].T * inflation
    lost = (np.abs(vectors[:, ~seen]) > 1e-6).any(axis=1)
    inner[lost], inner[:, lost] = np.nan, np.nan
    inner[lost, lost] = np.inf
    covariance = np.full((p, p), np.nan)
    covariance[np.ix_(free, free)] = inner
    known = at.objective.sigma is not None and inflation == 1 and not at.objective.robust
    quantiles = [float((norm.ppf(0.5 + level / 2) if known else t.ppf(0.5 + level / 2, freedom)) ** 2) for level in LEVELS]
    return covariance, quantiles, inflation


def ends_of(
    found: Minimum, covariance: Array, quantiles: list[float], inflation: float, profile: bool, report: Callable[[str], None]
) -> tuple[Array, Minimum]:
    """Return the ends of the intervals, infinite where open, shape (p, levels, 2), and the minimum that they belong to."""
    if not profile:
        half = np.sqrt(np.outer(np.diag(covariance), quantiles))
        half = np.where(half < WIDEST, half, math.inf)[..., None]
        return np.concatenate([-half, half], axis=-1) + found.theta[:, None, None], found
    thresholds = [q * inflation for q in quantiles]
    for _ in range(RESTARTS):
        try:
            finite = np.where(np.isfinite(covariance), covariance, 0.0)
            ends = np.full((len(found.theta), len(thresholds), 2), (-math.inf, math.inf))
            for i in np.flatnonzero(~np.isinf(np.diag(covariance))).tolist():
                for side, sign in enumerate((-1.0, 1.0)):
                    ends[i, :, side] = _side(found, i, sign, finite, thresholds, lambda: report("intervals"))
            return ends, found
        except _BetterMinimumError as better:
            found = settle(found.objective, better.theta, lambda: report("fitting"))
            covariance, _, _ = covariance_of(found)
    return ends_of(replace(found, ended=False), covariance, quantiles, inflation, False, report)


def _side(
    at: Minimum, i: int, sign: float, covariance: Array, thresholds: list[float], on_point: Callable[[], object]
) -> list[float]:
    bounds = at.objective.bounds
    limit = float(bounds[0][i] if sign < 0 else bounds[1][i])
    reach = abs(limit - float(at.theta[i]))
    width = math.sqrt(max(float(covariance[i, i]), 0.0))
    follow = covariance[:, i] / covariance[i, i] if covariance[i, i] > 0 else np.eye(len(at.theta))[i]
    known: list[tuple[float, float, Array]] = [(0.0, 0.0, at.theta)]
    from_case = False  # Whether the others start from their values in the case

    def root_excess(distance: float) -> float:
        """Return the square root of what q is above its minimum, at a distance from the fit."""
        # From the side of the fit: a point farther out may be in another minimum, as one trial was a long way.
        near = max((point for point in known if point[0] < distance), key=lambda point: point[0])
        fixed = {i: float(at.theta[i]) + sign * distance}
        # Where the others do not follow as they should, they may end beyond the model or in another minimum.
        guesses = [near[2] + sign * (distance - near[0]) * follow, near[2]]
        again = [point for point in known if point[0] == distance]
        for guess in [np.zeros_like(at.theta)] if from_case else reversed(guesses) if again else guesses:
            try:
                inside = np.clip(guess, bounds[0] + 1e-9, bounds[1] - 1e-9)
                found = minimise(at.objective, inside, fixed, tolerance=ENOUGH, near=CLOSE)
                break
            except (SolveError, InputError):
                continue
        else:
            return math.inf
        if found.value < at.value - BETTER:
            raise _BetterMinimumError(found.theta)
        excess = math.sqrt(max(0.0, found.value - found.fall - at.value))
        best = min([*again, (distance, excess, found.theta)], key=lambda point: point[1])
        known[:] = [*(point for point in known if point[0] != distance), best]
        on_point()
        return best[1]

    ends, distance = [], 0.0
    for threshold in thresholds:
        # A profile that is not monotone crosses a level more than once: the wider interval holds the narrower one.
        target = math.sqrt(threshold)
        distance = max(distance, _crossing(root_excess, known, target, width, reach))
        if math.isfinite(distance) and not from_case:
            # Noise may lead the fit out of the valley of q that the case lies in, which is lower farther out.
            from_case = True
            if root_excess(distance) < target - ACCURACY:
                known[:] = [point for point in known if point[0] <= distance]
                distance = max(distance, _crossing(root_excess, known, target, width, reach))
            else:
                from_case = False
        ends.append(float(at.theta[i]) + sign * distance)
    return ends


def _crossing(
    function: Callable[[float], float], known: list[tuple[float, float, Array]], target: float, width: float, reach: float
) -> float:
    """Return where a function that rises nearly linearly from zero, perhaps to infinity, crosses a target; else infinity."""
    low, low_value = max(((d, v) for d, v, _ in known if v <= target), default=(0.0, 0.0))
    above = [(d, v) for d, v, _ in known if d > low]
    high, high_value = min(above, default=(math.inf, math.inf))
    slope = 1 / width if width > 0 else 1.0
    short = False  # Whether the straight line fell short of the crossing
    for _ in range(MOST_TRIALS):
        if math.isinf(high):
            if low >= reach * (1 - 1e-9):
                return math.inf
            rate = low_value / low if low > 0 and low_value > 0 else slope
            trial = min(reach, max(target / rate, 1.02 * low), low + LONGEST)
        else:
            # The straight line between the ends, kept away from both; the middle where the farther one cannot be solved.
            straight = math.isfinite(high_value) and not short
            part = (target - low_value) / (high_value - low_value) if straight else 0.5
            trial = low + (high - low) * min(0.95, max(0.05, part))
        value = function(trial)
        if abs(value - target) < ACCURACY:
            return trial
        short = value <= target
        if not short:
            high, high_value = trial, value
            continue
        low, low_value = trial, value
        if math.isfinite(high):  # found from farther away, it may be in another minimum
            high_value = function(high)
        if high_value <= target:
            low, low_value, high, high_value = high, high_value, math.inf, math.inf
        if high - low < 1e-6 * max(high, 1e-3):
            break
    return high if math.isfinite(high_value) else math.inf
