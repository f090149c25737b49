"""The part of the friction integral of a ball that grows with the logarithm of the wetted radius, one surface at rest.

Source: :mod:`stribeck.contacts.cut_off`.
"""

from __future__ import annotations

import math

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.documentation import described
from stribeck.asymptotics.formula import Value
from stribeck.contacts.cut_off import COUETTE, POISEUILLE, log_cut_offs
from stribeck.quantities.arrays import real_array
from stribeck.quantities.units import InputError, show

LOGARITHM_COEFFICIENT = COUETTE + POISEUILLE  # Coefficient of lambda ln X, 16 pi/15.


@described(
    "The integral over lambda [-].", kind="ndarray", raises="If a wetted radius lies inside the contact, at 1 or below."
)
def far_integral(slope: Value, wetted_radius: Value | None = None) -> Array:
    r"""Return the contribution of the liquid around the contact to the friction integral, over the speed group.

    .. math:: \tfrac{16}{15} \pi \ln X
    """
    if wetted_radius is None:
        by_shear, by_pressure = log_cut_offs(1.0)
        with np.errstate(divide="ignore"):
            return np.asarray(COUETTE * by_shear + POISEUILLE * by_pressure - LOGARITHM_COEFFICIENT * np.log(slope))
    radius = real_array("wetted_radius", wetted_radius)
    if not ((radius > 1) & (radius < math.inf)).all():
        raise InputError(f"wetted_radius = {show(wetted_radius)}; in Hertz radii it must exceed 1, the edge of the contact.")
    return np.asarray(LOGARITHM_COEFFICIENT * np.log(radius))
