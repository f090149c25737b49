"""The minimum of the gap between the nodes of a polar mesh: over the plane, and on its middle line."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.numerics.settings import EPSILON, HALF_DIGITS, MAX_STEPS, NEAR_MINIMUM


@dataclass(frozen=True)
class Minimum:
    """Value and place of a minimum of the gap."""

    gap: float
    radius: float
    angle: float


def minimum_gap(mesh: PolarMesh, h: Array) -> Minimum:
    """Return the minimum of the interpolated gap, h being its nodal values of shape (modes, rings)."""
    angle, radius = np.unravel_index(int(np.argmin(h)), h.shape)
    padded = np.pad(h, 1, constant_values=np.inf)
    padded[0], padded[-1] = padded[1], padded[-2]
    neighbours = [padded[1 + i : h.shape[0] + 1 + i, 1 + j : h.shape[1] + 1 + j] for i in (-1, 0, 1) for j in (-1, 0, 1)]
    lowest = (h <= np.min(neighbours, axis=0)) & (h < NEAR_MINIMUM * h[angle, radius])
    coefficients = mesh.to_modes @ h
    found = [_descend(mesh, coefficients, mesh.radii[i], mesh.angles[j], False) for j, i in np.argwhere(lowest)]
    return min([*found, centre(mesh, h)], key=lambda one: one.gap)


def minimum_on_axis(mesh: PolarMesh, h: Array) -> Minimum:
    """Return the minimum of the interpolated gap on the middle line."""
    coefficients = mesh.to_modes @ h
    signs = (-1.0) ** np.arange(mesh.modes)
    sides = [
        (int(np.argmin(profile)), angle, profile)
        for angle, profile in ((0.0, coefficients.sum(axis=0)), (math.pi, signs @ coefficients))
    ]
    # A side that rises from the centre on holds no minimum; the descent from the other side may cross the centre.
    starts = [side for side in sides if side[0] > 0] or [min(sides, key=lambda side: side[2][0])]
    found = [_descend(mesh, coefficients, mesh.radii[node], angle, True) for node, angle, _ in starts]
    return min([centre(mesh, h), *found], key=lambda one: one.gap)


def centre(mesh: PolarMesh, h: Array) -> Minimum:
    """Return the gap at the centre."""
    row = mesh.rule(0).interpolation(np.array([-1.0]))[0]
    return Minimum(float(row @ h[:, mesh.of_panel[0]].mean(axis=0)), 0.0, 0.0)


def reach_of(mesh: PolarMesh, h: Array, radius: float, angle: float, depth: float) -> tuple[float, float]:
    """Return the distances in radius and angle at which the gap has risen by a depth above a minimum."""
    # By the curvature H there (2 d inv(H)_ii)**0.5, the extent of the ellipse in which the gap is lower; one radius and half a
    # turn at most.
    panel = min(max(int(mesh.edges.searchsorted(radius, side="right")) - 1, 0), mesh.panels - 1)
    orders, fields = np.arange(mesh.modes, dtype=np.float64), _derivatives(mesh, mesh.to_modes @ h, panel)
    eigenvalues, vectors = np.linalg.eigh(_jet(mesh, fields, orders, panel, radius, angle)[2])
    with np.errstate(all="ignore"):  # flat, as any angle is at the centre
        along = vectors**2 * (2.0 * depth / np.maximum(eigenvalues, 0.0))
        extents = np.sqrt(np.where(vectors == 0.0, 0.0, along).sum(axis=1))
    return min(float(extents[0]), 1.0), min(float(extents[1]), math.pi)


def _descend(mesh: PolarMesh, coefficients: Array, radius: float, angle: float, on_axis: bool) -> Minimum:
    """Return the minimum near a node, by Newton steps that may cross into neighbouring panels."""
    orders = np.arange(mesh.modes, dtype=np.float64)
    best, here, fields = Minimum(np.inf, radius, angle), -1, coefficients
    for _ in range(MAX_STEPS):
        panel = min(max(int(mesh.edges.searchsorted(radius, side="right")) - 1, 0), mesh.panels - 1)
        if panel != here:
            here, fields = panel, _derivatives(mesh, coefficients, panel)
        value, slope, curvature = _jet(mesh, fields, orders, panel, radius, angle)
        if value < best.gap:
            best = Minimum(float(value), float(radius), float(angle))
        limits = np.array([0.3 * (mesh.edges[panel + 1] - mesh.edges[panel]), np.pi / mesh.modes])
        if on_axis:
            slope[1], curvature[0, 1], curvature[1, 0], curvature[1, 1] = 0.0, 0.0, 0.0, 1.0
        scaled = limits[:, None] * curvature * limits
        eigenvalues, vectors = np.linalg.eigh(scaled)
        downhill = vectors @ ((vectors.T @ (slope * limits)) / np.maximum(np.abs(eigenvalues), EPSILON * abs(value)))
        length = float(np.abs(downhill).max())
        if length < HALF_DIGITS:
            break
        step = -limits * downhill / max(1.0, length)
        radius = float(radius + step[0])
        angle = float(angle + step[1])
        if radius < 0.0:
            radius, angle = -radius, math.pi - angle
        radius = min(radius, mesh.rim)
        angle = math.acos(math.cos(angle))
    return best


def _derivatives(mesh: PolarMesh, coefficients: Array, panel: int) -> Array:
    """Return a field and its first two derivatives in the coordinate of a panel at its nodes, shape (3, modes, degree + 1)."""
    half, derivative = mesh.spans[1][panel], mesh.rule(panel).derivative.T
    field = coefficients[:, mesh.of_panel[panel]]
    first = field @ derivative / half
    return np.stack([field, first, first @ derivative / half])


def _jet(mesh: PolarMesh, fields: Array, orders: Array, panel: int, radius: float, angle: float) -> tuple[float, Array, Array]:
    """Return value, gradient and Hessian of the interpolated field in radius and angle."""
    middle, half = mesh.spans[0][panel], mesh.spans[1][panel]
    in_log = panel >= mesh.log_from
    t = ((math.log(radius) if in_log else radius) - middle) / half
    f, f_t, f_tt = fields @ mesh.rule(panel).interpolation(np.array([t]))[0]
    if in_log:
        f_t, f_tt = f_t / radius, (f_tt - f_t) / radius**2
    c, s = np.cos(orders * angle), np.sin(orders * angle)
    gradient = np.array([c @ f_t, -(orders * s) @ f])
    mixed = -(orders * s) @ f_t
    return float(c @ f), gradient, np.array([[c @ f_tt, mixed], [mixed, -(orders**2 * c) @ f]])
