r"""The film of a ball that ruptures at the pressure of a cavity and re-forms behind it.

In the cavity :math:`p_f = p_\mathrm{cav}` and a part :math:`\phi` of the width is gas, elsewhere :math:`\phi = 0`.  Mass is

.. math:: R - \lambda \, U \, (\phi \, C) = 0, \qquad p_f \ge p_\mathrm{cav}, \quad \phi \ge 0, \quad
    \phi \, (p_f - p_\mathrm{cav}) = 0

with the weak residual R of Reynolds' equation at a node, the amount C that a full gap carries, and the outflow U from the
cells around nodes: upstream differences of first order, with which the film re-forms where it must.  Far from the contact
the film is full.

Source: [Jakobsson and Floberg 1957], [Olsson 1965] for the conservation of mass; [Elrod 1981] J. Lubr. Technol. 103, 350, for
the differences upstream.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.sparse import csc_matrix

from stribeck._types import Array, Flags
from stribeck.equations.cavities.system import CavitatedSystem
from stribeck.equations.point.system import Unknowns
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.numerics.settings import NEGLIGIBLE, SAFETY
from stribeck.quantities.lazy import cached_property


def edge_of(cavitated: Flags) -> Flags:
    """Return the cavitated nodes beside one with a film."""
    film = ~np.pad(cavitated, 1, mode="edge")
    return np.asarray(cavitated & (film[:-2, 1:-1] | film[2:, 1:-1] | film[1:-1, :-2] | film[1:-1, 2:]))


def outflow(mesh: PolarMesh) -> csc_matrix:
    """Return the outflow from the cells around the nodes, of a field that moves along x."""
    modes, rings = mesh.modes, mesh.rings
    edges = np.sqrt(np.append(0.0, 2.0 * np.cumsum(mesh.ring_weights * mesh.radii)))
    sides = np.arange(modes + 1) * (np.pi / modes)
    node = np.arange(modes * rings).reshape(modes, rings)
    outwards = np.multiply.outer(np.diff(np.sin(sides)), edges[1:])
    inner, outer, through = node[:, :-1], node[:, 1:], outwards[:, :-1]
    rim = np.maximum(outwards[:, -1], 0.0)
    inwards = np.multiply.outer(np.sin(sides[1:-1]), np.diff(edges))  # towards smaller angles
    rows, columns, values = [node[:, -1]], [node[:, -1]], [rim]
    for begin, end, amount in (
        (inner, outer, np.maximum(through, 0.0)),
        (outer, inner, np.maximum(-through, 0.0)),
        (node[1:], node[:-1], inwards),
    ):
        rows += [begin.ravel(), end.ravel()]
        columns += [begin.ravel(), begin.ravel()]
        values += [amount.ravel(), -amount.ravel()]
    shape = (mesh.size, mesh.size)
    return csc_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=shape)


@dataclass(frozen=True, eq=False)
class ReformingEquations(CavitatedSystem):
    """The discretised problem of a film that re-forms behind a cavity at the pressure ``least``."""

    finest: ClassVar[float] = 2e-3
    order: ClassVar[float] = 1.0

    @cached_property
    def spread(self) -> csc_matrix:
        """Residual at all nodes by unit gas at each, shape (nodes, nodes)."""
        return outflow(self.operators.mesh)

    def gas(self, y: Unknowns) -> Array:
        """Return the part of the width that is gas, at the nodes: the mean of inflow and outflow of their cells."""
        cavitated = y.fluid <= self.least
        passing, flow = self.passing(cavitated), self.flow(y.gap, y.fluid, y.offset)
        found = passing.gas(flow) - 0.5 * flow / passing.weights
        full = self.speed * self.film.carried(y.gap, y.fluid)
        return np.where(cavitated, np.clip(found / full, 0.0, 1.0), 0.0)

    def shear_error(self, y: Unknowns) -> float:
        """Return an estimate of the error of the total shear over h, by the void fraction and by the edge of the cavity."""
        # With shear flow streaks may fill less than the whole width from the rupture line on, which lies between
        # nodes: half of the cells there.
        at_edge = np.maximum(0.0, 1.0 - self.film.filled(y.gap)) / y.gap * edge_of(y.fluid <= self.least)
        return self.gas_error(y) + 0.5 * float((at_edge @ self.operators.mesh.area_weights).sum())

    def gas_error(self, y: Unknowns) -> float:
        """Return an estimate of that by the gas: a part of the outflow, as cells do not resolve it."""
        cavitated, mesh = y.fluid <= self.least, self.operators.mesh
        released = np.where(cavitated, self.flow(y.gap, y.fluid, y.offset) / self.passing(cavitated).weights, 0.0)
        lost = self.film.filled(y.gap) * released / (self.speed * self.film.carried(y.gap, y.fluid) * y.gap)
        return SAFETY * NEGLIGIBLE * abs(float((lost @ mesh.area_weights).sum()))

    def shear_missing(self, y: Unknowns) -> Array:
        """Return the shear over h missing on each ring in the dry streaks of the cavity, shape (rings,)."""
        # Streaks fill the width that the flowing volume takes at the mean speed of the walls: with shear flow not the liquid
        # fraction.
        mesh, filled = self.operators.mesh, self.film.filled(y.gap)
        dry = np.where(y.fluid <= self.least, np.maximum(0.0, 1.0 - filled + filled * self.gas(y)), 0.0)
        lost = dry * self.film.shear(mesh, self.speed, y.gap, y.fluid) / y.gap
        return np.asarray(2.0 * np.pi / mesh.modes * mesh.radii * lost.sum(axis=0))
