r"""Published regressions for the smooth ball, under their authors' names: central film, isoviscous and elastic.

They were fitted to solutions with cavitation, in groups of their own:

.. math::

    U_\mathrm{HD} &= \frac{\eta (u_1 + u_2)/2}{2 E^* R} = \frac{\lambda}{12 \pi} \left(\frac aR\right)^4, \qquad
    W_\mathrm{HD} = \frac{F_N}{2 E^* R^2} = \frac23 \left(\frac aR\right)^3, \qquad
    \frac hu = H_\mathrm{HD} \left(\frac Ra\right)^2 \\
    M &= \frac23 \left(\frac{6 \pi}{\lambda}\right)^{3/4}, \qquad
    \frac hu = H_\mathrm{Moes} \left(\frac{\lambda}{6 \pi}\right)^{1/2}

with their :math:`E' = 2 E^*`, the mean speed in the first line and the sum of the speeds in the second.  The exact film
depends on
:math:`\lambda` alone; a regression with other exponents depends on a/R too.

Source: facts of theory.md, section 11; the authors' names stand with each.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from stribeck.asymptotics.formula import Limit, Value, formula
from stribeck.contacts.groups import Groups
from stribeck.quantities.units import InputError, real_array, show

_regression = partial(formula, uses=("speed",), plane="smooth", geometry="point")


@_regression(
    predicts="central_gap",
    limits=(Limit("speed", 1e-5, 10.0),),
    worst=0.35,
    source="B. J. Hamrock and D. Dowson, J. Lubr. Technol. 100 (1978) 236",
)
def hamrock_dowson_soft(groups: Groups, slope: float = 0.1) -> Value:
    r"""Return the central film of Hamrock and Dowson for soft contacts, of a ball.

    .. math:: H = 7.32 \, (1 - 0.72 e^{-0.28}) \, U_\mathrm{HD}^{0.64} W_\mathrm{HD}^{-0.22}

    Its exponent 0.64 is that of a range of light loads; the exact one is 3/5 for slow speed.  At a/R = 0.1 from 31 %
    below at speed 1e-5 to 28 % above at 10; it goes as :math:`(a/R)^{-0.1}`.
    """
    return _film(groups, slope, 7.32 * (1 - 0.72 * math.exp(-0.28)), 0.64, -0.22)


@_regression(
    predicts="central_gap",
    limits=(Limit("speed", 1e-6, 10.0),),
    worst=0.11,
    source="J. de Vicente, J. R. Stokes and H. A. Spikes, Tribol. Lett. 20 (2005) 273",
)
def de_vicente(groups: Groups, slope: float = 0.1) -> Value:
    r"""Return the central film of de Vicente, Stokes and Spikes for soft balls.

    .. math:: H = 3.3 \, U_\mathrm{HD}^{0.60} W_\mathrm{HD}^{-0.14}

    Its exponents are nearly the exact ones, 3/5 and -2/15.  At a/R = 0.1 between 0.7 % below at speed 1e-6 and 10 %
    above at 0.5; it goes as :math:`(a/R)^{-0.02}`.
    """
    return _film(groups, slope, 3.3, 0.60, -0.14)


@_regression(
    predicts="central_gap",
    limits=(Limit("speed", 1e-6, 0.4),),
    worst=0.09,
    source="G. Nijenbanning, C. H. Venner and H. Moes, Wear 176 (1994) 217",
)
def nijenbanning_venner_moes(groups: Groups) -> Value:
    r"""Return the central film of Nijenbanning, Venner and Moes for a circular contact without pressure-viscosity effect.

    .. math::

        H &= \left[H_\mathrm{RI}^{3/2} + \left(H_\mathrm{EI}^{-4} + H_{00}^{-4}\right)^{-3/8}\right]^{2/3} \\
        H_\mathrm{RI} &= 145 \cdot 1.796^{-15/7} M^{-2}, \qquad H_\mathrm{EI} = 3.18 \cdot 1.63^{-14/25} M^{-2/15}, \qquad
        H_{00} = 1.8

    Between 4 and 8 % above the solver.  Its branch of the rigid ball is that with cavitation, which carries load without any
    deflection: from speed 0.5 on the film without cavitation is thinner and thinner beside it.
    """
    lambda_ = np.asarray(groups.speed)
    M = 2 / 3 * (6 * math.pi / lambda_) ** 0.75
    rigid, elastic = 145 * 1.796 ** (-15 / 7) * M**-2, 3.18 * 1.63 ** (-14 / 25) * M ** (-2 / 15)
    H = (rigid**1.5 + (elastic**-4 + 1.8**-4) ** (-3 / 8)) ** (2 / 3)
    found: Value = (H * np.sqrt(lambda_ / (6 * math.pi)))[()]
    return found


def _film(groups: Groups, slope: Value, factor: float, of_speed: float, of_load: float) -> Value:
    """Return a film that goes as powers of U_HD and W_HD."""
    ratio = real_array("slope", slope)
    if not ((ratio > 0) & np.isfinite(ratio)).all():
        raise InputError(f"slope = {show(slope)}; it is a/R and must be positive.")
    U, W = groups.speed * ratio**4 / (12 * math.pi), 2 / 3 * ratio**3
    found: Value = (factor * U**of_speed * W**of_load / ratio**2)[()]
    return found
