r"""Plane-strain deflection of the half-space under a pressure on the line.

.. math:: w(x) = -\frac1\pi \int_{-\infty}^{\infty} p(y) \ln|x - y| \, dy

The kernel is integrated exactly against the polynomial through the nodal pressures of each panel (product
integration), with

.. math:: \int_{-1}^{1} P_n(t) \ln|s - t| \, dt = \frac{2 \, [Q_{n+1}(s) - Q_{n-1}(s)]}{2n + 1},

:math:`Q_n` the Legendre functions of the second kind.  On the panel through infinity, with :math:`t = 1/x` and
:math:`s = 1/y`,  :math:`\ln|x - y| = \ln|s - t| - \ln|s| - \ln|t|`, so that the same integrals serve there.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre

from stribeck._types import Array, Flags, Indices
from stribeck.numerics.panels import HalfTail, Mesh, reference
from stribeck.quantities.units import InputError, show
from stribeck.solids.solid import Solid, check_solid

# Error of a panel's own Gauss rule for the logarithm, rho**(-2 order) at (rho + 1/rho)/2 half-widths, below which it serves.
FAR_RULE_ERROR = 4e-13

# Growth of rounding that the upward recurrence of Q_n may have outside a panel: above it a finer Gauss rule serves.
MAX_ROUNDING_GROWTH = 1e5

FINE_RULE_ERROR = 1e-16  # Error of that finer Gauss rule.


def log_moments(points: Array, order: int) -> Array:
    r"""Return :math:`\int_{-1}^{1} P_n(t) \ln|s - t| dt` for ``n < order`` at ``points`` s, shape (len(points), order)."""
    s = np.asarray(points, dtype=float)
    near = np.abs(s) <= np.cosh(np.log(MAX_ROUNDING_GROWTH) / (2 * order))
    moments = np.empty((len(s), order))
    moments[near] = _by_recurrence(s[near], order)
    if not near.all():
        nodes, values = _rule_outside(order)
        moments[~near] = np.log(np.abs(s[~near, None] - nodes)) @ values
    return moments


def _by_recurrence(s: Array, order: int) -> Array:
    """Return the moments by upward recurrence of the Legendre functions of the second kind."""
    # At the ends the singularities of the Q_n cancel; one unit in the last place away they do so in floating point.
    s = np.where(np.abs(s) == 1.0, s * (1 - 2.0**-53), s)
    q = np.empty((order + 1, len(s)))
    q[0] = 0.5 * np.log(np.abs((s + 1) / (s - 1)))
    q[1] = s * q[0] - 1
    for n in range(1, order):
        q[n + 1] = ((2 * n + 1) * s * q[n] - n * q[n - 1]) / (n + 1)
    moments = np.empty((len(s), order))
    moments[:, 0] = (s + 1) * np.log(np.abs(s + 1)) - (s - 1) * np.log(np.abs(s - 1)) - 2
    degree = np.arange(1, order)
    moments[:, 1:] = (2 * (q[2:] - q[:-2]) / (2 * degree + 1)[:, None]).T
    return moments


@lru_cache(maxsize=32)
def _rule_outside(order: int) -> tuple[Array, Array]:
    """Nodes of a rule that integrates the logarithm where no upward recurrence does, and weights times polynomials there."""
    log_rho = np.log(MAX_ROUNDING_GROWTH) / (2 * order)
    nodes, weights = legendre.leggauss(math.ceil(0.5 * (order - np.log(FINE_RULE_ERROR) / log_rho)))
    return nodes, weights[:, None] * legendre.legvander(nodes, order - 1)


def _log_integrals(s: Array, order: int) -> Array:
    """Log integrals of the nodal basis at ``s``."""
    return np.asarray(log_moments(s, order) @ reference(order).to_legendre)


def near_distance(order: int) -> float:
    """Return the distance from its centre, in half-widths, within which a panel is integrated exactly."""
    rho = float(FAR_RULE_ERROR ** (-0.5 / order))
    return 0.5 * (rho + 1 / rho)


def nodes_of(targets: Callable[[Array, Array, Array], Array], places: Array, order: int) -> Array:
    """Return where the nodes of panels are, seen from others, shape (pairs, order)."""
    centres, half_widths = places.T[:, :, None]
    return targets(centres, half_widths, reference(order).nodes)


def near_panels(mesh: Mesh) -> tuple[Indices, Indices, Array]:
    """Return targets and sources of all pairs of panels in ``x`` of which the source acts on a near node, and their places."""
    c, d = mesh.centres[:-1], mesh.half_widths[:-1]
    offset, ratio = (c[:, None] - c) / d, d[:, None] / d
    target, source = np.nonzero(np.abs(offset) - ratio < near_distance(mesh.order))
    return target, source, np.stack([offset[target, source], ratio[target, source]], axis=1)


def near_infinity(mesh: Mesh) -> Flags:
    """Return which panels in ``x`` act on a near node of the panel through infinity."""
    outermost = np.abs(mesh.centres[:-1]) + near_distance(mesh.order) * mesh.half_widths[:-1]
    return np.asarray(outermost > mesh.edges[-1])


def panels_from_infinity(mesh: Mesh) -> Array:
    """Return the places of the panels in ``x`` in units of the edge of the panel through infinity."""
    edge = mesh.edges[-1]
    return np.stack([mesh.centres[:-1] / edge, mesh.half_widths[:-1] / edge], axis=1)


def _beside_panel(s: Array, order: int) -> Array:
    """Integrals of ``ln|s - t|`` times the nodal basis of a panel at targets s, exact where these are near."""
    rule = reference(order)
    far = np.abs(s) >= near_distance(order)
    found = np.empty((len(s), order))
    found[far] = np.log(np.abs(s[far, None] - rule.nodes)) * rule.weights
    found[~far] = _log_integrals(s[~far], order)
    return found


def _from_tail(x: Array, centre: float, half: float, order: int) -> Array:
    """Return -pi times what densities ``p x**2`` at the nodes of a panel in ``t = 1/x`` deflect at x, less at infinity."""
    # The integrals of ln|1 - x t| times the nodal basis.
    rule, s = reference(order), (1 / x - centre) / half
    far = np.abs(s) >= near_distance(order)
    found = np.empty((len(x), order))
    found[far] = np.log1p(-x[far, None] * (centre + half * rule.nodes)) * rule.weights
    found[~far] = _log_integrals(s[~far], order) + np.log(half * np.abs(x[~far]))[:, None] * rule.weights
    at_infinity = _log_integrals(np.array([-centre / half]), order) + np.log(half) * rule.weights
    return np.asarray(half * (found - at_infinity))


def nodes_on_panel(centre: Array, half_width: Array, nodes: Array) -> Array:
    """Return the nodes of a panel in ``x``, seen from another."""
    return centre + half_width * nodes


def nodes_at_infinity(centre: Array, half_width: Array, nodes: Array) -> Array:
    """Return the nodes of the panel through infinity, seen from one in ``x`` whose place is in units of its edge."""
    return np.asarray((1 / nodes - centre) / half_width)


def _near_blocks(targets: Callable[..., Array], places: Array, half: Array, order: int) -> Array:
    """Return what pressures at the nodes of panels do at those of others near them, shape (pairs, order, order)."""
    near = _beside_panel(nodes_of(targets, places, order).ravel(), order).reshape(len(places), order, order)
    scaled = np.log(half)[:, None] * reference(order).weights
    return np.asarray(half[:, None, None] * (near.transpose(0, 2, 1) + scaled[:, :, None]))


def nodal_deflection(mesh: Mesh, beyond: bool = True) -> Array:
    r"""Return the matrix from nodal pressures to the deflection at the nodes, in Fortran order.

    .. math:: w(x_i) = -\frac1\pi \int p(y) \ln|x_i - y| \, dy = \sum_j D_{ij} p(x_j)

    Pressures on the panel through infinity deflect something only if ``beyond``.
    """
    order, panels = mesh.order, mesh.panels
    # By columns, so that the operator comes in Fortran order: what panel k does at the nodes of panel l is [k, :, l, :].
    kernel = np.empty((panels, order, panels, order))
    columns = kernel.reshape(mesh.size, mesh.size)
    # In the memory of the operator: new memory for each step costs more than the steps.
    distance = np.subtract.outer(mesh.nodes[:-order], mesh.nodes, out=columns[:-order])
    np.abs(distance, out=distance)
    distance[distance == 0] = 1.0
    np.log(distance, out=distance)
    distance *= mesh.weights[:-order, None]
    target, source, places = near_panels(mesh)
    kernel[source, :, target, :] = _near_blocks(nodes_on_panel, places, mesh.half_widths[source], order)
    outermost = np.flatnonzero(near_infinity(mesh))
    places = panels_from_infinity(mesh)[outermost]
    kernel[outermost, :, -1, :] = _near_blocks(nodes_at_infinity, places, mesh.half_widths[outermost], order)
    columns[-order:] = 0.0
    if beyond:
        columns[-order:] = (_from_tail(mesh.nodes, 0.0, mesh.half_widths[-1], order) * mesh.stretch[-order:]).T
    columns *= -1 / np.pi
    return columns.T


def deflection_by_half_tail(tail: HalfTail) -> Array:
    """Return the matrix from densities ``p x**2`` at the nodes of half the panel through infinity to the deflection."""
    return _from_tail(tail.mesh.nodes, -tail.half_width, tail.half_width, tail.mesh.order) / -np.pi


@dataclass(frozen=True)
class HalfPlane:
    """The elastic half-plane, much thicker than the contact is wide."""

    name: str = "half-plane"

    @property
    def parameters(self) -> dict[str, float | str]:
        """None."""
        return {}

    def scaled(self, length: float, speed: float = 1.0) -> HalfPlane:
        """Return the body itself: it has no length."""
        return self

    def deflection(self, mesh: Mesh) -> Array:
        """Return :func:`nodal_deflection`."""
        return nodal_deflection(mesh)

    def far_gap(self, x: Array) -> Array:
        """Return ``x**2/2 - ln|x|/2``: a load of pi/2 on the half-plane."""
        return 0.5 * x**2 - 0.5 * np.log(np.abs(x))


def as_solid(name: str, solid: Solid | None) -> Solid:
    """Return what users give as the body of that name, a half-plane for none; refuse what is no body."""
    if solid is None:
        return HalfPlane()
    if hasattr(solid, "deflection") and not isinstance(solid, type):
        check_solid(name, solid)
        return solid
    raise InputError(f"{name} = {show(solid)}; give one of sb.solids such as Layer('2 mm'), or leave it out: a half-space.")
