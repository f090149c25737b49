"""The first change of lubrication regime along one input of a contact, on solved states."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Geometry
from stribeck.contacts.regime import friction_share
from stribeck.curves.coordinate import Over
from stribeck.curves.regime import BOUNDARY_FLUID_SHARE, HYDRODYNAMIC_CONTACT_SHARE, Regime, Transition
from stribeck.curves.result import StribeckCurve
from stribeck.curves.stribeck_curve import continued, stribeck_curve
from stribeck.quantities.outcome import Outcome
from stribeck.regimes.margin_limits import limits, with_smallest
from stribeck.solver.solve_error import SolveError

__all__ = ["SCANNED", "Crossing", "Margin", "Scan"]

REACH = 1e6
"""Largest factor by which an input is changed."""

DECADE = math.log(10.0)
"""Length of one step outwards in the logarithm of an input, at least where it ends at a state that is solved anyhow."""

ROUNDING = 1e-9
"""Difference of logarithms of values that are the same."""

POINTS: dict[Geometry, int] = {"line": 41, "point": 3}
"""States looked at on a decade, by geometry: read off a function, or solved."""

FINER = 5
"""States solved anew between the two between which the regime changes, where the curve is no function."""

LITTLE, CLEAR = 0.02, 1.5
"""Change of the fluid's share over half a decade from which it is extrapolated to slow speed, and the factor by which the
limit must exceed the bound of boundary lubrication for slower speeds not to be searched: from load group 1 on it may never
fall below it."""

SCANNED: tuple[Over, ...] = ("speed", "load", "roughness")


@dataclass(frozen=True)
class Crossing:
    """Where another regime begins along one input.

    Attributes
    ----------
    regime : str
        The regime that is entered.
    value : float
        Value of the input there [SI].
    factor : float
        The same over its present value; infinite where that is zero.
    interval_95 : tuple of float or None
        Interval that holds the factor with 95 % probability; None if no input has an error.
    """

    regime: Regime
    value: float
    factor: float
    interval_95: tuple[float, float] | None = None


@dataclass(frozen=True)
class Margin:
    """The nearest changes of regime along one input, all other inputs kept.

    Attributes
    ----------
    name : {"speed", "load", "roughness", "viscosity"}
        The input.
    less, more : Crossing or None
        The first change with less and with more of it; None where there is none within the range searched.
    searched : tuple of float
        Values between which was searched [SI]; the search ends at a change, and where the input can be no more.
    """

    name: str
    less: Crossing | None
    more: Crossing | None
    searched: tuple[float, float]

    def crossing_into(self, regime: str) -> Crossing | None:
        """Return the nearer crossing into a regime, or None."""
        found = [mark for mark in (self.less, self.more) if mark is not None and mark.regime == regime]
        return min(found, key=lambda mark: abs(math.log(mark.factor)) if 0 < mark.factor < math.inf else 0.0, default=None)


def _stays_mixed(curve: StribeckCurve) -> bool:
    """Return whether the fluid's share, extrapolated as a geometric series of half decades, ends above its bound."""
    share = curve.observable("fluid_load_share")
    slow, middle, fast = (float(share[i]) for i in (0, len(share) // 2, -1))
    first, second = fast - middle, middle - slow
    if not 0 <= second < min(first, LITTLE):
        return False
    return slow - second**2 / (first - second) > CLEAR * BOUNDARY_FLUID_SHARE


@dataclass
class Scan:
    """The search for changes of regime along one input after another."""

    contact: Contact
    present: Regime
    rtol: float
    definition: Definition
    on_point: Callable[[int, int], object] | None
    whole: StribeckCurve | None = None  # A curve over one of the inputs that is solved already
    done: int = 0
    known: dict[float, StribeckCurve] = field(default_factory=dict)

    def along(self, name: Over) -> Margin:
        """Return the changes along one input."""
        value = float(getattr(self.contact, name))
        self.known.clear()
        found = self._from_zero(name) if value == 0 else self._both_ways(name, value)
        self.done += 1
        return found

    def _both_ways(self, name: Over, value: float) -> Margin:
        # Zero speed, zero roughness and zero dry friction hold the regime, whatever else changes.
        held = self.contact.speed == 0 or self.contact.boundary_friction == 0 or self.contact.roughness == 0
        if held:
            return Margin(name, None, None, (value, value))
        low, high = limits(self.contact, name)
        less, lowest = self._outwards(self.contact, name, low)
        more, highest = self._outwards(self.contact, name, high)
        return Margin(name, less, more, (value * math.exp(lowest), value * math.exp(highest)))

    def _from_zero(self, name: Over) -> Margin:
        """Return the change with more of an input that is zero."""
        if self.contact.boundary_friction == 0 or (name == "roughness" and self.contact.speed == 0):
            return Margin(name, None, None, (0.0, 0.0))
        if self.contact.roughness == 0 and name == "speed":
            return Margin(name, None, Crossing("hydrodynamic", 0.0, math.inf), (0.0, 0.0))
        start = with_smallest(self.contact, name)
        more, highest = self._outwards(start, name, limits(start, name)[1], math.inf)
        lowest = float(getattr(start, name))
        if more is not None:
            # A regime that the smallest value is in already begins at zero itself.
            more = Crossing(more.regime, more.value if more.value > lowest else 0.0, math.inf)
        return Margin(name, None, more, (0.0, lowest * math.exp(highest)))

    def _outwards(self, start: Contact, name: Over, limit: float, reach: float = REACH) -> tuple[Crossing | None, float]:
        """Return the first change of regime towards ``limit`` and how far was searched, logarithms of factors."""
        value, outward = float(getattr(start, name)), math.copysign(1.0, limit)
        near, end = value, value * math.exp(outward * min(abs(limit), math.log(reach)))
        while abs(math.log(end / near)) > ROUNDING:
            curve = self._curve(start, name, near, end, POINTS[start.groups.geometry])
            if curve is None:
                break
            change = self._first_change(curve, outward)
            if change is not None:
                regime, place = self._located(curve, start, name, outward, *change)
                return Crossing(regime, place, place / value), math.log(place / value)
            before, near = near, float(curve.values[-1 if outward > 0 else 0])
            is_long = math.log(before / near) >= DECADE - ROUNDING
            if name == "speed" and is_long and _stays_mixed(curve):
                break
        return None, math.log(near / value)

    def _curve(self, start: Contact, name: Over, near: float, end: float, points: int) -> StribeckCurve | None:
        """Return the states from a value of an input about a decade on; None where the solver does not reach them."""
        far = end if abs(math.log(end / near)) < DECADE else near * math.exp(math.copysign(DECADE, end - near))
        low, high = sorted((near, far))
        part = self._part_known(name, near, low, high, points)
        if part is not None:
            curve = part
        else:
            try:
                if near in self.known:  # where another curve begins or ends: a start from cold costs as much as a decade
                    curve = continued(self.known[near], end, points, self._report, math.exp(DECADE))
                else:
                    ends: Any = {name: (low, high)}
                    settings: Any = {"rtol": self.rtol, "definition": self.definition, "on_point": self._report}
                    curve = stribeck_curve(start, **ends, points=points, **settings)
            except SolveError:
                return None
        if curve.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if not curve.outcome.ok:
            return None
        self.known |= dict.fromkeys(curve.values[[0, -1]].tolist(), curve)
        return curve

    def _part_known(self, name: Over, near: float, low: float, high: float, points: int) -> StribeckCurve | None:
        """Return the states between two values as far as the curve that is solved already gives them."""
        whole, contact = self.whole, self.contact
        if whole is None or whole.over != name or not whole.rtol <= self.rtol:
            return None
        of_friction = (whole.definition, whole.boundary_friction, whole.beta)
        if of_friction != (self.definition, contact.boundary_friction, contact.beta):
            return None
        path = whole._function
        first, last = np.clip(np.log([low, high]), *path.coordinates[[0, -1]]).tolist()
        if last - first <= ROUNDING or not first - ROUNDING <= math.log(near) <= last + ROUNDING:
            return None
        values = np.clip(np.geomspace(math.exp(first), math.exp(last), points), low, high)
        return whole._along(path.between(first, last), values, points)

    def _report(self, done: int, points: int) -> None:
        if self.on_point is not None:
            self.on_point(self.done, len(SCANNED))

    def _first_change(self, curve: StribeckCurve, outward: float) -> tuple[Regime, float, float] | None:
        """Return the regime entered first on the way out, and the values of the states before and after."""
        values, regimes = curve.values.tolist(), list(curve.regimes)
        if outward < 0:
            values, regimes = values[::-1], regimes[::-1]
        for i, regime in enumerate(regimes):
            if regime != self.present:
                return regime, values[max(i - 1, 0)], values[i]
        return None

    def _located(
        self, curve: StribeckCurve, start: Contact, name: Over, outward: float, regime: Regime, near: float, far: float
    ) -> tuple[Regime, float]:
        """Return the regime entered first between two values, and the value where its share passes the bound."""
        if near == far:
            return regime, near
        regime, near, far = self._first_change(curve, outward) or (regime, near, far)
        wanted = Transition.HYDRODYNAMIC_START if "hydrodynamic" in (regime, self.present) else Transition.BOUNDARY_END
        low, high = sorted((near, far))
        mark = curve.landmark(wanted)
        found = mark.value if mark is not None and low <= mark.value <= high else None
        # Where the states' own errors hide the passage it lies within them: at the end that is at the threshold itself.
        return regime, self._nearest_to_bound(curve, wanted, low, high) if found is None else found

    @staticmethod
    def _nearest_to_bound(curve: StribeckCurve, mark: str, low: float, high: float) -> float:
        """Return that of two values of a curve where the share that a mark is about is nearer to its bound."""
        if mark == Transition.HYDRODYNAMIC_START:
            viscous = curve.friction - curve.friction_contact
            share, bound = friction_share(curve.friction_contact, viscous), HYDRODYNAMIC_CONTACT_SHARE
        else:
            share, bound = curve.observable("fluid_load_share"), BOUNDARY_FLUID_SHARE
        return float(min((low, high), key=lambda value: abs(share[np.flatnonzero(curve.values == value)[0]] - bound)))
