"""The liquid beside a contact that runs into its own wake, and how much of it the contact can draw in.

What has passed a trailing edge lies on the surface where it passed; a leading edge that comes back draws it in, and pushes
ahead what it does not.  On either side the liquid T is no less than the part of it that the contact has not reached.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from stribeck._types import Array

__all__ = ["Wake"]


@dataclass(frozen=True, eq=False)
class Wake:
    """The liquid on one side of the contact; lengths in half-widths, volumes in u_Hz a."""

    way: float  # Direction in which the surface comes from there: 1 from the left, -1 from the right
    places: Array  # Positions on the surface, towards it, the first at the contact
    lying: Array  # Liquid that lies beyond each
    held: float = 0.0  # All of the liquid

    @classmethod
    def at(cls, way: float, place: float) -> Wake:
        """Return the wake of a contact that has not moved yet."""
        return cls(way, np.array([way * place]), np.zeros(1))

    def is_reached(self, place: float) -> bool:
        """Return whether the surface comes from there on the way to a position."""
        return self.way * place > float(self.places[0])

    def lies_beyond(self, place: float) -> float:
        """Return the liquid that a contact at a position has not reached; minus infinity where it is flooded."""
        return float(np.interp(self.way * place, self.places, self.lying, right=-math.inf))

    def moved(self, place: float, drawn: float) -> Wake:
        """Return the wake after a step, in which the contact has drawn in some liquid, or left some if that is negative."""
        held = self.held - drawn
        here, lying = self.way * place, held
        if self.is_reached(place) and self.lies_beyond(place) > -math.inf:
            lying = self.lies_beyond(place)
        ahead = self.places > here
        places, lies = (np.append(first, rest[ahead]) for first, rest in ((here, self.places), (lying, self.lying)))
        return replace(self, places=places, lying=lies, held=held)
