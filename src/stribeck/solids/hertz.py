r"""The dry contact of a smooth cylinder in closed form: speed and roughness zero.

.. math::

    p = (1 - x^2)^{1/2}, \quad h = \tfrac12 \left[|x| \sqrt{x^2 - 1} - \ln\left(|x| + \sqrt{x^2 - 1}\right)\right]
    \text{ beyond } |x| = 1, \quad z_0 = -\frac{1 + \ln 4}{4}

Source: [BP] Eqs. (Hertz), (vertical_position_Hz), with the step function of the gap as there.
"""

import math

import numpy as np

from stribeck._types import Array

HERTZ_OFFSET = -(1 + math.log(4)) / 4  # Offset of the Hertz contact [u_Hz].


def pressure(x: Array) -> Array:
    """Return the Hertz pressure [p_Hz] at ``x`` [a]."""
    return np.sqrt(np.maximum(0.0, (1 - x) * (1 + x)))


def gap(x: Array) -> Array:
    """Return the gap of the dry contact [u_Hz] at ``x`` [a]."""
    x = np.abs(x)
    root = np.sqrt(np.maximum(0.0, (x - 1) * (x + 1)))
    return np.asarray(np.where(x > 1, 0.5 * (x * root - np.log1p(np.maximum(0.0, x - 1) + root)), 0.0))
