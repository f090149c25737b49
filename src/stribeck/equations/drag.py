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
from stribeck.equations.line import Equations
from stribeck.fluids.fluid import Slopes
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
    mesh, d, h_star = nodal.integral.mesh, equations.dilation(y), y[..., at.flux_gap]
    far, last = equations.far_gap(y), slice(-mesh.order, None)
    xi, beyond, to_beyond = mesh.beyond
    h = (nodal.gap[..., last] - far(mesh.nodes[last])) @ to_beyond.T + far(xi)
    known, p = None, None
    if film.uses_pressure:
        known = nodal.pressure
        p = ((known[..., last] * mesh.stretch[last]) @ to_beyond.T) / xi**2
    weights = mesh.weights.copy()
    weights[last] = 0.0
    one_sided, upstream = nodal.integral.one_sided, slice(0, len(xi) // 2)
    lower, upper = np.zeros((2, *y.shape[:-1]))
    for gap, pressure, own, (wet, torn) in (
        (nodal.gap, known, weights, _parts(nodal.integral)),
        (h, p, beyond, (upstream, slice(len(xi) // 2, None)) if one_sided else (slice(None), None)),
    ):
        walls = film.tractions(gap[..., wet], None if pressure is None else pressure[..., wet], h_star)
        lower, upper = lower + walls[0] @ own[wet], upper + walls[1] @ own[wet]
        if torn is not None:
            liquid = (
                film.cavity_traction(gap[..., torn], None if pressure is None else pressure[..., torn], h_star) @ own[torn]
            )
            lower, upper = lower + liquid, upper + liquid
    # Beyond the panels in x, integrated by parts: there the gap is known better than the pressure.
    wet = upstream if one_sided else slice(None)
    g = film.gradient(h[..., wet], None if p is None else p[..., wet], h_star)
    leverage = 0.5 * (mesh.edges[-1] ** 2 - xi[wet] ** 2) * beyond[wet]
    stretch, inner = np.ones(1) if d is None else d, slice(0, -mesh.order)
    moment = nodal.pressure[..., inner] @ (mesh.weights * mesh.nodes)[inner]
    moment = moment + np.ravel(equations.speed * stretch) * (g @ leverage)
    if op.has_exit:
        whole = (nodal.pressure @ nodal.weights)[..., None]
        moment = (stretch * (stretch * moment[..., None] + y[..., at.exit] * whole))[..., 0]
        lower, upper = lower * stretch[..., 0], upper * stretch[..., 0]
    found = np.stack([upper - 6 / np.ravel(equations.speed) * moment, lower, upper])
    found *= np.ravel(friction_scale(load, equations.speed))
    return found


def _parts(integral: RunningIntegral) -> tuple[slice | Flags, slice | Flags | None]:
    """Return the nodes in the film and those in the cavity, on the panels in x at least."""
    if integral.restart == 0.0:
        return slice(None), None
    if integral.one_sided:
        end = integral.middle * integral.mesh.order
        return slice(0, end), slice(end, -integral.mesh.order)
    return integral.integrated, ~integral.integrated


def drag_gradients(equations: Equations, y: Array, load: Numbers, slopes: Slopes | None) -> Array:
    """Return the derivatives of :func:`viscous_friction` with respect to the unknowns, shape (3, ..., y.shape[-1]).

    ``slopes`` are those of G at the nodes, see :func:`stribeck.equations.line.slopes_in_film`; None where the pressure is an
    unknown.
    """
    op, at, film, d = equations.operators, equations.layout, equations.film, equations.dilation(y)
    h, h_star = y[..., at.gap], y[..., at.flux_gap]
    p = y[..., at.pressure] if film.uses_pressure else None
    scale = friction_scale(load, equations.speed)
    stretch = np.ones(1) if d is None else d
    found = np.zeros((3, *y.shape))
    published, lower, upper = found
    wet, dry = op.parts if op.has_exit else (slice(None), slice(0, 0))
    torn = None
    if op.has_exit:
        torn = film.cavity_traction_slopes(h[..., dry], None if p is None else p[..., dry], h_star)
    of_walls = film.traction_slopes(h[..., wet], None if p is None else p[..., wet], h_star)
    of_sum, own = scale * stretch, op.mesh.weights
    for row, (by_gap, by_pressure, by_flux, _) in zip((lower, upper), of_walls, strict=True):
        row[..., at.gap][..., wet] = by_gap
        row[..., at.flux_gap] = (by_flux @ own[wet])[..., None]
        if by_pressure is not None:
            row[..., at.pressure][..., wet] = by_pressure
        if torn is not None:
            row[..., at.gap][..., dry] = torn.by_gap
            row[..., at.flux_gap] += (torn.by_flux @ own[dry])[..., None]
            if torn.by_pressure is not None:
                row[..., at.pressure][..., dry] = torn.by_pressure
        row[..., at.flux_gap] *= of_sum
        row[..., at.gap] *= of_sum * own
        if p is not None:
            row[..., at.pressure] *= of_sum * own
    of_moment, x_c = -6 * scale / equations.speed, y[..., at.exit] if op.has_exit else 0.0
    published[...] = upper
    if slopes is None:
        published[..., at.pressure] += of_moment * stretch * (stretch * op.moment + x_c * op.weights)
    else:
        first = op.moment_of_gradient if d is None else d * op.moment_of_gradient
        through = of_moment * equations.speed * stretch * stretch
        through = through * (first if not op.has_exit else first + x_c * op.load_of_gradient)
        published[..., at.gap] += through * slopes.by_gap
        published[..., at.flux_gap] += (through * slopes.by_flux).sum(axis=-1, keepdims=True)
    if op.has_exit:
        fluid = equations.fluid_pressure(y)
        whole = (fluid @ op.weights)[..., None]
        published[..., at.exit] += of_moment * stretch * whole
        if d is not None:
            nodal = Nodal(op.integral, np.atleast_2d(h), np.atleast_2d(fluid), op.weights)
            values = viscous_friction(equations, np.atleast_2d(y), load, nodal).reshape(3, *y.shape[:-1], 1)
            published[..., at.dilation] = values[2] / d + of_moment * (2 * d * (fluid @ op.moment)[..., None] + x_c * whole)
            lower[..., at.dilation], upper[..., at.dilation] = values[1] / d, values[2] / d
            if p is None:
                by_fluid = stretch * (stretch * op.moment + x_c * op.weights)
                g_part = (fluid - op.cavity_pressure) / d
                published[..., at.dilation] += of_moment * (g_part * by_fluid).sum(axis=-1, keepdims=True)
    return found
