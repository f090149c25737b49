"""The dry contact of a smooth ball as the limit of all others: small speed and small relative roughness.

Source: Hertz (1882); K. L. Johnson, Contact Mechanics (1985), Section 3.4.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from stribeck.asymptotics.formula import Limit, Value
from stribeck.asymptotics.hertz import dry
from stribeck.contacts.groups import Groups
from stribeck.solids import hertz

HERTZ_OFFSET = -1.0  # Offset of the dry smooth contact [u_Hz]: the ball has come closer by the indentation.

_dry = partial(
    dry,
    geometry="point",
    limits=(Limit("speed", 0, 1e-7), Limit("load", 1e-4, 0.9), Limit("relative_roughness", 0, 1e-3)),
)


@_dry(
    limits=(Limit("speed", 0, 1e-7), Limit("relative_roughness", 0, 1e-3)),
    worst=0.11,
    error_order=1 / 3,
    source="Hertz (1882)",
)
def pressure(groups: Groups, x: Value) -> Value:
    r"""Return the Hertz pressure of the ball along its middle, contact and fluid together.

    .. math:: p = (1 - x^2)^{1/2}

    The error is that at the edge, where the true pressure goes as kappa**(1/3) or lambda**(1/5).
    """
    return hertz.pressure(np.asarray(x, dtype=float)) + np.zeros(groups.shape)


@_dry(worst=0.012, source="Johnson (1985), Section 3.4")
def gap(groups: Groups, x: Value) -> Value:
    r"""Return the gap around the dry contact of a ball.

    .. math:: h = \frac1\pi \left[(x^2 - 2) \arccos\frac1{|x|} + (x^2 - 1)^{1/2}\right] \text{ beyond } |x| = 1

    Zero in the contact.  The error is relative to the largest gap within two radii; it is of order kappa, with logarithms, or
    lambda**(3/5).
    """
    beyond = np.maximum(np.abs(np.asarray(x, dtype=float)), 1.0)
    root = np.sqrt((beyond - 1) * (beyond + 1))
    # arctan of the root is arccos(1/r) without loss of digits near the edge.
    found: Value = (root + (beyond**2 - 2) * np.arctan(root)) / math.pi + np.zeros(groups.shape)
    return found


@_dry(worst=0.0045, source="Hertz (1882)")
def offset(groups: Groups) -> Value:
    r"""Return the offset of the dry contact of a ball.

    .. math:: z_0 = -1

    Unlike on the line there is no gauge: the surface far away stands still.
    """
    return np.full(groups.shape, HERTZ_OFFSET)[()]
