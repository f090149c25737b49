"""What laws of the shear rate share: moments and rates from a table, and checks of their numbers."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from functools import lru_cache

from stribeck._types import Array
from stribeck.fluids.laws import RateLaw
from stribeck.fluids.rheology.rate_moments import Table
from stribeck.quantities.units import InputError, show, to_si

__all__ = ["MIN_EXPONENT", "TabulatedLaw", "checked_exponent", "checked_time", "parameters_of", "set_numbers", "table_of"]

MIN_EXPONENT = 0.05  # Least exponent of a shear-thinning fluid; below it the stress is nearly that of a plastic solid.


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


def set_numbers(law: RateLaw, **values: float) -> None:
    """Set fields of a frozen law, in its ``__init__``."""
    for name, value in values.items():
        object.__setattr__(law, name, value)


def parameters_of(law: RateLaw, *names: str) -> dict[str, float | str]:
    """Return fields by name, as outputs print them."""
    return {name: getattr(law, name) for name in names}


def checked_time(value: str | float) -> float:
    """Return a relaxation time [s]; raise InputError unless it is above zero."""
    time = to_si(value, "time", "relaxation_time")
    if time <= 0:
        raise InputError(f"relaxation_time = {show(value)} must be above zero; one over the rate at which thinning begins.")
    return time


def checked_exponent(value: float) -> float:
    """Return the exponent of a shear-thinning fluid; raise InputError unless it is between 0.05 and 1."""
    n = to_si(value, "number", "exponent")
    if not MIN_EXPONENT <= n <= 1:
        raise InputError(
            f"exponent = {show(value)} must lie between {MIN_EXPONENT:g} and 1, which is Newtonian; the stress grows as "
            "the rate to this power. Fluids that thicken are not modelled."
        )
    return n
