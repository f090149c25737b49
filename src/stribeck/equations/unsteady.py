r"""A film in time: the steady equations, whose flux changes along the contact by what the film swallows.

With time in 2a/U_0 and s the speed over U_0, the film is that between walls at the share s of their speeds, and

.. math::

    p_f' = \lambda \, G_s(h, p_f, m), \qquad m(x) = m_0 - \int_0^x \partial_t (\rho h) \, dx

All else is the residual of :mod:`stribeck.equations.line`, m_0 in the place of the flux gap.  At the end of a step the rate of
:math:`\rho h` is ``rate * held - before``, with what the formula of the step takes from earlier states in ``before``.

A film that ``ends`` lies between the edges of :mod:`stribeck.equations.free_edge`; of a starved one, one of them is given.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.equations.free_edge import FilmBetween, film_between, integral_up_to
from stribeck.equations.line import Equations, Fields
from stribeck.fluids.fluid import Film
from stribeck.numerics.panels import Mesh, reference
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.numerics.trace import Matrix, Operator, act, value_of
from stribeck.quantities.lazy import cached_property

__all__ = ["Unsteady", "swallowed", "swallowed_up_to"]


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
