"""The answer to a tab's inputs: the solved state with its fields, the curve through it and the map of regimes around it.

The state is solved anew for each change, from the last one. What takes longer is solved when the inputs rest, part by part;
what belongs to the inputs before stands there meanwhile and is marked stale.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import Any, TypeVar

import numpy as np

from stribeck._types import Array
from stribeck.checks.check import Checks
from stribeck.checks.subject import Subject
from stribeck.checks.table import checks_of
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, Regime, regime_of
from stribeck.explorer import curves
from stribeck.explorer.curves import Curve, Diagram, Report
from stribeck.explorer.inputs.inputs import Inputs
from stribeck.explorer.uploads import Measured
from stribeck.quantities.units import InputError
from stribeck.regimes.margin_intervals import with_intervals
from stribeck.regimes.margins import RegimeMargins, regime_margins
from stribeck.solver.base_solution import BaseSolution
from stribeck.solver.fields import Field, Profile
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.point.solution import PointSolution
from stribeck.solver.solution import Solution
from stribeck.solver.solve import solve
from stribeck.solver.solve_error import SolveError
from stribeck.uncertainty.propagate import friction_band, propagate
from stribeck.uncertainty.result import Uncertainty

PIN_RTOL = 1e-4  # Relative tolerance of the state of a pinned contact.
KEPT_STATES = 8  # States from which the next one may start; those of balls hold megabytes
MAX_KEPT = 64  # Parts of answers that are kept for inputs that come back.

MAP_HALF_SIDE = 1.6  # Half the side of the map of a ball [a].
MAP_POINTS = 49  # Points along a side of that map.

NO_MARGINS_OF_BALLS = "Margins of a ball take ten seconds to a minute; run stribeck regimes."

T = TypeVar("T")
Part = Callable[[Report], Iterator[None]]  # Slow work, which stops whenever there is something new to show


@dataclass(frozen=True, eq=False)
class Pinned:
    """A contact that was kept for comparison."""

    name: str  # What it is called
    contact: Contact
    definition: Definition
    curve: Curve | None  # Its curve, as far as it is known
    state: BaseSolution


@dataclass(frozen=True, eq=False)
class Answer:
    """All that a tab shows."""

    inputs: Inputs  # What was asked
    solution: Solution | PointSolution  # The state
    regime: Regime  # Its regime
    checks: Checks  # Whether the model applies: what the state decides, and at rest all
    spread: Uncertainty | None  # What the errors of the inputs leave open in the state; at rest, where some are given
    curve: Curve | None  # The curve through it
    why: str  # Why the curve could not be solved
    diagram: Diagram | None  # The map of regimes around it
    margins: RegimeMargins | str | None  # The margins to the next regimes, or why there are none
    stale: frozenset[str]  # Which of these three, and of the checks, are not there yet, or belong to inputs before the present
    profile: Profile  # The fields, in Hertz units
    plane: Field | None  # The fields on the plane of a ball, from the middle line on to one side, to which the other is equal
    speeds: tuple[float, float]  # Ends of the axis of speeds [m/s]
    pins: Sequence[Pinned] = ()  # Pinned contacts
    measured: Sequence[Measured] = ()  # Measured curves


class Answerer:
    """Answers to the inputs of one tab, one after another."""

    def __init__(self) -> None:
        self._neighbours = Neighbours(1e-6, KEPT_STATES)
        self._last_state: tuple[Contact, Solution | PointSolution] | None = None
        self._kept: dict[Any, Any] = {}
        self._last: dict[tuple[str, str], Any] = {}

    def __call__(self, inputs: Inputs, pins: Sequence[Inputs] = (), measured: Sequence[Measured] = ()) -> Answer:
        """Return the answer at once, with the last curve where a new one has to be solved."""
        contact, definition, geometry = inputs.contact, inputs.case.definition, inputs.table.geometry
        solution = self._state(inputs)
        marks = self._marks(contact, definition) if curves.in_atlas(contact) else None
        places = [place for found in measured for place in found.places(contact, inputs.abscissa).tolist() if place > 0]
        ends = (0.0, 0.0) if marks is None else curves.decades_around(curves.axis_speeds(contact, marks), places)
        found = self.curve(contact, definition, ends)
        curve, is_old = self._newest("curve", geometry, found)
        if marks is None:
            ends = curves.decades_around(_ends_of(curve, contact), places)
        curve_band = self._kept.get(("band", _key(contact), definition, inputs.known))
        if curve is not None:
            curve = replace(curve, marks={}) if is_old else curve if curve_band is None else replace(curve, band=curve_band)
        key = _diagram_key(inputs, _ends_of(found, contact) if marks is None else ends)
        if marks is not None:
            self._keep(key, lambda: curves.diagram_from_atlas(contact, definition, ends, curves.decade_of_roughness(contact)))
        diagram, is_old_diagram = self._newest("diagram", geometry, self._kept.get(key))
        margins, is_old_margins = self._newest("margins", geometry, self._kept.get(_known_key("margins", inputs)))
        of_state = partial(checks_of, _subject(inputs, solution), "state")
        checks, are_some = self._keep(_known_key("checks", inputs), lambda: (of_state(), True))
        old = {"curve": is_old, "diagram": is_old_diagram, "margins": is_old_margins, "checks": are_some}
        plane = None
        if isinstance(solution, PointSolution):
            side = np.linspace(-MAP_HALF_SIDE, MAP_HALF_SIDE, MAP_POINTS)
            plane = solution.field(side, side[MAP_POINTS // 2 :, None])
        return Answer(
            inputs=inputs,
            solution=solution,
            regime=regime_of(solution.fluid_load_share, solution.friction(definition=definition).contact_share),
            checks=checks,
            spread=self._kept.get(_known_key("spread", inputs)),
            curve=curve,
            why=str(self._kept.get(("why", _key(contact), definition), "")),
            diagram=diagram,
            margins=margins,
            stale=frozenset(name for name, is_stale in old.items() if is_stale),
            profile=solution.profile(_places(solution)),
            plane=plane,
            speeds=ends,
            pins=[self._pinned(pin, ends) for pin in pins],
            measured=measured,
        )

    def at_rest(self, inputs: Inputs, pins: Sequence[Inputs] = ()) -> list[Part]:
        """Return what is to be solved for inputs that rest, the first part at once, and for the pinned contacts."""
        geometry = inputs.table.geometry
        drawn = [partial(self._solve_curve, inputs, rtol) for rtol in (curves.FIRST_RTOL[geometry], curves.SOLVED_RTOL)]
        slow = [partial(each, inputs) for each in (self._find_margins, self._find_spread, self._find_checks)]
        slow += [partial(self._solve_curve, pin, curves.SOLVED_RTOL) for pin in pins]  # a link has no curves, only contacts
        diagram = partial(self._solve_diagram, inputs)
        return [*drawn, diagram, *slow] if curves.SOLVED_ROWS[geometry].is_quick else [*drawn, *slow, diagram]

    def curve(self, contact: Contact, definition: Definition, speeds: tuple[float, float]) -> Curve | None:
        """Return the curve of a contact between two speeds; outside the atlas the solved one, None until it is solved."""
        if not curves.in_atlas(contact):
            found: Curve | None = self._kept.get(("solved", _key(contact), definition))
            return found
        marks = self._marks(contact, definition)
        key = ("curve", _key(contact), definition, speeds)
        return self._keep(key, lambda: curves.curve_from_atlas(contact, definition, speeds, marks))

    def _solve_curve(self, inputs: Inputs, rtol: float, report: Report) -> Iterator[None]:
        """Solve the curve of inputs outside the atlas, unless it is known as finely."""
        contact, definition = inputs.contact, inputs.case.definition
        key, why = ("solved", _key(contact), definition), ("why", _key(contact), definition)
        known: Curve | None = self._kept.get(key)
        if curves.in_atlas(contact) or why in self._kept or (known is not None and known.found.rtol <= rtol):
            return
        try:
            self._put(key, curves.solved_curve(contact, definition, report, rtol))
        except (InputError, SolveError) as problem:
            if known is None:  # else the first one stays, with its error
                self._put(why, str(problem))
        yield

    def _solve_diagram(self, inputs: Inputs, report: Report) -> Iterator[None]:
        """Solve the map of inputs outside the atlas row by row."""
        contact, definition = inputs.contact, inputs.case.definition
        if curves.in_atlas(contact):
            return
        known: Curve | None = self.curve(contact, definition, (0.0, 0.0))
        speeds = _ends_of(known, contact)
        key = _diagram_key(inputs, speeds)
        if key in self._kept and self._kept[key].part == 1.0:
            return
        for found in curves.solved_diagram(contact, definition, speeds, curves.decade_of_roughness(contact), report):
            self._put(key, found)
            yield

    def _find_margins(self, inputs: Inputs, report: Report) -> Iterator[None]:
        """Find the margins to the next regimes."""
        key = _known_key("margins", inputs)
        if key in self._kept:
            return
        contact, definition = inputs.contact, inputs.case.definition
        try:
            if inputs.table.geometry == "point":
                raise InputError(NO_MARGINS_OF_BALLS)
            found = regime_margins(contact, definition=definition, on_point=_parts(report))
            self._put(key, with_intervals(contact, found, inputs.case.errors, definition) if inputs.case.errors else found)
        except (InputError, SolveError) as problem:
            self._put(key, str(problem))
        yield

    def _find_spread(self, inputs: Inputs, report: Report) -> Iterator[None]:
        """Find what the errors of the inputs leave open in the state, and then along the curve."""
        errors, contact, definition = inputs.case.errors, inputs.contact, inputs.case.definition
        if not errors or _known_key("spread", inputs) in self._kept:
            return
        self._put(_known_key("spread", inputs), propagate(contact, errors, definition=definition))
        yield
        speeds = curves.axis_speeds(contact, self._marks(contact, definition)) if curves.in_atlas(contact) else (0.0, 0.0)
        curve = self.curve(contact, definition, speeds)
        if curve is not None:
            band = friction_band(contact, errors, curve.speed[[0, -1]], definition, on_point=_parts(report))
            self._put(("band", _key(contact), definition, inputs.known), band)
            yield

    def _find_checks(self, inputs: Inputs, report: Report) -> Iterator[None]:
        """Make the checks that need the curve, or another one."""
        key, last = _known_key("checks", inputs), self._last_state
        _, are_some = self._kept.get(key, (None, True))
        if are_some:
            solution = last[1] if last is not None and last[0] == inputs.contact else None
            self._put(key, (checks_of(_subject(inputs, solution, report)), False))
            yield

    def _state(self, inputs: Inputs) -> Solution | PointSolution:
        """Return the state, from the last ones where these are near."""
        contact = inputs.contact
        if self._last_state is not None and self._last_state[0] == contact and self._last_state[1].rtol == inputs.case.rtol:
            return self._last_state[1]
        if self._neighbours.rtol != inputs.case.rtol:
            self._neighbours = Neighbours(inputs.case.rtol, KEPT_STATES)
        state: Solution | PointSolution = self._neighbours.solution(contact.groups, contact)
        self._last_state = contact, state
        return state

    def _pinned(self, pin: Inputs, speeds: tuple[float, float]) -> Pinned:
        contact, definition = pin.contact, pin.case.definition
        state = self._keep(("pin", contact), lambda: solve(contact, rtol=PIN_RTOL))
        return Pinned(pin.case.title, contact, definition, self.curve(contact, definition, speeds), state)

    def _marks(self, contact: Contact, definition: Definition) -> Any:
        return self._keep(("marks", _key(contact), definition), lambda: curves.transition_marks(contact, definition))

    def _newest(self, kind: str, geometry: str, found: T | None) -> tuple[T | None, bool]:
        """Return what was found, or else the last of its kind; and whether it is stale."""
        if found is not None:
            self._last[kind, geometry] = found
        last: T | None = self._last.get((kind, geometry))
        return last, found is None

    def _keep(self, key: Any, make: Callable[[], T]) -> T:
        if key not in self._kept:
            self._put(key, make())
        found: T = self._kept[key]
        return found

    def _put(self, key: Any, value: Any) -> None:
        while len(self._kept) >= MAX_KEPT:
            del self._kept[next(iter(self._kept))]
        self._kept[key] = value


def _subject(inputs: Inputs, solution: Any, report: Report = lambda part: None) -> Subject:
    """Return what is checked of inputs, whose state may be known."""
    return Subject(inputs.contact, inputs.case.facts, inputs.case.definition, solution, on_point=_parts(report))


def _parts(report: Report) -> Callable[..., object]:
    """Return a report of the finished part as one of how many are done of how many."""
    return lambda done=0, of=1, *_: report(done / (of or 1))


def _key(contact: Contact, *without: str) -> tuple[Any, ...]:
    """Return all inputs, law and parts of a contact but the speed, and but what else is named."""
    return tuple(getattr(contact, each.name, None) for each in fields(contact) if each.name not in ("speed", *without))


def _known_key(what: str, inputs: Inputs) -> tuple[Any, ...]:
    """Return what checks, margins and the propagated errors of a state depend on."""
    return (what, inputs.contact, inputs.case.definition, inputs.known)


def _diagram_key(inputs: Inputs, speeds: tuple[float, float]) -> tuple[Any, ...]:
    """Return what a map depends on: all but speed and roughness, and its axes."""
    contact = inputs.contact
    return ("diagram", _key(contact, "roughness"), inputs.case.definition, speeds, curves.decade_of_roughness(contact))


def _ends_of(curve: Curve | None, contact: Contact) -> tuple[float, float]:
    """Return whole decades of speed around a solved curve and the contact."""
    if curve is None:
        speed = contact.speed or 1e-3
        return 1e-4 * speed, 1e4 * speed
    ends = [*curve.speed[[0, -1]].tolist(), *([contact.speed] if contact.speed > 0 else [])]
    return 10.0 ** math.floor(math.log10(min(ends))), 10.0 ** math.ceil(math.log10(max(ends)))


def _places(solution: BaseSolution) -> Array:
    """Return where fields are drawn [a]: as far as the pressures reach, to a round number of metres, and through nodes."""
    reach = 1.8
    if isinstance(solution, Solution):
        pressure = np.abs(solution.contact_pressure) + np.abs(solution.fluid_pressure)
        reach = max(1.6, 1.25 * float(np.abs(solution.x[pressure > 0.02 * pressure.max()]).max(initial=0.0)))
    assert solution.contact is not None
    a = solution.contact.hertz.half_width
    reach = curves.round_up(a * reach) / a
    nodes = solution.x[np.abs(solution.x) < reach]
    return np.unique(np.concatenate([np.linspace(-reach, reach, 241), nodes[:: 1 + len(nodes) // 150]]))
