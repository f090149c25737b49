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
from stribeck.numerics.settings import REBUILD_AT

if TYPE_CHECKING:
    from stribeck.equations.cavities.system import CavitatedLinear

__all__ = ["Capacitance", "Preconditioner"]

Single = npt.NDArray[np.float32]


@dataclass(eq=False)
class Capacitance:
    """The preconditioner of the full film, and its response to unit residuals at nodes, kept per node."""

    banded: BandedModes
    mesh: PolarMesh
    shape: tuple[int, int]
    nodes: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    answers: Single = field(init=False)
    """Z: changes of total pressure by mode and of the offset, shape (size + 1, nodes)."""
    totals: Single = field(init=False)
    gaps: Single = field(init=False)
    """Z at the nodes of the mesh: total pressure and gap, shape (size, nodes)."""
    last: Preconditioner | None = None

    def __post_init__(self) -> None:
        """Begin without nodes."""
        self.answers, self.totals, self.gaps = (np.zeros((self.mesh.size + last, 0), dtype=np.float32) for last in (1, 0, 0))

    def include(self, linear: CavitatedLinear) -> None:
        """Add the cavitated nodes that are new."""
        new = np.setdiff1d(np.flatnonzero(linear.cavitated), self.nodes)
        if new.size == 0:
            return
        self.nodes = np.append(self.nodes, new)
        # A ring of nodes at a time: their arrays stay in the cache.
        parts = [self._answers(linear, new[at : at + self.mesh.rings]) for at in range(0, new.size, self.mesh.rings)]
        kept = (self.answers, self.totals, self.gaps)
        self.answers, self.totals, self.gaps = (np.hstack(each) for each in zip(kept, *parts, strict=True))

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
        """Return the preconditioner of a Jacobian: the last one, where GMRES has few nodes to learn that broke or healed."""
        last = self.last
        if last is None or (last.cavitated != linear.cavitated).sum() > REBUILD_AT:
            self.include(linear)
            self.last = last = Preconditioner(self, linear)
        return last


class Preconditioner:
    """An approximate inverse of a Jacobian with cavitated nodes."""

    def __init__(self, kept: Capacitance, linear: CavitatedLinear) -> None:
        self.kept, self.linear, self.cavitated = kept, linear, linear.cavitated
        self.columns = np.flatnonzero(linear.cavitated.ravel()[kept.nodes])
        self.at = kept.nodes[self.columns]
        if self.at.size:
            square = kept.block(linear, self.columns, self.columns)
            self.factors = lu_factor(square, overwrite_a=True, check_finite=False)

    def __call__(self, right: Array) -> Array:
        """Return about what the inverse of the Jacobian makes of a right-hand side."""
        linear, mesh = self.linear, self.kept.mesh
        rows = np.where(linear.cavitated, 0.0, right[:-1].reshape(linear.cavitated.shape) * linear.stiffness)
        x = self.kept.banded(np.append((mesh.cosines.T @ rows).ravel(), right[-1]))
        if not self.at.size:
            return np.asarray(x)
        missing = right[self.at] - linear.changes(x).fluid.ravel()[self.at]
        residuals = np.zeros(self.kept.nodes.size, dtype=np.float32)
        residuals[self.columns] = lapack.sgetrs(*self.factors, missing)[0]
        return np.asarray(x + self.kept.answers @ residuals)
