r"""The slow smooth ball: the film by the inlet of the line, the leakage to the sides, and the minimum film.

Inlet and leakage are theory.md Eqs. (25) and (26).  The outlet of the line has a solution for any incoming film, here for what
the leakage leaves of it.  At the sides, where :math:`h \sim \lambda^{3/4}`, inlet, outlet and leakage are one problem.

Source: ours, on the inlet of J. H. Snoeijer, J. Eggers and C. H. Venner, Phys. Fluids 25, 101705 (2013); theory.md,
section 11.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from stribeck.asymptotics.constants import BALL_FILM_CONSTANT, FILM_CONSTANT, MINIMUM_CONSTANT
from stribeck.asymptotics.formula import Limit, Value, formula
from stribeck.asymptotics.point.rigid import GAP_COEFFICIENT
from stribeck.contacts.groups import Groups

# Flux lost up to the middle of the contact over the flux that enters, as a multiple of lambda**(1/5).
LEAKAGE_COEFFICIENT = math.pi * BALL_FILM_CONSTANT**2

# Logarithm of the minimum of the outlet over the line's, as a polynomial in the logarithm of the incoming film; from the
# outlet solved for films of 0.8 to 1.05 times the line's, within 2e-4.
OUTLET_COEFFICIENTS = (0.8283, -0.078)

# Fitted: limit of the minimum film over lambda**(3/4), and coefficients of what divides it.
SIDE_COEFFICIENTS = (0.6817, 0.9625, 1.0682)

# Fitted coefficients d1 .. d4, n2 .. n4 of :func:`central_gap`.
BRIDGE_COEFFICIENTS = (-0.35423, -0.055968, -0.05253, 0.094462, 0.53295, -0.10852, -0.0096834)

_film = partial(formula, uses=("speed",), plane="smooth", geometry="point", limits=(Limit("speed", 0.0, 1e-2),))


@_film(worst=0.014, source="ours; inlet of Snoeijer, Eggers and Venner (2013)")
def central_gap_slow(groups: Groups, leakage: bool = True) -> Value:
    r"""Return the gap in the middle of a slow smooth ball.

    .. math::

        h(0) = c \lambda^{3/5} \left(1 + \pi c^2 \lambda^{1/5}\right)^{-1/2}, \qquad c = 0.424803

    leakage : Whether with the flow to the sides, the bracket.

    In SI :math:`h = 1.696 \, R \, (\eta U/E^* R)^{3/5} (F_N/E^* R^2)^{-2/15}` times the bracket.  With leakage the error is
    within 0.1 % for speeds up to 1e-4, -1.3 % at 0.01 and -3.9 % at 0.1; without it goes as :math:`\tfrac\pi2 c^2
    \lambda^{1/5}`, 1.8 % even at speed 1e-6.
    """
    film: Value = BALL_FILM_CONSTANT * np.power(groups.speed, 0.6)
    return film * (1 + LEAKAGE_COEFFICIENT * np.power(groups.speed, 0.2)) ** -0.5 if leakage else film


@_film(limits=(), worst=0.0011, source="ours")
def central_gap(groups: Groups) -> Value:
    r"""Return the gap in the middle of a smooth ball at any speed.

    .. math::

        h(0) = c \lambda^{3/5} \left[\frac{1 + (d_1 - \pi c^2) u + n_2 u^2 + n_3 u^3 + n_4 u^4 + K d_3 u^5 + K d_4 u^6}
        {1 + d_1 u + d_2 u^2 + d_3 u^3 + d_4 u^4}\right]^{1/2}, \quad u = \lambda^{1/5},
        \quad K = \left(\frac{0.18162}{c}\right)^2

    As the speed tends to zero it is :func:`central_gap_slow`, as it tends to infinity the gap of the rigid ball,
    :mod:`stribeck.asymptotics.point.rigid`; in between :math:`d_1 \dots d_4, n_2 \dots n_4` = -0.35423, -0.055968, -0.05253,
    0.094462, 0.53295, -0.10852, -0.0096834 are fitted.  Largest error 0.09 % at 49 speeds from 1e-6 to 1e4.
    """
    return film_of(groups.speed)


def film_of(speed: Value) -> Value:
    """Return the gap in the middle of a smooth ball at a speed group."""
    d1, d2, d3, d4, n2, n3, n4 = BRIDGE_COEFFICIENTS
    K = (GAP_COEFFICIENT / BALL_FILM_CONSTANT) ** 2
    # Beyond, the ratio is its limit, K u**2, to all digits; its powers would overflow.
    u, beyond = np.minimum(np.power(speed, 0.2), 1e30), np.maximum(np.power(speed, 0.2) / 1e30, 1.0)
    above = 1 + u * (d1 - LEAKAGE_COEFFICIENT + u * (n2 + u * (n3 + u * (n4 + u * K * (d3 + d4 * u)))))
    below = 1 + u * (d1 + u * (d2 + u * (d3 + u * d4)))
    found: Value = BALL_FILM_CONSTANT * np.power(speed, 0.6) * np.sqrt(above / below) * beyond
    return found


@_film(
    limits=(Limit("speed", 0.0, 1e-3),),
    undefined="from the edge of the contact outwards, where this has no value",
    worst=0.03,
    source="ours",
)
def gap_slow(groups: Groups, x: Value) -> Value:
    r"""Return the gap along the middle of a slow smooth ball, in the contact.

    .. math::

        h = q - \frac{q^3}{\lambda} \frac{x}{(1-x^2)^{1/2}}, \qquad
        q = c \lambda^{3/5} \left[1 + 2 c^2 \lambda^{1/5} \left(\arcsin x + \tfrac\pi2\right)\right]^{-1/2}

    Compared with the solver up to 0.8 of the radius; inlet and outlet are :math:`\lambda^{2/5}` wide.
    """
    x = np.where(np.abs(x) < 1, x, np.nan)
    leaked = 2 / math.pi * LEAKAGE_COEFFICIENT * np.power(groups.speed, 0.2) * (np.arcsin(x) + math.pi / 2)
    q = BALL_FILM_CONSTANT * np.power(groups.speed, 0.6) * (1 + leaked) ** -0.5
    slope = np.divide(q**3, groups.speed, where=np.greater(groups.speed, 0), out=np.zeros(np.broadcast(q, groups.speed).shape))
    return np.asarray(q - slope * x / np.sqrt((1 - x) * (1 + x)))[()]


@_film(worst=0.018, source="ours; outlet of Snoeijer, Eggers and Venner (2013)")
def minimum_gap_on_axis(groups: Groups) -> Value:
    r"""Return the minimum along the middle of a slow smooth ball, at its outlet.

    .. math::

        h = 0.75801 \, c \lambda^{3/5} \, f^{\, 0.8283 - 0.078 \ln f}, \qquad
        f = \left(1 + 2\pi c^2 \lambda^{1/5}\right)^{-1/2}

    f is the film that reaches the outlet over that of the inlet.  Below by 0.07 % at speed 1e-6, 0.3 % at 1e-4, 1.7 %
    at 0.01.  The limit over the central film, 0.75801, is far: it is 0.750, 0.741, 0.720 at these speeds.
    """
    film = BALL_FILM_CONSTANT * np.power(groups.speed, 0.6)
    log_f = -0.5 * np.log1p(2 * LEAKAGE_COEFFICIENT * np.power(groups.speed, 0.2))
    one, two = OUTLET_COEFFICIENTS
    found: Value = MINIMUM_CONSTANT / FILM_CONSTANT * film * np.exp(log_f * (one + two * log_f))
    return found


@_film(limits=(Limit("speed", 1e-6, 0.3),), worst=0.017, source="ours: derived power, fitted coefficients")
def minimum_gap(groups: Groups) -> Value:
    r"""Return the minimum film of a slow smooth ball, at its two sides.

    .. math:: h = \frac{0.6817 \, \lambda^{3/4}}{1 + 0.9625 \, \lambda^{1/4} + 1.0682 \, \lambda^{1/2}}

    The power 3/4 is derived, the three coefficients are fitted, within 1.5 % over the range.  The local exponent is
    0.735 to 0.745 at speeds 1e-4 to 1e-6.
    """
    limit, one, two = SIDE_COEFFICIENTS
    v = np.power(groups.speed, 0.25)
    found: Value = limit * np.power(groups.speed, 0.75) / (1 + v * (one + two * v))
    return found
