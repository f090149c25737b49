"""Tables in text files: separator, header, decimal sign, encoding and missing values found or refused.

Measured friction, contact laws, power spectra and heights all come through here.  What the columns mean is not known here.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stribeck._types import Array
from stribeck.files.cells import COMMA, MISSING, POINT, WITH_UNIT, cells_of, has_number
from stribeck.files.reading import text_of
from stribeck.files.spreadsheet import SPREADSHEETS, text_of_spreadsheet
from stribeck.quantities.units import DIMENSIONS, InputError, show, to_si

__all__ = ["TextTable", "read_table", "read_two_columns", "values_of"]

SEPARATORS = {"\t": "tab", ";": "semicolon", ",": "comma", "|": "bar"}

LARGEST_TABLE = 20_000_000  # [byte]

BLOCK = "step"
"""Header of the column that numbers the tables of a file that has the same header above each."""

EXPECTED = "add a header such as 'speed [mm/s];friction' above rows of numbers"

LOOK_AHEAD = 3
"""Rows below a header among which one must hold numbers."""

_NAMED = re.compile(r"\s*([^\[\](),;]*?)\s*(?:[\[(]\s*(.*?)\s*[\])])?\s*")


@dataclass(frozen=True)
class TextTable:
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
        What separates the columns, in words.
    decimal_comma : bool
        Whether numbers have decimal commas.
    units_row : tuple of str
        A row of units below the header; empty if there is none.
    skipped : int
        Rows of other text above the header.
    """

    path: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers: tuple[int, ...]
    separator: str
    decimal_comma: bool
    units_row: tuple[str, ...] = ()
    skipped: int = 0


def read_table(path: Path, header_row: int | None = None, expected: str = EXPECTED) -> TextTable:
    """Return the cells of a text file of columns with a header.

    Parameters
    ----------
    path : pathlib.Path
        The file: columns separated by tab, semicolon, comma, bar or spaces; ``#`` begins a comment.
    header_row : int, optional
        Row of the names of the columns; by default the first that is no comment, or below other text the only row of names
        that has rows of as many cells with numbers below it.
    expected : str
        What to say of a file without a header.

    Returns
    -------
    TextTable
        Header and cells.

    Raises
    ------
    InputError
        If the file cannot be read, has no header, or a row has another number of cells than the header.
    """
    if path.suffix.lower() in SPREADSHEETS and path.is_file():
        text = text_of_spreadsheet(path)
    else:
        text = text_of(path, LARGEST_TABLE, "a table is a few pages of text", "a text file of columns")
    filled = _filled(text)
    skipped = 0
    if header_row is not None:
        filled = [(i, line) for i, line in filled if i >= header_row]
        if not filled or filled[0][0] != header_row:
            raise InputError(
                f"{path}: row {header_row}, where header_row expects the header, is empty, a comment or not there."
            )
    if not filled:
        raise InputError(f"{path} holds no data; {expected}.")
    if header_row is None:
        skipped = _header_at(filled)
        filled = filled[skipped:]
    number, first = filled[0]
    separator = _separator(first)
    header = tuple(cells_of(first, separator, path, number))
    elsewhere = "" if header_row or expected != EXPECTED else "; if the header is not in this row, set header_row in [fit]"
    if all(POINT.fullmatch(cell) or COMMA.fullmatch(cell) for cell in header):
        raise InputError(f"{path}: row {number} holds numbers, not names of columns; {expected}.")
    if len(header) < 2:
        raise InputError(
            f"{path}: row {number} holds one column, {show(header[0])}; "
            f"separate the columns by semicolons, tabs or commas{elsewhere}."
        )
    for name, times in Counter(header).items():
        if name and times > 1:
            raise InputError(
                f"{path}: row {number} has the column {show(name)} twice; give each column its own name{elsewhere}."
            )
    rows, numbers = [], []
    body, blocks = _one_table(filled, separator)
    for i, line in body:
        cells = _row(line, separator, len(header), path, i)
        if len(cells) != len(header):
            raise InputError(_ragged(path, i, line, cells, header, separator, elsewhere))
        rows.append(tuple(cells))
        numbers.append(i)
    units: tuple[str, ...] = ()
    if rows and not any(has_number(cell) for cell in rows[0]):
        plain = all(cell.lower() in MISSING for cell in rows[0])
        units = () if plain else tuple(cell.strip("[]()") for cell in rows[0])
        if units:
            rows, numbers = rows[1:], numbers[1:]
    if not rows:
        raise InputError(f"{path} has a header in row {number} and no rows of numbers below it{elsewhere}.")
    if blocks:
        header = (*header, BLOCK)
        rows = [(*row, str(blocks[i])) for row, i in zip(rows, numbers, strict=True)]
        units = (*units, "") if units else ()
    comma = _decimal_comma(path, header, rows, numbers)
    return TextTable(str(path), header, tuple(rows), tuple(numbers), SEPARATORS.get(separator, "space"), comma, units, skipped)


def read_two_columns(
    path: Path, plain: tuple[str, str] | None, with_units: dict[str, str]
) -> tuple[Array, tuple[float, float] | None]:
    """Return the numbers of a file.

    Parameters
    ----------
    path : pathlib.Path
        A file with a header, two numbers on each line, and comments after ``#``; commas, semicolons, tabs or spaces separate
        the numbers, whose decimal sign may be a comma if that is no separator.
    plain : tuple of str or None
        Names of the columns where they have no units; None where they need them.
    with_units : dict of str to str
        Names of the columns where they have, and the dimension of each.

    Returns
    -------
    ndarray, shape (n, 2)
        The numbers as written.
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
    table = read_table(path, expected=advice)
    found = [_NAMED.fullmatch(cell) for cell in table.header]
    names = tuple(match[1].strip().lower() if match else "" for match in found)
    units = [match[2] for match in found if match]
    values = values_of(path, table.rows, table.numbers, comma=table.decimal_comma, missing=False)
    if names == plain and units == [None, None]:
        return values, None
    if names != tuple(with_units) or not all(units):
        raise InputError(f"{path}: the header is {show(', '.join(table.header))}; {advice}.")
    kinds = zip(units, with_units.values(), names, strict=True)
    first, second = (to_si(f"1 {unit}", kind, name) for unit, kind, name in kinds)
    return values, (first, second)


def values_of(
    path: Path, rows: Sequence[Sequence[str]], numbers: Sequence[int], *, comma: bool, missing: bool = True
) -> Array:
    """Return the numbers in rows of cells, NaN where a cell holds no value if it may be ``missing``."""
    values = np.empty((len(rows), len(rows[0]) if rows else 0))
    for k, row in enumerate(rows):
        for j, cell in enumerate(row):
            try:
                values[k, j] = float(cell.replace(",", ".") if comma else cell)
            except ValueError:
                if not (missing and cell.lower() in MISSING):
                    where = f"{path}: line {numbers[k]}, column {j + 1}"
                    raise InputError(f"{where} is {show(cell)}, not a number.") from None
                values[k, j] = np.nan
    return values


def _one_table(filled: list[tuple[int, str]], separator: str) -> tuple[list[tuple[int, str]], dict[int, int]]:
    """Return the rows below a header that may come again above each step of a rig, and the step of each; text is left out.

    Text after the last row of numbers, such as "end of test", is left out too.
    """
    head = filled[0][1].strip()
    body = filled[1:]
    while len(body) > 1 and separator not in body[-1][1] and not has_number(body[-1][1]):
        body = body[:-1]
    if not any(line.strip() == head for _, line in body):
        return body, {}
    kept, blocks, block = [], {}, 1
    for i, line in body:
        if line.strip() == head:
            block += 1
        elif sum(has_number(cell) for cell in cells_of(line, separator, Path(), i)) > 1:
            kept.append((i, line))
            blocks[i] = block
    return kept, blocks


def _filled(text: str) -> list[tuple[int, str]]:
    """Return the lines that are neither empty nor comments, with their numbers."""
    lines = enumerate(text.splitlines(), 1)
    return [(i, line) for i, line in lines if line.strip(" \t;,|") and not line.lstrip().startswith("#")]


def _separator(line: str) -> str:
    return next((mark for mark in SEPARATORS if mark in line), "")


def _row(line: str, separator: str, width: int, path: Path, number: int) -> list[str]:
    """Return the cells of a row; columns that the header separates by tabs may be separated by spaces in it."""
    cells = cells_of(line, separator, path, number)
    while len(cells) > width and not cells[-1]:
        cells.pop()
    if len(cells) != width and separator == "\t":
        by_spaces = cells_of(line, "", path, number)
        return by_spaces if len(by_spaces) == width else cells
    return cells


def _header_at(lines: list[tuple[int, str]]) -> int:
    """Return the place of the header: that of the first line, unless only one below it has numbers below it as it should."""
    found = [k for k in range(len(lines)) if _is_header(lines[k : k + 1 + LOOK_AHEAD])]
    found = [k for k in found if k - 1 not in found]  # a row of units is none
    same = {lines[k][1].strip() for k in found}  # a rig may write its header again above each step
    return found[0] if len(same) == 1 and 0 not in found else 0


def _is_header(lines: list[tuple[int, str]]) -> bool:
    separator = _separator(lines[0][1])
    try:
        header, *rows = (cells_of(line, separator, Path(), 0) for _, line in lines)
    except InputError:
        return False
    if len(header) < 2 or not all(header) or any(has_number(cell) for cell in header):
        return False
    rows = [_row(line, separator, len(header), Path(), 0) for _, line in lines[1:]]
    numbers = [sum(has_number(cell) for cell in row) for row in rows]
    return bool(rows) and all(len(row) == len(header) for row in rows) and max(numbers) > 1 and max(numbers[:2]) > 1


def _ragged(
    path: Path, number: int, line: str, cells: list[str], header: tuple[str, ...], separator: str, elsewhere: str
) -> str:
    said = f"{path}: row {number} has {len(cells)} cell{'s' * (len(cells) != 1)} where the header has {len(header)}"
    wanted = len(header) - 1
    other = next((name for mark, name in SEPARATORS.items() if mark != separator and line.count(mark) == wanted), None)
    if separator == "," and len(cells) > len(header):
        return f"{said}; commas cannot both separate columns and begin decimals: export with semicolons or tabs."
    if other:
        mark = SEPARATORS.get(separator, "space")
        return f"{said}: the header is separated by {mark}s and this row by {other}s; use one separator{elsewhere}."
    return f"{said}; use one separator, and leave a cell empty if a value is missing{elsewhere}."


def _decimal_comma(path: Path, header: tuple[str, ...], rows: list[tuple[str, ...]], numbers: list[int]) -> bool:
    """Return whether numbers have decimal commas; refuse a file that has both signs, where 1,234 could mean two things."""
    comma: tuple[int, str, str] | None = None
    point: tuple[int, str, str] | None = None
    for number, row in zip(numbers, rows, strict=True):
        for name, cell in zip(header, row, strict=True):
            parts = WITH_UNIT.fullmatch(cell)
            text = (parts[1] if parts else cell).strip()
            if comma is None and COMMA.fullmatch(text):
                comma = number, name, cell
            elif point is None and "." in text and POINT.fullmatch(text):
                point = number, name, cell
    if comma and point:
        raise InputError(
            f"{path}: row {comma[0]}, column {show(comma[1])} has {show(comma[2])} with a comma and row {point[0]}, "
            f"column {show(point[1])} has {show(point[2])} with a point; use one decimal sign and no thousands separator."
        )
    return comma is not None
