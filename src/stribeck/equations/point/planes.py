"""The flow in the plane of each kind of film of the line."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stribeck.equations.point.films import PLAIN, NewtonianPlane, PlaneFilm
from stribeck.equations.thinning.plane import ThinningPlane
from stribeck.fluids.fluid import Film
from stribeck.fluids.laws import RateLaw
from stribeck.fluids.newtonian import Newtonian
from stribeck.fluids.shear_thinning import ShearThinning

PLANES: dict[type, Callable[[Any], PlaneFilm]] = {Newtonian: NewtonianPlane, ShearThinning: ThinningPlane}
"""The flow in the plane, by the kind of film."""


def plane_of(film: Film) -> PlaneFilm:
    """Return the flow in the plane of a film; a KeyError for one that has none."""
    return PLAIN if isinstance(film, Newtonian) and film.is_plain else PLANES[type(film)](film)


def has_viscosity_at_rest(law: RateLaw) -> bool:
    """Return whether the viscosity at low rates is that of the contact, as the far film of a ball requires."""
    slow = np.array([1e-60])
    return abs(float(law.stress(slow)[0][0] / slow[0]) - 1.0) < 1e-3
