"""Curves of a fit that are read between the inputs at which they were solved."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from stribeck._types import Array, Indices
from stribeck.fits.states.parts import FrictionParts, PartsOf
from stribeck.numerics.scattered import Scattered

__all__ = ["Between"]


@dataclass(eq=False)
class Between:
    """Reads curves between the inputs at which they were solved, and solves them where that leaves doubt."""

    solve: PartsOf  # What solves the states
    doubt: float  # Largest doubt with which a curve is read; at 0 all are solved
    known: dict[int, tuple[Scattered, list[FrictionParts]]] = field(default_factory=dict)

    def at(self, curve: int, place: Array, solved: Callable[[], FrictionParts], moving: Indices) -> FrictionParts:
        """Return the parts of one curve."""
        doubt = self.known[curve][0].doubt(place) if curve in self.known else math.inf
        if doubt > self.doubt:
            here = solved()
            scattered, all_solved = self.known.setdefault(curve, (Scattered(_lengths(here, moving)), []))
            scattered.add(place, here.values.ravel(), _rows(here, moving))
            all_solved.append(here)
            return here
        scattered, all_solved = self.known[curve]
        near = all_solved[scattered.nearest(place)]
        values, by = scattered.at(place)
        slopes = np.zeros_like(near.slopes)
        slopes[:, moving] = by.reshape(len(moving), *near.values.shape).swapaxes(0, 1)
        return FrictionParts(values.reshape(near.values.shape), slopes, near.errors + doubt, near.definition)


def _rows(parts: FrictionParts, moving: Indices) -> Array:
    """Return the slopes along moving inputs, shape (m, parts * rows)."""
    return np.asarray(parts.slopes[:, moving].swapaxes(0, 1).reshape(len(moving), parts.values.size))


def _lengths(parts: FrictionParts, moving: Indices) -> Array:
    """Return how far the logarithms of inputs move until a state changes by its own size, at most one."""
    size = np.ones_like(parts.values)
    size[1:] = np.abs(parts.values[1:]).max(axis=0)
    largest = (np.abs(parts.slopes[:, moving]) / size[:, None]).max(axis=(0, 2), initial=0.0)
    return np.asarray(1.0 / np.maximum(1.0, largest))
