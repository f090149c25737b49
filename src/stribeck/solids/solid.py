"""What the equations ask of an elastic body: its deflection under a pressure on the line.

A new solid is a new file with one frozen class that has the members of :class:`Solid`.
"""

from __future__ import annotations

from typing import Protocol

from stribeck._types import Array
from stribeck.numerics.panels import Mesh


class Solid(Protocol):
    """An elastic body: frozen, hashable, in Hertz units."""

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

    def far_gap(self, x: Array) -> Array:
        """Return the gap far away but for the offset and a smooth function of ``1/x`` [u_Hz]."""
