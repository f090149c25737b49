r"""Fast: the smooth ball that is hardly deflected, carried by the lift that its deflection gives.

The pressure under the parabola is odd in x and carries nothing; the flow over the deflection that it causes carries
:math:`27 \pi^2/(6400 \sqrt2) \, \lambda^2 h_0^{-5/2}`.

Source: ours; the literature has the lift as :math:`0.416 \, \eta^2 V^2 R^{5/2} h_0^{-5/2}/E^*`, a quarter of ours, with
V = 2 U in Reynolds' equation; theory.md, section 11.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from stribeck.asymptotics.formula import Limit, Value, formula
from stribeck.contacts.groups import Groups

LIFT_COEFFICIENT = 27 * math.pi**2 / (6400 * math.sqrt(2))  # Load of the fluid over lambda**2 h_0**(-5/2).

# h_0 over lambda**(4/5), 0.18162, at which that load is 2 pi/3.
GAP_COEFFICIENT = (3 * LIFT_COEFFICIENT / (2 * math.pi)) ** 0.4


_rigid = partial(
    formula,
    uses=("speed",),
    plane="smooth",
    geometry="point",
    small="1/speed",
    source="ours",
)


@_rigid(limits=(Limit("speed", 1e2),), worst=8e-4, error_order=1.2)
def minimum_gap(groups: Groups) -> Value:
    r"""Return the gap of a fast smooth ball.

    .. math:: h_0 = \left(\frac{81 \pi}{12800 \sqrt2}\right)^{2/5} \lambda^{4/5} = 0.18162 \, \lambda^{4/5}

    In other words :math:`F_N E^* h_0^{5/2} = \tfrac{243 \pi^3}{3200 \sqrt2} \, \eta^2 U^2 R^{5/2}`, with 1.6649.  The
    gap in the middle is larger by the deflection under the load, 3.5 % at speed 100.
    """
    found: Value = GAP_COEFFICIENT * np.power(groups.speed, 0.8)
    return found


@_rigid(limits=(Limit("speed", 3e2),), worst=0.26, error_order=0.6)
def fluid_pressure(groups: Groups, x: Value) -> Value:
    r"""Return the fluid pressure of a fast smooth ball along its middle, to the order that carries no load.

    .. math:: p_f = -\frac{\lambda x}{5 h^2}, \qquad h = h_0 + \frac{x^2}{2}

    x : Positions [a]; off the middle at x, y the same with :math:`h_0 + (x^2 + y^2)/2`.

    Compared with the solver within three of its widths, :math:`h_0^{1/2}`.  The part even in x, which carries
    the load, is smaller by :math:`\lambda/h_0^2`.

    Far away it is :math:`-\tfrac45 \lambda x/r^4`.
    """
    x = np.asarray(x, dtype=float)
    gap = minimum_gap.function(groups) + np.square(x) / 2
    return np.asarray(-groups.speed / 5 / gap * (x / gap))[()]
