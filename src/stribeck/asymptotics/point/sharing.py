r"""How asperities and fluid share the load under a ball at any speed, explicitly as the speed of a share, and the inverse.

Wedge and film are those of the line (:mod:`stribeck.asymptotics.load_sharing`), with the gap at rest of the ball; but
the film is a horseshoe, :math:`h = \kappa H (1 - y^2)^q` with a fitted q, whose thin sides asperities touch first.

Source: ours; theory.md, section 11.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.documentation import described
from stribeck.asymptotics.formula import Limit, Value, formula
from stribeck.asymptotics.load_sharing import MAX_STEPS, odds_at, odds_of
from stribeck.asymptotics.point.boundary import SHARE_EDGE_COEFFICIENTS, edge_factor, gap_at_rest, phi_of
from stribeck.asymptotics.point.film import film_of
from stribeck.contacts.groups import Groups

# Range of the states to which the coefficients are fitted.
FIT_RANGE = (Limit("speed", 1e-9, 1e2), Limit("load", 1e-3, 0.7), Limit("relative_roughness", 3e-4, 1e-1))

WEDGE_COEFFICIENTS = (17.3934, 3.1231, 1.44, -0.1293, -0.0146)  # Fitted coefficients of the wedge.
SHAPE_COEFFICIENTS = (0.3229, 0.00265, -0.0572)  # Fitted coefficients of q.
FILM_COEFFICIENTS = (0.7215, -0.1963, 0.1719, 0.2288)  # Fitted coefficients of the speed of the film.
SUM_COEFFICIENTS = (1.0553, -0.4377)  # Fitted coefficients of the sum of both speeds.

GAUSS_NODES = 48  # Gauss nodes across the film.
# Ends and number of the logarithms of speeds at which the film is inverted.
LOG_SPEED_TABLE = (math.log(1e-18), math.log(1e9), 6000)

MAX_ROUGHNESS = 100.0  # Relative roughness above which the film across cannot be integrated, and there is no value.


@formula(
    plane="mixed",
    geometry="point",
    limits=(*FIT_RANGE, Limit("film_ratio", 0.0, 6.0)),
    undefined="from load 1 and above roughness 100 on",
    worst=0.1,
    source="ours",
)
def contact_load_share(groups: Groups) -> Value:
    r"""Return the part of the load on the asperities of a ball.

    .. math:: \lambda(S) = \left(\lambda_w^{-m} + \lambda_f^{-m}\right)^{-1/m}

    S is 1 at rest and 0 without roughness.  The inverse of :func:`speed_of_share`, by bracketed steps in ln X.
    """
    return np.exp(-np.logaddexp(0.0, log_odds(groups)))[()]


@described("Speed group [-]; nan from load 1 on, without roughness, and at relative roughness above 100.")
def speed_of_share(groups: Groups, share: Value = 0.5) -> Value:
    r"""Return the speed at which the fluid carries a given part of the load of a ball.

    .. math:: \lambda = \left(\lambda_w^{-m} + \lambda_f^{-m}\right)^{-1/m}
    """
    odds, F, kappa = np.broadcast_arrays(odds_of(share), groups.load, groups.relative_roughness)
    found = np.full(odds.shape, math.nan)
    inside = (F < 1) & (kappa > 0) & (kappa <= MAX_ROUGHNESS)
    found[inside] = np.exp(_log_speed(odds[inside], F[inside], kappa[inside])[0])
    return found[()]


def log_odds(groups: Groups) -> Array:
    """Return ln X, fluid over contact share: -inf at rest, inf without roughness, nan where the law has no value."""
    return odds_at(groups, lambda *state: _log_speed(*state)[0], MAX_ROUGHNESS)


def film_speed_ratio(groups: Groups, odds: Array) -> Array:
    """Return the speed over that at which the smooth film alone would leave that share to the asperities, at most 1."""
    F, kappa = np.asarray(groups.load), np.asarray(groups.relative_roughness)
    return np.asarray(np.minimum(1.0, np.exp(np.log(groups.speed) - _log_speed(odds, F, kappa)[1])))


def _log_speed(odds: Array, F: Array, kappa: Array) -> tuple[Array, Array]:
    """Return the logarithms of the speed for ln X, and of that of the film alone."""
    w1, w2, w3, w4, w5 = WEDGE_COEFFICIENTS
    q0, q1, q2 = SHAPE_COEFFICIENTS
    f0, f1, f2, f3 = FILM_COEFFICIENTS
    s1, s2 = SUM_COEFFICIENTS
    more, fluid = np.logaddexp(0.0, odds), 1 / (1 + np.exp(-odds))  # ln(1 + X), 1 - S
    A_0, A = gap_at_rest(F), gap_at_rest(F, kappa)
    G = A + more
    H = G + math.log(1.5)
    edges = edge_factor(A_0, kappa, SHARE_EDGE_COEFFICIENTS)
    at_rest = -0.5 * np.log(phi_of(A, "closed") * np.maximum(edges, 0.02)) - math.log(w1) - w2 * np.log(A)
    wedge = 2 * np.log(kappa) + 0.5 * (odds + more) + math.log(w1) + w2 * np.log(G)
    wedge = wedge + at_rest * np.exp(-(w3 + w4 * A_0 + w5 * np.sqrt(kappa)) * more)
    log_y, log_H = np.log(kappa * H), np.log(H)
    q = np.clip(q0 + q1 * log_y + q2 * log_H, 0.0, 0.3)
    film = np.interp(np.log(kappa * _horseshoe(H, q)), *_film_table())
    film = film + (f0 + f1 * log_y + f2 * log_H) * (1 - fluid**f3)
    m = s1 + s2 * H / (1 + H)
    return np.asarray(-np.logaddexp(-m * wedge, -m * film) / m), np.asarray(film)


def _horseshoe(H: Array, q: Array) -> Array:
    """Return the film in the middle of a horseshoe of power q under which asperities carry what they do under H."""
    cosine, weights = _across()
    shape = cosine ** (2 * q[..., None])
    found = H
    for _ in range(MAX_STEPS):
        # In the logarithm the sum is nearly linear in the film.
        parts = weights * np.exp(-found[..., None] * shape)
        total = parts.sum(-1)
        step = (np.log(total) + H) * total / (parts * shape).sum(-1)
        found = found + step
        if np.all(np.abs(step) < 1e-12 * (1 + np.abs(found))):
            break
    return found


@cache
def _across() -> tuple[Array, Array]:
    """Return (1 - y**2)**(1/2) across the film, and weights of (2/pi) (1 - y**2)**(1/2) dy, which add up to one."""
    x, weights = np.polynomial.legendre.leggauss(GAUSS_NODES)
    cosine = np.cos(0.5 * math.pi * x)
    return cosine, weights * cosine**2


@cache
def _film_table() -> tuple[Array, Array]:
    """Return logarithms of the gap in the middle of a smooth ball, and of its speeds."""
    speeds = np.linspace(*LOG_SPEED_TABLE)
    return np.asarray(np.log(film_of(np.exp(speeds)))), speeds
