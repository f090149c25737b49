"""A laboratory's text file as header and cells: separator, decimal sign, encoding and missing values found or refused.

What the columns mean is for :mod:`stribeck.fits.measurements`.
"""

from __future__ import annotations

import codecs
import csv
import re
from dataclasses import dataclass
from pathlib import Path

from stribeck.quantities.units import InputError, show

__all__ = ["MISSING", "LabTable", "number_of", "read_table"]

LARGEST_FILE = 20_000_000  # [byte]

MISSING = frozenset({"", "-", "--", "na", "n/a", "nan", "null", "none", "#n/a", "#nv", "nv", "?"})
"""Cells that hold no value, in lower case."""

SEPARATORS = {"\t": "tab", ";": "semicolon", ",": "comma", "|": "bar"}

_POINT = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?")
_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+(?:[eE][+-]?[0-9]{1,3})?")
_WITH_UNIT = re.compile(r"([+-]?[0-9.,]+(?:[eE][+-]?[0-9]{1,3})?)\s*([A-Za-zµμ%°].*)")


@dataclass(frozen=True)
class LabTable:
    """The cells of a file, as text.

    Parameters
    ----------
    path : str
        The file.
    header : tuple of str
        Names of the columns.
    rows : tuple of tuple of str
        The cells, one for each column.
    numbers : tuple of int
        Row of the file in which each stands, counted from 1.
    separator : str
        What parts the columns, in words.
    decimal_comma : bool
        Whether numbers have decimal commas.
    units_row : tuple of str
        A row of units below the header; empty where there is none.
    """

    path: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers: tuple[int, ...]
    separator: str
    decimal_comma: bool
    units_row: tuple[str, ...] = ()

    def column(self, name: str) -> list[str]:
        """Return the cells of a column."""
        at = self.header.index(name)
        return [row[at] for row in self.rows]


def read_table(path: Path, header_row: int | None = None) -> LabTable:
    """Return the cells of a text file of columns.

    Parameters
    ----------
    path : pathlib.Path
        The file: columns apart by tab, semicolon, comma, bar or spaces; ``#`` begins a comment.
    header_row : int, optional
        Row of the names of the columns; the first that is no comment by default.

    Returns
    -------
    LabTable
        Header and cells.

    Raises
    ------
    InputError
        If the file cannot be read, has no header, or a row has another number of cells than that.
    """
    lines = _text(path).splitlines()
    filled = [(i, line) for i, line in enumerate(lines, 1) if line.strip(" \t;,|") and not line.lstrip().startswith("#")]
    if header_row is not None:
        filled = [(i, line) for i, line in filled if i >= header_row]
        if not filled or filled[0][0] != header_row:
            raise InputError(
                f"{path}: row {header_row}, where header_row expects the header, is empty, a comment or not there."
            )
    if not filled:
        raise InputError(f"{path} holds no data; a header such as 'speed [mm/s];friction' and rows of numbers are wanted.")
    number, first = filled[0]
    separator = next((mark for mark in SEPARATORS if mark in first), "")
    header = tuple(_cells(first, separator, path, number))
    if all(_POINT.fullmatch(cell) or _COMMA.fullmatch(cell) for cell in header):
        raise InputError(
            f"{path}: row {number} holds numbers, not names of columns; add a header such as 'speed [mm/s];friction' above it."
        )
    if len(header) < 2:
        raise InputError(
            f"{path}: row {number} holds one column, {show(header[0])}; "
            "part the columns by semicolons, tabs or commas, or say with header_row in [fit] where the header is."
        )
    for name in header:
        if name and header.count(name) > 1:
            raise InputError(f"{path}: row {number} has the column {show(name)} twice; give each column its own name.")
    rows, numbers = [], []
    for i, line in filled[1:]:
        cells = _cells(line, separator, path, i)
        while len(cells) > len(header) and not cells[-1]:
            cells.pop()
        if len(cells) != len(header):
            raise InputError(_ragged(path, i, line, cells, header, separator))
        rows.append(tuple(cells))
        numbers.append(i)
    units: tuple[str, ...] = ()
    if rows and not any(re.search(r"[0-9]", cell) and number_of(cell, ",") is not None for cell in rows[0]):
        plain = all(cell.lower() in MISSING for cell in rows[0])
        units = () if plain else tuple(cell.strip("[]()") for cell in rows[0])
        if units:
            rows, numbers = rows[1:], numbers[1:]
    if not rows:
        raise InputError(f"{path} has a header in row {number} and no rows of numbers below it.")
    comma = _decimal_comma(path, header, rows, numbers)
    return LabTable(str(path), header, tuple(rows), tuple(numbers), SEPARATORS.get(separator, "space"), comma, units)


def number_of(cell: str, decimal: str = ".") -> tuple[float, str] | None:
    """Return the number that a cell holds and its own unit, or None.

    Parameters
    ----------
    cell : str
        The text.
    decimal : {".", ","}
        The decimal sign; a comma lets points pass too.

    Returns
    -------
    tuple of float and str, or None
        Number and unit, empty where there is none.
    """
    text = cell.replace("\N{MINUS SIGN}", "-").strip()
    unit = ""
    bare = _POINT.fullmatch(text) or _COMMA.fullmatch(text)
    with_unit = None if bare else _WITH_UNIT.fullmatch(text)
    if with_unit:
        text, unit = with_unit.groups()
    if decimal == "," and _COMMA.fullmatch(text):
        text = text.replace(",", ".")
    return (float(text), unit) if _POINT.fullmatch(text) else None


def _text(path: Path) -> str:
    try:
        content = path.read_bytes()
    except (OSError, ValueError) as problem:
        reason = getattr(problem, "strerror", problem)
        received = f"{path} is a directory" if path.is_dir() else f"{path} cannot be read ({reason})"
        raise InputError(f"{received}; give the path of a text file with measured friction.") from None
    if len(content) > LARGEST_FILE:
        raise InputError(f"{path} has more than {LARGEST_FILE} bytes; a measured curve is a few pages of text.")
    for mark, code in ((codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16")):
        if content.startswith(mark):
            return content.decode(code, errors="replace")
    if b"\0" in content:
        raise InputError(f"{path} is not text (a spreadsheet?); export it as CSV.")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")  # what spreadsheets in Europe write


def _cells(line: str, separator: str, path: Path, number: int) -> list[str]:
    if separator:
        try:
            [cells] = csv.reader([line], delimiter=separator, skipinitialspace=True, strict=True)
        except (csv.Error, ValueError) as problem:
            raise InputError(f"{path}: row {number} cannot be parted into cells ({problem}); check its quotes.") from None
        return [cell.replace("\N{NO-BREAK SPACE}", " ").strip() for cell in cells]
    cells = []
    for part in line.split():
        # A unit in brackets belongs to the word before it.
        if cells and (part[0] in "[(" or cells[-1].count("[") > cells[-1].count("]")):
            cells[-1] += f" {part}"
        else:
            cells.append(part)
    return cells


def _ragged(path: Path, number: int, line: str, cells: list[str], header: tuple[str, ...], separator: str) -> str:
    said = f"{path}: row {number} has {len(cells)} cell{'s' * (len(cells) != 1)} where the header has {len(header)}"
    wanted = len(header) - 1
    other = next((name for mark, name in SEPARATORS.items() if mark != separator and line.count(mark) == wanted), None)
    if separator == "," and len(cells) > len(header):
        return f"{said}; commas cannot both part columns and begin decimals: export with semicolons or tabs."
    if other:
        mark = SEPARATORS.get(separator, "space")
        return f"{said}: the header is parted by {mark}s and this row by {other}s; use one of them."
    return f"{said}; leave a cell empty where a value is missing, and part all rows alike."


def _decimal_comma(path: Path, header: tuple[str, ...], rows: list[tuple[str, ...]], numbers: list[int]) -> bool:
    """Return whether numbers have decimal commas; refuse a file that has both signs, where 1,234 could mean two things."""
    comma: tuple[int, str, str] | None = None
    point: tuple[int, str, str] | None = None
    for number, row in zip(numbers, rows, strict=True):
        for name, cell in zip(header, row, strict=True):
            parts = _WITH_UNIT.fullmatch(cell)
            text = (parts[1] if parts else cell).strip()
            if comma is None and _COMMA.fullmatch(text):
                comma = number, name, cell
            elif point is None and "." in text and _POINT.fullmatch(text):
                point = number, name, cell
    if comma and point:
        raise InputError(
            f"{path}: row {comma[0]}, column {show(comma[1])} has {show(comma[2])} with a comma and row {point[0]}, "
            f"column {show(point[1])} has {show(point[2])} with a point; use one decimal sign and no thousands separator."
        )
    return comma is not None
