r"""The soft bodies that a ball is pressed on, by their kind: half-space and bonded layer.

A bonded layer under a pressure on a disc, mode by mode in the angle, has in Hertz units the kernel

.. math::

    K(r) = \frac{2}{\pi^2} \left[\frac1r + \frac1d \, k_s\left(\frac rd\right)\right], \qquad
    k_s(\xi) = \int_0^\infty [S(x) - 1] \, J_0(x \xi) \, dx

with S of :mod:`stribeck.solids.layer`: under a normal pressure the layer knows the size of the wave vector alone.  The first
part is the half-space, the second is smooth and integrated at the nodes.  K falls exponentially, so that
:math:`k_s = -1/\xi` beyond 24 thicknesses.

The pressure of a dry smooth ball up to its edge e follows from a function of the radius that is zero at the edge,

.. math::

    \varphi(t) + \frac2\pi \int_0^e \varphi(s) \int_0^\infty [S(q d) - 1] \cos q t \cos q s \, dq \, ds = c - t^2, \qquad
    \int_0^e \varphi \, dt = \frac23

Source: the kernel by Hankel's transform; the plane-strain solution as in solids/layer.py; the edge by Abel's
transform of the deflection, as for a half-space.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import scipy

from stribeck._types import Array
from stribeck.numerics.cells import Cells
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.numerics.newton import root_between
from stribeck.numerics.settings import HALF_DIGITS
from stribeck.solids.half_plane import HalfPlane
from stribeck.solids.half_space import deflection_by_mode
from stribeck.solids.layer import KERNEL_RADIUS, MAX_WAVENUMBER, Layer, smooth_on_cells, transfer

MIN_LAYER_THICKNESS = 0.2  # Thinnest layer under a ball, in Hertz radii of a half-space: thinner ones are not tested

LOCAL_ABOVE = 6.0  # Half-width of a panel [thicknesses] above which its pressure acts at its own nodes only.

ANGLES_PER_MODE = 4  # Points around a ring over the number of angular modes.

EDGE_NODES, EDGE_WAVES = 20, 100  # Radii and wave numbers of the edge of a dry contact, good to 1e-13.


@lru_cache(maxsize=16)
def _on_cells(poisson_ratio: float) -> Cells:
    """Return k_s over ``0 <= xi <= KERNEL_RADIUS``, quick to evaluate."""
    nodes, weights = np.polynomial.legendre.leggauss(1200)
    q, weights = 0.5 * MAX_WAVENUMBER * (1 + nodes), 0.5 * MAX_WAVENUMBER * weights
    weights = weights * (transfer(q, poisson_ratio) - 1)
    return smooth_on_cells(lambda xi: np.asarray(scipy.special.j0(np.outer(xi, q)) @ weights))


def smooth_kernel(xi: Array, poisson_ratio: float) -> Array:
    """Return k_s at distances of xi thicknesses."""
    return np.where(xi < KERNEL_RADIUS, _on_cells(poisson_ratio)(xi), -1.0 / np.maximum(xi, KERNEL_RADIUS))


def layer_by_mode(mesh: PolarMesh, layer: Layer) -> Array:
    """Return the matrices from the nodal pressures of each angular mode to its deflection, shape (modes, rings, rings)."""
    # On panels wider than twelve thicknesses, far out, the layer acts as springs, 4/pi d (1 - 2 nu)/(2 (1 - nu)^2).
    d, nu, r = layer.layer_thickness, layer.poisson_ratio, mesh.radii
    found = deflection_by_mode(mesh)
    half_widths = 0.5 * np.diff(mesh.edges)
    wide = half_widths > LOCAL_ABOVE * d
    first_wide = int(np.argmax(wide)) if wide.any() else mesh.panels
    last = mesh.rings if first_wide == mesh.panels else int(mesh.of_panel[first_wide, 0]) + 1
    # The angle must resolve the layer on the largest ring of sources.
    count = max(64, ANGLES_PER_MODE * mesh.modes, int(8 * r[last - 1] / d))
    angle = 2 * np.pi * np.arange(count // 2 + 1) / (2 * (count // 2))
    weights = np.full(angle.size, 2.0)
    weights[[0, -1]] = 1.0
    waves = np.cos(np.outer(np.arange(mesh.modes), angle)) * weights * (np.pi / (count // 2))
    for i in range(mesh.rings):
        distance = np.sqrt(np.maximum(r[i] ** 2 + r[:last, None] ** 2 - 2 * r[i] * r[:last, None] * np.cos(angle), 0.0)) / d
        by_mode = smooth_kernel(distance, nu) @ waves.T  # the integral over a turn, by mode
        found[:, i, :last] += (2 / np.pi**2 / d) * by_mode.T * (mesh.ring_weights * r)[:last]
    springs = 4 / np.pi * d * (1 - 2 * nu) / (2 * (1 - nu) ** 2)
    far = np.arange(last, mesh.rings)
    found[:, :, far] = 0.0
    found[:, far, far] = springs
    return found


@lru_cache(maxsize=64)
def layer_edge(layer: Layer) -> float:
    """Return the radius of the contact of a dry smooth ball with a layer [a]."""
    d = layer.layer_thickness
    nodes, weights = np.polynomial.legendre.leggauss(EDGE_NODES)
    x, of_wave = np.polynomial.legendre.leggauss(EDGE_WAVES)
    x, of_wave = 0.5 * MAX_WAVENUMBER * (1 + x), 0.5 * MAX_WAVENUMBER * of_wave
    of_wave *= 2 / np.pi / d * (transfer(x, layer.poisson_ratio) - 1)

    def excess(edge: float) -> float:
        t, of_t = 0.5 * edge * np.append(1 + nodes, 2.0), 0.5 * edge * weights
        waves = np.cos(np.outer(t, x / d))
        matrix = (waves * of_wave) @ waves[:-1].T * of_t
        ones, parabola = np.linalg.solve(np.eye(EDGE_NODES) + matrix[:-1], np.array([np.ones(EDGE_NODES), -(t[:-1] ** 2)]).T).T
        offset = (edge**2 + matrix[-1] @ parabola) / (1 - matrix[-1] @ ones)
        return float(of_t @ (offset * ones + parabola)) - 2 / 3

    found = root_between(excess, HALF_DIGITS, 1.0, HALF_DIGITS)
    return 1.0 if found is None else found  # of a layer so thick that rounding alone tells it from a half-space


@dataclass(frozen=True)
class PlaneBody:
    """What meshes and equations of a ball ask of a kind of body."""

    deflection: Callable[[PolarMesh, Any], Array]
    widest_panel: Callable[[Any], float]  # Largest width of the panels near the contact for a solid [a]
    edge: Callable[[Any], float]  # Radius of the contact of a dry smooth ball [a]
    reaches: float  # One if the deflection falls as 1/r far away, as that of a half-space; zero if it falls faster


# Body on the plane by the kind of solid of the model; the half-plane becomes the half-space.
BODIES: dict[type, PlaneBody] = {
    HalfPlane: PlaneBody(lambda mesh, _: deflection_by_mode(mesh), lambda _: math.inf, lambda _: 1.0, 1.0),
    Layer: PlaneBody(layer_by_mode, lambda layer: layer.layer_thickness, layer_edge, 0.0),
}
