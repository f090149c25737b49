"""Friction of a ball by its integral, of which a part grows with the logarithm of the wetted radius, one surface at rest.

Source: :mod:`stribeck.contacts.cut_off`.
"""

from __future__ import annotations

import math

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.formula import Value
from stribeck.contacts.cut_off import COUETTE, FULL_FAR_FILM, POISEUILLE, far_logarithms, log_cut_offs
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Groups
from stribeck.quantities.arrays import real_array
from stribeck.quantities.units import InputError, show

LOGARITHM_COEFFICIENT = COUETTE + POISEUILLE  # Coefficient of lambda ln X, 16 pi/15.


def far_integral(slope: Value, wetted_radius: Value | None = None, film: Value = 0.0) -> Array:
    r"""Return what the liquid around the contact adds to the friction integral, over the speed group.

    .. math:: \tfrac{16}{15} \pi \ln X + \tfrac{8}{15} \pi \ln(1 + y) + \tfrac25 \pi \frac{y}{1 + y}, \quad y = 2 h(0)/X^2

    The gap in the middle h(0), ``film``, counts where it is no longer thin beside the gap at the wetted radius X.
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


def friction_of(
    groups: Groups, J: Value, beta: float, definition: Definition, wetted_radius: float | None, film: Value = 0.0
) -> Array:
    """Return the friction coefficient of the finite part J of a friction integral, with the liquid around the contact."""
    if beta == 0:
        return np.zeros(np.shape(J))
    J = J + np.multiply(groups.speed, far_integral(groups.slope(beta), wetted_radius, film))
    if definition == "published" and wetted_radius is not None:
        # A disc of liquid ends with a pressure at its rim.
        J = J + POISEUILLE * np.asarray(groups.speed) / (1.0 + 2.0 * film / np.square(wetted_radius))
    return np.asarray(0.75 * beta * np.power(groups.load, 1 / 3) * J)
