r"""Contact pressure from the gap: the laws that the equations compose.

A law is a small frozen object with a name, the pressure, and its derivatives beside it.  Everything is in Hertz units
(gap in u_Hz, pressure in p_Hz).  The exponential law of the paper is the first; another law is one more class with the
methods of :class:`ContactLaw`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ._types import Array, Numbers
from .parameters import Groups


class ContactLaw(Protocol):
    """What the equations ask of a contact law."""

    @property
    def name(self) -> str:
        """Name that outputs print."""

    @property
    def decay(self) -> Numbers:
        """Length over which the pressure falls by a factor e at most [u_Hz]; 0 where there is no contact."""

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


def contact_law(groups: Groups) -> ContactLaw:
    """Return the contact law of the paper: exponential, or none where the roughness is zero.

    Groups that are columns give the law of states in rows; none or all of these are smooth.
    """
    if not np.any(groups.roughness):
        return NoContact()
    return ExponentialLaw(groups.load, groups.relative_roughness)
