"""The isotropic power spectrum of measured heights, from a map or from a line."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from scipy import special

from stribeck._types import Array, Flags
from stribeck.contact_laws.spectrum import SelfAffine, positive
from stribeck.quantities.results import Shown
from stribeck.quantities.units import InputError, checked_kind, show
from stribeck.surfaces.topography import Topography

Window = Literal["hann", "none"]

MIN_WAVES_IN_SCAN = 2.5  # Fewest waves in the scan that are used: detrending and window take power from longer ones

MIN_POINTS_PER_WAVE = 4.0  # Fewest points in a wave that is used: power beyond the grid folds onto shorter ones

MAX_RINGS_PER_DECADE = 24  # Most rings in a decade of wave numbers

# Wave numbers that stand for those within a ring of a map when a model is averaged over it; along a line 2 do
WAVES_PER_RING = 8


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredSpectrum(Shown):
    """Power spectrum of a scan, averaged over rings of wave numbers."""

    wavenumber: Annotated[Array, "wave number of each ring, the geometric mean of those in it", "1/m"]
    density: Annotated[Array, "mean of the periodogram", "m^4; m^3 of lines"]
    modes: Annotated[Array, "effective number of independent modes in each ring; one over its root is the relative error"]
    inner: Annotated[Array, "wave numbers over which a model is averaged, a row for each ring", "1/m"]
    is_line: Annotated[bool, "whether it is that of a line"]
    lowest: Annotated[float, "wave number from which the spectrum is reliable", "1/m"]
    highest: Annotated[float, "wave number up to which it is", "1/m"]
    lowest_reason: Annotated[str, "what sets the first"]
    highest_reason: Annotated[str, "what sets the second"]
    mean_square: Annotated[float, "mean square of the heights under the window", "m^2"]
    texture: Annotated[complex, "second angular harmonic of the spectrum over its ring; 0 for a line", "1"] = 0.0

    @property
    def reliable(self) -> Flags:
        """Flags of the rings that lie within the reliable wave numbers."""
        return np.asarray((self.wavenumber >= self.lowest) & (self.wavenumber <= self.highest))


def power_spectrum(
    topography: Topography,
    window: Window = "hann",
    *,
    resolution: float | None = None,
) -> MeasuredSpectrum:
    r"""Return the isotropic power spectrum of a scan, averaged over rings of wave vectors.

    .. math::

        C(q) = \frac{(\Delta x\, \Delta y)^2}{(2\pi)^2 A \langle w^2 \rangle} \left|\sum w\, h\, e^{-i q \cdot x}\right|^2,
        \qquad h_\mathrm{rms}^2 = \sum_k C(q_k)\, \Delta q_x \Delta q_y

    of a map; a line gives :math:`C_1(q) = \int_{-\infty}^{\infty} C\left((q^2 + k^2)^{1/2}\right) \mathrm{d}k`.

    Parameters
    ----------
    topography : Topography
        Heights without trend and without missing points.
    window : {"hann", "none"}
        Weight w of the heights; ``"none"`` is for periodic ones.
    resolution : float, optional
        Shortest wavelength that the instrument resolves [m]; that of the topography by default.

    Returns
    -------
    MeasuredSpectrum
        The spectrum with its reliable range.

    Raises
    ------
    InputError
        Where points are missing, the window is unknown, or nothing of the spectrum is reliable.

    Notes
    -----
    Reliable are wavelengths of at most 1/2.5 of the scan's shorter side, and at least 4 points and the resolution.
    The sum of all modes is the mean square of the windowed heights to rounding (``test_surfaces.py``).

    Source: [Persson05]; [Jacobs17] on windows and reliability.
    """
    checked_kind("topography", topography, Topography, "a Topography, as of read_topography(path)")
    if resolution is not None:
        resolution = positive("resolution", resolution)
    if topography.missing:
        raise InputError(f"{topography.source}: {topography.missing} points are missing; fill them first with repaired().")
    z = topography.heights
    weight = _window(window, z.shape)
    square = float(np.mean(weight**2))
    # The window turns a mean into power at long wavelengths, so its own mean goes first.
    z = (z - np.sum(weight * z) / np.sum(weight)) * weight
    area = math.prod(topography.size)
    axes = [2 * math.pi * np.fft.fftfreq(n, step) for n, step in zip(z.shape, topography.spacing, strict=True)]
    power = np.abs(np.fft.fftn(z)) ** 2 * (math.prod(topography.spacing) ** 2 / ((2 * math.pi) ** z.ndim * area * square))
    components = np.meshgrid(*axes, indexing="ij")
    q = np.sqrt(sum(component**2 for component in components))
    fundamental = 2 * math.pi / min(topography.size)
    largest = math.pi / max(topography.spacing)
    edges = _edges(fundamental, largest)
    keep = (q >= edges[0]) & (q < edges[-1])
    radius, power = q[keep], power[keep]
    order = np.argsort(radius, kind="stable")
    radius, power = radius[order], power[order]
    starts = np.unique(np.searchsorted(radius, edges[:-1]))
    starts = starts[starts < radius.size]  # the last ring may hold no wave
    counts = np.diff(np.append(starts, radius.size))
    density = np.add.reduceat(power, starts) / counts
    wavenumber = np.exp(np.add.reduceat(np.log(radius), starts) / counts)
    inner = WAVES_PER_RING if not topography.is_line else 2
    places = starts[:, None] + np.floor((np.arange(inner) + 0.5) / inner * counts[:, None]).astype(int)
    # Heights are real: half of the modes repeat the other half.  The window binds neighbours together.
    independent = float(square**2 / np.mean(weight**4))
    highest, highest_reason = (
        2 * math.pi / (MIN_POINTS_PER_WAVE * max(topography.spacing)),
        f"{MIN_POINTS_PER_WAVE:g} points in a wave",
    )
    instrument = resolution if resolution is not None else topography.resolution
    if instrument is not None and 2 * math.pi / instrument < highest:
        highest, highest_reason = 2 * math.pi / instrument, "resolution of the instrument"
    lowest = MIN_WAVES_IN_SCAN * fundamental
    texture = 0.0 + 0.0j
    if not topography.is_line:
        used = (wavenumber >= lowest) & (wavenumber <= highest)
        turn = ((components[0] + 1j * components[1])[keep][order] / radius) ** 2
        # Less one, as the grid's own wave vectors may lie unevenly in a ring.
        rings = np.add.reduceat((power / np.repeat(density, counts) - 1) * turn, starts)
        texture = complex(np.sum(rings[used]) / max(np.sum(counts[used]), 1))
    spectrum = MeasuredSpectrum(
        wavenumber=wavenumber,
        density=density,
        modes=counts / 2 * independent,
        inner=radius[places],
        is_line=topography.is_line,
        lowest=lowest,
        highest=highest,
        lowest_reason=f"{MIN_WAVES_IN_SCAN:g} waves in the scan",
        highest_reason=highest_reason,
        mean_square=float(np.mean(z**2) / square),
        texture=texture,
    )
    if spectrum.reliable.sum() < 6:
        raise InputError(
            f"{topography.source}: only wavelengths from {2 * math.pi / highest:.3g} m ({highest_reason}) to "
            f"{2 * math.pi / lowest:.3g} m ({spectrum.lowest_reason}) are reliable, too few for a spectrum; "
            "measure a larger area or with finer steps."
        )
    return spectrum


def line_density(wavenumber: Array, roughness: SelfAffine) -> Array:
    """Return the spectrum along a line of a self-affine surface without a short cut-off."""
    shape = line_shape(wavenumber, roughness.q0, roughness.roll_off or roughness.q0, roughness.hurst)
    return float(roughness.spectrum.density[0]) * shape


def line_shape(wavenumber: Array, q0: float, q_r: float, H: float) -> Array:
    r"""Return the spectrum along a line over that of the plateau of the surface, with B the incomplete beta function.

    .. math::

        \frac{C_1(q)}{C(q_0)} = 2 \int_0^\infty \frac{C(q \cosh v)}{C(q_0)}\, q \cosh v\, \mathrm{d}v
        = 2 \max(q_r^2 - q^2, 0)^{1/2} - 2 \max(q_0^2 - q^2, 0)^{1/2}
        + q \left(\frac{q}{q_r}\right)^{-2 (1 + H)} B_{\min(q^2/q_r^2, 1)}\left(H + \tfrac12, \tfrac12\right)
    """
    q = np.asarray(wavenumber, dtype=float)
    plateau = np.sqrt(np.maximum(q_r**2 - q**2, 0.0)) - np.sqrt(np.maximum(q0**2 - q**2, 0.0))
    beyond = special.beta(H + 0.5, 0.5) * special.betainc(H + 0.5, 0.5, np.minimum(q / q_r, 1.0) ** 2)
    return np.asarray(2 * plateau + q * (q / q_r) ** (-2 * (1 + H)) * beyond)


def _window(window: str, shape: tuple[int, ...]) -> Array:
    if not isinstance(window, str) or window not in ("hann", "none"):
        raise InputError(f"window = {show(window)} is not known; choose hann, or none for periodic heights.")
    weight = np.ones(shape)
    if window == "hann":
        for axis, n in enumerate(shape):
            line = np.sin(math.pi * (np.arange(n) + 0.5) / n) ** 2
            weight = weight * np.expand_dims(line, tuple(i for i in range(len(shape)) if i != axis))
    return weight


def _edges(fundamental: float, largest: float) -> Array:
    """Return edges of rings: a fundamental wide at first, then even on a logarithmic axis."""
    ratio = 10 ** (1 / MAX_RINGS_PER_DECADE)
    edges = [0.5 * fundamental]
    while edges[-1] < largest:
        edges.append(max(edges[-1] + fundamental, edges[-1] * ratio))
    edges[-1] = largest * (1 + 1e-12)
    return np.array(edges)
