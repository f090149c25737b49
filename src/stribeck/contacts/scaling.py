r"""How the groups of a geometry scale: one row for the cylinder, one for the ball.

With the dry smooth contact of Hertz as the unit, its half-width or radius a, indentation :math:`u = a^2/R` and largest
pressure :math:`p_\mathrm{Hz}`,

.. math::

    \frac{p_\mathrm{Hz}}{\beta E^*} = \bar F_N^{e}, \qquad \kappa = \frac{h_\mathrm{rms}}{\alpha u}
    = \frac{\bar h_\mathrm{rms}}{\bar F_N^{2e}}, \qquad \frac{a}{R} = c \, \beta \bar F_N^{e}

with e = 1/2, c = 2 on the line and e = 1/3, c = pi/2 on the ball.

Source: [Bertin & Pouliquen] Eq. (Hertz_scales) for the line; the same with Hertz's contact of a sphere for the ball.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

__all__ = ["SCALINGS", "Geometry", "Scaling"]

Geometry = Literal["line", "point"]  # A cylinder or a ball


@dataclass(frozen=True)
class Scaling:
    """How the groups of one geometry scale."""

    name: str  # Name of the geometry
    pressure_exponent: float  # e and 2e
    roughness_exponent: float  # e and 2e
    slope_factor: float  # c
    hersey_power: int  # Power of a/R in the Hersey number over the speed group
    hersey_divisor: float  # Divisor of the Hersey number


# The geometries by name: a cylinder, whose load is per unit length, and a ball.
SCALINGS: dict[Geometry, Scaling] = {
    "line": Scaling("line", 0.5, 1.0, 2.0, 2, 3 * math.pi),
    "point": Scaling("point", 1 / 3, 2 / 3, 0.5 * math.pi, 1, 4 * math.pi),
}
