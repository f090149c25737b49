r"""How far the stated position of the minimum gap may be from the true one.

At the minimum the slope of the gap vanishes, so that a wrong slope moves it by

.. math:: \delta x = -\frac{\delta h'}{h''}

The error of the slope comes from the changes of the nodal gaps by defect and rounding, from the search for the minimum, and
from the interpolation between the m nodes of a panel.  The last is estimated by the first Legendre polynomial left out, whose
slope is about :math:`\sqrt{2m/\pi}\,(1-s^2)^{-3/4}` inside a panel and :math:`m(m+1)/2` at its ends.  If the gap has a second
minimum of nearly the same depth, the distance between the two is the error.
"""

from __future__ import annotations

import numpy as np

from stribeck._types import Array
from stribeck.numerics.panels import Mesh, interpolation_error, reference
from stribeck.numerics.settings import ROUNDING, SAFETY


def position_error(mesh: Mesh, gap: Array, changes: Array, position: float, depth: float) -> float:
    """Return the absolute error of the position of the minimum gap, a coordinate of the mesh."""
    rule, order = reference(mesh.order), mesh.order
    panel = min(max(int(np.searchsorted(mesh.edges, position)) - 1, 0), mesh.panels - 2)
    width = float(mesh.half_widths[panel])
    s = (position - float(mesh.centres[panel])) / width
    nodes = slice(panel * order, (panel + 1) * order)
    own, far = gap[nodes], mesh.far[nodes]
    logarithm = np.log(own / far)
    first = rule.derivative @ rule.to_legendre
    basis = np.polynomial.legendre.legvander(np.array([s]), order - 1)[0]
    slope_of, curvature_of = basis @ first, basis @ rule.derivative @ first
    growth = mesh.scale**2 + position**2
    slope = slope_of @ logarithm + 2 * width * position / growth
    curvature = curvature_of @ logarithm + 2 * width**2 * (mesh.scale**2 - position**2) / growth**2

    moved = np.abs((changes[:, nodes] / own) @ slope_of)
    inside = max(1 - s**2, 1e-300)
    steepest = min(order * (order + 1) / 2, np.sqrt(2 * order / np.pi) / inside**0.75)
    missed = steepest * (interpolation_error(logarithm) + ROUNDING / own.min())
    wrong = abs(slope) + moved[0] + 2 * np.sqrt((moved[1:] ** 2).mean()) + missed
    found = SAFETY * width * wrong / max(abs(curvature), 1e-300)

    return float(max(found, _farthest_rival(mesh, gap, position, panel, depth)))


def _farthest_rival(mesh: Mesh, gap: Array, position: float, panel: int, depth: float) -> float:
    """Return the distance of the farthest other minimum that may be the deeper one, zero if there is none."""
    x, gap = mesh.nodes[: -mesh.order], gap[: -mesh.order]  # without the panel through infinity
    left, middle, right = gap[:-2], gap[1:-1], gap[2:]
    rising = (middle - left) / (x[1:-1] - x[:-2])
    falling = (right - middle) / (x[2:] - x[1:-1])
    apart = np.abs(np.arange(1, len(x) - 1) // mesh.order - panel) > 1
    at = np.flatnonzero((rising <= 0) & (falling >= 0) & apart)
    bend = (falling - rising)[at] / (x[at + 2] - x[at])  # of the parabola through the three nodes
    slope = rising[at] + bend * (x[at + 1] - x[at])
    bottom = middle[at] - 1.5 * slope**2 / (4 * np.maximum(bend, 1e-300))  # with half of the drop for what it misses
    deep = bottom <= gap.min() * (1 + 2 * depth)
    return float(np.abs(x[at[deep] + 1] - position).max(initial=0.0))
