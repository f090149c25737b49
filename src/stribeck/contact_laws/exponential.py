r"""The exponential contact law of the article, written out for speed, and that of smooth surfaces: no contact pressure.

Everything is in Hertz units: gap in u_Hz, pressure in p_Hz.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from stribeck._types import Array, Numbers


@dataclass(frozen=True)
class NoContact:
    """The contact pressure of smooth surfaces: none."""

    name: str = "smooth"
    decay_length: Numbers = 0.0
    constant_decay: bool = True

    def pressure(self, gap: Any) -> Any:
        """Return zeros."""
        return 0.0 * gap

    def log_pressure(self, gap: Any) -> Any:
        """Return minus infinity."""
        return np.full_like(gap, -np.inf)


@dataclass(frozen=True)
class ExponentialLaw:
    r"""Contact pressure that falls exponentially with the gap.

    .. math:: p_c = \bar F_N^{-e} \exp(-h/\kappa), \qquad \kappa = \bar h_\mathrm{rms}/\bar F_N^{2e}

    with e = 1/2 on the line and 1/3 on the ball.
    """

    load: Any  # Load group [-]; for stacked states a column of them
    decay_length: Any  # Relative roughness kappa, the length of the decay [u_Hz], likewise
    pressure_exponent: float = 0.5  # e
    name: str = "exponential"
    constant_decay: bool = True

    def pressure(self, gap: Any) -> Any:
        """Return the contact pressure [p_Hz]."""
        return np.exp(self.log_pressure(gap))

    def log_pressure(self, gap: Any) -> Any:
        """Return ``-h/kappa - e ln(F)``."""
        return gap / -self.decay_length - self.pressure_exponent * np.log(self.load)


@dataclass(frozen=True)
class SpectralExponential:
    r"""The exponential law of a surface of which the spectrum is known, so that the real area of contact is too.

    .. math:: \Phi(s) = e^{-s}, \qquad A/A_0 = \operatorname{erf}(k \Phi)
    """

    area_slope: float  # k: beta times the square root of 2 over the rms slope of the surface [-]
    name: str = "exponential"
    lowest: float = -np.inf

    @property
    def parameters(self) -> dict[str, float | str]:
        """The slope of the area."""
        return {"area_slope": self.area_slope}

    def log_pressure(self, separation: Any) -> Any:
        """Return ``-s``."""
        return -separation

    def area_fraction_at(self, pressure: Array) -> Array:
        """Return ``erf(k Phi)``, the real area of contact over the apparent one."""
        return np.asarray(scipy.special.erf(self.area_slope * pressure))

    def notes(self, separation: float) -> tuple[str, ...]:
        """Return none: those of the exponential law are those of the groups."""
        return ()
