r"""What roughness does to the flow through a narrow gap: flow factors and friction factors, as functions of the mean gap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.fluids.laws import FlowFactors

__all__ = ["Smooth"]


@dataclass(frozen=True)
class Smooth(FlowFactors):
    """The flow between smooth surfaces, which a gap many times the roughness is too."""

    def pressure(self, gap: Array) -> tuple[Array, Array]:
        """Return one and zero."""
        return np.ones_like(gap), np.zeros_like(gap)

    def shear(self, gap: Array) -> tuple[Array, Array]:
        """Return zero twice."""
        return np.zeros_like(gap), np.zeros_like(gap)
