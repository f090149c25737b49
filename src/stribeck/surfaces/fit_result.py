"""The fit of a self-affine spectrum: the spectrum, its standard errors, and intervals of alpha and beta.

Waves longer than a scan or shorter than a few of its points are not seen: an interval holds the values for all of them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.persson import GAMMA, exponential_limit
from stribeck.contact_laws.spectrum import SelfAffine
from stribeck.quantities.docstrings import Described
from stribeck.surfaces.measured_spectrum import line_density

__all__ = ["Estimate", "FitParameters", "SelfAffineFit", "central_differences"]

STANDARD_ERRORS_95 = 1.959964  # Standard errors to each side that hold 95 % of a normal distribution

# Wave numbers of the longest wave of the surface, over the lowest that was seen; the last is as good as none at all
LONGEST_WAVE_RATIOS = (1.0, 0.3, 0.1, 1e-3)

SHORTEST_WAVE = 1e-9  # Shortest wave of any surface: a few atoms [m]


@dataclass(frozen=True)
class Estimate(Described):
    """A number with its 95 % interval."""

    value: Annotated[float, "the number, for a surface without waves longer or shorter than those seen"]
    low: Annotated[float, "lower end; 0 for a positive number that is only bounded from above"]
    high: Annotated[float, "upper end"]

    @property
    def interval(self) -> str:
        """The interval in words, such as ``"1.76 to 1.83"``."""
        return f"at most {self.high:.3g}" if self.low == 0 else f"{self.low:.3g} to {self.high:.3g}"

    @property
    def relative_error(self) -> float | None:
        """Standard error over the value, of which 1.96 reach to the farther end of the interval; None without a lower end."""
        if self.low == 0:
            return None
        return math.log(max(self.high / self.value, self.value / self.low)) / STANDARD_ERRORS_95


@dataclass(frozen=True, eq=False)
class FitParameters:
    """Parameters of a fit with their covariance, and the surface that belongs to them."""

    # Logarithm of the spectrum at `centre`, Hurst exponent, logarithms of the roll-off and of the noise, if there are such,
    # and of q0 and q1
    theta: Array
    covariance: Array  # Of `theta`; zero for a longest wave that was not seen
    centre: float  # Logarithm of the wave number in the middle of the fit
    is_line: bool  # Whether the spectrum is that along a line
    roll_off: bool  # Whether the spectrum shows a roll-off
    q0_found: bool  # Whether it shows its longest wave
    q1_found: bool  # Whether it shows its shortest wave

    def physical(self, theta: Array, corner: float = 1.0, lowest: float = 1.0) -> Array:
        """Return ln h_rms, H, ln q_r, ln q_0 and ln q_1, with roll-off and q_0 moved by factors to longer waves."""
        H, q1 = float(theta[1]), float(theta[-1])
        q_r = (max(theta[2], theta[-2]) if self.roll_off else theta[-2]) + math.log(corner)
        q0 = (theta[-2] if self.roll_off else q_r) + math.log(lowest)
        shape = SelfAffine(1.0, math.exp(q0), math.exp(q1), H, math.exp(q_r))
        if self.is_line:
            level = float(line_density(np.array(math.exp(self.centre)), shape))
        else:
            level = float(shape.spectrum.density[0]) * math.exp(-2 * (1 + H) * max(self.centre - q_r, 0.0))
        return np.array([0.5 * (theta[0] - math.log(level)), H, q_r, q0, q1])

    def surface(self, theta: Array, corner: float = 1.0, lowest: float = 1.0, finest: bool = False) -> SelfAffine:
        """Return the surface of the parameters, optionally with longer waves and all shorter ones."""
        if finest:
            theta = np.array([*theta[:-1], max(theta[-1], math.log(2 * math.pi / SHORTEST_WAVE))])
        log_h, H, q_r, q0, q1 = map(float, self.physical(theta, corner, lowest))
        return SelfAffine(math.exp(log_h), math.exp(q0), math.exp(q1), H, math.exp(max(q_r, q0)))

    @property
    def admissible_extensions(self) -> list[tuple[float, float, bool]]:
        """Factors on roll-off and q_0, and whether shorter waves go on, of surfaces that the scan does not exclude."""
        shorter = (False,) if self.q1_found else (False, True)
        if self.q0_found:
            longer = [(1.0, 1.0)]
        else:
            # A power law that is not seen to end may end, or become a plateau, anywhere beyond the scan.
            longer = (
                [(1.0, factor) for factor in LONGEST_WAVE_RATIOS]
                if self.roll_off
                else list(itertools.product(LONGEST_WAVE_RATIOS, LONGEST_WAVE_RATIOS))
            )
        return [(*factors, finest) for factors in longer for finest in shorter]


@dataclass(frozen=True, eq=False)
class SelfAffineFit(Described):
    """Self-affine spectrum that fits a measured one."""

    roughness: Annotated[SelfAffine, "the spectrum; its ends are cut-offs of the surface if found, else those of the scan"]
    errors: Annotated[dict[str, float], "standard errors of h_rms [m], q0, roll_off, q1 [1/m] and hurst [-], if found"]
    found: Annotated[tuple[str, ...], "which of roll_off, q0, q1 and noise the spectrum shows"]
    noise: Annotated[float, "spectrum of the white noise, as that of the measurement; 0 where none was found"]
    deviance: Annotated[float, "deviance over its expectation: near one where the model holds", "1"]
    band: Annotated[tuple[float, float], "wave numbers that were fitted", "1/m"]
    _parameters: FitParameters = field(repr=False)

    def exponential_limit(self, gamma: float = GAMMA) -> tuple[Estimate, Estimate]:
        """Return alpha and beta of the contact law, each with its 95 % interval.

        Parameters
        ----------
        gamma : float
            Reduction of the elastic energy [-].

        Returns
        -------
        tuple of Estimate
            alpha and beta [-].

        Notes
        -----
        The interval is that of a profile over what both ends of the spectrum hide: from the smallest of ``value - 1.96
        standard errors`` to the largest of ``value + 1.96 standard errors``, over longest waves from the scan on, and with
        the power law to its end at the shortest wave seen or at 1 nm.  If neither a roll-off nor the longest wave was seen,
        ``beta`` has no lower bound, and its interval begins at 0.  How often the intervals hold the truth is in
        docs/surfaces.md, from ``benchmarks/surface_errors.py``.
        """
        known = self._parameters
        best = np.log(exponential_limit(known.surface(known.theta), gamma))
        hidden = known.admissible_extensions
        profile = np.array([np.log(exponential_limit(known.surface(known.theta, *each), gamma)) for each in hidden])
        low, high = np.empty(2), np.empty(2)
        for i in (0, 1):
            for ends, at, sign in ((low, profile[:, i].argmin(), -1), (high, profile[:, i].argmax(), 1)):

                def limit(theta: Array, each: tuple[float, float, bool] = hidden[at]) -> Array:
                    return np.log(exponential_limit(known.surface(theta, *each), gamma))

                turn = central_differences(limit, known.theta)[i]
                ends[i] = math.exp(
                    profile[at, i] + sign * STANDARD_ERRORS_95 * math.sqrt(float(turn @ known.covariance @ turn))
                )
        if not (known.q0_found or known.roll_off):
            low[1] = 0.0
        alpha, beta = (Estimate(*map(float, row)) for row in zip(np.exp(best), low, high, strict=True))
        return alpha, beta

    @property
    def beta_of_shorter_waves(self) -> float:
        """Largest beta over the value, if the power law goes on to shorter waves than were seen."""
        known = self._parameters
        ends = (exponential_limit(known.surface(known.theta, finest=finest))[1] for finest in (False, not known.q1_found))
        seen, all_waves = ends
        return all_waves / seen

    def at(self, wavenumber: Array, *, is_line: bool = False, noise: bool = True) -> Array:
        """Return the fitted spectrum, as a map or a line shows it.

        Parameters
        ----------
        wavenumber : ndarray
            Wave numbers [1/m].
        is_line : bool
            Whether the spectrum along a line is wanted.
        noise : bool
            Whether the noise is part of it.

        Returns
        -------
        ndarray
            Spectrum [m^4; m^3 along a line].
        """
        q = np.asarray(wavenumber, dtype=float)
        clean = line_density(q, self.roughness) if is_line else self.roughness.spectrum.at(q)
        return clean + (self.noise if noise else 0.0)


def central_differences(function: Callable[[Array], Array], x: Array) -> Array:
    """Return central differences of a smooth function of parameters of order one."""
    columns = []
    for i in range(x.size):
        step = np.zeros(x.size)
        step[i] = 1e-5
        columns.append((function(x + step) - function(x - step)) / 2e-5)
    return np.stack(columns, axis=1)
