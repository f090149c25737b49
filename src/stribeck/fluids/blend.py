"""Films between a Newtonian one and any other: states of the first lead to states of the second."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Self, cast

from stribeck.fluids.fluid import Film
from stribeck.fluids.newtonian import Newtonian

__all__ = ["Blend", "blend"]

# Logarithmic decay of the Newtonian part of a blend with a fluid that thins: its films are powers of that part; without decay
# the thinnest are lost (test_a_film_of_which_rounding_leaves_three_digits_is_returned_with_its_error).
NEWTONIAN_DECAY = 8.0


@dataclass(frozen=True)
class Blend:
    """A film whose flow lies between that of a Newtonian fluid and its own; in all else it is its own."""

    film: Film
    newtonian: float  # Part of the Newtonian fluid
    plain: Film = Newtonian()

    @property
    def name(self) -> str:
        """The name of the film."""
        return self.film.name

    @property
    def parameters(self) -> dict[str, float | str]:
        """The parameters of the film."""
        return self.film.parameters

    @property
    def uses_pressure(self) -> bool:
        """Whether the film's gradient depends on the pressure."""
        return self.film.uses_pressure

    def at(self, speed: Any) -> Self:
        """Return the blend at a speed."""
        return replace(self, film=self.film.at(speed))

    def gradient(self, gap: Any, pressure: Any, flux_gap: Any) -> Any:
        """Return the weighted mean of both gradients."""
        own = self.film.gradient(gap, pressure, flux_gap)
        return self.newtonian * self.plain.gradient(gap, None, flux_gap) + (1 - self.newtonian) * own

    def __getattr__(self, name: str) -> object:
        """Return any other attribute of the film."""
        return getattr(self.film, name)


def blend(film: Film, part: float) -> Film:
    """Return the film at a place of the path from the Newtonian one, 0, to its own, 1."""
    if part == 1.0:
        return film
    return cast(Film, Blend(film, (1 - part) * (math.exp(-NEWTONIAN_DECAY * part) if hasattr(film, "decay") else 1.0)))
