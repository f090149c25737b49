r"""Plane-strain deflection of the half-space under a pressure on the line.

.. math:: w(x) = -\frac1\pi \int_{-\infty}^{\infty} p(y) \ln|x - y| \, dy

The kernel is integrated exactly against the polynomial through the nodal pressures of each panel (product
integration), with

.. math:: \int_{-1}^{1} P_n(t) \ln|s - t| \, dt = \frac{2 \, [Q_{n+1}(s) - Q_{n-1}(s)]}{2n + 1},

:math:`Q_n` the Legendre functions of the second kind.  On the panel through infinity, with :math:`t = 1/x` and
:math:`s = 1/y`,  :math:`\ln|x - y| = \ln|s - t| - \ln|s| - \ln|t|`, so that the same integrals serve there.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre

from ._types import Array
from .mesh import Mesh, reference

FAR_ACCURACY = 4e-13
"""Error of a panel's own Gauss rule for the logarithm from which a target counts as far: rho**(-2 order) for a distance of
(rho + 1/rho)/2 half-widths."""

LOST_DIGITS = 1e5
"""Amplification of rounding that the upward recurrence of Q_n may have outside a panel: it falls on the highest degrees, whose
coefficients are small.  Beyond, the downward recurrence takes over."""


def log_moments(points: Array, order: int) -> Array:
    r"""Return :math:`\int_{-1}^{1} P_n(t) \ln|s - t| dt` for ``n < order`` at ``points`` s, shape (len(points), order)."""
    s = np.asarray(points, dtype=float)
    # At the ends the singularities of the Q_n cancel; one unit in the last place away they do so in floating point.
    s = np.where(np.abs(s) == 1.0, s * (1 - 2.0**-53), s)
    q = np.empty((order + 1, len(s)))
    q[0] = 0.5 * np.log(np.abs((s + 1) / (s - 1)))
    q[1] = s * q[0] - 1
    near = np.abs(s) <= np.cosh(np.log(LOST_DIGITS) / (2 * order))
    for n in range(1, order):
        q[n + 1] = ((2 * n + 1) * s * q[n] - n * q[n - 1]) / (n + 1)
    if not near.all():
        q[:, ~near] = _second_kind_outside(s[~near], order)
    moments = np.empty((len(s), order))
    moments[:, 0] = (s + 1) * np.log(np.abs(s + 1)) - (s - 1) * np.log(np.abs(s - 1)) - 2
    degree = np.arange(1, order)
    moments[:, 1:] = (2 * (q[2:] - q[:-2]) / (2 * degree + 1)[:, None]).T
    return moments


def _second_kind_outside(s: Array, order: int) -> Array:
    """Legendre functions of the second kind up to ``order`` outside the panel, by downward recurrence (Miller)."""
    nearest = np.abs(s).min()
    decay = np.log(nearest + np.sqrt(nearest**2 - 1))
    top = order + int(np.ceil(19.0 / decay))
    q = np.empty((order + 1, len(s)))
    above, here = np.zeros_like(s), np.full_like(s, 1e-280)
    for n in range(top, -1, -1):
        if n <= order:
            q[n] = here
        above, here = here, ((2 * n + 1) * s * here - (n + 1) * above) / max(n, 1)
    return np.asarray(q * (0.5 * np.log(np.abs((s + 1) / (s - 1))) / q[0]))


@lru_cache(maxsize=32)
def _from_moments(order: int) -> Array:
    """Matrix from the log moments to the integrals of the nodal (Lagrange) basis."""
    rule = reference(order)
    degrees = np.arange(order)
    return np.asarray((degrees[:, None] + 0.5) * legendre.legvander(rule.nodes, order - 1).T * rule.weights)


@lru_cache(maxsize=32)
def _on_panel(order: int) -> Array:
    """Log integrals of the nodal basis at the nodes themselves."""
    return log_moments(reference(order).nodes, order) @ _from_moments(order)


def near_distance(order: int) -> float:
    """Return the distance from its centre, in half-widths, within which a panel is integrated exactly."""
    rho = float(FAR_ACCURACY ** (-0.5 / order))
    return 0.5 * (rho + 1 / rho)


def deflection_operator(mesh: Mesh, points: Array | None = None) -> Array:
    r"""Return the matrix from nodal pressures to the deflection.

    .. math:: w(x_i) = -\frac1\pi \int p(y) \ln|x_i - y| \, dy = \sum_j D_{ij} p(x_j)

    Parameters
    ----------
    mesh : Mesh
        Panels that carry the pressure.
    points : ndarray, shape (n,), optional
        Where the deflection is wanted [Hertz half-width]; the nodes of ``mesh`` by default.  Zero is allowed.

    Returns
    -------
    ndarray, shape (n, mesh.size)
        The operator [u_Hz per p_Hz].

    Notes
    -----
    Spectral in the order of the panels; see ``tests/test_elasticity.py``.
    Source: [BP] Eq. (elasticity_dl), gauge ln(|x - y|/a).
    """
    order = mesh.order
    rule = reference(order)
    x = mesh.nodes if points is None else np.asarray(points, dtype=float)
    inner = mesh.nodes[:-order]
    kernel = np.empty((len(x), mesh.panels, order))

    distance = np.abs(x[:, None] - inner)
    s = (x[:, None] - mesh.centres[:-1]) / mesh.half_widths[:-1]
    near_by = near_distance(order)
    target, source = np.nonzero(np.abs(s) < near_by)
    distance[distance == 0] = 1.0
    kernel[:, :-1, :] = (np.log(distance) * mesh.weights[:-order]).reshape(len(x), mesh.panels - 1, order)
    half = mesh.half_widths[source][:, None]
    near = log_moments(s[target, source], order) @ _from_moments(order)
    kernel[target, source, :] = half * (near + np.log(half) * rule.weights)

    half_tail = mesh.half_widths[-1]
    t_source = mesh.local[-1]
    close = np.nonzero(np.abs(x) * half_tail * near_by > 1.0)[0]
    ratio = t_source * x[:, None]
    ratio[close] = 0.0
    tail = np.log1p(-ratio) * rule.weights
    t_target = 1.0 / x[close] if len(close) else np.empty(0)
    moments = log_moments(t_target / half_tail, order) @ _from_moments(order)
    tail[close] = moments + np.log(half_tail / np.abs(t_target))[:, None] * rule.weights
    at_infinity = log_moments(np.zeros(1), order) @ _from_moments(order) + np.log(half_tail) * rule.weights
    kernel[:, -1, :] = half_tail * (tail - at_infinity) * mesh.stretch[-order:]
    return np.asarray(kernel.reshape(len(x), mesh.size) / -np.pi)
