r"""One smooth curve through several measured ones, and how far each lies from it.

.. math:: \ln \mu_i = f(\ln x_i) + a_{c(i)}

with f a cubic spline; the F test of a = 0 asks whether the curves are one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array, Indices

SIZES = range(4, 13)  # Numbers of coefficients that the spline may have

SHIFT = math.log(10.0)  # Largest shift of a curve along the abscissa that is tried

TRIED_SHIFTS = 93

DEPARTURE_TERMS = 3  # Constant, slope and curvature by which a curve may depart on its own

ROWS_PER_TERM = 4  # Rows of a curve for each of these


SHIFT_STEPS, SHIFT_STEP = 8, 0.4  # Steps by which curves are shifted onto each other, and the largest


@dataclass(frozen=True)
class Points:
    """Logarithms of measured curves."""

    x: Array  # Logarithm of the abscissa
    y: Array  # Logarithm of friction
    error: Array  # Standard error of y, or one where it is not known
    curve: Indices
    count: int  # Number of curves
    has_errors: bool

    def part(self, rows: Array | Indices) -> Points:
        """Return some of the rows."""
        return Points(self.x[rows], self.y[rows], self.error[rows], self.curve[rows], self.count, self.has_errors)


@dataclass(frozen=True)
class Least:
    """A weighted least-squares fit."""

    coefficients: Array
    covariance: Array  # For rows with the errors of the points
    residuals: Array  # Over these errors
    leverage: Array
    rank: int

    @property
    def chi_squared(self) -> float:
        """Sum of squares."""
        return float(self.residuals @ self.residuals)


@dataclass(frozen=True)
class Agreement:
    """How well several curves are one."""

    size: int  # Coefficients of the spline
    common: Least  # The common curve alone
    ratio: float  # Scatter about the common curve over the errors, or over the noise of each curve by itself
    ratio_error: float
    scatter: float  # Scatter about the common curve, as a part of friction
    noise: float  # Of each curve by itself, over the stated errors where there are any, else as a part of friction
    variance: float  # Squared size of the noise over that of the points
    probability: float  # With which chance makes curves that are one differ as much


def knots_of(x: Array, size: int) -> Array:
    """Return the knots of a cubic spline with a number of coefficients, spread as the points are."""
    inner = np.quantile(x, np.linspace(0.0, 1.0, size - 2)[1:-1])
    return np.concatenate([np.full(4, x.min()), inner, np.full(4, x.max())])


def basis(x: Array, knots: Array, slope: bool = False) -> Array:
    """Return the B-splines, or their slopes, at places within the knots."""
    from scipy.interpolate import BSpline

    x = np.clip(x, knots[0], knots[-1])
    if not slope:
        return np.asarray(BSpline.design_matrix(x, knots, 3).toarray())
    count = len(knots) - 4
    return np.stack([BSpline(knots, each, 3)(x, 1) for each in np.eye(count)], axis=1)


def least(A: Array, points: Points) -> Least:
    """Return the weighted least-squares fit of columns to the points."""
    weighted, y = A / points.error[:, None], points.y / points.error
    U, S, V = np.linalg.svd(weighted, full_matrices=False)
    seen = S > 1e-10 * S[0]
    U, S, V = U[:, seen], S[seen], V[seen]
    coefficients = V.T @ (U.T @ y / S)
    return Least(coefficients, (V.T / S**2) @ V, y - U @ (U.T @ y), np.einsum("nk,nk->n", U, U), int(seen.sum()))


def agreement(points: Points) -> Agreement:
    """Return how well the curves are one."""
    from scipy.stats import f as f_test

    n, found = len(points.x), None
    for size in SIZES:
        A = basis(points.x, knots_of(points.x, size))
        own = _by_itself(points, size)
        k = own.rank + 1
        if n - k - 1 <= 0:
            break
        criterion = n * math.log(max(own.chi_squared, 1e-300) / n) + 2 * k + 2 * k * (k + 1) / (n - k - 1)
        if found is None or criterion < found[0]:
            found = criterion, size, A, own
    assert found is not None  # as there are rows enough
    _, size, A, own = found
    common = least(A, points)
    freedom = n - own.rank
    own_variance = max(own.chi_squared / freedom, 1e-30)
    variance = max(1.0, own_variance) if points.has_errors else own_variance
    extra = own.rank - common.rank
    statistic = max(common.chi_squared - own.chi_squared, 0.0) / extra / variance
    inside = overlapping(points)
    left = float((1 - common.leverage[inside]).sum())
    ratio = math.sqrt(float((common.residuals[inside] ** 2).sum()) / left / (1.0 if points.has_errors else own_variance))
    squares = (common.residuals[inside] * points.error[inside]) ** 2
    return Agreement(
        size=size,
        common=common,
        ratio=ratio,
        ratio_error=_ratio_error(ratio, left, None if points.has_errors else (freedom, extra)),
        scatter=math.sqrt(float(squares.sum()) / left),
        noise=math.sqrt(own_variance),
        variance=variance,
        probability=float(f_test.sf(statistic, extra, freedom)),
    )


def _by_itself(points: Points, size: int) -> Least:
    """Return the fit of a curve that is the same for all but for a smooth departure and a shift of each."""
    shifts, best = np.zeros(points.count), None
    departures = _departures(points)
    for _ in range(SHIFT_STEPS):
        x = points.x + shifts[points.curve]
        knots = knots_of(x, size)
        A = np.hstack([basis(x, knots), departures])
        if best is None:
            best = found = least(A, points)
        slope = basis(x, knots, slope=True) @ found.coefficients[:size]
        moving = [np.where(points.curve == c, slope, 0.0) for c in range(1, points.count)]
        found = least(np.column_stack([A, *moving]), points)
        if found.chi_squared < best.chi_squared or best.rank < found.rank:
            best = found
        shifts[1:] += np.clip(found.coefficients[-len(moving) :], -SHIFT_STEP, SHIFT_STEP)
    assert best is not None
    return best


def _ratio_error(ratio: float, left: float, estimated: tuple[int, int] | None) -> float:
    """Return the standard error of a ratio of scatters, whose sums of squares vary as noncentral ones of chi squared."""
    if estimated is None:
        excess = max(left * (ratio**2 - 1), 0.0)
        return math.sqrt(2 * (left + 2 * excess)) / (2 * left * ratio)
    freedom, extra = estimated
    squares = max(ratio**2 * (freedom + extra) - freedom, 0.0)
    excess = max(squares - extra, 0.0)
    relative = (2 * extra + 4 * excess) / (extra + excess) ** 2 + 2 / freedom
    return max(squares, extra) * math.sqrt(relative) / (2 * (freedom + extra) * ratio)


def _departures(points: Points) -> Array:
    """Return columns by which each curve but the first departs smoothly from the others."""
    columns = []
    for c in range(1, points.count):
        mine = points.curve == c
        terms = max(1, min(DEPARTURE_TERMS, int(mine.sum()) // ROWS_PER_TERM))
        middle, half = np.mean(points.x[mine]), max(float(np.ptp(points.x[mine])) / 2, 1e-12)
        columns += [np.where(mine, ((points.x - middle) / half) ** power, 0.0) for power in range(terms)]
    return np.stack(columns, axis=1)


def overlapping(points: Points) -> Array:
    """Return which rows lie where another curve was measured too."""
    found = np.zeros(len(points.x), bool)
    there = np.unique(points.curve).tolist()
    for c in there:
        others = [points.x[points.curve == each] for each in there if each != c]
        mine = points.curve == c
        found |= mine & np.any([(points.x >= each.min()) & (points.x <= each.max()) for each in others], axis=0)
    return found


def departure(points: Points, curve: int, found: Agreement) -> tuple[float, float, float, float, bool] | None:
    """Return how far a curve lies from the others; None where fewer than three of its rows lie beside them."""
    # The mean difference of ln(friction) and its error; the logarithm of the factor on the abscissa that removes it, nan
    # where none does, and its error; and whether this factor explains it better.
    mine = points.curve == curve
    others = points.part(~mine)
    inside = np.nonzero(mine & overlapping(points) & (points.x >= others.x.min()) & (points.x <= others.x.max()))[0]
    size = min(found.size, len(others.x) // 2)
    if len(inside) < 3 or size < 4:
        return None
    knots = knots_of(others.x, size)
    curve_of_others = least(basis(others.x, knots), others)
    left = len(others.x) - curve_of_others.rank
    variance = max(found.variance, curve_of_others.chi_squared / left if left else 0.0)
    here = points.part(inside)
    B = basis(here.x, knots)
    d = here.y - B @ curve_of_others.coefficients
    w = here.error**-2.0 / (here.error**-2.0).sum()
    offset = float(w @ d)
    error = math.sqrt(
        float(w @ (found.variance * here.error**2 * w)) + variance * float(w @ B @ curve_of_others.covariance @ B.T @ w)
    )
    at_offset = float((((d - offset) / here.error) ** 2).mean())
    shift, shift_error, at_shift = _shift(points.part(np.nonzero(mine)[0]), curve_of_others, knots, found.variance, variance)
    return offset, error, shift, shift_error, at_shift < at_offset


def _shift(mine: Points, others: Least, knots: Array, variance: float, of_others: float) -> tuple[float, float, float]:
    """Return the shift along the abscissa that brings a curve onto the others, its error, and the mean square that is left."""
    low, high = knots[0], knots[-1]
    needed = max(4, len(mine.x) // 2)

    def left(shift: float) -> float:
        rows = (mine.x + shift >= low) & (mine.x + shift <= high)
        if rows.sum() < needed:
            return math.inf
        d = mine.y[rows] - basis(mine.x[rows] + shift, knots) @ others.coefficients
        return float(((d / mine.error[rows]) ** 2).mean())

    tried = np.linspace(-SHIFT, SHIFT, TRIED_SHIFTS)
    values = [left(each) for each in tried.tolist()]
    best = int(np.argmin(values))
    if not math.isfinite(values[best]) or best in (0, len(tried) - 1):
        return math.nan, math.nan, math.inf
    shift = float(tried[best])
    for _ in range(10):  # Gauss-Newton
        rows = (mine.x + shift >= low) & (mine.x + shift <= high)
        here = mine.part(rows)
        B, slope = basis(here.x + shift, knots), basis(here.x + shift, knots, slope=True) @ others.coefficients
        w = slope / here.error**2
        step = float(w @ (here.y - B @ others.coefficients)) / max(float(w @ slope), 1e-300)
        shift += max(-0.1, min(0.1, step))
        if abs(step) < 1e-6:
            break
    if not math.isfinite(left(shift)):
        return math.nan, math.nan, math.inf
    square = variance * float(w @ (here.error**2 * w)) + of_others * float(w @ B @ others.covariance @ B.T @ w)
    return shift, math.sqrt(square) / max(float(w @ slope), 1e-300), left(shift)


def power_law(points: Points, found: Agreement, logs: Array) -> tuple[float, float, float] | None:
    """Return the power of an input with which friction goes, its error and probability of chance; None below three curves."""
    from scipy.stats import t

    beside = _connected(points)
    if len(beside) < 3 or np.ptp(logs[beside]) < 1e-9:
        return None
    here = points.part(np.nonzero(np.isin(points.curve, beside))[0])
    first, *others = beside
    offsets = np.stack([(here.curve == c) * 1.0 for c in others], axis=1)
    A = np.hstack([basis(here.x, knots_of(here.x, min(found.size, len(here.x) // 2))), offsets])
    both = least(A, here)
    m = len(others)
    a, covariance = both.coefficients[-m:], found.variance * both.covariance[-m:, -m:]
    z = logs[others] - logs[first]
    inverse = np.linalg.pinv(covariance)
    information = float(z @ inverse @ z)
    power = float(z @ inverse @ a) / information
    r = a - power * z
    freedom = m - 1
    error = math.sqrt(max(1.0, float(r @ inverse @ r) / freedom) / information)
    return power, error, float(2 * t.sf(abs(power) / error, freedom))


def _connected(points: Points) -> Sequence[int]:
    """Return the largest set of curves whose ranges hang together."""
    ranges = sorted(
        (float(points.x[points.curve == c].min()), float(points.x[points.curve == c].max()), c) for c in range(points.count)
    )
    sets: list[list[int]] = []
    reach = -math.inf
    for low, high, c in ranges:
        if low > reach:
            sets.append([])
        sets[-1].append(c)
        reach = max(reach, high)
    return sorted(max(sets, key=lambda each: sum(1 for _ in each)))
