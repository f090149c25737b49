r"""The integral of a nodal function from infinity to each node, and what it makes of an operator that acts on it.

.. math:: F' = v, \qquad F(\pm\infty) = 0

Left of ``x = 0``, which is always an edge, it integrates from minus infinity, right of it from plus infinity; the two meet if
the whole integral vanishes.  With a gap between 0 and an edge ``reformation`` it integrates from plus infinity down to that
edge and is zero within the gap; with a gap up to infinity it is zero beyond 0.

The matrix A of this integral is never formed: inside a panel it is a block of the order of the panel, from panel to panel a
running sum.
"""

from dataclasses import dataclass

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.numerics.panels import Mesh, reference
from stribeck.quantities.lazy import cached_property


@dataclass(frozen=True, eq=False)
class RunningIntegral:
    """The integral from infinity on a mesh."""

    mesh: Mesh  # The panels
    reformation: float = 0.0

    @property
    def one_sided(self) -> bool:
        """Whether the integral ends at zero, from the left."""
        return self.reformation == np.inf

    @cached_property
    def middle(self) -> int:
        """Number of panels left of zero."""
        return int(np.searchsorted(self.mesh.edges, 0.0))

    @cached_property
    def second(self) -> int:
        """First panel right of the gap; the number of panels in ``x`` where there is none."""
        return int(np.searchsorted(self.mesh.edges, self.reformation)) if self.reformation < np.inf else self.mesh.panels - 1

    @cached_property
    def integrated(self) -> Flags:
        """Whether the value at each node is needed: outside the gap, and all over the panel through infinity."""
        found = self.outside_gap.copy()
        found[-self.mesh.order :] = True
        return found

    @cached_property
    def filled(self) -> Indices:
        """The nodes of :attr:`integrated`."""
        return np.flatnonzero(self.integrated)

    @cached_property
    def outside_gap(self) -> Flags:
        """Whether each node lies outside the gap, shape (size,)."""
        found = np.ones((self.mesh.panels, self.mesh.order), dtype=bool)
        found[self.middle : self.second] = False
        if self.one_sided:
            found[-1] = self.mesh.local[-1] < 0
        return found.ravel()

    @cached_property
    def blocks(self) -> Array:
        """Per panel, nodal values -> its part of the integral from infinity at its nodes, shape (panels, order, order)."""
        # Panels left of zero integrate from their left edge, panels right of it from their right edge, the last one from
        # infinity in its middle, where dx = -dt/t**2.
        mesh = self.mesh
        rule = reference(mesh.order)
        half = mesh.half_widths[:-1, None, None]
        from_left = half * rule.integral
        panel = np.arange(mesh.panels - 1)[:, None, None]
        inner = np.where(panel >= self.second, from_left - half * rule.weights, from_left)
        inner[self.middle : self.second] = 0.0
        tail = mesh.half_widths[-1] * (rule.left_half - rule.integral) * mesh.stretch[-mesh.order :]
        if self.one_sided:
            tail[mesh.local[-1] > 0] = 0.0
        return np.concatenate([inner, tail[None]])

    @cached_property
    def tail_weights(self) -> tuple[Array, Array]:
        """Weights on the last panel of the integrals over ``x < -X`` and over ``x > X``."""
        mesh = self.mesh
        left = mesh.half_widths[-1] * reference(mesh.order).left_half * mesh.stretch[-mesh.order :]
        return left, mesh.weights[-mesh.order :] - left

    @cached_property
    def weights(self) -> Array:
        """Weights of the whole integral: over the line, or up to zero where there is a gap; shape (size,)."""
        if self.reformation == 0.0:
            return self.mesh.weights
        found = np.zeros(self.mesh.size)
        upstream = slice(0, self.middle * self.mesh.order)
        found[upstream] = self.mesh.weights[upstream]
        found[-self.mesh.order :] = self.tail_weights[0]
        return found

    @cached_property
    def weights_beyond(self) -> Array:
        """Weights of the integral from the edge ``reformation`` to infinity, shape (size,)."""
        found = np.zeros(self.mesh.size)
        beyond = slice(self.second * self.mesh.order, -self.mesh.order)
        found[beyond] = self.mesh.weights[beyond]
        found[-self.mesh.order :] = self.tail_weights[1]
        return found

    @cached_property
    def _arrived(self) -> Array:
        """Row per panel: nodal values -> the integral from infinity to the edge at which the panel begins."""
        panels, order, found = self.mesh.panels, self.mesh.order, np.zeros((self.mesh.panels, self.mesh.size))
        each = self.mesh.weights.reshape(panels, order)
        for k, row in enumerate(found[:-1].reshape(panels - 1, panels, order)):
            if k < self.middle:
                row[:k], row[-1] = each[:k], self.tail_weights[0]
            elif k >= self.second:
                row[k + 1 : -1], row[-1] = -each[k + 1 : -1], -self.tail_weights[1]
        return found

    def __call__(self, values: Array) -> Array:
        """Return the integral at the nodes, shape (..., size), of nodal ``values``, shape (..., size)."""
        nodal = values.reshape(*values.shape[:-1], self.mesh.panels, self.mesh.order)
        result = np.matmul(self.blocks, nodal[..., None])[..., 0]
        result += (values @ self._arrived.T)[..., None]
        return np.asarray(result.reshape(values.shape))

    @cached_property
    def matrix(self) -> Array:
        """A itself, shape (size, size)."""
        return self.after(np.eye(self.mesh.size))

    def after(self, operator: Array) -> Array:
        """Return ``operator @ A``, shape (rows, size), in Fortran order."""
        columns = np.ascontiguousarray(operator.T).reshape(self.mesh.panels, self.mesh.order, -1)
        result = self._arrived.T @ columns.sum(axis=1)
        for own, block, column in zip(result.reshape(columns.shape), self.blocks, columns, strict=True):
            own += block.T @ column  # panel by panel: another matrix of this size costs more than the products
        return np.asarray(result.T)
