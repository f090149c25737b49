r"""The observables of a state: load shares, films, friction, and their derivatives with respect to the unknowns.

Friction is kept for beta = 1 and in the two definitions of :data:`DEFINITIONS`; it is proportional to beta.  With
:math:`C = 2 \bar F_N^{1/2} \lambda / (3\pi)`, lengths in Hertz units,

.. math::

    \mu_f^\mathrm{published} &= C \int \frac1h \left[1 - 3\frac{h-h^*}{h} + 6\frac{h-h^*}{h^2}\frac{x^2}{2}\right] dx \\
    \mu_f^\mathrm{balanced} &= C \int \frac1h \left[1 + 3\frac{h-h^*}{h}\right] dx

The first is Eq. (friction) of [BP], the force on the cylinder with the contact pressure left unprojected.  The second is the
force on the substrate, equal and opposite to the whole force on the cylinder; see theory.md, section 6.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.contacts.friction import Definition
from stribeck.equations.drag import Nodal, drag_gradients, friction_scale, viscous_friction
from stribeck.equations.film import slopes_in_film
from stribeck.equations.gap import central_gap, far_gap, gap_beside, minimum_gap
from stribeck.equations.line import LOAD, Equations
from stribeck.fluids import newtonian as reynolds
from stribeck.fluids.fluid import Slopes
from stribeck.numerics.panels import Mesh, reference
from stribeck.quantities.outputs import ALL_NAMES, NAMES

__all__ = ["ROW", "Observables", "friction_integrals", "friction_scale", "gradients", "observables"]

ROW = {name: row for row, name in enumerate(ALL_NAMES)}  # Index of each in such an array

VISCOUS = ("viscous_published", "viscous_balanced", "viscous_upper")
DRAG_ROWS = [ROW[name] for name in VISCOUS]


@dataclass(frozen=True)
class Observables:
    """The observables of one state; gaps in u_Hz, friction for beta = 1."""

    contact_load_share: float
    fluid_load_share: float
    central_gap: float
    minimum_gap: float
    minimum_position: float
    flux_gap: float
    offset: float
    viscous_published: float
    viscous_balanced: float
    viscous_upper: float = math.nan
    exit_position: float = math.nan
    reformation_position: float = math.nan

    def viscous_friction(self, beta: float, definition: Definition = "balanced") -> float:
        """Return the viscous friction coefficient of a definition [-], which is proportional to beta."""
        return beta * float(getattr(self, f"viscous_{definition}"))

    def array(self, in_article: bool = True) -> Array:
        """Return the observables in the order of :data:`NAMES`, or of :data:`ALL_NAMES`."""
        return np.array([getattr(self, name) for name in (NAMES if in_article else ALL_NAMES)])


def drag_scales(values: Array) -> Array:
    """Return the scale of the tolerance of each drag, in the order of :data:`DRAG_ROWS`, of values of shape (..., rows)."""
    # Rolling friction has opposite signs on the two walls and passes through zero: both count by the larger of them.
    found = np.abs(values[..., DRAG_ROWS])
    published, balanced, upper = found[..., 0], found[..., 1], found[..., 2]
    np.fmax(balanced, upper, out=balanced)
    upper[...] = balanced
    np.fmax(published, balanced, out=published)
    return found


def drag_parts(values: Array) -> Array:
    """Return the drags over these scales, and one for all else; an error over that is relative to the observable itself."""
    parts, sizes, scales = np.ones_like(values), np.abs(values[..., DRAG_ROWS]), drag_scales(values)
    parts[..., DRAG_ROWS] = np.divide(sizes, scales, out=np.ones_like(sizes), where=sizes > 0)
    return parts


def friction_integrands(x: Array, h: Array, h_star: Numbers, slopes: Array | None = None) -> Array:
    """Return the integrands of the two definitions of friction, shape (2, ..., len(x))."""
    # ``slopes`` is the pressure gradient over lambda, (h - h*)/h**3, where it is known better than from the gap.
    u = 1 / h
    projected = 3 * x * x * (u * u * (1 - h_star * u) if slopes is None else slopes)
    return np.stack([u * (3 * h_star * u - 2) + projected, u * (4 - 3 * h_star * u)])


def observables(equations: Equations, y: Array, load: float) -> Observables:
    """Return the observables of the unknowns ``y`` of ``equations`` at the load group ``load``."""
    return observables_of_stacked(equations, y[None], load)[0]


def observables_of_stacked(equations: Equations, y: Array, load: Numbers) -> list[Observables]:
    """Return the observables of many states, the unknowns ``y`` of each in a row and their load groups in a column."""
    op, mesh, at = equations.operators, equations.operators.mesh, equations.layout
    positions, lowest = np.array([minimum_gap(mesh, row) for row in y[:, at.gap]]).T
    if not op.is_base_model:
        contact = equations.law.pressure(y[:, at.gap]) @ mesh.weights / LOAD
        numbers = (y[:, at.flux_gap.start], y[:, at.offset.start])
        return _of_any_film(equations, y, load, np.stack([contact, lowest, positions, *numbers]))
    values = smooth_observables(equations, y, load)
    values[ROW["minimum_gap"]] = lowest
    return [Observables(*row) for row in np.insert(values, ROW["minimum_gap"] + 1, positions, axis=0).T.tolist()]


def smooth_observables(equations: Equations, y: Array, load: Numbers) -> Array:
    """Return the observables by :data:`ROW` of base-model films, shape (n, rows), zero for the minimum gap."""
    op, mesh, at = equations.operators, equations.operators.mesh, equations.layout
    h, h_star = y[:, at.gap], y[:, at.flux_gap]
    contact = equations.law.pressure(h) @ mesh.weights / LOAD
    fluid, friction = np.zeros(len(y), y.dtype), np.zeros((3, len(y)), y.dtype)
    if equations.is_sliding:
        fluid = (equations.speed * reynolds.gradient(h, h_star)) @ op.load_of_gradient / LOAD
        scale, far = np.ravel(friction_scale(load, equations.speed)), op.model.solid.far_gap
        friction[:2] = scale * friction_integrals(mesh, h, h_star, far=far)
        friction[2] = scale * upper_integral(mesh, h, h_star, far)
    numbers = (y[:, at.flux_gap.start], y[:, at.offset.start])
    return np.stack([contact, fluid, central_gap(mesh, h), np.zeros(len(y), y.dtype), *numbers, *friction])


def _of_any_film(equations: Equations, y: Array, load: Numbers, known: Array) -> list[Observables]:
    """Return the observables of films other than the article's; ``known`` are those that do not depend on the film."""
    op, mesh, at = equations.operators, equations.operators.mesh, equations.layout
    contact, lowest, positions, flux, offset = known
    h, d = y[:, at.gap], equations.cavity_stretch(y)
    stretch = np.ones(len(y)) if d is None else d[:, 0]
    exit = y[:, at.exit.start] if op.has_exit else np.zeros(len(y))
    friction, fluid = np.zeros((3, len(y))), np.zeros(len(y))
    if equations.is_sliding:
        pressure = equations.fluid_pressure(y)
        fluid = stretch * (pressure @ op.weights) / LOAD
        friction = viscous_friction(equations, y, load, Nodal(op.integral, h, pressure, op.weights))
    if op.has_exit:
        central = np.array([gap_beside(mesh, row, -x / s)[0] for row, x, s in zip(h, exit, stretch, strict=True)])
    else:
        central = central_gap(mesh, h)
    ends = [exit if op.has_exit else np.full(len(y), math.nan)]
    ends.append(np.full(len(y), math.nan) if d is None else exit + stretch * mesh.reformation)
    positions = exit + stretch * positions
    values = np.stack([stretch * contact, fluid, central, lowest, positions, flux, offset, *friction, *ends])
    return [Observables(*row) for row in values.T.tolist()]


def friction_integrals(
    mesh: Mesh,
    h: Array,
    h_star: Numbers,
    slopes: Array | None = None,
    far: Callable[[Array], Array] = far_gap,
) -> Array:
    """Return the integrals of :func:`friction_integrands` over the whole line, shape (2, ...)."""
    # Beyond the panels in x the gap is ``far`` plus a smooth function of 1/x: that is interpolated, and the integrand summed
    # on panels that halve towards infinity.
    order = mesh.order
    inner_slopes = None if slopes is None else slopes[..., :-order]
    inner = friction_integrands(mesh.nodes[:-order], h[..., :-order], h_star, inner_slopes) @ mesh.weights[:-order]
    x, weights, h_tail = beyond_panels(mesh, h, far)
    tail = friction_integrands(x, h_tail, h_star) @ weights
    return np.asarray(inner + tail)


def upper_integral(mesh: Mesh, h: Array, h_star: Numbers, far: Callable[[Array], Array] = far_gap) -> Array:
    """Return the integral of the drag on the cylinder, ``(3 h*/h - 2)/h``, of each row."""
    order = mesh.order
    _, weights, h_tail = beyond_panels(mesh, h, far)
    inner, tail = 1 / h[..., :-order], 1 / h_tail
    found = (inner * (3 * h_star * inner - 2)) @ mesh.weights[:-order] + (tail * (3 * h_star * tail - 2)) @ weights
    return np.asarray(found)


def beyond_panels(mesh: Mesh, h: Array, far: Callable[[Array], Array]) -> tuple[Array, Array, Array]:
    """Return nodes beyond the panels in ``x``, the weights of integrals there, and the gap at these nodes."""
    x, weights, to_tail = mesh.beyond
    smooth = h[..., -mesh.order :] - far(mesh.nodes[-mesh.order :])
    return x, weights, smooth @ to_tail.T + far(x)


def gradients(equations: Equations, y: Array, load: Numbers, slopes: Slopes | None = None) -> Array:
    """Return the derivatives of the observables with respect to the unknowns, shape (len(ALL_NAMES), ..., y.shape[-1])."""
    # The minimum gap is taken at a fixed position, right to first order.  The projected pressure enters as its moment, 3 int
    # x**2 g dx = -6 int x A g dx without the panel through infinity: the two forms respond alike to changes of the gap, but
    # this one is insensitive to the quadrature error of g.
    op, mesh, speed, at = equations.operators, equations.operators.mesh, equations.speed, equations.layout
    of_gap, flux, offset = at.gap, at.flux_gap.start, at.offset.start
    h, h_star = y[..., of_gap], y[..., at.flux_gap]
    found = np.zeros((len(NAMES if op.is_base_model else ALL_NAMES), *y.shape))
    rows = dict(zip(ALL_NAMES, found, strict=False))
    rows["contact_load_share"][..., of_gap] = mesh.weights / LOAD * equations.law.slope(h, equations.law.pressure(h))
    if equations.is_sliding and op.is_base_model:
        u = 1 / h
        g_h, g_flux = reynolds.gap_derivative(h, h_star), reynolds.flux_derivative(h)
        of_load = speed * op.load_of_gradient / LOAD
        scale = friction_scale(load, speed)
        weights, moment = scale * mesh.weights * u * u, -6 * scale * op.moment_of_gradient
        rows["fluid_load_share"][..., of_gap] = of_load * g_h
        rows["fluid_load_share"][..., flux] = (of_load * g_flux).sum(axis=-1)
        rows["viscous_published"][..., of_gap] = weights * (2 - 6 * h_star * u) + moment * g_h
        rows["viscous_published"][..., flux] = 3 * weights.sum(axis=-1) + (moment * g_flux).sum(axis=-1)
        rows["viscous_balanced"][..., of_gap] = weights * (6 * h_star * u - 4)
        rows["viscous_balanced"][..., flux] = -3 * weights.sum(axis=-1)
    elif equations.is_sliding:
        film = equations.film
        if film.uses_pressure:
            slopes = None
        elif slopes is None:
            slopes = slopes_in_film(film, op.integral, h, None, h_star)
        for name, row in zip(VISCOUS, drag_gradients(equations, y, load, slopes), strict=True):
            rows[name][...] = row
        _of_fluid_share(equations, y, rows["fluid_load_share"], slopes)
    if op.has_exit:
        _of_frame(equations, y, rows)
    else:
        first = int(np.searchsorted(mesh.edges, 0.0)) * mesh.order
        middle = slice(first, first + mesh.order)
        rows["central_gap"][..., middle] = central_gap(mesh, h)[..., None] * reference(mesh.order).left_end / h[..., middle]
    lowest = rows["minimum_gap"].reshape(-1, at.size)
    lowest[np.arange(len(lowest)), np.ravel(np.argmin(h, axis=-1))] = 1.0
    rows["flux_gap"][..., flux] = 1.0
    rows["offset"][..., offset] = 1.0
    return found


def _of_fluid_share(equations: Equations, y: Array, row: Array, slopes: Slopes | None) -> None:
    """Write the derivatives of the load on the fluid, over the load, into ``row``; ``slopes`` as for drag."""
    op, at, d = equations.operators, equations.layout, equations.cavity_stretch(y)
    stretch = np.ones(1) if d is None else d
    if slopes is None:
        row[..., at.pressure] = stretch * op.weights / LOAD
    else:
        of_load = equations.speed * stretch * stretch * op.load_of_gradient / LOAD
        row[..., at.gap] = of_load * slopes.by_gap
        row[..., at.flux_gap] = (of_load * slopes.by_flux).sum(axis=-1, keepdims=True)
    if d is not None:
        fluid = equations.fluid_pressure(y)
        explicit = fluid if equations.film.uses_pressure else 2 * fluid - op.cavity_pressure
        row[..., at.cavity_stretch] = (explicit @ op.weights)[..., None] / LOAD


def _of_frame(equations: Equations, y: Array, rows: dict[str, Array]) -> None:
    """Write the effects of the exit and stretch of the cavity, and the derivatives of the central gap, into ``rows``."""
    mesh, at, d = equations.operators.mesh, equations.layout, equations.cavity_stretch(y)
    rows["exit_position"][..., at.exit] = 1.0
    if d is not None:
        contact = rows["contact_load_share"]
        contact *= d
        contact[..., at.cavity_stretch] = (equations.law.pressure(y[..., at.gap]) @ mesh.weights)[..., None] / LOAD
        rows["reformation_position"][..., at.exit] = 1.0
        rows["reformation_position"][..., at.cavity_stretch] = mesh.reformation
    central = rows["central_gap"].reshape(-1, at.size)
    for found, own in zip(central, y.reshape(-1, at.size), strict=True):
        stretch = 1.0 if d is None else float(own[at.cavity_stretch.start])
        place = -float(own[at.exit.start]) / stretch
        middle, slope, nodes, row = gap_beside(mesh, own[at.gap], place)
        found[nodes] = middle * row / own[nodes]
        found[at.exit] = -slope / stretch
        found[at.cavity_stretch] = -slope * place / stretch
