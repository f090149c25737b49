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

from stribeck._types import Array, Indices
from stribeck.numerics.panels import Mesh, interpolation_error, reference
from stribeck.numerics.settings import ROUNDING, SAFETY


def position_errors(mesh: Mesh, gap: Array, changes: Array, positions: Array, depth: Array) -> Array:
    """Return the absolute errors of the positions of the minimum gap [a], shape (rows,)."""
    rule, order = reference(mesh.order), mesh.order
    panel = np.clip(np.searchsorted(mesh.edges, positions) - 1, 0, mesh.panels - 2)
    width = mesh.half_widths[panel]
    s = (positions - mesh.centres[panel]) / width
    nodes = panel[:, None] * order + np.arange(order)
    rows = np.arange(len(gap))[:, None]
    own, far = gap[rows, nodes], mesh.far[nodes]
    logarithm = np.log(own / far)
    first = rule.derivative @ rule.to_legendre
    basis = np.polynomial.legendre.legvander(s, order - 1)
    slope_of, curvature_of = basis @ first, basis @ rule.derivative @ first
    growth = mesh.scale**2 + positions**2
    slope = (slope_of * logarithm).sum(axis=1) + 2 * width * positions / growth
    curvature = (curvature_of * logarithm).sum(axis=1) + 2 * width**2 * (mesh.scale**2 - positions**2) / growth**2

    at_nodes = changes[:, rows, nodes] / own
    moved = np.abs((slope_of * at_nodes).sum(axis=2))
    inside = np.maximum(1 - s**2, 1e-300)
    steepest = np.minimum(order * (order + 1) / 2, np.sqrt(2 * order / np.pi) / inside**0.75)
    missed = steepest * (interpolation_error(logarithm) + ROUNDING / own.min(axis=1))
    wrong = np.abs(slope) + moved[0] + 2 * np.sqrt((moved[1:] ** 2).mean(axis=0)) + missed
    found = SAFETY * width * wrong / np.maximum(np.abs(curvature), 1e-300)

    return np.asarray(np.maximum(found, _farthest_rival(mesh, gap, positions, panel, depth)))


def _farthest_rival(mesh: Mesh, gap: Array, positions: Array, panel: Indices, depth: Array) -> Array:
    """Return the distance of the farthest other minimum that may be the deeper one, zero if there is none."""
    x, gap = mesh.nodes[: -mesh.order], gap[:, : -mesh.order]  # without the panel through infinity
    left, middle, right = gap[:, :-2], gap[:, 1:-1], gap[:, 2:]
    rising = (middle - left) / (x[1:-1] - x[:-2])
    falling = (right - middle) / (x[2:] - x[1:-1])
    apart = np.abs(np.arange(1, len(x) - 1) // mesh.order - panel[:, None]) > 1
    rows, at = np.nonzero((rising <= 0) & (falling >= 0) & apart)
    found = np.zeros(len(gap))
    bend = (falling - rising)[rows, at] / (x[at + 2] - x[at])  # of the parabola through the three nodes
    slope = rising[rows, at] + bend * (x[at + 1] - x[at])
    bottom = middle[rows, at] - 1.5 * slope**2 / (4 * np.maximum(bend, 1e-300))  # with half of the drop for what it misses
    deep = bottom <= gap.min(axis=1)[rows] * (1 + 2 * depth[rows])
    np.maximum.at(found, rows[deep], np.abs(x[at[deep] + 1] - positions[rows[deep]]))
    return found
