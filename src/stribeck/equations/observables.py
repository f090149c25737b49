"""The observables of a state: load shares, films, friction, real area of contact, and their changes with the unknowns.

Friction is kept for beta = 1, to which it is proportional, and in the definitions of :mod:`stribeck.equations.drag`.
"""

import math
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.contact_laws.law import WithArea, area_slope
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Groups, contact_law
from stribeck.equations.drag import FilmOnMesh, viscous_friction
from stribeck.equations.gap import gap_beside, minimum_gap
from stribeck.equations.line import Equations, Fields
from stribeck.equations.operators import LOAD
from stribeck.equations.state import State
from stribeck.numerics.dual import value_of
from stribeck.numerics.panels import Mesh
from stribeck.numerics.settings import FLOOR, LOG_STEP
from stribeck.numerics.trace import Trace, act
from stribeck.quantities.outputs import ABSOLUTE, ALL_NAMES, GROUPS, RUPTURE_ROWS

ROW = {name: row for row, name in enumerate(ALL_NAMES)}  # Index of each in such an array

VISCOUS = ("viscous_published", "viscous_balanced", "viscous_upper")
ALONG = "along"  # Name of directions in traces
DRAG_ROWS = [ROW[name] for name in VISCOUS]
SHARE_ROWS = [ROW[name] for name in ABSOLUTE]
GAP_ROWS = [ROW["central_gap"], ROW["minimum_gap"]]
POSITION_ROWS = [ROW[row.name] for row in RUPTURE_ROWS]


@dataclass(frozen=True)
class Observables:
    """The observables of one state; gaps in u_Hz, friction for beta = 1."""

    contact_load_share: float
    fluid_load_share: float
    central_gap: float
    minimum_gap: float
    minimum_position: float
    flux_gap: float
    offset: float
    viscous_published: float
    viscous_balanced: float
    viscous_upper: float = math.nan
    exit_position: float = math.nan
    reformation_position: float = math.nan

    def viscous_friction(self, beta: float, definition: Definition = "balanced") -> float:
        """Return the viscous friction coefficient of a definition [-], which is proportional to beta."""
        return beta * float(getattr(self, f"viscous_{definition}"))

    def array(self) -> Array:
        """Return the observables in the order of :data:`ALL_NAMES`, nan where there are none."""
        return np.array([getattr(self, name) for name in ALL_NAMES])


def drag_scales(values: Array) -> Array:
    """Return the scale of the tolerance of each drag, in the order of :data:`DRAG_ROWS`, of values of shape (..., rows)."""
    # Rolling friction has opposite signs on the two walls and passes through zero: both count by the larger of them.
    found = np.abs(values[..., DRAG_ROWS])
    published, balanced, upper = found[..., 0], found[..., 1], found[..., 2]
    np.fmax(balanced, upper, out=balanced)
    upper[...] = balanced
    np.fmax(published, balanced, out=published)
    return found


def error_scales(values: Array, decay_length: Array | float | None) -> Array:
    """Return the scales of errors of values, shape (..., rows): these, bounded from below where they may vanish."""
    # ``decay_length`` is that of a contact at rest, None of a moving one.
    found = np.abs(values)
    found[..., SHARE_ROWS] = 1.0
    found[..., POSITION_ROWS] = np.fmax(1.0, found[..., POSITION_ROWS])
    found[..., DRAG_ROWS] = drag_scales(values)
    found[..., ROW["offset"]] = np.maximum(found[..., ROW["offset"]], found[..., ROW["central_gap"]])
    if decay_length is not None:
        found[..., GAP_ROWS] = np.maximum(found[..., GAP_ROWS], FLOOR * decay_length)
    found[found == 0] = 1.0
    return found


def drag_parts(values: Array) -> Array:
    """Return the drags over these scales, and one for all else; an error over that is relative to the observable itself."""
    parts, sizes, scales = np.ones_like(values), np.abs(values[..., DRAG_ROWS]), drag_scales(values)
    parts[..., DRAG_ROWS] = np.divide(sizes, scales, out=np.ones_like(sizes), where=sizes > 0)
    return parts


def observables(equations: Equations, y: Array, load: float) -> Observables:
    """Return the observables of the unknowns ``y`` of ``equations`` at the load group ``load``."""
    mesh, u = equations.operators.mesh, equations.fields(y)
    found = dict.fromkeys(ALL_NAMES, math.nan)
    found |= {name: float(value[0]) for name, value in measured(equations, u, load).items()}
    found["minimum_position"], found["minimum_gap"] = minimum_of(equations, y)
    found["central_gap"] = float(gap_beside(mesh, u.gap, coordinate(u, 0.0))[0])
    return Observables(**{each.name: found[each.name] for each in fields(Observables)})


def minimum_of(equations: Equations, y: Array) -> tuple[float, float]:
    """Return position and value of the minimum gap."""
    u = equations.fields(y)
    place, gap = minimum_gap(equations.operators.mesh, u.gap)
    if u.exit is not None:
        place = float(u.exit[0]) + stretch_of(u) * place
    return place, gap


def stretch_of(u: Fields) -> float:
    """Return the stretch of the frame: one where the film does not re-form."""
    return 1.0 if u.cavity_stretch is None else float(u.cavity_stretch[0])


def coordinate(u: Fields, x: float) -> float:
    """Return the coordinate of the mesh at a position."""
    return x if u.exit is None else (x - float(u.exit[0])) / stretch_of(u)


def measured(equations: Equations, u: Fields, load: Numbers, by: str | None = None) -> dict[str, Any]:
    """Return what follows from fields by integrals, of values or of traces; also traced by ln of one group."""
    op, d = equations.operators, u.cavity_stretch
    stretch = 1.0 if d is None else d
    contact = equations.contact(u.gap, by)
    found = {"contact_load_share": stretch * act(op.panel_load, contact) / LOAD}
    found |= dict.fromkeys(("fluid_load_share", *VISCOUS), np.zeros_like(value_of(u.offset)))
    if equations.is_sliding:
        fluid = u.pressure
        if fluid is None:
            fluid = equations.fluid_of_gradient(u, equations.gradient(equations.film, u, by), by)
        found["fluid_load_share"] = stretch * act(op.load, fluid) / LOAD
        film = FilmOnMesh(op.integral, u.gap, fluid, contact, op.load)
        found |= zip(VISCOUS, viscous_friction(equations, u, load, film, by), strict=True)
    found |= {"flux_gap": u.flux_gap, "offset": u.offset}
    if u.exit is not None:
        found["exit_position"] = u.exit
    if d is not None:
        found["reformation_position"] = u.exit + d * op.mesh.reformation
    return found


def changes(equations: Equations, y: Array, load: float, lowest: float, dy: Array) -> Array:
    """Return the changes of the observables with small changes ``dy`` of the unknowns, shape (..., len(ALL_NAMES))."""
    # ``lowest`` is the place of the minimum gap on the mesh.
    u, du = equations.fields(y), equations.fields(dy)
    moving = Fields(*(None if value is None else Trace(value, None, {ALONG: by}) for value, by in zip(u, du, strict=True)))
    found = np.zeros((*dy.shape[:-1], len(ALL_NAMES)))
    for name, value in measured(equations, moving, load).items():
        if isinstance(value, Trace):
            found[..., ROW[name]] = value.columns[ALONG][..., 0]
    mesh, centre = equations.operators.mesh, coordinate(u, 0.0)
    moved: Any = 0.0  # the centre on the mesh
    if u.exit is not None:
        moved = -du.exit[..., 0] / stretch_of(u)
    if u.cavity_stretch is not None:
        moved = moved - centre / stretch_of(u) * du.cavity_stretch[..., 0]
    found[..., ROW["central_gap"]] = _of_gap(mesh, u.gap, du.gap, centre, moved)
    # The minimum moves along a gap without a slope.
    found[..., ROW["minimum_gap"]] = _of_gap(mesh, u.gap, du.gap, lowest, 0.0)
    return found


def _of_gap(mesh: Mesh, gap: Array, change: Array, place: float, moving: Any) -> Array:
    """Return the changes of the gap's polynomial at a place that moves."""
    middle, slope, nodes, weights = gap_beside(mesh, gap, place)
    return np.asarray(change[..., nodes] @ (middle * weights / gap[nodes]) + slope * moving)


def real_area(groups: Groups, mesh: Mesh, stretch: float, contact: Array, load_error: float) -> tuple[float, float]:
    """Return the real area by a contact pressure at the nodes and its absolute error, by that of the load on asperities."""
    law: Any = groups.law
    scale = float(groups.pressure_scale)
    value = area_by_pressure(groups, mesh, stretch, contact)
    # The logarithm of the pressure is smooth; where it is too small for one it carries nothing.
    fine, logs = mesh.refined(2 * mesh.order), np.log(np.maximum(contact, np.finfo(float).tiny))
    missed = abs(area_by_pressure(groups, fine, stretch, np.exp(mesh.to_order(logs, fine.order))) - value)
    # No area grows faster with the load than at small pressure.
    return value, missed + 0.5 * LOAD * area_slope(law) * scale * load_error


def area_of_state(state: State, load_error: float) -> tuple[float, float]:
    """Return the real area of a sliding state and its error; smooth surfaces touch nowhere."""
    if state.groups.roughness == 0:
        return 0.0, 0.0
    contact = state.equations.contact(state.gap)
    return real_area(state.groups, state.mesh, state.cavity_stretch, contact, load_error)


def area_derivatives(state: State, moves: Array) -> Array:
    """Return the derivatives of the real area by the logarithms of the groups, then along changes of the model.

    ``moves`` are those of the unknowns; the area of a law that does not know it is nan, that of smooth surfaces zero.
    """
    groups = state.groups
    if groups.roughness == 0 or not isinstance(groups.law, WithArea):
        return np.full(len(moves), 0.0 if groups.roughness == 0 else math.nan)
    found = []
    for k, move in enumerate(moves):
        # So small a step that no pressure changes by more than the step itself.
        gap = state.equations.layout.gap
        step = LOG_STEP / max(1.0, float(np.abs(move[gap]).max()) / float(groups.relative_roughness))
        ends = [_moved_area(state, move, GROUPS[k] if k < len(GROUPS) else None, each) for each in (step, -step)]
        found.append((ends[0] - ends[1]) / (2 * step))
    return np.array(found)


def _moved_area(state: State, move: Array, group: str | None, step: float) -> float:
    """Return the area of a state after a small step along a direction of its unknowns and of one group."""
    groups, equations, y = state.groups, state.equations, state.y + step * move
    if group is not None:
        groups = replace(groups, **{group: float(getattr(groups, group)) * math.exp(step)})  # type: ignore[arg-type]
    u = equations.fields(y)
    contact = replace(equations, law=contact_law(groups)).contact(u.gap)
    stretch = 1.0 if u.cavity_stretch is None else float(u.cavity_stretch[0])
    return area_by_pressure(groups, state.mesh, stretch, contact)


def area_by_pressure(groups: Groups, mesh: Mesh, stretch: float, contact: Array) -> float:
    """Return the real area by a contact pressure at the nodes."""
    law: Any = groups.law
    return 0.5 * stretch * float(mesh.weights @ law.area_fraction_at(contact * float(groups.pressure_scale)))
