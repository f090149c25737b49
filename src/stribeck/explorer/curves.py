"""Friction along the speed and the regimes around it: curve, transitions and map of a contact.

All are read off the atlas where it holds; else the curve is solved, and the map row by row.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.atlas.lookup import has_friction
from stribeck.atlas.tables import table_for
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import DEFINITIONS, Definition, FrictionArray
from stribeck.contacts.friction_rules import RULES
from stribeck.curves.regime import Landmark, Transition
from stribeck.curves.result import StribeckCurve
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.units import InputError
from stribeck.regimes.transition_speeds import transition_speeds
from stribeck.solver.solve_error import SolveError
from stribeck.uncertainty.propagate import Band

CURVE_POINTS = 121  # Points at which a curve is shown.
DIAGRAM_ROWS = 33  # Roughnesses of a diagram.

SOLVED_RTOL = 1e-4  # Relative tolerance of curves that are solved.
# Tolerance of the first curve for new inputs, by geometry: less than a tenth of a pixel; at 1e-3 some take more states.
FIRST_RTOL = {"line": 5e-4, "point": SOLVED_RTOL}

# Points of curves that are solved, by geometry; of a ball each point is a state where it is no function.
SOLVED_POINTS = {"line": CURVE_POINTS, "point": 15}


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

# Ends of axes, times powers of ten: few, so that axes stay still while a slider moves.
AXIS_ENDS = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0)

Report = Callable[[float], object]  # Callback with the finished part; an exception that it raises ends the work.
Marks = Mapping[str, Landmark]

# Transitions that are shown.
SHOWN = {
    "boundary": Transition.BOUNDARY_END,
    "minimum": Transition.MINIMUM,
    "hydrodynamic": Transition.HYDRODYNAMIC_START,
}


@dataclass(frozen=True, eq=False)
class Curve:
    """Friction along the speed as the page shows it."""

    found: StribeckCurve  # The curve, solved or read off the atlas
    marks: Marks  # The transitions on it and beyond its ends
    notes: tuple[str, ...] = ()  # What to know of it, once it is solved finely
    band: Band | None = None  # What the errors of the inputs leave open, where some are given

    @property
    def speed(self) -> Array:
        """Speeds of its points [m/s]."""
        return self.found.values

    @cached_property
    def friction(self) -> Mapping[Definition, FrictionArray]:
        """Friction coefficient by definition, with its parts [-]."""
        own = self.found.definition
        return {each: self.found.friction if each == own else self.found.friction(definition=each) for each in DEFINITIONS}

    @cached_property
    def sizes(self) -> Mapping[Definition, Array]:
        """Its size: where the cylinder is the faster body the substrate is dragged along [-]."""
        return {definition: np.abs(np.asarray(friction.total)) for definition, friction in self.friction.items()}

    @property
    def source(self) -> str:
        """Where it comes from, with its error."""
        error = f"{self.found.error_estimate:.0e}".replace("e-0", "e-")
        return f"from the lookup table, within {error}" if not self.found.states else f"solved; error {error}"


@dataclass(frozen=True, eq=False)
class Diagram:
    """Regimes over speed and roughness at the load of the contact."""

    roughness: Array  # Roughnesses [m]
    lines: Array  # Where boundary lubrication ends, hydrodynamic begins and friction is least; 0, inf or nan beyond [m/s]
    part: float = 1.0  # How much of its rows is there [-]


def hersey_scale(contact: Contact) -> float:
    """Return the Hersey number at 1 m/s."""
    return 1.0 / RULES[contact.groups.geometry].speed_per("hersey_number", contact)


def _group_per_unit(contact: Contact, name: str) -> float:
    """Return the speed or roughness group at 1 m/s or 1 m."""
    value = getattr(contact, name)
    groups = contact.groups if value else contact.replace(**{name: 1.0}).groups
    return float(getattr(groups, name)) / (value or 1.0)


def in_atlas(contact: Contact) -> bool:
    """Return whether the atlas covers the contact law, the load and the roughness of a contact, and has its friction."""
    return has_friction(contact, replace(contact.groups, speed=0.0))


def transition_marks(contact: Contact, definition: Definition) -> Marks:
    """Return the transitions along the speed from the atlas."""
    if contact.roughness == 0 or contact.boundary_friction == 0:
        return {}
    groups, unit = contact.groups, _group_per_unit(contact, "speed")
    motion = RULES[groups.geometry].motion(contact)
    speeds, errors = transition_speeds(groups, contact.boundary_friction, contact.beta, definition, motion)
    rows = {"boundary": 0, "minimum": 2, "hydrodynamic": 1}
    return {
        name: Landmark(SHOWN[name], speed, math.nan, error=float(errors[row, 0]), unit="m/s")
        for name, row in rows.items()
        if 0 < (speed := float(speeds[row, 0]) / unit) < math.inf
    }


def decades_around(ends: tuple[float, float], speeds: Sequence[float]) -> tuple[float, float]:
    """Return the ends of an axis, in whole decades farther where speeds lie beyond [m/s]."""
    if not speeds:
        return ends
    low, high = (math.log10(end(speeds)) for end in (min, max))
    return min(ends[0], 10.0 ** math.floor(low + 1e-9)), max(ends[1], 10.0 ** math.ceil(high - 1e-9))


def round_up(value: float) -> float:
    """Return the next larger end of an axis."""
    power = 10.0 ** math.floor(math.log10(value))
    return float(f"{next(step for step in AXIS_ENDS if step * power >= value * (1 - 1e-9)) * power:.6g}")


def round_down(value: float) -> float:
    """Return the next smaller end of an axis."""
    power = 10.0 ** math.floor(math.log10(value))
    return float(f"{next(step for step in AXIS_ENDS[::-1] if step * power <= value * (1 + 1e-9)) * power:.6g}")


def axis_speeds(contact: Contact, marks: Marks) -> tuple[float, float]:
    """Return whole decades of speed [m/s] around the contact and its transitions, within the table."""
    unit = _group_per_unit(contact, "speed")
    places = [mark.value for mark in marks.values()] or [1e-8 / unit, 1.0 / unit]
    places += [contact.speed] if contact.speed > 0 else []
    low, high = 10.0 ** math.floor(math.log10(min(places)) - 0.7), 10.0 ** math.ceil(math.log10(max(places)) + 0.7)
    return _in_table(contact, (low, high))


def _in_table(contact: Contact, speeds: tuple[float, float]) -> tuple[float, float]:
    """Return the part of an axis of speeds that the atlas has."""
    unit = _group_per_unit(contact, "speed")
    low, high = (end / unit for end in table_for(contact.groups).speeds(contact.groups))
    return max(speeds[0], low), min(speeds[1], high)


def curve_from_atlas(contact: Contact, definition: Definition, speeds: tuple[float, float], marks: Marks) -> Curve:
    """Return a curve read off the atlas."""
    ends = _in_table(contact, speeds)
    return Curve(stribeck_curve(contact, speed=ends, points=CURVE_POINTS, definition=definition, method="atlas"), marks)


def solved_curve(contact: Contact, definition: Definition, report: Report, rtol: float = SOLVED_RTOL) -> Curve:
    """Return a curve of solved states, with the transitions located on them."""
    settings: Any = {"definition": definition, "rtol": rtol, "on_point": lambda done, of: report(done / of)}
    found = stribeck_curve(contact, points=SOLVED_POINTS[contact.INPUTS.geometry], **settings)
    if len(found) < 2:
        raise SolveError(found.outcome, None, found.outcome.value)
    if len(found) < CURVE_POINTS:
        found = found.sampled(CURVE_POINTS)
    return Curve(found, _marks_of(found), found.notes if rtol <= SOLVED_RTOL else ())


def _marks_of(found: StribeckCurve) -> Marks:
    """Return where the regimes of a solved curve end, within what its own tolerance leaves open."""
    marks = {name: found.landmark(mark, found.rtol) for name, mark in SHOWN.items()}
    return {name: mark for name, mark in marks.items() if mark is not None}


def solved_diagram(
    contact: Contact, definition: Definition, speeds: tuple[float, float], decade: int, report: Report
) -> Iterator[Diagram]:
    """Give the diagram at the load of a contact as its rows are solved, those beside the contact first."""
    step = SOLVED_ROWS[contact.INPUTS.geometry].step
    shown = np.geomspace(10.0**decade, 10.0 ** (decade + 3), DIAGRAM_ROWS)
    roughness = shown[::step]
    shown = shown[: step * (len(roughness) - 1) + 1]
    lines = np.full((3, len(roughness)), math.nan)
    own = contact.roughness or roughness[0]
    order = sorted(range(len(roughness)), key=lambda i: abs(math.log(roughness[i] / own)))
    for number, i in enumerate(order):
        with suppress(SolveError, InputError):  # its row stays empty
            lines[:, i] = _row(contact.replace(roughness=float(roughness[i])), definition, speeds, report)
        yield Diagram(shown, _between(roughness, lines, shown), part=(number + 1) / len(order))


def _between(roughness: Array, lines: Array, shown: Array) -> Array:
    """Return lines of a map at the rows that are shown, by monotone cubics of logarithms inside the axis."""
    from scipy.interpolate import PchipInterpolator

    with np.errstate(divide="ignore", invalid="ignore"):  # a line may be at zero, at infinity, or missing
        found = np.exp([np.interp(np.log(shown), np.log(roughness), np.log(line)) for line in lines])
    for line, drawn in zip(lines, found, strict=True):
        known, inside = (np.isfinite(each) & (each > 0) for each in (line, drawn))
        if known.sum() > 2:
            drawn[inside] = np.exp(PchipInterpolator(np.log(roughness[known]), np.log(line[known]))(np.log(shown[inside])))
    return found


def _row(contact: Contact, definition: Definition, speeds: tuple[float, float], report: Report) -> tuple[float, float, float]:
    """Return where boundary lubrication ends, hydrodynamic begins and friction is at its minimum."""
    solved = SOLVED_ROWS[contact.INPUTS.geometry]
    low, high = speeds[0] / solved.room, speeds[1] * solved.room
    settings: Any = {"definition": definition, "rtol": solved.rtol, "on_point": lambda done, of: report(done / of)}
    found = stribeck_curve(contact, speed=(low, high), points=solved.points, **settings)
    marks = {name: mark.value for name, mark in _marks_of(found).items()}
    slow = found.regimes[0]
    beyond = math.inf if found.values[-1] >= 0.99 * high else math.nan
    boundary = marks.get("boundary", 0.0 if slow != "boundary" else beyond)
    hydrodynamic = marks.get("hydrodynamic", 0.0 if slow == "hydrodynamic" else beyond)
    return boundary, hydrodynamic, marks.get("minimum", math.nan)


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
    found, _ = transition_speeds(rows, contact.boundary_friction, contact.beta, definition, motion, ends, narrowings=1)
    return Diagram(roughness, np.where(inside == h, found / unit, math.nan))
