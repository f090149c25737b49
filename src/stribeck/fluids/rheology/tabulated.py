"""What laws of the shear rate share: moments and rates from a table, and the numbers of most."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from functools import lru_cache

from stribeck._types import Array
from stribeck.fluids.laws import RateLaw
from stribeck.fluids.rheology.rate_moments import Table
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
