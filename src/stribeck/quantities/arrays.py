"""Arrays of numbers that a user gives."""

from __future__ import annotations

from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.quantities.units import InputError, show


def real_array(name: str, value: Any) -> Array:
    """Return numbers or arrays of numbers as float64; refuse text, truth values, complex numbers and ragged lists."""
    try:
        found = np.asarray(value)
    except ValueError:  # ragged lists
        found = np.asarray(None)
    if found.size and found.dtype.kind not in "iuf":
        raise InputError(f"{name} = {show(value)} is not made of real numbers; give a number or an array of them.")
    with np.errstate(over="ignore"):
        return found.astype(np.float64)
