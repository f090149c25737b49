"""The mesh of a stroke: it serves both directions and all speeds, and is kept."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from stribeck.equations.state import State
from stribeck.numerics.panels import Mesh

__all__ = ["shared_mesh"]


def shared_mesh(states: Sequence[State], order: int) -> Mesh:
    """Return a mesh that is as fine as those of several states and their mirror images, which shares its places with them."""
    known = [state.mesh.edges + state.exit for state in states]
    reach = max(float(edges[-1]) for edges in known)
    sides = [np.sort(sign * edges) for edges in known for sign in (1.0, -1.0)]
    ends = np.unique([x for edges in sides for x in edges if 0 < x < reach])
    ends = np.concatenate([[0.0], ends, [reach]])
    # Panels for a length, between one edge and the next: as many as the finest mesh has there.
    middles = 0.5 * (ends[1:] + ends[:-1])
    finest = np.full(middles.size, math.inf)
    for edges in sides:
        row = np.searchsorted(edges, middles)
        inside = (row > 0) & (row < len(edges))
        finest[inside] = np.fmin(finest[inside], np.diff(edges)[row[inside] - 1])
    count = np.append(0.0, np.cumsum(np.diff(ends) / finest))
    model = states[0].groups.model
    places = np.unique(np.abs(model.profile.places))
    found = [0.0]
    for start, end in pairwise(np.interp([0.0, *places[(places > 0) & (places < reach)], reach], ends, count)):
        found.extend(np.interp(np.linspace(start, end, math.ceil(end - start) + 1)[1:], count, ends))
    positive = np.array(found)
    return Mesh(np.append(-positive[:0:-1], positive), order, states[0].mesh.scale)
