r"""Deflection of an elastic half-space under a pressure on a disc, mode by mode in the angle (Boussinesq).

.. math::

    w(\mathbf r) = \frac{2}{\pi^2} \int \frac{p(\mathbf r')}{|\mathbf r - \mathbf r'|} d^2 r', \qquad
    w_m(r) = \frac{2}{\pi^2} \int p_m(s) \, \frac{2}{\sqrt{r s}} \, Q_{m-1/2}(\chi) \, s \, ds

for :math:`p = \sum_m p_m(r) \cos m\theta`, in Hertz units.  The kernel is integrated against the polynomials of each panel
(product integration): far panels by a Gauss rule, near ones in two parts, split at the target, on which the nodes cluster
towards it with the fifth power, so that the logarithm is no obstacle.

The rings of the potential are Legendre functions of the second kind of half-integer degree,

.. math:: \int_0^{2\pi} \frac{\cos m\varphi \, d\varphi}{\sqrt{r^2 + s^2 - 2 r s \cos\varphi}}
          = \frac{2}{\sqrt{r s}} \, Q_{m-1/2}(\chi), \qquad \chi = \frac{r^2 + s^2}{2 r s} = \cosh\ln\frac rs

They hold a logarithm where r = s, so that the difference of the radii is an argument of its own, to be given exactly.

Source: [DLMF] 14.5, 14.10 (recurrence in the degree), 19.5; Miller's algorithm: [DLMF] 3.6.
"""

import numpy as np
import scipy

from stribeck._types import Array
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.numerics.panels import clustered, reference
from stribeck.numerics.settings import HALF_DIGITS

FAR_DISTANCE = 1.35  # Distance from the centre of a panel [half-widths] from which FAR_POINTS serve, with an error of 1e-12.
FAR_POINTS = 24  # Gauss points of a panel for targets from FAR_DISTANCE on: rho**-35 is left beside a polynomial of degree 12.

FARTHER_DISTANCE = 2.8  # Distance from the centre of a panel [half-widths] from which FARTHER_POINTS serve.
FARTHER_POINTS = 16  # Gauss points of a panel for targets from FARTHER_DISTANCE on.

NEAR_POINTS = 40  # Gauss points on each part of a near panel.

CLUSTER_POWER = 5  # Power with which the points of a near panel cluster towards the target.


def deflection_by_mode(mesh: PolarMesh) -> Array:
    """Return the matrices from the nodal pressures of each angular mode to its deflection."""
    count, radii = mesh.modes, mesh.radii
    found = np.zeros((count, radii.size, mesh.rings))
    centre, half = mesh.spans
    for panel in range(mesh.panels):
        far_out = panel >= mesh.log_from
        place = ((np.log(radii) if far_out else radii) - centre[panel]) / half[panel]
        kind = np.searchsorted((FAR_DISTANCE, FARTHER_DISTANCE), np.abs(place), side="right")
        columns = mesh.of_panel[panel]
        for which, points in enumerate((_near_points, _far_points, _farther_points)):
            group = np.flatnonzero(kind == which)
            if group.size == 0:
                continue
            t, difference, weights = points(mesh, panel, radii[group], place[group])
            r = radii[group][:, None]
            source = r + difference
            kernel = ring_functions(
                np.broadcast_to(r, source.shape).ravel(), source.ravel(), difference.ravel(), count
            ).reshape(count, *source.shape)
            kernel *= 4.0 / np.pi**2 * weights * np.sqrt(source / r)
            basis = mesh.rule(panel).interpolation(t)
            if basis.ndim == 2:  # the same points for all targets
                block = kernel @ basis
            else:
                block = np.matmul(kernel.transpose(1, 0, 2), basis).transpose(1, 0, 2)
            found[:, group[:, None], columns] += block
    return found


def tilt_from_beyond(mesh: PolarMesh, power: float) -> Array:
    """Return the deflection at the radii of a mesh, of mode one, under ``(r/rim)**power`` beyond its rim, power < -1."""
    return np.asarray(deflections_from_beyond(mesh, power, 2)[1])


def deflections_from_beyond(mesh: PolarMesh, power: float, modes: int) -> Array:
    """Return the same of the first modes, shape (modes, rings)."""
    v, w = clustered(NEAR_POINTS, CLUSTER_POWER)
    r, rim = mesh.radii[:, None], mesh.rim
    # s = rim/(1 - v), so that it reaches from the rim to infinity; far out the kernel falls as r/s**2.
    beyond = v / (1.0 - v) * rim
    source = rim + beyond
    weights = w * rim / (1.0 - v) ** 2 * (source / rim) ** power
    difference = np.broadcast_to(beyond, (mesh.rings, v.size)) + (rim - r)
    radius, sources = np.broadcast_to(r, difference.shape), np.broadcast_to(source, difference.shape)
    kernel = ring_functions(radius.ravel(), sources.ravel(), difference.ravel(), modes).reshape(modes, *difference.shape)
    return np.asarray((4.0 / np.pi**2 * kernel * np.sqrt(sources / radius)) @ weights)


def _farther_points(mesh: PolarMesh, panel: int, radii: Array, place: Array) -> tuple[Array, Array, Array]:
    return _far_points(mesh, panel, radii, place, FARTHER_POINTS)


def _far_points(
    mesh: PolarMesh, panel: int, radii: Array, place: Array, count: int = FAR_POINTS
) -> tuple[Array, Array, Array]:
    """Return where the points lie on the panel, how far from the targets, and the weights over r."""
    t, w = reference(count).nodes, reference(count).weights
    centre, half = mesh.spans[0][panel], mesh.spans[1][panel]
    r = centre + half * t
    weights = half * w
    if panel >= mesh.log_from:
        r = np.exp(r)
        weights = weights * r
    difference = r - radii[:, None]
    return t, difference, np.broadcast_to(weights, difference.shape)


def _near_points(mesh: PolarMesh, panel: int, radii: Array, place: Array) -> tuple[Array, Array, Array]:
    """Return the same for near targets, on both parts of the panel; a part may be empty."""
    v, w = clustered(NEAR_POINTS, CLUSTER_POWER)
    half = float(mesh.spans[1][panel])
    inside = np.clip(place, -1.0, 1.0)[:, None]
    outside = place[:, None] - inside  # how far the target lies beyond the end of the panel
    below, above = 1.0 + inside, 1.0 - inside
    t = np.hstack([inside - below * v, inside + above * v])
    offset = half * np.hstack([-outside - below * v, -outside + above * v])
    offset[offset == 0.0] = half  # in an empty part, without weight
    weights = half * np.hstack([below * w, above * w])
    if panel < mesh.log_from:
        return t, offset, weights
    difference = radii[:, None] * np.expm1(offset)
    return t, difference, weights * (radii[:, None] + difference)


# Decay of the functions over which the recurrence upward in the degree loses a quarter of the digits.
UPWARD_LOG = -0.25 * np.log(HALF_DIGITS)
# Decay from the highest degree wanted to Miller's start: with the error of the start, of second order in 1/degree, the error
# left is below rounding.
START_LOG = 3.0 * UPWARD_LOG


def ring_functions(radius: Array, source: Array, difference: Array, count: int) -> Array:
    r"""Return :math:`Q_{m-1/2}(\chi)` for ``m < count``."""
    ratio = np.abs(difference) / np.sqrt(radius * source)  # 2 sinh(xi/2)
    excess = 0.5 * ratio * ratio  # chi - 1
    complement = (difference / (radius + source)) ** 2
    k = np.sqrt(1.0 - complement)
    first = k * scipy.special.ellipkm1(complement)
    second = (1.0 + excess) * first - (2.0 + excess) * k * scipy.special.ellipe(1.0 - complement)
    chi = 1.0 + excess
    xi = 2.0 * np.arcsinh(0.5 * ratio)
    found = np.empty((count, radius.size))
    found[0] = first
    if count == 1:
        return found
    by_distance = np.argsort(xi)
    upward = int(np.searchsorted(xi[by_distance], UPWARD_LOG / count))
    near = by_distance[:upward]
    found[:, near] = _upward(chi[near], first[near], second[near], count)
    start = upward
    while start < xi.size:  # groups in which the start of the downward recurrence differs by a factor of two at most
        stop = int(np.searchsorted(xi[by_distance], 2.0 * xi[by_distance[start]], side="right"))
        group = by_distance[start:stop]
        found[:, group] = _downward(chi[group], first[group], count, int(START_LOG / xi[group[0]]) + 2)
        start = stop
    return found


def _upward(chi: Array, first: Array, second: Array, count: int) -> Array:
    q = np.empty((count, chi.size))
    q[0], q[1] = first, second
    for m in range(1, count - 1):
        q[m + 1] = (2 * m * chi * q[m] - (m - 0.5) * q[m - 1]) / (m + 0.5)
    return q


def _downward(chi: Array, first: Array, count: int, beyond: int) -> Array:
    """Return the functions by the recurrence from ``beyond`` the last, as ratios, so that nothing overflows."""
    q = np.empty((count, chi.size))
    m = count + beyond + 1
    # Where the ratio of two neighbours does not change with the degree.
    ratio = (m - 0.5) / (m * chi + np.sqrt((m * chi) ** 2 - (m - 0.5) * (m + 0.5)))
    twice, below = 2.0 * chi, np.empty_like(chi)
    for m in range(count + beyond, 0, -1):  # ratio: Q of degree m + 1/2 over that of m - 1/2
        np.multiply(twice, m, out=below)
        ratio *= m + 0.5
        below -= ratio
        np.divide(m - 0.5, below, out=ratio)
        if m < count:
            q[m] = ratio
    q[0] = first
    return np.asarray(np.cumprod(q, axis=0, out=q))
