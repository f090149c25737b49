"""Friction along the speed and the regimes around it: curve, transitions and phase diagram of a contact.

All are read off the atlas; outside it the curve is solved.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.atlas.tables import table_for
from stribeck.contacts.friction import DEFINITIONS, Definition
from stribeck.contacts.line import Groups, LineContact
from stribeck.curves.regime import BOUNDARY_FLUID_SHARE, HYDRODYNAMIC_CONTACT_SHARE
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.regimes.phase_from_atlas import transition_speeds
from stribeck.solver.nearby import WarmStartSolver
from stribeck.solver.solve import SolveError

__all__ = [
    "Curve",
    "Diagram",
    "Transition",
    "axis_speeds",
    "curve_from_atlas",
    "decade_of_roughness",
    "diagram_from_atlas",
    "in_atlas",
    "solved_curve",
    "transition_marks",
]

POINTS = 121
SOLVED_POINTS = 41
ROWS = 31
"""Points of a curve, of one that is solved, and roughnesses of a diagram."""


SOLVED_RTOL = 1e-4
AROUND, AROUND_POINTS = 2.0, 13
"""Factor of the speed around a solved minimum within which the curve has more points, and how many."""


@dataclass(frozen=True)
class Transition:
    """Where along the speed a regime ends.

    Attributes
    ----------
    name : str
        ``"boundary"``, ``"hydrodynamic"`` or ``"minimum"``.
    speed : float
        Speed there [m/s].
    error : float
        Relative error of the speed; nan where it is not known [-].
    """

    name: str
    speed: float
    error: float


@dataclass(frozen=True, eq=False)
class Curve:
    """Friction along the speed.

    Attributes
    ----------
    speed : ndarray, shape (n,)
        Speeds [m/s].
    friction : mapping of str to ndarray
        Friction coefficient by definition [-].
    contact : ndarray, shape (n,)
        Part of it from asperities [-].
    transitions : tuple of Transition
        Those on it, and those beyond its ends.
    source : str
        Where it comes from, with its error.
    stale : bool
        Whether it belongs to inputs before the present ones.
    """

    speed: Array
    friction: Mapping[Definition, Array]
    contact: Array
    transitions: tuple[Transition, ...]
    source: str
    stale: bool = False

    def transition(self, name: str) -> Transition | None:
        """Return the transition of a name, or None."""
        return next((mark for mark in self.transitions if mark.name == name), None)


@dataclass(frozen=True, eq=False)
class Diagram:
    """Regimes over speed and roughness at the load of the contact.

    Attributes
    ----------
    roughness : ndarray, shape (n,)
        Roughnesses [m].
    boundary, hydrodynamic, minimum : ndarray, shape (n,)
        Speeds at which boundary lubrication ends, hydrodynamic lubrication begins and friction is at its minimum;
        zero, infinite or nan where there are none [m/s].
    message : str
        Why there is no diagram, or empty.
    """

    roughness: Array
    boundary: Array
    hydrodynamic: Array
    minimum: Array
    message: str = ""


def _speed_group(contact: LineContact) -> float:
    """Return the speed group at 1 m/s."""
    return float(contact.replace(speed=1.0).groups.speed)


def in_atlas(contact: LineContact) -> bool:
    """Return whether the atlas covers the contact law, the load and the roughness of a contact."""
    return bool(atlas.covers(replace(contact.groups, speed=0.0)))


def transition_marks(contact: LineContact, definition: Definition) -> tuple[Transition, ...]:
    """Return the transitions along the speed, ascending, from the atlas."""
    if contact.roughness == 0 or contact.boundary_friction == 0:
        return ()
    groups, unit = contact.groups, _speed_group(contact)
    boundary_friction, beta = contact.boundary_friction, contact.beta
    found = transition_speeds(groups, boundary_friction, beta, definition)
    marks = [
        Transition(name, float(getattr(found, name)[0]) / unit, float(found.error[i, 0]))
        for i, name in enumerate(("boundary", "hydrodynamic", "minimum"))
    ]
    return tuple(sorted((mark for mark in marks if 0 < mark.speed < math.inf), key=lambda mark: mark.speed))


def axis_speeds(contact: LineContact, marks: Sequence[Transition]) -> tuple[float, float]:
    """Return whole decades of speed that hold the contact and its transitions, with room on both sides [m/s]."""
    unit = _speed_group(contact)
    places = [mark.speed for mark in marks] or [1e-8 / unit, 1.0 / unit]
    places += [contact.speed] if contact.speed > 0 else []
    low, high = 10.0 ** math.floor(math.log10(min(places)) - 0.7), 10.0 ** math.ceil(math.log10(max(places)) + 0.7)
    row = atlas.for_groups(contact.groups)
    if row is None:
        return low, high
    lowest, highest = (end / unit for end in row.box["speed"])
    return max(low, lowest), min(high, highest)


def curve_from_atlas(contact: LineContact, speeds: tuple[float, float], marks: tuple[Transition, ...]) -> Curve:
    """Return a curve read off the atlas."""
    groups, unit = contact.groups, _speed_group(contact)
    boundary_friction, beta = contact.boundary_friction, contact.beta
    speed = np.geomspace(*speeds, POINTS)
    row = table_for(groups)
    along = Groups(np.clip(speed * unit, *row.box["speed"]), groups.load, groups.roughness, **groups.physics)
    solid = boundary_friction * np.asarray(atlas.contact_load_share(along))
    friction = {kind: solid + np.asarray(atlas.viscous_friction(along, beta, kind)) for kind in DEFINITIONS}
    return Curve(speed, friction, solid, marks, f"from the lookup table, within {_power(row.error)}")


def solved_curve(contact: LineContact, definition: Definition) -> Curve:
    """Return a curve of solved states, with the transitions located on them."""
    found = stribeck_curve(contact, points=SOLVED_POINTS, rtol=SOLVED_RTOL, definition=definition)
    if len(found) < 2:
        raise SolveError(found.outcome, None, found.outcome.value)
    states = dict(zip(map(float, found.values), found.solutions, strict=True))
    if found.minimum is not None:
        # Straight lines between the points of the curve would end in a kink where friction turns.
        solve = WarmStartSolver(SOLVED_RTOL)
        for speed in found.minimum.value * np.geomspace(1 / AROUND, AROUND, AROUND_POINTS):
            if found.values[0] < speed < found.values[-1]:
                states[float(speed)] = solve(contact.replace(speed=float(speed)))
    speeds = np.array(sorted(states))
    parts = {kind: [states[float(speed)].friction(definition=kind) for speed in speeds] for kind in DEFINITIONS}
    friction = {kind: np.array([part.total for part in parts[kind]]) for kind in DEFINITIONS}
    names = {
        f"{BOUNDARY_FLUID_SHARE:.0%} of the load": "boundary",
        f"{HYDRODYNAMIC_CONTACT_SHARE:.0%} of the friction": "hydrodynamic",
    }
    marks = []
    for mark in found.transitions:
        known = next((name for end, name in names.items() if mark.name.endswith(end)), "")
        name = "minimum" if mark is found.minimum else known
        if name and (name != "boundary" or " 5%" in mark.name):
            marks.append(Transition(name, mark.value, math.nan))
    source = f"solved, outside the lookup table; estimated error {_power(found.error_estimate)}"
    return Curve(speeds, friction, np.array([part.contact for part in parts[definition]]), tuple(marks), source)


def _power(error: float) -> str:
    """Return an error with one digit."""
    mantissa, _, exponent = f"{error:.0e}".partition("e")
    return f"{mantissa}e{int(exponent)}"


def decade_of_roughness(contact: LineContact) -> int:
    """Return the power of ten at which the diagram's axis of roughness begins; it covers three decades."""
    if contact.roughness == 0:
        return -8
    return math.floor(math.log10(contact.roughness) - 1.0 + 1e-9)


def diagram_from_atlas(contact: LineContact, definition: Definition, speeds: tuple[float, float], decade: int) -> Diagram:
    """Return the diagram at the load of a contact over three decades of roughness, or why there is none."""
    roughness = np.geomspace(10.0**decade, 10.0 ** (decade + 3), ROWS)
    none = np.full(ROWS, math.nan)
    load, unit = float(contact.groups.load), _speed_group(contact)
    row = atlas.for_groups(contact.groups)
    if row is None:
        message = "Regime map unavailable: no lookup table holds this contact law."
        return Diagram(roughness, none, none, none, message)
    lowest, highest = row.box["load"]
    message = ""
    if not lowest <= load <= highest:
        bound = f"up to {highest:g}" if load > highest else f"from {lowest:g}"
        message = f"Regime map unavailable: the lookup table covers load groups {bound}; here it is {load:.3g}."
    if message:
        return Diagram(roughness, none, none, none, message)
    h = roughness * float(contact.replace(roughness=1.0).groups.roughness)
    low, high = row.box["relative_roughness"]
    inside = np.clip(h, low * load, high * load)
    ends = (max(speeds[0] * unit, row.box["speed"][0]), min(speeds[1] * unit, row.box["speed"][1]))
    rows = replace(contact.groups, roughness=inside)
    found = transition_speeds(rows, contact.boundary_friction, contact.beta, definition, ends, narrowings=1)
    boundary, hydrodynamic, minimum = (
        np.where(inside == h, line / unit, math.nan) for line in (found.boundary, found.hydrodynamic, found.minimum)
    )
    return Diagram(roughness, boundary, hydrodynamic, minimum)
