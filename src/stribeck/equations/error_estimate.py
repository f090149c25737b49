r"""A-posteriori error of the observables: from the mesh, Newton's iteration and rounding.

The state is interpolated to more nodes on the same panels, where the pressures that its gap implies are evaluated anew.  Their
residual is the defect of the state.  One solve with the factors of Newton's last Jacobian gives the change of the unknowns
that would remove the defect, to first order:

.. math:: \delta y = -J^{-1} R_\mathrm{fine}(y)

Rounding is treated alike: the residual is wrong by a few units in the last place of its largest term, with unknown signs.
A few patterns of signs are tried, constant on panels, as errors that differ from node to node hardly move the film.  The
gradients of the observables turn all changes into errors.  The interpolation error between the nodes is added.

At the minimum of the gap its slope vanishes, so that a wrong slope moves the stated position by

.. math:: \delta x = -\frac{\delta h'}{h''}

The error of the slope comes from the changes of the nodal gaps by defect and rounding, from the search for the minimum, and
from the interpolation between the m nodes of a panel.  The last is estimated by the first Legendre polynomial left out, whose
slope is about :math:`\sqrt{2m/\pi}\,(1-s^2)^{-3/4}` inside a panel and :math:`m(m+1)/2` at its ends.  If the gap has a second
minimum of nearly the same depth, the distance between the two is the error.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from stribeck._types import Array, Flags
from stribeck.equations.drag import FilmOnMesh, viscous_friction
from stribeck.equations.enriched import EnrichedOperators, FineOperators
from stribeck.equations.film import is_thinning, jump_of
from stribeck.equations.line import Equations, Fields
from stribeck.equations.observables import (
    DRAG_ROWS,
    GAP_ROWS,
    POSITION_ROWS,
    ROW,
    SHARE_ROWS,
    Observables,
    changes,
    coordinate,
    error_scales,
    stretch_of,
)
from stribeck.equations.operators import LOAD
from stribeck.equations.state import State
from stribeck.numerics.panels import Mesh, between_orders, interpolation_error, reference
from stribeck.numerics.settings import DEFECT_SAFETY, EPSILON, NEGLIGIBLE, ROUNDING, SAFETY, SIGN_PATTERNS
from stribeck.numerics.trace import Trace, act
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outputs import NAMES


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimated errors of the observables, each an array over ALL_NAMES, nan where there are none."""

    discretisation: Array = field(repr=False)
    interpolation: Array = field(repr=False)
    rounding: Array = field(repr=False)
    scales: Array = field(repr=False)
    minimum_position: float = math.nan  # Absolute error of the position of the minimum gap [a]

    @property
    def relative(self) -> Array:
        """Relative errors of the observables."""
        # Rounding makes nodal gaps uneven, and the polynomials between them measure just that: the larger of both counts, not
        # the sum.
        return np.asarray((self.discretisation + np.maximum(self.interpolation, self.rounding)) / self.scales)

    @cached_property
    def total(self) -> float:
        """The largest relative error."""
        return float(np.nanmax(self.relative))

    @property
    def between_nodes(self) -> float:
        """The part of it by the polynomials between the nodes."""
        return float(np.nanmax(self.interpolation / self.scales))

    @property
    def at_nodes(self) -> float:
        """The part of it by mesh and iteration at the nodes; that of the ends of a film is :attr:`of_ends`."""
        relative = self.discretisation / self.scales
        relative[POSITION_ROWS[0] :] = math.nan
        return float(np.nanmax(relative))

    @property
    def of_ends(self) -> float:
        """The error of the ends of a film; zero where it has none."""
        return float(np.nanmax(self.discretisation[POSITION_ROWS[0] :], initial=0.0))

    @property
    def floor(self) -> float:
        """The part of it by rounding, which no mesh removes."""
        return float(np.nanmax(self.rounding / self.scales))


@dataclass(frozen=True)
class Perturbations:
    """Changes of unknowns and friction by defect and rounding: the possible errors of states."""

    unknowns: Array = field(repr=False)  # The defect first, then the patterns of rounding: (1 + SIGN_PATTERNS, unknowns)
    friction: Array = field(repr=False)  # Of the friction integrals on the finer nodes


def perturbations(state: State, observed: Array, fine: FineOperators) -> Perturbations:
    """Return the changes of a state by defect, quadrature and rounding; ``observed`` are its observables."""
    op, at, y = state.equations.operators, state.equations.layout, state.y
    coarse, mesh, film, u = fine.coarse, fine.mesh, state.equations.film, state.equations.fields(y)
    equations = replace(state.equations, operators=EnrichedOperators.of(op, fine))
    far_gap, integral = equations.far_gap(u), equations.operators.integral
    gap = np.exp(coarse.to_order(np.log(u.gap / coarse.far), mesh.order)) * mesh.far
    own, finer = slice(-coarse.order, None), slice(-mesh.order, None)  # through infinity, where the gap holds a logarithm
    smooth = u.gap[own] - far_gap(coarse.nodes[own])
    gap[finer] = smooth @ between_orders(coarse.order, mesh.order) + far_gap(mesh.nodes[finer])
    # On panels with a kink, or too wide for the shape, the gap between the nodes is not that of their polynomials.
    gap = np.maximum(gap + op.model.profile.missed(coarse, mesh, u.exit), NEGLIGIBLE * gap)
    fluid = None if u.pressure is None else coarse.to_order(u.pressure * coarse.stretch, mesh.order) / mesh.stretch
    flat = np.asarray((np.abs(u.gap - u.flux_gap) < NEGLIGIBLE * u.gap).reshape(coarse.panels, -1).all(axis=1))
    clip = _clip_to_coarse_error(coarse, flat, mesh.order) if is_thinning(film) and flat.any() else None

    known = u._replace(gap=gap, pressure=fluid)  # at the finer nodes
    slopes = equations.gradient(film, known)
    if flat.any():
        smooth = state.equations.gradient(film, u)
        smooth = coarse.to_order(smooth, mesh.order) if clip is None else clip(slopes, smooth)
        slopes = np.where(np.repeat(flat, mesh.order), smooth, slopes)
    jump = jump_of(film)
    jumps = None if jump is None else jump(gap, fluid)
    if jumps is not None:
        slopes = slopes + 0.5 * jumps
    integrated = equations.fluid_of_gradient(u, slopes)
    lowered = None if fluid is None else fine.lowered(integrated)
    if fluid is None or lowered is None:
        fluid = unresolved = integrated
    else:  # what the nodes hold of it is a row of its own; through infinity it may have a kink
        unresolved = fluid + integrated - coarse.to_order(lowered * coarse.stretch, mesh.order) / mesh.stretch
        fluid[finer] = unresolved[finer] = integrated[finer]
    contact = equations.contact(gap)
    at_end = slopes if equations.ending is film else equations.gradient(equations.ending, known)
    rows = equations.balances(u, contact + unresolved, slopes, at_end)
    rounding = _rounding(equations, u, rows.gap, slopes)
    if rows.exit is not None:
        steep, missed = _at_exit(state.equations, u)
        rounding = rounding._replace(exit=SAFETY * EPSILON * steep)
        rows = rows._replace(exit=np.abs(rows.exit) + steep * missed)
    if lowered is not None:
        missing = u.pressure - lowered
        missing[own] = 0.0
        rows = rows._replace(pressure=missing)
    residual = np.zeros((1 + SIGN_PATTERNS, y.size))
    for place, defect, rounded in zip(Fields._fields, rows, rounding, strict=True):
        if defect is not None:
            residual[0, getattr(at, place)] = defect
        if rounded is not None:
            residual[1:, getattr(at, place)] = rounded
    residual[1:] *= _signs(coarse.panels, coarse.order, at.size - at.numbers.start, at.numbers.start)
    known_friction = observed[DRAG_ROWS]
    friction = known_friction
    if equations.is_sliding:
        film_on_mesh = FilmOnMesh(integral, gap, fluid, contact, equations.operators.load, clip)
        friction = np.concatenate(viscous_friction(state.equations, u, float(state.groups.load), film_on_mesh))
    return Perturbations(state.correction(residual), np.abs(friction - known_friction))


def _rounding(equations: Equations, u: Fields, shape: Array, slopes: Array) -> Fields:
    """Return by how much rounding may change the rows: a few units in the last place of the largest terms."""
    op, scale, d = equations.operators, equations.flux_scale, u.cavity_stretch
    x = op.mesh.nodes if d is None else d * op.mesh.nodes
    undeformed = 0.5 * (x if u.exit is None else x + u.exit) ** 2 + op.model.profile.departure(op.mesh, u.exit)
    deflection = u.gap - u.offset - undeformed - shape
    size = SAFETY * EPSILON
    found = Fields(
        gap=size * (np.abs(u.offset) + np.abs(undeformed) + np.abs(deflection)),
        offset=np.full_like(u.offset, size * LOAD),
        flux_gap=size * scale * act(op.net, np.abs(slopes)),
    )
    if d is None:
        return found
    beyond = d * act(op.net_beyond, np.abs(slopes)) + np.abs(op.model.cavity_pressure / equations.speed)
    return found._replace(cavity_stretch=size * scale * beyond)


def _at_exit(equations: Equations, u: Fields) -> tuple[Array, Array]:
    """Return the change of the row of the exit with the gap there, relative, and the interpolation error of that gap."""
    op = equations.operators
    left = slice((op.integral.middle - 1) * op.mesh.order, op.integral.middle * op.mesh.order)
    traced = u._replace(gap=Trace.number("gap", u.gap))
    by_gap = equations.gradient(equations.ending, traced).columns["gap"]
    steep = np.abs(by_gap[left] * u.gap[left])[-1:]
    return equations.flux_scale * steep, interpolation_error(np.log(u.gap[left] / op.mesh.far[left]))


def _clip_to_coarse_error(coarse: Mesh, flat: Flags, order: int) -> Callable[[Array, Array], Array]:
    """Return a function that clips values at finer nodes of ``flat`` panels to those of the coarse nodes and their error."""
    # Where the shear rate vanishes the gradient turns sharply with the gap, or the gap with the gradient: that with the
    # smaller error between its nodes gives the values.

    def clip(finer: Array, nodal: Array) -> Array:
        held = coarse.to_order(nodal, order)
        error = interpolation_error(nodal.reshape(*nodal.shape[:-1], coarse.panels, -1))
        bound = np.repeat(np.where(flat, error, np.inf), order, axis=-1)
        return np.asarray(held + np.clip(finer - held, -bound, bound))

    return clip


def interpolation_errors(mesh: Mesh, gap: Array, lowest: float, centre: float) -> Array:
    """Return the absolute errors of the interpolated central and minimum gap, at coordinates of the mesh."""
    lowest_panel = min(max(int(np.searchsorted(mesh.edges, lowest)) - 1, 0), mesh.panels - 1)
    panels = [int(np.searchsorted(mesh.edges, centre, side="right")) - 1, lowest_panel]
    gap = gap.reshape(mesh.panels, -1)[panels]
    return np.asarray(_between_nodes(mesh, gap, panels) * gap.min(axis=1))


def gap_is_resolved(mesh: Mesh, gap: Array, rtol: float, *, centre: float = 0.0, spread: float = 0.0) -> bool:
    """Return whether central and minimum gap are interpolated to ``rtol``, up to ``spread`` from the place of the minimum."""
    # These gaps are the first to lose resolution on a reused mesh.
    central = int(mesh.locate(np.array([centre]))[0][0])
    lowest = mesh.nodes[int(np.argmin(gap))]
    near = np.abs(mesh.centres[:-1] - lowest) <= mesh.half_widths[:-1] + spread
    panels = [central, *np.flatnonzero(near)]
    return bool((_between_nodes(mesh, gap.reshape(mesh.panels, -1)[panels], panels) <= rtol).all())


def _between_nodes(mesh: Mesh, gap: Array, panels: list[int]) -> Array:
    """Return the relative errors of gaps, shape (panels, order), interpolated between the nodes of their ``panels``."""
    return np.asarray(SAFETY * interpolation_error(np.log(gap / mesh.far.reshape(mesh.panels, -1)[panels])))


@lru_cache(maxsize=64)
def _signs(panels: int, order: int, numbers: int, fields: int) -> Array:
    """Return fixed patterns of signs, each constant on a panel, shape (SIGN_PATTERNS, fields + numbers)."""
    signs = np.random.default_rng(panels).choice(np.array([-1.0, 1.0]), (SIGN_PATTERNS, panels + numbers))
    nodal = np.repeat(signs[:, numbers:], order, axis=1)
    return np.hstack([nodal, np.zeros((SIGN_PATTERNS, fields - panels * order)), signs[:, :numbers]])


def error_estimate(state: State, observed: Observables, fine: FineOperators) -> ErrorEstimate:
    """Return the estimated errors of the observables of a state."""
    # At speed zero the values may be those of the same state under another load, see stribeck.solver.at_rest.
    equations, y, values = state.equations, state.y, observed.array()
    mesh, u = equations.operators.mesh, equations.fields(y)
    changed = perturbations(state, values, fine)
    place = coordinate(u, observed.minimum_position)
    effects = np.abs(changes(equations, y, float(state.groups.load), place, changed.unknowns))
    effects[0, DRAG_ROWS] += changed.friction
    interpolation = np.zeros_like(values)
    interpolation[GAP_ROWS] = interpolation_errors(mesh, u.gap, place, coordinate(u, 0.0))
    scales = error_scales(values, None if equations.is_sliding else float(equations.law.decay_length))
    rounding = SAFETY * np.sqrt((effects[1:] ** 2).mean(axis=0))
    minimum = ROW["minimum_gap"]
    depth = (effects[0, minimum] + interpolation[minimum] + rounding[minimum]) / u.gap.min()
    of_gap = changed.unknowns[:, equations.layout.gap]
    of_place = stretch_of(u) * position_error(mesh, u.gap, of_gap, place, float(depth))
    discretisation = DEFECT_SAFETY * effects[0]
    if u.exit is not None:
        of_place += float((discretisation + rounding)[ROW["exit_position"]])
    for part in (discretisation, rounding):  # shares sum to one, so that they err alike
        part[SHARE_ROWS] = part[SHARE_ROWS].max()
    missing = np.isnan(values)
    missing[: len(NAMES)] = False
    for part in (discretisation, interpolation, rounding):
        part[missing] = math.nan
    return ErrorEstimate(discretisation, interpolation, rounding, scales, of_place)


def position_error(mesh: Mesh, gap: Array, changes: Array, position: float, depth: float) -> float:
    """Return the absolute error of the position of the minimum gap, a coordinate of the mesh."""
    rule, order = reference(mesh.order), mesh.order
    panel = min(max(int(np.searchsorted(mesh.edges, position)) - 1, 0), mesh.panels - 2)
    width = float(mesh.half_widths[panel])
    s = (position - float(mesh.centres[panel])) / width
    nodes = slice(panel * order, (panel + 1) * order)
    own, far = gap[nodes], mesh.far[nodes]
    logarithm = np.log(own / far)
    slope_of = rule.interpolation(np.array([s]))[0] @ rule.derivative
    curvature_of = slope_of @ rule.derivative
    growth = mesh.scale**2 + position**2
    slope = slope_of @ logarithm + 2 * width * position / growth
    curvature = curvature_of @ logarithm + 2 * width**2 * (mesh.scale**2 - position**2) / growth**2

    moved = np.abs((changes[:, nodes] / own) @ slope_of)
    inside = max(1 - s**2, 1e-300)
    steepest = min(order * (order + 1) / 2, np.sqrt(2 * order / np.pi) / inside**0.75)
    missed = steepest * (interpolation_error(logarithm) + ROUNDING / own.min())
    wrong = abs(slope) + moved[0] + 2 * np.sqrt((moved[1:] ** 2).mean()) + missed
    found = SAFETY * width * wrong / max(abs(curvature), 1e-300)

    return float(max(found, _farthest_rival(mesh, gap, position, panel, depth)))


def _farthest_rival(mesh: Mesh, gap: Array, position: float, panel: int, depth: float) -> float:
    """Return the distance of the farthest other minimum that may be the deeper one, zero if there is none."""
    x, gap = mesh.nodes[: -mesh.order], gap[: -mesh.order]  # without the panel through infinity
    places = np.flatnonzero(np.append(True, np.diff(x) > 0))  # rounding may make two nodes of the narrowest panels one
    panels, x, gap = places // mesh.order, x[places], gap[places]
    left, middle, right = gap[:-2], gap[1:-1], gap[2:]
    rising = (middle - left) / (x[1:-1] - x[:-2])
    falling = (right - middle) / (x[2:] - x[1:-1])
    at = np.flatnonzero((rising <= 0) & (falling >= 0) & (np.abs(panels[1:-1] - panel) > 1))
    bend = (falling - rising)[at] / (x[at + 2] - x[at])  # of the parabola through the three nodes
    slope = rising[at] + bend * (x[at + 1] - x[at])
    bottom = middle[at] - 1.5 * slope**2 / (4 * np.maximum(bend, 1e-300))  # with half of the drop for what it misses
    deep = bottom <= gap.min() * (1 + 2 * depth)
    return float(np.abs(x[at[deep] + 1] - position).max(initial=0.0))
