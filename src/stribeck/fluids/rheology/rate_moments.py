r"""Integrals of a flow curve that has no closed ones: tables over the logarithm of the rate.

With :math:`x` the rate and :math:`g(x)` the stress, both over those at relaxation time and viscosity one, the tables hold

.. math:: \frac{1}{g x} \int_0^x x' \, dg(x'), \qquad \frac{1}{g^2 x} \int_0^x g(x') \, x' \, dg(x'),

which are 1/2 and 1/3 for a Newtonian fluid and never far from that: relative digits are kept at all rates.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev, legendre

from stribeck._types import Array
from stribeck.numerics.cells import Cells
from stribeck.quantities.lazy import cached_property

WIDTH = 0.5
"""Of the panels, in ln(rate)."""

ORDER = 12
"""Chebyshev coefficients of each panel: exact to 1e-14 with singularities pi/2 from the real axis, as of Carreau."""

CELLS, TERMS = 8, 7
"""Cells of a panel, and terms of the polynomial on each: the same to rounding, and quicker to evaluate."""

LARGEST = 30.0
"""Natural logarithm of the rate at which tables end; beyond, the ratios have their limits."""

POLISH = 3
"""Newton steps in the logarithms with which a rate is found from its stress."""


@dataclass(frozen=True, eq=False)
class Table:
    """Moments of one flow curve."""

    stress: Callable[[Array], tuple[Array, Array]]
    smallest: float  # Natural logarithm of the rate below which the curve is that of viscosity one to rounding

    @cached_property
    def count(self) -> int:
        """Number of panels."""
        return int(np.ceil((LARGEST - self.smallest) / WIDTH))

    @cached_property
    def coefficients(self) -> Array:
        """Of both ratios, shape (panels, 2, ORDER)."""
        points = np.cos(np.pi * (np.arange(ORDER) + 0.5) / ORDER)[::-1]
        found = np.empty((self.count, 2, ORDER))
        to_coefficients = np.linalg.inv(chebyshev.chebvander(points, ORDER - 1))
        nodes, weights = legendre.leggauss(ORDER)
        start = np.array([self.smallest])
        x = np.exp(start)
        g = self.stress(x)[0]
        first, second = g * x / 2, g * g * x / 3
        for panel in range(self.count):
            left = self.smallest + panel * WIDTH
            ends = np.append(left + 0.5 * WIDTH * (1 + points), left + WIDTH)
            half = 0.5 * (ends - left)
            at = left + half[:, None] * (1 + nodes)
            x = np.exp(at)
            g, slope = self.stress(x)
            integrand = x * x * slope * weights * half[:, None]
            one, two = first + integrand.sum(axis=1), second + (g * integrand).sum(axis=1)
            x = np.exp(ends)
            g = self.stress(x)[0]
            ratios = np.stack([one / (g * x), two / (g * g * x)])
            found[panel] = ratios[:, :-1] @ to_coefficients.T
            first, second = one[-1], two[-1]
        return found

    def moments(self, rate: Array, stress: Array) -> tuple[Array, Array]:
        """Return both integrals from zero to rates >= 0, with the stresses there."""
        one, two = self._ratios(np.log(np.fmax(rate, 1e-300)))  # a rate that is nan has a stress that is
        area = stress * rate
        return one * area, two * area * stress

    @cached_property
    def _ratios(self) -> Cells:
        """Both ratios, quick to evaluate."""

        def by_panels(log_rate: Array) -> Array:
            place = np.clip((log_rate - self.smallest) / WIDTH, 0.0, self.count * (1 - 1e-15))
            panel = place.astype(np.intp)
            basis = chebyshev.chebvander(2 * (place - panel) - 1, ORDER - 1)
            return np.asarray(np.einsum("xfk,xk->fx", self.coefficients[panel], basis))

        return Cells.of(by_panels, self.smallest, self.smallest + WIDTH * self.count, CELLS * self.count, TERMS)

    @cached_property
    def _inverse(self) -> tuple[Array, Array]:
        """Logarithms of stresses and of the rates there, to start from."""
        rate = np.linspace(self.smallest, LARGEST, 4 * self.count)
        return np.log(self.stress(np.exp(rate))[0]), rate

    def rate(self, stress: Array) -> Array:
        """Return the rates at stresses >= 0."""
        wanted = np.log(np.maximum(stress, 1e-300))
        known, rates = self._inverse
        log_rate = np.interp(wanted, known, rates)
        log_rate = np.where(wanted < known[0], wanted, log_rate)
        steepest = (rates[-1] - rates[-2]) / (known[-1] - known[-2])
        log_rate = np.where(wanted > known[-1], rates[-1] + steepest * (wanted - known[-1]), log_rate)
        for _ in range(POLISH):
            x = np.exp(log_rate)
            g, slope = self.stress(x)
            log_rate = log_rate - (np.log(np.maximum(g, 1e-300)) - wanted) * g / (x * slope)
        return np.where(stress > 0, np.exp(log_rate), 0.0)
