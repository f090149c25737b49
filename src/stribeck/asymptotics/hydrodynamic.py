r"""Film and friction of the smooth contact: laws of slow and of fast speed, and those for every speed.

Slow, at large deformation, the film is thin and uniform in the Hertz contact, with inlet and outlet of width
:math:`\lambda^{2/5}`, the parameter of all corrections.  Fast, at small deformation, the cylinder is a rigid parabola on a
film much thicker than its indentation; corrections go as :math:`\lambda^{-1/3}` in the fields, where they are antisymmetric,
and as :math:`\lambda^{-2/3}` in what is read off them.  Films depend on the speed group alone, the friction also on
:math:`\beta \bar F_N^{1/2}`.

Each law of ours for every speed is the slow one times a root of a function that is 1 + s u at small and A u at large
:math:`u = \lambda^{2/5}`; the root is chosen for the ratio of the two limits to become a multiple of u.

Source: [BP] Sections "Large deformation limit", "Small deformation limit", "General model of the hydrodynamic friction";
theory.md, section 7.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.constants import FILM_CONSTANT, MINIMUM_CONSTANT, PRINTED_FILM_CONSTANT
from stribeck.asymptotics.formula import Limit, Value, formula
from stribeck.contacts.groups import Groups

# Next term of central and flux gap at small speed, relative, over lambda**(2/5); from states at speeds down to 1e-9.
GAP_SLOPE = 0.245

FRICTION_SLOPE = 4.0  # Next term of the friction at small speed, relative, over lambda**(2/5); from the same states.

# Fitted coefficients of the laws for every speed, by smallest maximum error on 241 speeds from 1e-12 to 1e8.
CENTRAL_GAP_COEFFICIENTS = (-0.841, 0.511, 0.032, 0.273)
FLUX_GAP_COEFFICIENTS = (-0.882, 0.574, 0.127, -0.442)
FRICTION_COEFFICIENTS = (3.69, 2.09, -1.10)

MAX_U = 1e50  # u up to which the laws are taken in powers of u, which overflow from 1e77 on.

_smooth = partial(formula, uses=("speed",), plane="smooth")
_slow = partial(_smooth, limits=(Limit("speed", 0.0, 1e-3),), small="speed", error_order=0.4)
_fast = partial(_smooth, limits=(Limit("speed", 1e3),), small="1/speed", error_order=2 / 3)
_any_speed = partial(_smooth, limits=())


@_slow(
    worst=0.015,
    source="[BP] Eq. (central_thickness_large), with c = 0.44583 for the printed 0.44, which is 1.3 % low",
)
def central_gap_large(groups: Groups, *, printed: bool = False) -> Value:
    r"""Return the gap at x = 0 at large deformation, speed group -> 0.

    .. math:: h(0) = c \lambda^{3/5}

    The next term, relative to it, is 0.245 lambda**(2/5).
    """
    return (PRINTED_FILM_CONSTANT if printed else FILM_CONSTANT) * groups.speed**0.6


@_slow(worst=0.015, source="[BP] below Eq. (hstar), with c = 0.44583 for the printed 0.44")
def flux_gap_large(groups: Groups) -> Value:
    r"""Return the flux gap at large deformation, speed group -> 0.

    .. math:: h^* = c \lambda^{3/5}

    As :func:`central_gap_large`; the two differ by less than 1e-3 even at the end of the range.
    """
    return FILM_CONSTANT * groups.speed**0.6


@_slow(worst=0.012, source="ours; :mod:`stribeck.asymptotics.film_layers` solves the outlet by itself")
def minimum_gap_large(groups: Groups) -> Value:
    r"""Return the minimum gap, at the outlet, at large deformation, speed group -> 0.

    .. math:: \min h = 0.33794 \lambda^{3/5} = 0.75801 \, c \lambda^{3/5}

    The next term, relative to it, is 0.191 lambda**(2/5).  Without cavitation, as the whole model.
    """
    return MINIMUM_CONSTANT * groups.speed**0.6


@_slow(
    predicts="viscous_friction",
    uses=("speed", "load"),
    limits=(Limit("speed", 0.0, 1e-4),),
    worst=0.083,
    source="[BP] Eq. (hydrofriction_large), with c = 0.44583 for the printed 0.44",
)
def friction_large(groups: Groups, beta: float = 1.0, *, printed: bool = False) -> Value:
    r"""Return the viscous friction at large deformation, speed group -> 0.

    .. math:: \mu = \frac{4}{3 \pi c} \beta \bar F_N^{1/2} \lambda^{2/5}

    The next term, relative to it, is 4.0 lambda**(2/5), so that the law is 8 % low at speed 1e-4.

    The printed scale (F_N R/E*)**(1/2) has a dimension and is no function of the groups: it is (F_N/(E* R))**(1/2) here, and
    ``printed`` changes the constant only.
    """
    c = PRINTED_FILM_CONSTANT if printed else FILM_CONSTANT
    return 4 / (3 * math.pi * c) * beta * groups.load**0.5 * groups.speed**0.4


@_fast(worst=0.021, source="[BP] Eq. (film_thickness_small_deformation)")
def central_gap_small(groups: Groups) -> Value:
    r"""Return the gap at x = 0 at small deformation, speed group -> infinity.

    .. math:: h(0) = \frac{\lambda^{2/3}}{24^{1/3}}

    The next term, relative to it, is 2.10 lambda**(-2/3).
    """
    return np.power(groups.speed, 2 / 3) / 24 ** (1 / 3)


@_fast(worst=0.002, source="[BP] Eq. (fields_small_deformation)")
def flux_gap_small(groups: Groups) -> Value:
    r"""Return the flux gap at small deformation, speed group -> infinity.

    .. math:: h^* = \frac43 \frac{\lambda^{2/3}}{24^{1/3}}

    The next term, relative to it, is 0.201 lambda**(-2/3).
    """
    return 4 / 3 * central_gap_small.function(groups)


@_fast(
    worst=0.017,
    error_order=1 / 3,
    source="[BP] Eq. (fields_small_deformation)",
)
def gap_small(groups: Groups, x: float | Array) -> Value:
    r"""Return the gap at small deformation, speed group -> infinity.

    .. math:: h(x) = h_0 + \frac{x^2}{2}, \quad h_0 = \frac{\lambda^{2/3}}{24^{1/3}}

    The next term is the deflection under the pressure of :func:`pressure_small`, of order lambda**(1/3); it is
    antisymmetric and so vanishes at x = 0.
    """
    return central_gap_small.function(groups) + np.square(x) / 2


@_fast(
    predicts="fluid_pressure",
    limits=(Limit("speed", 1e5),),
    worst=0.092,
    error_order=1 / 3,
    source="[BP] Eq. (fields_small_deformation); 6 eta U a/(p_Hz u_Hz**2) is lambda",
)
def pressure_small(groups: Groups, x: float | Array) -> Value:
    r"""Return the fluid pressure at small deformation, speed group -> infinity.

    .. math:: p(x) = -\frac{\lambda}{3} \frac{x}{(h_0 + x^2/2)^2}, \quad h_0 = \frac{\lambda^{2/3}}{24^{1/3}}

    It is antisymmetric and carries no load; what carries it, of the order lambda**(-1/3), is the next term.
    """
    gap = gap_small.function(groups, x)
    return -groups.speed / 3 / gap * (x / gap)


@_fast(
    predicts="viscous_friction",
    uses=("speed", "load"),
    limits=(Limit("speed", 1e2),),
    worst=0.00095,
    source="[BP] Eqs. (hydrofriction_small), (film_thickness_small_deformation); scale as in :func:`friction_large`",
)
def friction_small(groups: Groups, beta: float = 1.0) -> Value:
    r"""Return the viscous friction at small deformation, speed group -> infinity.

    .. math:: \mu = \frac{4 \sqrt2}{3} \, 24^{1/6} \, \beta \bar F_N^{1/2} \lambda^{2/3}

    The next term, relative to it, is 0.0195 lambda**(-2/3).
    """
    return 4 * math.sqrt(2) / 3 * 24 ** (1 / 6) * beta * groups.load**0.5 * np.power(groups.speed, 2 / 3)


@_any_speed(
    worst=0.0028, source="ours; [BP] Eqs. (central_thickness_large) and (film_thickness_small_deformation) are its ends"
)
def central_gap(groups: Groups) -> Value:
    r"""Return the gap at x = 0 at any speed.

    .. math::

        h(0) = c \lambda^{3/5} \left[\frac{1 + (6 s + d_1) u + b_2 u^2 + A d_2 u^3 + A d_3 u^4}
        {1 + d_1 u + d_2 u^2 + d_3 u^3}\right]^{1/6}, \quad u = \lambda^{2/5}, \quad A = \frac{1}{576 c^6}

    Exact as the speed tends to zero, with the next term :math:`1 + s \lambda^{2/5}`, s = 0.245, and as it tends to infinity,
    where it becomes :func:`central_gap_small`.  In between :math:`d_1, d_2, d_3, b_2` = -0.841, 0.511, 0.032, 0.273 are
    fitted.  Largest error 0.27 %, at speed 0.7, on 241 speeds from 1e-12 to 1e8.
    """
    return _film(groups.speed, 1 / (576 * FILM_CONSTANT**6), CENTRAL_GAP_COEFFICIENTS)


@_any_speed(worst=0.00041, source="ours; [BP] Eqs. (hstar) and (fields_small_deformation) give its ends")
def flux_gap(groups: Groups) -> Value:
    r"""Return the flux gap h* at any speed.

    .. math::

        h^* = c \lambda^{3/5} \left[\frac{1 + (6 s + d_1) u + b_2 u^2 + A d_2 u^3 + A d_3 u^4}
        {1 + d_1 u + d_2 u^2 + d_3 u^3}\right]^{1/6}, \quad u = \lambda^{2/5},
        \quad A = \left(\frac43\right)^6 \frac{1}{576 c^6}

    As :func:`central_gap`, with :math:`d_1, d_2, d_3, b_2` = -0.882, 0.574, 0.127, -0.442; the limit is
    :func:`flux_gap_small`.  Largest error 0.04 %, at speed 7.3.
    """
    return _film(groups.speed, (4 / 3) ** 6 / (576 * FILM_CONSTANT**6), FLUX_GAP_COEFFICIENTS)


def _film(speed: Value, far: float, fit: tuple[float, float, float, float]) -> Value:
    """Return the slow film times the sixth root of a function that tends to 1 + 6 s u at small u and to ``far`` u at large."""
    d1, d2, d3, b2 = fit
    u = np.power(speed, 0.4)
    # Beyond, the ratio is its limit to all digits.
    u, beyond = np.minimum(u, MAX_U), np.maximum(np.divide(u, MAX_U), 1.0)
    below = 1 + u * (d1 + u * (d2 + u * d3))
    above = 1 + u * (6 * GAP_SLOPE + d1 + u * (b2 + far * u * (d2 + u * d3)))
    found: Value = FILM_CONSTANT * speed**0.6 * (above / below * beyond) ** (1 / 6)
    return found


@_any_speed(
    predicts="viscous_friction", uses=("speed", "load"), worst=0.072, source="[BP] Eq. (interpolated_hydrodynamic_friction)"
)
def friction(groups: Groups, beta: float = 1.0) -> Value:
    r"""Return the viscous friction at any speed by the interpolation of the paper.

    .. math:: \mu_{f,\mathrm{th}} = \sqrt{\mu_\mathrm{small}^2 + \mu_\mathrm{large}^2}

    Between 7.2 % below the solver (at speed 0.003) and 1.2 % above it; :func:`friction_uniform` is within 0.3 %.
    """
    return np.hypot(friction_small.function(groups, beta), friction_large.function(groups, beta))


@_any_speed(
    predicts="viscous_friction",
    uses=("speed", "load"),
    worst=0.00225,
    source="ours; [BP] Eqs. (hydrofriction_large) and (hydrofriction_small) are its ends",
)
def friction_uniform(groups: Groups, beta: float = 1.0) -> Value:
    r"""Return the viscous friction at any speed.

    .. math::

        \mu = \mu_\mathrm{large} \left[1 + A u - \frac{(A - \frac32 s) u + b u^{3/2}}{1 + e_1 u^{1/2} + e_2 u + b u^{3/2}}
        \right]^{2/3}, \quad u = \lambda^{2/5}, \quad A u = \left(\frac{\mu_\mathrm{small}}{\mu_\mathrm{large}}\right)^{3/2}

    Exact as the speed tends to zero, with the next term :math:`1 + s \lambda^{2/5}`, s = 4.0, and as it tends to
    infinity.  In between :math:`b, e_1, e_2` = 3.69, 2.09, -1.10 are fitted.  Largest error 0.23 %, on 241 speeds from 1e-12
    to 1e8.
    """
    far = (math.sqrt(2) * math.pi * 24 ** (1 / 6) * FILM_CONSTANT) ** 1.5
    b, e1, e2 = FRICTION_COEFFICIENTS
    u = np.power(groups.speed, 0.4)
    below = (far - 1.5 * FRICTION_SLOPE) * u + b * u**1.5
    ratio: Value = (1 + far * u - below / (1 + e1 * u**0.5 + e2 * u + b * u**1.5)) ** (2 / 3)
    return friction_large.function(groups, beta) * ratio
