r"""A-posteriori error of the observables: what the mesh, Newton's iteration and rounding leave.

The state is put on the same panels with more nodes, where the pressures that its gap implies are evaluated anew.  The
residual that they leave is the defect of the state, and one solve with the factors of Newton's last Jacobian turns it into the
change of the unknowns that removing the defect would bring, to first order:

.. math:: \delta y = -J^{-1} R_\mathrm{fine}(y)

Rounding is treated alike: the residual is known to a few units in the last place of its largest term, with signs that
nobody knows.  Both changes become errors of the observables by their gradients.
To them comes what the polynomials on the panels miss between the nodes.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import lapack

from . import reynolds
from ._types import Array, Indices
from .elasticity import log_moments, near_distance
from .equations import LOAD, Operators
from .mesh import Mesh, interpolation_error, reference
from .observables import NAMES, Observables, friction_integrals, friction_scale, gradients
from .states import State

EXTRA_NODES = 2
"""Nodes that a panel gains where the defect is evaluated."""

SAFETY = 2.0
"""Factor from the estimated to the stated error."""

FLAT = 0.2
"""Where the gap differs from the flux gap by less than this part of itself all over a panel, the pressure gradient is smoother
than its formula in the gap, which there is the difference of nearly equal numbers; it is interpolated itself."""

ROUNDING_UNITS = 4.0
"""Units in the last place by which the residual may be wrong; checked against meshes that should agree."""

OFFSET_FLOOR = 1e-3
"""The error of the offset is relative to it where it exceeds this; it crosses zero."""

GAP_FLOOR = 1e-3
"""At speed zero the gap crosses zero too: its error is relative to it where it exceeds this part of kappa."""


@dataclass(frozen=True, eq=False)
class FineOperators:
    """The panels of a mesh with more nodes, and the deflection that pressures there cause at the nodes of the mesh.

    The degrees that the mesh itself holds deflect as on it.  Those above fall so fast with the distance from their panel that
    only its neighbourhood feels them.
    """

    coarse: Mesh

    @cached_property
    def mesh(self) -> Mesh:
        """The panels with :data:`EXTRA_NODES` more nodes."""
        return self.coarse.refined(self.coarse.order + EXTRA_NODES)

    @cached_property
    def _lowered(self) -> Array:
        """Fine nodal values -> coarse nodal values of the polynomial without its highest degrees."""
        m = self.coarse.order
        return legendre.legvander(reference(m).nodes, m - 1) @ reference(self.mesh.order).to_legendre[:m]

    @cached_property
    def _near(self) -> tuple[Indices, Indices, Array]:
        """Targets, their near panels, and the deflection by the highest degrees of these, shape (pairs, EXTRA_NODES)."""
        mesh, m = self.coarse, self.coarse.order
        s = (mesh.nodes[:, None] - mesh.centres) / mesh.half_widths
        s[:, -1] = 1 / (mesh.nodes * mesh.half_widths[-1])
        target, panel = np.nonzero(np.abs(s) < near_distance(m))
        moments = log_moments(s[target, panel], m + EXTRA_NODES)[:, m:]
        return target, panel, moments * mesh.half_widths[panel, None] / -np.pi

    def deflection(self, pressure: Array, operators: Operators) -> Array:
        """Return the deflection at the coarse nodes under fine nodal ``pressure``, with the ``operators`` of the mesh."""
        density = (pressure * self.mesh.stretch).reshape(self.mesh.panels, -1)
        lowered = (density @ self._lowered.T).ravel() / self.coarse.stretch
        highest = density @ reference(self.mesh.order).to_legendre[self.coarse.order :].T
        target, panel, moments = self._near
        near = np.bincount(target, np.einsum("pk,pk->p", moments, highest[panel]), len(lowered))
        return operators.deflection @ lowered + near


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimated errors of the observables, each an array of shape (len(NAMES),); nan for one that does not exist.

    Attributes
    ----------
    discretisation, interpolation, rounding : ndarray
        Absolute errors left by mesh and iteration at the nodes, by the polynomials between them, and by rounding.
    scales : ndarray
        What each is relative to: one for the load shares, the observable itself for the others.
    """

    discretisation: Array = field(repr=False)
    interpolation: Array = field(repr=False)
    rounding: Array = field(repr=False)
    scales: Array = field(repr=False)

    def at_most(self, difference: Array) -> ErrorEstimate:
        """Return the estimate with no discretisation error above twice the ``difference`` from a clearly coarser mesh.

        Where the film is thin the pressure between the nodes, not the state, makes the defect large.
        """
        return replace(self, discretisation=np.fmin(self.discretisation, SAFETY * difference))

    @property
    def relative(self) -> Array:
        """Relative errors of the observables in the order of :data:`observables.NAMES`."""
        return np.asarray((self.discretisation + self.interpolation + self.rounding) / self.scales)

    @property
    def total(self) -> float:
        """The largest relative error."""
        return float(np.nanmax(self.relative))

    @property
    def between_nodes(self) -> float:
        """The part of it that the polynomials between the nodes cause."""
        return float(np.nanmax(self.interpolation / self.scales))

    @property
    def at_nodes(self) -> float:
        """The part of it that mesh and iteration cause at the nodes."""
        return float(np.nanmax(self.discretisation / self.scales))

    @property
    def floor(self) -> float:
        """The part of it that rounding causes and no mesh removes."""
        return float(np.nanmax(self.rounding / self.scales))


@dataclass(frozen=True)
class Changes:
    """What may be wrong with a state.

    ``unknowns``, shape (1 + 2, len(y)), are the changes that defect and rounding may cause, the defect first; ``friction``,
    shape (2,), is by how much the two friction integrals change on the finer nodes.
    """

    unknowns: Array = field(repr=False)
    friction: Array = field(repr=False)


def changes(state: State, observed: Observables, fine: FineOperators) -> Changes:
    """Return what defect, quadrature and rounding may change in a state."""
    equations, op, y = state.equations, state.equations.operators, state.y
    mesh = fine.mesh
    h_star = y[-1]
    gap = np.exp(state.mesh.to_order(state.shape, mesh.order)) * mesh.far
    slopes = reynolds.gradient(gap, h_star)
    flat = np.abs(state.gap - h_star) < FLAT * state.gap
    flat_panels = flat.reshape(state.mesh.panels, -1).all(axis=1)
    slopes = np.where(
        np.repeat(flat_panels, mesh.order), state.mesh.to_order(reynolds.gradient(state.gap, h_star), mesh.order), slopes
    )
    pressure = equations.law.pressure(gap) + equations.speed * mesh.integral_from_infinity(slopes)
    deflection = fine.deflection(pressure, op)
    residual = np.empty((3, len(y)))
    residual[0, :-2] = y[:-2] - y[-2] - op.parabola - deflection
    residual[0, -2] = mesh.weights @ pressure - LOAD
    residual[0, -1] = equations.flux_scale * (mesh.weights @ slopes)
    size = np.finfo(float).eps * ROUNDING_UNITS
    noise = size * np.append(np.abs(y[-2]) + op.parabola + np.abs(deflection), [LOAD, 0.0])
    noise[-1] = size * equations.flux_scale * (mesh.weights @ np.abs(slopes))
    residual[1:] = _signs(len(y)) * noise
    assert state.root.factors is not None
    unknowns = -lapack.dgetrs(*state.root.factors, residual.T)[0].T
    friction = np.zeros(2)
    if equations.speed > 0:
        finer = friction_scale(float(state.groups.load), equations.speed) * friction_integrals(mesh, gap, h_star, slopes)
        friction = np.abs(finer - [observed.viscous_paper, observed.viscous_balanced])
    return Changes(unknowns, friction)


def interpolation_errors(state: State, minimum_position: float) -> tuple[float, float]:
    """Return the absolute errors of the interpolated central and least gap."""
    mesh = state.mesh
    shapes, gaps = state.shape.reshape(mesh.panels, -1), state.gap.reshape(mesh.panels, -1)
    central = int(np.searchsorted(mesh.edges, 0.0))
    least = min(max(int(np.searchsorted(mesh.edges, minimum_position)) - 1, 0), mesh.panels - 1)
    return tuple(SAFETY * interpolation_error(shapes[k]) * float(gaps[k].min()) for k in (central, least))  # type: ignore[return-value]


@lru_cache(maxsize=64)
def _signs(size: int) -> Array:
    """Two fixed patterns of signs without order, shape (2, size)."""
    k = np.arange(1, size + 1)
    return np.asarray(np.sign(np.stack([np.sin(2.399963 * k * k), np.cos(1.7 * k * k)])))


def error_estimate(state: State, observed: Observables, fine: FineOperators) -> ErrorEstimate:
    """Return the estimated errors of what was ``observed`` on a state.

    At speed zero the values may be those of the same state under another load, see ``refine.quasistatic_shift``.
    """
    changed = changes(state, observed, fine)
    effects = np.abs(gradients(state.equations, state.y, float(state.groups.load)) @ changed.unknowns.T)
    effects[-2:, 0] += changed.friction
    interpolation = np.zeros(len(NAMES))
    interpolation[2:4] = interpolation_errors(state, observed.minimum_position)
    scales = np.abs(observed.array())
    scales[:2] = 1.0
    scales[NAMES.index("offset")] = max(scales[NAMES.index("offset")], OFFSET_FLOOR)
    decay = state.equations.law.decay if state.equations.speed == 0 else 0.0
    scales[2:4] = np.maximum(scales[2:4], GAP_FLOOR * decay)
    scales[scales == 0] = 1.0
    return ErrorEstimate(SAFETY * effects[:, 0], interpolation, effects[:, 1:].max(axis=1), scales)
