"""The mesh of a stroke: it serves both directions and all speeds, and is kept."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stribeck._types import Array
from stribeck.numerics.panels import Mesh

__all__ = ["shared_mesh"]

RATIO = 0.5  # A panel is at most so much longer than the next one wants
SLIVER = 0.3  # Part of a panel below which what is left is joined to it


def shared_mesh(meshes: Sequence[Mesh], places: Array, order: int) -> Mesh:
    """Return a mesh that is as fine as each of several and their mirror images, with places of both sides as edges."""
    reach = max(float(mesh.edges[-1]) for mesh in meshes)
    sides = [np.sort(sign * mesh.edges) for mesh in meshes for sign in (1.0, -1.0)]

    def width(x: float) -> float:
        rows = [(edges, int(np.searchsorted(edges, x, side="right"))) for edges in sides]
        return min(float(edges[k] - edges[k - 1]) for edges, k in rows if 0 < k < len(edges))

    inside = np.unique(np.abs(places))
    fixed = [0.0, *(float(x) for x in inside if 0 < x < reach), reach]
    found = [0.0]
    for end in fixed[1:]:
        x = found[-1]
        small = 1e-9 * reach
        while x < end:
            step = width(x + small)
            step = min(step, max(width(min(x + step, reach) - small), RATIO * step))
            x = end if end - x - step < SLIVER * step else x + step
            found.append(x)
    positive = np.array(found)
    return Mesh(np.append(-positive[:0:-1], positive), order, meshes[0].scale)
