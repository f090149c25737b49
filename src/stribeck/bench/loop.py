"""A measured friction loop: friction over position or time of a motion to and fro, in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stribeck._types import Array, Indices
from stribeck.files.columns import Column, read_columns
from stribeck.files.writing import PathLike, path_of
from stribeck.quantities.units import InputError

__all__ = ["Loop", "read_loop"]

FRICTION = Column(r"friction|friction coefficient|coefficient of friction|cof|mu|reibwert", "number")

# What friction may be measured over, the first that is there
OVER = {
    "time": Column(r"(?:(?:elapsed|test|total|cycle) )?(?:time|zeit)|t", "time", is_bare=True),
    "position": Column(r"position|displacement|path|stroke position|weg|x", "length", is_bare=True),
}

ADVICE = "a loop has a column 'friction', with the sign of the force against the motion, and one 'position [mm]' or 'time [s]'"


@dataclass(frozen=True, eq=False)
class Loop:
    """The rows of a measured friction loop."""

    path: str
    over: str  # "position" or "time", what friction was measured over
    values: Array  # [m or s]
    friction: Array  # With the sign of the force against the motion [-]
    rows: Indices  # Row of the file in which each stands

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.friction)


def read_loop(path: PathLike) -> Loop:
    """Read a friction loop: a column of position or time, and one of the friction coefficient with its sign."""
    path = path_of(path)
    if not Path(path).is_file():
        raise InputError(f"{path}: there is no such file.")
    found, rows = read_columns(path, ADVICE, *({name: over, "friction": FRICTION} for name, over in OVER.items()), gaps=True)
    friction = found.pop("friction")
    [(over, values)] = found.items()
    if not (np.any(friction > 0) and np.any(friction < 0)):
        raise InputError(f"{path}: friction has one sign; a loop has friction of the way back below zero.")
    return Loop(str(path), over, values, friction, rows)
