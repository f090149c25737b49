r"""The flow across a film in the plane of a fluid that thins: a vector problem at each node, without an average viscosity.

The stress is linear across the film, :math:`\mathbf g(\zeta) = \mathbf T + \mathbf Q \zeta` for
:math:`-1/2 \le \zeta \le 1/2`, and the rate has its direction, :math:`\mathbf x = \varphi(g) \, \mathbf g` with
:math:`\varphi = x(g)/g`: pressure gradient and sliding thin the fluid for each other, whatever the angle between them.
With a given pressure gradient Q and slip the mean stress follows from

.. math:: \mathbf r_0 = \int \varphi \, \mathbf g \, d\zeta, \qquad
    \mathbf r_1 = \int \zeta \, \varphi \, \mathbf g \, d\zeta ,

a convex problem in two unknowns; :math:`\mathbf r_1` is what the film carries.  With the moments :math:`K_k` of
:math:`\zeta^k \, d\mathbf x/d\mathbf g`

.. math:: d\mathbf T = K_0^{-1} (d\mathbf r_0 - K_1 \, d\mathbf Q), \qquad
    d\mathbf r_1 = K_1 K_0^{-1} d\mathbf r_0 + (K_2 - K_1 K_0^{-1} K_1) \, d\mathbf Q .

The integrals are Gauss's on both sides of the place of the smallest stress, in the root of the distance from it, and moments
are about that place: nothing cancels.  In one direction this is :mod:`stribeck.fluids.local_flow`.

Source: ours; the generalised Reynolds equation in integrals of the fluidity is [Dowson 1962].
"""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.polynomial import legendre

from stribeck._types import Array, Flags
from stribeck.fluids.laws import RateLaw
from stribeck.numerics.cells import Cells
from stribeck.numerics.settings import EPSILON, HALF_DIGITS, LEAST_DEGREE, MAX_REFINEMENTS, MAX_STEPS, MIN_LOG_STEP, NEGLIGIBLE

# Columns at which rules are compared: slips, shear rates at the walls by the pressure gradient alone, angles between them.
SAMPLE_STATES = np.array(
    [(slip, slope, angle) for slip in (0.3, 5.0, 50.0, 500.0) for slope in (0.3, 5.0, 50.0) for angle in (0.1, 1.5, 2.5)]
).T

TINY = math.sqrt(np.finfo(float).tiny)  # Smallest divisor, and lowest rate of a law without a plateau: its square is normal


@lru_cache(maxsize=16)
def rule(points: int) -> tuple[Array, Array]:
    """Return roots of distances, and values there -> moments of the order k = 0 ... 4 over a side of length one."""
    nodes, weights = legendre.leggauss(points)
    roots = 0.5 * (1 + nodes)
    return roots, (roots[:, None] ** (2 * np.arange(5) + 1)) * weights[:, None]


@dataclass(frozen=True, eq=False)
class FlowCurve:
    """Fluidity as a function of the stress, from a table."""

    log_fluidity: Cells  # `ln(x/g)` as a function of `ln g`, which goes on along its tangents
    ends: tuple[float, float]  # Logarithms of the stresses at which the table ends
    points: int  # Gauss points of the rule on each side of the smallest stress that the law needs

    def __call__(self, square: Array) -> tuple[Array, Array]:
        """Return ``x/g`` and the derivative of its logarithm by ``ln g`` at squares of stresses."""
        place = 0.5 * np.log(np.maximum(square, TINY**2))
        inside = np.nan_to_num(np.clip(place, *self.ends))  # place is nan where the stress is
        log, slope = self.log_fluidity.with_slope(inside)
        return np.exp(log + (place - inside) * slope), slope


@lru_cache(maxsize=32)
def flow_curve(law: Any) -> FlowCurve:
    """Return the flow curve of a :class:`RateLaw`; fits and sweeps ask for many."""

    def log_fluidity(log_stress: Array) -> Array:
        stress = np.exp(log_stress)
        return np.asarray(np.log(law.rate(stress) / stress))

    # Below a plateau the viscosity is constant to the square of the rate.
    rates = np.array([law.plateau * HALF_DIGITS if law.plateau > 0 else TINY, 1 / EPSILON])
    ends = float(np.log(law.stress(rates[0]))), float(np.log(law.stress(rates[1])))
    table = Cells.of(log_fluidity, *ends, math.ceil((ends[1] - ends[0]) / MIN_LOG_STEP), LEAST_DEGREE + 1)
    slip, wall, angle = SAMPLE_STATES
    slope = 2 * law.stress(wall) * np.stack([np.cos(angle), np.sin(angle)])
    slip = np.stack([slip, np.zeros_like(slip)])

    def with_points(points: int) -> FlowCurve:
        return FlowCurve(table, ends, points)

    def carried(points: int) -> Array:
        return _solved(law, with_points(points), slope, slip).carried

    for points in range(2 * LEAST_DEGREE, MAX_REFINEMENTS * LEAST_DEGREE, LEAST_DEGREE):
        fine = carried(2 * points)
        if (np.hypot(*(carried(points) - fine)) <= HALF_DIGITS * np.hypot(*fine)).all():
            break
    return with_points(points)


class Column(NamedTuple):
    """The flow across the film at many nodes; vectors have the shape (2, n), symmetric matrices (3, n): xx, xy, yy."""

    mean: Array  # T, the mean stress
    carried: Array  # The moment r_1 of the rate
    by_slope: Array  # The derivative of r_1 by Q
    by_slip: Array  # The derivative of r_1 by r_0
    compliance: Array  # The inverse of K_0: the derivative of T by r_0


def column(law: RateLaw, slope: Array, slip: Array, start: Array | None = None) -> Column:
    """Return the flow with a pressure gradient and a slip."""
    return _solved(law, flow_curve(cast("Hashable", law)), slope, slip, start)


def mean_wall_stress(flow: Column, along: Array, slide: float) -> Array:
    """Return the mean stress along the motion over the slide, shape (n,); over the slip where the walls roll."""
    if slide:
        return np.asarray(-(flow.mean * along).sum(axis=0) / slide)
    return np.asarray((times(flow.compliance, along) * along).sum(axis=0))


def _solved(law: RateLaw, curve: FlowCurve, slope: Array, slip: Array, start: Array | None = None) -> Column:
    n = slope.shape[1]
    found = np.full((14, n), np.nan)
    at = first_guess(law, curve, slope, slip) if start is None else start
    left = np.flatnonzero(np.isfinite(slope).all(axis=0) & np.isfinite(slip).all(axis=0) & np.isfinite(at).all(axis=0))
    here = _Integrals.at(curve, at[:, left], slope[:, left], slip[:, left])
    part = np.ones(left.size)
    for _ in range(MAX_STEPS):
        if not left.size:
            break
        done = (here.size < HALF_DIGITS) & (part == 1.0)
        if done.any():
            found[:, left[done]] = here.of(done).ending()
            left, here, part = left[~done], here.of(~done), part[~done]
            continue
        there = _Integrals.at(curve, here.mean + part * here.step, here.slope, here.slip)
        before, after = (here.missing * here.step).sum(axis=0), -(there.missing * here.step).sum(axis=0)
        too_far = ~(after <= (1 - NEGLIGIBLE) * before)
        part = np.where(too_far, 0.5 * part, 1.0)
        here = there if not too_far.any() else here.where(too_far, there)
    return Column(found[:2], found[2:4], found[4:7], found[7:11].reshape(2, 2, n), found[11:])


def first_guess(law: RateLaw, curve: FlowCurve, slope: Array, slip: Array) -> Array:
    """Return a first mean stress, thinned by the larger of slip and pressure gradient."""
    size = np.sqrt((slip * slip).sum(axis=0))
    by_slope = curve((slope * slope).sum(axis=0) / 12)[0]
    alone = law.stress(size) / np.maximum(size, TINY)
    return np.asarray(slip * np.minimum(np.where(size > 0, alone, 1.0), 1 / by_slope))


class _Integrals(NamedTuple):
    """The integrals at a mean stress: moments about the smallest stress, the step to take, and the residual of r_0."""

    mean: Array
    slope: Array
    slip: Array
    place: Array
    carried: Array
    zeroth: Array
    first: Array
    second: Array
    missing: Array
    step: Array
    size: Array

    @classmethod
    def at(cls, curve: FlowCurve, mean: Array, slope: Array, slip: Array) -> _Integrals:
        """Return the integrals at a mean stress."""
        steepness = (slope * slope).sum(axis=0)
        roots, moments = rule(curve.points)
        place = np.clip(-(mean * slope).sum(axis=0) / np.maximum(steepness, TINY), -0.5, 0.5)
        least = mean + place * slope
        lengths = np.stack([0.5 - place, -0.5 - place])
        away = lengths[..., None] * roots**2
        square = (least * least).sum(axis=0)[:, None] + away * (
            2 * (least * slope).sum(axis=0)[:, None] + away * steepness[:, None]
        )
        compliance, bend = curve(square)
        powers = np.abs(lengths[..., None]) * lengths[..., None] ** np.arange(5)
        a = ((compliance @ moments[:, :3]) * powers[..., :3]).sum(axis=0).T
        b = (((compliance * bend / np.maximum(square, TINY)) @ moments) * powers).sum(axis=0).T
        products = (_product(least, least), _product(least, slope) + _product(slope, least), _product(slope, slope))
        matrices = []
        for k in range(3):
            matrix = b[k] * products[0] + b[k + 1] * products[1] + b[k + 2] * products[2]
            matrix[[0, 2]] += a[k]
            matrices.append(matrix)
        missing = slip - (a[0] * least + a[1] * slope)
        step = times(_inverse(matrices[0]), missing)
        largest = np.sqrt(np.maximum(*(((mean + side * slope) ** 2).sum(axis=0) for side in (-0.5, 0.5))))
        size = np.sqrt((step * step).sum(axis=0)) / np.maximum(largest, TINY)
        size = np.where((largest == 0) & (missing == 0).all(axis=0), 0.0, size)
        step = step * np.minimum(1.0, 1.0 / np.maximum(size, TINY))
        zeroth, first, second = matrices
        return cls(mean, slope, slip, place, a[1] * least + a[2] * slope, zeroth, first, second, missing, step, size)

    def of(self, chosen: Flags) -> _Integrals:
        """Return the chosen nodes."""
        return _Integrals(*(each[..., chosen] for each in self))

    def where(self, kept: Flags, other: _Integrals) -> _Integrals:
        """Return the kept nodes, and the others of ``other``."""
        return _Integrals(*(np.where(kept, mine, its) for mine, its in zip(self, other, strict=True)))

    def ending(self) -> Array:
        """Return the fields of the column after a last step."""
        inverse = _inverse(self.zeroth)
        carried = self.carried + times(self.first, self.step) + self.place * self.slip
        by_slip = np.stack([times(inverse, self.first[[0, 1]]), times(inverse, self.first[[1, 2]])])
        through = np.stack([times(self.first, by_slip[0]), times(self.first, by_slip[1])])
        by_slope = self.second - np.stack([through[0, 0], through[0, 1], through[1, 1]])
        by_slip[0, 0] += self.place
        by_slip[1, 1] += self.place
        return np.concatenate([self.mean + self.step, carried, by_slope, by_slip.reshape(4, -1), inverse])


def _product(first: Array, second: Array) -> Array:
    return np.stack([first[0] * second[0], first[0] * second[1], first[1] * second[1]])


def times(matrix: Array, vector: Array) -> Array:
    """Return the products of symmetric matrices with vectors."""
    return np.stack([matrix[0] * vector[0] + matrix[1] * vector[1], matrix[1] * vector[0] + matrix[2] * vector[1]])


def _inverse(matrix: Array) -> Array:
    xx, xy, yy = matrix
    return np.asarray(np.stack([yy, -xy, xx]) / np.maximum(xx * yy - xy * xy, TINY))
