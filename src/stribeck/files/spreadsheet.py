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
            sheets = [[list(row) for row in sheet.iter_rows(values_only=True)] for sheet in book.worksheets]
            book.close()
    except Exception as problem:  # zip, XML and openpyxl raise errors of many kinds, and each means the same
        said = " ".join(str(problem).split())
        raise InputError(f"{path} cannot be read as a spreadsheet ({said}); export it as CSV.") from None
    counts = [sum(_is_number(cell) for row in sheet for cell in row) for sheet in sheets]
    if not counts or max(counts) == 0:
        raise InputError(f"{path} holds no numbers in any of its sheets; formulas count only after a program has saved them.")
    sheet = sheets[counts.index(max(counts))]
    return "\n".join("\t".join(_text(cell) for cell in row) for row in sheet)


def _is_number(cell: Any) -> bool:
    return isinstance(cell, int | float) and not isinstance(cell, bool)


def _text(cell: Any) -> str:
    if cell is None:
        return ""
    if isinstance(cell, float):
        return repr(cell) if math.isfinite(cell) else "nan"
    return " ".join(str(cell).split())
