r"""Film and friction of the smooth contact at every speed, by our formulas and the paper's.

Films depend on the speed group alone, the friction also on :math:`\beta \bar F_N^{1/2}`.  Each law of ours is the law of
small speed times a root of a function that is 1 + s u at small and A u at large :math:`u = \lambda^{2/5}`; the root is chosen
for the ratio of the two limits to become a multiple of u.

Source: [BP] Section "General model of the hydrodynamic friction" for :func:`friction`; theory.md, section 7.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from stribeck.asymptotics.constants import FILM_CONSTANT
from stribeck.asymptotics.formula import Value, formula
from stribeck.asymptotics.smooth.large_deformation import central_gap_large, flux_gap_large, friction_large, minimum_gap_large
from stribeck.asymptotics.smooth.small_deformation import (
    central_gap_small,
    flux_gap_small,
    friction_small,
    gap_small,
    pressure_small,
)
from stribeck.contacts.groups import Groups

__all__ = [
    "FILM_CONSTANT",
    "central_gap",
    "central_gap_large",
    "central_gap_small",
    "flux_gap",
    "flux_gap_large",
    "flux_gap_small",
    "friction",
    "friction_large",
    "friction_small",
    "friction_uniform",
    "gap_small",
    "minimum_gap_large",
    "pressure_small",
]

# Next term of central and flux gap at small speed, relative, over lambda**(2/5); from states at speeds down to 1e-9.
GAP_SLOPE = 0.245

FRICTION_SLOPE = 4.0  # Next term of the friction at small speed, relative, over lambda**(2/5); from the same states.

# Fitted coefficients of the laws for every speed, by smallest maximum error on 241 speeds from 1e-12 to 1e8.
CENTRAL_GAP_COEFFICIENTS = (-0.841, 0.511, 0.032, 0.273)
FLUX_GAP_COEFFICIENTS = (-0.882, 0.574, 0.127, -0.442)
FRICTION_COEFFICIENTS = (3.69, 2.09, -1.10)

MAX_U = 1e50  # u up to which the laws are taken in powers of u, which overflow from 1e77 on.


_any_speed = partial(formula, uses=("speed",), plane="smooth", limits=())


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
    u = np.power(groups.speed, 0.4)
    far = 1 / (576 * FILM_CONSTANT**6)
    return FILM_CONSTANT * groups.speed**0.6 * _bridge(u, far, CENTRAL_GAP_COEFFICIENTS)


@_any_speed(worst=0.0004, source="ours; [BP] Eqs. (hstar) and (fields_small_deformation) give its ends")
def flux_gap(groups: Groups) -> Value:
    r"""Return the flux gap h* at any speed.

    .. math::

        h^* = c \lambda^{3/5} \left[\frac{1 + (6 s + d_1) u + b_2 u^2 + A d_2 u^3 + A d_3 u^4}
        {1 + d_1 u + d_2 u^2 + d_3 u^3}\right]^{1/6}, \quad u = \lambda^{2/5},
        \quad A = \left(\frac43\right)^6 \frac{1}{576 c^6}

    Exact as the speed tends to zero, with the next term :math:`1 + s \lambda^{2/5}`, s = 0.245, and as it tends to infinity,
    where it becomes :func:`flux_gap_small`.  In between :math:`d_1, d_2, d_3, b_2` = -0.882, 0.574, 0.127, -0.442 are fitted.
    Largest error 0.04 %, on 241 speeds from 1e-12 to 1e8.
    """
    u = np.power(groups.speed, 0.4)
    far = (4 / 3) ** 6 / (576 * FILM_CONSTANT**6)
    return FILM_CONSTANT * groups.speed**0.6 * _bridge(u, far, FLUX_GAP_COEFFICIENTS)


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
    slow = friction_large.function(groups, beta)
    far = (math.sqrt(2) * math.pi * 24 ** (1 / 6) * FILM_CONSTANT) ** 1.5
    b, e1, e2 = FRICTION_COEFFICIENTS
    u = np.power(groups.speed, 0.4)
    below = (far - 1.5 * FRICTION_SLOPE) * u + b * u**1.5
    ratio: Value = (1 + far * u - below / (1 + e1 * u**0.5 + e2 * u + b * u**1.5)) ** (2 / 3)
    return slow * ratio


def _bridge(u: Value, far: float, fit: tuple[float, float, float, float]) -> Value:
    """Return the sixth root of a rational function that tends to 1 + 6 s u at small u and to ``far`` u at large u."""
    d1, d2, d3, b2 = fit
    # Beyond, the ratio is its limit to all digits.
    u, beyond = np.minimum(u, MAX_U), np.maximum(np.divide(u, MAX_U), 1.0)
    below = 1 + u * (d1 + u * (d2 + u * d3))
    above = 1 + u * (6 * GAP_SLOPE + d1 + u * (b2 + far * u * (d2 + u * d3)))
    root: Value = (above / below * beyond) ** (1 / 6)
    return root
