r"""A film in time: the steady equations, whose flux changes along the contact by what the gap swallows.

With time in 2a/U_0 and s the speed over U_0, of a full Newtonian film,

.. math::

    p_f' = \lambda \frac{s h - m}{h^3}, \qquad m(x) = m_0 - \int_0^x \partial_t h \, dx

All else is the residual of :mod:`stribeck.equations.line`, m_0 in the place of the flux gap.  At the end of a step the rate of
the gap is ``rate * h - before``, with what the formula of the step takes from earlier states in ``before``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.equations.line import Equations, Fields
from stribeck.fluids.fluid import Film
from stribeck.numerics.newton import LU, Inverse
from stribeck.numerics.panels import Mesh, reference
from stribeck.numerics.trace import Matrix, act, pointwise

__all__ = ["Unsteady", "swallowed"]


@dataclass(frozen=True, eq=False)
class Unsteady(Equations):
    """The discretised problem at the end of one step in time."""

    share: float = 1.0  # Speed over U_0, with its sign
    rate: float = 0.0  # Factor of the gap in its rate
    before: Array | float = 0.0  # What earlier states leave of it
    volume: Matrix | None = None  # That of swallowed

    def carried(self, u: Fields) -> Any:
        """Return m at the nodes."""
        if self.volume is None or self.rate == 0.0:
            return u.flux_gap
        return u.flux_gap - act(self.volume, self.rate * u.gap - self.before)

    def gradient(self, film: Film, u: Fields, by: str | None = None) -> Any:
        """Return the gradient of the pressure over the speed group at the nodes."""
        s = self.share

        def over(h: Array, m: Array) -> tuple[Array, Array, Array]:
            cube = h**-3
            return (s * h - m) * cube, (3 * m / h - 2 * s) * cube, -cube

        return pointwise(over, u.gap, self.carried(u))

    def inverse(self, y: Array) -> Inverse:
        """Return the inverse of the Jacobian in units of the unknowns, by LU factors."""
        return LU.of(self.jacobian(y, self.units(y)), overwrite=True)


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
