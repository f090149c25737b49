r"""Parameters of the heights of a scan, and how it departs from the theory's surface, which is isotropic and Gaussian.

.. math::

    S_a = \langle |z| \rangle, \quad S_{ku} = \frac{\langle z^4 \rangle}{\langle z^2 \rangle^2}, \quad
    S_{dq}^2 = \langle |\nabla z|^2 \rangle, \quad A = \frac{\langle C\, e^{2 i \theta} \rangle}{\langle C \rangle}

about the removed trend, without a filter of waves (ISO 25178-2, ISO 4287); the slope is between neighbouring points.  A is
zero on average for an isotropic surface, with a mean square of one over the number of modes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from stribeck._types import Array
from stribeck.quantities.docstrings import Described
from stribeck.quantities.formats import Number, format_si
from stribeck.surfaces.measured_spectrum import MeasuredSpectrum
from stribeck.surfaces.topography import Topography

MIN_SIGNIFICANCE = 9.0  # ``n |A|^2`` above which a texture is not chance: exp(-9), once in 8000 isotropic surfaces

ANISOTROPY_NOTE_RATIO = 1.5  # Aspect ratio of features above which a note says that the surface is anisotropic

MAX_ASPECT_RATIO = 1e4  # Largest aspect ratio that can be distinguished from an endless groove

SKEWNESS_NOTE = 0.3  # Skewness above which a note says that the heights are not Gaussian, if it is also 3 standard errors

MAX_SCAN_LENGTH = 1.0  # Longest scan of instruments [m]
MIN_SCAN_LENGTH = 1e-8  # Shortest scan of instruments [m]

MAX_RMS_HEIGHT = 1e-3  # Largest rms height of roughness that instruments meet [m]
MIN_RMS_HEIGHT = 1e-11  # Smallest rms height of roughness that instruments meet [m]

MAX_RMS_SLOPE = 3.0  # Rms slope between neighbouring points above which the units of heights and positions do not fit together


@dataclass(frozen=True)
class Departures(Described):
    """Texture and skewness of a scan."""

    aspect_ratio: Annotated[float | None, "length of features along the texture over that across it; None for a line"]
    direction: Annotated[float | None, "angle of the texture to the first axis, 0 to pi; None if it is not significant", "rad"]
    skewness: Annotated[float, "third moment of the heights over the cube of their rms; 0 if Gaussian", "1"]
    skewness_error: Annotated[float, "its standard error for Gaussian heights with the correlation of the scan", "1"]


def moment(heights: Array, order: int) -> tuple[float, float]:
    """Return skewness (3) or kurtosis (4) of heights, and its standard error for Gaussian ones correlated as these are."""
    z = heights - heights.mean()
    rms = float(z.std())
    # Autocorrelation: the scatter of moments of correlated Gaussian heights is a sum of its powers.
    rho = np.fft.ifftn(np.abs(np.fft.fftn(z)) ** 2).real / (z.size * rms**2)
    variance = math.factorial(order) * float(np.sum(rho**order)) / z.size
    return float(np.mean((z / rms) ** order)), math.sqrt(max(variance, 0.0))


def height_numbers(topography: Topography) -> tuple[Number, ...]:
    """Return the parameters of the heights, those of moments with the error that a Gaussian surface has."""
    z, letter = topography.heights - topography.heights.mean(), "R" if topography.is_line else "S"
    steps = [np.diff(z, axis=axis) / step for axis, step in enumerate(topography.spacing)]
    slope = math.sqrt(sum(float(np.mean(each**2)) for each in steps))
    return (
        Number("mean_deviation", f"mean deviation {letter}a", "mean deviation of the heights of the scan about its trend",
               float(np.mean(np.abs(z))), unit="m", dimension="length"),
        Number("kurtosis", f"kurtosis {letter}ku", "kurtosis of the heights; 3 if Gaussian", *moment(topography.heights, 4)),
        Number("scan_rms_slope", f"rms slope {letter}dq between points", "rms slope of the scan between neighbouring points",
               slope),
    )  # fmt: skip


def departures(topography: Topography, measured: MeasuredSpectrum, hurst: float) -> Departures:
    r"""Return texture and skewness of a scan."""
    skewness, error = moment(topography.heights, 3)
    if measured.is_line:
        return Departures(None, None, skewness, error)
    strength, modes = abs(measured.texture), float(measured.modes[measured.reliable].sum())
    if modes * strength**2 < MIN_SIGNIFICANCE:
        return Departures(1.0, None, skewness, error)
    # Long features along x have their waves, and their power, across x.
    direction = (0.5 * float(np.angle(measured.texture)) + 0.5 * math.pi) % math.pi
    return Departures(_aspect_ratio(strength, hurst), direction, skewness, error)


def departure_notes(topography: Topography, found: Departures) -> list[str]:
    """Return a sentence for each departure that spoils the numbers."""
    notes = _size_notes(topography)
    if found.aspect_ratio is not None and found.direction is not None and found.aspect_ratio > ANISOTROPY_NOTE_RATIO:
        times = f"{found.aspect_ratio:.2g} times" if found.aspect_ratio < MAX_ASPECT_RATIO else "many times"
        notes.append(
            f"The surface is anisotropic: features are about {times} longer at {math.degrees(found.direction):.0f} degrees to "
            "the first axis than across it. All numbers are averages over directions, and the errors do not include what this "
            "changes; beta may be off by more than its interval."
        )
    if abs(found.skewness) > max(SKEWNESS_NOTE, 3 * found.skewness_error):
        kind = "plateaus with valleys" if found.skewness < 0 else "peaks on a plain"
        notes.append(
            f"The heights are not Gaussian: their skewness is {found.skewness:.2f} +- {found.skewness_error:.1g}, as of "
            f"{kind}. Persson's theory assumes Gaussian heights, and the error of h_rms does too; a contact law "
            "measured or computed for this surface (law = 'table') is safer."
        )
    return notes


def _size_notes(topography: Topography) -> list[str]:
    notes = []
    longest, height = max(topography.size), float(topography.heights.std())
    if not MIN_SCAN_LENGTH <= longest <= MAX_SCAN_LENGTH:
        than = "longer" if longest > MAX_SCAN_LENGTH else "shorter"
        notes.append(
            f"The scan is {format_si(longest, 'length')} long, {than} than any instrument measures; "
            "check the unit of positions."
        )
    if not MIN_RMS_HEIGHT <= height <= MAX_RMS_HEIGHT:
        notes.append(f"The rms height is {format_si(height, 'length')}, which is not plausible; check the unit of heights.")
    steps = [np.diff(topography.heights, axis=i) / step for i, step in enumerate(topography.spacing)]
    slope = max(float(np.sqrt(np.mean(step**2))) for step in steps)
    if slope > MAX_RMS_SLOPE:
        notes.append(
            f"The rms slope between neighbouring points is {slope:.2g}, steeper than instruments follow; check that heights "
            "and positions have the declared units."
        )
    return notes


def _aspect_ratio(strength: float, hurst: float) -> float:
    """Return the stretch of a self-affine surface whose spectrum has the second harmonic ``strength``."""
    from scipy.optimize import brentq

    angle = (np.arange(20_000) + 0.5) * (math.pi / 20_000)

    def harmonic(log_ratio: float) -> float:
        ratio = math.exp(log_ratio)
        log_power = -(1 + hurst) * np.log(ratio * np.cos(angle) ** 2 + np.sin(angle) ** 2 / ratio)
        power = np.exp(log_power - log_power.max())
        return float(-np.sum(power * np.cos(2 * angle)) / np.sum(power)) - strength

    most = math.log(MAX_ASPECT_RATIO)
    return math.exp(brentq(harmonic, 0.0, most)) if harmonic(most) > 0 else MAX_ASPECT_RATIO
