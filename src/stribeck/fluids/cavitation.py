"""Where the film ends: whether it fills the gap on both sides of the contact or ruptures behind it."""

from __future__ import annotations

from enum import StrEnum

__all__ = ["Cavitation"]


class Cavitation(StrEnum):
    """How the film ends behind the contact."""

    NONE = "none"
    """The gap is full of liquid on both sides, whatever the suction."""

    EXIT = "exit"
    """The film ruptures at ambient pressure, at the exit, where pressure and pressure gradient are zero."""

    REFORM = "reform"
    """The film ruptures at the pressure of the cavity and re-forms where it must."""
