"""The interface of a guess of a state, on the whole line."""

from __future__ import annotations

from typing import Protocol

from stribeck._types import Array
from stribeck.numerics.panels import Mesh


class Guess(Protocol):
    """A guessed state, on the whole line."""

    @property
    def flux_gap(self) -> float:
        """Guess of the flux gap."""

    @property
    def offset(self) -> float:
        """Guess of the offset."""

    @property
    def exit(self) -> float:
        """Guess of the exit, from which x is measured if the film has a free one."""

    @property
    def cavity_stretch(self) -> float:
        """Guess of stretch of the cavity, one if the film does not re-form."""

    @property
    def reformation(self) -> float:
        """Coordinate at which the film re-forms; infinite if it does not."""

    @property
    def minimum_position(self) -> float:
        """Approximate position of the minimum gap."""

    def log_gap(self, mesh: Mesh) -> Array:
        """Return the logarithm of the gap at the nodes of ``mesh``."""

    def fields(self, x: Array) -> Array:
        """Return the logarithm of the gap and, if known, the fluid pressure at ``x``, shape (1 or 2, len(x))."""
