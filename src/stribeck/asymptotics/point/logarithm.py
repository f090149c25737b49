"""The part of the friction integral of a ball that grows with the logarithm of the wetted radius, one surface at rest.

Source: :mod:`stribeck.contacts.cut_off`.
"""

from __future__ import annotations

import math

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.documentation import described
from stribeck.asymptotics.formula import Value
from stribeck.contacts.cut_off import COUETTE, FULL_FAR_FILM, POISEUILLE, far_logarithms, log_cut_offs
from stribeck.quantities.arrays import real_array
from stribeck.quantities.units import InputError, show

LOGARITHM_COEFFICIENT = COUETTE + POISEUILLE  # Coefficient of lambda ln X, 16 pi/15.


@described(
    "The integral over lambda [-].", kind="ndarray", raises="If a wetted radius lies inside the contact, at 1 or below."
)
def far_integral(slope: Value, wetted_radius: Value | None = None, film: Value = 0.0) -> Array:
    r"""Return the contribution of the liquid around the contact to the friction integral, over the speed group.

    .. math:: \tfrac{16}{15} \pi \ln X + \tfrac{8}{15} \pi \ln(1 + y) + \tfrac25 \pi \frac{y}{1 + y}, \quad y = 2 h(0)/X^2

    film : Gap in the middle h(0) [u_Hz], which counts where it is no longer thin beside the gap at X.
    """
    radius: Value = math.inf
    if wetted_radius is not None:
        radius = real_array("wetted_radius", wetted_radius)
        if not np.all((radius > 1) & (radius < math.inf)):
            raise InputError(
                f"wetted_radius = {show(wetted_radius)}; in Hertz radii it must exceed 1, the edge of the contact."
            )
    with np.errstate(divide="ignore"):
        logarithms = log_cut_offs(np.asarray(slope, dtype=float), radius)
        start = -0.5 * np.log(2.0 * np.asarray(film))
    by_shear, by_pressure, _ = far_logarithms(*logarithms, start, FULL_FAR_FILM.rise)
    return np.asarray(COUETTE * by_shear + POISEUILLE * by_pressure)
