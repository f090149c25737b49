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
from functools import cached_property

import numpy as np
from scipy.linalg import lu_solve

from . import reynolds
from ._types import Array
from .elasticity import deflection_operator
from .equations import LOAD, Equations
from .mesh import Mesh, legendre_tail
from .observables import NAMES, gradients
from .states import State

EXTRA_NODES = 4
"""Nodes that a panel gains where the defect is evaluated."""

SAFETY = 2.0
"""Factor from the estimated to the stated error."""

ROUNDING_UNITS = 4.0
"""Units in the last place by which the residual may be wrong; checked against meshes that should agree."""

OFFSET_FLOOR = 1e-3
"""The error of the offset is relative to it where it exceeds this; it crosses zero."""

GAP_FLOOR = 1e-3
"""At speed zero the gap crosses zero too: its error is relative to it where it exceeds this part of kappa."""


@dataclass(frozen=True, eq=False)
class FineOperators:
    """The panels of a mesh with more nodes, and the deflection that pressures there cause at the nodes of the mesh."""

    coarse: Mesh

    @cached_property
    def mesh(self) -> Mesh:
        """The panels with :data:`EXTRA_NODES` more nodes."""
        return self.coarse.refined(self.coarse.order + EXTRA_NODES)

    @cached_property
    def deflection(self) -> Array:
        """Fine nodal pressures -> deflection at the coarse nodes."""
        return deflection_operator(self.mesh, self.coarse.nodes)


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
    def floor(self) -> float:
        """The part of it that rounding causes and no mesh removes."""
        return float(np.nanmax(self.rounding / self.scales))


@dataclass(frozen=True)
class Changes:
    """What may be wrong: with the unknowns, by defect and by rounding, and with the gap between the nodes.

    ``unknowns`` has shape (1 + 2, len(y)), the defect first; ``interpolation`` holds the absolute errors of the
    interpolated central and least gap.
    """

    unknowns: Array = field(repr=False)
    interpolation: Array = field(repr=False)


def changes(state: State, fine: FineOperators) -> Changes:
    """Return what defect and rounding may change in a state."""
    equations, op, y = state.equations, state.equations.operators, state.y
    mesh = fine.mesh
    h_star = y[-1]
    gap = np.exp(state.mesh.to_order(state.shape, mesh.order)) * mesh.far
    slopes = reynolds.gradient(gap, h_star)
    pressure = equations.law.pressure(gap) + equations.speed * mesh.integral_from_infinity(slopes)
    deflection = fine.deflection @ pressure
    residual = np.empty((3, len(y)))
    residual[0, :-2] = y[:-2] - y[-2] - op.parabola - deflection
    residual[0, -2] = mesh.weights @ pressure - LOAD
    residual[0, -1] = equations.flux_scale * (mesh.weights @ slopes)
    size = np.finfo(float).eps * ROUNDING_UNITS
    noise = size * np.append(np.abs(y[-2]) + op.parabola + np.abs(deflection), [LOAD, 0.0])
    noise[-1] = size * equations.flux_scale * (mesh.weights @ np.abs(slopes))
    residual[1:] = _signs(len(y)) * noise
    assert state.root.factors is not None
    unknowns = -lu_solve(state.root.factors, residual.T, check_finite=False).T
    tails = legendre_tail(state.shape, state.mesh.order)
    central = int(np.searchsorted(state.mesh.edges, 0.0))
    least = int(np.argmin(state.gap)) // state.mesh.order
    missed = tails[central], tails[max(0, least - 1) : least + 2].max()
    gaps = state.gap[central * state.mesh.order], state.gap.min()
    return Changes(unknowns, SAFETY * np.multiply(missed, gaps))


def _signs(size: int) -> Array:
    """Two fixed patterns of signs without order, shape (2, size)."""
    k = np.arange(1, size + 1)
    return np.sign(np.stack([np.sin(2.399963 * k * k), np.cos(1.7 * k * k)]))


def error_estimate(state: State, values: Array, changes: Changes) -> ErrorEstimate:
    """Return the estimated errors of the observables ``values`` of a state from the possible ``changes`` of it.

    At speed zero the values may be those of the same state under another load, see ``solve.quasistatic_shift``.
    """
    effects = np.abs(gradients(state.equations, state.y, float(state.groups.load)) @ changes.unknowns.T)
    interpolation = np.zeros(len(NAMES))
    interpolation[[NAMES.index("central_gap"), NAMES.index("minimum_gap")]] = changes.interpolation
    scales = np.abs(values)
    scales[:2] = 1.0
    scales[NAMES.index("offset")] = max(scales[NAMES.index("offset")], OFFSET_FLOOR)
    decay = state.equations.law.decay if state.equations.speed == 0 else 0.0
    scales[2:4] = np.maximum(scales[2:4], GAP_FLOOR * decay)
    scales[scales == 0] = 1.0
    return ErrorEstimate(SAFETY * effects[:, 0], interpolation, effects[:, 1:].max(axis=1), scales)
