r"""A film in time: the steady equations, whose flux changes along the contact by what the film swallows.

With time in 2a/U_0 and s the speed over U_0, the film is that between walls at the share s of their speeds, and

.. math::

    p_f' = \lambda \, G_s(h, p_f, m), \qquad m(x) = m_0 - \int_0^x \partial_t (\rho h) \, dx

All else is the residual of :mod:`stribeck.equations.line`, m_0 in the place of the flux gap.  At the end of a step the rate of
:math:`\rho h` is ``rate * held - before``, with what the formula of the step takes from earlier states in ``before``.

The mesh does not move with the edges of a film that ``ends``: they lie where pressure and gradient vanish together, so that
the pressure is nowhere below the ambient one.  With the gradient G of a film that goes on for ever, which is smooth across
the edges a and b,

.. math:: G(a) = G(b) = 0, \qquad p_f(x) = \lambda \int_a^x G \, dx, \qquad \int_a^b G \, dx = 0

A change of an edge changes these integrals by less than itself, as G vanishes there: Newton's iteration needs no unknown
for it.  The edge of a starved film is given: its pressure is the ambient one there but rises at once.  The integrals up to
the edges are those of the polynomials of the panels.  On the side of the inlet the film mostly goes on for ever, on that of
the exit it does where the walls hardly move and the gap closes.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck._types import Array, Flags
from stribeck.equations.line import Equations, Fields
from stribeck.fluids.fluid import Film
from stribeck.numerics.dual import value_of
from stribeck.numerics.panels import Mesh, reference
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.numerics.trace import Matrix, Operator, act
from stribeck.quantities.lazy import cached_property


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


@dataclass(frozen=True, eq=False)
class Unsteady(Equations):
    """The discretised problem at the end of one step in time."""

    share: float = 1.0  # Speed over U_0, with its sign
    rate: float = 0.0  # Factor of the mass in its rate
    before: Array | float = 0.0  # What earlier states leave of it
    volume: Matrix | None = None  # That of swallowed
    ends: bool = False  # Whether the film ends where its pressure would fall below the ambient one
    begins: tuple[int, float] | None = None  # Of a starved film, the side of its inlet, 0 or 1, and where it begins [a]

    @cached_property
    def film(self) -> Film:
        """The film between walls at this share of their speeds."""
        return Equations(self.operators, self.speed, self.law).film.moving(self.share)

    def carried(self, u: Fields) -> Any:
        """Return m at the nodes."""
        return u.flux_gap if self.volume is None else self.carried_at(self.volume, u)

    def carried_at(self, swallowed: Matrix, u: Fields) -> Any:
        """Return m where an operator integrates up to."""
        if self.rate == 0.0:
            return u.flux_gap
        return u.flux_gap - act(swallowed, self.rate * self.film.held(u.gap, u.pressure) - self.before)

    def gradient(self, film: Film, u: Fields, by: str | None = None) -> Any:
        """Return the gradient of the pressure over the speed group at the nodes, as if the film went on for ever."""
        return super().gradient(film, u._replace(flux_gap=self.carried(u)), by)

    def between(self, u: Fields, g: Any) -> FilmBetween | None:
        """Return the film between its edges; None of one that goes on for ever."""
        if not self.ends:
            return None
        return film_between(self.operators.integral, value_of(u.gap), value_of(g), self.begins)

    def integral_to_end(self, u: Fields, g: Any) -> tuple[Operator, Operator]:
        """Return the operators from the gradient to the pressure, and to its whole integral, over the film."""
        film = self.between(u, g)
        return super().integral_to_end(u, g) if film is None else (film, film.net)


def swallowed_up_to(integral: RunningIntegral, place: float) -> Matrix:
    """Return the operator from nodal rates of the gap to their integral from zero to a place on the panels in x."""
    return Matrix((integral_up_to(integral, place) - integral_up_to(integral, 0.0))[None])


def swallowed(mesh: Mesh) -> Matrix:
    """Return the operator from nodal rates of the gap, smooth in 1/x far away, to their integral from zero to each node."""
    rule, order, panels = reference(mesh.order), mesh.order, mesh.panels
    middle = int(np.searchsorted(mesh.edges, 0.0))
    found = np.zeros((panels, order, panels, order))
    whole = mesh.half_widths[:, None] * rule.weights
    for k in range(panels - 1):
        block = mesh.half_widths[k] * rule.integral
        if k >= middle:
            found[k, :, k] = block
            found[k, :, middle:k] = whole[middle:k]
        else:
            found[k, :, k] = block - whole[k]
            found[k, :, k + 1 : middle] = -whole[k + 1 : middle]
    # Beyond the panels dx = -dt/t**2, from their end at t = +-1/X: the polynomial in t is integrated on panels that halve.
    for i, t in enumerate(mesh.local[-1]):
        side = np.sign(t)
        halvings = 1.0 / mesh.edges[-1] / 2.0 ** np.arange(0.0, np.ceil(-np.log2(abs(t) * mesh.edges[-1])) + 1)
        ends = side * np.append(halvings[halvings > abs(t)], abs(t))
        for start, end in zip(ends[:-1], ends[1:], strict=True):
            at = 0.5 * (start + end) + 0.5 * (end - start) * rule.nodes
            part = -0.5 * (end - start) * rule.weights / at**2
            found[-1, i, -1] += part @ rule.interpolation(at / mesh.half_widths[-1])
        if side > 0:
            found[-1, i, middle:-1] = whole[middle:-1]
        else:
            found[-1, i, :middle] = -whole[:middle]
    return Matrix(found.reshape(mesh.size, mesh.size))
