"""A measured friction loop: friction over position or time of a motion to and fro, in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from stribeck._types import Array, Indices
from stribeck.files.cells import is_named, split_header
from stribeck.files.text_table import TextTable, read_table, values_of
from stribeck.files.writing import PathLike, path_of
from stribeck.quantities.units import InputError, show, to_si

__all__ = ["Loop", "read_loop"]

# Headers of each column, and the dimension of what it holds.
COLUMNS = {
    "position": (r"position|displacement|path|stroke position|weg|x", "length"),
    "time": (r"(?:(?:elapsed|test|total|cycle) )?(?:time|zeit)|t", "time"),
    "friction": (r"friction|friction coefficient|coefficient of friction|cof|mu|reibwert", "number"),
}


@dataclass(frozen=True, eq=False)
class Loop:
    """The rows of a measured friction loop."""

    path: str
    over: Literal["position", "time"]  # What friction was measured over
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
    table = read_table(path, expected="the first line must name the columns, as 'position [mm], friction'")
    columns = {name: column for name in COLUMNS if (column := _column(table, name)) is not None}
    if "friction" not in columns or len(columns) < 2:
        raise InputError(
            f"{path}: the header is {show(', '.join(table.header))}; a loop has a column 'friction', with the sign of the "
            "force against the motion, and one 'position [mm]' or 'time [s]'."
        )
    over: Literal["position", "time"] = "time" if "time" in columns else "position"
    wanted = [columns[over], columns["friction"]]
    cells = [[row[k] for k in wanted] for row in table.rows]
    comma = table.decimal_comma([table.header[k] for k in wanted])
    values = values_of(path, cells, table.numbers, comma=comma)
    there = np.isfinite(values).all(axis=1)
    unit = split_header(table.header[columns[over]])[1] or table.unit(table.header[columns[over]])
    factor = to_si(f"1 {unit}", COLUMNS[over][1], over) if unit else 1.0
    friction = values[there, 1]
    if not (np.any(friction > 0) and np.any(friction < 0)):
        raise InputError(f"{path}: friction has one sign; a loop has friction of the way back below zero.")
    return Loop(str(path), over, factor * values[there, 0], friction, np.array(table.numbers)[there])


def _column(table: TextTable, name: str) -> int | None:
    return next((k for k, header in enumerate(table.header) if is_named(header, COLUMNS[name][0])), None)
