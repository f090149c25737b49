"""Spreadsheets as text: the sheet with most numbers, its cells separated by tabs."""

from __future__ import annotations

import math
import warnings
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from stribeck.files.writing import MissingExtraError
from stribeck.quantities.units import InputError

__all__ = ["SPREADSHEETS", "text_of_spreadsheet"]

SPREADSHEETS = (".xlsx", ".xlsm")

LARGEST_CELLS = 5_000_000
"""Cells of a workbook that are read; a small file may unpack to any number."""


def text_of_spreadsheet(path: Path) -> str:
    """Return the sheet of a workbook that holds most numbers, as text with tabs.

    Parameters
    ----------
    path : pathlib.Path
        The workbook.

    Returns
    -------
    str
        A line for each row, so that rows keep their numbers; numbers with a decimal point.

    Raises
    ------
    InputError
        If it cannot be read, or holds no numbers.
    MissingExtraError
        If openpyxl is not installed.
    """
    if find_spec("openpyxl") is None:
        raise MissingExtraError("a spreadsheet", "rig", "openpyxl")
    import openpyxl

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of styles and validations, which do not matter here
            book = openpyxl.load_workbook(path, read_only=True, data_only=True)
            sheets = _sheets(path, book)
            book.close()
    except InputError:
        raise
    except Exception as problem:  # zip, XML and openpyxl raise errors of many kinds, and each means the same
        said = " ".join(str(problem).split())
        raise InputError(f"{path} cannot be read as a spreadsheet ({said}); export it as CSV.") from None
    counts = [sum(_is_number(cell) for row in sheet for cell in row) for sheet in sheets]
    if not counts or max(counts) == 0:
        raise InputError(f"{path} holds no numbers in any of its sheets; formulas count only after a program has saved them.")
    sheet = sheets[counts.index(max(counts))]
    width = max(map(len, sheet))
    return "\n".join("\t".join([*map(_text, row), *[""] * (width - len(row))]) for row in sheet)


def _sheets(path: Path, book: Any) -> list[list[list[Any]]]:
    """Return the cells of each row of each sheet, up to its last that is filled."""
    sheets, count = [], 0
    for sheet in book.worksheets:
        rows = []
        for values in sheet.iter_rows(values_only=True):
            last = max((i for i, cell in enumerate(values, 1) if cell is not None), default=0)
            count += 1 + last
            if count > LARGEST_CELLS:
                raise InputError(f"{path} has more than {LARGEST_CELLS} cells; keep the sheet with the measured rows.")
            rows.append(list(values[:last]))
        sheets.append(rows)
    return sheets


def _is_number(cell: Any) -> bool:
    return isinstance(cell, int | float) and not isinstance(cell, bool)


def _text(cell: Any) -> str:
    if cell is None:
        return ""
    if isinstance(cell, float):
        return repr(cell) if math.isfinite(cell) else "nan"
    return " ".join(str(cell).split())
