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
from numpy.polynomial import chebyshev

from stribeck._types import Array, Flags
from stribeck.numerics.cells import Cells
from stribeck.numerics.panels import Mesh, reference
from stribeck.quantities.schema import Input, law
from stribeck.solids.half_plane import nodal_deflection
from stribeck.solids.solid import Lengths, Solid

__all__ = ["Layer"]

KERNEL_RADIUS = 24.0  # Distance [thicknesses] at which the kernel, below 3e-9 there, is cut to zero.

KERNEL_COEFFICIENTS = 160  # Chebyshev coefficients of the smooth part of the kernel, good to 1e-13.

MAX_WAVENUMBER = 40.0  # Wave number times thickness above which S is one to rounding.
WAVENUMBER_PANELS = 60  # Gauss panels of the wave numbers up to there.

KERNEL_CELLS = 1024  # Cells up to KERNEL_RADIUS on which the smooth part is a polynomial, equal to its series to 1e-14.
CELL_TERMS = 6  # Coefficients of the polynomial on a cell.

OWN_NODES_BELOW = 0.75  # Half-width of a panel [thicknesses] up to which its own nodes integrate the smooth part.

# Error of the rule for the smooth part on wider panels, by the image two thicknesses below the target.
SMOOTH_RULE_ERROR = 1e-13

KERNEL_RULE_ABOVE = 6.0  # Half-width of a panel [thicknesses] above which its pressure is integrated over the kernel's radius.

# Nodes over the kernel's radius on each side of a target, clustered by NEAR_CLUSTER_POWER: good to 1e-14 for a logarithm.
NEAR_NODES = 64
NEAR_CLUSTER_POWER = 8  # Power by which these nodes cluster towards the target.

FAR_FROM_PANEL = 4.0  # Distance from a wide panel [thicknesses] above which the deflection is interpolated.
FAR_TARGETS = 40  # Chebyshev targets of that interpolation.
FAR_NODES = 32  # Evenly spread nodes over the kernel's radius for FAR_TARGETS.


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
        width = mesh.half_widths[:-1] / d
        for k in np.flatnonzero((width > OWN_NODES_BELOW) & (width <= KERNEL_RULE_ABOVE)).tolist():
            near = _sees_images(mesh, k, d)
            smooth[k * mesh.order : (k + 1) * mesh.order, near] = self._of_wide_panel(mesh, k, mesh.nodes[near])
        kernel += smooth.T
        kernel[np.abs(mesh.nodes[:, None] - mesh.nodes) >= KERNEL_RADIUS * d] = 0.0
        for k in np.flatnonzero(width > KERNEL_RULE_ABOVE).tolist():
            column = kernel[:, k * mesh.order : (k + 1) * mesh.order]
            near = np.abs(mesh.nodes - mesh.centres[k]) < mesh.half_widths[k] + KERNEL_RADIUS * d
            column[:] = 0.0
            column[near] = self._by_whole_kernel(mesh, k, mesh.nodes[near])
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

    def _of_wide_panel(self, mesh: Mesh, k: int, x: Array) -> Array:
        """Return what pressures at the nodes of a panel deflect at places ``x`` by the smooth part, shape (order, len(x))."""
        half, d = float(mesh.half_widths[k]), self.layer_thickness
        nodes, weights = _finer_rule(mesh.order, _nodes_for(half / d, mesh.order))
        y = (float(mesh.centres[k]) + half * nodes)[:, None]
        smooth = self._smooth_part(x, y)
        beyond = np.abs(x - y) > KERNEL_RADIUS * d
        smooth[beyond] = np.log(np.abs(x - y)[beyond]) / math.pi  # where the whole kernel is zero
        return np.asarray((half * weights) @ smooth)

    def _by_whole_kernel(self, mesh: Mesh, k: int, x: Array) -> Array:
        """Return what pressures at the nodes of a panel deflect at places ``x`` by the whole kernel, shape (len(x), order)."""
        half, place = float(mesh.half_widths[k]) / self.layer_thickness, (x - mesh.centres[k]) / self.layer_thickness
        panel = reference(mesh.order)

        def ahead(place: Array, steps: int, grading: int) -> Array:
            first, last = np.clip(-half - place, 0.0, KERNEL_RADIUS), np.clip(half - place, 0.0, KERNEL_RADIUS)
            found = np.zeros((len(place), mesh.order))
            some = last > first
            # From afar it is a smooth function of the place, and the nodes in the contact lie close together.
            far = some & (first > FAR_FROM_PANEL)
            if 2 * half >= KERNEL_RADIUS - FAR_FROM_PANEL and np.count_nonzero(far) > FAR_TARGETS:
                rule, middle, span = (
                    reference(FAR_TARGETS),
                    -half - 0.5 * (FAR_FROM_PANEL + KERNEL_RADIUS),
                    0.5 * (KERNEL_RADIUS - FAR_FROM_PANEL),
                )
                there = ahead(middle + span * rule.nodes, FAR_NODES, 1)
                found[far] = rule.interpolation((place[far] - middle) / span) @ there
                some &= ~far
            first, length = first[some, None], (last - first)[some, None]
            at, weights = _clustered_rule(steps, grading)
            away = first + length * at
            kernel = length * weights * (smooth_kernel(away, self.poisson_ratio) - np.log(away) / math.pi)
            polynomials = panel.polynomials(((place[some, None] + away) / half).ravel()).reshape(mesh.order, *away.shape)
            found[some] = np.einsum("rs,nrs->rn", kernel, polynomials) @ panel.to_legendre
            return found

        both_sides = ahead(np.concatenate([place, -place]), NEAR_NODES, NEAR_CLUSTER_POWER)
        to_right, to_left = self.layer_thickness * both_sides.reshape(2, len(x), -1)
        return np.asarray(to_right + to_left[:, ::-1])

    def far_gap(self, x: Array) -> Array:
        """Return ``x**2/2``."""
        return 0.5 * x**2


def _sees_images(mesh: Mesh, k: int, thickness: float) -> Flags:
    """Return the nodes at which a panel's own nodes do not integrate the smooth part of the kernel."""
    # Polynomials on the panel converge by the ellipse through the image two thicknesses below the node.
    image = (mesh.nodes - mesh.centres[k] + 2j * thickness) / mesh.half_widths[k]
    return np.asarray(np.abs(image - 1) + np.abs(image + 1) < 2 * math.hypot(1.0, 2 / OWN_NODES_BELOW))


def _nodes_for(half_width: float, order: int) -> int:
    """Return how many nodes integrate the smooth part times the polynomials of a panel, with its half-width in thicknesses."""
    rho = 2 / half_width + math.hypot(1.0, 2 / half_width)
    return 4 * math.ceil((order - 1 - math.log(SMOOTH_RULE_ERROR) / math.log(rho)) / 8)


@lru_cache(maxsize=64)
def _finer_rule(order: int, count: int) -> tuple[Array, Array]:
    """Return ``count`` nodes on [-1, 1] and the weights there of what is known at ``order`` nodes, shape (order, count)."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return nodes, reference(order).interpolation(nodes).T * weights


@lru_cache(maxsize=2)
def _clustered_rule(count: int, grading: int) -> tuple[Array, Array]:
    """Return nodes and weights on [0, 1] for what holds a logarithm at zero or just beyond, if they crowd there."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    root = 0.5 * (1 + nodes)
    return root**grading, 0.5 * grading * root ** (grading - 1) * weights


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
    nodes, weights = np.polynomial.legendre.leggauss(24)
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
