"""The order in which states are solved: in chains, each state beside a solved one, each chain from cold.

Chains depend on the design alone, so that the numbers do not depend on how many workers there are.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from stribeck._types import Array, Indices

MAX_CHAIN = 40  # States of a chain: a cold start costs as much as ten that follow, and a lost worker loses one chain


def chains_of(groups: Array) -> Iterator[Indices]:
    """Yield the chains in which states are solved; resting and smooth states have chains of their own."""
    speed, load, roughness = groups.T
    kinds = 2 * (speed == 0) + (roughness == 0)
    places = np.log(np.stack([np.where(speed > 0, speed, 1.0), load, np.where(roughness > 0, roughness / load, 1.0)], axis=1))
    for kind in np.unique(kinds):
        yield from _halved(places, np.flatnonzero(kinds == kind))


def _halved(places: Array, states: Indices) -> Iterator[Indices]:
    """Yield states in order of the number that spreads them most, halved there until they are few."""
    widest = np.argmax(np.ptp(places[states], axis=0))
    ordered = states[np.argsort(-places[states, widest], kind="stable")]
    if len(ordered) <= MAX_CHAIN:
        yield ordered
        return
    for half in np.array_split(ordered, 2):
        yield from _halved(places, half)
