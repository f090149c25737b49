r"""The preconditioner of a film of a ball that is cavitated at some nodes.

That of the full film is banded; a capacitance matrix of the cavitated nodes is added: with :math:`Z = P^{-1} E`, E the
residuals of unit gas at each, and C the rows :math:`p_f` of these nodes, :math:`x = P^{-1} f + Z \mu` with
:math:`C Z \mu = f_E - C P^{-1} f`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy.linalg import lapack, lu_factor
from scipy.sparse import csc_matrix

from stribeck._types import Array, Indices
from stribeck.equations.point.preconditioner import BandedModes
from stribeck.numerics.fourier_panels import PolarMesh

if TYPE_CHECKING:
    from stribeck.equations.cavities.system import CavitatedLinear

__all__ = ["Capacitance", "Preconditioner"]

Single = npt.NDArray[np.float32]

# Change of the active set over the nodes of the factorised capacitance matrix up to which these factors are bordered; beyond
# that bordering costs more than factorising.
REFACTOR_FRACTION = 0.15

STORAGE_GROWTH = 1.2  # Columns allocated over columns needed: the active set grows by a few nodes a step

BLOCK_COLUMNS = 128  # Nodes whose columns are found together: their arrays stay in the cache, and their memory is used again


@dataclass(eq=False)
class Capacitance:
    """The preconditioner of the full film, and its response to unit residuals at nodes, kept per node."""

    banded: BandedModes
    mesh: PolarMesh
    shape: tuple[int, int]
    nodes: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    answers: Single = field(default_factory=lambda: np.zeros((0, 0), dtype=np.float32))
    """Z: changes of total pressure by mode and of the offset, shape (size + 1, nodes)."""
    totals: Single = field(default_factory=lambda: np.zeros((0, 0), dtype=np.float32))
    gaps: Single = field(default_factory=lambda: np.zeros((0, 0), dtype=np.float32))
    """Z at the nodes of the mesh: total pressure and gap, shape (size, nodes)."""
    room: list[Single] = field(default_factory=list)
    """Arrays of which these are the first columns."""
    last: _Factors | None = None

    def include(self, linear: CavitatedLinear) -> None:
        """Add the cavitated nodes that are new."""
        new = np.setdiff1d(np.flatnonzero(linear.cavitated), self.nodes)
        if new.size == 0:
            return
        before, self.nodes = self.nodes.size, np.append(self.nodes, new)
        if not self.room or self.room[0].shape[1] < self.nodes.size:
            wide = int(STORAGE_GROWTH * self.nodes.size)
            rooms = [np.empty((self.mesh.size + last, wide), dtype=np.float32) for last in (1, 0, 0)]
            for new_room, old_room in zip(rooms, self.room, strict=False):
                new_room[:, :before] = old_room[:, :before]
            self.room = rooms
        for start in range(before, self.nodes.size, BLOCK_COLUMNS):
            some = slice(start, min(start + BLOCK_COLUMNS, self.nodes.size))
            for each, part in zip(self.room, self._answers(linear, self.nodes[some]), strict=True):
                each[:, some] = part
        self.answers, self.totals, self.gaps = (each[:, : self.nodes.size] for each in self.room)

    def _answers(self, linear: CavitatedLinear, new: Indices) -> tuple[Single, Single, Single]:
        """Return the responses to unit residuals at some nodes: by mode, and of total pressure and gap at all nodes."""
        mesh, size = self.mesh, self.mesh.size
        own = (np.ones(new.size), new, np.arange(new.size + 1))
        unit = (csc_matrix(own, shape=(size, new.size)) if linear.spread is None else linear.spread[:, new]).tocoo()
        angle, ring = np.divmod(unit.row, mesh.rings)
        waves, modes = mesh.cosines[angle].T * unit.data, np.arange(mesh.modes)[:, None]
        right: Single = np.zeros((size + 1, new.size), dtype=np.float32)
        np.add.at(right, (modes * mesh.rings + ring, unit.col), waves.astype(np.float32))
        found = self.banded(right)
        by_mode, cosines = found[:-1].reshape(mesh.modes, mesh.rings, -1), mesh.cosines.astype(np.float32)
        deflected = np.matmul(linear.equations.operators.deflection.astype(np.float32), by_mode)
        total = (cosines @ by_mode.reshape(mesh.modes, -1)).reshape(size, -1)
        gap = (cosines @ deflected.reshape(mesh.modes, -1)).reshape(size, -1) + found[-1]
        return found, total, gap

    def block(self, linear: CavitatedLinear, rows: Indices, columns: Indices) -> Array:
        """Return C Z, the film pressures of cavitated nodes under unit residuals; both are places among the kept nodes."""
        at = self.nodes[rows]
        found, slope = self.totals[np.ix_(at, columns)], linear.contact_slope.ravel()[at]
        touching = np.flatnonzero(slope)
        found[touching] -= slope[touching, None].astype(np.float32) * self.gaps[np.ix_(at[touching], columns)]
        return np.asarray(found)

    def of(self, linear: CavitatedLinear) -> Preconditioner:
        """Return the preconditioner of a Jacobian, by the factors of the last one where few other nodes are cavitated."""
        self.include(linear)
        cavitated = linear.cavitated.ravel()[self.nodes]
        if self.last is not None:
            before = np.zeros(cavitated.size, dtype=bool)
            before[self.last.columns] = True
            if (before != cavitated).sum() <= REFACTOR_FRACTION * self.last.columns.size:
                joined, left = np.flatnonzero(cavitated & ~before), np.flatnonzero(before & ~cavitated)
                return Preconditioner(self, linear, self.last, joined, left)
        self.last = _Factors(np.flatnonzero(cavitated), None)
        if self.last.columns.size:
            square = self.block(linear, self.last.columns, self.last.columns)
            self.last = _Factors(self.last.columns, lu_factor(square, overwrite_a=True, check_finite=False))
        nothing = np.zeros(0, dtype=np.intp)
        return Preconditioner(self, linear, self.last, nothing, nothing)


@dataclass(frozen=True, eq=False)
class _Factors:
    """Factors of the capacitance matrix of some of the kept nodes."""

    columns: Indices
    factors: tuple[Array, npt.NDArray[np.int32]] | None
    borders: dict[int, Array] = field(default_factory=dict)
    """Solutions for nodes that border the matrix, by their place among the kept ones: they come again from step to step."""

    def beside(self, kept: Capacitance, linear: CavitatedLinear, added: Indices) -> Array:
        """Return the unit residuals that undo the film pressures under those at further nodes."""
        new = np.array([node for node in added.tolist() if node not in self.borders], dtype=np.intp)
        if new.size:
            self.borders.update(zip(new.tolist(), self.solve(-kept.block(linear, self.columns, new)).T, strict=True))
        return self._columns(added)

    def without(self, removed: Indices) -> Array:
        """Return the unit residuals under film pressures of one at some of the nodes."""
        new = np.array([node for node in removed.tolist() if node not in self.borders], dtype=np.intp)
        if new.size:
            units = (self.columns[:, None] == new).astype(np.float32)
            self.borders.update(zip(new.tolist(), self.solve(units).T, strict=True))
        return self._columns(removed)

    def _columns(self, nodes: Indices) -> Array:
        if not nodes.size:
            return np.zeros((self.columns.size, 0), dtype=np.float32)
        return np.stack([self.borders[node] for node in nodes.tolist()], axis=1)

    def solve(self, right: Array) -> Array:
        """Return the unit residuals that remove film pressures at these nodes."""
        if self.factors is None:
            return right
        return np.asarray(lapack.sgetrs(*self.factors, right)[0])


class Preconditioner:
    """An approximate inverse of a Jacobian with cavitated nodes."""

    # Nodes that joined or left the active set since the factors were made border the factors: a node that joined adds its
    # residual, the residual of one that left vanishes.

    def __init__(self, kept: Capacitance, linear: CavitatedLinear, base: _Factors, added: Indices, removed: Indices) -> None:
        self.kept, self.linear, self.base = kept, linear, base
        self.columns = np.concatenate([base.columns, added])
        self.at, self.added = kept.nodes[self.columns], added.size
        self.corner: tuple[Array, npt.NDArray[np.int32]] | None = None
        if added.size + removed.size:
            self.place = np.flatnonzero(np.isin(base.columns, removed))
            self.border = np.hstack([base.beside(kept, linear, added), base.without(removed)])
            self.rows = kept.block(linear, added, self.columns)
            corner = self._bordered(self.border)
            corner[: added.size, : added.size] += self.rows[:, base.columns.size :]
            self.corner = lu_factor(corner.astype(np.float32, copy=False), check_finite=False)

    def _bordered(self, old: Array) -> Array:
        """Return the effect of residuals at the nodes of the factors on the conditions of the bordering nodes."""
        return np.concatenate([self.rows[:, : self.base.columns.size] @ old, old[self.place]])

    def __call__(self, right: Array) -> Array:
        """Return about what the inverse of the Jacobian makes of a right-hand side."""
        linear, mesh = self.linear, self.kept.mesh
        rows = np.where(linear.cavitated, 0.0, right[:-1].reshape(linear.cavitated.shape) * linear.stiffness)
        x = self.kept.banded(np.append((mesh.cosines.T @ rows).ravel(), right[-1]))
        if not self.at.size:
            return np.asarray(x)
        missing = right[self.at] - linear.changes(x).fluid.ravel()[self.at]
        old = self.base.solve(missing[: self.base.columns.size])
        new = missing[self.base.columns.size :]
        if self.corner is not None:
            conditions = -self._bordered(old)
            conditions[: self.added] += new
            found = lapack.sgetrs(*self.corner, conditions)[0]
            old, new = old + self.border @ found, found[: self.added]
        residuals = np.zeros(self.kept.nodes.size, dtype=np.float32)
        residuals[self.columns] = np.concatenate([old, new])
        return np.asarray(x + self.kept.answers @ residuals)
