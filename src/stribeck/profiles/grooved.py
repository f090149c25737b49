"""Grooves across the sliding direction in another shape."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from stribeck._types import Array
from stribeck.profiles.check_profile import as_profile
from stribeck.profiles.cylinder import Cylinder
from stribeck.profiles.profile import Profile
from stribeck.profiles.shape import Shape
from stribeck.quantities.schema import Input, law
from stribeck.quantities.units import InputError

__all__ = ["Grooved"]

FADING_POWER = 8  # Power of the distance with which grooves fade at the ends of the grooved strip


@law
class Grooved(Shape):
    r"""A shape with grooves across the sliding direction, which fade at the ends of a strip of width 2B.

    .. math:: h_0 = h_\mathrm{base} + \frac{d}{2} \left(1 - \cos\frac{2\pi x}{l}\right) e^{-(x/B)^8}

    One cavity behind the contact is modelled, none in each groove.
    """

    name: ClassVar[str] = "grooved"
    label: ClassVar[str] = "cylinder with grooves"

    base_radius: Input = Input(
        label="radius of the cylinder with grooves",
        symbol="$R$",
        dimension="length",
        typical="10 mm",
        source="a rod",
        optional=True,
        is_free=False,
    )
    groove_depth: Input = Input(
        label="depth of the grooves", symbol="$d$", dimension="length", typical="1 um", source="a honed or laser-cut surface"
    )
    groove_pitch: Input = Input(
        label="pitch of the grooves", symbol="$l$", dimension="length", typical="50 um", source="a honed or laser-cut surface"
    )
    grooved_width: Input = Input(
        label="width of the grooved strip",
        symbol="$2B$",
        dimension="length",
        typical="1 mm",
        source="a few widths of the contact",
        is_free=False,
    )
    body: Profile | None = None
    reversed: bool = False

    def __post_init__(self) -> None:
        """Refuse a base that is no shape, or is given beside a radius."""
        if (self.body is None) == (self.base_radius is None):
            raise InputError("grooves are cut into one body: give base_radius, that of a cylinder, or body, another shape.")
        _ = as_profile(self._under_grooves)

    @property
    def _under_grooves(self) -> Profile:
        """The body in which the grooves are."""
        return Cylinder(self.base_radius) if self.body is None else self.body

    @property
    def parameters(self) -> Mapping[str, float | str]:
        """Those of the body too."""
        own = {name: value for name, value in super().parameters.items() if value is not None}
        return {**(self.body.parameters if self.body is not None else {}), **own}

    @property
    def places(self) -> tuple[float, ...]:
        """Kinks of the body [m]."""
        return tuple(self._under_grooves.places)

    def gap(self, x: Array) -> Array:
        """Return the gap [m]."""
        depth, wave, fading, _ = self._grooves(x)
        return np.asarray(self._under_grooves.gap(x) + depth * (1 - np.cos(wave * x)) * fading)

    def slope(self, x: Array) -> Array:
        """Return its slope."""
        depth, wave, fading, rate = self._grooves(x)
        return np.asarray(
            self._under_grooves.slope(x) + depth * fading * (wave * np.sin(wave * x) - rate * (1 - np.cos(wave * x)))
        )

    def _grooves(self, x: Array) -> tuple[float, float, Array, Array]:
        """Return half the depth, the wave number, what is left of the grooves, and the rate at which they fade."""
        half = 0.5 * self.grooved_width
        y = np.clip(x / half, -FADING_POWER, FADING_POWER)
        rate = FADING_POWER * y ** (FADING_POWER - 1) / half
        return 0.5 * self.groove_depth, 2 * math.pi / self.groove_pitch, np.exp(-(y**FADING_POWER)), rate
