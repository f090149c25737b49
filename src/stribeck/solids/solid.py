"""What the equations ask of an elastic body: its deflection under a pressure on the line.

A new solid is a new file with one frozen class that has the members of :class:`Solid`, and ``lengths`` if it has any; one that
changes with the speed may have ``together(solids, mesh)``, which is :func:`deflecting` for such bodies.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, NamedTuple, Protocol

import numpy as np

from stribeck._types import Array
from stribeck.numerics.panels import Mesh

# Deflection matrices kept: the meshes at both ends of an interval and the finer one of an error estimate.
CACHED_DEFLECTIONS = 3


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


def deflecting(solids: Sequence[Solid], mesh: Mesh) -> Callable[[Array], Array]:
    """Return the function from rows of nodal pressure to the deflection of each on its own body."""
    together: Any = getattr(type(solids[0]), "together", None)
    if together is not None:
        found: Callable[[Array], Array] = together(solids, mesh)
        return found
    if all(each == solids[0] for each in solids):
        matrix = _deflection(solids[0], mesh)
        return lambda pressure: np.asarray(pressure @ matrix.T)
    stacked = np.stack([each.deflection(mesh) for each in solids])
    return lambda pressure: np.asarray(np.matmul(stacked, pressure[..., None])[..., 0])


@lru_cache(maxsize=CACHED_DEFLECTIONS)
def _deflection(solid: Solid, mesh: Mesh) -> Array:
    return solid.deflection(mesh)
