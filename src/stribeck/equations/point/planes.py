"""The flow in the plane of each kind of film of the line."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from stribeck.equations.point.films import BlendedPlane, NewtonianPlane, PlaneFilm
from stribeck.equations.thinning.plane import ThinningPlane
from stribeck.fluids.fluid import Film
from stribeck.fluids.newtonian import Blend, Newtonian
from stribeck.fluids.shear_thinning import ShearThinning

# The flow in the plane, by the kind of film.
PLANES: dict[type, Callable[[Any], PlaneFilm]] = {
    Newtonian: NewtonianPlane,
    ShearThinning: ThinningPlane,
    Blend: lambda film: BlendedPlane(plane_of(film.film), film.newtonian),
}


def plane_of(film: Film) -> PlaneFilm:
    """Return the flow in the plane of a film; a KeyError for one that has none."""
    return PLANES[type(film)](film)
