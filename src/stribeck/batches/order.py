"""In which order states are solved: so that each finds its neighbour solved, in chains that are independent of each other.

A chain begins cold; one chain is what a worker gets at a time.  Chains depend on the design alone, so that the numbers do not
depend on how many workers there are.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from stribeck._types import Array, Indices

MAX_CHAIN = 40  # States of a chain: a cold start costs as much as ten that follow, and a lost worker loses one chain

LOAD_WEIGHT = 0.3  # Of a step in load at fixed relative roughness, against one in speed: it hardly changes the fields


def coordinates(groups: Array) -> Array:
    """Return where states lie as neighbours: logarithms of speed, load and relative roughness, zero counting as one."""
    speed, load, roughness = groups.T
    z = np.stack([_log(speed), LOAD_WEIGHT * np.log(load), _log(roughness / load)], axis=1)
    return np.asarray(z)


def _log(values: Array) -> Array:
    return np.asarray(np.log(np.where(values > 0, values, 1.0)))


def chains_of(groups: Array) -> tuple[Indices, ...]:
    """Return the chains in which states are solved; resting and smooth states have chains of their own."""
    distinct, twin, counts = np.unique(groups, axis=0, return_inverse=True, return_counts=True)
    # States that differ only in what friction is made of are solved together.
    twins = np.split(np.argsort(twin.ravel(), kind="stable"), np.cumsum(counts)[:-1])
    kinds = 2 * (distinct[:, 0] == 0) + (distinct[:, 2] == 0)
    of_kind = (np.nonzero(kinds == kind)[0] for kind in np.unique(kinds))
    chains = (part for states in of_kind for part in _parts(states[_columns(coordinates(distinct[states]))]))
    return tuple(np.concatenate([twins[i] for i in chain]) for chain in chains)


def _parts(order: Indices) -> Iterator[Indices]:
    """Yield equal parts of an order, none longer than a chain."""
    yield from np.array_split(order, math.ceil(len(order) / MAX_CHAIN))


def _columns(z: Array) -> Indices:
    """Return the order of states: columns of like roughness and load, followed along the speed down and up."""
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
