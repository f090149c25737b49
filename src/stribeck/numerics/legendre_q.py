r"""Legendre functions of the second kind of half-integer degree, :math:`Q_{m-1/2}(\chi)`: the rings of a potential.

.. math:: \int_0^{2\pi} \frac{\cos m\varphi \, d\varphi}{\sqrt{r^2 + s^2 - 2 r s \cos\varphi}}
          = \frac{2}{\sqrt{r s}} \, Q_{m-1/2}(\chi), \qquad \chi = \frac{r^2 + s^2}{2 r s} = \cosh\ln\frac rs

They hold a logarithm where r = s, so that the difference of the radii is an argument of its own, to be given exactly.

Source: [DLMF] 14.5, 14.10 (recurrence in the degree), 19.5; Miller's algorithm: [DLMF] 3.6.
"""

from __future__ import annotations

import numpy as np
import scipy

from stribeck._types import Array
from stribeck.numerics.settings import HALF_DIGITS

# Decay of the functions over which the recurrence upward in the degree loses a quarter of the digits.
UPWARD_LOG = -0.25 * np.log(HALF_DIGITS)
# Decay from the highest degree wanted to Miller's start: with the error of the start, of second order in 1/degree, the error
# left is below rounding.
START_LOG = 3.0 * UPWARD_LOG


def ring_functions(radius: Array, source: Array, difference: Array, count: int) -> Array:
    r"""Return :math:`Q_{m-1/2}(\chi)` for ``m < count``."""
    ratio = np.abs(difference) / np.sqrt(radius * source)  # 2 sinh(xi/2)
    excess = 0.5 * ratio * ratio  # chi - 1
    complement = (difference / (radius + source)) ** 2
    k = np.sqrt(1.0 - complement)
    first = k * scipy.special.ellipkm1(complement)
    second = (1.0 + excess) * first - (2.0 + excess) * k * scipy.special.ellipe(1.0 - complement)
    chi = 1.0 + excess
    xi = 2.0 * np.arcsinh(0.5 * ratio)
    found = np.empty((count, radius.size))
    found[0] = first
    if count == 1:
        return found
    by_distance = np.argsort(xi)
    upward = int(np.searchsorted(xi[by_distance], UPWARD_LOG / count))
    near = by_distance[:upward]
    found[:, near] = _upward(chi[near], first[near], second[near], count)
    start = upward
    while start < xi.size:  # groups in which the start of the downward recurrence differs by a factor of two at most
        stop = int(np.searchsorted(xi[by_distance], 2.0 * xi[by_distance[start]], side="right"))
        group = by_distance[start:stop]
        found[:, group] = _downward(chi[group], first[group], count, int(START_LOG / xi[group[0]]) + 2)
        start = stop
    return found


def _upward(chi: Array, first: Array, second: Array, count: int) -> Array:
    q = np.empty((count, chi.size))
    q[0], q[1] = first, second
    for m in range(1, count - 1):
        q[m + 1] = (2 * m * chi * q[m] - (m - 0.5) * q[m - 1]) / (m + 0.5)
    return q


def _downward(chi: Array, first: Array, count: int, beyond: int) -> Array:
    """Return the functions by the recurrence from ``beyond`` the last, as ratios, so that nothing overflows."""
    q = np.empty((count, chi.size))
    m = count + beyond + 1
    # Where the ratio of two neighbours does not change with the degree.
    ratio = (m - 0.5) / (m * chi + np.sqrt((m * chi) ** 2 - (m - 0.5) * (m + 0.5)))
    twice, below = 2.0 * chi, np.empty_like(chi)
    for m in range(count + beyond, 0, -1):  # ratio: Q of degree m + 1/2 over that of m - 1/2
        np.multiply(twice, m, out=below)
        ratio *= m + 0.5
        below -= ratio
        np.divide(m - 0.5, below, out=ratio)
        if m < count:
            q[m] = ratio
    q[0] = first
    return np.asarray(np.cumprod(q, axis=0, out=q))
