"""The unknowns of a state by name: where each lies in the vector that Newton's iteration moves.

Fields have a value at every node, numbers have one.  The residual has the same layout: the row of the gap is that of the
elastic shape, the row of the pressure that of Reynolds' equation, the row of the offset the load balance, the row of the flux
gap the pressure that the film must end with, and the row of the exit the gradient there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stribeck._types import Array


@dataclass(frozen=True)
class Layout:
    """Names of the unknowns on a mesh, in their order.

    Attributes
    ----------
    nodes : int
        Nodes of the mesh.
    fields : tuple of str
        Unknowns with a value at each node.
    numbers : tuple of str
        Unknowns with one value, after the fields.
    """

    nodes: int
    fields: tuple[str, ...] = ("gap",)
    numbers: tuple[str, ...] = ("offset", "flux_gap")

    @property
    def size(self) -> int:
        """Number of all unknowns."""
        return self.nodes * len(self.fields) + len(self.numbers)

    @cached_property
    def _blocks(self) -> dict[str, slice]:
        n, first = self.nodes, self.nodes * len(self.fields)
        fields = {name: slice(k * n, (k + 1) * n) for k, name in enumerate(self.fields)}
        return fields | {name: slice(first + k, first + k + 1) for k, name in enumerate(self.numbers)}

    def __getitem__(self, name: str) -> slice:
        """Return where an unknown lies; a number keeps its axis, so that it is a column of stacked states."""
        return self._blocks[name]

    def __contains__(self, name: object) -> bool:
        """Return whether there is such an unknown."""
        return name in self._blocks

    def index(self, name: str) -> int:
        """Return the position of a number, without an axis of its own."""
        return int(self._blocks[name].start)

    def numbers_of(self, y: Array) -> Array:
        """Return the numbers of the unknowns ``y``, a view of shape (..., number of numbers)."""
        return y[..., self.nodes * len(self.fields) :]

    def stacked(self, **values: float | Array) -> Array:
        """Return the vector of unknowns that have these values, each field and number by its name."""
        return np.concatenate([np.atleast_1d(np.asarray(values[name], float)) for name in (*self.fields, *self.numbers)])
