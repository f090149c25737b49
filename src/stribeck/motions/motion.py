"""What a motion is: the sliding speed over time, where it turns, and whether it comes back to where it began."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np

from stribeck._types import Array
from stribeck.numerics.settings import MAX_REFINEMENTS, NEGLIGIBLE
from stribeck.quantities.units import InputError, show


class Motion(Protocol):
    """A motion as users give it: frozen; seconds and metres."""

    @property
    def duration(self) -> float:
        """Time of a cycle, or of the whole motion [s]."""

    @property
    def repeats(self) -> bool:
        """Whether its end is its beginning, so that it may be repeated."""

    def speed(self, time: Array) -> Array:
        """Return the sliding speed, negative on the way back [m/s]."""

    def position(self, time: Array) -> Array:
        """Return the path of the moving surface, whose derivative the speed is [m]."""

    def times(self, steps: int) -> Array:
        """Return ``steps`` + 1 instants from zero to the duration, dense where the speed is small [s]."""
        return dense_where_slow(self, steps)


def dense_where_slow(motion: Motion, steps: int, corners: Sequence[float] = ()) -> Array:
    """Return instants of a motion, denser as its speed falls, for the films change with the speed over itself."""
    fine = np.union1d(np.linspace(0.0, motion.duration, steps * MAX_REFINEMENTS + 1), corners)
    speed = np.abs(motion.speed(0.5 * (fine[1:] + fine[:-1])))
    count = np.append(0.0, np.cumsum(np.diff(fine) / np.sqrt(NEGLIGIBLE + speed / (speed.max() or 1.0))))
    found = np.interp(np.linspace(0.0, count[-1], steps + 1), count, fine)
    found[-1] = motion.duration
    return np.asarray(found)


def checked_motion(motion: Any) -> Motion:
    """Return a motion whose members agree with each other, or refuse it by the member that does not."""
    members = ("duration", "repeats", "speed", "position", "times")
    lacking = [name for name in members if not hasattr(motion, name)]
    if lacking:
        raise InputError(
            f"motion = {show(motion)}; it must be a motion, as sb.motions.Sine(stroke='50 mm', frequency='1 Hz'); it "
            f"lacks {', '.join(lacking)}."
        )
    found: Motion = motion
    times = _values("times", found.times, 64, 65)
    if not (times[0] == 0 and np.all(np.diff(times) > 0) and abs(times[-1] / found.duration - 1) < 1e-9):
        raise InputError(f"motion.times(64) = {show(times.tolist())}; they must rise from 0 to duration = {found.duration}.")
    speed, path = _values("speed", found.speed, times, 65), _values("position", found.position, times, 65)
    largest = np.abs(speed).max()
    if not largest > 0:
        raise InputError(f"motion = {show(motion)} is at rest all the time: it must move.")
    moved = np.diff(path) / np.diff(times)
    bounds = np.sort([speed[:-1], speed[1:], _values("speed", found.speed, 0.5 * (times[1:] + times[:-1]), 64)], axis=0)
    if np.any(moved > bounds[-1] + NEGLIGIBLE * largest) or np.any(moved < bounds[0] - NEGLIGIBLE * largest):
        raise InputError(f"motion = {show(motion)}: its speed is not the rate of its position; mend one of the two.")
    return found


def _values(name: str, function: Callable[[Any], Any], given: Any, size: int) -> Array:
    """Return what a member gives, as finite numbers of the right count."""
    found = np.asarray(function(given), dtype=float)
    if found.shape != (size,) or not np.isfinite(found).all():
        raise InputError(f"motion.{name} gives {show(found.tolist())}; it must give {size} finite numbers.")
    return found
