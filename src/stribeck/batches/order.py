"""In which order states are solved: so that each finds its neighbour solved, in chains that are independent of each other.

A chain begins cold, all others of it follow the one before; one chain is what a worker gets at a time.  Chains depend on the
design alone, so that the numbers do not depend on how many workers there are.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from stribeck._types import Array, Indices

__all__ = ["chains_of", "coordinates"]

CHAIN = 40  # States of a chain, at most: a cold start costs as much as ten that follow, and a lost worker loses one chain

LINE = 16  # States from which one line of a grid is a chain, or several, of its own; shorter ones are joined

LOAD_WEIGHT = 0.3  # Of a step in load at fixed relative roughness, against one in speed: it hardly changes the fields


def coordinates(groups: Array) -> Array:
    """Return where states lie as neighbours: logarithms of speed, load and relative roughness, zero counting as one."""
    speed, load, roughness = groups.T
    z = np.stack([_log(speed), LOAD_WEIGHT * np.log(load), _log(roughness / load)], axis=1)
    return np.asarray(z)


def _log(values: Array) -> Array:
    return np.asarray(np.log(np.where(values > 0, values, 1.0)))


def chains_of(groups: Array, shape: Sequence[int] = ()) -> tuple[Indices, ...]:
    """Return the chains in which states are solved."""
    _, first, twin, counts = np.unique(groups, axis=0, return_index=True, return_inverse=True, return_counts=True)
    kinds = 2 * (groups[:, 0] == 0) + (groups[:, 2] == 0)
    alone = np.zeros(len(groups), dtype=bool)
    alone[first] = True  # states that differ only in what friction is made of are solved together
    found: list[Indices] = []
    for kind in np.unique(kinds):
        wanted = alone & (kinds == kind)
        lines = _lines(groups, shape) if len(shape) > 1 else [_scattered(groups, np.nonzero(wanted)[0])]
        lines = [line[wanted[line]] for line in lines]
        long = [line for line in lines if len(line) >= LINE]
        short = [line for line in lines if len(line) < LINE]
        found += [part for line in [*long, *([np.concatenate(short)] if short else [])] for part in _parts(line)]
    twin = twin.ravel()
    twins = np.split(np.argsort(twin, kind="stable"), np.cumsum(counts)[:-1])
    return tuple(np.concatenate([twins[twin[i]] for i in part]) for part in found)


def _scattered(groups: Array, states: Indices) -> Indices:
    """Return states that are no grid in order: as they are given, or by cells where that is shorter."""
    z = coordinates(groups[states])
    given = np.arange(len(states))
    return np.asarray(states[min(_cells(z), given, key=lambda order: _length(z[order]))])


def _length(z: Array) -> float:
    return float(np.abs(np.diff(z, axis=0)).max(axis=1).sum()) if len(z) > 1 else 0.0


def _parts(order: Indices) -> Iterator[Indices]:
    """Yield equal parts of an order, none longer than a chain."""
    if len(order):
        yield from np.array_split(order, math.ceil(len(order) / CHAIN))


def _lines(groups: Array, shape: Sequence[int]) -> list[Indices]:
    """Return the lines of a grid, neighbours one after the other and each beginning where the one before it ended."""
    longest = int(np.argmax(shape))
    places = np.moveaxis(np.arange(len(groups)).reshape(shape), longest, -1)
    others = places.shape[:-1]
    lines: list[Indices] = []
    for turn, index in enumerate(np.ndindex(*others)):
        # Each axis runs back where the number of the lines before it on the slower axes is odd.
        flipped = [
            size - 1 - i if int(np.ravel_multi_index(index[:k], others[:k]) if k else 0) % 2 else i
            for k, (i, size) in enumerate(zip(index, others, strict=True))
        ]
        one = places[tuple(flipped)]
        # High speeds first: there a cold start is cheapest.
        rising = groups[one[0], 0] < groups[one[-1], 0]
        back = shape[longest] < LINE and turn % 2 == 1
        lines.append(one[::-1] if rising != back else one)
    return lines


def _cells(z: Array) -> Indices:
    """Return scattered states in order: columns of like roughness and load, followed along the speed up and down."""
    extents = np.ptp(z, axis=0)
    wide = extents > 1e-9
    cell = float((np.prod(extents[wide]) / len(z)) ** (1 / max(1, wide.sum())))
    load_cells, roughness_cells = (max(1, round(e / cell)) if e > 1e-9 else 1 for e in extents[1:])
    columns: list[Indices] = []
    for k, strip in enumerate(np.array_split(np.argsort(z[:, 2], kind="stable"), roughness_cells)):
        strip = strip[np.argsort(z[strip, 1], kind="stable")]
        cells = np.array_split(strip, load_cells)
        columns += cells if k % 2 == 0 else cells[::-1]
    ordered = [column[np.argsort(-z[column, 0], kind="stable")] for column in columns if len(column)]
    return np.concatenate([column if k % 2 == 0 else column[::-1] for k, column in enumerate(ordered)])
