"""Parts of a series: steps of steady speed, by binary segmentation at change points of ln(speed), strokes, ramps, rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.fits.table.correlated import FEWEST
from stribeck.fits.table.repeats import LARGEST_NOISE, SAME_SPEED
from stribeck.fits.table.strokes import REST_SPEED

__all__ = ["Part", "directions", "parts_of"]

MEDIAN_OF_DIFFERENCES = 0.954  # Median size of the difference of two normal numbers, over their standard deviation


@dataclass(frozen=True)
class Part:
    """Neighbouring rows of one curve and direction."""

    first: int
    end: int
    direction: int  # Sign of the speed; 0 at rest or while it turns
    steady: bool  # Whether the speed is that of a step
    speed: float  # Size of its mean [m/s]

    @property
    def rows(self) -> Indices:
        """The places of its rows."""
        return np.arange(self.first, self.end)


def directions(speed: Array, friction: Array) -> tuple[Array, Array]:
    """Return the speed with its sign, and friction positive along the motion."""
    turns = _runs(np.sign(friction))
    both = (friction > 0).any() and (friction < 0).any()
    if not (speed < 0).any() and both and float(np.median([end - first for first, end in turns])) >= FEWEST:
        speed = speed * np.where(friction < 0, -1.0, 1.0)
    along = np.sign(speed) * friction if (speed < 0).any() and both else friction
    polarity = 1.0 if np.sum(along) >= 0 else -1.0
    return speed, polarity * along


def parts_of(speed: Array, changes: Flags) -> list[Part]:
    """Return the parts of a series in order; ``changes`` marks rows at which a part begins whatever the speed does."""
    largest = float(np.max(np.abs(speed), initial=0.0))
    sign = np.where(np.abs(speed) <= REST_SPEED * largest, 0, np.sign(speed)).astype(int)
    found: list[Part] = []
    for first, end in _runs(sign, changes):
        if sign[first] == 0:
            found.append(Part(first, end, 0, False, 0.0))
            continue
        sizes = np.abs(speed[first:end])
        for start, stop, steady in _steps(np.log(sizes)):
            mean = float(np.exp(np.log(sizes[start:stop]).mean()))
            found.append(Part(first + start, first + stop, int(sign[first]), steady, mean))
    return found


def _steps(y: Array) -> list[tuple[int, int, bool]]:
    """Return first, end and whether the speed is steady of the pieces of a stretch of one direction; y is its logarithm."""
    pieces = _pieces(y)
    means = [float(y[first:end].mean()) for first, end in pieces]
    changes = [abs(_change(y[first:end])) for first, end in pieces]
    apart = [abs(b - a) for a, b in zip(means[:-1], means[1:], strict=True)]
    steady = []
    for k, (first, end) in enumerate(pieces):
        nearest = min([*apart[max(0, k - 1) : k + 1]], default=np.inf)
        # On a ramp a piece changes by as much as it lies from the next; within a step it hardly changes.
        steady.append(end - first >= FEWEST and changes[k] < max(nearest / 2, SAME_SPEED))
    joined: list[tuple[int, int, bool]] = []
    for k, (first, end) in enumerate(pieces):
        if joined and steady[k] and joined[-1][2] and apart[k - 1] < LARGEST_NOISE:
            joined[-1] = (joined[-1][0], end, True)
        else:
            joined.append((first, end, steady[k]))
    return joined


def _pieces(y: Array) -> list[tuple[int, int]]:
    """Return the pieces between the change points of a mean, by binary segmentation."""
    changes = np.diff(y)
    turns = np.mean(changes[1:] * changes[:-1] < 0) if len(y) > 2 else 0.0  # two thirds of noise, none of a smooth speed
    noise = float(np.median(np.abs(changes))) / MEDIAN_OF_DIFFERENCES if turns >= 0.5 else 0.0
    least = 2 * noise**2 * np.log(max(len(y), 2))  # what noise alone lowers the sum of squares by
    sums = np.concatenate([[0.0], np.cumsum(y)])
    waiting, found = [(0, len(y))], list[tuple[int, int]]()
    while waiting:
        first, end = waiting.pop()
        if end - first > 1:
            rows = np.arange(1, end - first)
            left = (sums[first + 1 : end] - sums[first]) / rows
            right = (sums[end] - sums[first + 1 : end]) / (end - first - rows)
            gain = rows * (end - first - rows) / (end - first) * (left - right) ** 2
            at = int(np.argmax(gain))
            if abs(left[at] - right[at]) > SAME_SPEED and gain[at] > least:
                waiting += [(first + at + 1, end), (first, first + at + 1)]
                continue
        found.append((first, end))
    return found


def _change(y: Array) -> float:
    """Return by how much a straight line through a series changes from end to end."""
    if len(y) < 2:
        return 0.0
    place = np.arange(len(y)) - (len(y) - 1) / 2
    return float(place @ y / (place @ place) * (len(y) - 1))


def _runs(sign: Array | Indices, changes: Flags | None = None) -> list[tuple[int, int]]:
    """Return first and end of the stretches of equal signs."""
    new = np.diff(sign) != 0
    if changes is not None:
        new |= changes[1:]
    edges = [0, *(np.flatnonzero(new) + 1).tolist(), len(sign)]
    return list(zip(edges[:-1], edges[1:], strict=True))
