"""The states of a design: every combination of a grid, the rows of a list, or points spread at random over ranges.

Which inputs these are, and what they mean, is not known here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from stribeck._types import Array

__all__ = ["KINDS", "RANDOM_KINDS", "Axis", "Kind", "points_of"]

Kind = Literal["grid", "list", "random", "latin-hypercube", "sobol"]

KINDS: tuple[Kind, ...] = get_args(Kind)
RANDOM_KINDS: tuple[Kind, ...] = KINDS[2:]  # Kinds of design whose number of points is given


@dataclass(frozen=True)
class Axis:
    """Values of one input in a design: a list or a range."""

    name: str  # The input
    values: tuple[float, ...] = ()  # Values of a list; empty for a range
    low: float = math.nan  # Ends of a range
    high: float = math.nan  # Ends of a range
    points: int = 0  # Values on a range in a grid; 0 where the design draws them
    spacing: Literal["log", "linear"] = "log"  # In what a range is even

    def __len__(self) -> int:
        """Return the number of values in a grid or a list."""
        return len(self.values) or self.points

    def every(self) -> Array:
        """Return the values that a grid or a list takes."""
        if self.values:
            return np.array(self.values)
        return np.asarray((np.geomspace if self.spacing == "log" else np.linspace)(self.low, self.high, self.points))

    def at(self, parts: Array) -> Array:
        """Return the values at given parts of the way, 0 to 1: on a range, or one of the listed."""
        if self.values:
            places = np.minimum((parts * len(self.values)).astype(int), len(self.values) - 1)
            return np.asarray(np.array(self.values)[places])
        if self.spacing == "log":
            return np.asarray(np.exp(math.log(self.low) + parts * (math.log(self.high) - math.log(self.low))))
        return np.asarray(self.low + parts * (self.high - self.low))


def points_of(kind: Kind, axes: Sequence[Axis], points: int = 0, seed: int = 0) -> dict[str, Array]:
    """Return the value of each axis at each state of a design."""
    if kind == "list":
        return {axis.name: axis.every() for axis in axes}
    if kind == "grid":
        meshes = np.meshgrid(*(axis.every() for axis in axes), indexing="ij")
        return {axis.name: mesh.ravel() for axis, mesh in zip(axes, meshes, strict=True)}
    parts = _parts(kind, len(axes), points, seed)
    return {axis.name: axis.at(parts[:, i]) for i, axis in enumerate(axes)}


def _parts(kind: Kind, axes: int, points: int, seed: int) -> Array:
    """Return points in the unit cube, shape (points, axes)."""
    if kind == "random":
        return np.random.default_rng(seed).random((points, axes))
    from scipy.stats import qmc  # slow to import

    # The seed by its old name, which SciPy before 1.15 knows too.
    sampler = (qmc.LatinHypercube if kind == "latin-hypercube" else qmc.Sobol)(axes, seed=np.random.default_rng(seed))
    return np.asarray(sampler.random(points))
