"""What the shapes of the package have in common: numbers in SI units, kinks, and the side from which they are seen."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from stribeck._types import Array
from stribeck.fluids.cavitation import Cavitation
from stribeck.quantities.schema import numbers_of

__all__ = ["Shape"]


@dataclass(frozen=True)
class Shape(ABC):
    """A shape of the package: a frozen class with its numbers, and its gap and slope over the lowest point."""

    name: ClassVar[str]
    label: ClassVar[str]

    # Full films hold against any suction, which behind a blunt edge or the steep side of a lip would carry loads below zero.
    cavitation: ClassVar[Cavitation] = Cavitation.EXIT

    @property
    def parameters(self) -> Mapping[str, float | str]:
        """Its numbers, and whether it is reversed."""
        turned = {"reversed": "true"} if getattr(self, "reversed", False) else {}
        return {name: getattr(self, name) for name in numbers_of(type(self))} | turned

    @property
    def places(self) -> tuple[float, ...]:
        """Where slope or curvature of the gap have a kink [m]; nowhere unless a shape says so."""
        return ()

    @abstractmethod
    def gap(self, x: Array) -> Array:
        """Return the gap at positions along the contact [m]."""

    @abstractmethod
    def slope(self, x: Array) -> Array:
        """Return the slope of the gap [-]."""
