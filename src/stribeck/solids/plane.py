"""The soft bodies that a ball is pressed on, by their kind: half-space and bonded layer."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from stribeck._types import Array
from stribeck.numerics.fourier_panels import PolarMesh
from stribeck.solids.half_plane import HalfPlane
from stribeck.solids.half_space import deflection_by_mode
from stribeck.solids.layer import Layer
from stribeck.solids.layer_plane import layer_by_mode

__all__ = ["BODIES", "MIN_LAYER_THICKNESS", "PlaneBody"]

MIN_LAYER_THICKNESS = 0.2  # Thinnest layer under a ball, in Hertz radii of a half-space: thinner ones are not tested


@dataclass(frozen=True)
class PlaneBody:
    """What meshes and equations of a ball ask of a kind of body."""

    deflection: Callable[[PolarMesh, Any], Array]
    widest_panel: Callable[[Any], float]  # Largest width of the panels near the contact for a solid [a]
    reaches: float  # One if the deflection falls as 1/r far away, as that of a half-space; zero if it falls faster


def _half_space(mesh: PolarMesh, solid: HalfPlane) -> Array:
    return deflection_by_mode(mesh)


def _any(solid: HalfPlane) -> float:
    return math.inf


def _thickness(solid: Layer) -> float:
    return solid.layer_thickness


# Body on the plane by the kind of solid of the model; the half-plane becomes the half-space.
BODIES: dict[type, PlaneBody] = {
    HalfPlane: PlaneBody(_half_space, _any, 1.0),
    Layer: PlaneBody(layer_by_mode, _thickness, 0.0),
}
