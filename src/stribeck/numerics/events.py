"""Events along a path: zeros and minima of functions whose values are known at places of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.numerics.newton import root_between

__all__ = ["Event", "first_zero", "least_by_slope"]

Function = Callable[[float], float]


@dataclass(frozen=True)
class Event:
    """A zero of a function along a path, and the places between which it was sought."""

    function: Function
    place: float
    low: float
    high: float


def _between(function: Function, low: float, high: float, tolerance: float) -> Event | None:
    place = root_between(function, low, high, tolerance)
    return None if place is None else Event(function, place, low, high)


def first_zero(function: Function, places: Array, values: Array, tolerance: float) -> Event | None:
    """Return the first zero of a function between ascending places where its values are known, or None."""
    changes = np.flatnonzero(np.diff(np.sign(values)))
    if not len(changes):
        return None
    low, high = places[changes[0] : changes[0] + 2].tolist()
    return _between(function, low, high, tolerance)


def least_by_slope(slope: Function, places: Array, sizes: Array, tolerance: float) -> Event | None:
    """Return the zero of the slope of a function around the least of its values, or None where that is the first or last."""
    i = int(np.argmin(sizes)) if len(sizes) else 0
    return _between(slope, float(places[i - 1]), float(places[i + 1]), tolerance) if 0 < i < len(places) - 1 else None
