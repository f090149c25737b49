r"""Contact laws of any shape: scaled to a load and a roughness, shifted, continued, found by name.

A law is a small frozen object with a name and the pressure, of which derivatives follow.  Everything is in Hertz units
(gap in u_Hz, pressure in p_Hz).  A *shape* is the law without dimensions, :class:`stribeck.contact_laws.law.AsperityLaw`,
which the groups of a state carry; :class:`ScaledLaw` makes the contact law of it.

Laws are known as functions of real numbers, by tables and splines too.  Around each separation of a state, where series of it
are made, such a law is the polynomial through its values nearby (:class:`ContinuedLaw`), which has a series whatever it is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from stribeck._types import Array
from stribeck.contact_laws.exponential import ExponentialLaw, NoContact
from stribeck.contact_laws.law import AsperityLaw, ContactLaw, as_asperity_law
from stribeck.numerics.hermite import chebyshev_form
from stribeck.numerics.series import polynomial
from stribeck.numerics.trace import Trace, mapped
from stribeck.quantities.registry import laws_of
from stribeck.quantities.schema import made_of
from stribeck.quantities.units import InputError, show

# Laws by their names; None is the exponential law.
NAMED_LAWS: dict[str, Any] = {"exponential": None, **laws_of("stribeck.contact_laws", AsperityLaw)}

POLYNOMIAL_DEGREE = 10  # Degree of the polynomial around a separation.

# Half-width in ln(s) of a polynomial for laws of positive separations: Persson's law leaves it by 1e-8 on twice this width,
# and on a narrower one rounding counts.
LOG_HALF_WIDTH = 0.25

RELATIVE_HALF_WIDTH = 0.2  # Half-width of a polynomial over the separation, for laws of any separation.
MIN_HALF_WIDTH = 0.2  # Least half-width of a polynomial, as a separation.

# Separations around which a law is compared with its polynomials, whose intervals overlap.
SCANNED_SEPARATIONS = np.concatenate([np.linspace(-3.0, 0.0, 16), np.geomspace(1e-3, 50.0, 64)])


@dataclass(frozen=True)
class ScaledLaw:
    r"""Contact law of any shape.

    .. math:: p_c = \bar F_N^{-e} \, \Phi(h/\kappa), \qquad \kappa = \bar h_\mathrm{rms}/\bar F_N^{2e}

    with e = 1/2 on the line and 1/3 on the ball.
    """

    shape: AsperityLaw  # Phi of the separation `s = h/kappa`, which is alpha h/h_rms
    load: Any  # Load group [-]; for stacked states a column of them
    decay_length: Any  # Relative roughness kappa, the unit of separations [u_Hz], likewise
    pressure_exponent: float = 0.5  # e
    constant_decay: bool = False

    @property
    def name(self) -> str:
        """Name of the shape."""
        return self.shape.name

    def pressure(self, gap: Any) -> Any:
        """Return the contact pressure [p_Hz]."""
        return np.exp(self.log_pressure(gap))

    def log_pressure(self, gap: Any) -> Any:
        """Return ``ln Phi(h/kappa) - e ln(F)``."""
        return mapped(self.shape.log_pressure, gap / self.decay_length) - self.pressure_exponent * np.log(self.load)


def by_group(law: ContactLaw, name: str) -> ContactLaw:
    """Return a law whose pressures are traced by the logarithm of the load or the roughness group, the other one held."""
    if isinstance(law, NoContact):
        return law
    assert isinstance(law, ExponentialLaw | ScaledLaw)
    load, kappa = np.asarray(law.load), np.asarray(law.decay_length)
    if name == "roughness":
        return replace(law, decay_length=Trace.number(name, kappa, kappa))
    by_load = -2 * law.pressure_exponent * kappa
    return replace(law, load=Trace.number(name, load, load), decay_length=Trace.number(name, kappa, by_load))


@dataclass(frozen=True)
class ShiftedLaw:
    """A shape at separations that are all larger by ``shift``: at speed zero that only shifts the gap."""

    shape: AsperityLaw
    shift: float

    @property
    def name(self) -> str:
        """Name of the shape."""
        return self.shape.name

    @property
    def parameters(self) -> dict[str, float | str]:
        """Parameters of the shape."""
        return self.shape.parameters

    @property
    def lowest(self) -> float:
        """Lowest separation of the shape, shifted."""
        return self.shape.lowest + self.shift

    def log_pressure(self, separation: Any) -> Any:
        """Return ln(Phi) at ``s - shift``."""
        return self.shape.log_pressure(separation - self.shift)

    def notes(self, separation: float) -> tuple[str, ...]:
        """Return the notes of the shape at ``s - shift``."""
        return self.shape.notes(separation - self.shift)


def law_of(law: Any) -> AsperityLaw | None:
    """Return a contact law, given itself or by its name; None is the exponential one."""
    return named_law(law) if isinstance(law, str) else as_asperity_law(law)


def named_law(name: str, **numbers: str | float) -> AsperityLaw | None:
    """Return the law of a name and of its numbers; refuse unknown names, and laws that need more than that."""
    if name not in NAMED_LAWS:
        known = ", ".join(map(repr, NAMED_LAWS))
        raise InputError(f"law = {show(name)}; names are {known}. A law of a surface or table needs a case file or an object.")
    law = made_of(NAMED_LAWS[name], f"law = {name!r}", numbers)
    return None if law is None else as_asperity_law(law)


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
