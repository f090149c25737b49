"""How far a contact is from the next lubrication regime, in speed, load, roughness and viscosity, on solved states."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from stribeck.contact_laws.law import largest_load
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, check_definition
from stribeck.contacts.groups import Geometry
from stribeck.curves.coordinate import Over
from stribeck.curves.regime import BOUNDARY_FLUID_SHARE, HYDRODYNAMIC_CONTACT_SHARE, Regime, Transition, regime_of
from stribeck.curves.result import StribeckCurve
from stribeck.curves.stribeck_curve import continued, stribeck_curve
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.units import InputError, show
from stribeck.solver.solution import Solution
from stribeck.solver.solve import SolveError, check_rtol, solve

__all__ = ["Crossing", "Margin", "RegimeMargins", "regime_margins", "scanned_rtol"]

REACH = 1e6
"""Largest factor by which an input is changed."""

BOX = {"speed": (1e-12, 1e6), "load": (1e-8, 10.0), "relative_roughness": (1e-6, 1e3)}
"""Groups between which is searched, where the solver is tested; the load also no further than the contact law holds."""

PHYSICAL = {"speed": (1e-12, 1e3), "viscosity": (1e-5, 1e8), "roughness": (1e-10, math.inf)}
"""What an input can be made at all [SI]: a speed from an atom's width in 100 s to that of sound, a fluid from gas to pitch,
a roughness from that of atoms.  Roughness ends with the contact itself: see :func:`physical_bounds`."""


class Search(NamedTuple):
    """How far and how finely the regimes of one geometry are searched.

    Attributes
    ----------
    lightest : float
        Smallest load: of a cylinder, per length, that of a thread of 10 um; of a ball that of a grain of dust [SI].
    heaviest : callable
        ``heaviest(contact)`` is the load at which the Hertz contact is as wide as the body [SI].
    roughest : callable
        ``roughest(contact)`` is the largest roughness: of a cylinder the half-width of the Hertz contact, of a ball its
        indentation, beyond which states at heavy loads are no longer determined [m].
    largest_group : float
        Load group up to which the solver is tested, where the contact law allows it.
    rtol : float
        Smallest tolerance of the states that are scanned: a ball takes a tenth of a second or more each.
    """

    lightest: float
    heaviest: Callable[[Contact], float]
    roughest: Callable[[Contact], float]
    largest_group: float
    rtol: float


SEARCHES: dict[Geometry, Search] = {
    "line": Search(1e-6, lambda each: math.pi / 4 * each.modulus * each.radius, lambda each: each.hertz.half_width, 10.0, 0.0),
    "point": Search(1e-9, lambda each: 4 / 3 * each.modulus * each.radius**2, lambda each: each.hertz.indentation, 1e4, 3e-3),
}
"""The searches by geometry."""

DECADE = math.log(10.0)
"""Length of one step outwards in the logarithm of an input."""

POINTS: dict[Geometry, int] = {"line": 41, "point": 3}
"""States looked at on a decade, by geometry: read off a function, or solved."""

FINER = 5
"""States solved anew between the two between which the regime changes, where the curve is no function."""

LITTLE, CLEAR = 0.02, 1.5
"""Change of the fluid's share over half a decade from which it is extrapolated to slow speed, and the factor by which the
limit must exceed the bound of boundary lubrication for slower speeds not to be searched: from load group 1 on it may never
fall below it."""

THRESHOLD = 5e-3
"""Logarithm of the factor below which a contact is said to stand at the threshold."""

NEIGHBOURS: dict[Regime, tuple[Regime, ...]] = {
    "boundary": ("mixed",),
    "mixed": ("boundary", "hydrodynamic"),
    "hydrodynamic": ("mixed",),
}

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


@dataclass(frozen=True)
class RegimeMargins:
    """A contact's regime and the way to its neighbours.

    Attributes
    ----------
    regime : str
        The present regime.
    margins : tuple of Margin
        For speed, load, roughness and viscosity; the last not for a fluid that thins.
    notes : tuple of str
        What to know: why an input leads nowhere, and whether the contact stands at a threshold.
    geometry : {"line", "point"}
        That of the contact.
    """

    regime: Regime
    margins: tuple[Margin, ...]
    notes: tuple[str, ...]
    geometry: Geometry = "line"

    @property
    def targets(self) -> tuple[Regime, ...]:
        """The regimes beside the present one, and those that an input enters without passing through them."""
        entered = [mark.regime for margin in self.margins for mark in (margin.less, margin.more) if mark is not None]
        return tuple(dict.fromkeys([*NEIGHBOURS[self.regime], *entered]))

    def is_beyond(self, regime: Regime, margin: Margin) -> bool:
        """Return whether a regime may lie beyond the one at which the search along an input ended."""
        return regime not in NEIGHBOURS[self.regime] and (margin.less is not None or margin.more is not None)


@one_blas_thread
def regime_margins(
    contact: Contact,
    *,
    rtol: float = 1e-6,
    definition: Definition = "balanced",
    on_point: Callable[[int, int], object] | None = None,
    curve: StribeckCurve | None = None,
) -> RegimeMargins:
    """Return by which factors of speed, load, roughness and viscosity the lubrication regime of a contact changes.

    Parameters
    ----------
    contact : Contact
        The contact; zero speed and zero roughness are ordinary inputs.
    rtol : float
        Relative tolerance of the states, at least that of :func:`scanned_rtol`.
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    on_point : callable, optional
        ``on_point(done, scans)`` is called after each state, for progress.
    curve : StribeckCurve, optional
        Curve of the contact over the speed, as of :func:`stribeck_curve`, whose states spare starts from cold.

    Returns
    -------
    RegimeMargins
        For each input the nearest change with less and with more of it.

    Raises
    ------
    InputError
        If an argument is outside its range.
    SolveError
        If the contact itself cannot be solved.
    KeyboardInterrupt
        After Ctrl-C.

    Notes
    -----
    Each input is followed by continuation, decade by decade, until the regime of :func:`regime_of` changes, by at most a
    factor of 1e6, as far as the groups lie in speed 1e-12 to 1e6, load 1e-8 to 1, where the law goes on to 10 and of a ball to
    1e4, relative roughness 1e-6 to 1e3, and within :func:`physical_bounds`; towards slow speed no further than to
    where the fluid's share tends to a limit above its bound.  More load lowers the speed group as a power, and the relative
    roughness.  Speed and viscosity enter as their product: one scan serves both.
    """
    check_rtol(rtol)
    definition = check_definition(definition)
    if not isinstance(contact, Contact):
        raise InputError(f"contact = {show(contact)}; it must be a LineContact or PointContact, as margins are in SI units.")
    rtol = scanned_rtol(contact, rtol)
    is_known = curve is not None and curve.is_function and curve.values[0] <= contact.speed <= curve.values[-1]
    there = curve.solve_at(contact.speed) if curve is not None and is_known else solve(contact, rtol=rtol)
    present = _regime(there, definition)
    scan = _Scan(contact, present, rtol, definition, on_point, curve)
    notes = []
    if contact.speed == 0 and contact.roughness > 0:
        notes.append("At zero speed, load, roughness and viscosity do not change the regime.")
    if contact.roughness == 0 and contact.speed > 0:
        notes.append("Smooth surfaces never touch: there is no boundary or mixed lubrication.")
    if contact.boundary_friction == 0:
        notes.append("Without dry friction, all friction is viscous and every state counts as hydrodynamic.")
    if contact.groups.load >= largest_load(contact.law) and contact.roughness > 0:
        notes.append(
            "At load groups of 1 or more, the fluid carries part of the load at every speed; there may be no "
            "boundary lubrication."
        )
    found = [scan.along(name) for name in SCANNED]
    if contact.replace(viscosity=2 * contact.viscosity).groups.model == contact.groups.model:
        found.append(_within(_of_viscosity(contact, found[0]), physical_bounds(contact, "viscosity")))
    else:
        notes.append("Viscosity has no margins: this fluid thins with the shear rate, so that speed does not stand for it.")
    if contact.speed > 0:
        found[0] = _within(found[0], physical_bounds(contact, "speed"))
    close = [mark for margin in found for mark in (margin.less, margin.more) if mark is not None and _at_threshold(mark)]
    if close:
        notes.append(f"The contact is at the threshold to {close[0].regime} lubrication.")
    return RegimeMargins(present, tuple(found), tuple(notes), contact.groups.geometry)


def scanned_rtol(contact: Contact, rtol: float) -> float:
    """Return the tolerance of the states among which changes of regime are looked for.

    Parameters
    ----------
    contact : Contact
        The contact.
    rtol : float
        Relative tolerance that is asked for.

    Returns
    -------
    float
        At least 3e-3 of a ball: transitions and minima of the PDMS ball, of a lens and of one at load group 2 then lie within
        1.2e-3 of those at 1e-3 or 1e-4, for a tenth of the time.
    """
    return max(rtol, SEARCHES[contact.groups.geometry].rtol)


def physical_bounds(contact: Contact, name: str) -> tuple[float, float]:
    r"""Return between which values an input of a contact can be sought, whatever the model says beyond.

    .. math:: F_N \le \frac{\pi}{4} E^* R \text{ on the line}, \quad \frac43 E^* R^2 \text{ on the ball} \;\;(a \le R),
        \qquad h_\mathrm{rms} \le a \text{ and } u_\mathrm{Hz}

    Parameters
    ----------
    contact : Contact
        The contact.
    name : {"speed", "load", "roughness", "viscosity"}
        The input.

    Returns
    -------
    tuple of float
        Lowest and highest value [SI]: speed 1e-12 to 1000 m/s, viscosity 1e-5 to 1e8 Pa s, load from 1e-6 N/m or 1e-9 N to
        where the Hertz contact is as wide as the body, roughness from 0.1 nm to the half-width of that contact,
        of a ball to its indentation.

    Notes
    -----
    Rules of thumb: roughness higher than the contact is half wide is a matter of shape, and the present value counts as
    possible even where it is none.
    """
    search = SEARCHES[contact.groups.geometry]
    if name == "load":
        low, high = search.lightest, search.heaviest(contact)
    else:
        low, high = PHYSICAL[name]
    if name == "roughness":
        high = search.roughest(contact)
    value = float(getattr(contact, name))
    return (min(low, value), max(high, value)) if value > 0 else (low, high)


def _stays_mixed(curve: StribeckCurve) -> bool:
    """Return whether the fluid's share, extrapolated as a geometric series of half decades, ends above its bound."""
    share = curve.observable("fluid_load_share")
    slow, middle, fast = (float(share[i]) for i in (0, len(share) // 2, -1))
    first, second = fast - middle, middle - slow
    if not 0 <= second < min(first, LITTLE):
        return False
    return slow - second**2 / (first - second) > CLEAR * BOUNDARY_FLUID_SHARE


def _within(margin: Margin, bounds: tuple[float, float]) -> Margin:
    """Return a margin without what lies beyond the bounds of its input."""
    low, high = bounds
    ends = max(margin.searched[0], low), min(margin.searched[1], high)
    less, more = (mark if mark is not None and low <= mark.value <= high else None for mark in (margin.less, margin.more))
    return Margin(margin.name, less, more, ends)


def _of_viscosity(contact: Contact, speed: Margin) -> Margin:
    """Return the margins in viscosity that those in speed are; a resting contact has none."""
    eta = contact.viscosity
    if contact.speed == 0:
        return Margin("viscosity", None, None, (eta, eta))
    less, more = (
        None if mark is None else Crossing(mark.regime, eta * mark.factor, mark.factor) for mark in (speed.less, speed.more)
    )
    low, high = (eta * (end / contact.speed) for end in speed.searched)
    return Margin("viscosity", less, more, (low, high))


def _at_threshold(mark: Crossing) -> bool:
    return 0 < mark.factor < math.inf and abs(math.log(mark.factor)) < THRESHOLD


def _regime(solution: Solution, definition: Definition) -> Regime:
    return regime_of(solution.fluid_load_share, solution.friction(definition=definition).contact_share)


@dataclass
class _Scan:
    """The search for changes of regime along one input after another."""

    contact: Contact
    present: Regime
    rtol: float
    definition: Definition
    on_point: Callable[[int, int], object] | None
    like: StribeckCurve | None = None
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
        low, high = _limits(self.contact, name)
        less, lowest = self._outwards(self.contact, name, low)
        more, highest = self._outwards(self.contact, name, high)
        return Margin(name, less, more, (value * math.exp(lowest), value * math.exp(highest)))

    def _from_zero(self, name: Over) -> Margin:
        """Return the change with more of an input that is zero."""
        if self.contact.boundary_friction == 0 or (name == "roughness" and self.contact.speed == 0):
            return Margin(name, None, None, (0.0, 0.0))
        if self.contact.roughness == 0 and name == "speed":
            return Margin(name, None, Crossing("hydrodynamic", 0.0, math.inf), (0.0, 0.0))
        start = _with_smallest(self.contact, name)
        more, highest = self._outwards(start, name, _limits(start, name)[1], math.inf)
        lowest = float(getattr(start, name))
        if more is not None:
            # A regime that the smallest value is in already begins at zero itself.
            more = Crossing(more.regime, more.value if more.value > lowest else 0.0, math.inf)
        return Margin(name, None, more, (0.0, lowest * math.exp(highest)))

    def _outwards(self, start: Contact, name: Over, limit: float, reach: float = REACH) -> tuple[Crossing | None, float]:
        """Return the first change of regime towards ``limit`` and how far was searched, logarithms of factors."""
        value, outward = float(getattr(start, name)), math.copysign(1.0, limit)
        size, here = min(abs(limit), math.log(reach)), 0.0
        while size - here > 1e-9:
            there = min(here + DECADE, size)
            near, far = (value * math.exp(outward * s) for s in (here, there))
            curve = self._curve(start, name, near, far, POINTS[start.groups.geometry])
            if curve is None:
                break
            change = self._first_change(curve, outward)
            if change is not None:
                regime, place = self._located(curve, start, name, outward, *change)
                return Crossing(regime, place, place / value), math.log(place / value)
            here = there
            if name == "speed" and outward < 0 and _stays_mixed(curve):
                break
        return None, outward * here

    def _curve(self, start: Contact, name: Over, near: float, far: float, points: int) -> StribeckCurve | None:
        """Return the states between two values of an input; None where the solver does not reach them all."""
        try:
            if near in self.known:  # where another curve begins or ends: a start from cold costs as much as a decade
                curve = continued(self.known[near], far, points, self._report, near)
            else:
                ends: Any = {name: (min(near, far), max(near, far))}
                settings: Any = {"rtol": self.rtol, "definition": self.definition, "on_point": self._report, "like": self.like}
                curve = stribeck_curve(start, **ends, points=points, **settings)
                self.like = curve if self.like is None else self.like
        except SolveError:
            return None
        if curve.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if not curve.outcome.ok:
            return None
        if curve.is_function:
            self.known |= {near: curve, far: curve}
        else:
            self.known |= dict.fromkeys(curve.values.tolist(), curve)
        return curve

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
        if not curve.is_function:
            finer = self._curve(start, name, near, far, FINER)
            if finer is None:
                return regime, math.sqrt(near * far)
            curve = finer
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
            share, bound = curve.friction_contact / np.maximum(curve.friction, 1e-300), HYDRODYNAMIC_CONTACT_SHARE
        else:
            share, bound = curve.observable("fluid_load_share"), BOUNDARY_FLUID_SHARE
        return float(min((low, high), key=lambda value: abs(share[np.flatnonzero(curve.values == value)[0]] - bound)))


def _limits(contact: Contact, name: str) -> tuple[float, float]:
    """Return the logarithms of the factors of an input between which it is possible and the groups stay in the box."""
    groups = contact.groups
    highest = min(SEARCHES[groups.geometry].largest_group, largest_load(contact.law))
    box = BOX | {"load": (BOX["load"][0], highest)}
    n_speed, n_load, n_roughness = contact.INPUTS.exponents[name]
    n_roughness -= groups.scaling.roughness_exponent * n_load
    low, high = _possible_factors(contact, name)
    for group, n in (("speed", n_speed), ("load", n_load), ("relative_roughness", n_roughness)):
        value = float(getattr(groups, group))
        if n == 0 or value == 0:
            continue
        ends = sorted(math.log(end / value) / n for end in box[group])
        low, high = max(low, ends[0]), min(high, ends[1])
    return min(low, 0.0), max(high, 0.0)


def _possible_factors(contact: Contact, name: str) -> tuple[float, float]:
    """Return the logarithms of the factors that lead to the bounds of an input, of the speed to those of the viscosity too."""
    names = ("speed", "viscosity") if name == "speed" else (name,)
    ends = [(getattr(contact, each), physical_bounds(contact, each)) for each in names]
    return min(math.log(low / value) for value, (low, _) in ends), max(math.log(high / value) for value, (_, high) in ends)


def _with_smallest(contact: Contact, name: Over) -> Contact:
    """Return the contact with the minimum speed or roughness of the box instead of zero."""
    groups = contact.replace(**{name: 1.0}).groups
    group = "speed" if name == "speed" else "relative_roughness"
    return contact.replace(**{name: BOX[group][0] / float(getattr(groups, group))})
