r"""What a user reads off a state: load shares, films, friction, and their derivatives with respect to the unknowns.

Friction is kept for beta = 1 and in the two definitions of :data:`DEFINITIONS`; it is proportional to beta.  With
:math:`C = 2 \bar F_N^{1/2} \lambda / (3\pi)`, lengths in Hertz units,

.. math::

    \mu_f^\mathrm{paper} &= C \int \frac1h \left[1 - 3\frac{h-h^*}{h} + 6\frac{h-h^*}{h^2}\frac{x^2}{2}\right] dx \\
    \mu_f^\mathrm{balanced} &= C \int \frac1h \left[1 + 3\frac{h-h^*}{h}\right] dx

The first is Eq. (friction) of [BP], the force on the cylinder with the contact pressure left unprojected.  The second is the
force on the substrate, equal and opposite to the whole force on the cylinder; see theory.md, section 6.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre

from stribeck._types import Array, Numbers
from stribeck.equations.line import LOAD, Equations
from stribeck.fluids import newtonian as reynolds
from stribeck.numerics.panels import Mesh, reference

NAMES = (
    "contact_load_share",
    "fluid_load_share",
    "central_gap",
    "minimum_gap",
    "flux_gap",
    "offset",
    "viscous_paper",
    "viscous_balanced",
)
"""The observables, in the order of every array of them here."""

ROW = {name: row for row, name in enumerate(NAMES)}
"""Where each is in such an array."""

NEWTON_STEPS = 3
LARGEST_STEP = 0.2
"""Of the search for the least gap, the step in half-widths of a panel."""

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
    viscous_paper: float
    viscous_balanced: float

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
    return observables_of_rows(equations, y[None], load)[0]


def observables_of_rows(equations: Equations, y: Array, load: Numbers) -> list[Observables]:
    """Return the observables of many states, the unknowns ``y`` of each in a row and their load groups in a column."""
    mesh, at = equations.operators.mesh, equations.layout
    h, h_star = y[:, at["gap"]], y[:, at["flux_gap"]]
    contact = equations.law.pressure(h) @ mesh.weights / LOAD
    positions, least = np.array([least_gap(mesh, row) for row in h]).T
    fluid, friction = np.zeros(len(y)), np.zeros((2, len(y)))
    if equations.is_sliding:
        fluid = (equations.speed * reynolds.gradient(h, h_star)) @ equations.operators.load_of_gradient / LOAD
        friction = np.ravel(friction_scale(load, equations.speed)) * friction_integrals(mesh, h, h_star)
    numbers = (y[:, at.index("flux_gap")], y[:, at.index("offset")])
    values = np.stack([contact, fluid, central_gap(mesh, h), least, positions, *numbers, *friction])
    return [Observables(*row) for row in values.T.tolist()]


def gap_at(mesh: Mesh, h: Array, x: Array) -> Array:
    """Return the gap at ``x`` from the panels' polynomials.

    Those are of the logarithm of the gap over its growth, or of the gap over its growth where it touches zero; on the panel
    through infinity they are of what the gap has beyond ``x**2/2 - ln|x|/2``.
    """
    far = mesh.scale**2 + x * x
    if h.min() > 0:
        gap = np.exp(mesh.interpolate(np.log(h / mesh.far), x)) * far
    else:
        gap = mesh.interpolate(h / mesh.far, x) * far
    beyond = np.abs(x) > mesh.edges[-1]
    if beyond.any():
        x, tail = x[beyond], mesh.nodes[-mesh.order :]
        rule = reference(mesh.order)
        remainder = rule.interpolation(1 / (x * mesh.half_widths[-1])) @ (h[-mesh.order :] - far_gap(tail))
        gap[beyond] = far_gap(x) + remainder
    return np.asarray(gap)


def far_gap(x: Array) -> Array:
    """Return ``x**2/2 - ln|x|/2``, the gap far away but for a smooth function of ``1/x``."""
    return 0.5 * x**2 - 0.5 * np.log(np.abs(x))


def central_gap(mesh: Mesh, h: Array) -> Array:
    """Return the gap at zero, where the panel right of it begins; that of every row of ``h``."""
    first = int(np.searchsorted(mesh.edges, 0.0)) * mesh.order
    nodes = slice(first, first + mesh.order)
    return np.asarray(np.exp(np.log(h[..., nodes] / mesh.far[nodes]) @ reference(mesh.order).left_end) * mesh.scale**2)


def least_gap(mesh: Mesh, h: Array) -> tuple[float, float]:
    """Return position and value of the least gap, that of the panels' polynomials around the least node."""
    order = mesh.order
    panel, node = divmod(int(np.argmin(h)), order)
    panels = {panel, panel - (node == 0), panel + (node == order - 1)}
    found = [_least_on_panel(mesh, h, k) for k in panels if 0 <= k < mesh.panels - 1]
    return min(found, key=lambda pair: pair[1]) if found else (float(mesh.nodes[np.argmin(h)]), float(h.min()))


def _least_on_panel(mesh: Mesh, h: Array, panel: int) -> tuple[float, float]:
    """Return position and value of the least gap on a panel, by Newton's iteration from its least node."""
    nodes = slice(panel * mesh.order, (panel + 1) * mesh.order)
    rule, c, d = reference(mesh.order), float(mesh.centres[panel]), float(mesh.half_widths[panel])
    node = int(np.argmin(h[nodes]))
    polynomial = (_taylor(mesh.order)[node] @ np.log(h[nodes] / mesh.far[nodes])).tolist()[::-1]
    start = s = float(rule.nodes[node])
    for _ in range(NEWTON_STEPS):
        _, slope, curvature = _jet(polynomial, s - start)
        x = c + d * s
        far = mesh.scale**2 + x * x
        slope += 2 * d * x / far
        curvature += 2 * d * d * (mesh.scale**2 - x * x) / far**2
        step = -slope / max(curvature, abs(slope) / LARGEST_STEP, 1e-300)
        s = min(1.0, max(-1.0, s + step))
    x = c + d * s
    return x, math.exp(_jet(polynomial, s - start)[0]) * (mesh.scale**2 + x * x)


@lru_cache(maxsize=32)
def _taylor(order: int) -> Array:
    """Matrices, one a node, from nodal values to the Taylor coefficients of their polynomial about that node."""
    rule = reference(order)
    coefficients, factor = rule.to_legendre, 1.0
    found = np.empty((order, order, order))
    for n in range(order):
        found[:, n] = legendre.legvander(rule.nodes, order - 1) @ coefficients / factor
        coefficients, factor = rule.derivative @ coefficients, factor * (n + 1)
    return found


def _jet(polynomial: list[float], t: float) -> tuple[float, float, float]:
    """Return a polynomial, its highest coefficient first, and its first two derivatives at ``t``."""
    value = slope = half_curvature = 0.0
    for coefficient in polynomial:
        half_curvature = half_curvature * t + slope
        slope = slope * t + value
        value = value * t + coefficient
    return value, slope, 2 * half_curvature


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

    The position of the least gap is held, to first order without effect.  The projected pressure enters as its moment,
    ``3 int x**2 g dx = -6 int x A g dx`` without the panel through infinity: the two forms respond alike to true changes of
    the gap, but this one is insensitive to what the quadrature of g leaves.
    """
    op, mesh, speed, at = equations.operators, equations.operators.mesh, equations.speed, equations.layout
    of_gap, flux, offset = at["gap"], at.index("flux_gap"), at.index("offset")
    h, h_star = y[..., of_gap], y[..., at["flux_gap"]]
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
        rows["viscous_paper"][..., of_gap] = weights * (2 - 6 * h_star * u) + moment * g_h
        rows["viscous_paper"][..., flux] = 3 * weights.sum(axis=-1) + (moment * g_flux).sum(axis=-1)
        rows["viscous_balanced"][..., of_gap] = weights * (6 * h_star * u - 4)
        rows["viscous_balanced"][..., flux] = -3 * weights.sum(axis=-1)
    first = int(np.searchsorted(mesh.edges, 0.0)) * mesh.order
    middle = slice(first, first + mesh.order)
    rows["central_gap"][..., middle] = central_gap(mesh, h)[..., None] * reference(mesh.order).left_end / h[..., middle]
    np.put_along_axis(rows["minimum_gap"], np.argmin(h, axis=-1)[..., None], 1.0, axis=-1)
    rows["flux_gap"][..., flux] = 1.0
    rows["offset"][..., offset] = 1.0
    return found
