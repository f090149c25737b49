"""Events along a path: zeros and minima of functions whose values are known at places of it."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.numerics.newton import root_between
from stribeck.numerics.settings import HALF_DIGITS
from stribeck.quantities.lazy import cached_property

SLOPE_STEP: float = HALF_DIGITS ** (1 / 3)  # Largest step in the slope of a function at its event, known to half of the digits

Function = Callable[[float], float]


@dataclass(frozen=True)
class Event:
    """A zero of a function along a path, and the places between which it was sought."""

    function: Function
    place: float
    low: float
    high: float
    is_least: bool = False  # Whether the function is the slope of another one, whose least value lies there

    @cached_property
    def slope(self) -> float:
        """The slope of the function there."""
        step = min(SLOPE_STEP, 0.1 * (self.high - self.low))
        return float((self.function(self.place + step) - self.function(self.place - step)) / (2 * step))


def _between(function: Function, ends: Array, tolerance: float, is_least: bool = False) -> Event | None:
    low, high = sorted(ends.tolist())
    place = root_between(function, low, high, tolerance)
    return None if place is None else Event(function, place, low, high, is_least)


def first_zero(function: Function, places: Array, values: Array, tolerance: float) -> Event | None:
    """Return the first zero of a function on the way along places where its values are known, up or down, or None."""
    changes = np.flatnonzero(np.diff(np.sign(values)))
    return _between(function, places[changes[0] : changes[0] + 2], tolerance) if len(changes) else None


def zero_of_growing(
    function: Function, start: float, step: float, ends: tuple[float, float], tolerance: float
) -> Event | None:
    """Return the zero of a growing function, looked for in steps from a place to one of two ends, or None."""
    here, value = start, function(start)
    step = -step if value >= 0 else step
    while ends[0] <= here + step <= ends[1]:
        there = here + step
        event = first_zero(function, np.array([here, there]), np.array([value, value := function(there)]), tolerance)
        if event is not None:
            return event
        here = there
    return None


def least_by_slope(
    slope: Function, places: Array, sizes: Array, tolerance: float, shallowest: float = -math.inf
) -> Event | None:
    """Return the zero of the slope of a function around the least of its values; None at an end, or too shallow."""
    i = int(np.argmin(sizes)) if len(sizes) else 0
    # Its depth is that below the lower of both sides.
    if not 0 < i < len(places) - 1 or min(sizes[:i].max(), sizes[i + 1 :].max()) - sizes[i] <= shallowest:
        return None
    return _between(slope, places[[i - 1, i + 1]], tolerance, is_least=True)


AROUND, THIRDS = np.array([-0.04, -0.004, 0.004, 0.04]), np.array([1 / 3, 2 / 3])
"""Where a round of :func:`rising_zeros` looks: around the place by false position, and where that is far off, at thirds, over
the distance of the ends.  Many values at once cost what one does."""


def rising_zeros(
    values_at: Callable[[Array], Array], ends: Array, values: Array, rounds: int, enough: float
) -> tuple[Array, Array, Array]:
    """Return where many functions pass from below to above zero, their slopes there, and how far apart their last ends are."""
    # Ends and their values have the shape (2, n), the lower ones first; places of shape (m, n) are asked for at once.
    (low, high), (below, above), one = ends, values, np.arange(ends.shape[1])
    for _ in range(rounds):
        if np.all(above - below <= enough):
            break
        middle = low + (high - low) * below / (below - above)
        between = np.concatenate([middle + AROUND[:, None] * (high - low), low + THIRDS[:, None] * (high - low)])
        between = np.sort(np.clip(between, low, high), axis=0)
        places, heights = np.vstack([low, between, high]), np.vstack([below, values_at(between), above])
        last = np.argmax((heights[:-1] < 0) & (heights[1:] >= 0), axis=0)
        low, high = places[last, one], places[last + 1, one]
        below, above = heights[last, one], heights[last + 1, one]
    slopes = (above - below) / np.maximum(high - low, np.finfo(float).tiny)
    return low + (high - low) * below / (below - above), slopes, high - low
