"""What the tables of a geometry hold of its friction: from logarithms to the observables that its friction rule takes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.atlas.table import FRICTION_RADIUS
from stribeck.contacts.cut_off import FarFilm
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Geometry
from stribeck.solids import hertz

# An observable, and if wanted its derivatives by ln(speed), ln(load) and ln(roughness), shape (3, n).
Part = tuple[Array, Array | None]


class Drag(NamedTuple):
    """How the tables of one geometry hold the viscous friction."""

    names: Callable[[Definition], tuple[str, ...]]
    parts: Callable[[dict[str, Part], Array, Array, FarFilm], dict[str, Part]]
    dry_offset: float  # Offset of the dry smooth contact [u_Hz]


def _times(factor: Array, log: Part, powers: tuple[float, float, float]) -> Part:
    """Return factor times the exponential of a logarithm; ``powers`` are those of the groups in the factor."""
    value = factor * np.exp(log[0])
    return value, None if log[1] is None else value * (log[1] + np.array(powers)[:, None])


def _sum(parts: tuple[Part, ...], signs: tuple[float, ...]) -> Part:
    pairs = list(zip(parts, signs, strict=True))
    value = np.asarray(sum(sign * each for (each, _), sign in pairs))
    slopes = [sign * slope for (_, slope), sign in pairs if slope is not None]
    return value, np.asarray(sum(slopes)) if slopes else None


def _line_names(definition: Definition) -> tuple[str, ...]:
    return (f"viscous_{definition}",)


def _line_parts(logs: dict[str, Part], speed: Array, load: Array, film: FarFilm) -> dict[str, Part]:
    return {name: _times(np.sqrt(load) * speed, log, (1.0, 0.5, 0.0)) for name, log in logs.items()}


def _ball_names(definition: Definition) -> tuple[str, ...]:
    return "couette", "poiseuille", "published"


def _ball_parts(logs: dict[str, Part], speed: Array, load: Array, film: FarFilm) -> dict[str, Part]:
    integrals = {name: _times(speed, log, (1.0, 0.0, 0.0)) for name, log in logs.items()}
    couette, poiseuille = integrals["couette"], integrals["poiseuille"]
    found = {}
    for name, part, constant in (("J_couette", couette, film.couette), ("J_poiseuille", poiseuille, film.poiseuille)):
        far = speed * (constant * math.log(FRICTION_RADIUS))
        found[name] = _sum((part, (far, np.stack([far, 0 * far, 0 * far]))), (1.0, -1.0))
    found["J_pcx"] = _sum((couette, poiseuille, integrals["published"]), (1.0, 1.0, -1.0))
    return found


# The rules by geometry.
DRAG: dict[Geometry, Drag] = {
    "line": Drag(_line_names, _line_parts, hertz.HERTZ_OFFSET),
    "point": Drag(_ball_names, _ball_parts, -1.0),
}
