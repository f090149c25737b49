r"""Taylor series: arithmetic, and solutions of equations order by order.

A solution of :math:`R(w(t), t) = 0` is expanded about t = 0.  The coefficient of order k of the residual is linear in that of
the solution,

.. math:: J w_k = -R_k|_{w_k = 0},

with the Jacobian at the solution: one factorisation serves all orders.  What is nonlinear is either composed of products,
quotients and exponentials, whose coefficients follow from those of lower order, or known by its values alone: then the
coefficients are those of a polynomial near its values on [-r, r], which has them also where the function is not quite smooth,
with fewer digits.

Coefficients are in the first axis, order by order.  The module knows no physics.
Source: [Griewank & Walther 2008] Evaluating Derivatives, chapter 13.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from operator import mul

import numpy as np
from numpy.polynomial import chebyshev

from stribeck._types import Array

__all__ = [
    "Samples",
    "along",
    "beyond",
    "exponential",
    "implicit_series",
    "integral_of_product",
    "interval",
    "logarithm",
    "product",
    "radius",
    "reciprocal",
]

MAX_RADIUS = 6.0  # Radius of series whose higher coefficients vanish

COEFFICIENT_NOISE = 1e-12  # Rounding of sampled values relative to the unknowns, magnified by solving for the coefficients

INTERVAL_ORDER = 12  # Values on an interval, unless more are asked for

PADE_DENOMINATOR_DEGREE = 6  # Highest degree of the denominator of an extrapolation


def product_term(a: Array, b: Array, k: int) -> Array:
    """Return the coefficient of order k of a product."""
    if a.ndim == 1:
        return np.asarray(a[: k + 1] @ b[k::-1])
    return np.asarray(np.einsum("j...,j...->...", a[: k + 1], b[k::-1]))


def exponential_term(slopes: Array, values: Array, k: int) -> Array:
    """Return the coefficient of order k >= 1 of an exponential from its own lower ones and those of its argument, times k."""
    return product_term(slopes[1:], values, k - 1) / k


def exponential(logs: Array) -> Array:
    """Return the series of the exponential of a series of numbers."""
    slopes, found = (logs * np.arange(len(logs))).tolist(), [math.exp(logs[0])]
    for k in range(1, len(logs)):
        found.append(sum(map(mul, slopes[1:], reversed(found))) / k)
    return np.array(found)


def along(rate: float, order: int) -> Array:
    """Return the series of ``exp(rate t)``."""
    found = np.ones(order + 1)
    np.cumprod(rate / np.arange(1.0, order + 1), out=found[1:])
    return found


def logarithm(values: Array) -> Array:
    """Return the series of the logarithm of a series of numbers."""
    first, *others = values.tolist()
    found, slopes = [math.log(first)], [0.0]
    for k, value in enumerate(others, 1):
        found.append((value - sum(map(mul, slopes[1:], reversed(others[: k - 1]))) / k) / first)
        slopes.append(k * found[k])
    return np.array(found)


def product(a: Array, b: Array) -> Array:
    """Return the series of a product of two, of numbers or of rows."""
    if a.ndim == 1:
        return np.convolve(a, b)[: len(a)]
    padded = np.concatenate([np.zeros_like(b[1:]), b])
    row, column = padded.strides
    # Row j of window k is that of order j - (len(a) - 1 - k), zero below order zero.
    windows = np.ndarray((len(a), *a.shape), buffer=padded, strides=(row, row, column))
    return np.asarray(np.einsum("kjn,jn->kn", windows, a[::-1]))


def integral_of_product(a: Array, b: Array, weights: Array) -> Array:
    """Return the series of the sum over the last axis of a product of two, times weights."""
    orders = np.arange(len(a))
    products: Array = (a * weights) @ b.T
    found = np.bincount(np.add.outer(orders, orders).ravel(), products.ravel())
    return np.asarray(found[: len(a)], dtype=float)


def reciprocal(values: Array) -> Array:
    """Return the series of one over a series."""
    found = np.zeros_like(values)
    found[0] = 1.0 / values[0]
    for k in range(1, len(values)):
        found[k] = -found[0] * product_term(values[1:], found, k - 1)
    return found


@dataclass(frozen=True, eq=False)
class Samples:
    """Where a function is evaluated for its Taylor coefficients about zero."""

    places: Array  # The places
    weights: Array  # What the values are multiplied by; the sum is the coefficient

    def taylor(self, values: Array, order: int) -> Array:
        """Return the Taylor coefficients up to ``order``, shape (order + 1, ...), of values, shape (n, ...)."""
        return np.asarray(np.tensordot(self.weights[: order + 1], values, 1))

    def powers(self, order: int) -> Array:
        """Return the powers of the places up to ``order``, shape (n, order + 1)."""
        return np.asarray(self.places[:, None] ** np.arange(order + 1))


def interval(reach: float, count: int = INTERVAL_ORDER, degree: int | None = None) -> Samples:
    """Return samples of a real function up to a distance ``reach``, for the polynomial of a degree nearest to its values."""
    # A degree hardly above the orders asked for leaves out more of what is not smooth; by default the polynomial interpolates.
    matrix = _to_taylor(count)[-1 if degree is None else degree]
    orders = np.arange(len(matrix))
    return Samples(reach * chebyshev.chebpts1(count), matrix * reach ** -orders[:, None].astype(float))


@lru_cache(maxsize=4)
def _to_taylor(count: int) -> list[Array]:
    """Matrices from values at Chebyshev points to the Taylor coefficients about zero of polynomials, by their degrees."""
    degrees = np.arange(count)
    values = chebyshev.chebvander(chebyshev.chebpts1(count), count - 1).T
    to_chebyshev = values * np.where(degrees == 0, 1, 2)[:, None] / count
    to_powers = np.zeros((count, count))
    for n in degrees:
        to_powers[: n + 1, n] = chebyshev.cheb2poly(np.eye(count)[n, : n + 1])
    return [to_powers[: n + 1, : n + 1] @ to_chebyshev[: n + 1] for n in degrees]


def implicit_series(
    start: Array,
    samples: Samples,
    local: Callable[[int, Array], Array],
    residual: Callable[[int, Array, Array], Array],
    inverse: Callable[[Array], Array],
    order: int,
) -> Array:
    """Return the Taylor coefficients of the solution of an equation."""
    found = np.zeros((order + 1, *start.shape))
    found[0] = start
    for k in range(1, order + 1):
        found[k] = inverse(residual(k, found, samples.weights[k] @ local(k, found)))
    return found


def radius(coefficients: Array, reach: float = 1.0, rounding: float = COEFFICIENT_NOISE) -> float:
    """Return about the radius of convergence of series: that by which their coefficients fall."""
    order = len(coefficients) - 1
    size = np.abs(coefficients[1:]).reshape(order, -1).max(axis=1)
    k = np.arange(order // 2 + 1, order + 1)
    told = k[size[k - 1] > rounding * reach ** -k.astype(float)]
    return float(
        np.min((max(size[0], rounding / reach) / size[told - 1]) ** (1.0 / np.maximum(told - 1, 1)), initial=MAX_RADIUS)
    )


def beyond(series: Array, t: float) -> tuple[Array, float]:
    """Return series at a place outside, and the largest difference between two of their rational forms."""
    # The denominators, of two degrees, make the highest coefficients vanish.
    order = len(series) - 1
    scaled = series * (t ** np.arange(order + 1.0))[:, None]
    degree = min(PADE_DENOMINATOR_DEGREE, (order - 1) // 2)
    if degree < 2:
        return np.asarray(scaled.sum(axis=0)), 0.0
    best, other = _rational(scaled, degree, products := scaled @ scaled.T), _rational(scaled, degree - 1, products)
    return best, float(np.abs(best - other).max())


def _rational(scaled: Array, degree: int, products: Array) -> Array:
    """Return the sum of a series as a rational function whose denominator has a degree, from the products of its orders."""
    order = len(scaled) - 1
    high = order - degree + 1 + np.arange(degree) - np.arange(degree + 1)[:, None]
    gram = products[high[:, None], high].sum(axis=2)
    rest = gram[1:, 1:] + (1e-14 * np.trace(gram) + 1e-200) * np.eye(degree)
    q = np.append(1.0, np.linalg.solve(rest, -gram[1:, 0]))
    parts = np.append(np.ones(order - 2 * degree), np.cumsum(q)[::-1] / q.sum())
    return np.asarray(parts @ scaled[: len(parts)])
