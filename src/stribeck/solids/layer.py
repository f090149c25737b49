r"""Deflection of an elastic layer that is bonded to a rigid base.

.. math::

    \hat w(q) = \frac{2 \hat p(q)}{E^* |q|} \, S(q d), \qquad
    S(x) = \frac{k \sinh 2x - 2x}{k \cosh 2x + 2x^2 + 5 - 12\nu + 8\nu^2}, \quad k = 3 - 4\nu

In Hertz units the kernel on the line is that of the half-plane and a smooth function of x/d,

.. math::

    K(x) = -\frac1\pi \ln\left|\frac xd\right| + k_s\left(\frac xd\right), \qquad
    \pi k_s(\xi) = \int_0^\infty \frac{(S(q) - 1) \cos q\xi + e^{-q}}{q} \, dq

K falls exponentially: beyond 24 thicknesses, where it is taken for zero, it is below 3e-9 (1e-14 for :math:`\nu = 0`).  The
layer sticks to its base; its upper surface is free of shear stress.  Unlike the half-plane it has no logarithm far away, so
that its offset is a height.

Source: the plane-strain solution of a bonded layer, [Johnson 1985] section 5.8; checked against a Fourier integral.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.polynomial import chebyshev, legendre

from stribeck._types import Array
from stribeck.numerics.cells import Cells
from stribeck.numerics.panels import Mesh, clustered, reference
from stribeck.quantities.schema import Input, law
from stribeck.solids.half_plane import nodal_deflection
from stribeck.solids.solid import Lengths, Solid

KERNEL_RADIUS = 24.0  # Distance [thicknesses] at which the kernel, below 3e-9 there, is cut to zero.

KERNEL_COEFFICIENTS = 160  # Chebyshev coefficients of the smooth part of the kernel, good to 1e-13.

MAX_WAVENUMBER = 40.0  # Wave number times thickness above which S is one to rounding.
WAVENUMBER_PANELS = 60  # Gauss panels of the wave numbers up to there.

KERNEL_CELLS = 1024  # Cells up to KERNEL_RADIUS on which the smooth part is a polynomial, equal to its series to 1e-14.
CELL_TERMS = 6  # Coefficients of the polynomial on a cell.

OWN_NODES_BELOW = 0.75  # Half-width of a panel [thicknesses] up to which its own nodes integrate the smooth part.

# Nodes over the kernel's radius on each side of a target, clustered by NEAR_CLUSTER_POWER: good to 1e-14 for a logarithm.
NEAR_NODES = 64
NEAR_CLUSTER_POWER = 8  # Power by which these nodes cluster towards the target.


@law
class Layer(Solid):
    """An elastic layer bonded to a rigid base: it neither slides on the base nor lifts off."""

    kind: ClassVar[str] = "layer"
    name: ClassVar[str] = "bonded layer"
    label: ClassVar[str] = "bonded layer"

    layer_thickness: Input = Input(
        without="half-space",
        label="thickness of the layer",
        symbol="$d$",
        dimension="length",
        typical="2 mm",
        source="a pad of rubber",
        letters=("thickness",),
    )
    poisson_ratio: Input = Input(
        label="Poisson's ratio",
        symbol=r"$\nu$",
        dimension="number",
        typical="0.5",
        source="rubber and gels",
        zero=True,
        highest=0.5,
        default=0.5,
        is_free=False,
    )

    @property
    def lengths(self) -> Lengths:
        """Its thickness, for meshes."""
        return Lengths(self.layer_thickness)

    def scaled(self, length: float, speed: float = 1.0) -> Layer:
        """Return the layer with its thickness over a length, the Hertz half-width."""
        return Layer(self.layer_thickness / length, self.poisson_ratio)

    def deflection(self, mesh: Mesh) -> Array:
        """Return the matrix from nodal pressures to the deflection at the nodes [u_Hz per p_Hz]."""
        d = self.layer_thickness
        x = mesh.nodes.reshape(mesh.panels, mesh.order)
        kernel = nodal_deflection(mesh, beyond=False)
        # Each pair of panels once: the smooth part is symmetric but for the weights, and the kernel is in Fortran order.
        first, second = np.triu_indices(mesh.panels)
        found = self._smooth_part(x[first][:, :, None], x[second][:, None, :])
        smooth = np.empty((mesh.size, mesh.size))
        by_panels = smooth.reshape(mesh.panels, mesh.order, mesh.panels, mesh.order)
        by_panels[second, :, first] = found.transpose(0, 2, 1)
        by_panels[first, :, second] = found
        smooth *= mesh.weights[:, None]
        kernel += smooth.T
        kernel[np.abs(mesh.nodes[:, None] - mesh.nodes) >= KERNEL_RADIUS * d] = 0.0
        for k in np.flatnonzero(mesh.half_widths[:-1] > OWN_NODES_BELOW * d).tolist():
            near = np.abs(mesh.nodes - mesh.centres[k]) < mesh.half_widths[k] + KERNEL_RADIUS * d
            kernel[near, k * mesh.order : (k + 1) * mesh.order] = self._by_whole_kernel(mesh, k, mesh.nodes[near])
        beyond = np.arange(mesh.size - mesh.order, mesh.size)
        kernel[:, beyond] = 0.0
        # On the panel through infinity, many thicknesses long, a layer yields to the pressure at each place, d S'(0) of it.
        nu = self.poisson_ratio
        kernel[beyond, beyond] = 0.5 * d * (1 - 2 * nu) / (1 - nu) ** 2
        return np.asarray(kernel, order="F")

    def _smooth_part(self, x: Array, y: Array) -> Array:
        """Return the smooth part of the kernel between places, the logarithm of the thickness included."""
        distance = np.abs(x - y)
        distance *= 1 / self.layer_thickness
        np.minimum(distance, KERNEL_RADIUS, out=distance)
        found = smooth_kernel(distance, self.poisson_ratio)
        found += math.log(self.layer_thickness) / math.pi
        return found

    def _by_whole_kernel(self, mesh: Mesh, k: int, x: Array) -> Array:
        """Return what pressures at the nodes of a panel deflect at places ``x`` by the whole kernel, shape (len(x), order)."""
        half, place = float(mesh.half_widths[k]) / self.layer_thickness, (x - mesh.centres[k]) / self.layer_thickness
        panel, (at, weights) = reference(mesh.order), clustered(NEAR_NODES, NEAR_CLUSTER_POWER)

        def ahead(place: Array) -> Array:
            first, last = np.clip(-half - place, 0.0, KERNEL_RADIUS), np.clip(half - place, 0.0, KERNEL_RADIUS)
            found = np.zeros((len(place), mesh.order))
            some = last > first
            first, length = first[some, None], (last - first)[some, None]
            away = first + length * at
            kernel = length * weights * (smooth_kernel(away, self.poisson_ratio) - np.log(away) / math.pi)
            polynomials = legendre.legvander((place[some, None] + away) / half, mesh.order - 1)
            found[some] = np.einsum("rs,rsn->rn", kernel, polynomials) @ panel.to_legendre
            return found

        return np.asarray(self.layer_thickness * (ahead(place) + ahead(-place)[:, ::-1]))

    def far_gap(self, x: Array) -> Array:
        """Return ``x**2/2``."""
        return 0.5 * x**2


def transfer(x: Array, poisson_ratio: float) -> Array:
    """Return S(x): the deflection of the layer over that of the half-plane, at wave number times thickness x > 0."""
    nu = poisson_ratio
    k, constant = 3 - 4 * nu, 5 - 12 * nu + 8 * nu**2
    small = np.minimum(x, 40.0)
    sinh, cosh = np.sinh(2 * small), np.cosh(2 * small)
    # The cubic term by its series, which the difference of the sines loses at small x for nu = 1/2.
    top = np.where(x < 0.03, (k - 1) * 2 * x + k * (4 / 3 * x**3 + 4 / 15 * x**5 + 8 / 315 * x**7), k * sinh - 2 * small)
    return np.asarray(top / (k * cosh + 2 * small**2 + constant))


@lru_cache(maxsize=16)
def _on_cells(poisson_ratio: float) -> Cells:
    """Return the smooth kernel over ``0 <= xi <= KERNEL_RADIUS``, quick to evaluate."""
    nodes, weights = legendre.leggauss(24)
    half = 0.5 * MAX_WAVENUMBER / WAVENUMBER_PANELS
    q = (half * (1 + 2 * np.arange(WAVENUMBER_PANELS)[:, None] + nodes)).ravel()
    weights = np.tile(half * weights, WAVENUMBER_PANELS)
    excess = transfer(q, poisson_ratio) - 1
    return smooth_on_cells(lambda xi: ((excess * np.cos(np.outer(xi, q)) + np.exp(-q)) / q) @ weights / np.pi)


def smooth_on_cells(function: Callable[[Array], Array]) -> Cells:
    """Return a smooth function over ``0 <= xi <= KERNEL_RADIUS`` on cells, by its Chebyshev series."""
    xi = 0.5 * KERNEL_RADIUS * (1 + np.cos(np.pi * (np.arange(KERNEL_COEFFICIENTS) + 0.5) / KERNEL_COEFFICIENTS))
    series = chebyshev.chebfit(2 * xi / KERNEL_RADIUS - 1, function(xi), KERNEL_COEFFICIENTS - 1)

    def smooth(xi: Array) -> Array:
        return np.asarray(chebyshev.chebval(2 * xi / KERNEL_RADIUS - 1, series), dtype=float)

    return Cells.of(smooth, 0.0, KERNEL_RADIUS, KERNEL_CELLS, CELL_TERMS)


def smooth_kernel(xi: Array, poisson_ratio: float) -> Array:
    """Return k_s at distances of xi thicknesses, ``0 <= xi <= 24``."""
    return np.asarray(_on_cells(poisson_ratio)(xi))
