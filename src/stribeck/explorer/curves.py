"""Friction along the speed and the regimes around it: curve, transitions and phase diagram of a contact.

All are read off the atlas where it holds; else the curve is solved, and the diagram row by row.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.atlas.tables import table_for
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import DEFINITIONS, Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Groups
from stribeck.curves import regime
from stribeck.curves.atlas_curve import where_law_is_in_doubt
from stribeck.curves.stribeck_curve import StribeckCurve, stribeck_curve
from stribeck.quantities.units import InputError
from stribeck.regimes.phase_from_atlas import transition_speeds
from stribeck.solver.solve_error import SolveError
from stribeck.uncertainty.band import Band

__all__ = [
    "Curve",
    "Diagram",
    "Transition",
    "axis_speeds",
    "curve_from_atlas",
    "curve_notes",
    "decade_of_roughness",
    "diagram_from_atlas",
    "hersey_scale",
    "in_atlas",
    "solve_curve",
    "solved_curve",
    "solved_diagram",
    "transition_marks",
]

CURVE_POINTS = 121  # Points at which a curve is shown.
DIAGRAM_ROWS = 33  # Roughnesses of a diagram.

SOLVED_RTOL = 1e-4  # Relative tolerance of curves that are solved.
# Tolerance of the first curve for new inputs, by geometry: less than a tenth of a pixel; at 1e-3 some take more states.
FIRST_RTOL = {"line": 5e-4, "point": SOLVED_RTOL}

# Points of curves that are solved, by geometry; of a ball each point is a state where it is no function.
SOLVED_POINTS = {"line": CURVE_POINTS, "point": 15}


# Points of the curve that is solved for its notes and its picture where the page reads it off the atlas, by geometry.
PRINTED_POINTS = {"line": 101, "point": 41}


class SolvedRows(NamedTuple):
    """How a diagram of one geometry is solved."""

    step: int  # One of how many of the :data:`DIAGRAM_ROWS` roughnesses is solved
    points: int  # Points of a row
    rtol: float  # Tolerance of its states
    room: float = 1.0  # Factor by which rows go on beyond the ends of the axis, so that lines can leave it between two rows
    is_quick: bool = False  # Whether it comes before margins and checks, which need not wait for it long


# Plan of a solved diagram by geometry.  Monotone cubics between rows three quarters of a decade apart miss the speeds by up to
# 4 %, less than a pixel; straight lines do so between rows half a decade apart.
SOLVED_ROWS = {"line": SolvedRows(8, 25, 1e-3, room=10.0, is_quick=True), "point": SolvedRows(8, 9, 1e-3)}

SPEED_POWERS = (1.0, 2.6)  # Least and largest power of the roughness as which the speeds of transitions grow.
SPEED_MARGIN = 2.0  # Factor by which a row goes on beyond the speeds that these powers predict.

Report = Callable[[float], object]  # Callback with the finished part; an exception that it raises ends the work.


@dataclass(frozen=True)
class Transition:
    """Where along the speed a regime ends."""

    name: str  # `"boundary"`, `"hydrodynamic"` or `"minimum"`
    speed: float  # Speed there [m/s]
    error: float  # Relative error of the speed; nan where it is not known [-]


@dataclass(frozen=True, eq=False)
class Curve:
    """Friction along the speed."""

    speed: Array  # Speeds [m/s]
    friction: Mapping[Definition, Array]  # Friction coefficient by definition [-]
    contact: Array  # Part of it from asperities [-]
    transitions: tuple[Transition, ...]  # Those on it, and those beyond its ends
    source: str  # Where it comes from, with its error
    stale: bool = False  # Whether it belongs to inputs before the present ones
    solved: StribeckCurve | None = None  # The solved curve that it shows; None off the atlas
    doubtful: Array = field(default_factory=lambda: np.zeros(0, bool))
    band: Band | None = None  # What the errors of the inputs leave open, where some are given

    def transition(self, name: str) -> Transition | None:
        """Return the transition of a name, or None."""
        return next((mark for mark in self.transitions if mark.name == name), None)


@dataclass(frozen=True, eq=False)
class Diagram:
    """Regimes over speed and roughness at the load of the contact."""

    roughness: Array  # Roughnesses [m]
    boundary: Array
    hydrodynamic: Array
    minimum: Array
    stale: bool = False  # Whether it belongs to inputs before the present ones
    part: float = 1.0  # How much of its rows is there [-]


def hersey_scale(contact: Contact) -> float:
    """Return the Hersey number at 1 m/s."""
    return 1.0 / RULES[contact.groups.geometry].hersey(contact)


def _group_per_unit(contact: Contact, name: str) -> float:
    """Return the speed or roughness group at 1 m/s or 1 m."""
    value = getattr(contact, name)
    groups = contact.groups if value else contact.replace(**{name: 1.0}).groups
    return float(getattr(groups, name)) / (value or 1.0)


def in_atlas(contact: Contact) -> bool:
    """Return whether the atlas covers the contact law, the load and the roughness of a contact."""
    return bool(atlas.covers(replace(contact.groups, speed=0.0)))


def transition_marks(contact: Contact, definition: Definition) -> tuple[Transition, ...]:
    """Return the transitions along the speed, ascending, from the atlas."""
    if contact.roughness == 0 or contact.boundary_friction == 0:
        return ()
    groups, unit = contact.groups, _group_per_unit(contact, "speed")
    boundary_friction, beta = contact.boundary_friction, contact.beta
    found = transition_speeds(groups, boundary_friction, beta, definition, **RULES[groups.geometry].motion(contact))
    marks = [
        Transition(name, float(getattr(found, name)[0]) / unit, float(found.error[i, 0]))
        for i, name in enumerate(("boundary", "hydrodynamic", "minimum"))
    ]
    return tuple(sorted((mark for mark in marks if 0 < mark.speed < math.inf), key=lambda mark: mark.speed))


def axis_speeds(contact: Contact, marks: Sequence[Transition], measured: Sequence[float] = ()) -> tuple[float, float]:
    """Return whole decades of speed [m/s] around the contact, its transitions and measured speeds, within the table."""
    unit = _group_per_unit(contact, "speed")
    places = [mark.speed for mark in marks] or [1e-8 / unit, 1.0 / unit]
    places += [contact.speed] if contact.speed > 0 else []
    low, high = 10.0 ** math.floor(math.log10(min(places)) - 0.7), 10.0 ** math.ceil(math.log10(max(places)) + 0.7)
    if len(measured):
        low = min(low, 10.0 ** math.floor(math.log10(min(measured)) + 1e-9))
        high = max(high, 10.0 ** math.ceil(math.log10(max(measured)) - 1e-9))
    row = atlas.for_groups(contact.groups)
    if row is None:
        return low, high
    lowest, highest = (end / unit for end in row.speeds(contact.groups))
    return max(low, lowest), min(high, highest)


def curve_from_atlas(contact: Contact, speeds: tuple[float, float], marks: tuple[Transition, ...]) -> Curve:
    """Return a curve read off the atlas."""
    groups, unit, boundary_friction = contact.groups, _group_per_unit(contact, "speed"), contact.boundary_friction
    speed = np.geomspace(*speeds, CURVE_POINTS)
    row = table_for(groups)
    along = Groups(np.clip(speed * unit, *row.speeds(groups)), groups.load, groups.roughness, **groups.physics)
    rule = RULES[groups.geometry]
    inputs = rule.of_contact(contact)
    terms = {kind: atlas.friction_terms(along, inputs, kind) for kind in DEFINITIONS}
    solid = boundary_friction * float(rule.sliding_factor(groups, inputs)) * terms["balanced"][0]
    friction = {kind: solid + viscous for kind, (_, viscous) in terms.items()}
    doubtful = where_law_is_in_doubt(along, contact, terms["balanced"][1])
    return Curve(speed, friction, solid, marks, f"from the lookup table, within {_power(row.error)}", doubtful=doubtful)


def curve_notes(contact: Contact, definition: Definition, report: Report) -> tuple[str, ...]:
    """Return what ``stribeck curve`` says of the curve of a contact that the page reads off the atlas."""
    try:
        return solve_curve(contact, definition, report, PRINTED_POINTS[contact.INPUTS.geometry], SOLVED_RTOL).notes
    except (InputError, SolveError) as problem:
        return (str(problem),)


def solve_curve(
    contact: Contact,
    definition: Definition,
    report: Report,
    points: int,
    rtol: float,
    speeds: tuple[float, float] | None = None,
) -> StribeckCurve:
    """Return the Stribeck curve of a contact and report the finished part."""
    return stribeck_curve(
        contact,
        speed=speeds,
        points=points,
        rtol=rtol,
        definition=definition,
        on_point=lambda done, of: report(done / of),
    )


def solved_curve(
    contact: Contact,
    definition: Definition,
    report: Report,
    rtol: float = SOLVED_RTOL,
) -> Curve:
    """Return a curve of solved states, with the transitions located on them."""
    found = solve_curve(contact, definition, report, SOLVED_POINTS[contact.INPUTS.geometry], rtol)
    if len(found) < 2:
        raise SolveError(found.outcome, None, found.outcome.value)
    if len(found) < CURVE_POINTS:
        found = found.sampled(CURVE_POINTS)
    speed = np.asarray(found.values)
    doubtful = found.law_in_doubt
    friction = {kind: found.friction(definition=kind) for kind in DEFINITIONS}
    contact_part = np.asarray(friction[definition].contact)
    totals: dict[Definition, Array] = {kind: np.asarray(friction[kind]) for kind in DEFINITIONS}
    source = f"solved; estimated error {_power(found.error_estimate)}"
    return Curve(speed, totals, contact_part, _marks_of(found), source, solved=found, doubtful=doubtful)


def _interpolate(speed: Array, values: Array, at: Array) -> Array:
    """Return values between those at some speeds, in logarithms unless some are negative."""
    from scipy.interpolate import PchipInterpolator

    if (values < 0).any():
        return np.asarray(PchipInterpolator(np.log(speed), values)(np.log(at)))
    tiny = 1e-300
    return np.exp(PchipInterpolator(np.log(speed), np.log(np.maximum(values, tiny)))(np.log(at)))


# Transitions of a curve that are shown.
SHOWN_TRANSITIONS = {
    "boundary": regime.Transition.BOUNDARY_END,
    "minimum": regime.Transition.MINIMUM,
    "hydrodynamic": regime.Transition.HYDRODYNAMIC_START,
}


def _marks_of(found: StribeckCurve) -> tuple[Transition, ...]:
    """Return where the regimes of a solved curve end, within what its own tolerance leaves open."""
    marks = [(name, found.landmark(mark, found.rtol)) for name, mark in SHOWN_TRANSITIONS.items()]
    known = [Transition(name, mark.value, mark.error) for name, mark in marks if mark is not None]
    return tuple(sorted(known, key=lambda mark: mark.speed))


def solved_diagram(
    contact: Contact,
    definition: Definition,
    speeds: tuple[float, float],
    decade: int,
    report: Report,
    own_curve: StribeckCurve | None = None,
) -> Iterator[Diagram]:
    """Give the diagram at the load of a contact as its rows are solved, those beside the contact first."""
    step = SOLVED_ROWS[contact.INPUTS.geometry].step
    shown = np.geomspace(10.0**decade, 10.0 ** (decade + 3), DIAGRAM_ROWS)
    roughness = shown[::step]
    shown = shown[: step * (len(roughness) - 1) + 1]
    lines = np.full((3, len(roughness)), math.nan)
    own = contact.roughness or roughness[0]
    order = sorted(range(len(roughness)), key=lambda i: abs(math.log(roughness[i] / own)))
    solved = {} if own_curve is None else {own: own_curve}
    for number, i in enumerate(order):
        here = float(roughness[i])
        near = solved[min(solved, key=lambda other: abs(math.log(other / here)))] if solved else None  # noqa: B023
        try:
            lines[:, i], solved[here] = _row(contact.replace(roughness=here), definition, speeds, report, near)
        except (SolveError, InputError):
            pass  # its row stays empty
        with np.errstate(divide="ignore", invalid="ignore"):  # a line may be at zero, at infinity, or missing
            between = np.exp([np.interp(np.log(shown), np.log(roughness), np.log(line)) for line in lines])
        for drawn, solved_speeds in zip(between, lines, strict=True):
            known, inside = (np.isfinite(each) & (each > 0) for each in (solved_speeds, drawn))
            if known.sum() > 2:
                drawn[inside] = _interpolate(roughness[known], solved_speeds[known], shown[inside])
        yield Diagram(shown, between[0], between[1], between[2], part=(number + 1) / len(order))


def _row(
    contact: Contact, definition: Definition, speeds: tuple[float, float], report: Report, neighbour: StribeckCurve | None
) -> tuple[tuple[float, float, float], StribeckCurve]:
    """Return where boundary lubrication ends, hydrodynamic begins and friction is at its minimum, and the curve."""
    # Solved where the regimes of the neighbouring row predict the transitions, and else on the whole range.
    solved = SOLVED_ROWS[contact.INPUTS.geometry]
    whole = speeds[0] / solved.room, speeds[1] * solved.room
    for low, high in (_expected(contact.roughness, whole, neighbour), whole):
        found = solve_curve(contact, definition, report, solved.points, solved.rtol, (low, high))
        is_slow = low == whole[0] or found.regimes[0] == "boundary"
        rises = found.regimes[-1] == "hydrodynamic" and np.argmin(np.abs(found.friction.total)) < len(found) - 1
        if is_slow and (rises or high == whole[1]):
            break
    marks = {mark.name: mark.speed for mark in _marks_of(found)}
    slow = found.regimes[0]
    ends = found.values[-1] >= 0.99 * high
    beyond = math.inf if ends else math.nan
    boundary = marks.get("boundary", 0.0 if slow != "boundary" else beyond)
    hydrodynamic = marks.get("hydrodynamic", 0.0 if slow == "hydrodynamic" else beyond)
    return (boundary, hydrodynamic, marks.get("minimum", math.nan)), found


def _expected(roughness: float, whole: tuple[float, float], neighbour: StribeckCurve | None) -> tuple[float, float]:
    """Return speeds between which the transitions at a roughness should lie, by those of a curve at another one."""
    marks = {} if neighbour is None else {mark.name: mark.speed for mark in _marks_of(neighbour)}
    if neighbour is None or neighbour.contact is None or not {"boundary", "hydrodynamic"} <= marks.keys():
        return whole
    factors = [(roughness / neighbour.contact.roughness) ** power for power in SPEED_POWERS]
    low, high = min(factors) * marks["boundary"] / SPEED_MARGIN, max(factors) * max(marks.values()) * SPEED_MARGIN
    low, high = max(low, whole[0]), min(high, whole[1])
    return (low, high) if low < high else whole


def _power(error: float) -> str:
    """Return an error with one digit."""
    mantissa, _, exponent = f"{error:.0e}".partition("e")
    return f"{mantissa}e{int(exponent)}"


def decade_of_roughness(contact: Contact) -> int:
    """Return the power of ten at which the diagram's axis of roughness begins; it covers three decades."""
    if contact.roughness == 0:
        return -8
    return math.floor(math.log10(contact.roughness) - 1.0 + 1e-9)


def diagram_from_atlas(contact: Contact, definition: Definition, speeds: tuple[float, float], decade: int) -> Diagram:
    """Return the diagram at the load of a contact over three decades of roughness, off the atlas."""
    roughness = np.geomspace(10.0**decade, 10.0 ** (decade + 3), DIAGRAM_ROWS)
    groups, unit, row = contact.groups, _group_per_unit(contact, "speed"), table_for(contact.groups)
    h = roughness * _group_per_unit(contact, "roughness")
    low, high = row.box["relative_roughness"]
    scale = float(groups.load) ** groups.scaling.roughness_exponent
    inside = np.clip(h, low * scale, high * scale)
    rows = replace(groups, roughness=inside)
    lowest, highest = row.speeds(rows)
    ends = max(speeds[0] * unit, lowest), min(speeds[1] * unit, highest)
    motion = RULES[groups.geometry].motion(contact)
    found = transition_speeds(rows, contact.boundary_friction, contact.beta, definition, ends, narrowings=1, **motion)
    boundary, hydrodynamic, minimum = (
        np.where(inside == h, line / unit, math.nan) for line in (found.boundary, found.hydrodynamic, found.minimum)
    )
    return Diagram(roughness, boundary, hydrodynamic, minimum)
