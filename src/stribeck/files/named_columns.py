"""Columns of a table by what they are called, in SI units."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping

import numpy as np

from stribeck._types import Array
from stribeck.files.cells import is_named, split_header
from stribeck.files.text_table import read_table, values_of
from stribeck.files.writing import path_of
from stribeck.quantities.units import InputError, show

__all__ = ["read_named_columns"]


def read_named_columns(
    path: str | os.PathLike[str], columns: Mapping[str, str], advice: str, factor: Callable[[str, str, str], float]
) -> list[Array]:
    """Return the columns whose names match a pattern, of rows that are whole; ``factor`` of kind, unit and name is to SI."""
    file = path_of(path)
    table = read_table(file, expected=advice, knows=lambda name: any(_matches(name, each) for each in columns.values()))
    found: list[Array] = []
    for kind, pattern in columns.items():
        names = [name for name in table.header if _matches(name, pattern)]
        if len(names) != 1:
            which = f"columns {', '.join(map(show, names))} all" if names else f"none of {', '.join(map(show, table.header))}"
            raise InputError(f"{file}: {which} may be the {kind}; {advice}.")
        unit = table.unit(names[0])
        if not unit:
            raise InputError(f"{file}: the column {show(names[0])} has no unit; {advice}.")
        rows = [(cell,) for cell in table.column(names[0])]
        values = values_of(file, rows, table.numbers, comma=table.decimal_comma(names))[:, 0]
        plain = unit.replace("·", "*").replace("s^-1", "1/s").replace("s⁻¹", "1/s")
        found.append(values * factor(kind, plain, names[0]))
    known = ~np.isnan(found).any(axis=0)
    return [values[known] for values in found]


def _matches(header: str, pattern: str) -> bool:
    """Return whether a pattern is the name of a column, its primes included."""
    return is_named(header, pattern) or re.fullmatch(pattern, split_header(header)[0].strip().lower()) is not None
