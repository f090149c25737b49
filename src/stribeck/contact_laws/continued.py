"""Contact laws near the separations of a state, where series of it are made.

Laws are known as functions of real numbers, by tables and splines too.  Around each separation such a law is the polynomial
through its values nearby, which has a series whatever the law is.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from stribeck._types import Array
from stribeck.contact_laws.law import AsperityLaw
from stribeck.numerics.hermite import chebyshev_form

DEGREE = 10
"""Degree of the polynomials."""

LOG_REACH = 0.25
"""Half-width in ln(s) of the values that they go through, for laws of positive separations: on wider ones the law of Persson
follows no polynomial of this degree (an error of 1e-8 on 0.5), on narrower ones rounding counts."""

REACH, SMALLEST_REACH = 0.2, 0.2
"""Half-width of other laws: part of the separation, and the smallest."""

LOOKED_AT = np.concatenate([np.linspace(-3.0, 0.0, 16), np.geomspace(1e-3, 50.0, 64)])
"""Separations around which a law is compared with them: their intervals overlap."""


@dataclass(frozen=True, eq=False)
class ContinuedLaw:
    """The shape of a contact law near separations, one a column."""

    name: str  # Name of the shape
    logarithmic: bool  # Whether polynomials are in the logarithm of the separation
    centre: Array  # Where they are centred, and their unit
    reach: Array  # Where they are centred, and their unit
    coefficients: Array  # Of ln(Phi), ascending

    @classmethod
    def of(cls, shape: AsperityLaw, separation: Array) -> ContinuedLaw:
        """Return the continuation of a law near separations, shape (n,)."""
        logarithmic, centre, reach, values = _around(shape, separation)
        return cls(shape.name, logarithmic, centre, reach, _to_powers() @ values)

    @classmethod
    def exponential(cls, separation: Array) -> ContinuedLaw:
        """Return that of the exponential law, which is linear."""
        one = np.ones_like(separation)
        return cls("exponential", False, separation, one, np.stack([-separation, -one]))


def _around(shape: AsperityLaw, separation: Array) -> tuple[bool, Array, Array, Array]:
    """Return whether polynomials are in the logarithm, their centres and their unit, and ln(Phi) at Chebyshev's points."""
    logarithmic = shape.lowest == 0.0
    centre = np.log(separation) if logarithmic else separation
    reach = np.full_like(centre, LOG_REACH) if logarithmic else np.maximum(SMALLEST_REACH, REACH * np.abs(centre))
    points = centre + reach * chebyshev.chebpts1(DEGREE + 1)[:, None]
    return logarithmic, centre, reach, shape.log_pressure(np.exp(points) if logarithmic else points)


def misfit(shape: AsperityLaw) -> float:
    """Return about the largest difference of ln(Phi) of a law from such polynomials, by their last coefficients.

    It is 2e-8 at most for laws with a formula, and 1e-5 or more for a table, at its points.
    """
    with np.errstate(all="ignore"):  # what is not finite is no number here either
        *_, values = _around(shape, LOOKED_AT[LOOKED_AT > shape.lowest])
    return float(np.abs(chebyshev_form(values)[-3:]).max())


@lru_cache(maxsize=1)
def _to_powers() -> Array:
    """Matrix from values at Chebyshev points to the coefficients of the polynomial through them."""
    return np.asarray(np.linalg.inv(np.vander(chebyshev.chebpts1(DEGREE + 1), increasing=True)))
