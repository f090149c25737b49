"""The answer to a tab's inputs: the solved state with its fields, the curve through it and the phase diagram around it.

The state is solved anew for each change, from the last one. Curve and diagram are kept until something other than the speed
changes; outside the atlas both are solved when the inputs rest, and those before stand there meanwhile, marked stale.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics import FORMULAS
from stribeck.checks.check import Checks
from stribeck.checks.law import add_range_along_curve
from stribeck.checks.subject import Subject
from stribeck.checks.table import checks_of
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.model import BASE_MODEL
from stribeck.curves.regime import Regime, regime_of
from stribeck.explorer.curves import (
    FIRST_RTOL,
    SOLVED_ROWS,
    SOLVED_RTOL,
    Curve,
    Diagram,
    Report,
    Transition,
    axis_speeds,
    curve_from_atlas,
    curve_notes,
    decade_of_roughness,
    diagram_from_atlas,
    in_atlas,
    solved_curve,
    solved_diagram,
    transition_marks,
)
from stribeck.explorer.inputs.carried import errors_of, facts_of
from stribeck.explorer.inputs.inputs import Inputs
from stribeck.quantities.units import InputError
from stribeck.solver.base_solution import BaseSolution, Profile
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.point.solution import Field, PointSolution
from stribeck.solver.solution import Solution
from stribeck.solver.solve import solve
from stribeck.solver.solve_error import SolveError
from stribeck.uncertainty.band import friction_band
from stribeck.uncertainty.propagate import propagate
from stribeck.uncertainty.result import Uncertainty

__all__ = ["Answer", "Answerer", "AsymptoticField", "profile_reach", "round_down", "round_up", "asymptotic_fields"]

STATE_RTOL = 1e-6  # Relative tolerance of the state that the page shows.
PIN_RTOL = 1e-4  # Relative tolerance of the curve of a pinned contact.
KEPT_STATES = 8  # States from which the next one may start; those of balls hold megabytes
MAX_CACHED_ANSWERS = 64  # Answers that are kept for inputs that come back.
NEGLIGIBLE_SHARE = 0.01  # Load share below which asperities, or the fluid, count as absent when formulas are chosen.

FIELDS_DRAWN = ("gap", "pressure", "contact_pressure", "fluid_pressure")

MAP_HALF_SIDE = 1.6  # Half the side of the map of a ball [a].
MAP_POINTS = 49  # Points along a side of that map.

# Ends of axes, times powers of ten: few, so that axes stay still while a slider moves.
AXIS_ENDS = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0)

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class AsymptoticField:
    """An asymptotic field where it is in its range."""

    name: str  # The formula
    worst: float  # Its largest relative error in its range
    predicts: str  # The field
    x: Array  # In Hertz units
    value: Array  # In Hertz units


@dataclass(frozen=True, eq=False)
class Answer:
    """All that a tab shows."""

    inputs: Inputs  # What was asked
    solution: Solution | PointSolution  # The state
    regime: Regime  # Its regime
    checks: Checks  # Whether the model applies: those that the state decides, and at rest all
    notes: tuple[str, ...]  # What to know of the curve, as `stribeck curve` prints it; at rest
    spread: Uncertainty | None  # What the errors of the inputs leave open in the state; at rest, where some are given
    curve: Curve | None  # The curve through it, None where it cannot be solved
    diagram: Diagram | None  # The phase diagram around it, None where it is not solved yet
    reach: float  # How far the profile is drawn to both sides [a]
    profile: Profile  # The fields, in Hertz units
    plane: Field | None  # The fields on the plane of a ball, from the middle line on to one side, to which the other is equal
    thin: tuple[AsymptoticField, ...]  # Asymptotic fields
    speeds: tuple[float, float]  # Ends of the axis of speeds [m/s]

    @property
    def checks_with_curve(self) -> Checks:
        """The checks, and that of the contact law along the curve that is shown."""
        return self.checks if self.curve is None else add_range_along_curve(self.checks, self.curve.doubtful)


class Answerer:
    """Answers to the inputs of one tab, one after another; ``known`` is one that need not be found again."""

    def __init__(self, known: Answer | None = None) -> None:
        self._neighbours = Neighbours(STATE_RTOL, KEPT_STATES)
        self._last: tuple[Contact, Solution | PointSolution] | None = None
        self._kept: dict[Any, Any] = {}
        self._last_curves: dict[str, Curve] = {}
        self._last_diagrams: dict[str, Diagram] = {}
        if known is not None:
            self._last = known.inputs.contact, known.solution
            self._kept["checks", known.inputs.contact, known.inputs.rest] = known.checks
            if known.curve is not None:
                self._last_curves[known.inputs.table.geometry] = known.curve

    def __call__(self, inputs: Inputs, measured: Sequence[float] = ()) -> Answer:
        """Return the answer at once: outside the atlas with the last curve, marked stale, until :meth:`settle` ends."""
        contact, definition = inputs.contact, inputs.definition
        solution = self._state(inputs)
        friction = solution.friction(definition=definition)
        curve, speeds = self._curve_now(contact, definition, measured)
        band = self._kept.get(("band", _key(contact), definition, inputs.rest))
        if curve is not None and not curve.stale and band is not None:
            curve = replace(curve, band=band)
        reach = profile_reach(solution)
        x = np.linspace(-reach, reach, 241)
        nodes = solution.x[np.abs(solution.x) < reach]
        x = np.unique(np.concatenate([x, nodes[:: 1 + len(nodes) // 150]]))
        plane = None
        if isinstance(solution, PointSolution):
            side = np.linspace(-MAP_HALF_SIDE, MAP_HALF_SIDE, MAP_POINTS)
            plane = solution.field(side, side[MAP_POINTS // 2 :, None])
        return Answer(
            inputs=inputs,
            solution=solution,
            regime=regime_of(solution.fluid_load_share, friction.contact_share),
            checks=self._keep(("checks", contact, inputs.rest), lambda: self._checks(inputs, solution)),
            notes=self._kept.get(("notes", _key(contact), definition), ()),
            spread=self._kept.get(_spread_key(inputs)),
            curve=curve,
            diagram=self._diagram_now(contact, definition, speeds),
            reach=reach,
            profile=solution.profile(x),
            plane=plane,
            thin=tuple(asymptotic_fields(solution, reach)),
            speeds=speeds,
        )

    def settle(self, inputs: Inputs, report: Report, at_rest: bool = False) -> bool:
        """Solve the curve of inputs outside the atlas, first of all as the picture needs it."""
        contact, definition = inputs.contact, inputs.definition
        key, geometry = ("solved", _key(contact), definition), contact.INPUTS.geometry
        rtol = SOLVED_RTOL if at_rest else FIRST_RTOL[geometry]
        known: Curve | None = self._kept.get(key)
        if in_atlas(contact) or (key in self._kept and (known is None or known.solved is None or known.solved.rtol <= rtol)):
            return False
        try:
            found = solved_curve(contact, definition, report, rtol)
            self._kept.pop(key, None)
            self._keep(key, lambda: found)
        except (InputError, SolveError) as problem:
            if known is not None:  # the first one stays, with its error
                return False
            self._kept[key] = None
            self._kept["why", _key(contact), definition] = str(problem)
        return True

    def diagrams(self, inputs: Inputs, report: Report) -> Iterator[None]:
        """Solve the diagram of inputs outside the atlas row by row, and stop after each to show it."""
        contact, definition = inputs.contact, inputs.definition
        if in_atlas(contact):
            return
        _, speeds = self._curve_now(contact, definition)
        key = _diagram_key(contact, definition, speeds)
        if key in self._kept and self._kept[key].part == 1.0:
            return
        curve: Curve | None = self._kept.get(("solved", _key(contact), definition))
        own = None if curve is None else curve.solved
        for found in solved_diagram(contact, definition, speeds, decade_of_roughness(contact), report, own):
            self._kept[key] = self._last_diagrams[contact.INPUTS.geometry] = found
            yield

    @staticmethod
    def map_is_quick(inputs: Inputs) -> bool:
        """Return whether a diagram is there within a second, off the atlas too."""
        return SOLVED_ROWS[inputs.table.geometry].is_quick

    def settle_checks(self, inputs: Inputs, report: Report) -> bool:
        """Make the checks that need the curve, or another one; return whether they change the line above the numbers."""
        contact = inputs.contact
        key = ("checks", contact, inputs.rest)
        if ("all checks", *key) in self._kept:
            return False
        before = self._kept.get(key)
        facts = facts_of(inputs.rest)
        solution: Any = self._last[1] if self._last is not None and self._last[0] == contact else None
        subject = Subject(contact, facts, inputs.definition, solution, on_point=lambda done, of: report(done / of))
        self._kept[key] = checks_of(subject)
        self._kept["all checks", *key] = True
        return bool(self._kept[key] != before)

    def settle_notes(self, inputs: Inputs, report: Report) -> bool:
        """Find what to know of the curve over the speed; return whether there is something new to show."""
        contact, definition = inputs.contact, inputs.definition
        key = ("notes", _key(contact), definition)
        if key in self._kept:
            return False
        curve: Curve | None = self._kept.get(("solved", _key(contact), definition))
        if curve is None or curve.solved is None:
            notes = curve_notes(contact, definition, report)
        else:
            notes = curve.solved.notes
        self._keep(key, lambda: notes)
        return bool(notes)

    def settle_spread(self, inputs: Inputs, report: Report) -> bool:
        """Find what the errors of the inputs leave open in the state and along the curve; return whether some are given."""
        errors, key = errors_of(inputs.rest), _spread_key(inputs)
        contact, definition = inputs.contact, inputs.definition
        if not errors or key in self._kept:
            return False
        spread = propagate(contact, errors, definition=definition)
        self._keep(key, lambda: spread)
        curve, _ = self._curve_now(contact, definition)
        if curve is not None and not curve.stale:
            ends = curve.speed[[0, -1]]
            band = friction_band(contact, errors, ends, definition, on_point=lambda done, of: report(done / of))
            self._keep(("band", _key(contact), definition, inputs.rest), lambda: band)
        return True

    def why_no_curve(self, inputs: Inputs) -> str:
        """Return why a curve could not be solved; empty if it was, or was not tried."""
        return str(self._kept.get(("why", _key(inputs.contact), inputs.definition), ""))

    def curve(self, contact: Contact, definition: Definition, speeds: tuple[float, float]) -> Curve | None:
        """Return the curve of a contact between two speeds; outside the atlas the solved one, None until it is solved."""
        if not in_atlas(contact):
            found: Curve | None = self._kept.get(("solved", _key(contact), definition))
            return found
        marks = self._marks(contact, definition)
        return self._keep(("curve", _key(contact), definition, speeds), lambda: curve_from_atlas(contact, speeds, marks))

    def _state(self, inputs: Inputs) -> Solution | PointSolution:
        """Return the state, from the last one where that is near."""
        contact = inputs.contact
        if self._last is not None and self._last[0] == contact and self._last[1].rtol == inputs.rtol:
            return self._last[1]
        if self._neighbours.rtol != inputs.rtol:
            self._neighbours = Neighbours(inputs.rtol, KEPT_STATES)
        state: Solution | PointSolution = self._neighbours.solution(contact.groups, contact)
        self._last = contact, state
        return state

    def state_of_pin(self, contact: Contact) -> Solution | PointSolution:
        """Return the state of a contact that was pinned."""
        found: Solution | PointSolution = self._keep(("pin", contact, contact.law), lambda: solve(contact, rtol=PIN_RTOL))
        return found

    @staticmethod
    def _checks(inputs: Inputs, solution: Solution | PointSolution) -> Checks:
        subject = Subject(inputs.contact, facts_of(inputs.rest), inputs.definition, solved=solution)  # type: ignore[arg-type]
        return checks_of(subject, "state")

    def _marks(self, contact: Contact, definition: Definition) -> tuple[Transition, ...]:
        return self._keep(("marks", _key(contact), definition), lambda: transition_marks(contact, definition))

    def _curve_now(
        self, contact: Contact, definition: Definition, measured: Sequence[float] = ()
    ) -> tuple[Curve | None, tuple[float, float]]:
        """Return the curve and the ends of its axis."""
        geometry = contact.INPUTS.geometry
        speeds = axis_speeds(contact, self._marks(contact, definition), measured) if in_atlas(contact) else (0.0, 0.0)
        curve = self.curve(contact, definition, speeds)
        last = self._last_curves.get(geometry)
        if curve is not None:
            self._last_curves[geometry] = curve
        elif last is not None:
            curve = replace(last, stale=True, transitions=())
        if in_atlas(contact):
            return curve, speeds
        if curve is None:
            speed = contact.speed or 1e-3
            return None, (1e-4 * speed, 1e4 * speed)
        ends = [float(curve.speed[0]), float(curve.speed[-1]), *([contact.speed] if contact.speed > 0 else [])]
        return curve, (10.0 ** math.floor(math.log10(min(ends))), 10.0 ** math.ceil(math.log10(max(ends))))

    def _diagram_now(self, contact: Contact, definition: Definition, speeds: tuple[float, float]) -> Diagram | None:
        """Return the diagram; outside the atlas what is solved of it, or the last one, marked stale."""
        key = _diagram_key(contact, definition, speeds)
        geometry = contact.INPUTS.geometry
        if in_atlas(contact):
            decade = decade_of_roughness(contact)
            read = self._keep(key, lambda: diagram_from_atlas(contact, definition, speeds, decade))
            self._last_diagrams[geometry] = read
            return read
        found: Diagram | None = self._kept.get(key)
        last = self._last_diagrams.get(geometry)
        return replace(last, stale=True) if found is None and last is not None else found

    def _keep(self, key: Any, make: Callable[[], T]) -> T:
        if key not in self._kept:
            while len(self._kept) >= MAX_CACHED_ANSWERS:
                del self._kept[next(iter(self._kept))]
            self._kept[key] = make()
        found: T = self._kept[key]
        return found


def _key(contact: Contact, *without: str) -> tuple[Any, ...]:
    """Return all inputs, law and parts of a contact but the speed, and but what else is named."""
    return tuple(getattr(contact, each.name) for each in fields(contact) if each.name not in ("speed", *without))


def _spread_key(inputs: Inputs) -> tuple[Any, ...]:
    """Return what the propagated errors of a state depend on."""
    return ("spread", inputs.contact, inputs.definition, inputs.rest)


def _diagram_key(contact: Contact, definition: Definition, speeds: tuple[float, float]) -> tuple[Any, ...]:
    """Return what a diagram depends on: all but speed and roughness, and its axes."""
    return ("diagram", _key(contact, "roughness"), definition, speeds, decade_of_roughness(contact))


def round_up(value: float) -> float:
    """Return the next larger end of an axis."""
    power = 10.0 ** math.floor(math.log10(value))
    return float(f"{next(step for step in AXIS_ENDS if step * power >= value * (1 - 1e-9)) * power:.6g}")


def round_down(value: float) -> float:
    """Return the next smaller end of an axis."""
    power = 10.0 ** math.floor(math.log10(value))
    return float(f"{next(step for step in AXIS_ENDS[::-1] if step * power <= value * (1 + 1e-9)) * power:.6g}")


def profile_reach(solution: BaseSolution) -> float:
    """Return how far the profile is drawn to both sides: as far as the pressures reach, to a round number of metres [a]."""
    reach = 1.8
    if isinstance(solution, Solution):
        pressure = np.abs(solution.contact_pressure) + np.abs(solution.fluid_pressure)
        reach = max(1.6, 1.25 * float(np.abs(solution.x[pressure > 0.02 * pressure.max()]).max(initial=0.0)))
    a = 1.0 if solution.contact is None else solution.contact.hertz.half_width
    return round_up(a * reach) / a


def asymptotic_fields(solution: BaseSolution, reach: float) -> list[AsymptoticField]:
    """Return the asymptotic fields whose range holds the state."""
    groups = solution.groups
    if groups.geometry != "line" or groups.model != BASE_MODEL:
        return []
    absent = {"smooth": solution.contact_load_share, "rest": solution.fluid_load_share, "mixed": 0.0}
    found = []
    for formula in FORMULAS:
        if formula.predicts not in FIELDS_DRAWN or formula.interval is None or absent[formula.plane] >= NEGLIGIBLE_SHARE:
            continue
        if not bool(formula.valid(groups)):
            continue
        low, high = formula.interval(groups)
        x = np.linspace(max(low, -reach), min(high, reach), 121)
        if formula.predicts == "gap" and formula.plane == "rest" and low < 0 < high:
            x = x[1:-1]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            value = np.asarray(formula(groups, x))
        if np.isfinite(value).all():
            found.append(AsymptoticField(formula.name, formula.worst, formula.predicts, x, value))
    return found
