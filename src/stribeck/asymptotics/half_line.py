r"""Common parts of the boundary layers at the edge of a contact: a half-space under a pressure that grows like that of Hertz.

The pressure of Hertz in theory.md Eq. (9) has a root that no polynomial resolves.  A smooth pressure of the same far field,
whose gap is known, stands for it:

.. math::

    P_B = \sqrt2 \, \mathrm{Re} \sum_a c_a (i a - \xi)^{1/2}, \qquad
    H_B = \frac{2 \sqrt2}{3} \, \mathrm{Re} \sum_a c_a (\xi + i a)^{3/2}, \qquad a = 1, 2, 3, \quad c = (3, -3, 1) .

The moments 0, 1, 2 of a are then 1, 0, 0, so that :math:`P_B - P_H` carries no load and falls as :math:`|\xi|^{-7/2}` inside
and :math:`\xi^{-5/2}` outside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.numerics.panels import Mesh
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.quantities.lazy import cached_property
from stribeck.solids.half_plane import nodal_deflection

EQUAL_PANELS_UP_TO = 2.0  # Distance to which panels have equal width; farther out each is as wide as its distance.


@dataclass(frozen=True, eq=False)
class Base:
    """The smooth pressure of Hertz's far field at given positions, and its gap."""

    xi: Array  # Positions, the contact at negative ones

    @cached_property
    def _roots(self) -> tuple[Array, Array, Array]:
        r"""For each a :math:`m = |\xi + i a|`, :math:`(m - \xi)^{1/2}` and :math:`(m + \xi)^{1/2}`, without cancellation."""
        a = np.array([1.0, 2.0, 3.0]).reshape(-1, *(1,) * np.ndim(self.xi))
        m = np.hypot(self.xi, a)
        large = np.sqrt(m + np.abs(self.xi))
        inside = np.less(self.xi, 0)
        return m, np.where(inside, large, a / large), np.where(inside, a / large, large)

    @property
    def _steps(self) -> tuple[Array, Array]:
        """Differences of (m - xi)**(1/2) from a = 1 to 2 and from 2 to 3, without cancellation."""
        m, root, _ = self._roots
        return 3 / ((m[0] + m[1]) * (root[0] + root[1])), 5 / ((m[1] + m[2]) * (root[1] + root[2]))

    @property
    def root(self) -> Array:
        r"""A positive pressure of the same far field inside, :math:`[(1 + \xi^2)^{1/2} - \xi]^{1/2}`."""
        return np.asarray(self._roots[1][0])

    @property
    def root_excess(self) -> Array:
        """The difference of :attr:`root` and :attr:`pressure`, to full relative accuracy."""
        first, second = self._steps
        return 2 * first - second

    @property
    def pressure(self) -> Array:
        """The pressure P_B."""
        return self.root - self.root_excess

    @property
    def slope(self) -> Array:
        """Its derivative."""
        m, root, _ = self._roots
        return np.asarray(sum(-0.5 * c * f / each for c, f, each in zip((3, -3, 1), root, m, strict=True)))

    @property
    def gap(self) -> Array:
        """The gap H_B."""
        first, second = self._steps
        g = self._roots[2]
        return np.asarray((3 * g[0] ** 3 - 3 * g[1] ** 3 + g[2] ** 3) / 3 - 3 * (second - first))


@dataclass(frozen=True, eq=False)
class HalfLine:
    """Panels from ``-reach`` to about ``reach``; beyond them P - P_B is zero."""

    reach: float  # Smallest half-width of the box
    width: float  # Width of the panels near the edge
    order: int  # Nodes on each panel

    @cached_property
    def mesh(self) -> Mesh:
        """The panels; the last one, through infinity, carries nothing."""
        near = self.width * np.arange(1, round(EQUAL_PANELS_UP_TO / self.width) + 1)
        far = near[-1] * 2.0 ** np.arange(1, np.ceil(np.log2(self.reach / near[-1])) + 1)
        positive = np.concatenate([near, far])
        return Mesh(np.concatenate([-positive[::-1], [0.0], positive]), self.order)

    @cached_property
    def xi(self) -> Array:
        """Nodes, shape (n,)."""
        return self.mesh.nodes[: -self.order]

    @cached_property
    def base(self) -> Base:
        """The smooth pressure of Hertz's far field at the nodes."""
        return Base(self.xi)

    @cached_property
    def weights(self) -> Array:
        """Weights of the integral, shape (n,)."""
        return self.mesh.weights[: -self.order]

    @cached_property
    def deflection(self) -> Array:
        """Matrix from nodal pressures to the deflection, shape (n, n)."""
        return nodal_deflection(self.mesh, beyond=False)[: -self.order, : -self.order]

    @cached_property
    def deflection_of_gradient(self) -> Array:
        """Matrix from nodal pressure gradients, integrated from both ends, to the deflection, shape (n, n)."""
        padded = np.pad(self.deflection, ((0, 0), (0, self.order)))
        return RunningIntegral(self.mesh).after(padded)[:, : -self.order]

    def integral(self, gradient: Array) -> Array:
        """Return the integral of nodal values from either end to the nodes."""
        return RunningIntegral(self.mesh)(np.append(gradient, np.zeros(self.order)))[: -self.order]


@dataclass(frozen=True, eq=False)
class Layer:
    """A solved boundary layer."""

    line: HalfLine  # Its panels
    constant: float  # C, the constant of the gap beside the deflection
    load: float  # Integral of P - P_H
    excess: Array  # P - P_B at the nodes
    deflection: Array  # Deflection under it

    def gap(self, xi: Array) -> Array:
        """Return the gap H at any positions."""
        logarithm = -self.load / (2 * np.pi) * np.log1p(np.square(xi))
        nodal = self.deflection + self.load / (2 * np.pi) * np.log1p(np.square(self.line.xi))
        return Base(xi).gap + self.constant + logarithm + self._between(nodal, xi, -0.5)

    def pressure(self, xi: Array) -> Array:
        """Return the pressure P at any positions; to 1e-12 only beyond the panels on the free side."""
        return Base(xi).pressure + self._between(self.excess, xi, -1.5)

    def _between(self, nodal: Array, xi: Array, power: float) -> Array:
        """Interpolate what falls as a power of the distance, which continues it beyond the panels."""
        mesh, end = self.line.mesh, self.line.mesh.edges[-1]
        inside = np.clip(xi, -end, np.nextafter(end, 0.0)).ravel()
        values = mesh.interpolate(np.append(nodal, np.zeros(self.line.order)), inside).reshape(np.shape(xi))
        return np.asarray(values * np.maximum(1.0, np.abs(xi) / end) ** power)
