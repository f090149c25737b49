"""Friction of a ball at any speed, load and roughness in closed form, with the logarithm of theory.md Eq. (21).

Slow, the horseshoe of the smooth film is sheared, fast the rigid ball; where asperities keep the gap open, at speeds below
that of a film of this thickness, the shear is smaller.  The published definition also has the moment of the contact pressure.

Source: ours; theory.md, section 11.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.constants import BALL_FILM_CONSTANT
from stribeck.asymptotics.documentation import described
from stribeck.asymptotics.formula import Limit, Value, formula
from stribeck.asymptotics.point.boundary import LOGARITHM_COEFFICIENT, edge_factor, friction_of, gap_at_rest
from stribeck.asymptotics.point.film import film_of
from stribeck.asymptotics.point.rigid import GAP_COEFFICIENT
from stribeck.asymptotics.point.sharing import FIT_RANGE, film_speed_ratio, log_odds, speed_of_share
from stribeck.asymptotics.uniform import first_moment
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Groups

# Friction integral over lambda**(2/5) of the slow horseshoe, 1.4054.
SLOW_INTEGRAL = math.sqrt(math.pi) * math.gamma(1.2) / math.gamma(1.7) / (3 * BALL_FILM_CONSTANT)

# Fitted coefficients of :func:`smooth_integral` and :func:`viscous_friction`; the moment of first order in the speed is within
# 0.3 % of its quadrature (:mod:`stribeck.asymptotics.point.boundary`) for A from 0.08 to 20.
SMOOTH_COEFFICIENTS = (1.14012, 4.59157, 1.21222, -0.65781, 0.84862, 1.04412, -0.027006)
ROUGH_COEFFICIENTS = (0.55662, 0.017976, 0.30227, 0.013413, 0.0021505)
FIRST_MOMENT_COEFFICIENTS = (0.158797, 0.621804, 3.214195, 1.305809, 0.380217)
MOMENT_COEFFICIENTS = (2.0682, 1.3137, 37.592, 0.73164, 0.2153, 1.2369, 0.43489)
MOMENT_EDGE_COEFFICIENTS = (-0.56624, 7.1791, 0.68051)


LINEAR_SHARE_BELOW = 1e-4  # Load share of the fluid below which the friction integral is proportional to the speed.


@described("J_fp [-]; within 7e-4 of J with the liquid up to 15 radii, at 49 speeds from 1e-6 to 1e4.")
def smooth_integral(speed: Value) -> Value:
    r"""Return the finite part of the balanced friction integral of a smooth ball at any speed.

    .. math::

        J_\mathrm{fp} = 1.4054 \, \lambda^{2/5} \, \frac{1 + b_1 u + b_2 u^2}{1 + a_1 u + a_2 u^2 + a_3 u^3 + a_4 u^4}
        - \frac{8\pi}{15} \lambda \ln\left(1 + q \lambda^{2/5} + 2 e^{3/4} \, 0.18162 \, \lambda^{4/5}\right), \quad u =
        \lambda^{1/5}
    """
    b1, b2, a1, a2, a3, a4, q = SMOOTH_COEFFICIENTS
    lambda_ = np.asarray(speed)
    u = lambda_**0.2
    film = SLOW_INTEGRAL * u**2 * (1 + u * (b1 + u * b2)) / (1 + u * (a1 + u * (a2 + u * (a3 + u * a4))))
    found: Value = film - LOGARITHM_COEFFICIENT / 2 * lambda_ * np.log1p(
        q * u**2 + 2 * math.exp(0.75) * GAP_COEFFICIENT * u**4
    )
    return found


@formula(
    uses=("speed", "load"),
    plane="smooth",
    geometry="point",
    limits=(Limit("speed", 0.0, 1e3), Limit("load", 0.0, 0.1)),
    worst=0.025,
    source="ours",
)
def viscous_friction_smooth(
    groups: Groups, beta: float = 1.0, definition: Definition = "balanced", wetted_radius: float | None = None
) -> Value:
    r"""Return the friction of a smooth ball at any speed.

    .. math:: \mu_f = \tfrac34 \beta \bar F_N^{1/3} \left[J_\mathrm{fp}(\lambda) + \tfrac{16}{15} \pi \lambda \ln X_c
        + \tfrac{8}{15} \pi \lambda \ln(1 + y) + \tfrac25 \pi \lambda \frac{y}{1 + y}\right], \quad y = 2 h(0)/X_c^2

    definition :
        The same for a whole ball; a disc of liquid ends with a pressure at its rim, which adds
        :math:`\tfrac25 \pi \lambda/(1 + y)` to the published one.

    :func:`smooth_integral` has both limits and seven fitted coefficients.  The error is below 0.15 % at any speed
    while the contact is narrow, :math:`a < R/5`; the stated one is that of load 0.1 at :math:`\beta = 1`.
    """
    J = smooth_integral(groups.speed)
    return friction_of(groups, J, beta, definition, wetted_radius, film_of(groups.speed))[()]


_rough = partial(formula, plane="mixed", geometry="point", undefined="from load 1 on")


@_rough(limits=(*FIT_RANGE, Limit("film_ratio", 0.0, 12.0)), worst=0.22, source="ours")
def viscous_friction(
    groups: Groups, beta: float = 1.0, definition: Definition = "balanced", wetted_radius: float | None = None
) -> Value:
    r"""Return the viscous friction of a ball.

    .. math::

        J_\mathrm{fp} &= J_\mathrm{smooth} \, r^{0.55662 + 0.017976 \sqrt\kappa \ln(1/r)}
        \left[1 + (0.30227 + 0.013413 \ln \kappa + 0.0021505 \ln \bar F_N) \ln\frac1r\right], \quad
        r = \min\left(1, \lambda/\lambda_f\right) \\
        J_m &= \frac{\lambda}{\kappa^2} \, M(G_X) \, S^q \left[1 + (m_0 + m_1 A_0 + m_2 A_0^2) \, \kappa^{2/3}\right], \quad
        q = b_7 + \frac{b_1 + b_2/G_X}{(1 + b_3 \kappa^{b_4} G_X^{b_6}) \, (1 + b_5 \ln(1 + X))} \\
        M(G) &= c_1 G^{-c_2} (1 + c_3 G)^{-c_4} (1 + c_5 G)^{c_2 + c_4 - 3}, \quad A_0 = -\tfrac13 \ln \bar F_N

    The speed of the film is that of :mod:`stribeck.asymptotics.point.sharing`.  Relative to itself, the error up to beta 1 is
    largest where the viscous part is a small part of all friction; in the median it is 3 %. By the published definition, which
    the moment dominates there, it is 7.5 % at worst and 1.5 % in the median.
    """
    return _viscous(groups, log_odds(groups), beta, definition, wetted_radius)[()]


@_rough(
    limits=(*FIT_RANGE, Limit("beta/mu0", 0.1, 1.0)),
    worst=0.15,
    source="ours, with :mod:`stribeck.asymptotics.point.sharing`",
)
def friction(
    groups: Groups,
    boundary_friction: float = 1.0,
    beta: float = 1.0,
    definition: Definition = "balanced",
    wetted_radius: float | None = None,
) -> Value:
    r"""Return the friction coefficient of a ball.

    .. math:: \mu = \mu_0 S + \mu_f

    Against 1086 solved states over the whole box the error is below 0.03 % in the median, 5.5 % on 99 of 100 and 13.4 % at
    worst for beta/mu0 = 0.1 to 1, by both definitions; the worst lies in the corner of the box, at load 1e-3, kappa 3e-4 and
    speed 3e-4, where the few asperities under the sides of thick films count. At beta/mu0 = 0.01 it is 17 %. All this is
    for beta up to 1: at 2.5 and load 0.7 the contact is wider than the ball, and this is up to seven times the friction.
    """
    odds = log_odds(groups)
    share = np.exp(-np.logaddexp(0.0, odds))
    return (boundary_friction * share + _viscous(groups, odds, beta, definition, wetted_radius))[()]


def _viscous(groups: Groups, odds: Array, beta: float, definition: Definition, wetted_radius: float | None) -> Array:
    power, bend, one, by_roughness, by_load = ROUGH_COEFFICIENTS
    lambda_, F, kappa = np.broadcast_arrays(groups.speed, groups.load, groups.relative_roughness)
    J = np.array(np.broadcast_to(smooth_integral(lambda_), odds.shape))
    J[np.isnan(odds)] = np.nan
    rough = np.isfinite(odds)
    lambda_, F, kappa, odds = lambda_[rough], F[rough], kappa[rough], odds[rough]
    # In boundary lubrication the integral is proportional to the speed.
    slowest = np.log(LINEAR_SHARE_BELOW / (1 - LINEAR_SHARE_BELOW))
    low = Groups(1.0, F, kappa * F ** (2 / 3), geometry="point")
    speed = np.where(odds < slowest, speed_of_share(low, LINEAR_SHARE_BELOW), lambda_)
    states = Groups(speed, F, kappa * F ** (2 / 3), geometry="point")
    y = -np.log(film_speed_ratio(states, np.maximum(odds, slowest)))
    factor = 1 + (one + by_roughness * np.log(kappa) + by_load * np.log(F)) * y
    J[rough] = smooth_integral(speed) * np.exp(-y * (power + bend * np.sqrt(kappa) * y)) * factor * lambda_ / speed
    if definition == "published":
        J[rough] += lambda_ / kappa**2 * _moment(F, kappa, odds)
    return friction_of(groups, J, beta, definition, wetted_radius, film_of(groups.speed))


def _moment(F: Array, kappa: Array, odds: Array) -> Array:
    """Return the moment of the contact pressure over lambda/kappa**2."""
    b1, b2, b3, b4, b5, b6, b7 = MOMENT_COEFFICIENTS
    more = np.logaddexp(0.0, odds)
    G = gap_at_rest(F, kappa) + more
    q = b7 + (b1 + b2 / G) / ((1 + b3 * kappa**b4 * G**b6) * (1 + b5 * more))
    edges = edge_factor(gap_at_rest(F), kappa, MOMENT_EDGE_COEFFICIENTS)
    return np.asarray(first_moment(G, FIRST_MOMENT_COEFFICIENTS) * np.exp(-more * q) * edges)
