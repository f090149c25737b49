r"""What a user reads off a state: load shares, films, friction, and their derivatives with respect to the unknowns.

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
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.contacts.friction import Definition
from stribeck.equations.gap import central_gap, far_gap, minimum_gap
from stribeck.equations.line import LOAD, Equations
from stribeck.fluids import newtonian as reynolds
from stribeck.numerics.panels import Mesh, reference
from stribeck.quantities.outputs import NAMES

ROW = {name: row for row, name in enumerate(NAMES)}
"""Where each is in such an array."""

TAIL_HALVINGS = 12
"""Panels on each side of infinity on which the friction integrands, which hold a logarithm there, are summed."""


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

    def viscous_friction(self, beta: float, definition: Definition = "balanced") -> float:
        """Return the viscous friction coefficient of a definition [-], which is proportional to beta."""
        return beta * float(getattr(self, f"viscous_{definition}"))

    def array(self) -> Array:
        """Return the observables in the order of :data:`NAMES`."""
        return np.array([getattr(self, name) for name in NAMES])


def friction_scale(load: Numbers, speed: Numbers) -> Array:
    """Return C = 2 F**(1/2) lambda/(3 pi), the factor of both friction integrals for beta = 1."""
    return np.asarray(2 * np.sqrt(load) * speed / (3 * math.pi))


def friction_integrands(x: Array, h: Array, h_star: Numbers, slopes: Array | None = None) -> Array:
    """Return the integrands of the two definitions of friction, shape (2, ..., len(x)).

    ``slopes`` is the pressure gradient ``(h - h*)/h**3`` over lambda where that is known better than from the gap.
    """
    u = 1 / h
    projected = 3 * x * x * (u * u * (1 - h_star * u) if slopes is None else slopes)
    return np.stack([u * (3 * h_star * u - 2) + projected, u * (4 - 3 * h_star * u)])


def observables(equations: Equations, y: Array, load: float) -> Observables:
    """Return the observables of the unknowns ``y`` of ``equations`` at the load group ``load``."""
    return observables_of_stacked(equations, y[None], load)[0]


def observables_of_stacked(equations: Equations, y: Array, load: Numbers) -> list[Observables]:
    """Return the observables of many states, the unknowns ``y`` of each in a row and their load groups in a column."""
    mesh, at = equations.operators.mesh, equations.layout
    h, h_star = y[:, at.gap], y[:, at.flux_gap]
    contact = equations.law.pressure(h) @ mesh.weights / LOAD
    positions, lowest = np.array([minimum_gap(mesh, row) for row in h]).T
    fluid, friction = np.zeros(len(y)), np.zeros((2, len(y)))
    if equations.is_sliding:
        fluid = (equations.speed * reynolds.gradient(h, h_star)) @ equations.operators.load_of_gradient / LOAD
        friction = np.ravel(friction_scale(load, equations.speed)) * friction_integrals(mesh, h, h_star)
    numbers = (y[:, at.flux_gap.start], y[:, at.offset.start])
    values = np.stack([contact, fluid, central_gap(mesh, h), lowest, positions, *numbers, *friction])
    return [Observables(*row) for row in values.T.tolist()]


def friction_integrals(mesh: Mesh, h: Array, h_star: Numbers, slopes: Array | None = None) -> Array:
    """Return the integrals of :func:`friction_integrands` over the whole line, shape (2, ...).

    Beyond the panels in ``x`` the gap is ``x**2/2 - ln|x|/2`` plus a smooth function of ``1/x``: that is interpolated, and
    the integrand summed on panels that halve towards infinity.
    """
    order = mesh.order
    inner_slopes = None if slopes is None else slopes[..., :-order]
    inner = friction_integrands(mesh.nodes[:-order], h[..., :-order], h_star, inner_slopes) @ mesh.weights[:-order]
    t, weights, to_tail = _towards_infinity(order)
    t = t * mesh.half_widths[-1]
    x_tail = mesh.nodes[-order:]
    smooth = h[..., -order:] - far_gap(x_tail)
    x = 1 / t
    h_tail = smooth @ to_tail.T + far_gap(x)
    tail = friction_integrands(x, h_tail, h_star) @ (weights * mesh.half_widths[-1] * x**2)
    return np.asarray(inner + tail)


@lru_cache(maxsize=32)
def _towards_infinity(order: int) -> tuple[Array, Array, Array]:
    """Nodes and weights on [-1, 1] on panels that halve towards zero, and the interpolation to them."""
    edges = np.append(0.0, 2.0 ** -np.arange(TAIL_HALVINGS, -1, -1.0))
    half = 0.5 * np.diff(edges)
    rule = reference(order)
    t = (0.5 * (edges[1:] + edges[:-1])[:, None] + half[:, None] * rule.nodes).ravel()
    weights = np.outer(half, rule.weights).ravel()
    t = np.concatenate([-t, t])
    return t, np.concatenate([weights, weights]), rule.interpolation(t)


def gradients(equations: Equations, y: Array, load: Numbers) -> Array:
    """Return the derivatives of the observables with respect to the unknowns, shape (len(NAMES), ..., y.shape[-1]).

    The position of the minimum gap is held, to first order without effect.  The projected pressure enters as its moment,
    ``3 int x**2 g dx = -6 int x A g dx`` without the panel through infinity: the two forms respond alike to true changes of
    the gap, but this one is insensitive to what the quadrature of g leaves.
    """
    op, mesh, speed, at = equations.operators, equations.operators.mesh, equations.speed, equations.layout
    of_gap, flux, offset = at.gap, at.flux_gap.start, at.offset.start
    h, h_star = y[..., of_gap], y[..., at.flux_gap]
    found = np.zeros((len(NAMES), *y.shape))
    rows = dict(zip(NAMES, found, strict=True))
    rows["contact_load_share"][..., of_gap] = mesh.weights / LOAD * equations.law.slope(h, equations.law.pressure(h))
    if equations.is_sliding:
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
    first = int(np.searchsorted(mesh.edges, 0.0)) * mesh.order
    middle = slice(first, first + mesh.order)
    rows["central_gap"][..., middle] = central_gap(mesh, h)[..., None] * reference(mesh.order).left_end / h[..., middle]
    np.put_along_axis(rows["minimum_gap"], np.argmin(h, axis=-1)[..., None], 1.0, axis=-1)
    rows["flux_gap"][..., flux] = 1.0
    rows["offset"][..., offset] = 1.0
    return found
