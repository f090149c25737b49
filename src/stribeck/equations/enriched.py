"""The panels of a mesh with more nodes: what pressures there deflect at the nodes of the mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from stribeck._types import Array
from stribeck.equations.operators import Operators
from stribeck.numerics.panels import Mesh, reference
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.quantities.lazy import cached_property
from stribeck.solids.half_plane import (
    log_moments,
    near_distance,
    near_infinity,
    near_panels,
    nodes_at_infinity,
    nodes_of,
    nodes_on_panel,
    panels_from_infinity,
)

__all__ = ["FineOperators"]

# Nodes that a panel gains where the defect is evaluated. Of the error on a wide panel over which the asperity pressure of a
# Gaussian surface dies away two see a fifth, four nine tenths, eight no more; an odd number has a node at infinity.
EXTRA_NODES = 4


def _by_highest(s: Array, order: int) -> Array:
    """Moments of the logarithm with the degrees that a panel of ``order`` nodes gains, at those targets s that are near."""
    near = np.abs(s) < near_distance(order)
    found = np.zeros((len(s), EXTRA_NODES))
    found[near] = log_moments(s[near], order + EXTRA_NODES)[:, order:]
    return found


def _seen_from_infinity(centre: Array, half_width: Array, nodes: Array) -> Array:
    """Nodes of a panel in ``x``, in units of the edge of the panel through infinity, in the coordinate of the latter."""
    return np.asarray(1 / (centre + half_width * nodes))


@dataclass(frozen=True, eq=False)
class FineOperators:
    """The panels of a mesh with more nodes, and the deflection by pressures there at the nodes of the mesh."""

    # The deflection by degrees that the mesh holds is that on the mesh; the deflection by higher degrees falls so fast with
    # the distance from their panel that only its neighbourhood counts.

    coarse: Mesh

    @cached_property
    def mesh(self) -> Mesh:
        """The panels with :data:`EXTRA_NODES` more nodes."""
        return self.coarse.refined(self.coarse.order + EXTRA_NODES)

    @cached_property
    def _integrals(self) -> dict[float, RunningIntegral]:
        return {}

    def integral(self, reformation: float = 0.0) -> RunningIntegral:
        """Return the integral from infinity on that mesh, see :class:`RunningIntegral`."""
        return self._integrals.setdefault(reformation, RunningIntegral(self.mesh, reformation))

    @cached_property
    def _lowered(self) -> Array:
        """Fine nodal values -> coarse nodal values of the polynomial without its highest degrees."""
        m = self.coarse.order
        return legendre.legvander(reference(m).nodes, m - 1) @ reference(self.mesh.order).to_legendre[:m]

    @cached_property
    def _of_highest(self) -> Array:
        """Highest Legendre coefficients on all panels -> the deflection by them, shape (size, panels * EXTRA_NODES)."""
        mesh, m = self.coarse, self.coarse.order
        found = np.zeros((mesh.panels, m, mesh.panels, EXTRA_NODES))
        target, source, near = near_panels(mesh)
        outermost, places, nodes = np.flatnonzero(near_infinity(mesh)), panels_from_infinity(mesh), reference(m).nodes
        targets = [
            nodes_of(nodes_on_panel, near, m),
            nodes_of(nodes_at_infinity, places[outermost], m),
            nodes_of(_seen_from_infinity, places, m),
        ]
        highest = _by_highest(np.concatenate([*targets, nodes[None]]).ravel(), m).reshape(-1, m, EXTRA_NODES)
        parts = np.split(highest, np.cumsum([len(each) for each in targets]))
        found[target, :, source], found[-1, :, outermost], found[:-1, :, -1], found[-1:, :, -1] = parts
        found *= mesh.half_widths[:, None] / -np.pi
        return found.reshape(mesh.size, -1)

    def lowered(self, pressure: Array) -> Array:
        """Return rows of fine ``pressure`` at the coarse nodes, without their highest degrees."""
        density = (pressure * self.mesh.stretch).reshape(len(pressure), self.mesh.panels, -1)
        return np.asarray((density @ self._lowered.T).reshape(len(pressure), -1) / self.coarse.stretch)

    def weights(self, operators: Operators) -> Array:
        """Return the row that integrates fine pressures to the load, as the ``operators`` do for coarse ones."""
        mesh, tail = self.mesh, operators.tail
        if tail is None:
            return mesh.weights
        found, own = mesh.weights.copy(), slice(-mesh.order, None)
        found[own] = (tail.weights @ tail.interpolation(mesh.order)) * mesh.stretch[own]
        return found

    def deflection(self, pressure: Array, operators: Operators, cavity_stretch: Array | None = None) -> Array:
        """Return the deflection at coarse nodes under rows of fine ``pressure``, over the cavity stretch, without its log."""
        if operators.deflection_by_tail is not None and operators.tail is not None:
            own = slice(-self.mesh.order, None)
            density = (pressure[:, own] * self.mesh.stretch[own]) @ operators.tail.interpolation(self.mesh.order).T
            inner = pressure.copy()
            inner[:, own] = 0.0
            return self._deflection(inner, operators, None) + density @ operators.deflection_by_tail.T
        return self._deflection(pressure, operators, cavity_stretch)

    def _deflection(self, pressure: Array, operators: Operators, cavity_stretch: Array | None) -> Array:
        density = (pressure * self.mesh.stretch).reshape(len(pressure), self.mesh.panels, -1)
        lowered = self.lowered(pressure)
        highest = density @ reference(self.mesh.order).to_legendre[self.coarse.order :].T
        found = lowered @ operators.deflection.T if cavity_stretch is None else operators.by_kernel(lowered, cavity_stretch)
        return found + highest.reshape(len(pressure), -1) @ self._of_highest.T
