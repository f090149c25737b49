"""What the equations ask of an elastic body: its deflection under a pressure on the line.

A new solid is a new file with one frozen class that has the members of :class:`Solid`, and ``lengths`` if it has any.
"""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

from stribeck._types import Array
from stribeck.numerics.panels import Mesh


class Lengths(NamedTuple):
    """The lengths of a body that a mesh must resolve [a]."""

    thickness: float = math.inf  # Of the thinnest layer; infinite without one
    memories: tuple[float, ...] = ()  # Over which the body remembers the pressure that has passed

    def joined(self, other: Lengths) -> Lengths:
        """Return the lengths of two bodies."""
        return Lengths(min(self.thickness, other.thickness), self.memories + other.memories)


def lengths_of(solid: Solid) -> Lengths:
    """Return the lengths that a solid has beside the width of the contact: none where it does not tell any."""
    return getattr(solid, "lengths", Lengths())


class Solid(Protocol):
    """An elastic body: frozen, hashable as operators are kept by it, in Hertz units."""

    @property
    def name(self) -> str:
        """Name that outputs print."""

    @property
    def parameters(self) -> dict[str, float | str]:
        """What distinguishes this body from others of its name, for outputs."""

    def scaled(self, length: float, speed: float = 1.0) -> Solid:
        """Return the body in Hertz units, from SI, by the Hertz half-width and the speed of its surface."""

    def deflection(self, mesh: Mesh) -> Array:
        """Return the matrix from nodal pressures to the deflection at the nodes, shape (size, size), in Fortran order."""

    def __hash__(self) -> int:
        """Return the same for the same body: operators are kept by it."""
        return object.__hash__(self)

    def far_gap(self, x: Array) -> Array:
        """Return the gap far away but for the offset and a smooth function of ``1/x`` [u_Hz]."""
