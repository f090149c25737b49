r"""The shape of the rigid body as the equations see it: what its gap has beyond the parabola :math:`x^2/2` of a cylinder.

A shape is anything with four members, see :class:`Profile`.  In units of a length L and a height u_0 its gap is

.. math:: g(x) = \frac{h_0(x_0 + L x)}{u_0}

with :math:`x_0` the origin of x.  The gap of a lip or a land grows as ``|x|``, which films do not feel but viscous drag far
away does: beyond 6 L every shape goes over into the parabola, and from 14 L on it is the parabola.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar, Protocol

import numpy as np

from stribeck._types import Array
from stribeck.numerics.panels import Mesh
from stribeck.numerics.settings import HALF_DIGITS
from stribeck.numerics.trace import act, pointwise
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.registry import check_user_part, refusal
from stribeck.quantities.units import InputError, show

PROFILE_UP_TO = 6.0  # Distance up to which the gap is that of the shape [L]
PARABOLA_FROM = 14.0  # Distance from which it is the parabola [L]

REQUIRED_MEMBERS = ("gap", "slope", "places", "parameters")

CHECKED_DISTANCES = np.geomspace(1e-6, 1.0, 13)  # Distances from a kink, or from zero, of a shape of unknown size
SLOPE_RTOL = 1e-4  # Difference of the slope from differences of the gap over the largest slope nearby
STEP = 1e-6  # Step of these differences over the distance


class Profile(Protocol):
    """A shape as users give it: frozen, hashable; lengths in SI with a contact, in L and u_0 with groups."""

    @property
    def places(self) -> Sequence[float]:
        """Where the slope or the curvature of the gap has a kink."""

    @property
    def parameters(self) -> Mapping[str, float | str]:
        """What distinguishes this shape from others of its name, for outputs."""

    def gap(self, x: Array) -> Array:
        """Return the undeformed gap at positions along the contact."""

    def slope(self, x: Array) -> Array:
        """Return the derivative of the gap."""

    def __hash__(self) -> int:
        """Return the same for the same shape: what is computed is kept by it."""
        return object.__hash__(self)


@dataclass(frozen=True)
class Undeformed:
    """The undeformed gap in Hertz units: of a cylinder the parabola itself, from which those of other shapes depart."""

    name: ClassVar[str] = "cylinder"
    parameters: ClassVar[Mapping[str, float | str]] = {}
    places: ClassVar[Array] = np.empty(0)  # Where panels of a mesh must end [a]
    is_parabola: ClassVar[bool] = True

    def part(self, part: float) -> Undeformed:
        """Return the gap at a place of the path from the parabola, 0, to this one, 1."""
        return self

    def departure(self, mesh: Mesh, exit: Any) -> Any:
        """Return the gap beyond the parabola [u_Hz] at the nodes of a mesh, whose zero is the exit where there is one."""
        return 0.0

    def missed(self, coarse: Mesh, mesh: Mesh, exit: Any) -> Any:
        """Return the departure at the nodes of a finer mesh on the same panels, less the polynomials of the coarse one."""
        return 0.0

    def moment(self, mesh: Mesh, exit: Any, pressure: Any) -> Any:
        """Return the integral of the departure's slope times nodal pressure over the panels in x."""
        return 0.0


def undeformed(shape: Profile, origin: float, length: float, height: float) -> Undeformed:
    """Return the gap of a shape in Hertz units, seen from an origin: a cylinder is the parabola itself."""
    own = getattr(shape, "undeformed", None)
    found: Undeformed = Departure(shape, origin, length, height) if own is None else own(origin, length, height)
    return found


@dataclass(frozen=True)
class Departure(Undeformed):
    """A shape in Hertz units."""

    shape: Profile
    origin: float = 0.0  # x_0 [m], or [L] with groups
    length: float = 1.0  # L [m]
    height: float = 1.0  # u_0 [m]
    of_shape: float = 1.0  # Its part along the path from the parabola

    is_parabola: ClassVar[bool] = False

    @property
    def name(self) -> str:  # type: ignore[override]
        """The name of the shape."""
        return str(getattr(self.shape, "name", type(self.shape).__name__))

    @property
    def parameters(self) -> Mapping[str, float | str]:  # type: ignore[override]
        """Those of the shape."""
        return self.shape.parameters

    @property
    def direction(self) -> float:
        """Minus one of a shape that is reversed, which then is seen from behind."""
        return -1.0 if getattr(self.shape, "reversed", False) else 1.0

    @cached_property
    def places(self) -> Array:
        """Kinks of the shape, and where it begins and ends to go over into the parabola."""
        own = (self.direction * np.asarray(self.shape.places, dtype=float) - self.origin) / self.length
        ends = np.array([-PARABOLA_FROM, -PROFILE_UP_TO, PROFILE_UP_TO, PARABOLA_FROM])
        return np.sort(np.append(own[np.abs(own) < PARABOLA_FROM], ends))

    def part(self, part: float) -> Departure:
        """Return the gap at a place of the path from the parabola, 0, to this one, 1."""
        return replace(self, of_shape=part)

    def departure(self, mesh: Mesh, exit: Any) -> Any:
        """Return the gap beyond the parabola: on each panel that between the kinks amid which it was made."""
        return pointwise(partial(self._on_panels, mesh), mesh.nodes if exit is None else mesh.nodes + exit)

    def missed(self, coarse: Mesh, mesh: Mesh, exit: Any) -> Any:
        """Return the departure between the nodes less their polynomials."""
        found = self._gap_and_slope(mesh.nodes if exit is None else mesh.nodes + exit)[0]
        return found - coarse.to_order(self.departure(coarse, exit), mesh.order)

    def moment(self, mesh: Mesh, exit: Any, pressure: Any) -> Any:
        """Return the integral of the departure's slope times pressure."""
        slope = pointwise(lambda x: (self._on_panels(mesh, x)[1], self._curvature(mesh, x)), exit + mesh.nodes)
        return act(mesh.inner_weights, slope * pressure)

    def _between_kinks(self, mesh: Mesh, x: Any) -> Any:
        """Return the places nearest to ``x`` between the kinks amid which the panels of a mesh were made."""
        places = np.concatenate([[-np.inf], self.places, [np.inf]])
        after = np.repeat(np.searchsorted(places, mesh.origin + mesh.middles), mesh.order)
        return np.clip(x, places[after - 1] + HALF_DIGITS, places[after] - HALF_DIGITS)

    def _curvature(self, mesh: Mesh, x: Any) -> Any:
        """Return the curvature of the departure there, no more exact than half of the digits."""
        at = self._between_kinks(mesh, x)
        inwards = np.where(x > at, -HALF_DIGITS, HALF_DIGITS)
        return (self._gap_and_slope(at + inwards)[1] - self._gap_and_slope(at)[1]) / inwards

    def _on_panels(self, mesh: Mesh, x: Any) -> tuple[Any, Any]:
        """Return the departure and its slope at the nodes of a mesh, which now lie at ``x``."""
        # A kink moves through the panels with the exit: each goes on, as a parabola, with what it has up to the kink, so that
        # Newton's iteration meets none, and the next mesh has the kink between panels.
        at = self._between_kinks(mesh, x)
        gap, slope = self._gap_and_slope(at)
        beyond = x - at
        if not beyond.any():
            return gap, slope
        bend = self._curvature(mesh, x) * beyond
        return gap + beyond * (slope + 0.5 * bend), slope + bend

    def _gap_and_slope(self, x: Any) -> tuple[Any, Any]:
        """Return the departure and its slope at positions in the contact."""
        x = np.clip(np.asarray(x), -PARABOLA_FROM, PARABOLA_FROM)
        t = np.clip((np.abs(x) - PROFILE_UP_TO) / (PARABOLA_FROM - PROFILE_UP_TO), 0.0, 1.0)
        left = 1 - t**4 * (35 - 84 * t + 70 * t**2 - 20 * t**3)
        falls = -140 * (t * (1 - t)) ** 3 * np.sign(x) / (PARABOLA_FROM - PROFILE_UP_TO)
        place = self.direction * (self.origin + self.length * x)
        gap = self.shape.gap(place) / self.height - 0.5 * x**2
        slope = self.direction * self.shape.slope(place) * (self.length / self.height) - x
        return self.of_shape * left * gap, self.of_shape * (left * slope + falls * gap)


def as_profile(profile: Any) -> Profile:
    """Return what users give as a shape; refuse what is none, or contradicts itself."""
    if isinstance(profile, type) or not all(hasattr(profile, member) for member in REQUIRED_MEMBERS):
        raise InputError(
            f"profile = {show(profile)}; give one of sb.profiles such as Land('0.4 mm', '1 mm'), or an object with "
            f"{', '.join(REQUIRED_MEMBERS)}."
        )
    check_user_part("profile", profile, _check_slope)
    found: Profile = profile
    return found


def _check_slope(profile: Profile) -> None:
    """Refuse a shape whose slope is not the derivative of its gap at any distance from the first of its kinks."""
    middle = next(iter(profile.places), 0.0)
    x = middle + np.concatenate([-CHECKED_DISTANCES, CHECKED_DISTANCES])
    step = STEP * np.abs(x - middle)
    gap, slope = (np.asarray(each(x), dtype=float) for each in (profile.gap, profile.slope))
    if gap.shape != x.shape or slope.shape != x.shape:
        raise refusal("profile", profile, "gap and slope must return a number for each place.")
    found = (profile.gap(x + step) - profile.gap(x - step)) / (2 * step)
    rounding = 4 * np.finfo(float).eps * np.abs(gap) / step
    wrong = np.abs(found - slope) - rounding > SLOPE_RTOL * np.maximum(np.abs(slope).max(), np.abs(found).max())
    if wrong.any():
        place = x[np.argmax(wrong)]
        raise refusal("profile", profile, f"its slope is not the derivative of its gap at x = {place:.3g}.")
