r"""Viscous friction of any film: the integrals of its drag on both walls, and their derivatives.

With :math:`C = 2 \bar F_N^{1/2} \lambda / (3\pi)` and the tractions :math:`T` of the film in :math:`\eta_0 U/u_\mathrm{Hz}`,

.. math::

    \mu_f^\mathrm{balanced} = C \int T_1 \, dx, \qquad \mu_f^\mathrm{upper} = C \int T_2 \, dx, \qquad
    \mu_f^\mathrm{published} = \mu_f^\mathrm{upper} - \frac{6 C}{\lambda} \int x \, p_f \, dx

on the substrate, on the cylinder, and on the cylinder with the fluid pressure projected on its slope.  In the cavity the
liquid is sheared without a pressure gradient.  For the film of the article the first and the last have closed forms in
:mod:`stribeck.equations.observables`.

In a thin film the last moment is a small difference of large pressures.  An elastic body takes no force along x from them, so
that by the identities A and B of theory.md, section 6, and by parts

.. math:: \int x \, p_f \, dx = -\lambda \int h \, G \, dx - \int x \, p_c \, dx

The two sides err as fluid and asperities press, and count by the share of the other.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from stribeck._types import Array, Flags, Numbers
from stribeck.equations.film import gradient_in_film, slopes_in_film
from stribeck.equations.line import LOAD, Equations
from stribeck.fluids.fluid import Film, Slopes
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.solids.solid import lengths_of

__all__ = ["drag_gradients", "friction_scale", "viscous_friction"]


class Nodal(NamedTuple):
    """A film on the nodes of a mesh, which may be finer than that of its equations: rows of states."""

    integral: RunningIntegral
    gap: Array
    pressure: Array
    weights: Array  # Integrates nodal pressures to the load
    clip: Callable[[Array, Array], Array] | None = None  # (values here, values at the coarse nodes) -> values to take


def friction_scale(load: Numbers, speed: Numbers) -> Array:
    """Return C = 2 F**(1/2) lambda/(3 pi), the factor of all friction integrals for beta = 1."""
    return np.asarray(2 * np.sqrt(load) * speed / (3 * math.pi))


def viscous_friction(equations: Equations, y: Array, load: Numbers, nodal: Nodal) -> Array:
    """Return the viscous friction for beta = 1: published, balanced and upper, shape (3, rows)."""
    op, at, film = equations.operators, equations.layout, equations.film
    mesh, d, h_star = nodal.integral.mesh, equations.cavity_stretch(y), y[..., at.flux_gap]
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
    walls = _walls(film, nodal.gap, known, h_star, _parts(nodal.integral))
    if nodal.clip is not None:
        own = y[..., at.pressure] if film.uses_pressure else None
        walls = nodal.clip(walls, _walls(film, y[..., at.gap], own, h_star, _parts(op.integral)))
    far_parts = (upstream, slice(len(xi) // 2, None)) if one_sided else (slice(None), None)
    lower, upper, wall_stress_integral = walls @ weights + _walls(film, h, p, h_star, far_parts) @ beyond
    # Beyond the panels in x, integrated by parts: there the gap is known better than the pressure.
    wet = far_parts[0]
    g = film.gradient(h[..., wet], None if p is None else p[..., wet], h_star)
    leverage = 0.5 * (mesh.edges[-1] ** 2 - xi[wet] ** 2) * beyond[wet]
    stretch, arm = (1.0 if d is None else d[..., 0]), weights * mesh.nodes
    x_c, speed = (y[..., at.exit.start] if op.has_exit else 0.0), np.squeeze(equations.speed)
    contact, whole = equations.law.pressure(nodal.gap), nodal.pressure @ nodal.weights
    moment = stretch * (stretch * (nodal.pressure @ arm + speed * stretch * (g @ leverage)) + x_c * whole)
    balance = -stretch * (speed * wall_stress_integral + stretch * (contact @ arm) + x_c * (contact @ weights))
    moment = moment + _share_balanced(equations, stretch * whole) * (balance - moment)
    found = np.empty((3, *moment.shape))
    found[1], found[2] = lower * stretch, upper * stretch
    found[0] = found[2] - 6 / speed * moment
    found *= np.squeeze(friction_scale(load, equations.speed))
    return found


def _walls(
    film: Film, gap: Array, pressure: Array | None, flux_gap: Numbers, parts: tuple[slice | Flags, slice | Flags | None]
) -> Array:
    """Return drag on substrate and cylinder and h G, zero where the film is cavitated, shape (3, ..., nodes)."""
    wet, cavitated = parts
    found = np.empty((3, *gap.shape)) if cavitated is None else np.zeros((3, *gap.shape))
    column = (gap[..., wet], None if pressure is None else pressure[..., wet], flux_gap)
    found[0][..., wet], found[1][..., wet] = film.tractions(*column)
    found[2][..., wet] = gap[..., wet] * film.gradient(*column)
    if cavitated is not None:
        liquid = film.cavity_traction(gap[..., cavitated], None if pressure is None else pressure[..., cavitated], flux_gap)
        found[:2][..., cavitated] = liquid
    return found


def _share_balanced(equations: Equations, fluid_load: Array) -> Array:
    """Return the share with which the balance of forces gives the moment of the pressure: none on bodies that remember."""
    remembers = bool(lengths_of(equations.operators.model.solid).memories)
    return np.zeros_like(fluid_load) if remembers else np.minimum(np.maximum(fluid_load / LOAD, 0.0), 1.0)


def _parts(integral: RunningIntegral) -> tuple[slice | Flags, slice | Flags | None]:
    """Return the nodes in the film and those in the cavity, on the panels in x at least."""
    if integral.reformation == 0.0:
        return slice(None), None
    if integral.one_sided:
        end = integral.middle * integral.mesh.order
        return slice(0, end), slice(end, -integral.mesh.order)
    return integral.integrated, ~integral.integrated


def drag_gradients(equations: Equations, y: Array, load: Numbers, slopes: Slopes | None) -> Array:
    """Return the derivatives of :func:`viscous_friction` with respect to the unknowns, shape (3, ..., y.shape[-1])."""
    op, at, film, d = equations.operators, equations.layout, equations.film, equations.cavity_stretch(y)
    h, h_star = y[..., at.gap], y[..., at.flux_gap]
    p = y[..., at.pressure] if film.uses_pressure else None
    scale = friction_scale(load, equations.speed)
    stretch = np.ones(1) if d is None else d
    found = np.zeros((3, *y.shape))
    published, lower, upper = found
    wet, dry = op.parts if op.has_exit else (slice(None), slice(0, 0))
    cavitated = None
    if op.has_exit:
        cavitated = film.cavity_traction_slopes(h[..., dry], None if p is None else p[..., dry], h_star)
    of_walls = film.traction_slopes(h[..., wet], None if p is None else p[..., wet], h_star)
    of_sum, own = scale * stretch, op.mesh.weights
    for row, (by_gap, by_pressure, by_flux, _) in zip((lower, upper), of_walls, strict=True):
        row[..., at.gap][..., wet] = by_gap
        row[..., at.flux_gap] = (by_flux @ own[wet])[..., None]
        if by_pressure is not None:
            row[..., at.pressure][..., wet] = by_pressure
        if cavitated is not None:
            row[..., at.gap][..., dry] = cavitated.by_gap
            row[..., at.flux_gap] += (cavitated.by_flux @ own[dry])[..., None]
            if cavitated.by_pressure is not None:
                row[..., at.pressure][..., dry] = cavitated.by_pressure
        row[..., at.flux_gap] *= of_sum
        row[..., at.gap] *= of_sum * own
        if p is not None:
            row[..., at.pressure] *= of_sum * own
    of_moment, x_c = -6 * scale / equations.speed, y[..., at.exit] if op.has_exit else 0.0
    published[...] = upper
    fluid = equations.fluid_pressure(y)
    whole = (fluid @ op.weights)[..., None]
    share = _share_balanced(equations, stretch * whole)
    if slopes is None:
        slopes = slopes_in_film(film, op.integral, h, p, h_star)
    g = gradient_in_film(film, op.integral, h, p, h_star)
    _of_balance(equations, y, g, slopes, share * of_moment, published)
    of_moment = (1 - share) * of_moment
    of_pressure = of_moment * stretch * (stretch * op.moment + x_c * op.weights)
    beyond = of_moment * equations.speed * stretch**3 * op.moment_beyond
    by_gradient = beyond
    if p is None:
        first = stretch * op.moment_of_gradient + x_c * op.load_of_gradient if op.has_exit else op.moment_of_gradient
        by_gradient = beyond + of_moment * equations.speed * stretch**2 * first
    published[..., at.gap] += by_gradient * slopes.by_gap
    published[..., at.flux_gap] += (by_gradient * slopes.by_flux).sum(axis=-1, keepdims=True)
    if slopes.by_pressure is not None:
        published[..., at.pressure] += of_pressure + beyond * slopes.by_pressure
    if op.has_exit:
        published[..., at.exit] += of_moment * stretch * whole
    if d is not None:
        values = viscous_friction(equations, y, load, Nodal(op.integral, h, fluid, op.weights))[..., None]
        lower[..., at.cavity_stretch], upper[..., at.cavity_stretch] = values[1] / d, values[2] / d
        moments = of_moment * (2 * d * (fluid @ op.moment)[..., None] + x_c * whole)
        moments += (3 * beyond * g).sum(axis=-1, keepdims=True) / d
        if p is None:
            moments += (of_pressure * (fluid - op.cavity_pressure)).sum(axis=-1, keepdims=True) / d
        published[..., at.cavity_stretch] += upper[..., at.cavity_stretch] + moments
    return found


def _of_balance(equations: Equations, y: Array, g: Array, slopes: Slopes, factor: Array, row: Array) -> None:
    """Add to ``row`` the derivatives of the moment of the fluid pressure by the balance of forces, times ``factor``."""
    op, at, law, d = equations.operators, equations.layout, equations.law, equations.cavity_stretch(y)
    h = y[..., at.gap]
    contact = law.pressure(h)
    stretch = np.ones(1) if d is None else d
    wet = op.integral.weights + op.integral.weights_beyond if op.has_reformation else op.integral.weights
    through = -factor * stretch * equations.speed * wet
    pressed = -factor * stretch * equations.positions(y) * op.mesh.weights
    row[..., at.gap] += through * (g + h * slopes.by_gap) + pressed * law.slope(h, contact)
    row[..., at.flux_gap] += (through * h * slopes.by_flux).sum(axis=-1, keepdims=True)
    if slopes.by_pressure is not None:
        row[..., at.pressure] += through * h * slopes.by_pressure
    if op.has_exit:
        row[..., at.exit] -= factor * stretch * (contact @ op.mesh.weights)[..., None]
    if d is not None:
        arm = op.mesh.weights * op.mesh.nodes
        balance = ((through * h * g + pressed * contact) / d).sum(axis=-1, keepdims=True)
        row[..., at.cavity_stretch] += balance - factor * d * (contact @ arm)[..., None]
