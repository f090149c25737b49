"""The panels of a mesh with more nodes: what pressures there deflect at the nodes of the mesh."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.polynomial import legendre

from stribeck._types import Array
from stribeck.equations.operators import Operators
from stribeck.numerics.panels import Mesh, reference
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.numerics.settings import EXTRA_NODES
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
    """The panels of a mesh with more nodes, and what they add to it."""

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
    def of_highest(self) -> Array:
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
        """Return fine ``pressure`` at the coarse nodes, without its highest degrees."""
        density = (pressure * self.mesh.stretch).reshape(self.mesh.panels, -1)
        return np.asarray((density @ self._lowered.T).ravel() / self.coarse.stretch)


@dataclass(frozen=True, eq=False)
class EnrichedOperators(Operators):
    """The operators of equations whose pressures are known at the finer nodes: their rows are those of the mesh."""

    fine: FineOperators = field(kw_only=True)

    @classmethod
    def of(cls, operators: Operators, fine: FineOperators) -> EnrichedOperators:
        """Return those of a mesh and a model, with the deflection that the mesh has already."""
        found = cls(operators.mesh, operators.model, fine=fine)
        vars(found).update(deflection=operators.deflection)
        return found

    @cached_property
    def integral(self) -> RunningIntegral:
        """Finer nodal pressure gradients -> pressure there."""
        return self.fine.integral(self.reformation)

    @property
    def pressed(self) -> Mesh:
        """The finer nodes, where pressures are known."""
        return self.fine.mesh

    def by_kernel(self, pressure: Any, d: Any) -> Any:
        """Return the deflection under finer pressure, over the cavity stretch, without its logarithm."""
        mesh = self.fine.mesh
        if self.deflection_by_tail is not None and self.tail is not None:
            own = slice(-mesh.order, None)
            density = (pressure[own] * mesh.stretch[own]) @ self.tail.interpolation(mesh.order).T
            inner = pressure.copy()
            inner[own] = 0.0
            return self._by_degrees(inner, None) + density @ self.deflection_by_tail.T
        return self._by_degrees(pressure, d)

    def _by_degrees(self, pressure: Array, d: Any) -> Array:
        fine = self.fine
        density = (pressure * fine.mesh.stretch).reshape(fine.mesh.panels, -1)
        highest = density @ reference(fine.mesh.order).to_legendre[fine.coarse.order :].T
        return np.asarray(super().by_kernel(fine.lowered(pressure), d) + fine.of_highest @ highest.ravel())
