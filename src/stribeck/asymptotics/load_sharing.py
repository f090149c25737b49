r"""How asperities and fluid share the load, at any speed: which speed gives which share, explicitly, and the inverse.

Wedge and film open the gap, each at its own speed: theory.md, section 10, has them with X and G; :math:`H = G + \ln(4/\pi)`.
The limits are exact; what lies between is fitted to solved states, 21 600 over the box and 1 700 of the wedge.

Source: ours, with phi of [BP] Appendix D; theory.md, section 10.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.constants import FILM_CONSTANT
from stribeck.asymptotics.formula import Limit, Value, formula
from stribeck.asymptotics.hydrodynamic import GAP_SLOPE
from stribeck.asymptotics.perturbation import phi_of
from stribeck.contacts.groups import Groups
from stribeck.quantities.units import InputError, real_array, show

# Range of the states to which the coefficients are fitted.
FIT_RANGE = (Limit("speed", 1e-9, 1e2), Limit("load", 1e-4, 0.7), Limit("relative_roughness", 1e-4, 1e-1))

# H - G: a uniform pressure is pi/4 of the largest one of the same load in Hertz's shape.
LOG_SHAPE_RATIO = math.log(4 / math.pi)

FILM_SPEED_COEFFICIENTS = (-2.970, 2.566, 0.8164, 0.6893, -0.7373)  # Fitted coefficients of :func:`_log_film_speed`.
WEDGE_COEFFICIENTS = (4.909, 2.551, 0.7937, 0.02793)  # Fitted coefficients of :func:`_wedge`.
EDGE_COEFFICIENTS = (-6.265, 4.186, 3.065)  # Fitted coefficients of the edge, in :func:`_wedge` and the film.
# Fitted coefficients of :func:`_film`.
FILM_COEFFICIENTS = (0.5996, 0.8093, 0.3581, 0.09829, 0.1302, 0.7041, 2.677, 1.038, 3.302)
SUM_COEFFICIENTS = (2.358, -0.3874, -0.9880, 0.05973)  # Fitted coefficients of :func:`_log_speed`.

MAX_STEPS = 60  # Steps of the inversion; 6 are usual.
STEP = 1e-6  # Difference in ln X of its slopes.


@formula(
    predicts="speed_at_half_fluid",
    uses=("load", "roughness"),
    plane="mixed",
    limits=FIT_RANGE[1:],
    undefined="from load 1 on, and without roughness",
    worst=0.105,
    source="ours",
)
def speed_at_fluid_share(groups: Groups, share: float = 0.5) -> Value:
    r"""Return the speed at which the fluid carries a given part of the load.

    .. math::

        \lambda &= (\lambda_w^{-m} + \lambda_f^{-m})^{-1/m}, \quad m = s_1 + s_2 \frac{H}{1 + H} + s_3 \kappa^{s_4} \\
        \lambda_w &= \kappa^2 [X(1+X)]^{1/2} g(G) \left[\frac{\phi^{-1/2}}{g(G_0)}\right]^{(1+X)^{-w_3 - w_4 G_0}} E,
        \quad g(G) = w_1 G^{w_2}, \quad G_0 = -\tfrac12 \ln \bar F_N \\
        E &= (1 + 2 e)^{-1/2} \text{ for } e > 0, \text{ else } \exp(-e), \quad
        e = (e_1 + e_2 H) \frac{\kappa^{2/3}}{(1+X)^{e_3}} \\
        \lambda_f &= \lambda_\mathrm{film}(\kappa H) \left(1 + p_1 \kappa^{p_2} H^{p_3}\right)
        \left(1 + p_5 \kappa^{p_6} H^{p_7}\right)^{p_4/(1 + p_8 (\kappa H)^{p_9})}

    For half of the load within 10 %, in the median 0.9 %; for 5 % of it within 27 % and 0.8 %, the worst at heavy loads and
    the largest roughness. The criterion :math:`\lambda^2 \phi/\kappa^4 = 1` of [BP], where the true share is 0.13 to 0.46,
    is the first order extrapolated.

    The letters are the fitted coefficients of wedge, edge, film and sum.
    """
    F, kappa = np.asarray(groups.load), np.asarray(groups.relative_roughness)
    found = np.exp(_log_speed(odds_of(share), F, kappa))
    return np.where(np.equal(groups.roughness, 0), math.nan, found)[()]


def odds_of(share: Value) -> Array:
    """Return ln X of the part of the load on the fluid; refuse what is none."""
    wanted = real_array("share", share)
    if not ((wanted > 0) & (wanted < 1)).all():
        raise InputError(f"share = {show(share)}; a fraction of the load lies between 0 and 1, both excluded.")
    return np.asarray(np.log(wanted / (1 - wanted)))


@formula(
    plane="mixed", limits=(*FIT_RANGE, Limit("film_ratio", 0.0, 12.0)), undefined="from load 1 on", worst=0.08, source="ours"
)
def contact_load_share(groups: Groups) -> Value:
    r"""Return the part of the load on the asperities, the inverse of :func:`speed_at_fluid_share`.

    .. math:: \lambda(1 - S) = \lambda

    S is 1 at rest and 0 without roughness.  The inversion, by bracketed Newton steps in ln X, is converged to rounding.
    """
    return np.exp(-np.logaddexp(0.0, log_odds(groups)))[()]


def log_odds(groups: Groups) -> Array:
    """Return ln X, fluid over contact share: -inf at rest, inf without roughness, nan from load 1 on."""
    return odds_at(groups, _log_speed)


def odds_at(groups: Groups, log_speed: Callable[[Array, Array, Array], Array], max_roughness: float = math.inf) -> Array:
    """Return ln X at which a law of ln(speed), of ln X, F and kappa, gives the speed of the groups: by Newton in brackets."""
    lambda_, F, kappa = np.broadcast_arrays(groups.speed, groups.load, groups.relative_roughness)
    has_value = (F < 1) & ((lambda_ == 0) | (kappa <= max_roughness))
    found = np.where(has_value, np.where(lambda_ > 0, math.inf, -math.inf), math.nan)
    inside = has_value & (lambda_ > 0) & (kappa > 0)
    wanted, F, kappa = np.log(lambda_[inside]), F[inside], kappa[inside]
    low, high = np.full(F.shape, -300.0), np.full(F.shape, 700.0)
    x = np.zeros(F.shape)
    for _ in range(MAX_STEPS):
        off = log_speed(x, F, kappa) - wanted
        low, high = np.where(off < 0, x, low), np.where(off < 0, high, x)
        newton = x - off * STEP / (log_speed(x + STEP, F, kappa) - wanted - off)
        moved = np.where((newton > low) & (newton < high), newton, 0.5 * (low + high))
        if np.all(np.abs(moved - x) <= 1e-12 * (1 + np.abs(x))):
            break
        x = moved
    found[inside] = x
    return found


def film_speed_ratio(groups: Groups, odds: Array) -> Array:
    """Return the speed over that at which the smooth film alone would be as thick, at most 1, for ln X = ``odds``."""
    F, kappa = np.asarray(groups.load), np.asarray(groups.relative_roughness)
    _, H = gaps(odds, F)
    return np.minimum(1.0, groups.speed * np.exp(-_film(H, kappa)))


def gaps(odds: Array, F: Array) -> tuple[Array, Array]:
    """Return the central gaps G and H, in kappa u_Hz, at which asperities carry the rest."""
    G = -0.5 * np.log(F) + np.logaddexp(0.0, odds)
    return G, G + LOG_SHAPE_RATIO


def _log_speed(odds: Array, F: Array, kappa: Array) -> Array:
    """Return the logarithm of the speed for ln X."""
    s1, s2, s3, s4 = SUM_COEFFICIENTS
    G, H = gaps(odds, F)
    m = s1 + s2 * H / (1 + H) + s3 * kappa**s4
    return np.asarray(-np.logaddexp(-m * _wedge(odds, G, H, F, kappa), -m * _film(H, kappa)) / m)


def _wedge(odds: Array, G: Array, H: Array, F: Array, kappa: Array) -> Array:
    """Return the logarithm of the speed of the wedge."""
    w1, w2, w3, w4 = WEDGE_COEFFICIENTS
    e1, e2, e3 = EDGE_COEFFICIENTS
    more = np.logaddexp(0.0, odds)  # ln(1 + X)
    G_0 = -0.5 * np.log(F)
    at_rest = -0.5 * np.log(phi_of(F, "closed")) - math.log(w1) - w2 * np.log(G_0)
    found = 2 * np.log(kappa) + 0.5 * (odds + more) + math.log(w1) + w2 * np.log(G) + at_rest * np.exp(-(w3 + w4 * G_0) * more)
    edge = (e1 + e2 * H) * np.exp(-e3 * more) * kappa ** (2 / 3)
    return np.asarray(found - np.where(edge > 0, 0.5 * np.log1p(2 * np.maximum(edge, 0.0)), edge))


def _film(H: Array, kappa: Array) -> Array:
    """Return the logarithm of the speed of the film."""
    p1, p2, p3, p4, p5, p6, p7, p8, p9 = FILM_COEFFICIENTS
    y = kappa * H
    profile = np.log1p(p1 * kappa**p2 * H**p3) + p4 * np.log1p(p5 * kappa**p6 * H**p7) / (1 + p8 * y**p9)
    return np.asarray(_log_film_speed(y) + profile)


def _log_film_speed(y: Array) -> Array:
    r"""Return the logarithm of the speed at which the smooth contact has the central gap y, within 0.2 %.

    .. math::

        \lambda_\mathrm{film} = \left(\frac yc\right)^{5/3} \left[\frac{1 + f_1 z^2 + f_2 z^3}
        {1 + (f_1 + a) z^2 + f_3 z^3 + f_4 z^4 + f_5 z^5 + K f_2 z^6}\right]^{1/6}, \quad z = y^{1/3}

    a and K follow from the laws of small and large speed.
    """
    f1, f2, f3, f4, f5 = FILM_SPEED_COEFFICIENTS
    c = FILM_CONSTANT
    a, K = 10 * GAP_SLOPE * c ** (-2 / 3), c**-10 / 24**3
    z = np.cbrt(y)
    bridge = (1 + z**2 * (f1 + f2 * z)) / (1 + z**2 * (f1 + a + z * (f3 + z * (f4 + z * (f5 + z * K * f2)))))
    return np.asarray(5 / 3 * np.log(y / c) + np.log(bridge) / 6)
