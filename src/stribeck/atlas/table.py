"""The table of the atlas: Chebyshev coefficients on blocks of speed, load and roughness, and their summation.

On a block the observables are tensor products of Chebyshev polynomials in the coordinates of :mod:`stribeck.atlas.grid`.  What
is tabulated are logarithms, see :data:`LINE_FUNCTIONS`.  States are sorted by block; then the products of the polynomials in
load and roughness of many states are one matrix, and the sum over them one matrix product.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.resources import files
from typing import Any

import numpy as np

from stribeck._types import Array, Indices
from stribeck.atlas.grid import (
    BREAK_TERMS,
    SEGMENTS,
    Grid,
    Region,
    breaks_from,
    chebyshev,
    chebyshev_slopes,
    local,
    within,
)
from stribeck.numerics.dual import Dual, chained, slope_of, value_of

# Tabulated functions of the line, in the order of the table: the logarithms of fluid over contact share, of both viscous
# frictions over :math:`\beta \bar F_N^{1/2} \lambda` and of the three gaps, and the offset less the central gap. Below the
# first end of a segment, the logarithm of the power of the speed with which the fluid's share begins is taken off the first.
LINE_FUNCTIONS = ("log_odds", "viscous_published", "viscous_balanced", "central_gap", "minimum_gap", "flux_gap", "deflection")

# Tabulated functions of balls: as of the line, with the logarithms of the two parts and the published sum of the friction
# integral over lambda, up to the radius :data:`FRICTION_RADIUS`.
BALL_FUNCTIONS = ("log_odds", "couette", "poiseuille", "published", "central_gap", "minimum_gap", "deflection")

FRICTION_RADIUS = 1e3  # Radius of the disc of liquid of which the friction of balls is tabulated [a]

FUNCTIONS = {"line": LINE_FUNCTIONS, "point": BALL_FUNCTIONS}  # By geometry

COEFFICIENT_UNIT = 2.0**-25  # Unit of the coefficients in the file, which holds whole numbers

CHUNK_STATES = 1024  # States that are summed at once: their polynomials then fit into the cache


@dataclass(frozen=True, eq=False)
class Block:
    """Coefficients of one block: ``coefficients[t, f, pair]`` is of the polynomials t, ``first[pair]``, ``second[pair]``."""

    coefficients: Array
    first: Indices
    second: Indices
    _chosen: dict[tuple[int, ...], Array] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, dense: Array) -> Block:
        """Return the block of coefficients along speed, roughness, load and function."""
        first, second = np.nonzero(np.abs(dense).max(axis=(0, 3)))
        return cls(np.ascontiguousarray(dense[:, first, second].transpose(0, 2, 1)), first, second)

    def chosen(self, functions: tuple[int, ...]) -> Array:
        """Return the coefficients of some functions as a matrix, a row for each polynomial in speed and function."""
        if functions not in self._chosen:
            part = self.coefficients[:, list(functions)]
            self._chosen[functions] = np.ascontiguousarray(part.reshape(-1, part.shape[-1]))
        return self._chosen[functions]

    def sum(self, functions: tuple[int, ...], t: Array, k: Array, y: Array, slopes: int) -> Array:
        """Return values and derivatives by the first local coordinates, shape (1 + slopes, functions, states)."""
        terms, matrix = self.coefficients.shape[0], self.chosen(functions)
        T = chebyshev(t, terms)
        K, Y = chebyshev(k, int(self.first.max()) + 1), chebyshev(y, int(self.second.max()) + 1)
        shape = terms, len(functions), t.size
        partial = (matrix @ (K[self.first] * Y[self.second])).reshape(shape)
        found = np.empty((1 + slopes, len(functions), t.size))
        np.einsum("tn,tfn->fn", T, partial, out=found[0])
        if slopes:
            np.einsum("tn,tfn->fn", chebyshev_slopes(t, terms), partial, out=found[1])
        if slopes == 3:
            by_k = matrix @ (chebyshev_slopes(k, K.shape[0])[self.first] * Y[self.second])
            by_y = matrix @ (K[self.first] * chebyshev_slopes(y, Y.shape[0])[self.second])
            np.einsum("tn,tfn->fn", T, by_k.reshape(shape), out=found[2])
            np.einsum("tn,tfn->fn", T, by_y.reshape(shape), out=found[3])
        return found


@dataclass(frozen=True, eq=False)
class Table:
    """A whole table; :func:`load_table` reads one that comes with the package."""

    grid: Grid  # Coordinates and blocks
    breaks: tuple[Array, ...]  # For each region the coefficients of the logarithms of the speeds b_1 .. b_5
    blocks: tuple[Block | None, ...]  # For each piece its segments; none where a region does not begin at rest
    film: Array  # Smooth films along the logarithm of the speed, without the first function
    about: dict[str, Any]  # Where the table comes from
    law: Array = field(default_factory=lambda: np.empty((2, 0)))

    def ends(self, region: int, k: Any, y: Any) -> Any:
        """Return the logarithms of the speeds at which segments end, shape (6, states), at the coordinates of a region."""
        matrix = self.breaks[region].reshape(-1, BREAK_TERMS**2)

        def sums(in_k: Array, in_y: Array) -> Array:
            return breaks_from(matrix @ (in_k[:, None] * in_y).reshape(BREAK_TERMS**2, -1))

        at_k, at_y = value_of(k), value_of(y)
        of_k, of_y = chebyshev(at_k, BREAK_TERMS), chebyshev(at_y, BREAK_TERMS)
        by_k, by_y = (
            lambda: sums(chebyshev_slopes(at_k, BREAK_TERMS), of_y),
            lambda: sums(of_k, chebyshev_slopes(at_y, BREAK_TERMS)),
        )
        return chained(sums(of_k, of_y), (k[None, :], y[None, :]), (by_k, by_y))

    def read(self, functions: tuple[int, ...], log_speed: Array, log_load: Array, kappa: Array, slopes: int) -> Array:
        """Return functions at states inside the box, and 0, 1 or 3 derivatives, shape (1 + slopes, functions, states).

        The derivatives are by ln(speed), -ln(load) and ln(relative roughness); where no asperities are left the first function
        is infinite.
        """
        # A ``log_speed`` of -inf is rest, ``kappa`` 0 a smooth surface.
        states, last = log_speed.size, self.grid.pieces * SEGMENTS
        block = np.full(states, last)
        coordinates, chain = np.empty((3, states)), np.empty((slopes, slopes, states))
        regions = np.where(kappa > 0, self.grid.region_at(log_load, kappa), -1)
        for number, region in enumerate(self.grid.regions):
            inside = np.nonzero(regions == number)[0]
            for start in range(0, inside.size, 4 * CHUNK_STATES):
                part = inside[start : start + 4 * CHUNK_STATES]
                block[part], *places = self._place(number, region, log_speed[part], log_load[part], kappa[part], slopes)
                coordinates[:, part] = [value_of(place) for place in places]
                if slopes:
                    chain[..., part] = [slope_of(place) for place in places[:slopes]]
        found, film = self._sums(functions, block, coordinates, slopes), block == last
        if film.any():
            found[..., film] = self._film(functions, log_speed[film], slopes)
            chain[..., film] = np.eye(slopes)[..., None]
        if slopes:
            found[1:] = np.einsum("cfn,cin->ifn", found[1:], chain)
        if 0 in functions:  # below b_1 the power of the speed was taken off the odds
            row, power, early = functions.index(0), float(self.grid.power), (block % SEGMENTS == 0) & ~film
            found[0, row] += np.where(early, power * log_speed, 0.0)
            if slopes:
                found[1, row] += np.where(early, power, 0.0)
        return found

    def _sums(self, functions: tuple[int, ...], block: Indices, coordinates: Array, slopes: int) -> Array:
        """Return the sums of :meth:`Block.sum` for states in any order; those on no block are left open."""
        order = np.argsort(block.astype(np.uint16), kind="stable")
        counts = np.bincount(block, minlength=self.grid.pieces * SEGMENTS + 1)
        ends = np.cumsum(counts).tolist()
        coordinates = coordinates[:, order]
        found = np.empty((1 + slopes, len(functions), block.size))
        for number in np.nonzero(counts[:-1])[0].tolist():
            here = self.blocks[number]
            assert here is not None
            for start in range(ends[number] - int(counts[number]), ends[number], CHUNK_STATES):
                part = slice(start, min(start + CHUNK_STATES, ends[number]))
                t, k, y = coordinates[:, part]
                found[..., part] = here.sum(functions, t, k, y, slopes)
        result = np.empty_like(found)
        result[..., order] = found
        return result

    def _place(
        self, number: int, region: Region, log_speed: Array, log_load: Array, kappa: Array, slopes: int
    ) -> tuple[Indices, Any, Any, Any]:
        """Return the block of states of a region and their local coordinates, with 0, 1 or 3 derivatives."""
        by: list[Any] = [log_speed, log_load, np.log(kappa)]
        axes = np.eye(slopes)[..., None] + np.zeros(log_speed.shape)
        by[:slopes] = map(Dual, by, axes)
        s, L, log_kappa = by
        k, y = region.roughness_coordinate(log_kappa), region.load_coordinate(L, np.exp(log_kappa))
        ends = self.ends(number, k, y)
        segment = np.maximum((log_speed >= value_of(ends)).sum(axis=0), 0 if region.has_rest else 1)
        (i, k_local), (j, y_local) = (local(c, n) for c, n in zip((k, y), region.pieces, strict=True))
        first, power = self.grid.piece_at(number, 0, 0), self.grid.power
        block = np.where(segment < SEGMENTS, SEGMENTS * (first + i * region.pieces[1] + j) + segment, -1)
        block[segment >= SEGMENTS] = self.grid.pieces * SEGMENTS
        at = np.arange(segment.size)
        lowest, low, high = (ends[np.clip(row, 0, SEGMENTS - 1), at] for row in (np.zeros_like(segment), segment - 1, segment))
        squared = segment == 0
        ratio = np.exp(power * np.minimum(s - lowest, 0.0))
        length = np.where(value_of(low) < value_of(high), high - low, 1.0)
        logarithmic = within(2 * (np.where(squared | (log_speed == -np.inf), low, s) - low) / length - 1)
        return block, np.where(squared, 2 * ratio - 1, logarithmic), k_local, y_local

    def _film(self, functions: tuple[int, ...], log_speed: Array, slopes: int) -> Array:
        """Return functions of smooth films and, if wanted, their derivative by ln(speed), as :meth:`Block.sum`."""
        pieces, terms, _ = self.film.shape
        low, high = (math.log(end) for end in self.grid.films)
        piece, x = local((2 * np.maximum(log_speed, low) - low - high) / (high - low), pieces)
        found = np.zeros((1 + slopes, len(functions), log_speed.size))
        for number in np.unique(piece):
            here = np.nonzero(piece == number)[0]
            T = chebyshev(x[here], terms)
            for row, function in enumerate(functions):
                if function == 0:
                    found[0, row, here] = np.inf
                    continue
                found[0, row, here] = self.film[number, :, function - 1] @ T
                if slopes:
                    slope = self.film[number, :, function - 1] @ chebyshev_slopes(x[here], terms)
                    found[1, row, here] = slope * 2 * pieces / (high - low)
        return found


def unpack(grid: Grid, data: Any) -> Table:
    """Return the table of the arrays of a file."""
    about = json.loads(str(data["about"]))
    functions = len(about["functions"])
    law = data["law"] if "law" in data else np.empty((2, 0))
    flat, position = data["blocks"] * COEFFICIENT_UNIT, 0
    blocks: list[Block | None] = []
    for region in grid.regions:
        for _ in range(math.prod(region.pieces)):
            for count in region.speeds:
                shape = functions, count, *region.nodes
                size = math.prod(shape)
                dense = np.moveaxis(flat[position : position + size].reshape(shape), 0, 3)
                blocks.append(Block.of(dense) if count else None)
                position += size
    return Table(grid, tuple(data["breaks"]), tuple(blocks), data["film"], about, law)


@lru_cache(maxsize=16)
def load_table(file: str, grid: Grid) -> Table:
    """Return a table that comes with the package, read on first use."""
    with files("stribeck.atlas").joinpath(file).open("rb") as stream, np.load(stream) as data:
        return unpack(grid, data)
