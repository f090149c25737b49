"""Units of columns: those of a friction coefficient, of forces in grams, of rotations."""

from __future__ import annotations

import functools
import math
import re

from stribeck.quantities.units import InputError, to_si

__all__ = ["BARE", "DIMENSION", "has_dimension", "si_factor"]

BARE = {"": 1.0, "-": 1.0, "1": 1.0, "%": 0.01, "percent": 0.01, "‰": 0.001}  # Units of a friction coefficient

# Dimension of what a column may hold beside inputs of the contact.
DIMENSION = {"speed": "speed", "speed_viscosity": "drag", "hersey_number": "number", "friction": "number", "error": "number"}

STANDARD_GRAVITY = 9.80665  # [m/s^2]

_MASS = re.compile(r"(?:[mk]?g|gram|gr)f?")
_TURNS = re.compile(r"(?:r\.?p\.?m\.?|rev(?:olutions)?/min|U/min|1/min|/min|min\^?[-−]1|min⁻¹)", re.IGNORECASE)
_TURNS_PER_SECOND = re.compile(r"(?:rps|rev/s|U/s|1/s|Hz|s\^?[-−]1|s⁻¹)")


@functools.cache
def has_dimension(unit: str, dimension: str) -> bool:
    """Return whether a unit is one of a dimension."""
    try:
        si_factor(unit, dimension, "unit")
    except InputError:
        return False
    return True


def si_factor(unit: str, dimension: str, name: str) -> float:
    """Return the SI value of a unit; grams press as their weight, and turns are of a shaft."""
    text = unit.strip()
    if dimension == "force" and _MASS.fullmatch(text):
        power = {"m": 1e-6, "k": 1.0}.get(text[0], 1e-3)
        return power * STANDARD_GRAVITY
    if dimension == "rotation" and _TURNS.fullmatch(text):
        return 2 * math.pi / 60
    if dimension == "rotation" and _TURNS_PER_SECOND.fullmatch(text):
        return 2 * math.pi
    return to_si(f"1 {text}", dimension, name)
