r"""How the groups of a geometry scale: one row for the cylinder, one for the ball.

With the dry smooth contact of Hertz as the unit, its half-width or radius a, indentation :math:`u = a^2/R` and largest
pressure :math:`p_\mathrm{Hz}`,

.. math::

    \frac{p_\mathrm{Hz}}{\beta E^*} = \bar F_N^{e}, \qquad \kappa = \frac{h_\mathrm{rms}}{\alpha u}
    = \frac{\bar h_\mathrm{rms}}{\bar F_N^{2e}}, \qquad \frac{a}{R} = c \, \beta \bar F_N^{e}
    = \left(\frac{k F_N}{R^r E^*}\right)^{e}

with r = 1, e = 1/2, c = 2 and k = 4/pi on the line, and r = 2, e = 1/3, c = pi/2 and k = 3/4 on the ball.

Source: [Bertin & Pouliquen] Eq. (Hertz_scales) for the line; the same with Hertz's contact of a sphere for the ball.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

__all__ = ["SCALINGS", "Geometry", "Scaling"]

Geometry = Literal["line", "point"]  # A cylinder or a ball


@dataclass(frozen=True)
class Scaling:
    """How the groups of one geometry scale."""

    name: Geometry  # Name of the geometry
    body: str  # What it is of
    dimensions: int  # r, directions in which the contact is small
    slope_factor: float  # c
    hertz_factor: float  # k
    hertz_pressure: float  # Largest Hertz pressure over the mean one
    hersey_power: int  # Power of a/R in the Hersey number over the speed group
    hersey_divisor: float  # Divisor of the Hersey number
    pressure_exponent: float = field(init=False)  # e
    roughness_exponent: float = field(init=False)  # 2e

    def __post_init__(self) -> None:
        """Set the exponents, which every group asks for."""
        object.__setattr__(self, "pressure_exponent", 1 / (1 + self.dimensions))
        object.__setattr__(self, "roughness_exponent", 2 / (1 + self.dimensions))

    @property
    def exponents(self) -> dict[str, tuple[float, float, float]]:
        """Exponents with which inputs of a contact enter the groups of speed, load and roughness."""
        r, shift = self.dimensions, self.pressure_exponent * self.hersey_power
        return {
            "radius": (r - 1 + r * shift, -r, -1),
            "modulus": (shift, -1, 0),
            "load": (-1 - shift, 1, 0),
            "viscosity": (1, 0, 0),
            "speed": (1, 0, 0),
            "roughness": (0, 0, 1),
            "alpha": (0, 0, -1),
            "beta": (0, -1 - r, -2),
        }


# The geometries by name: a cylinder, whose load is per unit length, and a ball.
SCALINGS: dict[Geometry, Scaling] = {
    "line": Scaling("line", "cylinder", 1, 2.0, 4 / math.pi, 4 / math.pi, 2, 3 * math.pi),
    "point": Scaling("point", "ball", 2, 0.5 * math.pi, 0.75, 1.5, 1, 4 * math.pi),
}
