"""The discretised problem of a cavitated film: its equations, its Jacobian, and where the void goes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from stribeck._types import Array, Flags
from stribeck.equations.point.system import Equations, Linear, Unknowns
from stribeck.numerics.fourier_panels import lobatto, radau


class VoidTransport:
    """The path of gas from cavitated nodes: downstream from node to node, until one with a film takes it."""

    def __init__(self, spread: csc_matrix | None, cavitated: Flags) -> None:
        self.cavitated, self.spread = cavitated, None
        self.weights: Array | float = 1.0
        """Residual of a cavitated node over its own gas."""
        if spread is not None:
            self.weights = spread.diagonal().reshape(cavitated.shape)
            self.at = np.flatnonzero(cavitated)
            self.spread = spread[:, self.at]
            self.factors = splu(self.spread[self.at]) if self.at.size else None

    def gas(self, flow: Array) -> Array:
        """Return the gas at the nodes that makes up for the residual at the cavitated ones."""
        if self.spread is None:
            return flow
        found = np.zeros(flow.size)
        if self.factors is not None:
            found[self.at] = self.factors.solve(flow.ravel()[self.at])
        return found.reshape(flow.shape)

    def rows(self, flow: Array) -> Array:
        """Return the residual with the gas of the cavitated nodes, which has to vanish at the others."""
        if self.spread is None or self.factors is None:
            return flow
        passed = self.spread @ self.factors.solve(flow.ravel()[self.at])
        return np.asarray(flow - passed.reshape(flow.shape))


@dataclass(frozen=True, eq=False)
class CavitatedSystem(Equations):
    """The discretised problem of a film that may break, by default at ambient pressure."""

    least: float = 0.0

    order: ClassVar[float] = 2.0

    @property
    def spread(self) -> csc_matrix | None:
        """Residuals by unit void at each node, node by node; None where a void acts at its own node alone."""
        return None

    def linear(self, y: Unknowns) -> CavitatedLinear:
        """Return the Jacobian at a solution."""
        return CavitatedLinear(self, y, y.fluid <= self.least)

    def with_same_active_set(self, y: Unknowns, like: Unknowns) -> Unknowns:
        """Return unknowns that break where a solution of neighbouring equations does."""
        least = like.fluid.min()
        fluid = np.where(like.fluid <= least, self.least, np.maximum(y.fluid, just_above(self.least)))
        return Unknowns(y.gap, fluid, y.offset)

    def passing(self, cavitated: Flags) -> VoidTransport:
        """Return where gas of cavitated nodes goes."""
        return VoidTransport(self.spread, cavitated)


def stiffness(linear: Linear) -> Array:
    """Return the diagonal of the pressure stiffness at the nodes, shape (modes, rings)."""
    mesh = linear.equations.operators.mesh
    squares = np.tile(lobatto(mesh.degree).derivative ** 2, (mesh.panels, 1, 1))
    squares[0] = radau(mesh.degree).derivative ** 2
    radial = np.matmul((linear.film.radial_of_pressure / mesh.stretch**2)[:, :, None, :], squares)[:, :, 0, :]
    return np.asarray(mesh.gathered(radial) + (mesh.angular_derivative**2).T @ linear.film.angular_of_pressure)


class CavitatedLinear(Linear):
    """The Jacobian at a state with cavitated nodes; rows of R_2 at the nodes, over the stiffness."""

    def __init__(self, equations: CavitatedSystem, y: Unknowns, cavitated: Flags) -> None:
        super().__init__(equations, y)
        self.stiffness, self.least, self.spread = stiffness(self), equations.least, equations.spread
        self.set_active(cavitated)

    def set_active(self, cavitated: Flags) -> None:
        """Take other nodes for cavitated."""
        self.cavitated, self.passing = cavitated, VoidTransport(self.spread, cavitated)

    def product(self, x: Array) -> Array:
        """Return the change of the rows at the nodes and of the load."""
        change = self.changes(x)
        rows = np.where(self.cavitated, change.fluid, self.passing.rows(self.flow(change.fluid, change.gap)) / self.stiffness)
        return np.append(rows.ravel(), self.equations.load_row @ x[: self.equations.operators.mesh.rings])

    def right(self, residual: tuple[Array, Array, float]) -> Array:
        """Return the right-hand side of the step."""
        return self.sources(residual, self.least - self.y.fluid)

    def sources(self, change: tuple[Array, Array, float], least: Array | float) -> Array:
        """Return the right-hand side for the change of the unknowns with that of the residual and of the least pressure."""
        shape, flow, load = change
        moved = self.flow(self.contact_slope * shape, -shape)
        cavitated = least - self.contact_slope * shape
        rows = np.where(self.cavitated, cavitated, -self.passing.rows(flow + moved) / self.stiffness)
        return np.append(rows.ravel(), -load)


def just_above(least: float) -> float:
    """Return the lowest pressure of a film that is not cavitated."""
    # Of a full film it is any pressure.
    return least if np.isinf(least) else least + max(float(np.finfo(float).eps) * abs(least), float(np.finfo(float).tiny))
