"""The gap between the nodes: at any position, in the middle, and its minimum."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from stribeck._types import Array, Indices
from stribeck.numerics.panels import Mesh, interpolation_error, reference
from stribeck.numerics.settings import HALF_DIGITS, MAX_STEPS

TINY = np.finfo(float).tiny


def far_gap(x: Array) -> Array:
    """Return ``x**2/2 - ln|x|/2``, the far gap on the half-plane up to a smooth function of ``1/x``."""
    return 0.5 * x**2 - 0.5 * np.log(np.abs(x))


def gap_at(mesh: Mesh, h: Array, x: Array, far_gap: Callable[[Array], Array] = far_gap) -> Array:
    """Return the gap at the coordinates ``x`` of the mesh from the polynomials of the panels."""
    # Polynomials are of the logarithm of the gap over its growth, of the gap over its growth where it touches zero, and of the
    # gap less ``far_gap`` on the panel through infinity.
    far = mesh.scale**2 + x * x
    if h.min() > 0:
        gap = np.exp(mesh.interpolate(np.log(h / mesh.far), x)) * far
    else:
        gap = mesh.interpolate(h / mesh.far, x) * far
    beyond = np.abs(x) > mesh.edges[-1]
    if beyond.any():
        x, tail = x[beyond], mesh.nodes[-mesh.order :]
        rule = reference(mesh.order)
        remainder = rule.interpolation(1 / (x * mesh.half_widths[-1])) @ (h[-mesh.order :] - far_gap(tail))
        gap[beyond] = far_gap(x) + remainder
    return np.asarray(gap)


def gap_beside(mesh: Mesh, h: Array, x: float) -> tuple[Any, Any, slice, Array]:
    """Return the gap and its slope at a coordinate in the contact, the nodes of its panel, and the row of ln(gap) there."""
    k = min(max(int(np.searchsorted(mesh.edges, x, side="right")) - 1, 0), mesh.panels - 2)
    width, nodes = float(mesh.half_widths[k]), slice(k * mesh.order, (k + 1) * mesh.order)
    rule, s = reference(mesh.order), (x - float(mesh.centres[k])) / width
    row = rule.interpolation(np.array([s]))[0]
    logs, far = np.log(h[..., nodes]) - np.log(mesh.far[nodes]), mesh.scale**2 + x * x
    value = np.exp(logs @ row) * far
    slope = logs @ (row @ rule.derivative) / width
    return value, value * (slope + 2 * x / far), nodes, row


def minimum_gap(mesh: Mesh, h: Array) -> tuple[float, float]:
    """Return position and value of the minimum gap, that of the panels' polynomials around the minimum node."""
    position, gap, _, _ = minimum_gaps(mesh, np.log(h[None, : -mesh.order]))
    return float(position[0]), float(gap[0])


def minimum_gaps(mesh: Mesh, log_gap: Array) -> tuple[Array, Array, Array, Indices]:
    """Return place, value, error and panel of the minimum gap of many states, the logarithms on panels in x in rows."""
    order, rule, count = mesh.order, reference(mesh.order), len(log_gap)
    panels = log_gap.shape[1] // order
    shape = log_gap - np.log(mesh.far[:-order])
    k, about = np.divmod(np.argmin(log_gap, axis=1), order)
    start = rule.nodes[about]
    beside = np.clip(k - (about == 0) + (about == order - 1), 0, panels - 1)
    if (beside != k).any():  # on the panel beside that of the lowest node the search begins at their common edge
        at_end = np.where(about == 0, 1.0, -1.0)
        start = np.append(start, at_end)
        k, about = np.append(k, beside), np.append(about, np.where(about == 0, order - 1, 0))
    own = shape.reshape(count, panels, order)[np.arange(len(k)) % count, k]
    slopes = own @ rule.derivative.T
    bends = slopes @ rule.derivative.T
    c, d, s = mesh.centres[k], mesh.half_widths[k], start
    low, high = _brackets(order)[:, about]
    for _ in range(MAX_STEPS):
        basis, x = rule.interpolation(s), c + d * s
        far = mesh.scale**2 + x * x
        slope = np.einsum("rn,rn->r", basis, slopes) + 2 * d * x / far
        bend = np.einsum("rn,rn->r", basis, bends) + 2 * d * d * (mesh.scale**2 - x * x) / far**2
        last, s = s, np.minimum(np.maximum(s - slope / (np.abs(bend) + TINY), low), high)
        if np.abs(s - last).max() <= HALF_DIGITS:
            break
    x = c + d * s
    value = np.einsum("rn,rn->r", rule.interpolation(s), own) + np.log(mesh.scale**2 + x * x)
    rows = np.arange(count)
    rows += np.where(value[-count:] < value[:count], len(k) - count, 0)
    return x[rows], np.exp(value[rows]), 2 * interpolation_error(own[rows]), k[rows]


@lru_cache(maxsize=32)
def _brackets(order: int) -> Array:
    """Return the nodes or ends of a panel before and behind each node: the minimum around the lowest one lies between."""
    nodes = reference(order).nodes
    return np.array([np.append(-1.0, nodes[:-1]), np.append(nodes[1:], 1.0)])
