r"""Coordinates in which the solutions are smooth, and the blocks on which the atlas tabulates them.

A state is :math:`s = \ln \lambda`, :math:`L = -\ln \bar F_N` and :math:`\kappa`. Three maps make its observables smooth:

*Load.* At rest the gap at the centre is :math:`\kappa (L/2 + r(\kappa))` with :math:`r \approx \kappa` where that is small,
and what slow fluid does goes with powers of it. So the coordinate is :math:`y = \ln(L + \delta)`,
:math:`\delta = 2\kappa/(1 + \kappa)`, from the heaviest to the lightest load of a region.

*Roughness.* Its logarithm.

*Speed.* Speeds that go with the load and the roughness, smooth functions themselves, part it into segments: where roughness
begins to yield (:math:`b_1`), and where asperities carry :math:`e^{-1.1}, e^{-2.6}, e^{-6.5}, e^{-30}` of the load
(:math:`b_2 \dots b_5`). Below :math:`b_1` everything is analytic in :math:`\lambda^2`, the mirror image of a contact being
the contact that slides the other way, and the coordinate is :math:`(\lambda/\lambda_1)^2`, with rest at its end; then the
logarithm of the speed. Above :math:`b_5` there are no asperities left and the smooth film does not know the load.

Here are maps and polynomials; the table is :mod:`stribeck.atlas.table`, how it is made :mod:`evidence.atlas_build`.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.numerics.dual import chained, value_of

MIN_LOAD = 1e-6  # Minimum load group of the atlas

MIN_SPEED = 1e-12  # Minimum speed group of the atlas beside rest

MAX_ROUGHNESS_OF_HEAVY = 1e-3  # Relative roughness up to which heavy loads are a region of their own

# L of the smallest heavy load. Towards load 1 the gap at rest closes, to 2 kappa, and the speed at which roughness begins to
# yield falls below the minimum speed: this region begins at that.
MAX_L_OF_HEAVY = -math.log(0.99)

BREAK_TERMS = 8  # Terms in load and in roughness of the polynomials for the speeds at which segments end

# Segments of speed with a table: the squared speed, two up to the share exp(-1.1), and three beyond; then the film.
SEGMENTS = 6


@dataclass(frozen=True)
class Region:
    """Relative roughnesses and loads with one coordinate in load and the same numbers of nodes."""

    roughness: tuple[float, float]  # Smallest and largest relative roughness
    logs: tuple[float, float]  # Smallest and largest L = -ln(load)
    pieces: tuple[int, int]  # Pieces in roughness and load
    nodes: tuple[int, int]  # Nodes of a piece in roughness and load
    speeds: tuple[int, ...]  # Nodes of each segment of speed
    closing: float = 0.0  # A constant delta; zero for `2 kappa/(1 + kappa)`
    nested: bool = False  # Whether the nodes in roughness are the ends and the extrema of a Chebyshev polynomial

    @property
    def has_rest(self) -> bool:
        """Whether the segments begin at rest, else at :data:`MIN_SPEED`."""
        return self.speeds[0] > 0

    def roughness_coordinate(self, log_kappa: Any) -> Any:
        """Return the coordinate in [-1, 1] of the logarithm of the relative roughness."""
        low, high = (math.log(end) for end in self.roughness)
        return (2 * log_kappa - low - high) / (high - low)

    def load_coordinate(self, log_load: Any, kappa: Any) -> Any:
        """Return the coordinate in [-1, 1] of L = -ln(load)."""
        delta = self.delta(kappa)
        low, high = (np.log(end + delta) for end in self.logs)
        return (2 * np.log(log_load + delta) - low - high) / (high - low)

    def delta(self, kappa: Any) -> Any:
        """Return what is added to L in the coordinate."""
        return np.full_like(kappa, self.closing) if self.closing else 2 * kappa / (1 + kappa)


MAX_L = -math.log(MIN_LOAD)  # L of the minimum load

# The regions: nearly smooth ones, the heavy loads of these, and rougher ones.
REGIONS = (
    Region((1e-6, MAX_ROUGHNESS_OF_HEAVY), (MAX_L_OF_HEAVY, MAX_L), (2, 2), (10, 12), (10, 13, 12, 10, 14, 16)),
    Region((1e-6, MAX_ROUGHNESS_OF_HEAVY), (0.0, MAX_L_OF_HEAVY), (2, 1), (10, 9), (0, 14, 14, 10, 12, 15), 0.006),
    Region((MAX_ROUGHNESS_OF_HEAVY, 1e-1), (0.0, MAX_L), (2, 3), (11, 10), (10, 12, 11, 10, 12, 16)),
    Region((1e-1, 1e2), (0.0, MAX_L), (2, 2), (11, 9), (9, 11, 10, 9, 11, 14)),
)


@dataclass(frozen=True)
class Grid:
    """The coordinates and the blocks of one table."""

    regions: tuple[Region, ...]
    heaviest: float = 1.0  # Load group at which L is zero
    load_factor: float = 1.0
    power: int = 2  # Power of the speed in the fluid's share at small speed
    films: tuple[float, float] = (MIN_SPEED, 1e6)  # Speeds between which smooth films are tabulated
    resting: float = 0.0

    def log_load(self, load: Array) -> Array:
        """Return L of a load group, not beyond the regions."""
        highest = max(region.logs[1] for region in self.regions)
        return np.asarray(np.clip(self.load_factor * np.log(self.heaviest / load), 0.0, highest))

    def load_at(self, log_load: float) -> float:
        """Return the load group at L."""
        return self.heaviest * math.exp(-log_load / self.load_factor)

    @property
    def has_rest(self) -> Flags:
        """For each region whether it begins at rest."""
        return np.array([region.has_rest for region in self.regions])

    @property
    def pieces(self) -> int:
        """Pieces in roughness and load; each has :data:`SEGMENTS` blocks."""
        return sum(math.prod(region.pieces) for region in self.regions)

    def piece_at(self, region: int, i: int, j: int) -> int:
        """Return the number of the piece i in roughness and j in load of a region."""
        before = sum(math.prod(other.pieces) for other in self.regions[:region])
        return before + i * self.regions[region].pieces[1] + j

    def region_at(self, log_load: Array, kappa: Array) -> Indices:
        """Return the region of states with a positive relative roughness."""
        found = np.zeros(np.broadcast_shapes(log_load.shape, kappa.shape), dtype=np.intp)
        order = sorted(range(len(self.regions)), key=lambda n: (self.regions[n].roughness[0], self.regions[n].logs[0]))
        for number in order:
            region = self.regions[number]
            found[(kappa >= region.roughness[0]) & (log_load >= region.logs[0])] = number
        return found


LINE_EXPONENTIAL = Grid(REGIONS)  # Cylinder, exponential law, full film

# Cylinder, Persson's law, full film: L = ln(20/load), as nothing closes where the law goes on to full contact.
LINE_PERSSON = Grid(
    (Region((1e-3, 1.0), (0.0, math.log(2e3)), (2, 2), (6, 6), (6, 9, 7, 8, 9, 9), 8.0),),
    heaviest=20.0,
)

# Cylinder, exponential law, a film that ends: slow, its share is of first order in the speed.
LINE_EXIT = Grid(
    (
        Region((1e-3, 1e-1), (-math.log(0.9), MAX_L), (1, 1), (12, 12), (7, 10, 8, 8, 10, 11)),
        Region((1e-1, 1e1), (-math.log(0.9), MAX_L), (1, 1), (10, 11), (7, 10, 8, 8, 10, 11)),
    ),
    power=1,
    films=(1e-7, 1e4),
)

# Ball, exponential law, full film: L = -2/3 ln(load), as the pressure goes with the cube root of the load.
BALL_EXPONENTIAL = Grid(
    (
        Region((1e-5, 1e-3), (2 / 3 * math.log(2), 2 / 3 * math.log(1e7)), (1, 1), (11, 7), (4, 7, 7, 6, 8, 8), nested=True),
        Region((1e-3, 1.0), (2 / 3 * math.log(2), 2 / 3 * math.log(1e7)), (1, 1), (23, 7), (4, 6, 6, 6, 7, 8), nested=True),
    ),
    load_factor=2 / 3,
    films=(1e-5, 1e3),
)

# Ball, exponential law, a film that ends at ambient pressure.
BALL_EXIT = Grid(
    (Region((5e-3, 1.0), (2 / 3 * math.log(2), 2 / 3 * math.log(1e4)), (1, 1), (15, 6), (5, 6, 6, 6, 7, 8), nested=True),),
    load_factor=2 / 3,
    power=1,
    films=(1e-4, 10.0),
)

# Ball, Persson's law, full film. Above load 30 nearly all of the dry surface is in contact, and the share of slow fluid goes
# with so small a power of the speed that rest is far from every speed of use: segments begin at the smallest.
BALL_PERSSON = Grid(
    (
        Region((5e-4, 0.05), (0.0, math.log(1e4 / 300)), (1, 1), (8, 5), (0, 8, 8, 6, 7, 8), 6.0),
        Region((5e-4, 0.1), (math.log(10), math.log(1e4 / 30)), (1, 1), (9, 6), (0, 8, 8, 6, 7, 8), 8.0 - math.log(10)),
        Region((5e-4, 0.1), (math.log(1e4 / 30), math.log(1e7)), (1, 1), (10, 8), (4, 8, 7, 6, 7, 8), 8.0 - math.log(10)),
    ),
    heaviest=1e4,
    films=(1e-3, 1e3),
    resting=math.log(1e4 / 30),
)


def chebyshev(x: Array, terms: int) -> Array:
    """Return the Chebyshev polynomials at ``x``, shape (terms, len(x))."""
    values = np.empty((terms, x.size))
    values[0] = 1.0
    if terms > 1:
        values[1] = x
    twice = 2 * x
    for n in range(2, terms):
        np.multiply(twice, values[n - 1], out=values[n])
        values[n] -= values[n - 2]
    return values


def chebyshev_slopes(x: Array, terms: int) -> Array:
    """Return the derivatives of the Chebyshev polynomials at ``x``, shape (terms, len(x))."""
    slopes = np.zeros((terms, x.size))
    second, before, twice = np.ones(x.size), np.zeros(x.size), 2 * x
    for n in range(1, terms):  # T_n' = n U_(n-1), with U the polynomials of the second kind
        np.multiply(second, n, out=slopes[n])
        second, before = twice * second - before, second
    return slopes


def local(coordinate: Any, pieces: int) -> tuple[Indices, Any]:
    """Return the piece that a coordinate in [-1, 1] lies on, and the coordinate in [-1, 1] of that piece."""
    along = 0.5 * pieces * (coordinate + 1)
    piece = np.clip(value_of(along).astype(np.intp), 0, pieces - 1)
    return piece, within(2 * (along - piece) - 1)


def within(coordinate: Any) -> Any:
    """Return a coordinate between -1 and 1, beyond which rounding may have led it, with the derivatives that it has."""
    return chained(np.clip(value_of(coordinate), -1.0, 1.0), [coordinate], [None])


def breaks_from(values: Array) -> Array:
    """Return all ends of segments from b_1 .. b_5 along the first axis: b_1, the middle to b_2, b_2 .. b_5."""
    return np.concatenate([values[:1], 0.5 * (values[:1] + values[1:2]), values[1:]])
