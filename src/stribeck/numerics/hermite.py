r"""Two-point Hermite interpolation: the polynomial that has the Taylor coefficients of both ends of an interval.

.. math::

    H(t) = \sum_{j=0}^{K} \left[ a_j \, d^j \, B_j(\tau) + (-1)^j b_j \, d^j \, B_j(1 - \tau) \right],
    \qquad B_j(\tau) = \tau^j (1 - \tau)^{K+1} \sum_{i=0}^{K-j} \binom{K+i}{i} \tau^i

for an interval of length d, :math:`\tau` running from 0 to 1 on it.  No linear system is solved: that of the monomials loses
all digits from K = 10 on.  That of Chebyshev polynomials loses none: where a polynomial is evaluated often it is kept by them.
Source: [Davis 1975] Interpolation and Approximation, section 2.5.
"""

import math
from functools import lru_cache
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.numerics.dual import Dual
from stribeck.numerics.settings import EPSILON, INNER_PLACES


def inner_places() -> Array:
    """Return the parts of an interval at which it is checked."""
    return np.arange(1, INNER_PLACES + 1) / (INNER_PLACES + 1)


@lru_cache(maxsize=64)
def _sums(order: int) -> Array:
    """Coefficients of the sums in B_j, row j: those of ``tau**j`` times the sum, in ascending powers of tau."""
    found = np.zeros((order + 1, order + 1))
    for j in range(order + 1):
        found[j, j:] = [math.comb(order + i, i) for i in range(order + 1 - j)]
    return found


def hermite_weights(order: int, tau: Array) -> tuple[Array, Array]:
    """Return the weights of the coefficients of both ends, on an interval of length one."""
    powers = np.arange(order + 1)
    sums = _sums(order).T
    left = (tau[:, None] ** powers @ sums) * (1 - tau[:, None]) ** (order + 1)
    right = ((1 - tau[:, None]) ** powers @ sums) * tau[:, None] ** (order + 1)
    return left, right * (-1.0) ** powers


@lru_cache(maxsize=64)
def hermite_form(order: int) -> Array:
    """Return the matrix from the coefficients of both ends, one under the other, to those of Chebyshev polynomials."""
    return chebyshev_form(np.hstack(hermite_weights(order, chebyshev_nodes(2 * order + 2))))


@lru_cache(maxsize=64)
def _highest_order(order: int) -> Array:
    r"""Return the rows that give the change by the highest order at both ends over :math:`(\tau (1 - \tau))^K`."""
    # That change is linear in tau: it is evaluated inside and extrapolated to the ends, where the quotient is 0/0.
    at = np.array([0.25, 0.75])
    left, right = hermite_weights(order, at)
    without = [np.pad(part, ((0, 0), (0, 1))) for part in hermite_weights(order - 1, at)]
    inside = np.hstack([left - without[0], right - without[1]]) / (3 / 16) ** order
    return np.asarray(np.array([[1.5, -0.5], [-0.5, 1.5]]) @ inside)


@lru_cache(maxsize=64)
def _highest_orders(order: int) -> Array:
    """Return the rows of the change by the highest order and, below, by the order before: one alone may vanish by accident."""
    left, right = np.hsplit(_highest_order(order - 1), 2)
    return np.vstack([_highest_order(order), np.hstack([np.pad(part, ((0, 0), (0, 1))) for part in (left, right)])])


def missed_by(order: int, ends: Array, rate: float) -> Array:
    r"""Return by how much a polynomial is wrong, over :math:`(\tau (1 - \tau))^K`: its change by the highest order."""
    if order < 2:
        return np.abs(_highest_order(order) @ ends).max(axis=0) if order else np.zeros(ends.shape[1])
    found = np.abs(_highest_orders(order) @ ends)
    return np.asarray(np.maximum(found[:2].max(axis=0), rate * found[2:].max(axis=0)))


@lru_cache(maxsize=64)
def _from_nodes(count: int) -> Array:
    """Return the matrix from values at the nodes to coefficients of Chebyshev polynomials."""
    angles = np.pi * (np.arange(count) + 0.5) / count
    matrix: Array = 2.0 / count * np.cos(np.outer(np.arange(count), angles))
    matrix[0] *= 0.5
    return matrix


def chebyshev_nodes(count: int) -> Array:
    """Return the places between 0 and 1, shape (count,), whose values :func:`chebyshev_form` takes."""
    return np.asarray(0.5 + 0.5 * np.cos(np.pi * (np.arange(count) + 0.5) / count))


def chebyshev_form(values: Array) -> Array:
    """Return the coefficients of the polynomials through values at these nodes, both of shape (count, ...)."""
    return np.asarray(_from_nodes(len(values)) @ values)


@lru_cache(maxsize=64)
def _chebyshev_slopes(count: int) -> Array:
    """Return the matrix from the first Chebyshev polynomials to their derivatives by the place from 0 to 1."""
    slopes = np.zeros((count, count))
    slopes[: count - 1] = 2.0 * np.polynomial.chebyshev.chebder(np.eye(count))
    return slopes


def chebyshev_basis(tau: Any, count: int) -> Any:
    """Return the first ``count`` Chebyshev polynomials at places from 0 to 1, shape (len(tau), count)."""
    if isinstance(tau, Dual):
        basis = chebyshev_basis(tau.value, count)
        return Dual(basis, np.reshape(tau.slope, (-1, 1)) * (basis @ _chebyshev_slopes(count)))
    return np.cos(np.arccos(np.clip(2.0 * tau - 1.0, -1.0, 1.0))[:, None] * np.arange(count))


def weights_through(nodes: Array, x: Any) -> tuple[Any, Any]:
    """Return the weights of values and slopes at several nodes in the polynomial through them, shape (len(x), len(nodes))."""
    if isinstance(x, Dual):
        step = EPSILON**2  # of complex polynomials, whose imaginary part is their slope times that: nothing cancels
        moved = weights_through(nodes, x.value + 1j * step)
        along = np.reshape(x.slope, (-1, 1)) / step
        values, slopes = (Dual(each.real, along * each.imag) for each in moved)
        return values, slopes
    apart = nodes[:, None] - nodes
    np.fill_diagonal(apart, 1.0)
    steps = x[:, None] - nodes
    others = [np.delete(np.arange(len(nodes)), j) for j in range(len(nodes))]
    basis = np.stack([np.prod(steps[:, k] / apart[j, k], axis=1) for j, k in enumerate(others)], axis=1)
    bend = np.array([np.sum(1.0 / apart[j, k]) for j, k in enumerate(others)])  # slope of each basis at its own node
    return (1.0 - 2.0 * bend * steps) * basis**2, steps * basis**2


def slope_noise(nodes: Array, values: Array, slopes: Array, errors: Array, x: Array) -> Array:
    r"""Return how far errors of slopes set the polynomial through values and slopes off at x, shape (len(x), ...).

    .. math:: |a| \, \frac{\prod_j (x - x_j)^2}{\min_j |x - x_j|}

    with what the ``errors`` of the values leave of the coefficient a of the highest order.  That vanishes if any one of the
    slopes is changed by :math:`a \prod_{j \ne k} (x_k - x_j)^2`; of exact slopes it is far less than the polynomial misses.
    """
    apart = nodes[:, None] - nodes
    np.fill_diagonal(apart, 1.0)
    of_slopes = np.prod(apart, axis=1) ** -2.0
    of_values = -2.0 * ((1.0 / apart).sum(axis=1) - 1.0) * of_slopes
    highest = np.abs(of_slopes @ slopes + of_values @ values) - np.abs(of_values) @ errors
    away = np.abs(x[:, None] - nodes)
    shape = np.prod(away, axis=1) * np.prod(np.sort(away, axis=1)[:, 1:], axis=1)
    return np.asarray(np.maximum(highest, 0.0) * shape[:, None])
