r"""The flow across a film of a fluid that thins, exactly: shear rates at both walls from what the walls and the flux demand.

The stress is linear across the film, :math:`g(\zeta) = T + Q \zeta` for :math:`-1/2 \le \zeta \le 1/2`, and the rate
:math:`x(g)` follows from the law.  With a given slip and a given flux,

.. math:: \int x \, d\zeta = r_0, \qquad \int \zeta \, x \, d\zeta = r_1 .

Substituting the stress for :math:`\zeta`, both integrals are differences of the law's moments at the walls, and so are their
derivatives

.. math::

    A = \frac{x_b - x_a}{Q}, \quad B = \frac{(x_a + x_b)/2 - r_0}{Q}, \quad C = \frac{(x_b - x_a)/4 - 2 r_1}{Q}, \qquad
    \begin{pmatrix} A & B \\ B & C \end{pmatrix} \begin{pmatrix} dT \\ dQ \end{pmatrix} =
    \begin{pmatrix} dr_0 \\ dr_1 \end{pmatrix}

If both walls have almost the same rate, differences cancel and a Gauss rule in the rate serves.  Newton's iteration takes the
larger wall rate and the stress at the other wall as unknowns: the integrals are almost linear in these.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from stribeck._types import Array, Flags
from stribeck.fluids.laws import Profile, RateLaw
from stribeck.numerics.dual import with_slope

MIN_RATE_RATIO = 0.5  # Least ratio of the wall rates, of one sign, for the Gauss rule; below it the moments serve.

GAUSS_NODES, GAUSS_WEIGHTS = legendre.leggauss(9)  # Rule in the shear rate, good to 1e-14 for rates that differ by two.

MEAN_WEIGHTS = 0.5 * GAUSS_WEIGHTS  # Weights of the mean over the shear rate.

LINEAR_STRESS_BELOW = 1e-6  # Relative difference of the wall rates below which the stress is linear in the rate to rounding.

STEP_RTOL = 1e-7  # Relative Newton step that ends the iteration: the next one, its square, is below rounding.

MAX_STEPS = 80  # Newton steps of a column before its flow counts as not found.

MIN_WALL_RATE = 1e-8  # Least wall rate over the rate at the other wall; laws without a plateau are singular at zero.

LINEAR_RATE_BELOW = 0.01  # Stress step over the stress up to which rate and stress serve equally as the unknown.

MAX_RATE_GROWTH = 4.0  # Largest factor by which the larger wall rate grows or falls in one step.

WALL_POSITIONS = np.array([[-0.5], [0.5]])  # Position of both walls across the film over its width.


def profile(law: RateLaw, r_0: Array, r_1: Array, start: tuple[Array, Array] | None = None) -> Profile:
    """Return the flow with the integrals ``r_0`` and ``r_1``, both of shape (n,), not both zero."""
    x = np.stack((r_0 - 6 * r_1, r_0 + 6 * r_1) if start is None else start)
    size = MIN_WALL_RATE * np.abs(x).max(axis=0)
    x = np.where(np.abs(x) < size, size, x)  # a wall at rest is singular in laws without a plateau
    found = np.empty((9, len(r_0)))
    left = np.arange(len(r_0))
    wanted = np.stack([r_0, r_1])
    here = _Walls.at(law, x, wanted)
    part = np.ones(len(r_0))
    for _ in range(MAX_STEPS):
        # A defect that is no number is never less: such a column has no flow.
        lost = np.isnan(here.defect)
        if lost.any():
            found[:, left[lost]] = np.nan
            if lost.all():
                return Profile(*found)
            left, wanted, part, here = left[~lost], wanted[:, ~lost], part[~lost], here.of(~lost)
        ahead = _step_rates(law, here.x, here.g, part * here.step, here.slope)
        done = (part == 1.0) & (here.step_over_stress() < STEP_RTOL)
        done &= larger(ahead - here.x) < STEP_RTOL * larger(here.x)
        if done.any():
            ended = np.concatenate((ahead, here.g + here.step, here.slope, here.by))
            if len(left) == len(r_0) and done.all():
                return Profile(*ended)
            found[:, left[done]] = ended[:, done]
            if done.all():
                return Profile(*found)
            more = ~done
            left, wanted, part, ahead = left[more], wanted[:, more], part[more], ahead[:, more]
            here = here.of(more)
        there = _Walls.at(law, ahead, wanted)
        worse = ~(there.defect < here.defect)
        part = np.where(worse, 0.5 * part, 1.0)
        here = here.where(worse, there)
    found[:, left] = np.nan
    return Profile(*found)


class _Walls(NamedTuple):
    """Rates, stresses and slopes of the law at both walls, A, B, C, the step of the stresses and the defect, by first axis."""

    x: Array
    g: Array
    slope: Array
    by: Array
    step: Array
    defect: Array

    @classmethod
    def at(cls, law: RateLaw, x: Array, wanted: Array) -> _Walls:
        """Return stresses, slopes and defects at wall rates."""
        g, slope = _odd(law, x)
        integrals, by = _integrals(law, x, g)
        missing = wanted - integrals
        determinant = by[0] * by[2] - by[1] ** 2
        of_mean = (by[2] * missing[0] - by[1] * missing[1]) / determinant
        of_slope = (by[0] * missing[1] - by[1] * missing[0]) / determinant
        return cls(x, g, slope, by, of_mean + WALL_POSITIONS * of_slope, np.hypot(missing[0], 3 * missing[1]))

    def step_over_stress(self) -> Array:
        """Return the step of the stresses over the larger of these."""
        return np.asarray(larger(self.step) / larger(self.g))

    def of(self, chosen: Flags) -> _Walls:
        """Return the chosen nodes."""
        return _Walls(*(each[..., chosen] for each in self))

    def where(self, kept: Flags, other: _Walls) -> _Walls:
        """Return the kept nodes, and the others of ``other``."""
        if not kept.any():
            return other
        return _Walls(*(np.where(kept, mine, its) for mine, its in zip(self, other, strict=True)))


def larger(of_walls: Array) -> Array:
    """Return the larger of the absolute values at both walls."""
    size = np.abs(of_walls)
    return np.asarray(np.maximum(size[0], size[1]))


def _odd(law: RateLaw, rate: Array) -> tuple[Array, Array]:
    g, slope = with_slope(law.stress, np.abs(rate))
    return np.copysign(g, rate), slope


def _step_rates(law: RateLaw, x: Array, g: Array, step: Array, slope: Array) -> Array:
    """Return the wall rates after a step of the stress: linear in the rate at the wall of the larger, else in the stress."""
    size = np.abs(x)
    bound = MAX_RATE_GROWTH * larger(x)
    linear = np.clip(x + step / slope, -bound, bound)
    minor = (size < MIN_RATE_RATIO * size[::-1]) & (np.abs(step) > LINEAR_RATE_BELOW * np.abs(g))
    if minor.any():
        moved = g[minor] + step[minor]
        largest = law.stress(MAX_RATE_GROWTH * size[::-1][minor])
        moved = np.clip(moved, -largest, largest)
        linear[minor] = np.copysign(law.rate(np.abs(moved)), moved)
    return linear


def _integrals(law: RateLaw, x: Array, g: Array) -> tuple[Array, Array]:
    """Return both integrals and their derivatives A, B, C."""
    size = np.abs(x)
    alike: Flags = (x[0] * x[1] > 0) & (np.minimum(size[0], size[1]) > MIN_RATE_RATIO * np.maximum(size[0], size[1]))
    few = np.flatnonzero(alike)
    found = np.empty((5, len(alike)))
    if len(few) < len(alike):
        with np.errstate(all="ignore"):  # alike walls differ by nothing
            found[:] = _by_moments(law, x, g)
    if len(few):
        found[:, few] = _by_rule(law, x[:, few], g[:, few])
    return found[:2], found[2:]


def _by_moments(law: RateLaw, x: Array, g: Array) -> tuple[Array, ...]:
    """Return integrals and derivatives from the moments of the law at the walls."""
    first, second = law.moments(np.abs(x), np.abs(g))
    second = np.copysign(second, x)
    area, moment = first[1] - first[0], second[1] - second[0]
    Q, T = g[1] - g[0], 0.5 * (g[0] + g[1])
    span = x[1] - x[0]
    i_0 = area / Q
    i_1 = (moment - T * area) / Q**2
    return i_0, i_1, span / Q, (0.5 * (x[0] + x[1]) - i_0) / Q, (0.25 * span - 2 * i_1) / Q


def _by_rule(law: RateLaw, x: Array, g_walls: Array) -> tuple[Array, ...]:
    """Return integrals and derivatives by the Gauss rule in the rate."""
    middle, half = 0.5 * (x[0] + x[1]), 0.5 * (x[1] - x[0])
    offset = half * GAUSS_NODES[:, None]
    g, slope = _odd(law, middle + offset)
    mean_slope = MEAN_WEIGHTS @ slope  # Q = 2 half mean_slope
    # zeta at the nodes: the stress relative to that in the middle of the film, over Q.
    flat = np.abs(half) < LINEAR_STRESS_BELOW * np.abs(middle)
    Q = np.where(flat, 1.0, 2 * half * mean_slope)
    zeta = np.where(flat, 0.5 * GAUSS_NODES[:, None], (g - 0.5 * (g_walls[0] + g_walls[1])) / Q)
    by_mean = 1 / mean_slope
    slope = slope * offset  # d zeta is the share of the slope in its mean
    i_0 = middle + by_mean * (MEAN_WEIGHTS @ slope)
    slope *= zeta
    i_1 = by_mean * (MEAN_WEIGHTS @ slope)  # the mean of zeta is zero
    return i_0, i_1, by_mean, by_mean * (MEAN_WEIGHTS @ zeta), by_mean * (MEAN_WEIGHTS @ (zeta * zeta))
