r"""Contact pressure from the gap: the laws that the equations compose.

A law is a small frozen object with a name, the pressure, and its derivatives beside it.  Everything is in Hertz units
(gap in u_Hz, pressure in p_Hz).  The exponential law of the paper is the default, and written out for speed.  Any other law is
a *shape* without dimensions, :class:`stribeck._types.LawShape`, which the groups of a state carry; :class:`ScaledLaw` makes
the contact law of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from scipy.special import erf

from stribeck._types import Array, LawShape, Numbers, is_exponential
from stribeck.contact_laws.greenwood import GreenwoodTripp, GreenwoodWilliamson
from stribeck.contacts.line import Groups
from stribeck.quantities.units import InputError, show

NAMED: dict[str, LawShape | None] = {
    "exponential": None,
    "greenwood-williamson": GreenwoodWilliamson(),
    "greenwood-tripp": GreenwoodTripp(),
}
"""Laws that need no parameters beside alpha, beta and h_rms; None is the exponential one."""

SAFE_SEPARATION = 2.3
"""Separation at the largest pressure from which all gaps are positive at rest; that of the exponential law at load 0.01."""


class ContactLaw(Protocol):
    """What the equations ask of a contact law."""

    @property
    def name(self) -> str:
        """Name that outputs print."""

    @property
    def decay(self) -> Numbers:
        """The unit of separations, kappa [u_Hz]; 0 where there is no contact."""

    def local_decay(self, gap: Array) -> Numbers:
        """Return the length over which the pressure falls by a factor e, by its slope at the gap [u_Hz]."""

    @property
    def uniform(self) -> bool:
        """Whether that length is the same at all gaps."""

    def pressure(self, gap: Array) -> Array:
        """Return the contact pressure [p_Hz] at the gap [u_Hz]."""

    def log_pressure(self, gap: Array) -> Array:
        """Return the logarithm of the contact pressure over p_Hz, finite where the pressure itself underflows."""

    def slope(self, gap: Array, pressure: Array) -> Array:
        """Return the derivative of the contact pressure with respect to the gap, given that pressure [p_Hz/u_Hz]."""

    def load_derivative(self, gap: Array, pressure: Array) -> Array:
        """Return the derivative of the contact pressure with respect to the logarithm of the load group [p_Hz]."""

    def roughness_derivative(self, gap: Array, pressure: Array) -> Array:
        """Return the derivative of the contact pressure with respect to the logarithm of the roughness group [p_Hz]."""


@dataclass(frozen=True)
class NoContact:
    """The contact pressure of smooth surfaces: none."""

    name: str = "smooth"
    decay: Numbers = 0.0
    uniform: bool = True

    def local_decay(self, gap: Array) -> Numbers:
        """Return zero."""
        return self.decay

    def pressure(self, gap: Array) -> Array:
        """Return zeros."""
        return np.zeros_like(gap)

    def log_pressure(self, gap: Array) -> Array:
        """Return minus infinity."""
        return np.full_like(gap, -np.inf)

    def slope(self, gap: Array, pressure: Array) -> Array:
        """Return zeros."""
        return np.zeros_like(gap)

    load_derivative = slope
    roughness_derivative = slope


@dataclass(frozen=True)
class ExponentialLaw:
    r"""Contact pressure that falls exponentially with the gap.

    .. math:: p_c = \bar F_N^{-1/2} \exp(-h/\kappa), \qquad \kappa = \bar h_\mathrm{rms}/\bar F_N

    Parameters
    ----------
    load : float or ndarray
        Load group [-]; for states in rows a column of them.
    decay : float or ndarray
        Relative roughness kappa, the length of the decay [u_Hz], likewise.

    Notes
    -----
    The small-pressure limit of Persson's contact mechanics: good for gaps above about 0.4 h_rms; it lets the gap become
    negative instead of stiffening towards full contact.
    Source: [BP] Eq. (contact_pressure_dl).
    """

    load: Numbers
    decay: Numbers
    name: str = "exponential"
    uniform: bool = True

    def local_decay(self, gap: Array) -> Numbers:
        """Return kappa."""
        return self.decay

    def pressure(self, gap: Array) -> Array:
        """Return the contact pressure [p_Hz]."""
        return np.asarray(np.exp(self.log_pressure(gap)))

    def log_pressure(self, gap: Array) -> Array:
        """Return ``-h/kappa - ln(F)/2``."""
        return np.asarray(gap / -self.decay - 0.5 * np.log(self.load))

    def slope(self, gap: Array, pressure: Array) -> Array:
        """Return ``dp_c/dh`` = -p_c/kappa."""
        return pressure / -self.decay

    def load_derivative(self, gap: Array, pressure: Array) -> Array:
        """Return ``dp_c/dlnF`` = p_c (-1/2 - h/kappa), the roughness group held."""
        return -pressure * (0.5 + gap / self.decay)

    def roughness_derivative(self, gap: Array, pressure: Array) -> Array:
        """Return ``dp_c/dln h_rms`` = p_c h/kappa."""
        return pressure * (gap / self.decay)


@dataclass(frozen=True)
class ScaledLaw:
    r"""Contact law of any shape.

    .. math:: p_c = \bar F_N^{-1/2} \, \Phi(h/\kappa), \qquad \kappa = \bar h_\mathrm{rms}/\bar F_N

    Parameters
    ----------
    shape : LawShape
        Phi of the separation ``s = h/kappa``, which is alpha h/h_rms.
    load : float or ndarray
        Load group [-]; for states in rows a column of them.
    decay : float or ndarray
        Relative roughness kappa, the unit of separations [u_Hz], likewise.

    Notes
    -----
    With ``Phi = exp(-s)`` this is the exponential law.  Source: theory.md, section 8.
    """

    shape: LawShape
    load: Numbers
    decay: Numbers
    uniform: bool = False

    @property
    def name(self) -> str:
        """Name of the shape."""
        return self.shape.name

    def local_decay(self, gap: Array) -> Numbers:
        """Return ``-kappa/(d ln Phi/ds)``."""
        with np.errstate(divide="ignore"):
            return np.asarray(-self.decay / self.shape.log_slope(gap / self.decay))

    def pressure(self, gap: Array) -> Array:
        """Return the contact pressure [p_Hz]."""
        return np.asarray(np.exp(self.log_pressure(gap)))

    def log_pressure(self, gap: Array) -> Array:
        """Return ``ln Phi(h/kappa) - ln(F)/2``."""
        return np.asarray(self.shape.log_pressure(gap / self.decay) - 0.5 * np.log(self.load))

    def slope(self, gap: Array, pressure: Array) -> Array:
        """Return ``dp_c/dh`` = p_c (d ln Phi/ds)/kappa."""
        return np.asarray(pressure * self.shape.log_slope(gap / self.decay) / self.decay)

    def load_derivative(self, gap: Array, pressure: Array) -> Array:
        """Return ``dp_c/dlnF`` = p_c (-1/2 + s d ln Phi/ds), the roughness group held."""
        return np.asarray(pressure * (-0.5 + self._elasticity(gap)))

    def roughness_derivative(self, gap: Array, pressure: Array) -> Array:
        """Return ``dp_c/dln h_rms`` = -p_c s d ln Phi/ds."""
        return np.asarray(-pressure * self._elasticity(gap))

    def _elasticity(self, gap: Array) -> Array:
        s = gap / self.decay
        return np.asarray(s * self.shape.log_slope(s))


@dataclass(frozen=True)
class ShiftedShape:
    """A shape at separations that are all larger by ``shift``: at speed zero that only shifts the gap."""

    shape: LawShape
    shift: float

    @property
    def name(self) -> str:
        """Name of the shape."""
        return self.shape.name

    @property
    def parameters(self) -> dict[str, float | str]:
        """Those of the shape."""
        return self.shape.parameters

    @property
    def lowest(self) -> float:
        """That of the shape, shifted."""
        return self.shape.lowest + self.shift

    def log_pressure(self, separation: Array) -> Array:
        """Return ln(Phi) at ``s - shift``."""
        return self.shape.log_pressure(separation - self.shift)

    def log_slope(self, separation: Array) -> Array:
        """Return d ln(Phi)/ds at ``s - shift``."""
        return self.shape.log_slope(separation - self.shift)

    def notes(self, separation: float) -> tuple[str, ...]:
        """Return the notes of the shape at ``s - shift``."""
        return self.shape.notes(separation - self.shift)


@dataclass(frozen=True)
class BlendedShape:
    """A shape on the way from the exponential law, ``part`` = 0, to another, ``part`` = 1, in the logarithm of Phi."""

    shape: LawShape
    part: float
    name: str = "blended"

    @property
    def parameters(self) -> dict[str, float | str]:
        """Those of the shape."""
        return self.shape.parameters

    @property
    def lowest(self) -> float:
        """That of the shape."""
        return self.shape.lowest

    def log_pressure(self, separation: Array) -> Array:
        """Return ``-(1 - part) s + part ln(Phi)``."""
        return np.asarray(self.part * self.shape.log_pressure(separation) - (1 - self.part) * separation)

    def log_slope(self, separation: Array) -> Array:
        """Return its derivative."""
        return np.asarray(self.part * self.shape.log_slope(separation) - (1 - self.part))

    def notes(self, separation: float) -> tuple[str, ...]:
        """Return none: no result has this law."""
        return ()


def named_law(name: str) -> LawShape | None:
    """Return the law of a name; refuse a name that there is not, or of which more must be known."""
    if name not in NAMED:
        known = ", ".join(map(repr, NAMED))
        raise InputError(f"law = {show(name)}; names are {known}. A law of a surface or table needs a case file or an object.")
    return NAMED[name]


@dataclass(frozen=True)
class ExponentialShape:
    r"""The exponential law of a surface of which the spectrum is known, so that the real area of contact is too.

    .. math:: \Phi(s) = e^{-s}, \qquad A/A_0 = \operatorname{erf}(k \Phi)

    Parameters
    ----------
    area_slope : float
        k: beta times the square root of 2 over the rms slope of the surface [-].
    """

    area_slope: float
    name: str = "exponential"
    lowest: float = -np.inf

    @property
    def parameters(self) -> dict[str, float | str]:
        """The slope of the area."""
        return {"area_slope": self.area_slope}

    def log_pressure(self, separation: Array) -> Array:
        """Return ``-s``."""
        return -np.asarray(separation)

    def log_slope(self, separation: Array) -> Array:
        """Return -1."""
        return np.full_like(separation, -1.0)

    def area_fraction_at(self, pressure: Array) -> Array:
        """Return ``erf(k Phi)``, the real area of contact over the apparent one."""
        return np.asarray(erf(self.area_slope * pressure))

    def notes(self, separation: float) -> tuple[str, ...]:
        """Return none: those of the exponential law are those of the groups."""
        return ()


def contact_law(groups: Groups) -> ContactLaw:
    """Return the contact law of a state: that of its shape, exponential without one, none where the roughness is zero.

    Groups that are columns give the law of states in rows; none or all of these are smooth.
    """
    if not np.any(groups.roughness):
        return NoContact()
    if is_exponential(groups.law):
        return ExponentialLaw(groups.load, groups.relative_roughness)
    assert groups.law is not None
    return ScaledLaw(groups.law, groups.load, groups.relative_roughness)


def separation_at(shape: LawShape, log_pressure: float) -> float:
    """Return the separation at which ln(Phi) has a value, by bisection; minus or plus 1e6 where it has none between them."""
    low, high = max(-1e6, shape.lowest), 1e6
    for _ in range(100):
        middle = 0.5 * (low + high)
        with np.errstate(all="ignore"):
            above = float(shape.log_pressure(np.array([middle]))[0]) > log_pressure
        low, high = (middle, high) if above else (low, middle)
    return 0.5 * (low + high)


def lifted(groups: Groups) -> tuple[Groups, float]:
    r"""Return groups at rest with a shifted law, all gaps of which are positive, and by how much they are larger.

    .. math:: \Delta s = \max(0, s_0 - \Phi^{-1}(\bar F_N^{1/2}))

    Nowhere is the pressure much above that of the smooth contact, one: there the separation is s_0, :data:`SAFE_SEPARATION`.
    Laws that diverge at zero need no shift.
    """
    shape = groups.law
    if shape is None or is_exponential(shape) or shape.lowest > -np.inf or isinstance(shape, ShiftedShape):
        return groups, 0.0
    shift = max(0.0, SAFE_SEPARATION - separation_at(shape, 0.5 * float(np.log(groups.load))))
    if shift == 0.0:
        return groups, 0.0
    return replace(groups, law=ShiftedShape(shape, shift)), shift * float(groups.relative_roughness)
