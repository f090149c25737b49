"""A stroke to and fro as a crank drives it."""

import math
from typing import ClassVar

import numpy as np

from stribeck._types import Array
from stribeck.motions.motion import Motion
from stribeck.quantities.schema import Input, law


@law
class Sine(Motion):
    r"""A stroke to and fro, from its middle.

    .. math:: x = \tfrac12 S \sin 2\pi f t, \qquad U = \pi f S \cos 2\pi f t
    """

    kind: ClassVar[str] = "sine"

    stroke: Input = Input(
        label="stroke from end to end", symbol="$S$", dimension="length", typical="50 mm", source="a rod seal on a test rig"
    )
    frequency: Input = Input(
        label="strokes to and fro per time", symbol="$f$", dimension="rate", typical="1 1/s", source="a rod seal on a test rig"
    )
    repeats: ClassVar[bool] = True

    @property
    def duration(self) -> float:
        """Time of a cycle [s]."""
        return 1 / self.frequency

    def speed(self, time: Array) -> Array:
        """Return the sliding speed [m/s]."""
        return np.asarray(math.pi * self.frequency * self.stroke * np.cos(2 * math.pi * self.frequency * time))

    def position(self, time: Array) -> Array:
        """Return the position from the middle of the stroke [m]."""
        return np.asarray(0.5 * self.stroke * np.sin(2 * math.pi * self.frequency * time))
