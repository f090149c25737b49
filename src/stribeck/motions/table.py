"""A motion as it was measured: speeds at instants."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from stribeck._types import Array
from stribeck.motions.motion import Motion, dense_where_slow
from stribeck.quantities.units import InputError, show, to_si


@dataclass(frozen=True)
class Table(Motion):
    """Sliding speeds at instants, straight lines between them.

    ``time`` rises from zero; both are numbers in s and m/s or text with a unit.  A table ``repeats`` if its last speed is its
    first one.
    """

    kind: ClassVar[str] = "table"

    time: Sequence[Any]
    velocity: Sequence[Any]
    repeats: bool = False

    def __post_init__(self) -> None:
        """Read the numbers, and refuse rows that are none."""
        for name, dimension in (("time", "time"), ("velocity", "speed")):
            given = getattr(self, name)
            if isinstance(given, str) or not hasattr(given, "__len__"):
                raise InputError(f"{name} = {show(given)} must be a list of numbers or of text with a unit.")
            object.__setattr__(self, name, tuple(to_si(each, dimension, name) for each in given))
        t = np.array(self.time)
        if len(t) < 2 or len(t) != len(self.velocity) or t[0] != 0 or not np.all(np.diff(t) > 0):
            raise InputError(
                f"time = {show(self.time)} with {len(self.velocity)} speeds; instants must begin at 0 and rise, and there "
                "must be as many speeds, at least two."
            )
        if not isinstance(self.repeats, bool):
            raise InputError(f"repeats = {show(self.repeats)} must be true or false, without quotes.")
        if self.repeats and self.velocity[0] != self.velocity[-1]:
            raise InputError(
                f"a table that repeats must end with the speed {self.velocity[0]:g} m/s with which it begins; its last is "
                f"{self.velocity[-1]:g} m/s."
            )

    @property
    def duration(self) -> float:
        """Time of the table [s]."""
        return float(self.time[-1])

    def speed(self, time: Array) -> Array:
        """Return the sliding speed [m/s]."""
        return np.asarray(np.interp(time, self.time, self.velocity))

    def position(self, time: Array) -> Array:
        """Return the path since the first instant [m]."""
        t, v = np.array(self.time), np.array(self.velocity)
        passed = np.append(0.0, np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t)))
        row = np.clip(np.searchsorted(t, time, side="right") - 1, 0, len(t) - 2)
        since = time - t[row]
        return np.asarray(passed[row] + since * (v[row] + 0.5 * since * (v[row + 1] - v[row]) / (t[row + 1] - t[row])))

    def times(self, steps: int) -> Array:
        """Return instants that are denser where the speed is small [s]."""
        return dense_where_slow(self, steps, self.time)
