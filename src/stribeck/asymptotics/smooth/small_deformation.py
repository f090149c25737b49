r"""Fields, film and friction of the smooth contact at small deformation, where the speed group tends to infinity.

The cylinder is a rigid parabola on a film much thicker than its indentation; corrections go as :math:`\lambda^{-1/3}` in the
fields, where they are antisymmetric, and as :math:`\lambda^{-2/3}` in what is read off them.

Source: [BP] Section "Small deformation limit"; theory.md, section 7.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.formula import Limit, Value, formula
from stribeck.asymptotics.judged import around
from stribeck.contacts.groups import Groups

FAST_RANGE = (Limit("speed", 1e3),)


def _at_inverse_speed(inverse: float) -> Groups:
    return Groups(1 / inverse, 0.1, 0.0)


def _four_widths(groups: Groups) -> Value:
    return 4 * np.sqrt(central_gap_small.function(groups))


_fast = partial(
    formula,
    uses=("speed",),
    plane="smooth",
    limits=FAST_RANGE,
    small="1/speed",
    error_order=2 / 3,
    approach=_at_inverse_speed,
    steps=(1e-5, 1e-4, 1e-3),
)


@_fast(predicts="central_gap", worst=0.021, source="[BP] Eq. (film_thickness_small_deformation)")
def central_gap_small(groups: Groups) -> Value:
    r"""Return the gap at x = 0 at small deformation, speed group -> infinity.

    .. math:: h(0) = \frac{\lambda^{2/3}}{24^{1/3}}

    The next term, relative to it, is 2.10 lambda**(-2/3).
    """
    return np.power(groups.speed, 2 / 3) / 24 ** (1 / 3)


@_fast(predicts="flux_gap", worst=0.002, source="[BP] Eq. (fields_small_deformation)")
def flux_gap_small(groups: Groups) -> Value:
    r"""Return the flux gap at small deformation, speed group -> infinity.

    .. math:: h^* = \frac43 \frac{\lambda^{2/3}}{24^{1/3}}

    The next term, relative to it, is 0.201 lambda**(-2/3).
    """
    return 4 / 3 * central_gap_small.function(groups)


@_fast(
    predicts="gap",
    worst=0.017,
    error_order=1 / 3,
    steps=(1e-7, 1e-6, 1e-5),
    interval=around(0.0, _four_widths),
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
    steps=(1e-7, 1e-6, 1e-5),
    interval=around(0.0, _four_widths),
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
