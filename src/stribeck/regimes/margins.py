"""How far a contact is from the next lubrication regime, in speed, load, roughness and viscosity, on solved states."""

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import numpy as np

from stribeck.contact_laws.law import largest_load
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import (
    BOUNDARY_FLUID_SHARE,
    REGIMES,
    Definition,
    Regime,
    check_definition,
    coefficients,
    friction_share,
    regime_numbers,
)
from stribeck.contacts.geometries import INPUT_TABLES
from stribeck.contacts.groups import Geometry
from stribeck.contacts.inputs import follows_surface
from stribeck.contacts.with_parts import exponents_of, known_speeds
from stribeck.curves.coordinate import Over
from stribeck.curves.friction_path import FrictionPath
from stribeck.curves.line_source import LineSource
from stribeck.curves.regime import Transition
from stribeck.curves.result import StribeckCurve, path_of
from stribeck.curves.stribeck_curve import begun
from stribeck.files.datasets import Column, listed
from stribeck.files.results import Labelled, Tabled
from stribeck.numerics.events import Event
from stribeck.numerics.settings import EPSILON
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.results import Card, Told
from stribeck.quantities.units import InputError, show
from stribeck.regimes.advice import ways_to
from stribeck.solver.base_solution import regime_of_state
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solve import check_rtol, solve
from stribeck.solver.solve_error import SolveError

# Groups between which is searched, where the solver is tested; the load also no further than the contact law holds.
BOX = {"speed": (1e-12, 1e6), "load": (1e-8, 10.0), "relative_roughness": (1e-6, 1e3)}

# What an input can be made at all [SI]: a speed from an atom's width in 100 s to that of sound, a fluid from gas to pitch,
# a roughness from that of atoms.  Roughness ends with the contact itself: see physical_bounds.
PHYSICAL = {"speed": (1e-12, 1e3), "viscosity": (1e-5, 1e8), "roughness": (1e-10, math.inf)}


class Search(NamedTuple):
    """How far and how finely the regimes of one geometry are searched."""

    lightest: float
    heaviest: Callable[[Contact], float]
    roughest: Callable[[Contact], float]
    largest_group: float  # Load group up to which the solver is tested, where the contact law allows it
    rtol: float  # Smallest tolerance of margins: a ball takes a tenth of a second or more for each state
    coarse: float  # Smallest tolerance of the curves on which they are looked for, before they are located


SEARCHES: dict[Geometry, Search] = {
    "line": Search(
        1e-6, lambda each: math.pi / 4 * each.modulus * each.radius, lambda each: each.hertz.half_width, 10.0, 0.0, 0.0
    ),
    "point": Search(
        1e-9, lambda each: 4 / 3 * each.modulus * each.radius**2, lambda each: each.hertz.indentation, 1e4, 3e-3, 1e-2
    ),
}


def scanned_rtol(contact: Contact, rtol: float) -> float:
    """Return the tolerance of margins."""
    return max(rtol, SEARCHES[contact.groups.geometry].rtol)


def physical_bounds(contact: Contact, name: str) -> tuple[float, float]:
    r"""Return between which values an input of a contact can be sought, whatever the model says beyond.

    .. math:: F_N \le \frac{\pi}{4} E^* R \text{ on the line}, \quad \frac43 E^* R^2 \text{ on the ball} \;\;(a \le R),
        \qquad h_\mathrm{rms} \le a \text{ and } u_\mathrm{Hz}
    """
    search = SEARCHES[contact.groups.geometry]
    if name == "load":
        low, high = search.lightest, search.heaviest(contact)
    else:
        low, high = PHYSICAL[name]
    if name == "roughness":
        high = search.roughest(contact)
    if name == "speed":
        slowest, fastest = known_speeds(contact)
        low, high = max(low, slowest), min(high, fastest)
    value = float(getattr(contact, name))
    return (min(low, value), max(high, value)) if value > 0 else (low, high)


def limits(contact: Contact, name: str) -> tuple[float, float]:
    """Return the logarithms of the factors of an input between which it is possible and the groups stay in the box."""
    groups = contact.groups
    highest = min(SEARCHES[groups.geometry].largest_group, largest_load(contact.law))
    box = BOX | {"load": (BOX["load"][0], highest)}
    n_speed, n_load, n_roughness = exponents_of(contact)[name]
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
    """Return the logarithms of the factors to the bounds of an input, of the speed also to those of the viscosity."""
    is_for_both = name == "speed" and not contact.friction_of_asperities.uses_speed
    names = ("speed", "viscosity") if is_for_both else (name,)
    ends = [(getattr(contact, each), physical_bounds(contact, each)) for each in names]
    return min(math.log(low / value) for value, (low, _) in ends), max(math.log(high / value) for value, (_, high) in ends)


def with_smallest(contact: Contact, name: Over) -> Contact:
    """Return the contact with the minimum speed or roughness of the box instead of zero."""
    groups = contact.replace(**{name: 1.0}).groups
    group = "speed" if name == "speed" else "relative_roughness"
    return contact.replace(**{name: BOX[group][0] / float(getattr(groups, group))})


REACH = 1e6  # Largest factor by which an input is changed

ROUNDING = 1e-9  # Difference of logarithms of values that are the same

# From load group 1 on the fluid's share may never fall below the bound of boundary lubrication, however slow the contact.
DECADE = math.log(10.0)  # Range of ln(speed) over whose slow end the share is extrapolated to slow speed
MAX_SHARE_CHANGE = 0.02  # Change of the share over half a decade from which it is extrapolated
SAFETY_OF_LIMIT = 1.5  # Factor by which its limit must exceed the bound for slower speeds not to be searched

SCANNED: tuple[Over, ...] = ("speed", "load", "roughness")


@dataclass(frozen=True)
class Crossing:
    """Where another regime begins along one input."""

    regime: Regime  # The regime that is entered
    value: float  # Value of the input there [SI]
    factor: float  # The same over its present value; infinite where that is zero
    interval_95: tuple[float, float] | None = None  # That of the factor, where inputs have errors


@dataclass(frozen=True)
class Margin:
    """The nearest changes of regime along one input, all other inputs kept."""

    name: str  # Speed, load, roughness or viscosity
    less: Crossing | None  # The first change with less of it, within what was searched
    more: Crossing | None  # The same with more of it
    searched: tuple[float, float]  # Values between which was searched [SI]: until a change, or where it can be no more

    def crossing_into(self, regime: str) -> Crossing | None:
        """Return the nearer crossing into a regime, or None."""
        found = [mark for mark in (self.less, self.more) if mark is not None and mark.regime == regime]
        return min(found, key=lambda mark: abs(math.log(mark.factor)) if 0 < mark.factor < math.inf else 0.0, default=None)


@dataclass
class Scan:
    """The search for changes of regime along one input after another."""

    contact: Contact
    present: Regime
    rtol: float
    definition: Definition
    on_point: Callable[[int, int], object] | None
    whole: FrictionPath | None = None  # The path of a curve over one of the inputs that is solved already
    state: RefinedState | None = None  # The contact's own state, where it is known
    done: int = 0

    def along(self, name: Over) -> Margin:
        """Return the changes along one input."""
        value, contact = float(getattr(self.contact, name)), self.contact
        if value == 0:
            found = self._from_zero(name)
        elif contact.speed == 0 or contact.friction_of_asperities.is_frictionless or contact.roughness == 0:
            found = Margin(name, None, None, (value, value))  # these hold the regime, whatever else changes
        else:
            (less, lowest), (more, highest) = self._outwards(contact, name, limits(contact, name))
            found = Margin(name, less, more, (lowest, highest))
        self.done += 1
        return found

    def _from_zero(self, name: Over) -> Margin:
        """Return the change with more of an input that is zero."""
        if self.contact.friction_of_asperities.is_frictionless or (name == "roughness" and self.contact.speed == 0):
            return Margin(name, None, None, (0.0, 0.0))
        if self.contact.roughness == 0 and name == "speed":
            return Margin(name, None, Crossing("hydrodynamic", 0.0, math.inf), (0.0, 0.0))
        start = with_smallest(self.contact, name)
        _, (more, highest) = self._outwards(start, name, (0.0, limits(start, name)[1]), math.inf)
        if more is not None:
            # A regime that the smallest value is in already begins at zero itself.
            more = Crossing(more.regime, more.value if more.value > getattr(start, name) else 0.0, math.inf)
        return Margin(name, None, more, (0.0, highest))

    def _outwards(
        self, start: Contact, name: Over, ways: tuple[float, float], reach: float = REACH
    ) -> list[tuple[Crossing | None, float]]:
        """Return the first change of regime on both ways, logarithms of factors, and up to which value it was searched."""
        value = float(getattr(start, name))
        here = math.log(value)
        ends = [here + math.copysign(min(abs(way), math.log(reach)), way) for way in ways]
        try:
            path = self._path(start, name, here, ends)
        except SolveError:
            return [(None, value), (None, value)]
        return [self._towards(path, value, end) for end in ends]

    def _path(self, start: Contact, name: Over, here: float, ends: list[float]) -> FrictionPath:
        """Return the path of a contact as far as it is known: its own state, or a curve that is solved already."""
        whole = self.whole
        if whole is not None and whole.source.coordinate.over == name and whole.source.rtol <= self.rtol:
            first, last = whole.source.ends
            is_inside = first - ROUNDING <= here <= last + ROUNDING
            if is_inside and whole.coefficients == (*coefficients(start, None, None), self.definition):
                return whole
        bounds, state = (math.exp(ends[0]), math.exp(ends[1])), self.state if start is self.contact else None
        path = begun(start, name, bounds, max(self.rtol, SEARCHES[start.groups.geometry].coarse), self.definition, state)
        if start is self.contact and isinstance(path.source, LineSource):
            self.state = path.source.state_at(here)
        return path

    def _towards(self, path: FrictionPath, value: float, end: float) -> tuple[Crossing | None, float]:
        """Return the first change of regime from a value to a coordinate, and the value up to which it was searched."""
        here = math.log(value)
        outward = math.copysign(1.0, end - here)

        def is_enough(found: FrictionPath) -> bool:
            begin = found.source.ends[:: int(outward)][0]
            return self._first_change(found, begin, _reached(found, end, outward)) is not None or _keeps_regime(found, outward)

        reached = float(np.clip(end, *path.source.ends))
        change = self._first_change(path, here, reached)
        if change is None and outward * (end - reached) > ROUNDING and not _keeps_regime(path, outward):
            try:
                path = path.continued(end, is_enough, self._report)
            except SolveError:
                return None, value * math.exp(reached - here)
            if path.source.outcome is Outcome.INTERRUPTED:
                raise KeyboardInterrupt
            begin, reached = reached, _reached(path, end, outward)
            change = self._first_change(path, begin, reached)
        if change is None:
            return None, value * math.exp(reached - here)
        regime, mark, event = change
        place = value if event is None else path.located(mark, event, min(path.source.accepted(None), self.rtol)).value
        return Crossing(regime, place, place / value), place

    def _report(self, low: float, high: float) -> None:
        if self.on_point is not None:
            self.on_point(self.done, len(SCANNED))

    def _first_change(self, path: FrictionPath, here: float, end: float) -> tuple[Regime, Transition, Event | None] | None:
        """Return the regime entered first on the way, the transition and where it is; nowhere if it is there already."""
        low, high = sorted((here, end))
        inside = [s for s in path.source.places.tolist() if low < s < high]
        places = np.array([here, *(inside if here < end else inside[::-1]), end])
        places, fluid, contact, viscous = path.known(places)
        first = REGIMES[int(regime_numbers(fluid[0], friction_share(contact[0], viscous[0])))]
        if first != self.present:
            return first, Transition.BOUNDARY_END, None
        hydrodynamic = path.first(Transition.HYDRODYNAMIC_START, places, fluid, contact, viscous)
        boundary = path.first(Transition.BOUNDARY_END, places, fluid, contact, viscous)
        if self.present == "hydrodynamic":  # whatever the fluid carries, while asperities cause little friction
            if hydrodynamic is None:
                return None
            share = float(path.parts(np.array([hydrodynamic.place]))[0][0])
            return "boundary" if share <= BOUNDARY_FLUID_SHARE else "mixed", Transition.HYDRODYNAMIC_START, hydrodynamic
        if hydrodynamic is not None and (boundary is None or abs(hydrodynamic.place - here) < abs(boundary.place - here)):
            return "hydrodynamic", Transition.HYDRODYNAMIC_START, hydrodynamic
        if boundary is None:
            return None
        return "boundary" if self.present == "mixed" else "mixed", Transition.BOUNDARY_END, boundary


def _reached(path: FrictionPath, end: float, outward: float) -> float:
    """Return how far a path leads towards an end, not beyond it: there the friction of asperities may be unknown."""
    return outward * min(outward * path.source.ends[1 if outward > 0 else 0], outward * end)


def _keeps_regime(path: FrictionPath, outward: float) -> bool:
    """Return whether no other regime can be beyond the end of a path."""
    if outward < 0 and _stays_mixed(path):
        return True
    places = path.source.places[:: int(outward)][-2:]
    read = path.source.read(places)
    contact, viscous, *_ = read.friction_terms(*path.coefficients)[-1]
    roughness = [path.source.coordinate.groups_at(s).relative_roughness for s in places.tolist()]
    films = read.values["minimum_gap"] / np.array(roughness)
    return bool(friction_share(contact, viscous) < EPSILON and films[-1] > films[0])  # less than the rounding of their sum


def _stays_mixed(path: FrictionPath) -> bool:
    """Return whether the fluid's share ends above its bound, extrapolated as a geometric series of half decades of speed."""
    first, last = path.source.ends
    if path.source.coordinate.over != "speed" or last - first < DECADE:
        return False
    slow, middle, fast = path.fluid_shares(first + DECADE * np.array([0.0, 0.5, 1.0])).tolist()
    first, second = fast - middle, middle - slow
    if not 0 <= second < min(first, MAX_SHARE_CHANGE):
        return False
    return bool(slow - second**2 / (first - second) > SAFETY_OF_LIMIT * BOUNDARY_FLUID_SHARE)


THRESHOLD = 5e-3  # Logarithm of the factor below which a contact is said to stand at the threshold

NEIGHBOURS: dict[Regime, tuple[Regime, ...]] = {
    "boundary": ("mixed",),
    "mixed": ("boundary", "hydrodynamic"),
    "hydrodynamic": ("mixed",),
}


@dataclass(frozen=True, repr=False)
class RegimeMargins(Told, Tabled):
    """A contact's regime and the way to its neighbours; its dataset has the changes of regime along ``crossing``."""

    regime: Regime  # The present one
    margins: tuple[Margin, ...]  # For speed, load, roughness and viscosity, as far as each has them
    notes: tuple[str, ...]  # Why an input leads nowhere, and whether the contact stands at a threshold
    geometry: Geometry = "line"
    counted: str = ""  # Which errors the intervals count and which inputs count as exact; empty without intervals

    def to_dict(self) -> dict[str, Any]:
        """Return the margins by input, ready for JSON."""
        table = INPUT_TABLES[self.geometry]
        return {margin.name: asdict(margin) | {"unit": table.quantities[margin.name].unit} for margin in self.margins}

    def _card(self) -> Card:
        return Card(f"{self.regime} lubrication", notes=self.notes, sentences=[*ways_to(self)])

    def _labelled(self) -> Labelled:
        table = INPUT_TABLES[self.geometry]
        found = [(margin.name, mark) for margin in self.margins for mark in (margin.less, margin.more) if mark is not None]
        marks = [mark for _, mark in found]
        ends = np.array([mark.interval_95 or (math.nan, math.nan) for mark in marks]).reshape(-1, 2)
        columns: dict[str, Column] = {
            "input": ("crossing", listed([name for name, _ in found]), "1", "input that is changed"),
            "next_regime": ("crossing", listed([mark.regime for mark in marks]), "1", "regime that is entered"),
            "value": ("crossing", [mark.value for mark in marks], "see unit", "value of the input there"),
            "unit": ("crossing", listed([table.quantities[name].unit for name, _ in found]), "1", "SI unit of the value"),
            "factor": ("crossing", [mark.factor for mark in marks], "1", "the same over the present value"),
            "factor_low_95": ("crossing", ends[:, 0], "1", "low end of the 95 % interval of factor"),
            "factor_high_95": ("crossing", ends[:, 1], "1", "high end of the 95 % interval of factor"),
        }
        number: dict[str, Column] = {"crossing": ("crossing", np.arange(len(found)), "1", "number of the change of regime")}
        about = {f"searched_{margin.name}": np.array(margin.searched) for margin in self.margins}
        words = {"regime": self.regime, "notes": "\n".join(self.notes), "counted": self.counted}
        return columns, number, {"title": "Margins to the next regimes", **about, **words}

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
    contact : LineContact or PointContact
        The contact.
    rtol : float
        Relative error of the states; not below 3e-3 for a ball.
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    on_point : callable, optional
        Called as the search goes on, with the number of inputs that are done and of all.
    curve : StribeckCurve, optional
        The curve of this contact over the speed, which saves solving it again.

    Returns
    -------
    RegimeMargins
        For each input the next regime with less and with more of it, the factor, and the value there [SI]. Each input is
        varied alone, by a factor of up to 1e6.

    Raises
    ------
    InputError
        If the contact has no units, or an argument is wrong.
    SolveError
        If the state of the contact cannot be solved.

    Examples
    --------
    >>> import stribeck as sb
    >>> contact = sb.LineContact(radius=0.01, modulus=2.7e6, load=30, viscosity=0.05, speed=0.02, roughness=1e-6, alpha=2,
    ...                          beta=0.06, boundary_friction=0.7)
    >>> speed = regime_margins(contact).margins[0]
    >>> print(speed.more.regime, f"{speed.more.value:.4f} m/s")
    hydrodynamic 0.0305 m/s
    """
    rtol = check_rtol(rtol)
    definition = check_definition(definition)
    if not isinstance(contact, Contact):
        raise InputError(f"contact = {show(contact)}; it must be a LineContact or PointContact, as margins are in SI units.")
    rtol = scanned_rtol(contact, rtol)
    path = None if curve is None else path_of(curve)
    scan = Scan(contact, "mixed", rtol, definition, on_point, path)
    if curve is not None and curve.values[0] <= contact.speed <= curve.values[-1]:
        there = curve.solve_at(contact.speed)
        if path is not None and isinstance(path.source, LineSource) and curve.rtol <= rtol:
            scan.state = path.source.state_at(math.log(contact.speed))
    else:
        there = solve(contact, rtol=rtol)
    scan.present = present = regime_of_state(there, definition)
    notes = []
    if contact.speed == 0 and contact.roughness > 0:
        notes.append("At zero speed, load, roughness and viscosity do not change the regime.")
    if contact.roughness == 0 and contact.speed > 0:
        notes.append("Smooth surfaces never touch: there is no boundary or mixed lubrication.")
    if contact.friction_of_asperities.is_frictionless:
        notes.append("Without dry friction, all friction is viscous and every state counts as hydrodynamic.")
    if contact.groups.load >= largest_load(contact.law) and contact.roughness > 0:
        notes.append(
            "At load groups of 1 or more, the fluid carries part of the load at every speed; there may be no "
            "boundary lubrication."
        )
    if contact.speed > 0 and follows_surface(contact, {"roughness"}):
        notes.append(
            "Margin and slope of the roughness keep beta, as if wavelengths grew with the height; levers of a report and "
            "propagated errors let beta follow."
        )
    scanned = SCANNED
    if contact.profile is not None:
        notes.append("Load has no margins: the contact of this profile grows with the load in its own way.")
        scanned = tuple(name for name in SCANNED if name != "load")
    found = [scan.along(name) for name in scanned]
    if contact.friction_of_asperities.uses_speed:
        notes.append("Viscosity has no margins: the stress of the asperities follows the speed, which does not stand for it.")
    elif contact.replace(viscosity=2 * contact.viscosity, speed=contact.speed / 2).groups.model == contact.groups.model:
        found.append(_within(_of_viscosity(contact, found[0]), physical_bounds(contact, "viscosity")))
    else:
        notes.append("Viscosity has no margins: speed, which acts otherwise on this fluid or body, does not stand for it.")
    if contact.speed > 0:
        found[0] = _within(found[0], physical_bounds(contact, "speed"))
    marks = [mark for margin in found for mark in (margin.less, margin.more) if mark is not None]
    close = [mark for mark in marks if 0 < mark.factor < math.inf and abs(math.log(mark.factor)) < THRESHOLD]
    if close:
        notes.append(f"The contact is at the threshold to {close[0].regime} lubrication.")
    return RegimeMargins(present, tuple(found), tuple(notes), contact.groups.geometry)


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
