r"""A-posteriori error of the observables: from the mesh, Newton's iteration and rounding.

The state is interpolated to more nodes on the same panels, where the pressures that its gap implies are evaluated anew.  Their
residual is the defect of the state.  One solve with the factors of Newton's last Jacobian gives the change of the unknowns
that would remove the defect, to first order:

.. math:: \delta y = -J^{-1} R_\mathrm{fine}(y)

Rounding is treated alike: the residual is wrong by a few units in the last place of its largest term, with unknown signs.
A few patterns of signs are tried, constant on panels, as errors that differ from node to node hardly move the film.  The
gradients of the observables turn all changes into errors.  The interpolation error between the nodes is added.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.equations.drag import FilmOnMesh, viscous_friction
from stribeck.equations.enriched import FineOperators
from stribeck.equations.film import gradient_in_film
from stribeck.equations.line import LOAD
from stribeck.equations.observables import (
    DRAG_ROWS,
    ROW,
    Observables,
    changes,
    drag_scales,
)
from stribeck.equations.position_error import position_errors
from stribeck.equations.state import StackedStates, is_rough, is_thinning, jump_of
from stribeck.numerics.panels import Mesh, between_orders, interpolation_error, reference
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.numerics.settings import EPSILON, FLOOR, SAFETY
from stribeck.numerics.trace import Matrix, Trace
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outputs import ABSOLUTE, NAMES, RUPTURE_ROWS

__all__ = [
    "GAP_ROWS",
    "ErrorEstimate",
    "FineOperators",
    "error_estimates",
    "gap_is_resolved",
    "perturbations",
]

DEFECT_SAFETY = 3.0  # Safety factor of the defect: finer nodes see only a part of it if the pressures need many more nodes

# If the gap differs from the flux gap by less than this part of itself on a whole panel, the pressure gradient is interpolated
# itself: its formula is there the difference of nearly equal numbers.
CANCELLATION_BELOW = 0.2

SIGN_PATTERNS = 5  # Number of patterns of signs: enough for the mean square of their changes within a factor of two

SHARE_ROWS = [ROW[name] for name in ABSOLUTE]
GAP_ROWS = [ROW["central_gap"], ROW["minimum_gap"]]
POSITION_ROWS = [ROW[row.name] for row in RUPTURE_ROWS]


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimated errors of the observables, each an array over ALL_NAMES, nan where there are none."""

    discretisation: Array = field(repr=False)
    interpolation: Array = field(repr=False)
    rounding: Array = field(repr=False)
    scales: Array = field(repr=False)
    minimum_position: float = math.nan  # Absolute error of the position of the minimum gap [a]

    def at_most(self, difference: Array) -> ErrorEstimate:
        """Return the estimate with no discretisation error above twice the ``difference`` from a clearly coarser mesh."""
        # In thin films the pressure between the nodes, not the state, makes the defect large.
        return replace(self, discretisation=np.fmin(self.discretisation, SAFETY * difference))

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

    unknowns: Array = field(repr=False)  # The defect first, then the patterns of rounding: (1 + SIGN_PATTERNS, rows, unknowns)
    friction: Array = field(repr=False)  # Of the friction integrals on the finer nodes: (3, rows)


def perturbations(states: StackedStates, observed: Array, fine: FineOperators) -> Perturbations:
    """Return the changes of states by defect, quadrature and rounding; ``observed`` as in :func:`error_estimates`."""
    equations, op, at, y = states.equations, states.equations.operators, states.equations.layout, states.y
    coarse, mesh, film, u = fine.coarse, fine.mesh, states.equations.film, equations.fields(y)
    far_gap = equations.far_gap(u)
    integral, d = fine.integral(op.reformation), equations.cavity_stretch(y)
    h, z0, h_star = y[:, at.gap], y[:, at.offset], y[:, at.flux_gap]
    balance, net = at.offset.start, at.flux_gap.start
    gap = np.exp(coarse.to_order(np.log(h / coarse.far), mesh.order)) * mesh.far
    own, finer = slice(-coarse.order, None), slice(-mesh.order, None)  # through infinity, where the gap holds a logarithm
    smooth = h[:, own] - far_gap(coarse.nodes[own])
    gap[:, finer] = smooth @ between_orders(coarse.order, mesh.order) + far_gap(mesh.nodes[finer])
    known = equations.fluid_pressure(y) if film.uses_pressure else None
    fluid = None if known is None else coarse.to_order(known * coarse.stretch, mesh.order) / mesh.stretch
    flat = np.asarray((np.abs(h - h_star) < CANCELLATION_BELOW * h).reshape(len(y), coarse.panels, -1).all(axis=2))
    clip = _clip_to_coarse_error(coarse, flat, mesh.order) if is_thinning(film) and flat.any() else None

    slopes = gradient_in_film(film, integral, gap, fluid, h_star)
    if flat.any():
        smooth = gradient_in_film(film, op.integral, h, known, h_star)
        if clip is not None:
            smooth = clip(slopes, smooth)
        elif not is_rough(film):
            smooth = coarse.to_order(smooth, mesh.order)
        else:  # what conducts is no such difference, and may turn sharply
            by_flux = Trace.number("flux_gap", h_star)
            conducted = gradient_in_film(film, op.integral, h, known, by_flux).columns["flux_gap"]
            finer_conducted = gradient_in_film(film, integral, gap, fluid, by_flux).columns["flux_gap"]
            missing = np.divide(smooth, conducted, out=np.zeros_like(smooth), where=conducted != 0)
            smooth = coarse.to_order(missing, mesh.order) * finer_conducted
        slopes = np.where(np.repeat(flat, mesh.order, axis=1), smooth, slopes)
    jump = jump_of(film)
    jumps = None if jump is None else jump(gap, fluid)
    if jumps is not None:
        slopes = slopes + 0.5 * jumps
    integrated = equations.speed * integral(slopes)
    if d is not None:
        integrated = d * integrated + np.where(integral.outside_gap, 0.0, op.model.cavity_pressure)
    lowered = None if fluid is None else fine.lowered(integrated)
    if fluid is None or lowered is None:
        fluid = unresolved = integrated
    else:  # what the nodes hold of it is a row of its own; through infinity it may have a kink
        unresolved = fluid + integrated - coarse.to_order(lowered * coarse.stretch, mesh.order) / mesh.stretch
        fluid[:, finer] = unresolved[:, finer] = integrated[:, finer]
    contact = equations.law.pressure(gap)
    pressure = contact + unresolved
    deflection = fine.deflection(pressure, op, d)
    residual = np.empty((1 + SIGN_PATTERNS, *y.shape))
    parabola = op.parabola if not op.has_exit else 0.5 * equations.positions(y) ** 2
    weights = fine.weights(op)
    load = pressure @ weights
    if d is not None:
        deflection = d * deflection - d * np.log(d) / math.pi * load[:, None]
        load = d[:, 0] * load
    residual[0, :, at.gap] = h - z0 - parabola - deflection
    residual[0, :, balance] = load - LOAD
    residual[0, :, net] = np.ravel(equations.flux_scale) * (slopes @ integral.weights)
    size = SAFETY * EPSILON
    residual[1:, :, at.gap] = size * (np.abs(z0) + parabola + np.abs(deflection))
    residual[1:, :, balance] = size * LOAD
    residual[1:, :, net] = size * np.ravel(equations.flux_scale) * (np.abs(slopes) @ integral.weights)
    if op.has_exit:
        ending = equations.ending
        at_end = slopes if ending is film else gradient_in_film(ending, integral, gap, fluid, h_star)
        _of_ends(states, residual, integral, slopes, at_end, size)
    residual[:, :, at.pressure] = 0.0
    if known is not None and lowered is not None:
        residual[0, :, at.pressure] = known - lowered
        residual[0, :, at.pressure][:, -coarse.order :] = 0.0
    residual[1:] *= _signs(coarse.panels, coarse.order, at.size - at.numbers.start, at.numbers.start)[:, None]
    unknowns = states.correction(residual)
    known_friction = observed[:, DRAG_ROWS].T
    friction = known_friction
    if equations.is_sliding:
        film_on_mesh = FilmOnMesh(integral, gap, fluid, contact, Matrix(weights[None]), clip)
        friction = np.stack([each[:, 0] for each in viscous_friction(equations, u, states.load, film_on_mesh)])
    return Perturbations(unknowns, np.abs(friction - known_friction))


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


def _of_ends(
    states: StackedStates, residual: Array, integral: RunningIntegral, slopes: Array, at_end: Array, size: float
) -> None:
    """Write the rows of the ends of the film: defect on finer nodes, interpolation error at the exit, rounding."""
    # ``slopes`` is G at the finer nodes, ``at_end`` the gradient that vanishes at the exit.
    equations, op, at, y = states.equations, states.equations.operators, states.equations.layout, states.y
    coarse, mesh, scale = op.mesh, integral.mesh, np.ravel(equations.flux_scale)
    left = slice((op.integral.middle - 1) * coarse.order, op.integral.middle * coarse.order)
    of_fine = slice((integral.middle - 1) * mesh.order, integral.middle * mesh.order)
    h = y[:, at.gap][:, left]
    pressure = y[:, at.pressure] if equations.film.uses_pressure else None
    by_gap = Trace.number("gap", y[:, at.gap])
    of_exit = gradient_in_film(equations.ending, op.integral, by_gap, pressure, y[:, at.flux_gap]).columns["gap"]
    steep = np.abs(of_exit[:, left.stop - 1] * h[:, -1])
    missed = interpolation_error(np.log(h / coarse.far[left]))
    at_edge = at_end[:, of_fine] @ reference(mesh.order).left_end[::-1]
    residual[0][:, at.exit] = (scale * (np.abs(at_edge) + steep * missed))[:, None]
    residual[1:, :, at.exit] = (size * scale * steep)[:, None]
    cavity_stretch = equations.cavity_stretch(y)
    if cavity_stretch is not None:
        d, in_cavity = cavity_stretch[:, 0], op.model.cavity_pressure / np.ravel(equations.speed)
        net = at.flux_gap.start
        residual[0, :, net] = d * residual[0, :, net] - scale * in_cavity
        residual[0, :, at.cavity_stretch.start] = scale * (d * (slopes @ integral.weights_beyond) + in_cavity)
        beyond = np.abs(slopes) @ integral.weights_beyond
        residual[1:, :, at.cavity_stretch.start] = size * scale * (d * beyond + np.abs(in_cavity))


def interpolation_errors(states: StackedStates, minimum_positions: Array, central_positions: Array) -> Array:
    """Return the absolute errors of the interpolated central and minimum gap, shape (2, rows), at coordinates of the mesh."""
    mesh = states.equations.operators.mesh
    lowest = np.clip(np.searchsorted(mesh.edges, minimum_positions) - 1, 0, mesh.panels - 1)
    central = np.searchsorted(mesh.edges, central_positions, side="right") - 1
    panels = np.stack([central, lowest])
    gap = states.y[:, states.equations.layout.gap].reshape(len(lowest), mesh.panels, -1)[np.arange(len(lowest)), panels]
    return np.asarray(_between_nodes(mesh, gap, panels) * gap.min(axis=2))


def gap_is_resolved(mesh: Mesh, gap: Array, rtol: float, *, centre: float = 0.0, spread: float = 0.0) -> bool:
    """Return whether central and minimum gap are interpolated to ``rtol``, up to ``spread`` from the place of the minimum."""
    # These gaps are the first to lose resolution on a reused mesh.
    central = int(mesh.locate(np.array([centre]))[0][0])
    lowest = mesh.nodes[int(np.argmin(gap))]
    near = np.abs(mesh.centres[:-1] - lowest) <= mesh.half_widths[:-1] + spread
    panels = [central, *np.flatnonzero(near)]
    return bool((_between_nodes(mesh, gap.reshape(mesh.panels, -1)[panels], panels) <= rtol).all())


def _between_nodes(mesh: Mesh, gap: Array, panels: Indices | list[int]) -> Array:
    """Return the relative errors of gaps, shape (..., order), interpolated between the nodes of their ``panels``."""
    return np.asarray(SAFETY * interpolation_error(np.log(gap / mesh.far.reshape(mesh.panels, -1)[panels])))


@lru_cache(maxsize=64)
def _signs(panels: int, order: int, numbers: int, fields: int) -> Array:
    """Return fixed patterns of signs, each constant on a panel, shape (SIGN_PATTERNS, fields + numbers)."""
    signs = np.random.default_rng(panels).choice(np.array([-1.0, 1.0]), (SIGN_PATTERNS, panels + numbers))
    nodal = np.repeat(signs[:, numbers:], order, axis=1)
    return np.hstack([nodal, np.zeros((SIGN_PATTERNS, fields - panels * order)), signs[:, :numbers]])


def error_estimates(states: StackedStates, observed: list[Observables], fine: FineOperators) -> list[ErrorEstimate]:
    """Return the estimated errors of the observables ``observed``."""
    # At speed zero the values may be those of the same state under another load, see stribeck.solver.at_rest.
    values = np.array([one.array() for one in observed])
    changed = perturbations(states, values, fine)
    effects = np.abs(changes(states.equations, states.y, states.load, changed.unknowns)).transpose(1, 2, 0)
    op, positions = states.equations.operators, np.array([one.minimum_position for one in observed])
    centres, stretch = np.zeros(len(values)), np.ones(len(values))
    if op.has_exit:
        d, exits = states.equations.cavity_stretch(states.y), states.y[:, states.equations.layout.exit.start]
        stretch = stretch if d is None else d[:, 0]
        centres, positions = -exits / stretch, (positions - exits) / stretch
    effects[:, DRAG_ROWS, 0] += changed.friction.T
    interpolation = np.zeros_like(values)
    interpolation[:, GAP_ROWS] = interpolation_errors(states, positions, centres).T
    scales = np.abs(values)
    scales[:, POSITION_ROWS] = np.maximum(1.0, scales[:, POSITION_ROWS])
    scales[:, DRAG_ROWS] = drag_scales(values)
    scales[:, SHARE_ROWS] = 1.0
    scales[:, ROW["offset"]] = np.maximum(scales[:, ROW["offset"]], FLOOR)
    if not states.equations.is_sliding:
        scales[:, GAP_ROWS] = np.maximum(scales[:, GAP_ROWS], FLOOR * states.equations.law.decay_length)
    scales[scales == 0] = 1.0
    rounding = SAFETY * np.sqrt((effects[:, :, 1:] ** 2).mean(axis=2))
    gap = states.y[:, states.equations.layout.gap]
    minimum = ROW["minimum_gap"]
    depth = (effects[:, minimum, 0] + interpolation[:, minimum] + rounding[:, minimum]) / gap.min(axis=1)
    of_gap = changed.unknowns[:, :, states.equations.layout.gap]
    places = stretch * position_errors(op.mesh, gap, of_gap, positions, depth)
    discretisation = DEFECT_SAFETY * effects[:, :, 0]
    if op.has_exit:
        places = places + (discretisation + rounding)[:, ROW["exit_position"]]
    missing = np.isnan(values)
    missing[:, : len(NAMES)] = False
    for part in (discretisation, interpolation, rounding):
        part[missing] = math.nan
    parts = (discretisation, interpolation, rounding, scales, places.tolist())
    return [ErrorEstimate(*row) for row in zip(*parts, strict=True)]
