"""The dry contact of a smooth cylinder to which all others tend at small speed and small relative roughness.

Source: [BP] Eqs. (Hertz), (vertical_position_Hz).
"""

from __future__ import annotations

from functools import partial

import numpy as np

from stribeck.asymptotics.formula import Limit, Value, formula
from stribeck.contacts.groups import Groups
from stribeck.solids import hertz

dry = partial(
    formula,
    uses=(),
    plane="mixed",
    limits=(Limit("speed", 0, 1e-7), Limit("load", 1e-4, 0.9), Limit("relative_roughness", 0, 1e-4)),
    small="relative_roughness",
    error_order=1,
)


@dry(
    limits=(Limit("speed", 0, 1e-7), Limit("relative_roughness", 0, 1e-4)),
    worst=0.05,
    error_order=1 / 3,
    source="[BP] Eq. (Hertz)",
)
def pressure(groups: Groups, x: Value) -> Value:
    r"""Return the Hertz pressure, contact and fluid together.

    .. math:: p = (1 - x^2)^{1/2}

    The error is that at the edge, where the true pressure goes as kappa**(1/3) or lambda**(1/5); at fixed distance from the
    edge it falls as kappa.
    """
    return hertz.pressure(np.asarray(x, dtype=float)) + np.zeros(groups.shape)


@dry(worst=1e-3, source="[BP] Eq. (Hertz)")
def gap(groups: Groups, x: Value) -> Value:
    r"""Return the gap around the dry contact.

    .. math:: h = \tfrac12 \left[|x| \sqrt{x^2 - 1} - \ln\left(|x| + \sqrt{x^2 - 1}\right)\right] \text{ beyond } |x| = 1

    Zero in the contact.  The error is relative to the largest gap within two half-widths; it is of order kappa,
    with logarithms, or lambda**(3/5).
    """
    return hertz.gap(np.asarray(x, dtype=float)) + np.zeros(groups.shape)


@dry(worst=1e-3, source="[BP] Eq. (vertical_position_Hz)")
def offset(groups: Groups) -> Value:
    r"""Return the offset of the dry contact.

    .. math:: z_0 = -\frac{1 + \ln 4}{4}
    """
    return np.full(groups.shape, hertz.HERTZ_OFFSET)
