r"""The pressure of slow fluid in a rough contact of a ball, to first order in the speed, and integrals over it.

With gaps in :math:`\kappa u_\mathrm{Hz}`, :math:`H_0 = A - \tfrac12 \ln(1 - r^2)`, :math:`A = -\tfrac13 \ln F`, the pressure
:math:`p_f = (\lambda/\kappa^2) P_1(r) \cos\theta` obeys

.. math:: \frac1r (r H_0^3 P_1')' - \frac{H_0^3}{r^2} P_1 = H_0', \qquad P_1(0) = P_1(1) = 0 .

All of it depends on the load alone.  The coordinate is that of the line (:mod:`stribeck.asymptotics.slow_contact`),
:math:`r = \tanh(\delta \sinh v)` with :math:`\cos\delta = e^{-A}`: the zeros of :math:`H_0` then lie at the same place
whatever the load.  Spectral elements in v; beyond, where :math:`1 - r^2 < 10^{-16}`, nothing is left.

Source: ours, as [BP] Appendix D for the line.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.formula import Value
from stribeck.numerics.fourier_panels import lobatto

ELEMENT_DEGREE = 16  # Degree of the elements: the integrals err by 1e-12 for loads up to 1 - 1e-3.
ELEMENTS = 12  # Number of the elements.

DOMAIN_LENGTH = 19.0  # Length of the integrals in artanh(r): 1e-16 of the whole is left out.


MAX_GAP = 1e50  # A up to which powers of the gap stay in double precision; above it the integrals are zero.


@dataclass(frozen=True)
class Slow:
    """The contact from its middle to its edge at the nodes of the elements, shape (elements, nodes).

    ``r``, ``H``, ``p_0``: distance, gap at rest, pressure at rest; ``P``, ``slope``: P_1 and its derivative; ``weights``:
    those of dr.
    """

    r: Array
    H: Array
    p_0: Array
    P: Array
    slope: Array
    weights: Array

    def integral(self, integrand: Array) -> float:
        """Return the integral over r from the middle to the edge."""
        return float((self.weights * integrand).sum())

    @property
    def share(self) -> float:
        r"""The fluid's share of the load over lambda**2/kappa**4, phi of :mod:`stribeck.asymptotics.point.boundary`."""
        return -0.75 * self.integral(self.r**2 * self.P / self.p_0 * (1 - 3 * self.H**2 * self.slope) / self.H**3)

    @property
    def shear(self) -> float:
        r"""Balanced friction integral over lambda/kappa, :math:`\pi \int [r/(3 H_0) + \tfrac12 H_0 (r P_1)'] dr`."""
        return np.pi * self.integral(self.r / (3 * self.H) + 0.5 * self.H * (self.r * self.slope + self.P))

    @property
    def moment(self) -> float:
        r"""Moment of the fluid's pressure over lambda/kappa**2, :math:`\pi \int r^2 P_1 dr`."""
        return np.pi * self.integral(self.r**2 * self.P)


@lru_cache(maxsize=512)
def slow_contact(A: float) -> Slow:
    """Return the contact at -1/3 ln F = A > 0."""
    rule = lobatto(ELEMENT_DEGREE)
    delta = np.arcsin(np.sqrt(-np.expm1(-2 * A)))
    edges = np.linspace(0.0, np.arcsinh(DOMAIN_LENGTH / delta), ELEMENTS + 1)
    half = 0.5 * (edges[1] - edges[0])
    v = edges[:-1, None] + half * (rule.nodes + 1)
    u = delta * np.sinh(v)
    r, p_0 = np.tanh(u), 1 / np.cosh(u)
    H = A + np.log1p(2 * np.sinh(u / 2) ** 2)
    stretch = half * delta * np.cosh(v) * p_0**2
    weights = rule.weights * stretch
    d_dr = rule.derivative / stretch[..., None]
    n = ELEMENTS * ELEMENT_DEGREE + 1
    matrix, right = np.zeros((n, n)), np.zeros(n)
    for k in range(ELEMENTS):
        place = slice(k * ELEMENT_DEGREE, (k + 1) * ELEMENT_DEGREE + 1)
        matrix[place, place] -= d_dr[k].T @ ((weights[k] * r[k] * H[k] ** 3)[:, None] * d_dr[k])
        # The node in the middle has P = 0.
        matrix[place, place] -= np.diag(weights[k] * H[k] ** 3 / np.where(r[k] > 0, r[k], 1.0))
        right[place] += weights[k] * r[k] ** 2 / p_0[k] ** 2
    P = np.zeros(n)
    P[1:-1] = np.linalg.solve(matrix[1:-1, 1:-1], right[1:-1])
    local = np.stack([P[k * ELEMENT_DEGREE : (k + 1) * ELEMENT_DEGREE + 1] for k in range(ELEMENTS)])
    slope = np.einsum("kij,kj->ki", d_dr, local)
    return Slow(r, H, p_0, local, slope, weights)


def of_gap(A: Value, number: Callable[[Slow], float]) -> Array:
    """Return a number for each A from its contact, equal ones once; nan where A is no finite positive number."""
    gaps = np.asarray(A, dtype=float)
    different, where = np.unique(gaps, return_inverse=True)
    found = [number(slow_contact(each)) if 0 < each < MAX_GAP else np.nan for each in different.tolist()]
    return np.asarray(np.array(found)[where.reshape(gaps.shape)])
