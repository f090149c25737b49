"""Friction at any speed, load and roughness in closed form, from the law of load sharing and the smooth film.

The viscous part is the shear of the smooth film, reduced where roughness keeps the gap open at a lower speed, and the moment
of the contact pressure that the paper's definition of the friction contains.

Source: ours; theory.md, sections 6 and 10.
"""

from __future__ import annotations

from functools import partial
from typing import Literal

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics import hydrodynamic
from stribeck.asymptotics.formula import Limit, Value, formula
from stribeck.asymptotics.load_sharing import FIT_RANGE, film_speed_ratio, gaps, log_odds
from stribeck.contacts.groups import Groups

Definition = Literal["published", "balanced"]

SHEAR_COEFFICIENTS = (0.6179, 8.341, 0.3064, 0.05872)  # Fitted coefficients of the shear in :func:`viscous_friction`.
# Fitted coefficients of the moment of first order in the speed, within 1 % of (4/pi) :func:`perturbation.pressure_moment` for
# G from 0.02 to 60.
FIRST_MOMENT_COEFFICIENTS = (0.3524, 0.7752, 0.4341, 1.0889, 4.999)
MOMENT_COEFFICIENTS = (0.9251, 3.692, 11.52, 0.4319, 7.886, 0.7303, 1.237)  # Fitted coefficients of the moment at any speed.

_uniform = partial(formula, plane="mixed", undefined="from load 1 on")


@_uniform(
    limits=(*FIT_RANGE, Limit("film_ratio", 0.0, 12.0)),
    worst=0.75,
    source="ours, with S, G and the film's speed of :mod:`load_sharing`",
)
def viscous_friction(groups: Groups, beta: float = 1.0, definition: Definition = "published") -> Value:
    r"""Return the part of the friction from the fluid.

    .. math::

        \mu_f &= \mu_\mathrm{smooth} \, r^{a_1} \left[1 + a_2 \kappa^{a_3} (1 - r^{a_4})\right] + \mu_m \\
        r &= \min\left(1, \lambda/\lambda_f\right) \\
        \mu_m &= \beta \bar F_N^{1/2} \frac{\lambda}{\kappa^2} \, M(G) \, S^q \left[1 + b_5 \kappa^{b_6} G_0^{b_7}\right] \\
        q &= \frac{b_1 + b_2/G}{1 + b_3 \kappa^{b_4}}, \quad G_0 = -\tfrac12 \ln \bar F_N \\
        M(G) &= m_1 G^{-m_2} (1 + m_3 G)^{-m_4} (1 + m_5 G)^{m_2 + m_4 - 3}

    Where asperities carry nothing it is :func:`hydrodynamic.friction_uniform`. The stated error is relative to itself, largest
    where it is a small part of all friction; in the median 3 %.
    """
    return _viscous(groups, log_odds(groups), beta, definition)[()]


@_uniform(
    limits=(*FIT_RANGE, Limit("beta/mu0", 1e-3, 1.0)),
    worst=0.075,
    source="ours: :func:`viscous_friction` and :func:`load_sharing.contact_load_share`",
)
def friction(groups: Groups, boundary_friction: float = 1.0, beta: float = 1.0, definition: Definition = "published") -> Value:
    r"""Return the friction coefficient.

    .. math:: \mu = \mu_0 S + \mu_f

    The error is 0.1 % in the median over the box, 0.5 % over those states where both parts of the friction count, and at worst
    7.2 % for beta/mu0 from 1e-3 to 1.  Below, the share of asperities counts where little of it is left, and the worst
    error is 11 % at 1e-4; above, the viscous part counts in the boundary regime, and it is 13 % at 3 and 29 % at 10 by the
    definition of the paper, and within 7 % up to 30 by the balanced one (validity.md has the table).
    """
    odds = log_odds(groups)
    share = np.exp(-np.logaddexp(0.0, odds))
    return (boundary_friction * share + _viscous(groups, odds, beta, definition))[()]


def _viscous(groups: Groups, odds: Array, beta: float, definition: Definition) -> Array:
    a1, a2, a3, a4 = SHEAR_COEFFICIENTS
    b1, b2, b3, b4, b5, b6, b7 = MOMENT_COEFFICIENTS
    lambda_, F, kappa = np.broadcast_arrays(groups.speed, groups.load, groups.relative_roughness)
    found = np.array(np.broadcast_to(hydrodynamic.friction_uniform.function(groups, beta), odds.shape))
    found[np.isnan(odds)] = np.nan
    rough = np.isfinite(odds)
    lambda_, F, kappa, odds = lambda_[rough], F[rough], kappa[rough], odds[rough]
    r = film_speed_ratio(Groups(lambda_, F, kappa * F), odds)
    found[rough] *= r**a1 * (1 + a2 * kappa**a3 * (1 - r**a4))
    if definition == "balanced":
        return found
    G, _ = gaps(odds, F)
    first = first_moment(G, FIRST_MOMENT_COEFFICIENTS)
    share_to_q = np.exp(-np.logaddexp(0.0, odds) * (b1 + b2 / G) / (1 + b3 * kappa**b4))
    edge = 1 + b5 * kappa**b6 * (-0.5 * np.log(F)) ** b7
    found[rough] += beta * np.sqrt(F) * lambda_ / kappa**2 * first * share_to_q * edge
    return found


def first_moment(G: Array, coefficients: tuple[float, float, float, float, float]) -> Array:
    """Return the moment of the contact pressure of first order in the speed, by the central gap in kappa u_Hz."""
    m1, m2, m3, m4, m5 = coefficients
    return np.asarray(m1 * G**-m2 * (1 + m3 * G) ** -m4 * (1 + m5 * G) ** (m2 + m4 - 3))
