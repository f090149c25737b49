"""Carreau and Yasuda's law of shear, as a user writes it who gives the package a fluid of their own (for_developers.md)."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from stribeck.fluids.laws import RateLaw
from stribeck.fluids.rheology.tabulated import EXPONENT, RELAXATION_TIME
from stribeck.quantities.schema import Input


@dataclass(frozen=True)
class Yasuda(RateLaw):
    """The fluid that thins as g(x) = x (1 + x**a)**((n - 1)/a)."""

    name: ClassVar[str] = "yasuda"
    label: ClassVar[str] = "Carreau and Yasuda"

    relaxation_time: Input = RELAXATION_TIME  # the arguments are this time, then the numbers of the shape
    exponent: Input = EXPONENT
    sharpness: Input = Input(
        label="sharpness of thinning",
        symbol="$a$",
        dimension="number",
        typical="2",
        source="polymer melts, 1 to 3",
        lowest=0.2,
        highest=10.0,
        default=2.0,
    )

    @property
    def time(self):
        return self.relaxation_time

    @property
    def shape(self):
        return self.exponent, self.sharpness  # the arguments after the time, in their order

    @property
    def plateau(self):
        return 1.0 if self.sharpness == 2 else 0.0  # below x = 1 the viscosity is a series in x**2, or in no even power

    def smallest(self):
        return np.log(1e-17) / self.sharpness  # below this ln x the fluid is Newtonian to rounding

    def scaled(self, units):
        return replace(self, relaxation_time=self.relaxation_time / units.time)  # the shape has no units

    def stress(self, rate):
        n, a = self.exponent, self.sharpness
        return rate * (1 + rate**a) ** ((n - 1) / a)  # g
