"""A flat land with rounded edges: a worn seal, a wiper that has been cut flat, a pad."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from stribeck._types import Array
from stribeck.profiles.shape import Shape
from stribeck.quantities.schema import Input, law

__all__ = ["Land"]


@law
class Land(Shape):
    r"""A flat land of width 2b with edges that are rounded by parabolas.

    .. math:: h_0 = \frac{\max(|x| - b, 0)^2}{2 r}
    """

    name: ClassVar[str] = "land"
    label: ClassVar[str] = "flat land with rounded edges"

    land_width: Input = Input(
        label="width of the land", symbol="$2b$", dimension="length", typical="0.4 mm", source="the worn trace of a rod seal"
    )
    edge_radius: Input = Input(
        label="radius of the edges of the land",
        symbol="$r$",
        dimension="length",
        typical="1 mm",
        source="a worn edge under a microscope",
    )
    reversed: bool = False

    @property
    def places(self) -> tuple[float, ...]:
        """Both edges, where the curvature jumps [m]."""
        return (-0.5 * self.land_width, 0.5 * self.land_width)

    def gap(self, x: Array) -> Array:
        """Return the gap [m]."""
        return np.asarray(0.5 * self._beyond(x) ** 2 / self.edge_radius)

    def slope(self, x: Array) -> Array:
        """Return its slope."""
        return np.asarray(np.sign(x) * self._beyond(x) / self.edge_radius)

    def _beyond(self, x: Array) -> Array:
        """Return the distance from the land."""
        return np.asarray(np.maximum(np.abs(x) - 0.5 * self.land_width, 0.0))
