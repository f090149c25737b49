"""A lip with two plane sides and a rounded tip, as of a rod seal, a shaft seal or a wiper."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from stribeck._types import Array
from stribeck.profiles.shape import Shape
from stribeck.quantities.schema import Input, law

__all__ = ["Lip"]


@law
class Lip(Shape):
    r"""A lip whose sides rise at two angles from a rounded tip.

    .. math::

        h_0' = \frac{m_a - m_o}{2} + \frac{m_a + m_o}{2} \frac{x}{(x^2 + e^2)^{1/2}}, \qquad
        m = \tan\theta, \quad e = \frac{m_a + m_o}{2} r

    with r the radius of curvature of the tip.  The fluid flows from the side of the oil, where x is negative, to that of the
    air; ``reversed`` is the other direction of the stroke.
    """

    name: ClassVar[str] = "lip"
    label: ClassVar[str] = "lip with two sides"

    angle_oil: Input = Input(
        label="angle of the lip on the side of the oil",
        symbol=r"$\theta_o$",
        dimension="angle",
        typical="45 deg",
        source="shaft seals, ISO 6194",
        highest=0.5 * math.pi,
    )
    angle_air: Input = Input(
        label="angle of the lip on the side of the air",
        symbol=r"$\theta_a$",
        dimension="angle",
        typical="25 deg",
        source="shaft seals, ISO 6194",
        highest=0.5 * math.pi,
    )
    tip_radius: Input = Input(
        label="radius of the tip of the lip",
        symbol="$r$",
        dimension="length",
        typical="50 um",
        source="a moulded or trimmed edge",
    )
    reversed: bool = False

    @property
    def _sides(self) -> tuple[float, float, float]:
        """Half the difference and half the sum of both slopes, and the length over which they turn."""
        oil, air = math.tan(self.angle_oil), math.tan(self.angle_air)
        return 0.5 * (air - oil), 0.5 * (air + oil), 0.5 * (air + oil) * self.tip_radius

    def gap(self, x: Array) -> Array:
        """Return the gap [m]."""
        tilt, mean, e = self._sides
        return np.asarray(tilt * x + mean * (np.hypot(x, e) - e))

    def slope(self, x: Array) -> Array:
        """Return its slope."""
        tilt, mean, e = self._sides
        return np.asarray(tilt + mean * x / np.hypot(x, e))
