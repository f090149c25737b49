"""Text files of two columns with a header: a table of a contact law, or of a power spectrum."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from stribeck._types import Array
from stribeck.quantities.units import DIMENSIONS, InputError, show, to_si

__all__ = ["read_two_columns"]

LARGEST_FILE = 10_000_000

_HEADER = re.compile(r"\s*([^\[\](),;]*?)\s*(?:[\[(]\s*(.*?)\s*[\])])?\s*")


def read_two_columns(
    path: Path, plain: tuple[str, str] | None, with_units: dict[str, str]
) -> tuple[Array, tuple[float, float] | None]:
    """Return the numbers of a file.

    Parameters
    ----------
    path : pathlib.Path
        A file with a header, two numbers on each line, and comments after ``#``; commas, semicolons or tabs part the numbers,
        and where that are no commas these may be decimal.
    plain : tuple of str or None
        Names of the columns where they have no units; None where they need them.
    with_units : dict of str to str
        Names of the columns where they have, and the dimension of each.

    Returns
    -------
    ndarray, shape (n, 2)
        The numbers as they stand.
    tuple of float or None
        The SI values of the units, if it has any.

    Raises
    ------
    InputError
        If the file cannot be read, or is no such table; the sentence names line and column.
    """
    example = ", ".join(f"{name} [{DIMENSIONS[kind].example.split()[1]}]" for name, kind in with_units.items())
    advice = f"the first line must be {show(example)}, with the units of the file"
    if plain is not None:
        advice = f"the first line must be {show(', '.join(plain))}, or with units such as {show(example)}"
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path} is not text in UTF-8; save the table as CSV.") from None
    except (OSError, ValueError) as problem:
        raise InputError(f"{path} cannot be read ({getattr(problem, 'strerror', problem)}); give a CSV file.") from None
    if len(content) > LARGEST_FILE:
        raise InputError(f"{path} has more than {LARGEST_FILE} bytes; some hundred rows are enough.")
    lines = [(i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip() and not line.lstrip().startswith("#")]
    if not lines:
        raise InputError(f"{path} is empty; {advice}.")
    separator = next((sign for sign in ";\t," if sign in lines[0][1]), None)
    header = lines[0][1].split(separator)
    found = [_HEADER.fullmatch(cell) for cell in header]
    names = tuple(match.group(1).strip().lower() if match else "" for match in found)
    units = [match.group(2) for match in found if match]
    rows = np.array([_row(path, i, line.split(separator), separator) for i, line in lines[1:]]).reshape(-1, 2)
    if names == plain and units == [None, None]:
        return rows, None
    if names != tuple(with_units) or not all(units):
        raise InputError(f"{path}: the header is {show(', '.join(cell.strip() for cell in header))}; {advice}.")
    kinds = zip(units, with_units.values(), names, strict=True)
    first, second = (to_si(f"1 {unit}", kind, name) for unit, kind, name in kinds)
    return rows, (first, second)


def _row(path: Path, number: int, cells: list[str], separator: str | None) -> tuple[float, float]:
    if len(cells) != 2:
        raise InputError(f"{path}, line {number}: {len(cells)} columns where two are expected.")
    values = []
    for column, cell in zip(("first", "second"), cells, strict=True):
        written = cell.strip().replace(",", ".") if separator != "," else cell.strip()
        try:
            values.append(float(written))
        except ValueError:
            raise InputError(f"{path}, line {number}, {column} column: {show(cell.strip())} is not a number.") from None
    return values[0], values[1]
