"""The shapes of the package by formulas: a cylinder, a flat land, a lip, a worn cylinder, and grooves in any of them."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from stribeck._types import Array
from stribeck.fluids.fluid import Cavitation
from stribeck.numerics.settings import ROUNDING
from stribeck.profiles.profile import Departure, Profile, Undeformed, as_profile
from stribeck.quantities.schema import Input, law, numbers_of
from stribeck.quantities.units import InputError

FADING_POWER = 8  # Power of the distance with which grooves fade at the ends of the grooved strip

EDGE_SHARPNESS = 0.16  # Height over which a worn flat goes over into the cylinder, over the depth of wear
MAX_EXPONENT = 700.0  # Largest exponent that double precision holds

_length = partial(Input, dimension="length")


@dataclass(frozen=True)
class Shape(ABC):
    """A shape of the package: a frozen class with its numbers, and its gap and slope over the lowest point."""

    name: ClassVar[str]
    label: ClassVar[str]

    # Full films hold against any suction, which behind a blunt edge or the steep side of a lip would carry loads below zero.
    cavitation: ClassVar[Cavitation] = Cavitation.EXIT

    @property
    def parameters(self) -> Mapping[str, float | str]:
        """Its numbers, and whether it is reversed."""
        turned = {"reversed": "true"} if getattr(self, "reversed", False) else {}
        return {name: getattr(self, name) for name in numbers_of(type(self))} | turned

    @property
    def places(self) -> tuple[float, ...]:
        """Where slope or curvature of the gap have a kink [m]; nowhere unless a shape says so."""
        return ()

    @abstractmethod
    def gap(self, x: Array) -> Array:
        """Return the gap at positions along the contact [m]."""

    @abstractmethod
    def slope(self, x: Array) -> Array:
        """Return the slope of the gap [-]."""


@law
class Cylinder(Shape):
    r"""A cylinder, whose gap is :math:`x^2/2R`: a contact with this profile is that with its radius, to the last digit."""

    label: ClassVar[str] = "cylinder"
    cavitation: ClassVar[Cavitation] = Cavitation.NONE

    radius: Input = _length(label="radius of the cylinder", symbol="$R$", typical="10 mm", source="a rod", is_free=False)

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
        return Undeformed() if abs(curvature - 1) <= ROUNDING else Departure(self, origin, length, height)


@law
class Grooved(Shape):
    r"""A shape with grooves across the sliding direction, which fade at the ends of a strip of width 2B.

    .. math:: h_0 = h_\mathrm{base} + \frac{d}{2} \left(1 - \cos\frac{2\pi x}{l}\right) e^{-(x/B)^8}

    One cavity behind the contact is modelled, none in each groove.
    """

    name: ClassVar[str] = "grooved"
    label: ClassVar[str] = "cylinder with grooves"

    groove_depth: Input = _length(
        label="depth of the grooves", symbol="$d$", typical="1 um", source="a honed or laser-cut surface"
    )
    groove_pitch: Input = _length(
        label="pitch of the grooves", symbol="$l$", typical="50 um", source="a honed or laser-cut surface"
    )
    grooved_width: Input = _length(
        label="width of the grooved strip", symbol="$2B$", typical="1 mm", source="a few widths of the contact", is_free=False
    )
    base_radius: Input = _length(
        label="radius of the cylinder with grooves",
        symbol="$R$",
        typical="10 mm",
        source="a rod",
        optional=True,
        is_free=False,
    )
    body: Profile | None = None
    reversed: bool = False

    def __post_init__(self) -> None:
        """Refuse a base that is no shape, is given beside a radius, or is reversed by itself."""
        if (self.body is None) == (self.base_radius is None):
            raise InputError("grooves are cut into one body: give base_radius, that of a cylinder, or body, another shape.")
        if getattr(as_profile(self._under_grooves), "reversed", False):
            raise InputError(f"body = {self.body!r}: give reversed = True to the grooves, with which their body turns.")

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


@law
class Land(Shape):
    r"""A flat land of width 2b with edges that are rounded by parabolas.

    .. math:: h_0 = \frac{\max(|x| - b, 0)^2}{2 r}
    """

    name: ClassVar[str] = "land"
    label: ClassVar[str] = "flat land with rounded edges"

    land_width: Input = _length(
        label="width of the land", symbol="$2b$", typical="0.4 mm", source="the worn trace of a rod seal"
    )
    edge_radius: Input = _length(
        label="radius of the edges of the land", symbol="$r$", typical="1 mm", source="a worn edge under a microscope"
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
    tip_radius: Input = _length(
        label="radius of the tip of the lip", symbol="$r$", typical="50 um", source="a moulded or trimmed edge"
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


@law
class Worn(Shape):
    r"""A cylinder of radius R from which a depth w has been worn, with edges that are not sharp.

    .. math:: h_0 = s \ln\left(1 + e^{(x^2/2R - w)/s}\right), \qquad s = 0.16 \, w

    The flat has a half-width of about :math:`(2 R w)^{1/2}`.
    """

    name: ClassVar[str] = "worn"
    label: ClassVar[str] = "cylinder worn flat"

    worn_radius: Input = _length(label="radius of the cylinder", symbol="$R$", typical="10 mm", source="a rod", is_free=False)
    wear_depth: Input = _length(label="depth of wear", symbol="$w$", typical="2 um", source="a run-in slider")
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
