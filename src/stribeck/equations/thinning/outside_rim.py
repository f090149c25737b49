"""What films beyond the rim of a ball have in common: the fluid, the motion, the rim, and the waves there."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple, Self

import numpy as np

from stribeck._types import Array
from stribeck.fluids.laws import RateLaw

__all__ = ["OutsideRim", "Waves"]


class Waves(NamedTuple):
    """Coefficients of cos k theta, k = 1, 3, 5 and so on: the film far away is odd along the motion."""

    pressure: Array
    slope: Array
    flux: Array

    def at(self, angles: Array, modes: int) -> Array:
        """Return the three at angles, by as many of the modes, shape (3, angles)."""
        cosines = np.cos(np.multiply.outer(angles, np.arange(1, min(modes, 2 * self.pressure.size), 2)))
        return np.stack([cosines @ each[: cosines.shape[1]] for each in self])


@dataclass(frozen=True, eq=False)
class OutsideRim:
    """The film of a ball outside a rim, of a shear-thinning fluid."""

    law: RateLaw  # The law, its time in Hertz units at this speed
    slide: float  # Half the slide-to-roll ratio
    speed: float  # Speed group
    rim: float  # Radius of the rim [a]

    is_all: ClassVar[bool] = False
    """Whether it is the whole film; else what it has more than that of a fluid that does not thin."""

    @property
    def at_rim_by_offset(self) -> tuple[Waves, Waves]:
        """The waves at the rim without an offset, and their derivatives by the offset."""
        raise NotImplementedError

    def at_radius(self, radius: float) -> Self:
        """Return the film beyond another radius."""
        return replace(self, rim=radius)

    def first(self, offset: float) -> float:
        """Return the factor of cos(theta) in the pressure at the rim."""
        found, change = self.at_rim_by_offset
        return float(found.pressure[0] + offset * change.pressure[0])

    def at_rim(self, angles: Array, modes: int) -> tuple[Array, Array]:
        """Return pressure, radial derivative and flux, see :class:`Waves`, at angles of the rim, and by the offset."""
        found, change = self.at_rim_by_offset
        return found.at(angles, modes), change.at(angles, modes)
