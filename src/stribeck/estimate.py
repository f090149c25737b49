r"""A-posteriori error of the observables: what the mesh, Newton's iteration and rounding leave.

The state is put on the same panels with more nodes, where the pressures that its gap implies are evaluated anew.  The
residual that they leave is the defect of the state, and one solve with the factors of Newton's last Jacobian turns it into the
change of the unknowns that removing the defect would bring, to first order:

.. math:: \delta y = -J^{-1} R_\mathrm{fine}(y)

Rounding is treated alike: the residual is known to a few units in the last place of its largest term, with signs that
nobody knows.  Both changes become errors of the observables by their gradients.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.linalg import lu_solve

from . import reynolds
from ._types import Array
from .elasticity import deflection_operator
from .equations import LOAD
from .mesh import Mesh
from .observables import NAMES, Observables, gradients
from .states import State

EXTRA_NODES = 4
"""Nodes that a panel gains where the defect is evaluated."""

SAFETY = 2.0
"""Factor from the estimated to the stated error."""

ROUNDING_UNITS = 4.0
"""Units in the last place by which the residual may be wrong; checked against meshes that should agree."""

OFFSET_FLOOR = 1e-3
"""The error of the offset is relative to it where it exceeds this; it crosses zero."""


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
        """Fine nodal pressures -> deflection at the coarse nodes and, in the last row, at zero."""
        return deflection_operator(self.mesh, np.append(self.coarse.nodes, 0.0))


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimated errors of the observables.

    Attributes
    ----------
    discretisation, rounding : ndarray, shape (len(NAMES),)
        Absolute errors left by mesh and iteration, and by rounding.
    scales : ndarray, shape (len(NAMES),)
        What each is relative to: one for the load shares, the observable itself for the others.
    """

    discretisation: Array = field(repr=False)
    rounding: Array = field(repr=False)
    scales: Array = field(repr=False)

    @property
    def relative(self) -> Array:
        """Relative errors of the observables in the order of :data:`observables.NAMES`."""
        return np.asarray((self.discretisation + self.rounding) / self.scales)

    @property
    def total(self) -> float:
        """The largest relative error."""
        return float(self.relative.max())

    @property
    def floor(self) -> float:
        """The part of it that rounding causes and no mesh removes."""
        return float((self.rounding / self.scales).max())


def changes(state: State, fine: FineOperators) -> Array:
    """Return the changes of the unknowns that defect and rounding may cause, shape (1 + 2, len(y)), the defect first."""
    equations, op, y = state.equations, state.equations.operators, state.y
    mesh = fine.mesh
    h_star = y[-1]
    far = 1 + mesh.nodes**2
    gap = np.exp(state.mesh.to_order(state.shape(state.mesh), mesh.order)) * far
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
    return np.asarray(-lu_solve(state.root.factors, residual.T, check_finite=False).T)


def _signs(size: int) -> Array:
    """Two fixed patterns of signs without order, shape (2, size)."""
    k = np.arange(1, size + 1)
    return np.sign(np.stack([np.sin(2.399963 * k * k), np.cos(1.7 * k * k)]))


def error_estimate(state: State, values: Observables, changes: Array, load: float, y: Array | None = None) -> ErrorEstimate:
    """Return the estimated errors of the observables ``values`` of a state from the possible ``changes`` of its unknowns."""
    y = state.y if y is None else y
    effects = np.abs(gradients(state.equations, y, load) @ changes.T)
    scales = np.abs(values.values())
    scales[:2] = 1.0
    scales[NAMES.index("offset")] = max(scales[NAMES.index("offset")], OFFSET_FLOOR)
    scales[scales == 0] = 1.0
    return ErrorEstimate(SAFETY * effects[:, 0], effects[:, 1:].max(axis=1), scales)
