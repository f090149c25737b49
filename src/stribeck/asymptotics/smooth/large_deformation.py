r"""Film and friction of the smooth contact at large deformation, where the speed group tends to zero.

The film is thin and uniform in the Hertz contact, with inlet and outlet of width :math:`\lambda^{2/5}`, the parameter of all
corrections.  Films depend on the speed group alone, the friction also on :math:`\beta \bar F_N^{1/2}`.

Source: [BP] Section "Large deformation limit"; theory.md, section 7.
"""

from __future__ import annotations

import math
from functools import partial

from stribeck.asymptotics.constants import FILM_CONSTANT, MINIMUM_CONSTANT, PRINTED_FILM_CONSTANT
from stribeck.asymptotics.formula import Limit, Value, formula
from stribeck.asymptotics.judged import smooth_line
from stribeck.contacts.groups import Groups

SLOW_RANGE = (Limit("speed", 0.0, 1e-3),)


_slow = partial(
    formula,
    uses=("speed",),
    plane="smooth",
    limits=SLOW_RANGE,
    small="speed",
    error_order=0.4,
    approach=smooth_line,
    steps=(1e-9, 1e-8, 1e-7),
)


@_slow(
    predicts="central_gap",
    worst=0.015,
    source="[BP] Eq. (central_thickness_large), with c = 0.44583 for the printed 0.44, which is 1.3 % low",
)
def central_gap_large(groups: Groups, *, printed: bool = False) -> Value:
    r"""Return the gap at x = 0 at large deformation, speed group -> 0.

    .. math:: h(0) = c \lambda^{3/5}

    The next term, relative to it, is 0.245 lambda**(2/5).
    """
    return (PRINTED_FILM_CONSTANT if printed else FILM_CONSTANT) * groups.speed**0.6


@_slow(predicts="flux_gap", worst=0.015, source="[BP] below Eq. (hstar), with c = 0.44583 for the printed 0.44")
def flux_gap_large(groups: Groups) -> Value:
    r"""Return the flux gap at large deformation, speed group -> 0.

    .. math:: h^* = c \lambda^{3/5}

    As :func:`central_gap_large`; the two differ by less than 1e-3 even at the end of the range.
    """
    return FILM_CONSTANT * groups.speed**0.6


@_slow(
    predicts="minimum_gap",
    worst=0.012,
    source="ours; :mod:`stribeck.asymptotics.smooth.film_layers` solves the outlet by itself",
)
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
