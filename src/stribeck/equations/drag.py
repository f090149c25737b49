r"""Viscous friction of any film: the integrals of its drag on both walls, and their derivatives.

With :math:`C = 2 \bar F_N^{1/2} \lambda / (3\pi)` and the tractions :math:`T` of the film in :math:`\eta_0 U/u_\mathrm{Hz}`,

.. math::

    \mu_f^\mathrm{balanced} = C \int T_1 \, dx, \qquad \mu_f^\mathrm{upper} = C \int T_2 \, dx, \qquad
    \mu_f^\mathrm{published} = \mu_f^\mathrm{upper} - \frac{6 C}{\lambda} \int x \, p_f \, dx

on the substrate, on the cylinder, and on the cylinder with the fluid pressure projected on its slope.  In the cavity the
liquid is sheared without a pressure gradient.  For the film of the article the first and the last have closed forms in
:mod:`stribeck.equations.observables`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from stribeck._types import Array, Flags, Numbers
from stribeck.equations.line import Equations, scattered, slopes_in_film
from stribeck.fluids.fluid import Slopes
from stribeck.numerics.panels import towards_infinity
from stribeck.numerics.running_integral import RunningIntegral

__all__ = ["drag_gradients", "friction_scale", "viscous_friction"]


class Nodal(NamedTuple):
    """A film on the nodes of a mesh, which may be finer than that of its equations: rows of states.

    ``weights`` is the row that integrates nodal pressures to the load.
    """

    integral: RunningIntegral
    gap: Array
    pressure: Array
    weights: Array


def friction_scale(load: Numbers, speed: Numbers) -> Array:
    """Return C = 2 F**(1/2) lambda/(3 pi), the factor of all friction integrals for beta = 1."""
    return np.asarray(2 * np.sqrt(load) * speed / (3 * math.pi))


def viscous_friction(equations: Equations, y: Array, load: Numbers, nodal: Nodal) -> Array:
    """Return the viscous friction for beta = 1: published, balanced and upper, shape (3, rows).

    Parameters
    ----------
    equations : Equations
        Of the states.
    y : ndarray, shape (rows, unknowns)
        The states, for their numbers.
    load : float or ndarray
        Load group, a column of stacked states.
    nodal : Nodal
        Gap and fluid pressure.
    """
    op, at, film = equations.operators, equations.layout, equations.film
    mesh, order = nodal.integral.mesh, nodal.integral.mesh.order
    d, h_star = equations.dilation(y), y[..., at.flux_gap]
    far = equations.far_gap(y)
    t, tail_weights, to_tail = towards_infinity(order)
    t = t * mesh.half_widths[-1]
    xi, t_nodes = 1 / t, mesh.local[-1]
    smooth = nodal.gap[..., -order:] - far(mesh.nodes[-order:])
    h = smooth @ to_tail.T + far(xi)
    tail_weights = tail_weights * mesh.half_widths[-1] * xi**2
    p = None
    if film.uses_pressure:
        p = ((nodal.pressure[..., -order:] * t_nodes**-2) @ to_tail.T) * t**2
    weights = mesh.weights.copy()
    weights[-order:] = 0.0
    full = nodal.integral.integrated
    lower, upper = np.zeros((2, *y.shape[:-1]))
    for gap, pressure, wet, own in (
        (nodal.gap, nodal.pressure if film.uses_pressure else None, full, weights),
        (h, p, t < 0 if nodal.integral.one_sided else np.ones_like(t, dtype=bool), tail_weights),
    ):
        walls = film.tractions(*_at(wet, gap, pressure), h_star)
        lower, upper = lower + walls[0] @ own[wet], upper + walls[1] @ own[wet]
        if not wet.all():
            torn = film.cavity_traction(*_at(~wet, gap, pressure), h_star) @ own[~wet]
            lower, upper = lower + torn, upper + torn
    scale = friction_scale(load, equations.speed)
    stretch = np.ones(1) if d is None else d
    # Beyond the panels in x, integrated by parts: there the gap is known better than the pressure.
    g = film.gradient(*_at(wet, h, p), h_star)
    leverage = 0.5 * (mesh.edges[-1] ** 2 - xi[wet] ** 2) * tail_weights[wet]
    inner = slice(0, -order)
    moment = nodal.pressure[..., inner] @ (mesh.weights * mesh.nodes)[inner]
    moment = moment + np.ravel(equations.speed * stretch) * (g @ leverage)
    if op.has_exit:
        whole = (nodal.pressure @ nodal.weights)[..., None]
        moment = (stretch * (stretch * moment[..., None] + y[..., at.exit] * whole))[..., 0]
        lower, upper = lower * stretch[..., 0], upper * stretch[..., 0]
    scale = np.ravel(scale)
    upper = scale * upper
    return np.stack([upper - 6 * scale / np.ravel(equations.speed) * moment, scale * lower, upper])


def _at(nodes: Flags, gap: Array, pressure: Array | None) -> tuple[Array, Array | None]:
    """Return gap and pressure at some nodes; unchanged if these are all."""
    if nodes.all():
        return gap, pressure
    return gap[..., nodes], None if pressure is None else pressure[..., nodes]


def drag_gradients(equations: Equations, y: Array, load: Numbers) -> Array:
    """Return the derivatives of :func:`viscous_friction` with respect to the unknowns, shape (3, ..., y.shape[-1])."""
    op, at, film, d = equations.operators, equations.layout, equations.film, equations.dilation(y)
    h, h_star, wet = y[..., at.gap], y[..., at.flux_gap], op.wet
    p = y[..., at.pressure] if film.uses_pressure else None
    scale = friction_scale(load, equations.speed)
    stretch = np.ones(1) if d is None else d
    found = np.zeros((3, *y.shape))
    published, lower, upper = found
    lower_slopes, upper_slopes = film.traction_slopes(h[..., wet], None if p is None else p[..., wet], h_star)
    torn = None
    if not wet.all():
        torn = film.cavity_traction_slopes(h[..., ~wet], None if p is None else p[..., ~wet], h_star)
    for row, slopes in ((lower, lower_slopes), (upper, upper_slopes)):
        by_gap, by_pressure, by_flux = (_joined(k, slopes, torn, wet, h) for k in range(3))
        row[..., at.gap] = scale * stretch * op.mesh.weights * by_gap
        row[..., at.flux_gap] = scale * stretch * (by_flux @ op.mesh.weights)[..., None]
        if p is not None:
            row[..., at.pressure] = scale * stretch * op.mesh.weights * by_pressure
    of_moment = -6 * scale / equations.speed
    fluid = equations.pressures(y)[1]
    whole, first = (fluid @ op.weights)[..., None], (fluid @ op.moment)[..., None]
    x_c = y[..., at.exit] if op.has_exit else 0.0
    by_fluid = stretch * (stretch * op.moment + x_c * op.weights)
    published[...] = upper
    if p is not None:
        published[..., at.pressure] += of_moment * by_fluid
    else:
        through = equations.speed * stretch * stretch * (stretch * op.moment_of_gradient + x_c * op.load_of_gradient)
        slopes = slopes_in_film(film, op.integral, h, None, h_star)
        published[..., at.gap] += of_moment * through * slopes.by_gap
        published[..., at.flux_gap] += of_moment * (through * slopes.by_flux).sum(axis=-1, keepdims=True)
    if op.has_exit:
        published[..., at.exit] += of_moment * stretch * whole
    if d is not None:
        values = viscous_friction(equations, y, load, Nodal(op.integral, h, fluid, op.weights))
        published[..., at.dilation] = values[2][..., None] / d + of_moment * (2 * d * first + x_c * whole)
        lower[..., at.dilation], upper[..., at.dilation] = values[1][..., None] / d, values[2][..., None] / d
        if p is None:
            g_part = (fluid - op.cavity_pressure) / d
            published[..., at.dilation] += of_moment * (g_part * by_fluid).sum(axis=-1, keepdims=True)
    return found


def _joined(k: int, of_film: Slopes, torn: Slopes | None, wet: Flags, like: Array) -> Array:
    """Return one derivative at all nodes: that of the film, and in the cavity that of its liquid."""
    slope = of_film[k]
    found = np.zeros_like(like) if slope is None else scattered(np.broadcast_to(slope, like[..., wet].shape), wet, like)
    if torn is not None and torn[k] is not None:
        found[..., ~wet] = torn[k]
    return found
