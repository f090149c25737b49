r"""Taylor series of solutions, order by order, of equations that are known by their values alone.

A solution of :math:`R(w(t), t) = 0` is expanded about t = 0.  The coefficient of order k of the residual is linear in that of
the solution,

.. math:: J w_k = -R_k|_{w_k = 0},

with the Jacobian at the solution: one factorisation serves all orders.  The coefficients of what is nonlinear come from its
values around zero: on a circle of radius r in the complex plane, by Cauchy's integral, where it is analytic,

.. math:: f_k = \frac{1}{2\pi} \int_0^{2\pi} f(r e^{i\theta}) \, (r e^{i\theta})^{-k} d\theta,

else those of the polynomial through its values on [-r, r], which has them also where the function is not quite smooth, with
fewer digits.  Nothing is asked of a function but that it takes arrays.

The module knows no physics.  Source: [Trefethen & Weideman 2014] SIAM Review 56, 385, for the trapezoidal rule on a circle.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from stribeck._types import Array

__all__ = ["Samples", "circle", "implicit_series", "interval", "radius"]

LARGEST_RADIUS = 6.0
"""Radius of series whose higher coefficients vanish."""

ROUNDING = 1e-12
"""Rounding of values at samples, relative to the unknowns, as solving for the coefficients magnifies it."""

ON_INTERVAL = 20
"""Values on an interval."""


@dataclass(frozen=True, eq=False)
class Samples:
    """Where a function is evaluated for its Taylor coefficients about zero.

    Attributes
    ----------
    places : ndarray, shape (n,)
        The places, complex on a circle.
    weights : ndarray, shape (orders, n)
        What the values are multiplied by; the real part of the sum is the coefficient.
    """

    places: Array
    weights: Array

    def taylor(self, values: Array, order: int) -> Array:
        """Return the Taylor coefficients up to ``order``, shape (order + 1, ...), of values, shape (n, ...)."""
        return np.tensordot(self.weights[: order + 1], values, 1).real

    def aliased(self, values: Array) -> float:
        """Return how large the highest of the coefficients are that the samples on a circle tell, on the circle.

        What lies beyond adds itself to the lower ones; zero for an interval.
        """
        if not np.iscomplexobj(self.places):
            return 0.0
        last = len(self.weights) - 1
        return float(np.abs((self.weights[last - 1 :] @ values).real).max() * abs(self.places[0]) ** (last - 1))

    def powers(self, order: int) -> Array:
        """Return the powers of the places up to ``order``, shape (n, order + 1)."""
        return np.asarray(self.places[:, None] ** np.arange(order + 1))


def circle(reach: float, count: int) -> Samples:
    """Return ``count`` samples of an analytic function on the upper half of a circle; the lower half mirrors them.

    With the radius of convergence R they leave a relative error of ``(reach/R)**(2 count)``.
    """
    places = reach * np.exp(1j * np.pi * (np.arange(count) + 0.5) / count)
    return Samples(places, places ** -np.arange(2 * count)[:, None] / count)


def interval(reach: float) -> Samples:
    """Return the samples of a real function up to a distance ``reach``."""
    orders = np.arange(ON_INTERVAL)
    return Samples(reach * chebyshev.chebpts1(ON_INTERVAL), _to_taylor() * reach ** -orders[:, None].astype(float))


@lru_cache(maxsize=1)
def _to_taylor() -> Array:
    """Matrix from values at Chebyshev points to the Taylor coefficients about zero of the polynomial through them."""
    degrees = np.arange(ON_INTERVAL)
    values = chebyshev.chebvander(chebyshev.chebpts1(ON_INTERVAL), ON_INTERVAL - 1).T
    to_chebyshev = values * np.where(degrees == 0, 1, 2)[:, None] / ON_INTERVAL
    to_powers = np.zeros((ON_INTERVAL, ON_INTERVAL))
    for n in degrees:
        to_powers[: n + 1, n] = chebyshev.cheb2poly(np.eye(ON_INTERVAL)[n, : n + 1])
    return np.asarray(to_powers @ to_chebyshev)


def implicit_series(
    start: Array,
    samples: Samples,
    local: Callable[[int, Array], Array],
    residual: Callable[[int, Array, Array], Array],
    inverse: Callable[[Array], Array],
    order: int,
) -> Array:
    """Return the Taylor coefficients of the solution of an equation.

    Parameters
    ----------
    start : ndarray, shape (n,)
        The solution at zero.
    samples : Samples
        Where the equation is evaluated.
    local : callable
        ``local(k, w)`` returns what is nonlinear, at the samples in rows, from the coefficients w of the solution, shape
        (order + 1, n), of which those from k on are zero.
    residual : callable
        ``residual(k, w, v)`` returns the coefficient of order k of the residual, v being that of what ``local`` returns.
    inverse : callable
        ``inverse(r)`` returns ``-J**-1 r`` with the Jacobian at the start.
    order : int
        The highest order.

    Returns
    -------
    ndarray, shape (order + 1, n)
        The coefficients.
    """
    found = np.zeros((order + 1, *start.shape))
    found[0] = start
    for k in range(1, order + 1):
        found[k] = inverse(residual(k, found, (samples.weights[k] @ local(k, found)).real))
    return found


def radius(coefficients: Array, reach: float) -> float:
    """Return about the radius of convergence of series: that by which their coefficients fall.

    Parameters
    ----------
    coefficients : ndarray, shape (K + 1, ...)
        The coefficients.
    reach : float
        Distance of the samples that they come from: what does not exceed their rounding tells nothing.

    Returns
    -------
    float
        The radius, from the upper half of the orders; at most :data:`LARGEST_RADIUS`.
    """
    order = len(coefficients) - 1
    size = np.abs(coefficients[1:]).reshape(order, -1).max(axis=1)
    k = np.arange(order // 2 + 1, order + 1)
    told = k[size[k - 1] > ROUNDING * reach ** -k.astype(float)]
    return float(
        np.min((max(size[0], ROUNDING / reach) / size[told - 1]) ** (1.0 / np.maximum(told - 1, 1)), initial=LARGEST_RADIUS)
    )
