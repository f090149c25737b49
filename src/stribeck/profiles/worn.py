"""A cylinder that has worn flat."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from stribeck._types import Array
from stribeck.profiles.shape import Shape
from stribeck.quantities.schema import Input, law

__all__ = ["Worn"]

EDGE_SHARPNESS = 0.16  # Height over which the worn flat goes over into the cylinder, over the depth of wear
MAX_EXPONENT = 700.0  # Largest exponent that double precision holds


@law
class Worn(Shape):
    r"""A cylinder of radius R from which a depth w has been worn, with edges that are not sharp.

    .. math:: h_0 = s \ln\left(1 + e^{(x^2/2R - w)/s}\right), \qquad s = 0.16 \, w

    The flat has a half-width of about :math:`(2 R w)^{1/2}`.
    """

    name: ClassVar[str] = "worn"
    label: ClassVar[str] = "cylinder worn flat"

    worn_radius: Input = Input(
        label="radius of the cylinder", symbol="$R$", dimension="length", typical="10 mm", source="a rod", is_free=False
    )
    wear_depth: Input = Input(
        label="depth of wear", symbol="$w$", dimension="length", typical="2 um", source="a run-in slider"
    )
    reversed: bool = False

    def gap(self, x: Array) -> Array:
        """Return the gap [m]."""
        return np.asarray(EDGE_SHARPNESS * self.wear_depth * np.logaddexp(0.0, self._over_edge(x)))

    def slope(self, x: Array) -> Array:
        """Return its slope."""
        return np.asarray(x / self.worn_radius / (1 + np.exp(np.clip(-self._over_edge(x), -MAX_EXPONENT, MAX_EXPONENT))))

    def _over_edge(self, x: Array) -> Array:
        """Return the height of the cylinder over the worn flat, over that of the edge."""
        return np.asarray((0.5 * x**2 / self.worn_radius - self.wear_depth) / (EDGE_SHARPNESS * self.wear_depth))
