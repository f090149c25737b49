"""What laws of the shear rate share: moments and rates from a table, and the numbers of most."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev, legendre

from stribeck._types import Array
from stribeck.fluids.laws import RateLaw
from stribeck.numerics.cells import Cells
from stribeck.numerics.dual import with_slope
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.schema import Input

__all__ = ["EXPONENT", "MIN_EXPONENT", "RELAXATION_TIME", "TabulatedLaw", "table_of"]

MIN_EXPONENT = 0.05  # Least exponent of a shear-thinning fluid; below it the stress is nearly that of a plastic solid.

RELAXATION_TIME = Input(
    label="relaxation time",
    symbol="$t$",
    dimension="time",
    typical="1 ms",
    source="one over the rate at which the fluid begins to thin",
)
EXPONENT = Input(
    label="exponent of shear thinning",
    symbol="$n$",
    dimension="number",
    typical="0.5",
    source="polymer solutions, 0.3 to 0.8",
    lowest=MIN_EXPONENT,
    zero=True,
    highest=1.0,
    reason="1 is Newtonian, as the stress grows as the rate to this power; fluids that thicken are not modelled",
)

PANEL_WIDTH = 0.5  # Width of a panel of the table in the logarithm of the rate.

# Chebyshev coefficients of a panel, good to 1e-14 with singularities pi/2 off the real axis (Carreau).
PANEL_COEFFICIENTS = 12

CELLS_PER_PANEL = 8  # Cells of a panel on which the same function is a polynomial that is quicker to evaluate.
CELL_TERMS = 7  # Coefficients of the polynomial on a cell, equal to the panel to rounding.

MAX_LOG_RATE = 30.0  # Natural logarithm of the rate at which the table ends; above it the ratios have their limits.

INVERSION_STEPS = 3  # Newton steps in the logarithms that find a rate from its stress.


class TabulatedLaw(RateLaw):
    """A law whose moments and rate come from a table of its stress; it takes the relaxation time, then its :attr:`shape`."""

    def moments(self, rate: Array, stress: Array) -> tuple[Array, Array]:
        """Return both moments."""
        return table_of(type(self), *self.shape).moments(rate, stress)

    def rate(self, stress: Array) -> Array:
        """Return the rate at a stress."""
        return table_of(type(self), *self.shape).rate(stress)

    @property
    @abstractmethod
    def shape(self) -> tuple[float, ...]:
        """Its numbers but for the relaxation time, in the order of its arguments."""

    @abstractmethod
    def smallest(self) -> float:
        """Return the logarithm of the rate below which the law is Newtonian to rounding."""


@lru_cache(maxsize=64)
def table_of(law: Callable[..., TabulatedLaw], *shape: float) -> Table:
    """Return the table of a law with the relaxation time one; fits and sweeps ask for many."""
    of_law = law(1.0, *shape)
    return Table(of_law.stress, of_law.smallest())


@dataclass(frozen=True, eq=False)
class Table:
    r"""Moments of one flow curve that has no closed ones, over the logarithm of the rate.

    With :math:`x` the rate and :math:`g(x)` the stress, both over those at relaxation time and viscosity one, it holds

    .. math:: \frac{1}{g x} \int_0^x x' \, dg(x'), \qquad \frac{1}{g^2 x} \int_0^x g(x') \, x' \, dg(x'),

    which are 1/2 and 1/3 for a Newtonian fluid and never far from that: relative digits are kept at all rates.
    """

    stress: Callable[[Any], Any]
    smallest: float  # Natural logarithm of the rate below which the curve is that of viscosity one to rounding

    @cached_property
    def count(self) -> int:
        """Number of panels."""
        return int(np.ceil((MAX_LOG_RATE - self.smallest) / PANEL_WIDTH))

    @cached_property
    def coefficients(self) -> Array:
        """Of both ratios, shape (panels, 2, PANEL_COEFFICIENTS)."""
        points = np.cos(np.pi * (np.arange(PANEL_COEFFICIENTS) + 0.5) / PANEL_COEFFICIENTS)[::-1]
        found = np.empty((self.count, 2, PANEL_COEFFICIENTS))
        to_coefficients = np.linalg.inv(chebyshev.chebvander(points, PANEL_COEFFICIENTS - 1))
        nodes, weights = legendre.leggauss(PANEL_COEFFICIENTS)
        start = np.array([self.smallest])
        x = np.exp(start)
        g = self.stress(x)
        first, second = g * x / 2, g * g * x / 3
        for panel in range(self.count):
            left = self.smallest + panel * PANEL_WIDTH
            ends = np.append(left + 0.5 * PANEL_WIDTH * (1 + points), left + PANEL_WIDTH)
            half = 0.5 * (ends - left)
            at = left + half[:, None] * (1 + nodes)
            x = np.exp(at)
            g, slope = with_slope(self.stress, x)
            integrand = x * x * slope * weights * half[:, None]
            one, two = first + integrand.sum(axis=1), second + (g * integrand).sum(axis=1)
            x = np.exp(ends)
            g = self.stress(x)
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
            place = np.clip((log_rate - self.smallest) / PANEL_WIDTH, 0.0, self.count * (1 - 1e-15))
            panel = place.astype(np.intp)
            basis = chebyshev.chebvander(2 * (place - panel) - 1, PANEL_COEFFICIENTS - 1)
            return np.asarray(np.einsum("xfk,xk->fx", self.coefficients[panel], basis))

        return Cells.of(
            by_panels, self.smallest, self.smallest + PANEL_WIDTH * self.count, CELLS_PER_PANEL * self.count, CELL_TERMS
        )

    @cached_property
    def _inverse(self) -> tuple[Array, Array]:
        """Logarithms of stresses and of the rates there, to start from."""
        rate = np.linspace(self.smallest, MAX_LOG_RATE, 4 * self.count)
        return np.log(self.stress(np.exp(rate))), rate

    def rate(self, stress: Array) -> Array:
        """Return the rates at stresses >= 0."""
        wanted = np.log(np.maximum(stress, 1e-300))
        known, rates = self._inverse
        log_rate = np.interp(wanted, known, rates)
        log_rate = np.where(wanted < known[0], wanted, log_rate)
        steepest = (rates[-1] - rates[-2]) / (known[-1] - known[-2])
        log_rate = np.where(wanted > known[-1], rates[-1] + steepest * (wanted - known[-1]), log_rate)
        for _ in range(INVERSION_STEPS):
            x = np.exp(log_rate)
            g, slope = with_slope(self.stress, x)
            log_rate = log_rate - (np.log(np.maximum(g, 1e-300)) - wanted) * g / (x * slope)
        return np.where(stress > 0, np.exp(log_rate), 0.0)
