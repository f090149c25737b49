r"""The edges of a film on a mesh that does not move with them.

The film ends where pressure and gradient vanish together, so that the pressure is nowhere below the ambient one.  With the
gradient G of a film that goes on for ever, which is smooth across the edges a and b,

.. math:: G(a) = G(b) = 0, \qquad p_f(x) = \lambda \int_a^x G \, dx, \qquad \int_a^b G \, dx = 0

A change of an edge changes these integrals by less than itself, as G vanishes there: Newton's iteration needs no unknown
for it.  The edge of a starved film is given: its pressure is the ambient one there but rises at once.  The integrals up to
the edges are those of the polynomials of the panels.  On the side of the inlet the film mostly goes on for ever, on that of
the exit it does where the walls hardly move and the gap closes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array, Flags
from stribeck.numerics.panels import reference
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.numerics.trace import Matrix
from stribeck.quantities.lazy import cached_property

__all__ = ["FilmBetween", "film_between", "integral_up_to"]


@dataclass(frozen=True, eq=False)
class FilmBetween:
    """The operator from the gradient to the pressure of a film between its edges."""

    integral: RunningIntegral  # That of a film that goes on for ever
    edges: tuple[float, float]  # Their x, infinite where the film does not end [a]

    @cached_property
    def inside(self) -> Flags:
        """Whether each node lies in the film."""
        x = self.integral.mesh.nodes
        return np.asarray((x > self.edges[0]) & (x < self.edges[1]))

    @cached_property
    def _up_to(self) -> tuple[Array, Array]:
        """Weights of the integrals from minus infinity to the edges."""
        left, right = (integral_up_to(self.integral, edge) for edge in self.edges)
        return left, right

    @cached_property
    def net(self) -> Matrix:
        """Gradient -> its integral over the film."""
        left, right = self._up_to
        return Matrix((right - left)[None])

    @cached_property
    def _passed(self) -> tuple[Array, Array]:
        """What nodes left and right of zero add to the integral from infinity: columns, and the rows that they have."""
        (left, right), x = self._up_to, self.integral.mesh.nodes
        columns = np.stack([self.inside & (x < 0), self.inside & (x > 0)], axis=1).astype(float)
        return columns, np.stack([-left, self.integral.mesh.weights - right])

    def __call__(self, values: Array) -> Array:
        """Return the pressure at the nodes."""
        columns, rows = self._passed
        return np.asarray(self.inside * self.integral(values) + (values @ rows.T) @ columns.T)

    @cached_property
    def matrix(self) -> Array:
        """The matrix."""
        columns, rows = self._passed
        return self.inside[:, None] * self.integral.matrix + columns @ rows

    def after(self, operator: Array) -> Array:
        """Return ``operator @ self``."""
        columns, rows = self._passed
        return self.integral.after(operator * self.inside) + (operator @ columns) @ rows


def film_between(integral: RunningIntegral, gap: Array, g: Array, begins: tuple[int, float] | None = None) -> FilmBetween:
    """Return the film around the thinnest place that a nodal gap and its gradient G make, one edge (0 or 1) perhaps given."""
    mesh, order = integral.mesh, integral.mesh.order
    x, total = mesh.nodes[:-order], float(mesh.weights @ g)
    pressure = integral(g)[:-order] + np.where(x > 0, total, 0.0)
    # On either side the film ends where a pressure that goes on for ever is lowest, with infinity among such places.
    turns = np.flatnonzero((g[: -order - 1] < 0) & (g[1:-order] >= 0))
    middle = int(np.argmin(gap[:-order]))
    edges = []
    for side, at_infinity, infinity in ((turns[turns < middle], 0.0, -math.inf), (turns[turns >= middle], total, math.inf)):
        k = int(side[np.argmin(pressure[side])]) if len(side) else -1
        if k < 0 or pressure[k] >= at_infinity:
            edges.append(infinity)
        else:
            edges.append(float(x[k] + (x[k + 1] - x[k]) * g[k] / (g[k] - g[k + 1])))
    if begins is not None:
        edges[begins[0]] = begins[1]
    return FilmBetween(integral, (edges[0], edges[1]))


def integral_up_to(integral: RunningIntegral, place: float) -> Array:
    """Return the weights of the integral from minus infinity to a place on the panels in x, or at infinity."""
    mesh, order = integral.mesh, integral.mesh.order
    if math.isinf(place):
        return mesh.weights if place > 0 else np.zeros(mesh.size)
    rule = reference(order)
    k = int(np.searchsorted(mesh.edges, place, side="right")) - 1
    found = np.zeros((mesh.panels, order))
    found[:k] = mesh.weights.reshape(mesh.panels, order)[:k]
    found[-1] = integral.tail_weights[0]
    start = float(mesh.edges[k])
    half = 0.5 * (place - start)
    at = (start + half * (1 + rule.nodes) - mesh.centres[k]) / mesh.half_widths[k]
    found[k] = half * (rule.weights @ rule.interpolation(at))
    return found.ravel()
