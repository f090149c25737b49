"""The cylinder, as a profile: the parabola that a contact without a profile has."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from stribeck._types import Array
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.settings import ROUNDING
from stribeck.profiles.profile import Departure, Parabola, Undeformed
from stribeck.profiles.shape import Shape
from stribeck.quantities.schema import Input, law

__all__ = ["Cylinder"]


@law
class Cylinder(Shape):
    r"""A cylinder, whose gap is :math:`x^2/2R`: a contact with this profile is that with its radius, to the last digit."""

    label: ClassVar[str] = "cylinder"
    cavitation: ClassVar[Cavitation] = Cavitation.NONE

    radius: Input = Input(
        label="radius of the cylinder", symbol="$R$", dimension="length", typical="10 mm", source="a rod", is_free=False
    )

    @property
    def name(self) -> str:  # type: ignore[override]
        """The name that outputs print; no name of a law, as a contact without a profile is a cylinder."""
        return "cylinder"

    @property
    def radius_of_contact(self) -> float:
        """The radius of the cylinder with the same dry width: its own, at any load."""
        return self.radius

    def gap(self, x: Array) -> Array:
        """Return the parabola."""
        return np.asarray(0.5 * x**2 / self.radius)

    def slope(self, x: Array) -> Array:
        """Return its slope."""
        return np.asarray(x / self.radius)

    def undeformed(self, origin: float, length: float, height: float) -> Undeformed:
        """Return the gap in Hertz units."""
        curvature = length * (length / height) / self.radius
        return Parabola() if abs(curvature - 1) <= ROUNDING else Departure(self, origin, length, height)
