r"""Parameters of the heights of a scan as instruments print them: Sa, Sku and Sdq of maps, Ra, Rku and Rdq of profiles.

.. math::

    S_a = \langle |z| \rangle, \quad S_{ku} = \frac{\langle z^4 \rangle}{\langle z^2 \rangle^2}, \quad
    S_{dq}^2 = \langle |\nabla z|^2 \rangle

about the removed trend, without a filter of waves (ISO 25178-2, ISO 4287); the slope is between neighbouring points.
"""

from __future__ import annotations

import math

import numpy as np

from stribeck._types import Array
from stribeck.quantities.number import Number
from stribeck.surfaces.topography import Topography

__all__ = ["height_numbers", "moment"]


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
