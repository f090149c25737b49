"""The pressure of a dry contact in a table: its edge and steepest rise, with errors of their own.

All fits are parabolas through the square of the pressure, which is smooth where the pressure begins as the root of the
distance.  How many rows they take is chosen by their errors.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from stribeck._types import Array, Indices, Numbers
from stribeck.quantities.formats import format_percent
from stribeck.quantities.units import InputError, show, to_si

CONTACT_PRESSURE_RATIO = 0.02  # Pressure over the peak below which a row lies outside the contact.
FLANK_PRESSURE_RATIO = 0.9  # Pressure over the peak at which a flank ends.
SECOND_CONTACT_RATIO = 0.1  # Pressure over the peak from which what lies apart is a contact of its own.

MIN_STEP_RATIO = 1e-6  # Step over the length of the table below which two rows have the same position.
MAX_ROWS = 600  # Rows of the contact from which neighbours are averaged: more take longer and tell the same.
MIN_ROWS = 5  # Fewest rows of a fit with residuals, and between an edge and the peak.
WINDOW_RATIO = 1.4  # Rows of a fit over those of the next smaller one.
FITTED = 3  # Coefficients of a fit.
MEDIAN_OF_RESIDUALS = 0.693  # Median over mean of the squared residuals of fits through the fewest rows.
STANDARD_ERRORS = 2.0  # Standard errors that are stated of a fit.
SAFETY_FACTOR = 1.5  # Of the error of the most certain fit: 1 in 20 waved pressures exceeds it (test_film_of_pressure.py).
OUTLIER_RATIO = 3.0  # Residual over the median one from which a row loses weight.
OUTLIER_ROUNDS = 5  # Rounds of weighting.


class Edge(NamedTuple):
    """Where a contact begins, and the root of the distance as which its pressure begins."""

    place: float
    coefficient: tuple[float, float]  # with its error
    flank: float  # Way to nine tenths of the peak
    spacing: float


@dataclass(frozen=True)
class DryPressure:
    """The rows of a contact, whose edge is to the left of them, from the outermost row with pressure on."""

    x: Array
    p: Array
    outermost: float  # Where the edge lies at the most
    side: str  # The edge in the words of the table

    @classmethod
    def of(cls, x: Array, p: Array, side: str) -> Self:
        """Return the contact in a table, or refuse a table with too few rows of it or with several."""
        peak, highest = int(p.argmax()), float(p.max())
        outside = np.flatnonzero(p <= CONTACT_PRESSURE_RATIO * highest)
        first = int(max(outside[outside < peak], default=-1)) + 1
        last = int(min(outside[outside > peak], default=len(x))) - 1
        if (np.r_[p[:first], p[last + 1 :]] > SECOND_CONTACT_RATIO * highest).any():
            raise InputError("The table holds several contacts with no pressure between them; give each a table of its own.")
        if peak - first < MIN_ROWS or last - first < 2 * MIN_ROWS:
            raise InputError(
                f"The table has {peak - first} rows between the {side} edge of the contact and its peak; {MIN_ROWS} are "
                f"needed, and {2 * MIN_ROWS + 1} in the contact. Give finer rows, down to zero pressure; a sharp edge has no "
                "film of its own."
            )
        outermost = x[max(int(np.argmax(p > 0)) - 1, 0)] - (x[first + 1] - x[first])
        starts = np.arange(first, last + 1, math.ceil((last + 1 - first) / MAX_ROWS))
        counts = np.diff(np.append(starts, last + 1))
        place, square = (np.add.reduceat(each[: last + 1], starts) / counts for each in (x, p**2))
        return cls(place, np.sqrt(square), float(outermost), side)

    @property
    def highest(self) -> float:
        """Highest pressure."""
        return float(self.p.max())

    def edge(self) -> Edge:
        """Return the edge, or refuse a pressure that has none."""
        noise, peak = _Noise.of(self.x, self.p), int(self.p.argmax()) + 1
        x, p = self.x[:peak], self.p[:peak]
        places, ended, found = list[float](), list[bool](), list[tuple[float, float]]()
        for n in _windows(len(x)):
            span = x[n - 1] - x[0]
            A = np.vander((x[:n] - x[0]) / span, FITTED, increasing=True)
            plain = weight = 1 / (p[:n] + p[:n].mean())
            for _ in range(OUTLIER_ROUNDS):
                c = np.linalg.lstsq(A * weight[:, None], weight * p[:n] ** 2, rcond=None)[0]
                left = plain * (A @ c - p[:n] ** 2)
                scale = OUTLIER_RATIO * np.median(np.abs(left)) + np.finfo(float).eps * p.max()
                weight = plain / np.sqrt(1 + np.square(left / scale))
            covariance = np.linalg.inv((A * weight[:, None]).T @ (A * weight[:, None]))
            variance = max(
                float(noise.at(float(np.mean(p[:n] ** 2)))), np.sum(np.square(weight * (A @ c - p[:n] ** 2))) / (n - FITTED)
            )
            # The slope of the parabola at its root is the root of its discriminant, k to the fourth.
            square, gradient = c[1] ** 2 - 4 * c[0] * c[2], np.array([-4 * c[2], 2 * c[1], -4 * c[0]])
            doubt = STANDARD_ERRORS * math.sqrt(gradient @ covariance @ gradient * variance)
            low, k, high = (max(each, 0.0) ** 0.25 / math.sqrt(span) for each in (square - doubt, square, square + doubt))
            rising = c[1] + math.sqrt(max(square, 0.0))
            if rising > 0:
                outer = np.power((self.outermost - x[0]) / span, np.arange(FITTED))
                ended.append(outer @ c <= STANDARD_ERRORS * math.sqrt(outer @ covariance @ outer * variance))
                places.append(float(x[0] - span * 2 * c[0] / rising))
                found.append((float(k), float(max(high - k, k - low))))
        if found:
            best, error = _most_certain(found)
            if ended[best]:
                flank = x[int(np.argmax(p >= FLANK_PRESSURE_RATIO * p[-1]))] - places[best]
                return Edge(places[best], (found[best][0], error), float(flank), float(x[1] - x[0]))
        raise InputError(
            f"The pressure has no {self.side} edge: it begins at {format_percent(float(p[0] / p[-1]))} of its peak, and does "
            "not fall to zero there as the root of the distance. Give the whole contact; a sharp edge has no film of its own."
        )

    def steepest_rise(self, zone: float) -> tuple[float, float]:
        """Return the steepest rise of the pressure beyond a place, and its error; zero where it does not rise."""
        x, p, noise = self.x, self.p, _Noise.of(self.x, self.p)
        found = []
        for n in _windows(len(x) // 2, FITTED):
            fits = _Fits.through(x, p, n + 1 - n % 2)
            # The steepest of many fits is steep by noise too: where it is the steepest at the least.
            sigmas = max(STANDARD_ERRORS, math.sqrt(2 * math.log(len(x) / n))) * fits.deviation
            sigmas = sigmas * np.sqrt(np.maximum(noise.at(np.square(fits.pressure)), np.median(fits.residual)))
            beyond = np.maximum(fits.middle, zone)
            slopes, sigmas = (np.interp(beyond, fits.middle, each) for each in (fits.slope, sigmas))
            at = int((slopes - sigmas).argmax())
            if fits.middle[-1] >= zone and slopes[at] > 0:
                found.append((float(slopes[at]), float(sigmas[at])))
        if not found:
            return 0.0, 0.0
        best, error = _most_certain(found)
        return found[best][0], error


def rows_of(x: Iterable[float | str], p: Iterable[float | str]) -> tuple[Array, Array]:
    """Return the rows of a table in order of their positions, or refuse what is no pressure of one contact."""
    columns = []
    for name, values, kind in (("x", x, "length"), ("p", p, "pressure")):
        if isinstance(values, str) or not hasattr(values, "__len__"):
            raise InputError(f"{name} = {show(values)}; it must be a column of numbers, one for each row.")
        cells = values.tolist() if isinstance(values, np.ndarray) else list(values)
        columns.append(np.array([to_si(each, kind, f"{name} in row {i}") for i, each in enumerate(cells, 1)]))
    if len(columns[0]) != len(columns[1]):
        raise InputError(f"x has {len(columns[0])} rows and p has {len(columns[1])}; give as many of both.")
    order = np.argsort(columns[0], kind="stable")
    xs, ps = (column[order] for column in columns)
    if len(xs) < 2 or not ps.max() > 0:
        raise InputError("The table has no pressure above zero; give the contact pressure of the dry contact.")
    if ps.min() < 0:
        raise InputError(
            f"The pressure is negative at x = {xs[ps.argmin()]:.6g} m; set it to zero outside of the contact, and give "
            "compression the positive sign."
        )
    close = np.diff(xs) <= MIN_STEP_RATIO * (xs[-1] - xs[0])
    if close.any():
        raise InputError(f"Two rows have x = {xs[:-1][close][0]:.6g} m; give one pressure for each position.")
    return xs, ps


def _windows(rows: int, fewest: int = MIN_ROWS) -> list[int]:
    """Return the numbers of rows of fits, from the fewest on."""
    sizes = [fewest]
    while sizes[-1] * WINDOW_RATIO < rows:
        sizes.append(math.ceil(sizes[-1] * WINDOW_RATIO))
    return [size for size in sizes if size <= rows]


def _most_certain(found: list[tuple[float, float]]) -> tuple[int, float]:
    """Return which of several values with errors is the most certain, and its error with what two smaller fits change.

    They are of fits of more and more rows, of which those after the first that contradicts a smaller one are too long.
    """
    low, high = -math.inf, math.inf
    errors = list[float]()
    for i, (value, error) in enumerate(found):
        low, high = max(low, value - error), min(high, value + error)
        if low > high:
            break
        others = range(max(i - 2, 0), i) or range(1, len(found))[:1]  # Two, for one may agree by luck.
        # The truncation goes as the square of the rows.
        truncations = [abs(value - found[j][0]) / (1 - WINDOW_RATIO ** (-2 * abs(i - j))) for j in others]
        errors.append(error + max(truncations, default=0.0))
    best = int(np.argmin(errors))
    return best, SAFETY_FACTOR * errors[best]


class _Fits(NamedTuple):
    """Parabolas through the squared pressure of each n neighbouring rows."""

    middle: Array
    pressure: Array
    slope: Array  # of the pressure
    deviation: Array  # of the slope, for noise one
    residual: Array  # mean square, of the pressure

    @classmethod
    def through(cls, x: Array, p: Array, n: int) -> _Fits:
        rows: Indices = np.arange(len(x) - n + 1)[:, None] + np.arange(n)
        middle, span = x[rows[:, n // 2]], x[rows[:, -1]] - x[rows[:, 0]]
        t, q = (x[rows] - middle[:, None]) / span[:, None], p[rows] ** 2
        weight = 1 / (p[rows] + p[rows].mean(axis=1, keepdims=True))
        A = np.stack([np.ones_like(t), t, t**2], axis=-1) * weight[..., None]
        inverse = np.linalg.inv(np.swapaxes(A, 1, 2) @ A)
        c = np.einsum("nij,nkj,nk->ni", inverse, A, q * weight)
        residual = np.sum(np.square(np.einsum("nki,ni->nk", A, c) - q * weight), axis=1) / max(n - FITTED, 1)
        height = np.sqrt(np.maximum(c[:, 0], p.min() ** 2))
        scale = 2 * height * span
        return cls(middle, height, c[:, 1] / scale, np.sqrt(inverse[:, 1, 1]) / scale, residual)


class _Noise(NamedTuple):
    """Variance of the pressure of a table, and the part that grows with its square."""

    absolute: float
    relative: float

    @classmethod
    def of(cls, x: Array, p: Array) -> _Noise:
        fits = _Fits.through(x, p, MIN_ROWS)
        found = (fits.residual, fits.residual / np.square(fits.pressure))
        return cls(*(float(np.median(each)) / MEDIAN_OF_RESIDUALS for each in found))

    def at(self, square: Numbers) -> Array:
        """Return the variance where the square of the pressure is given."""
        return np.asarray(np.maximum(self.absolute, self.relative * square))
