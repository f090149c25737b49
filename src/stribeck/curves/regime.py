"""The transitions between regimes by name, and where states come from: solved, or read off the atlas."""

from __future__ import annotations

from enum import StrEnum
from typing import Literal

from stribeck.contacts.regime import BOUNDARY_FLUID_SHARE, HYDRODYNAMIC_CONTACT_SHARE, Regime, regime_of
from stribeck.quantities.units import InputError, show

__all__ = [
    "BOUNDARY_FLUID_SHARE",
    "HYDRODYNAMIC_CONTACT_SHARE",
    "METHODS",
    "Method",
    "Regime",
    "Transition",
    "check_method",
    "regime_of",
]

Method = Literal["solver", "atlas"]

METHODS: tuple[Method, ...] = ("solver", "atlas")
"""Where states come from: solved, or read off :mod:`stribeck.atlas`."""


class Transition(StrEnum):
    """The named places of a curve; the values are their names in outputs."""

    BOUNDARY_END = f"fluid carries {BOUNDARY_FLUID_SHARE:.0%} of the load"
    EQUAL_SHARES = "fluid carries 50% of the load"
    HYDRODYNAMIC_START = f"asperities cause {HYDRODYNAMIC_CONTACT_SHARE:.0%} of the friction"
    MINIMUM = "minimum of friction"


def check_method(method: str) -> Method:
    """Return ``method`` if it is one of the two."""
    for known in METHODS:
        if isinstance(method, str) and method == known:
            return known
    raise InputError(f"method = {show(method)}; it must be {' or '.join(map(repr, METHODS))}.")
