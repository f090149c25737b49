"""Tilt and curvature of a scan: the form of the body, found by least squares and removed from its roughness."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Annotated, Literal, get_args

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.spectrum import SelfAffine
from stribeck.quantities.docstrings import Described
from stribeck.quantities.units import InputError, checked_kind, show
from stribeck.surfaces.topography import Topography

Trend = Literal["none", "mean", "tilt", "curvature"]
TRENDS = get_args(Trend)


@dataclass(frozen=True)
class Form(Described):
    """What was taken away from the heights."""

    trend: Annotated[Trend, "what was fitted"]
    tilt: Annotated[tuple[float, ...], "slope along each axis at the middle of the scan", "1"] = ()
    curvatures: Annotated[tuple[float, ...], "principal curvatures, the strongest first, if fitted", "1/m"] = ()
    direction: Annotated[float, "angle of the strongest curvature to the first axis", "rad"] = 0.0
    _weights: Array = field(default_factory=lambda: np.empty(0), repr=False, compare=False)

    @property
    def radius(self) -> float | None:
        """Radius of the strongest curvature [m]; None where no curvature was fitted."""
        return 1 / abs(self.curvatures[0]) if self.curvatures and self.curvatures[0] else None

    def radius_error(self, roughness: SelfAffine, topography: Topography) -> float | None:
        r"""Return the standard error of the radius that the roughness causes.

        .. math:: \frac{\delta R}{R} = R \left[\sum_k |\hat w_k|^2 C(q_k)\, \Delta q_x \Delta q_y\right]^{1/2}

        Parameters
        ----------
        roughness : SelfAffine
            Spectrum of the roughness, flat below its roll-off down to the length of the scan.
        topography : Topography
            The scan.

        Returns
        -------
        float or None
            Standard error [m]; None where no curvature was fitted.

        Notes
        -----
        The curvature is a sum of heights with weights w, so its variance is that of the roughness under their transform.
        Roughness longer than the scan cannot be distinguished from curvature and is not in this error.
        """
        if self.radius is None:
            return None
        steps = topography.spacing
        table, lowest = roughness.spectrum, 2 * math.pi / max(topography.size)
        if topography.is_line:
            q = np.abs(2 * math.pi * np.fft.fftfreq(self._weights.size, steps[0]))
            from stribeck.surfaces.measured_spectrum import line_density

            density, cell = line_density(np.maximum(q, lowest), roughness), 2 * math.pi / topography.size[0]
        else:
            axes = [2 * math.pi * np.fft.fftfreq(n, step) for n, step in zip(self._weights.shape, steps, strict=True)]
            q = np.hypot(*np.meshgrid(*axes, indexing="ij"))
            density = table.at(np.maximum(q, table.lowest))
            cell = (2 * math.pi) ** 2 / math.prod(topography.size)
        transform = np.abs(np.fft.fftn(self._weights)) ** 2
        variance = float(np.sum((transform * density)[q > 0])) * cell
        return math.sqrt(variance) * self.radius**2


def detrended(topography: Topography, trend: Trend = "curvature") -> tuple[Topography, Form]:
    r"""Return the heights without their trend, and the trend.

    .. math:: z = a + b \cdot x + \tfrac12 x^T K x

    by least squares; the principal curvatures are the eigenvalues of :math:`K`, on a cylinder one of them :math:`\pm1/R`.

    Parameters
    ----------
    topography : Topography
        The heights; points without one are left out of the fit.
    trend : {"none", "mean", "tilt", "curvature"}
        What to take away; each includes those before it.

    Returns
    -------
    tuple of Topography and Form
        Roughness about the trend, and what the trend is.

    Raises
    ------
    InputError
        Where the trend is unknown, or nothing is left without it.
    """
    if not isinstance(trend, str) or trend not in TRENDS:
        raise InputError(f"detrend = {show(trend)} is not known; choose one of {', '.join(TRENDS)}.")
    if trend == "none":
        return topography, Form("none")
    z = checked_kind("topography", topography, Topography, "a Topography, as of read_topography(path)").heights
    good = ~np.isnan(z)
    # Coordinates from -1 to 1 about the middle, so that the normal equations are well conditioned.
    half = [0.5 * (n - 1) * step for n, step in zip(z.shape, topography.spacing, strict=True)]
    grids = np.meshgrid(*(np.linspace(-1, 1, n) for n in z.shape), indexing="ij")
    columns = [np.ones(z.shape)]
    if trend != "mean":
        columns += grids
    if trend == "curvature":
        columns += [grids[i] * grids[j] for i in range(z.ndim) for j in range(i, z.ndim)]
    A = np.stack([column[good] for column in columns], axis=1)
    inverse = np.linalg.inv(A.T @ A)
    coefficients = inverse @ (A.T @ z[good])
    # Once more on what is left, as the trend may be a million times larger than the roughness.
    coefficients = coefficients + inverse @ (A.T @ (z[good] - A @ coefficients))
    rest = z - sum(c * column for c, column in zip(coefficients, columns, strict=True))
    span = float(np.nanmax(np.abs(z)))
    if not np.nanmax(np.abs(rest)) > 1e-13 * span:
        raise InputError(f"{topography.source}: nothing is left after removing the {trend}; the scan has no roughness.")
    tilt = tuple(float(c) / h for c, h in zip(coefficients[1 : 1 + z.ndim], half, strict=False)) if trend != "mean" else ()
    flat = replace(topography, heights=rest)
    if trend != "curvature":
        return flat, Form(trend, tilt)
    K = np.zeros((z.ndim, z.ndim))
    places = [(i, j) for i in range(z.ndim) for j in range(i, z.ndim)]
    for (i, j), c in zip(places, coefficients[1 + z.ndim :], strict=True):
        value = c / (half[i] * half[j])
        K[i, j] += value
        K[j, i] += value
    values, vectors = np.linalg.eigh(K)
    order = np.argsort(-np.abs(values))
    v = vectors[:, order[0]]
    # The curvature along v is a sum of heights; these are its weights.
    combination = np.zeros(len(coefficients))
    for place, (i, j) in enumerate(places):
        combination[1 + z.ndim + place] = 2 * v[i] * v[j] / (half[i] * half[j])
    weights = np.zeros(z.shape)
    weights[good] = A @ (inverse @ combination)
    angle = math.atan2(float(v[1]), float(v[0])) % math.pi if z.ndim == 2 else 0.0
    shape = Form(trend, tilt, tuple(float(values[i]) for i in order), angle, weights)
    return flat, shape
