r"""Deflection of an elastic layer that is bonded to a rigid base.

.. math::

    \hat w(q) = \frac{2 \hat p(q)}{E^* |q|} \, S(q d), \qquad
    S(x) = \frac{k \sinh 2x - 2x}{k \cosh 2x + 2x^2 + 5 - 12\nu + 8\nu^2}, \quad k = 3 - 4\nu

In Hertz units the kernel on the line is that of the half-plane and a smooth function of x/d,

.. math::

    K(x) = -\frac1\pi \ln\left|\frac xd\right| + k_s\left(\frac xd\right), \qquad
    \pi k_s(\xi) = \int_0^\infty \frac{(S(q) - 1) \cos q\xi + e^{-q}}{q} \, dq

K falls exponentially: beyond 24 thicknesses it is zero to rounding.  The layer sticks to its base; its upper surface is free
of shear stress.  Unlike the half-plane it has no logarithm far away, so that its offset is a height.

Source: the plane-strain solution of a bonded layer, [Johnson 1985] section 5.8; checked against a Fourier integral.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from stribeck._types import Array
from stribeck.numerics.cells import Cells
from stribeck.numerics.panels import Mesh, reference
from stribeck.quantities.units import InputError, show, to_si
from stribeck.solids.half_plane import nodal_deflection
from stribeck.solids.solid import Lengths

__all__ = ["Layer"]

REACH = 24.0
"""Distance in thicknesses beyond which the kernel is zero."""

TABLE = 160
"""Chebyshev coefficients of the smooth part of the kernel: exact to 1e-13."""

LARGEST_WAVE, WAVE_PANELS = 40.0, 60
"""Wave number times thickness beyond which S is one to rounding, and panels of waves up to there."""

CELLS, DEGREES = 384, 8
"""Cells over :data:`REACH` on which the smooth part is a polynomial, and its coefficients there: to 1e-14 the same."""

FINEST_PANEL = 0.75
"""Half-width of a panel in thicknesses up to which its own nodes integrate the smooth part; wider ones are cut for that."""

WIDEST_PANEL = 6.0
"""Half-width of a panel in thicknesses from which its pressure acts only at its own nodes."""


@dataclass(frozen=True, init=False)
class Layer:
    """An elastic layer bonded to a rigid base: it neither slides on the base nor lifts off.

    Parameters
    ----------
    thickness : str or float
        Its thickness, > 0 [m]; with groups in Hertz half-widths a of the half-plane.
    poisson_ratio : float
        Poisson's ratio, 0 to 0.5; 0.5 is incompressible.

    Raises
    ------
    InputError
        If an argument is outside its range.
    """

    thickness: float
    poisson_ratio: float

    def __init__(self, thickness: str | float, poisson_ratio: float = 0.5) -> None:
        d, nu = to_si(thickness, "length", "thickness"), to_si(poisson_ratio, "number", "poisson_ratio")
        if not d > 0:
            raise InputError(f"thickness = {show(thickness)}; it must be above zero, such as '2 mm'.")
        if not 0 <= nu <= 0.5:
            raise InputError(f"poisson_ratio = {show(poisson_ratio)}; it must lie between 0 and 0.5.")
        object.__setattr__(self, "thickness", d)
        object.__setattr__(self, "poisson_ratio", nu)

    @property
    def name(self) -> str:
        """Name that outputs print."""
        return "bonded layer"

    @property
    def parameters(self) -> dict[str, float | str]:
        """Thickness and Poisson's ratio."""
        return {"thickness": self.thickness, "poisson_ratio": self.poisson_ratio}

    @property
    def lengths(self) -> Lengths:
        """Its thickness, for meshes."""
        return Lengths(self.thickness)

    def scaled(self, length: float, speed: float = 1.0) -> Layer:
        """Return the layer with its thickness over a length, the Hertz half-width."""
        return Layer(self.thickness / length, self.poisson_ratio)

    def deflection(self, mesh: Mesh) -> Array:
        """Return the matrix from nodal pressures to the deflection at the nodes [u_Hz per p_Hz].

        Panels on which pressure acts must not be much wider than the layer is thick: on panels wider than twelve thicknesses
        the layer acts as springs side by side, ``d (1 - 2 nu)/(2 (1 - nu)^2)`` [u_Hz per p_Hz].
        """
        d, nu, x = self.thickness, self.poisson_ratio, mesh.nodes
        distance = np.abs(x[:, None] - x) / d
        near = distance < REACH
        kernel = nodal_deflection(mesh)
        smooth = smooth_kernel(np.minimum(distance, REACH), nu)
        smooth += math.log(d) / math.pi
        smooth *= mesh.weights[:, None]
        width = mesh.half_widths[:-1] / d
        for k in np.flatnonzero((width > FINEST_PANEL) & (width <= WIDEST_PANEL)).tolist():
            smooth[k * mesh.order : (k + 1) * mesh.order] = self._of_wide_panel(mesh, k)
        kernel += smooth.T  # symmetric but for the weights, and the kernel is in Fortran order
        kernel *= near.T
        wide = np.append(width > WIDEST_PANEL, True)
        columns = np.flatnonzero(np.repeat(wide, mesh.order))
        kernel[:, columns] = 0.0
        kernel[columns, columns] = d * (1 - 2 * nu) / (2 * (1 - nu) ** 2)
        return np.asfortranarray(kernel)

    def _of_wide_panel(self, mesh: Mesh, k: int) -> Array:
        """Return what pressures at the nodes of a panel deflect at all nodes by the smooth part, shape (order, size)."""
        rule, half = reference(mesh.order), float(mesh.half_widths[k])
        parts = math.ceil(half / (FINEST_PANEL * self.thickness))
        t = ((2 * np.arange(parts)[:, None] + 1 - parts + rule.nodes) / parts).ravel()
        distance = np.abs(mesh.nodes - (float(mesh.centres[k]) + half * t)[:, None]) / self.thickness
        smooth = smooth_kernel(np.minimum(distance, REACH), self.poisson_ratio)
        beyond = distance > REACH
        smooth[beyond] = np.log(distance[beyond]) / math.pi  # where the whole kernel is zero
        smooth += math.log(self.thickness) / math.pi
        weights = np.tile(rule.weights, parts) * (half / parts)
        return np.asarray((weights[:, None] * rule.interpolation(t)).T @ smooth)

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
def _table(poisson_ratio: float) -> Array:
    """Chebyshev coefficients of the smooth kernel over ``0 <= xi <= REACH``."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    half = 0.5 * LARGEST_WAVE / WAVE_PANELS
    q = (half * (1 + 2 * np.arange(WAVE_PANELS)[:, None] + nodes)).ravel()
    weights = np.tile(half * weights, WAVE_PANELS)
    xi = 0.5 * REACH * (1 + np.cos(np.pi * (np.arange(TABLE) + 0.5) / TABLE))
    excess = transfer(q, poisson_ratio) - 1
    values = ((excess * np.cos(np.outer(xi, q)) + np.exp(-q)) / q) @ weights / np.pi
    found = chebyshev.chebfit(2 * xi / REACH - 1, values, TABLE - 1)
    return np.asarray(found)


@lru_cache(maxsize=16)
def _on_cells(poisson_ratio: float) -> Cells:
    """Return the smooth kernel over ``0 <= xi <= REACH``, quick to evaluate."""
    of_table = _table(poisson_ratio)

    def smooth(xi: Array) -> Array:
        return np.asarray(chebyshev.chebval(2 * xi / REACH - 1, of_table), dtype=float)

    return Cells.of(smooth, 0.0, REACH, CELLS, DEGREES)


def smooth_kernel(xi: Array, poisson_ratio: float) -> Array:
    """Return k_s at distances of xi thicknesses, ``0 <= xi <= 24``."""
    return _on_cells(poisson_ratio)(xi)
