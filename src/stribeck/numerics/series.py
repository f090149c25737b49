r"""Taylor series of solutions of equations, order by order.

A solution of :math:`R(w(t), t) = 0` is expanded about t = 0.  The coefficient of order k of the residual is linear in that of
the solution,

.. math:: J w_k = -R_k|_{w_k = 0},

with the Jacobian at the solution: one factorisation serves all orders.  The residual is made of jets,
:mod:`stribeck.numerics.jets`.

Coefficients are in the first axis, order by order.  The module knows no physics.
Source: [Griewank & Walther 2008] Evaluating Derivatives, chapter 13.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stribeck._types import Array
from stribeck.numerics.settings import COEFFICIENT_NOISE, HALF_DIGITS, MAX_LOG_STEP

__all__ = [
    "along",
    "beyond",
    "implicit_series",
    "radius",
]


def along(rate: float, order: int) -> Array:
    """Return the series of ``exp(rate t)``."""
    found = np.ones(order + 1)
    np.cumprod(rate / np.arange(1.0, order + 1), out=found[1:])
    return found


def implicit_series(
    found: Array, coefficient: Callable[[int], Array], inverse: Callable[[Array], Array], refines: bool = False
) -> None:
    """Write the Taylor coefficients of the solution of an equation below the first one.

    ``coefficient(k)`` is that of the residual with the coefficients that are written so far.
    """
    is_old = False
    for k in range(1, len(found)):
        found[k] = inverse(coefficient(k))
        if refines and (k == 1 or is_old):
            change = inverse(coefficient(k))
            # Factors that change the first order too much are too old: every order is refined.
            is_old = is_old or bool(np.abs(change).max() > HALF_DIGITS * np.abs(found[1]).max())
            found[k] += change
        if not np.isfinite(found[k]).all():  # every later order is made of this one
            found[k:] = np.nan
            return


def radius(coefficients: Array, reach: float = 1.0, rounding: float = COEFFICIENT_NOISE) -> float:
    """Return about the radius of convergence of series: that by which their coefficients fall."""
    order = len(coefficients) - 1
    size = np.abs(coefficients[1:]).reshape(order, -1).max(axis=1)
    k = np.arange(order // 2 + 1, order + 1)
    told = k[size[k - 1] > rounding * reach ** -k.astype(float)]
    return float(
        np.min((max(size[0], rounding / reach) / size[told - 1]) ** (1.0 / np.maximum(told - 1, 1)), initial=MAX_LOG_STEP)
    )


def beyond(series: Array, t: float) -> tuple[Array, float]:
    """Return series at a place outside, and the largest difference between two of their rational forms."""
    # The denominators, of two degrees, make the highest coefficients vanish.
    order = len(series) - 1
    scaled = series * (t ** np.arange(order + 1.0))[:, None]
    degree = order // 3
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
