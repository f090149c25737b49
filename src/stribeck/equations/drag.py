r"""Viscous friction of any film: the integrals of its drag on both walls.

With :math:`C = 2 \bar F_N^{1/2} \lambda / (3\pi)` and the tractions :math:`T` of the film in :math:`\eta_0 U/u_\mathrm{Hz}`,

.. math::

    \mu_f^\mathrm{balanced} = C \int T_1 \, dx, \qquad \mu_f^\mathrm{upper} = C \int T_2 \, dx, \qquad
    \mu_f^\mathrm{published} = \mu_f^\mathrm{upper} - \frac{6 C}{\lambda} \int x \, p_f \, dx

on the substrate, on the cylinder, and on the cylinder with the fluid pressure projected on its slope.  In the cavity the
liquid is sheared without a pressure gradient.

In a thin film the last moment is a small difference of large pressures.  An elastic body takes no force along x from them, so
that by the identities A and B of theory.md, section 6, and by parts

.. math:: \int x \, p_f \, dx = -\lambda \int h \, G \, dx - \int x \, p_c \, dx

The two sides err as fluid and asperities press, and count by the share of the other.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.equations.film import Nodes, at_nodes
from stribeck.equations.line import Equations, Fields
from stribeck.equations.operators import LOAD
from stribeck.fluids.fluid import Film
from stribeck.numerics.dual import value_of
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.numerics.trace import Matrix, Trace, act
from stribeck.solids.solid import lengths_of

Clip = Callable[[Array, Array], Array]  # (values here, values at the coarse nodes) -> values to take


class FilmOnMesh(NamedTuple):
    """A film on the nodes of a mesh, which may be finer than that of its equations: values of states in rows, or traces."""

    integral: RunningIntegral
    gap: Any
    pressure: Any  # Of the fluid
    contact: Any  # Pressure of the asperities
    load: Matrix  # Nodal pressures of the fluid -> load
    clip: Clip | None = None


def friction_scale(load: Any, speed: Any) -> Any:
    """Return C = 2 F**(1/2) lambda/(3 pi), the factor of all friction integrals for beta = 1."""
    return 2 * np.sqrt(load) * speed / (3 * math.pi)


def viscous_friction(equations: Equations, u: Fields, load: Numbers, on: FilmOnMesh, by: str | None = None) -> list[Any]:
    """Return the viscous friction for beta = 1: published, balanced and upper; also traced by the logarithm of a group."""
    film, integral, mesh, known = equations.film, on.integral, on.integral.mesh, u.pressure is not None
    speed, traced = equations.speed_of(by), equations.traced_speed(by)
    d = u.cavity_stretch
    stretch, x_c = (1.0 if d is None else d), (0.0 if u.exit is None else u.exit)
    x, beyond, _ = mesh.beyond
    middle = len(x) // 2
    upstream, downstream = (slice(0, middle), slice(middle, None)) if integral.one_sided else (None, None)
    *own, _ = _walls(film, _parts(integral), on.gap, on.pressure if known else None, u.flux_gap, traced)
    if on.clip is not None:
        *coarse, _ = _walls(film, _parts(equations.operators.integral), u.gap, u.pressure, u.flux_gap)
        own = [on.clip(here, held) for here, held in zip(own, coarse, strict=True)]
    # Beyond the panels in x the gap is the far gap plus a smooth function of 1/x, which is interpolated; and the moment is
    # integrated by parts, as there the gap is known better than the pressure.
    h = act(mesh.to_beyond, on.gap) + equations.far_gap_beyond(u, mesh)
    p = act(mesh.density_beyond, on.pressure) if known else None
    *far, g = _walls(film, (upstream, downstream), h, p, u.flux_gap, traced)
    lower, upper, through = (
        act(mesh.inner_weights, here) + act(Matrix(beyond[None]), there) for here, there in zip(own, far, strict=True)
    )
    leverage = Matrix((0.5 * (mesh.edges[-1] ** 2 - x**2) * beyond)[None])
    whole = act(on.load, on.pressure)
    moment = stretch * (stretch * (act(mesh.arm, on.pressure) + stretch * (speed * act(leverage, g))) + x_c * whole)
    pressed = stretch * act(mesh.arm, on.contact) + x_c * act(mesh.inner_weights, on.contact)
    profile = equations.operators.model.profile
    moment = moment + profile.moment(mesh, x_c, on.pressure)
    pressed = pressed + profile.moment(mesh, x_c, on.contact)
    balance = -(stretch * (speed * through + pressed))
    # Both sides are the same but for their errors, so that the share has no derivative.
    moment = moment + _share_balanced(equations, value_of(stretch * whole)) * (balance - moment)
    scale, of_moment = friction_scale(load, equations.speed), friction_scale(load, 6.0)
    factors = [_scale(scale, {"speed": 1.0, "load": 0.5}, by), _scale(of_moment, {"load": 0.5}, by)]
    on_cylinder = factors[0] * (stretch * upper)
    return [on_cylinder - factors[1] * moment, factors[0] * (stretch * lower), on_cylinder]


def _scale(value: Any, powers: dict[str, float], by: str | None) -> Any:
    """Return a factor that is a product of powers of groups, traced by the logarithm of one of them."""
    return value if by not in powers else Trace.number(by, np.atleast_1d(value), powers[by] * value)


def _walls(
    film: Film, parts: tuple[Nodes | None, Nodes | None], gap: Any, pressure: Any, flux_gap: Any, speed: Any = None
) -> list[Any]:
    """Return drag on substrate and cylinder, h G, and G, both zero where the film is cavitated."""
    wet, cavitated = parts

    def through(film: Film, gap: Any, pressure: Any, flux_gap: Any) -> tuple[Any, ...]:
        g = film.gradient(gap, pressure, flux_gap)
        return *film.tractions(gap, pressure, flux_gap), gap * g, g

    lower, upper, carried, g = at_nodes(film, through, wet, gap, pressure, flux_gap, speed)
    if cavitated is not None:
        (liquid,) = at_nodes(film, lambda film, *at: (film.cavity_traction(*at),), cavitated, gap, pressure, flux_gap, speed)
        lower, upper = lower + liquid, upper + liquid
    return [lower, upper, carried, g]


def _share_balanced(equations: Equations, fluid_load: Array) -> Array:
    """Return the share with which the balance of forces gives the moment of the pressure: none on bodies that remember."""
    remembers = bool(lengths_of(equations.operators.model.solid).memories)
    return np.zeros_like(fluid_load) if remembers else np.minimum(np.maximum(fluid_load / LOAD, 0.0), 1.0)


def _parts(integral: RunningIntegral) -> tuple[Nodes | None, Nodes | None]:
    """Return the nodes in the film, None for all, and those in the cavity, on the panels in x at least."""
    if integral.reformation == 0.0:
        return None, None
    if integral.one_sided:
        end = integral.middle * integral.mesh.order
        return slice(0, end), slice(end, -integral.mesh.order)
    return integral.integrated, ~integral.integrated
