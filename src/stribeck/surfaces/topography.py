"""Measured heights of a surface: maps and lines, dead pixels and spikes, and surfaces made with a known spectrum."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from numbers import Integral
from typing import Any

import numpy as np

from stribeck._types import Array, Flags
from stribeck.contact_laws.spectrum import SelfAffine, Spectrum, positive, table_of
from stribeck.quantities.units import InputError, show

MIN_POINTS = {1: 64, 2: 32}  # Fewest points along a line and along each side of a map, for a spectrum of a decade

MAX_MISSING_SHARE = 0.1  # Largest share of missing points that is filled

# Deviation from the neighbours, over its robust standard deviation in the whole scan, above which a point may be a spike
SPIKE_DEVIATION = 12.0

SPIKE_ISOLATION = 4.0  # Deviation from the neighbours, over the range of their own heights, above which a point is a spike


@dataclass(frozen=True, eq=False)
class Topography:
    """Heights on an even grid, along a line or over a rectangle.

    Parameters
    ----------
    heights : ndarray
        Heights, of shape (n,) or (nx, ny); NaN where nothing was measured [m].
    spacing : float or tuple of float
        Distance between neighbouring points, for all axes or one for each [m].
    source : str
        Where it comes from: file, format and channel.
    resolution : float, optional
        Shortest wavelength that the instrument resolves [m]; None where it is not known.
    notes : tuple of str
        What was done to the data or must be known about them, a sentence each.

    Raises
    ------
    InputError
        Where the array has another shape, is too small, has too few measured points or no roughness at all.
    """

    heights: Array
    spacing: tuple[float, ...]
    source: str = "heights in memory"
    resolution: float | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Check the heights and keep a read-only copy."""
        try:
            z = np.array(self.heights, dtype=float)
        except (TypeError, ValueError, OverflowError):
            raise InputError(f"{self.source}: heights = {show(self.heights)} is no array of numbers.") from None
        steps = self.spacing if isinstance(self.spacing, tuple | list) else (self.spacing,) * z.ndim
        object.__setattr__(self, "spacing", tuple(positive("spacing", step) for step in steps))
        if z.ndim not in (1, 2) or len(self.spacing) != z.ndim:
            raise InputError(
                f"{self.source}: heights of shape {z.shape} with {len(self.spacing)} spacings are neither a profile nor a map."
            )
        if min(z.shape) < MIN_POINTS[z.ndim]:
            kind = "a line" if z.ndim == 1 else "a map"
            raise InputError(
                f"{self.source}: {' x '.join(map(str, z.shape))} points are too few for a spectrum; "
                f"{kind} needs {MIN_POINTS[z.ndim]} or more along each side."
            )
        z[~np.isfinite(z)] = np.nan
        check_missing(z, self.source)
        if not np.nanmax(z) > np.nanmin(z):
            raise InputError(f"{self.source}: all heights are the same; there is no roughness to evaluate.")
        z.setflags(write=False)
        object.__setattr__(self, "heights", z)

    @property
    def is_line(self) -> bool:
        """Whether the heights lie along a line."""
        return self.heights.ndim == 1

    @property
    def size(self) -> tuple[float, ...]:
        """Length of the scan along each axis [m]."""
        return tuple(n * step for n, step in zip(self.heights.shape, self.spacing, strict=True))

    @property
    def missing(self) -> int:
        """Number of points without a height."""
        return int(np.isnan(self.heights).sum())

    def repaired(self, *, keep_spikes: bool = False) -> Topography:
        """Return the topography with dead points filled smoothly from their neighbours.

        Parameters
        ----------
        keep_spikes : bool
            Whether spikes are kept as roughness.

        Returns
        -------
        Topography
            Heights without NaN; the notes say how many points were filled.

        Raises
        ------
        InputError
            If too many points are missing or spikes.

        Notes
        -----
        A spike is a single point whose distance from the median of its 8 neighbours (4 on each side in a profile) is more
        than 4 times the range of their heights, and more than 12 times the robust standard deviation of that distance in the
        scan.  Filled heights solve Laplace's equation between the heights around; this lowers the power of short waves by
        about the share of filled points.
        """
        dead, spikes = np.isnan(self.heights), np.zeros(self.heights.shape, dtype=bool)
        if not keep_spikes:
            spikes = _spikes(self.heights)
        notes = list(self.notes)
        if dead.any():
            verb = "is" if self.missing == 1 else "are"
            notes.append(f"{self.missing} of {dead.size} points {verb} without a height, filled from the neighbours.")
        if spikes.any():
            number = int(spikes.sum())
            what = "1 point is a spike" if number == 1 else f"{number} points are spikes"
            notes.append(f"{what}, far above or below all neighbours, and replaced by their heights.")
        holes = dead | spikes
        if holes.mean() > MAX_MISSING_SHARE:
            raise InputError(f"{self.source}: {100 * holes.mean():.0f} % of the points are treated as missing; measure again.")
        return replace(self, heights=_filled(self.heights, holes), notes=tuple(notes))


def synthetic_topography(
    roughness: Spectrum | SelfAffine,
    points: tuple[int, ...],
    spacing: float,
    seed: int,
    *,
    oversize: int = 2,
) -> Topography:
    r"""Return a Gaussian random surface with a known power spectrum.

    .. math:: h(x) = \sum_k \left[C(q_k)\, \Delta q_x \Delta q_y\right]^{1/2} \xi_k \, e^{i q_k \cdot x}

    Parameters
    ----------
    roughness : Spectrum or SelfAffine
        Power spectrum of the surface.
    points : tuple of int
        Points along each axis of the map, or one number for a line.
    spacing : float
        Distance between points, the same along both axes [m].
    seed : int
        Seed of the random numbers xi, complex and normal with unit mean square.
    oversize : int
        How much larger than wanted the periodic surface is made, so that the part cut out is not periodic itself.

    Returns
    -------
    Topography
        The surface; its own rms height scatters about that of the spectrum.

    Raises
    ------
    InputError
        Where the numbers of points are too small, or an argument is impossible.

    Notes
    -----
    Wave numbers beyond those of the grid, pi/spacing, are left out.  A line is cut from a map of that length.
    """
    table, step = table_of(roughness), positive("spacing", spacing)
    counts: list[Any] = [*points, oversize] if isinstance(points, tuple | list) and len(points) in (1, 2) else [0]
    if not all(isinstance(count, Integral) and int(count) > 0 for count in counts):
        raise InputError(
            f"points = {show(points)}, oversize = {show(oversize)}: give whole numbers, of points along one or two axes."
        )
    shape = points if len(points) == 2 else (points[0], max(64, points[0] // 4))
    n = tuple(oversize * count for count in shape)
    random = np.random.default_rng(seed)
    q = [2 * math.pi * np.fft.fftfreq(count, step) for count in n]
    amplitude = np.sqrt(table.at(np.hypot(*np.meshgrid(*q, indexing="ij"))) * (2 * math.pi / step) ** 2 / (n[0] * n[1]))
    white = np.fft.fft2(random.standard_normal(n)) / math.sqrt(n[0] * n[1])
    heights = np.fft.ifft2(white * amplitude).real * (n[0] * n[1])
    cut = heights[: shape[0], : shape[1]]
    if len(points) == 1:
        return Topography(cut[:, 0], (step,), source="synthetic")
    return Topography(cut, (step, step), source="synthetic")


def check_missing(heights: Array, source: str) -> None:
    """Refuse heights of which so many are missing that to fill them would make a surface up."""
    share = float(np.isnan(heights).mean())
    if share > MAX_MISSING_SHARE:
        raise InputError(
            f"{source}: {100 * share:.0f} % of the points are missing, more than "
            f"{100 * MAX_MISSING_SHARE:.0f} %; crop the scan to the measured area."
        )


def _spikes(heights: Array) -> Flags:
    from scipy import ndimage

    dead = np.isnan(heights)
    z = _filled(heights, dead)
    around = np.ones((9,) if z.ndim == 1 else (3, 3), dtype=bool)
    around[tuple(n // 2 for n in around.shape)] = False
    # Mirrored about its last points, so that a point at the edge is not its own neighbour.
    options: dict[str, Any] = {"footprint": around, "mode": "mirror"}
    deviation = np.abs(z - ndimage.median_filter(z, **options))
    scatter = ndimage.maximum_filter(z, **options) - ndimage.minimum_filter(z, **options)
    usual = 1.4826 * float(np.median(deviation[~dead]))
    # Heights in a few steps may have no scatter at all; then no spike can be found.
    if usual == 0:
        return np.zeros(z.shape, dtype=bool)
    return np.asarray(~dead & (deviation > SPIKE_DEVIATION * usual) & (deviation > SPIKE_ISOLATION * scatter))


def _filled(heights: Array, holes: Flags) -> Array:
    """Return the heights with the holes filled by the solution of Laplace's equation on the grid."""
    if not holes.any():
        return heights
    from scipy import sparse
    from scipy.sparse.csgraph import laplacian
    from scipy.sparse.linalg import spsolve

    hole, places = holes.ravel(), np.arange(heights.size).reshape(heights.shape)
    pairs = [(places.take(range(n - 1), axis), places.take(range(1, n), axis)) for axis, n in enumerate(heights.shape)]
    one, other = (np.concatenate([pair[side].ravel() for pair in pairs]) for side in (0, 1))
    touching = hole[one] | hole[other]
    links = (one[touching], other[touching])
    graph = sparse.coo_matrix((np.ones(links[0].size), links), shape=(hole.size, hole.size))
    balance: Any = laplacian(graph + graph.T)
    balance = balance.tocsc()[hole]
    filled = heights.copy()
    filled[holes] = spsolve(balance[:, hole], -balance[:, ~hole] @ heights[~holes])
    return filled
