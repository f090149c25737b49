r"""The film far from the contact: that of a rigid ball with the deflection under a point force.

With :math:`h = z_0 + r^2/2 + b/r` Reynolds' equation has, to first order in b, the solution

.. math::

    p = \cos\theta \Big[ -\frac\lambda5 \frac{r}{(z_0 + r^2/2)^2} \Big(1 - \frac{16 b}{r^3}\Big) \Big]
        + \sum_m C_m \cos m\theta \; r^{-3 - \sqrt{9 + m^2}}

The first part is exact for b = 0, and 16 follows from :math:`h^3` and :math:`\partial_x h` to first order.  The
sum holds the decaying solutions without a source in a gap :math:`r^2/2`; their coefficients come from the film inside, so that
the condition at the rim needs their rates alone.
"""

import math
from functools import cache
from typing import Any

import numpy as np
from numpy.polynomial import legendre

from stribeck._types import Array
from stribeck.contacts.cut_off import FULL_FAR_FILM, FarFilm
from stribeck.numerics.settings import MAX_DEGREE
from stribeck.numerics.trace import Value

DEFLECTION_COEFFICIENT = 4.0 / (3.0 * math.pi)  # b: the deflection under the load, far away, times the distance


def particular(
    r: Array, offset: Value, speed: float, far: FarFilm = FULL_FAR_FILM, bulge: float = DEFLECTION_COEFFICIENT
) -> tuple[Any, Any]:
    """Return the factor of cos(theta) in the first part, and its derivative in r, of an offset or of its trace."""
    rigid = offset + 0.5 * r * r
    bent = 1.0 - 16.0 * bulge / r**3
    base = -0.25 * far.pressure * speed * r / (rigid * rigid)
    slope = base * (1.0 / r - 2.0 * r / rigid) * bent + base * (48.0 * bulge / r**4)
    return base * bent, slope


def rates(modes: int) -> Array:
    """Return the exponents of the sum, one per mode."""
    return np.asarray(-3.0 - np.sqrt(9.0 + np.arange(modes) ** 2))


@cache
def _rule() -> tuple[Array, Array]:
    """Return the Gauss rule of the integrals, on 0 to 1."""
    t, w = legendre.leggauss(2 * MAX_DEGREE)
    return 0.5 * (t + 1.0), 0.5 * w


def tails(
    rim: float,
    offset: float,
    speed: float,
    pressure: float,
    far: FarFilm = FULL_FAR_FILM,
    bulge: float = DEFLECTION_COEFFICIENT,
) -> tuple[float, float, float]:
    """Return the parts of shear, pressure flow and moment outside the rim, without the logarithms at infinity."""
    # ``pressure`` is the factor of cos(theta) in the film pressure at the rim.
    u, w = _rule()
    r = rim / u
    ring = rim / u**2 * w * r
    h = offset + 0.5 * r * r + bulge / r
    f, slope = particular(r, offset, speed, far, bulge)
    decaying = (pressure - float(particular(np.array([rim]), offset, speed, far, bulge)[0][0])) * (r / rim) ** rates(2)[1]
    f, slope = f + decaying, slope + decaying * rates(2)[1] / r
    log, strength = math.log(rim), far.pressure * speed
    couette = 0.5 * far.couette * speed * (float((ring * (1.0 / h - 2.0 / r**2)).sum()) - 2.0 * log)
    poiseuille = 0.5 * math.pi * (float((ring * (h * (slope + f / r) - strength / r**2)).sum()) - strength * log)
    moment = math.pi * (float((ring * (f * r + strength / r**2)).sum()) + strength * log)
    return couette, poiseuille, moment
