"""A motion that comes to rest and stays there."""

from typing import ClassVar

import numpy as np

from stribeck._types import Array
from stribeck.motions.motion import Motion
from stribeck.quantities.schema import Input, law


@law
class Stop(Motion):
    r"""A speed that falls evenly to zero, and rest after it.

    .. math:: U = U_0 \max\left(1 - \frac{t}{T_b}, 0\right)
    """

    kind: ClassVar[str] = "stop"

    start: Input = Input(
        label="speed before the stop", symbol="$U_0$", dimension="speed", typical="0.1 m/s", source="a rod seal on a test rig"
    )
    braking_time: Input = Input(
        label="time of braking", symbol="$T_b$", dimension="time", typical="10 ms", source="the brake of a test rig"
    )
    rest: Input = Input(label="time at rest", symbol="$T_r$", dimension="time", typical="1 s", source="a pause")
    repeats: ClassVar[bool] = False

    @property
    def duration(self) -> float:
        """Time of both [s]."""
        return self.braking_time + self.rest

    def speed(self, time: Array) -> Array:
        """Return the sliding speed [m/s]."""
        return np.asarray(self.start * np.maximum(1 - time / self.braking_time, 0.0))

    def position(self, time: Array) -> Array:
        """Return the path since the first instant [m]."""
        braked = np.minimum(time, self.braking_time)
        return np.asarray(self.start * (braked - 0.5 * braked**2 / self.braking_time))

    def times(self, steps: int) -> Array:
        """Return instants, half of them at rest and there ever farther apart [s]."""
        half = steps // 2
        brake = np.linspace(0.0, self.braking_time, half + 1)
        first = self.braking_time / half
        grown = np.geomspace(1.0, 1.0 + self.rest / first, steps - half + 1) - 1.0
        found = np.append(brake, self.braking_time + first * grown[1:])
        found[-1] = self.duration
        return np.asarray(found)
