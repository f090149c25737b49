"""A motion whose speed changes evenly: a start, a run-down."""

from typing import ClassVar

import numpy as np

from stribeck._types import Array
from stribeck.motions.motion import Motion
from stribeck.quantities.schema import Input, law


@law
class Ramp(Motion):
    r"""A speed that changes evenly from one to another.

    .. math:: U = U_0 + (U_1 - U_0) \frac{t}{T}
    """

    kind: ClassVar[str] = "ramp"

    start: Input = Input(
        label="first speed", symbol="$U_0$", dimension="speed", typical="1 mm/s", source="a slow sliding test", zero=True
    )
    end: Input = Input(
        label="last speed", symbol="$U_1$", dimension="speed", typical="0.1 m/s", source="a rod seal on a test rig", zero=True
    )
    duration: Input = Input(
        label="time of the ramp", symbol="$T$", dimension="time", typical="100 ms", source="the start of a test rig"
    )
    repeats: ClassVar[bool] = False

    def speed(self, time: Array) -> Array:
        """Return the sliding speed [m/s]."""
        return np.asarray(self.start + (self.end - self.start) * time / self.duration)

    def position(self, time: Array) -> Array:
        """Return the path since the start [m]."""
        return np.asarray(self.start * time + 0.5 * (self.end - self.start) * time**2 / self.duration)
