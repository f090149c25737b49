"""The minimum of the gap between the nodes of a polar mesh: over the plane, and on its middle line."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from stribeck._types import Array
from stribeck.numerics.fourier_panels import PolarMesh

STEPS = 12
"""Newton steps towards a minimum."""

CANDIDATES = 3
"""Nodes from which it is sought: the lowest of those that are lower than their neighbours."""


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
    lowest = (h <= np.min(neighbours, axis=0)) & (h < 3.0 * h[angle, radius])
    places = np.argwhere(lowest)
    places = places[np.argsort(h[lowest])][:CANDIDATES]
    coefficients = mesh.to_modes @ h
    found = [_descend(mesh, coefficients, mesh.radii[i], mesh.angles[j], False) for j, i in places]
    return min([*found, centre(mesh, h)], key=lambda one: one.gap)


def minimum_on_axis(mesh: PolarMesh, h: Array) -> Minimum:
    """Return the minimum of the interpolated gap on the middle line."""
    coefficients = mesh.to_modes @ h
    signs = (-1.0) ** np.arange(mesh.modes)
    found = [centre(mesh, h)]
    for angle, profile in ((0.0, coefficients.sum(axis=0)), (np.pi, signs @ coefficients)):
        start = mesh.radii[int(np.argmin(profile))]
        found.append(_descend(mesh, coefficients, start, angle, True))
    return min(found, key=lambda one: one.gap)


def centre(mesh: PolarMesh, h: Array) -> Minimum:
    """Return the gap at the centre."""
    row = mesh.rule(0).interpolation(np.array([-1.0]))[0]
    return Minimum(float(row @ h[:, mesh.of_panel[0]].mean(axis=0)), 0.0, 0.0)


def _descend(mesh: PolarMesh, coefficients: Array, radius: float, angle: float, on_axis: bool) -> Minimum:
    """Return the minimum near a node, by Newton steps that may cross into neighbouring panels."""
    orders = np.arange(mesh.modes, dtype=np.float64)
    best = Minimum(np.inf, radius, angle)
    for _ in range(STEPS):
        value, slope, curvature = _jet(mesh, coefficients, orders, radius, angle)
        if value < best.gap:
            best = Minimum(float(value), float(radius), float(angle))
        panel = int(np.clip(np.searchsorted(mesh.edges, radius, side="right") - 1, 0, mesh.panels - 1))
        limits = np.array([0.3 * (mesh.edges[panel + 1] - mesh.edges[panel]), np.pi / mesh.modes])
        if on_axis:
            slope[1], curvature[0, 1], curvature[1, 0], curvature[1, 1] = 0.0, 0.0, 0.0, 1.0
        scaled = limits[:, None] * curvature * limits
        eigenvalues, vectors = np.linalg.eigh(scaled)
        downhill = vectors @ ((vectors.T @ (slope * limits)) / np.maximum(np.abs(eigenvalues), 1e-14 * abs(value)))
        step = -limits * downhill / max(1.0, float(np.abs(downhill).max()))
        radius = radius + step[0]
        angle = angle + step[1]
        if radius < 0.0:
            radius, angle = -radius, np.pi - angle
        radius = min(radius, mesh.rim)
        angle = float(np.arccos(np.cos(angle)))
    return best


def _jet(mesh: PolarMesh, coefficients: Array, orders: Array, radius: float, angle: float) -> tuple[float, Array, Array]:
    """Return value, gradient and Hessian of the interpolated field in radius and angle."""
    panel = int(np.clip(np.searchsorted(mesh.edges, radius, side="right") - 1, 0, mesh.panels - 1))
    middle, half = mesh.spans[0][panel], mesh.spans[1][panel]
    rule = mesh.rule(panel)
    in_log = panel >= mesh.log_from
    t = ((np.log(radius) if in_log else radius) - middle) / half
    series = rule.to_legendre @ coefficients[:, mesh.of_panel[panel]].T
    f = legendre.legval(t, series)
    f_t = legendre.legval(t, legendre.legder(series)) / half
    f_tt = legendre.legval(t, legendre.legder(series, 2)) / half**2
    if in_log:
        f_t, f_tt = f_t / radius, (f_tt - f_t) / radius**2
    c, s = np.cos(orders * angle), np.sin(orders * angle)
    gradient = np.array([c @ f_t, -(orders * s) @ f])
    mixed = -(orders * s) @ f_t
    return float(c @ f), gradient, np.array([[c @ f_tt, mixed], [mixed, -(orders**2 * c) @ f]])
