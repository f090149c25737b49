"""What the equations ask of an elastic body: its deflection under a pressure on the line.

A new solid is a new file with one frozen class that has the members of :class:`Solid`, and ``lengths`` if it has any.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple, Protocol

import numpy as np

from stribeck._types import Array
from stribeck.numerics.panels import Mesh
from stribeck.quantities.registry import GUIDE, check_user_part, refusal
from stribeck.quantities.schema import numbers_of
from stribeck.quantities.units import InputError, show

REQUIRED_MEMBERS = ("name", "parameters", "scaled", "deflection", "far_gap")

SCALING_RTOL = 1e-6  # Largest difference of deflections in two units of length over the largest: rounding alone differs.

NODES_PER_PANEL = 8  # Nodes of a panel of the mesh of the check.
FAR_DISTANCE = 1e3  # Distance over the longest length of the body at which a load of pi/2 acts nearly as a point.
FAR_GAP_TOLERANCE = 0.05  # Largest difference of gaps from a tenth of that distance on [u_Hz].

CHECKED_UNITS = (0.1, 10.0)  # Units of length to which the body is scaled.

# Lengths at which a body that has no length of its own is checked, SI to Hertz units.
CHECKED_LENGTHS = np.geomspace(1e-6, 1.0, 7)


class Lengths(NamedTuple):
    """The lengths of a body that a mesh must resolve [a]."""

    thickness: float = math.inf  # Of the thinnest layer; infinite without one
    memories: tuple[float, ...] = ()  # Over which the body remembers the pressure that has passed

    def joined(self, other: Lengths) -> Lengths:
        """Return the lengths of two bodies."""
        return Lengths(min(self.thickness, other.thickness), self.memories + other.memories)


def lengths_of(solid: Solid | None) -> Lengths:
    """Return the lengths that a solid has beside the width of the contact: none where it does not tell any, or is none."""
    return getattr(solid, "lengths", Lengths())


class Solid(Protocol):
    """An elastic body: frozen, hashable as operators are kept by it, in Hertz units."""

    @property
    def name(self) -> str:
        """Name that outputs print."""

    @property
    def parameters(self) -> dict[str, float | str]:
        """What distinguishes this body from others of its name, for outputs: its numbers."""
        return {name: getattr(self, name) for name in numbers_of(type(self))}

    def scaled(self, length: float, speed: float = 1.0) -> Solid:
        """Return the body in Hertz units, from SI, by the Hertz half-width and the speed of its surface."""

    def deflection(self, mesh: Mesh) -> Array:
        """Return the matrix from nodal pressures to the deflection at the nodes, shape (size, size), in Fortran order."""

    def __hash__(self) -> int:
        """Return the same for the same body: operators are kept by it."""
        return object.__hash__(self)

    def far_gap(self, x: Array) -> Array:
        """Return the gap far away but for the offset and a smooth function of ``1/x`` [u_Hz]."""


def check_solid(name: str, solid: Any) -> None:
    """Refuse a body of somebody else's whose members contradict each other."""
    lacking = [member for member in REQUIRED_MEMBERS if not hasattr(solid, member)]
    if lacking:
        raise InputError(f"{name} = {show(solid)} lacks {', '.join(lacking)}. {GUIDE}")
    check_user_part("solid", solid, _check_members)


def _check_members(solid: Solid) -> None:
    longest = _longest(solid.scaled(1.0))
    for length in (longest,) if longest > 0 else CHECKED_LENGTHS.tolist():
        _scaling(solid, length)
    _far_gap(solid, longest if longest > 0 else 1.0)


def _scaling(solid: Solid, length: float) -> None:
    """Refuse a body that deflects in another way in another unit of length: deflection over u_Hz is a length over a."""
    mesh = Mesh(_edges(FAR_DISTANCE), NODES_PER_PANEL)
    longest = _longest(solid.scaled(1.0))
    for unit in CHECKED_UNITS:
        found = unit * length * _longest(solid.scaled(unit * length))
        if not abs(found - longest) <= SCALING_RTOL * longest:
            raise refusal(
                "solid",
                solid,
                f"scaled does not agree with the same body in another unit of length: its lengths have "
                f"{found:.6g} for {longest:.6g}.",
            )
    first = _deflection(solid.scaled(length), mesh)
    size = float(np.abs(first).max())
    for unit in CHECKED_UNITS:
        other = unit * _deflection(solid.scaled(unit * length), Mesh(mesh.edges / unit, NODES_PER_PANEL))
        if not np.abs(other - first).max() <= SCALING_RTOL * size:
            raise refusal(
                "solid",
                solid,
                f"scaled does not agree with the same body in another unit of length: its deflection differs "
                f"by {np.abs(other - first).max() / size:.2g} of the largest.",
            )


def _far_gap(solid: Solid, length: float) -> None:
    """Refuse a body whose gap far away is not that of its own deflection under a load of pi/2."""
    scaled = solid.scaled(length)
    mesh = Mesh(_edges(FAR_DISTANCE), NODES_PER_PANEL)
    x = mesh.nodes[: -mesh.order]
    gap = np.asarray(scaled.far_gap(x), dtype=float)
    if gap.shape != x.shape:
        raise refusal("solid", solid, "far_gap must return a number for each place.")
    beyond = gap - 0.5 * x**2 - _deflection(scaled, mesh)
    for side in (-1, 1):
        far = beyond[side * x > 0.1 * FAR_DISTANCE]
        if not np.ptp(far) <= FAR_GAP_TOLERANCE:
            raise refusal(
                "solid",
                solid,
                f"far_gap does not agree with deflection under a load of pi/2: beyond an offset they differ "
                f"by {np.ptp(far):.2g} u_Hz from {0.1 * FAR_DISTANCE:g} to {FAR_DISTANCE:g} times the longest of its "
                f"lengths.",
            )


def _edges(far: float) -> Array:
    """Return panels that are even where the load is, and double beyond."""
    beyond = np.geomspace(1.0, far, 11)
    return np.concatenate([-beyond[::-1], np.linspace(-0.75, 0.75, 7), beyond])


def _deflection(solid: Solid, mesh: Mesh) -> Array:
    """Return the deflection beyond its mean under a smooth load of pi/2 in the middle of the mesh, on the finite panels."""
    matrix = np.asarray(solid.deflection(mesh), dtype=float)
    if matrix.shape != (mesh.size, mesh.size) or not np.isfinite(matrix).all():
        raise refusal("solid", solid, "deflection must return a finite matrix, nodes by nodes.")
    finite = slice(0, mesh.size - mesh.order)
    half = mesh.edges[-1] / FAR_DISTANCE
    x = mesh.nodes[finite] / half
    pressure = np.where(np.abs(x) < 1, 15 * np.pi / 32 * (1 - x**2) ** 2, 0.0)
    found = matrix[finite, finite] @ pressure
    return np.asarray(found - found.mean())


def _longest(solid: Solid) -> float:
    """Return the longest length of a body; zero if it has none."""
    lengths = lengths_of(solid)
    return max((each for each in (lengths.thickness, *lengths.memories) if np.isfinite(each)), default=0.0)
