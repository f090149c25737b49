"""What laws of the shear rate share: a table of moments and rates, and the numbers of most."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.polynomial import legendre

from stribeck._types import Array
from stribeck.numerics.cells import Cells
from stribeck.numerics.dual import with_slope
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.schema import Input

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

# Width of a cell of the table in the logarithm of the rate, and coefficients of the polynomials on it: good to 1e-14 with
# singularities pi/2 off the real axis (Carreau).
CELL_WIDTH, CELL_TERMS = 0.0625, 7

GAUSS_NODES = 4  # Nodes between two places at which a moment is tabulated.

INVERSION_STEPS = 3  # Newton steps in the logarithms that find a rate from its stress.


@lru_cache(maxsize=64)
def table_of(law: Callable[..., Any], *shape: float) -> Table:
    """Return the table of a law with the relaxation time one; fits and sweeps ask for many."""
    of_law = law(1.0, *shape)
    return Table(of_law.stress, of_law.smallest(), of_law.max_log_rate)


@dataclass(frozen=True, eq=False)
class Table:
    r"""Moments of one flow curve that has no closed ones, over the logarithm of the rate.

    With :math:`x` the rate and :math:`g(x)` the stress, both over those at relaxation time and viscosity one, it holds

    .. math:: \frac{1}{g x} \int_0^x x' \, dg(x'), \qquad \frac{1}{g^2 x} \int_0^x g(x') \, x' \, dg(x'),

    which are 1/2 and 1/3 for a Newtonian fluid and never far from that: relative digits are kept at all rates.
    """

    stress: Callable[[Any], Any]
    smallest: float  # Natural logarithm of the rate below which the curve is that of viscosity one to rounding
    largest: float  # That of the rate at which the table ends

    def moments(self, rate: Array, stress: Array) -> tuple[Array, Array]:
        """Return both integrals from zero to rates >= 0, with the stresses there."""
        one, two = self._ratios(np.log(np.fmax(rate, 1e-300)))  # a rate that is nan has a stress that is
        area = stress * rate
        return one * area, two * area * stress

    @property
    def _cells(self) -> int:
        return int(np.ceil((self.largest - self.smallest) / CELL_WIDTH))

    @cached_property
    def _ratios(self) -> Cells:
        """Both ratios, quick to evaluate."""
        nodes, weights = legendre.leggauss(GAUSS_NODES)

        def integrated(log_rate: Array) -> Array:
            """Return the ratios at places, by the integrals between each and the one before."""
            order = np.argsort(log_rate)
            ends = np.append(self.smallest, log_rate[order])
            half = 0.5 * np.diff(ends)[:, None]
            x = np.exp(ends[:-1, None] + half * (1 + nodes))
            g, slope = with_slope(self.stress, x)
            parts = x * x * slope * weights * half
            x = np.exp(ends)
            g_ends = self.stress(x)
            first = g_ends[0] * x[0] / 2 + np.cumsum(parts.sum(axis=1))
            second = g_ends[0] ** 2 * x[0] / 3 + np.cumsum((g * parts).sum(axis=1))
            area = (g_ends * x)[1:]
            found = np.empty((2, len(order)))
            found[:, order] = first / area, second / (g_ends[1:] * area)
            return found

        end = self.smallest + CELL_WIDTH * self._cells
        return Cells.of(integrated, self.smallest, end, self._cells, CELL_TERMS)

    @cached_property
    def _inverse(self) -> tuple[Array, Array]:
        """Logarithms of stresses and of the rates there, to start from."""
        rate = np.linspace(self.smallest, self.largest, self._cells // 2)
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
