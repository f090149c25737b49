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
from stribeck.fluids.laws import RateLaw

ALIKE = 0.5
"""Smallest ratio of the wall rates, of one sign, at which the Gauss rule serves."""

NODES, WEIGHTS = legendre.leggauss(9)
"""Gauss rule in the rate: exact to 1e-14 for rates that differ by a factor of two."""

STEEPEST = 1e-6
"""Relative difference of the wall rates below which the stress is linear in the rate to rounding of the moments."""

CLOSE = 1e-7
"""Relative step after which the next would be below rounding, as steps are squared."""

MOST_STEPS = 80

AT_REST = 1e-8
"""Smallest wall rate over that of the other wall."""

SMALL_STEP = 0.01
"""Step of the stress over the stress up to which it makes no difference which of the two is the unknown."""

LARGEST_STEP = 4.0
"""Factor by which the larger wall rate may grow in a step; it may fall by as much."""


class Profile(NamedTuple):
    """The flow across the film at many nodes: rates x, stresses g and slopes dg/dx at the walls a and b, and A, B, C."""

    x_a: Array
    x_b: Array
    g_a: Array
    g_b: Array
    slope_a: Array
    slope_b: Array
    by_mean: Array
    mixed: Array
    by_slope: Array

    def change(self, r_0: Array | float, r_1: Array | float) -> tuple[Array, Array]:
        """Return the changes of T and Q for those of both integrals."""
        determinant = self.by_mean * self.by_slope - self.mixed**2
        return (self.by_slope * r_0 - self.mixed * r_1) / determinant, (self.by_mean * r_1 - self.mixed * r_0) / determinant


def profile(law: RateLaw, r_0: Array, r_1: Array, start: tuple[Array, Array] | None = None) -> Profile:
    """Return the flow with the integrals ``r_0`` and ``r_1``, both of shape (n,), not both zero.

    Parameters
    ----------
    law : RateLaw
        The law.
    r_0, r_1 : ndarray, shape (n,)
        Integrals of the rate.
    start : pair of ndarray, optional
        Wall rates to start from.
    """
    x_a, x_b = (r_0 - 6 * r_1, r_0 + 6 * r_1) if start is None else start
    size = np.maximum(np.abs(x_a), np.abs(x_b))
    # A wall at rest is singular in laws without a plateau.
    x_a, x_b = (np.where(np.abs(x) < AT_REST * size, AT_REST * size, x) for x in (x_a, x_b))
    found = np.empty((9, len(r_0)))
    left = np.arange(len(r_0))
    wanted = np.stack([r_0, r_1])
    here = _Walls.at(law, x_a, x_b, wanted)
    part = np.ones(len(r_0))
    for _ in range(MOST_STEPS):
        ahead = here.moved(law, part)
        change = np.maximum(np.abs(ahead[0] - here.x_a), np.abs(ahead[1] - here.x_b)) / here.size
        done = (np.maximum(change, here.stress_change) < CLOSE) & (part == 1.0)
        if done.any():
            found[:, left[done]] = here.ending(ahead, done)
            more = ~done
            left, wanted, part = left[more], wanted[:, more], part[more]
            here, ahead = here.of(more), (ahead[0][more], ahead[1][more])
            if not len(left):
                return Profile(*found)
        there = _Walls.at(law, *ahead, wanted)
        worse = ~(there.defect < here.defect)
        part = np.where(worse, 0.5 * part, 1.0)
        here = here.where(worse, there)
    found[:, left] = np.nan
    return Profile(*found)


class _Walls(NamedTuple):
    """Rates, stresses and slopes of the law at both walls, A, B, C, the step to take and how much is missing."""

    x_a: Array
    x_b: Array
    g_a: Array
    g_b: Array
    slope_a: Array
    slope_b: Array
    by_mean: Array
    mixed: Array
    by_slope: Array
    step_a: Array
    step_b: Array
    size: Array
    defect: Array

    @classmethod
    def at(cls, law: RateLaw, x_a: Array, x_b: Array, wanted: Array) -> _Walls:
        """Return what is known at these wall rates."""
        g_a, slope_a = _odd(law, x_a)
        g_b, slope_b = _odd(law, x_b)
        i_0, i_1, by_mean, mixed, by_slope = _integrals(law, x_a, x_b, g_a, g_b)
        missing_0, missing_1 = wanted[0] - i_0, wanted[1] - i_1
        determinant = by_mean * by_slope - mixed**2
        d_mean = (by_slope * missing_0 - mixed * missing_1) / determinant
        d_slope = (by_mean * missing_1 - mixed * missing_0) / determinant
        step_a, step_b = d_mean - 0.5 * d_slope, d_mean + 0.5 * d_slope
        size = np.maximum(np.abs(x_a), np.abs(x_b))
        defect = np.hypot(missing_0, 3 * missing_1)
        return cls(x_a, x_b, g_a, g_b, slope_a, slope_b, by_mean, mixed, by_slope, step_a, step_b, size, defect)

    @property
    def stress_change(self) -> Array:
        """The step of the stresses over the larger of these."""
        largest = np.maximum(np.abs(self.g_a), np.abs(self.g_b))
        return np.asarray(np.maximum(np.abs(self.step_a), np.abs(self.step_b)) / largest)

    def of(self, chosen: Flags) -> _Walls:
        """Return the chosen nodes."""
        return _Walls(*(each[chosen] for each in self))

    def where(self, kept: Flags, other: _Walls) -> _Walls:
        """Return the kept nodes, and the others of ``other``."""
        if not kept.any():
            return other
        return _Walls(*(np.where(kept, mine, its) for mine, its in zip(self, other, strict=True)))

    def moved(self, law: RateLaw, part: Array) -> tuple[Array, Array]:
        """Return the wall rates after a part of the step."""
        return (
            _moved(law, self.x_a, self.g_a, part * self.step_a, self.slope_a, self.x_b),
            _moved(law, self.x_b, self.g_b, part * self.step_b, self.slope_b, self.x_a),
        )

    def ending(self, ahead: tuple[Array, Array], done: Flags) -> Array:
        """Return the fields of the profile after a last step."""
        x_a, x_b = ahead
        g_a, g_b = self.g_a + self.step_a, self.g_b + self.step_b
        slopes = (self.slope_a, self.slope_b)
        return np.stack([x_a, x_b, g_a, g_b, *slopes, self.by_mean, self.mixed, self.by_slope])[:, done]


def _odd(law: RateLaw, rate: Array) -> tuple[Array, Array]:
    g, slope = law.stress(np.abs(rate))
    return np.copysign(g, rate), slope


def _moved(law: RateLaw, x: Array, g: Array, step: Array, slope: Array, other: Array) -> Array:
    """Return the wall rates after a step of the stress: linear in the rate at the wall of the larger, else in the stress."""
    linear = x + step / slope
    bound = np.maximum(np.abs(x), np.abs(other))
    linear = np.clip(linear, -LARGEST_STEP * bound, LARGEST_STEP * bound)
    minor = (np.abs(x) < ALIKE * np.abs(other)) & (np.abs(step) > SMALL_STEP * np.abs(g))
    if minor.any():
        moved = g[minor] + step[minor]
        largest = law.stress(LARGEST_STEP * np.abs(other[minor]))[0]
        moved = np.clip(moved, -largest, largest)
        linear[minor] = np.copysign(law.rate(np.abs(moved)), moved)
    return linear


def _integrals(law: RateLaw, x_a: Array, x_b: Array, g_a: Array, g_b: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Return both integrals and their derivatives A, B, C."""
    alike: Flags = (x_a * x_b > 0) & (np.minimum(np.abs(x_a), np.abs(x_b)) > ALIKE * np.maximum(np.abs(x_a), np.abs(x_b)))
    found = np.empty((5, len(x_a)))
    apart = ~alike
    if apart.any():
        found[:, apart] = _by_moments(law, *(each[apart] for each in (x_a, x_b, g_a, g_b)))
    if alike.any():
        found[:, alike] = _by_rule(law, *(each[alike] for each in (x_a, x_b, g_a, g_b)))
    return tuple(found)  # type: ignore[return-value]


def _by_moments(law: RateLaw, x_a: Array, x_b: Array, g_a: Array, g_b: Array) -> tuple[Array, ...]:
    """Return integrals and derivatives from the moments of the law at the walls."""
    first, second = law.moments(np.abs(np.concatenate([x_a, x_b])))
    n = len(x_a)
    area = first[n:] - first[:n]
    moment = np.copysign(second[n:], x_b) - np.copysign(second[:n], x_a)
    Q, T = g_b - g_a, 0.5 * (g_a + g_b)
    i_0 = area / Q
    i_1 = (moment - T * area) / Q**2
    return i_0, i_1, (x_b - x_a) / Q, (0.5 * (x_a + x_b) - i_0) / Q, (0.25 * (x_b - x_a) - 2 * i_1) / Q


def _by_rule(law: RateLaw, x_a: Array, x_b: Array, g_a: Array, g_b: Array) -> tuple[Array, ...]:
    """Return integrals and derivatives by the Gauss rule in the rate."""
    middle, half = 0.5 * (x_a + x_b), 0.5 * (x_b - x_a)
    offset = half * NODES[:, None]
    g, slope = _odd(law, middle + offset)
    weights = 0.5 * WEIGHTS[:, None]
    mean_slope = (weights * slope).sum(axis=0)  # Q = 2 half mean_slope
    share = weights * slope / mean_slope  # d zeta
    # zeta at the nodes: the stress relative to that in the middle of the film, over Q.
    flat = np.abs(half) < STEEPEST * np.abs(middle)
    Q = np.where(flat, 1.0, 2 * half * mean_slope)
    zeta = np.where(flat, 0.5 * NODES[:, None], (g - 0.5 * (g_a + g_b)) / Q)
    i_0 = middle + (share * offset).sum(axis=0)
    i_1 = (share * zeta * offset).sum(axis=0)  # the mean of zeta is zero
    by_mean = 1 / mean_slope
    return (
        i_0,
        i_1,
        by_mean,
        by_mean * (weights * zeta).sum(axis=0),
        by_mean * (weights * zeta**2).sum(axis=0),
    )
