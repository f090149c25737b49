"""A measured curve from a CSV file: speed and friction, nothing else."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import dataclass

import numpy as np

from .._types import Array
from ..units import InputError, show, to_si

__all__ = ["Measured", "read_measured"]

MOST_POINTS = 20_000


@dataclass(frozen=True, eq=False)
class Measured:
    """A measured Stribeck curve.

    Attributes
    ----------
    name : str
        Name of its file.
    speed : ndarray, shape (n,)
        Sliding speed, ascending [m/s].
    friction : ndarray, shape (n,)
        Friction coefficient [-].
    """

    name: str
    speed: Array
    friction: Array


def read_measured(name: str, content: bytes) -> Measured:
    """Return a measured curve from the text of a CSV file.

    Parameters
    ----------
    name : str
        Name of the file, for sentences.
    content : bytes
        Two columns, speed and friction coefficient, with a line of names or without, separated by comma, semicolon or tab; the
        unit of the speed may stand in brackets after its name, else it is m/s.  Lines that begin with ``#`` are comments.

    Returns
    -------
    Measured
        The curve.

    Raises
    ------
    InputError
        Where a line cannot be read, or a value is no positive number.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{name} is not text in UTF-8; save it as CSV.") from None
    lines = [(i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip() and not line.lstrip().startswith("#")]
    if not lines:
        raise InputError(f"{name} is empty; it must hold two columns, speed and friction.")
    separator = next((mark for mark in ("\t", ";", ",") if mark in lines[0][1]), ",")
    rows = [(i, next(csv.reader(io.StringIO(line), delimiter=separator))) for i, line in lines]
    columns, factor = (0, 1), 1.0
    if not _is_number(rows[0][1][0]):
        columns, factor = _columns(name, rows[0][1])
        rows = rows[1:]
    if not 1 <= len(rows) <= MOST_POINTS:
        raise InputError(f"{name} holds {len(rows)} points; it must be 1 to {MOST_POINTS}.")
    values = np.array([[_value(name, i, row, column) for column in columns] for i, row in rows])
    order = np.argsort(values[:, 0])
    return Measured(name, values[order, 0] * factor, values[order, 1])


def _columns(name: str, header: list[str]) -> tuple[tuple[int, int], float]:
    """Return the columns of speed and friction, and the speed of their unit in m/s."""
    found = []
    for wanted in ("speed", "friction"):
        places = [i for i, title in enumerate(header) if re.match(rf"{wanted}\b(?!_)", title.strip(), re.IGNORECASE)]
        if not places:
            titles = ", ".join(show(title) for title in header[:6])
            raise InputError(f"{name} has no column {wanted!r}; its first line names {titles}.")
        found.append(places[0])
    unit = re.search(r"[\[(](.+)[\])]", header[found[0]])
    return (found[0], found[1]), to_si(f"1 {unit[1]}", "speed", "speed") if unit else 1.0


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _value(name: str, line: int, row: list[str], column: int) -> float:
    text = row[column].strip() if column < len(row) else ""
    if not _is_number(text) or not 0 < float(text) < float("inf"):
        raise InputError(f"{name}, line {line}: {show(text)} is not a positive number, as both columns hold.")
    return float(text)
