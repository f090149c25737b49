"""Contact laws near the separations of a state, where series of it are made.

Laws are known as functions of real numbers, by tables and splines too.  Around each separation such a law is the polynomial
through its values nearby, which has a series whatever the law is.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from stribeck._types import Array
from stribeck.contact_laws.law import AsperityLaw
from stribeck.numerics.hermite import chebyshev_form
from stribeck.numerics.jets import polynomial

POLYNOMIAL_DEGREE = 10  # Degree of the polynomial around a separation.

# Half-width in ln(s) of a polynomial for laws of positive separations: Persson's law leaves it by 1e-8 on twice this width,
# and on a narrower one rounding counts.
LOG_HALF_WIDTH = 0.25

RELATIVE_HALF_WIDTH = 0.2  # Half-width of a polynomial over the separation, for laws of any separation.
MIN_HALF_WIDTH = 0.2  # Least half-width of a polynomial, as a separation.

# Separations around which a law is compared with its polynomials, whose intervals overlap.
SCANNED_SEPARATIONS = np.concatenate([np.linspace(-3.0, 0.0, 16), np.geomspace(1e-3, 50.0, 64)])


@dataclass(frozen=True, eq=False)
class ContinuedLaw:
    """The shape of a contact law near separations, one a column."""

    name: str  # Name of the shape
    logarithmic: bool  # Whether polynomials are in the logarithm of the separation
    centre: Array  # Middle of the interval of each polynomial
    reach: Array  # Half-width of the interval, the unit of its coordinate
    coefficients: Array  # Of ln(Phi), ascending

    @classmethod
    def of(cls, shape: AsperityLaw, separation: Array) -> ContinuedLaw:
        """Return the continuation of a law near separations, shape (n,)."""
        logarithmic, centre, reach, values = _around(shape, separation)
        return cls(shape.name, logarithmic, centre, reach, _to_powers() @ values)

    def log_pressure(self, separation: Any) -> Any:
        """Return ln(Phi) of a series of separations that begins near these."""
        place = np.log(separation) if self.logarithmic else separation
        return polynomial(self.coefficients, (place - self.centre) / self.reach)


def _around(shape: AsperityLaw, separation: Array) -> tuple[bool, Array, Array, Array]:
    """Return whether polynomials are in the logarithm, their centres and their unit, and ln(Phi) at Chebyshev's points."""
    logarithmic = shape.lowest == 0.0
    centre = np.log(separation) if logarithmic else separation
    reach = (
        np.full_like(centre, LOG_HALF_WIDTH)
        if logarithmic
        else np.maximum(MIN_HALF_WIDTH, RELATIVE_HALF_WIDTH * np.abs(centre))
    )
    points = centre + reach * chebyshev.chebpts1(POLYNOMIAL_DEGREE + 1)[:, None]
    return logarithmic, centre, reach, shape.log_pressure(np.exp(points) if logarithmic else points)


def misfit(shape: AsperityLaw) -> float:
    """Return about the largest difference of ln(Phi) of a law from its polynomials, by their last coefficients."""
    # At most 2e-8 for laws with a formula, and 1e-5 or more for a table, at its points.
    with np.errstate(all="ignore"):  # what is not finite is no number here either
        *_, values = _around(shape, SCANNED_SEPARATIONS[SCANNED_SEPARATIONS > shape.lowest])
    return float(np.abs(chebyshev_form(values)[-3:]).max())


@lru_cache(maxsize=1)
def _to_powers() -> Array:
    """Matrix from values at Chebyshev points to the coefficients of the polynomial through them."""
    return np.asarray(np.linalg.inv(np.vander(chebyshev.chebpts1(POLYNOMIAL_DEGREE + 1), increasing=True)))
