"""Tables as text: their columns, the numbers in them, and curves that stand side by side."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from stribeck._types import Array, Flags
from stribeck.files.cells import (
    NUMBER_WITH_COMMA,
    NUMBER_WITH_POINT,
    NUMBER_WITH_UNIT,
    SUMMARY,
    THOUSANDS,
    has_number,
    is_missing,
    number_of,
    read_as,
    split_header,
    thousands_in,
)
from stribeck.quantities.units import InputError, show

CURVE_HEADER = "curve"  # Header of the column that names the curves of a file that has them side by side

PLUS_MINUS = re.compile(r"\s*(?:±|\+/-|\+-)\s*")


@dataclass(frozen=True)
class TextTable:
    """The cells of a file, as text."""

    path: str  # The file
    header: tuple[str, ...]  # Names of the columns; empty for a column without a name
    rows: tuple[tuple[str, ...], ...]  # The cells, one for each column
    numbers: tuple[int, ...]  # Row of the file in which each stands, counted from 1
    separator: str  # Separator of the columns, in words
    units_row: tuple[str, ...] = ()  # A row of units below the header; empty if there is none
    written: tuple[str, ...] = ()  # Names of the columns as the file has them
    above: tuple[tuple[int, str], ...] = ()  # Number and text of each row above the header
    between: tuple[tuple[int, str], ...] = ()  # Number and text of each line of text and comment below the header
    unread: tuple[int, ...] = ()  # Rows without numbers of its columns between or below its own, and headers of other tables
    notes: tuple[str, ...] = ()  # Notes on rows and columns that were left out or put together, one sentence each
    made: tuple[str, ...] = ()  # Headers of columns that are not in the file, with a decimal point whatever the file has

    def unit(self, name: str) -> str:
        """Return the unit of a column: that in its header, or in the row of units."""
        return split_header(name)[1] or (self.units_row[self.header.index(name)] if self.units_row else "")

    @property
    def decimal_sign(self) -> str:
        """What begins the decimals of the numbers, a comma if any of them has one and none separates the columns."""
        return "," if self.separator != "comma" and any("," in cell for row in self.rows for cell in row) else "."

    def decimal_comma(self, names: Sequence[str]) -> bool:
        """Return whether columns have decimal commas; refuse both signs, where 1,234 could mean two things."""
        comma: tuple[int, str, str] | None = None
        point: tuple[int, str, str] | None = None
        for at, name in enumerate(self.header):
            if not name or name not in names:
                continue
            for number, row in zip(self.numbers, self.rows, strict=True):
                parts = NUMBER_WITH_UNIT.fullmatch(row[at])
                text = (parts[1] if parts else row[at]).strip()
                if comma is None and NUMBER_WITH_COMMA.fullmatch(text):
                    comma = number, name, row[at]
                elif point is None and "." in text and NUMBER_WITH_POINT.fullmatch(text):
                    point = number, name, row[at]
                if comma and point:
                    break
        if comma and point:
            raise InputError(
                f"{self.path}: row {comma[0]}, column {show(comma[1])} has {show(comma[2])} with a comma and row {point[0]}, "
                f"column {show(point[1])} has {show(point[2])} with a point; use one decimal sign and no thousands separator."
            )
        return comma is not None

    def _decimal(self, name: str) -> str:
        """Return the decimal sign of a column; refuse one that marks thousands, as the signs of other columns tell."""
        if name in self.made:
            return "."
        if thousands_in(self.column(name)):
            of_file = [each for each in self.header if each and each != name and each not in self.made]
            others = [each for each in of_file if not thousands_in(self.column(each))]
            numeric = [each for each in others if all(is_missing(cell) or has_number(cell) for cell in self.column(each))]
            self.decimal_comma([name, *numeric])
        return "," if self.decimal_comma([name]) else "."

    def thousands_noted(self, names: Sequence[str]) -> list[str]:
        """Return how columns were read in which each decimal sign may stand between thousands."""
        examples = [(name, thousands_in(self.column(name))) for name in names if name in self.header]
        return [f"{show(name)}: {read_as(cell)}" for name, cell in examples if cell]

    def column(self, name: str) -> tuple[str, ...]:
        """Return the cells of a column."""
        at = self.header.index(name)
        return tuple(row[at] for row in self.rows)

    def values(self, name: str) -> Array:
        """Return the numbers of a column as written, NaN where a cell holds none."""
        decimal = self._decimal(name)
        read = [None if is_missing(cell) else number_of(cell, decimal) for cell in self.column(name)]
        return np.array([np.nan if each is None else each[0] for each in read])

    def numbers_of(
        self, name: str, factor: Callable[[str, str], float] | None = None, *, unit: str = "", gaps: bool = True
    ) -> Array:
        """Return the numbers of a column, NaN where a cell is empty if it may have gaps; refuse text.

        ``factor`` of the unit of a cell, or else of the column (``unit`` or that of the table), and of where it stands is what
        a number counts; without it numbers are as written and have no units of their own.
        """
        decimal = self._decimal(name)
        column = f"{self.path}: column {show(name)}"
        usual = 1.0 if factor is None else None
        found = np.full(len(self.rows), np.nan)
        for i, cell in enumerate(self.column(name)):
            if gaps and is_missing(cell):
                continue
            where = f"{self.path}: row {self.numbers[i]}, column {show(name)}"
            read = number_of(cell, decimal)
            if read is None or (read[1] and factor is None):
                advice = "leave the cell empty where a value is missing" if gaps else "each row needs a number"
                if THOUSANDS.fullmatch(cell):
                    advice = "write it without marks between thousands"
                raise InputError(f"{where}: {show(cell)} is not a number; {advice}.")
            number, own = read
            if own and factor is not None:
                found[i] = number * factor(own, where)
                continue
            if usual is None:
                assert factor is not None
                usual = factor(unit or self.unit(name), column)
                below = self.units_row[self.header.index(name)] if self.units_row else ""
                if below and unit in ("", self.unit(name)) and factor(below, column) != usual:
                    raise InputError(f"{column} has the unit {show(below)} in the row below; take one of both out.")
            found[i] = number * usual
        return found

    def with_column(self, name: str, cells: Sequence[str]) -> Self:
        """Return the table with one more column."""
        rows = tuple((*row, cell) for row, cell in zip(self.rows, cells, strict=True))
        units = (*self.units_row, "") if self.units_row else ()
        return replace(self, header=(*self.header, name), rows=rows, units_row=units, made=(*self.made, name))

    def of_rows(self, kept: Flags) -> Self:
        """Return the table of some of its rows."""
        places = np.flatnonzero(kept).tolist()
        return replace(self, rows=tuple(self.rows[i] for i in places), numbers=tuple(self.numbers[i] for i in places))

    def of_columns(self, kept: Sequence[int]) -> Self:
        """Return the table of some of its columns."""
        rows = tuple(tuple(row[i] for i in kept) for row in self.rows)
        units = tuple(self.units_row[i] for i in kept) if self.units_row else ()
        return replace(self, header=tuple(self.header[i] for i in kept), rows=rows, units_row=units)

    def without(self, name: str) -> Self:
        """Return the table without a column."""
        at = self.header.index(name)
        return self.of_columns([i for i in range(len(self.header)) if i != at])


def as_comparable(cell: str) -> Any:
    """Return what is equal for cells that mean the same, such as ``0.50`` and ``0.5``."""
    return number_of(cell, ",") or cell


def drop_repeated_columns(table: TextTable) -> TextTable:
    """Return the table without columns that come again with the same name and cells, and without unnamed empty ones."""
    seen: dict[str, list[tuple[Any, ...]]] = {}
    kept = []
    repeated = {name for name in table.header if table.header.count(name) > 1}
    for i, name in enumerate(table.header):
        cells = tuple(as_comparable(row[i]) if name in repeated else row[i] for row in table.rows)
        if name and cells not in seen.setdefault(name, []):
            seen[name].append(cells)
            kept.append(i)
        elif not name and any(cells):
            kept.append(i)
    return table if len(kept) == len(table.header) else table.of_columns(kept)


def rows_but_statistics(names: Sequence[str], rows: Sequence[Sequence[str]]) -> list[int]:
    """Return which rows are no statistics of others: not called so below all, nor in a column of numbers or without a name."""
    called = {
        (k, j) for k, row in enumerate(rows) for j, cell in enumerate(row) if cell[:1].isalpha() and SUMMARY.fullmatch(cell)
    }
    of_numbers = set[int]()
    for column in {j for _, j in called}:
        others = [row[column] for k, row in enumerate(rows) if (k, column) not in called]
        if others and all(has_number(cell) or not (cell or names[column]) for cell in others):
            of_numbers.add(column)
    statistics = {k for k, _ in called}
    last = next((k for k in range(len(rows), 0, -1) if k - 1 not in statistics), len(rows))
    last = max(last, (len(rows) + 1) // 2)  # a table may be one of means alone
    between = {k for k, j in called if j in of_numbers}
    return [k for k in range(last) if k not in between]


def are_pairs(header: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> bool:
    """Return whether each name stands above two columns of numbers, as of curves that were read off a picture."""
    named, unnamed = header[::2], header[1::2]
    return (
        all(named)
        and len(named) == len(unnamed)
        and not any(unnamed)
        and all(any(has_number(row[i]) for row in rows) for i in range(1, len(header), 2))
    )


def stack_curves(table: TextTable, labels: tuple[str, ...]) -> TextTable:
    """Return the table with curves that stand side by side one below another, each with its name in a column."""
    # Columns before the first label belong to all curves. Without labels, columns whose names come again in the same order,
    # with different numbers, are curves too.
    width = len(labels) or len(table.header)
    if labels:
        starts = [i for i, label in enumerate(labels) if label]
        curves = [labels[i] for i in starts]
    else:
        period = next((n for n in range(2, width // 2 + 1) if table.header[n:width] == table.header[: width - n]), 0)
        if not period or width % period or not all(table.header[:period]):
            return table
        starts = list(range(0, width, period))
        if len({tuple(row[i : i + period] for row in table.rows) for i in starts}) < len(starts):
            return table  # the same numbers again
        curves = [str(k) for k in range(1, len(starts) + 1)]
    blocks = [range(start, end) for start, end in zip(starts, [*starts[1:], width], strict=True)]
    shared = [i for i in range(len(table.header)) if not starts[0] <= i < width]
    names = list(dict.fromkeys(table.header[i] for block in blocks for i in block if table.header[i]))
    at = [{table.header[i]: i for i in reversed(block) if table.header[i]} for block in blocks]
    rows, numbers = [], []
    for curve, where in zip(curves, at, strict=True):
        for number, row in zip(table.numbers, table.rows, strict=True):
            own = [row[where[name]] if name in where else "" for name in names]
            if any(own):
                rows.append((*(row[i] for i in shared), *own, curve))
                numbers.append(number)
    units = table.units_row
    if units:
        first = {name: i for where in reversed(at) for name, i in where.items()}
        units = (*(units[i] for i in shared), *(units[first[name]] for name in names), "")
    header = (*(table.header[i] for i in shared), *names, CURVE_HEADER)
    note = f"Curves side by side: {', '.join(map(show, curves))}."
    return replace(table, header=header, rows=tuple(rows), numbers=tuple(numbers), units_row=units, notes=(*table.notes, note))


def split_errors(table: TextTable) -> TextTable:
    """Return the table with what follows a plus-minus sign in the cells of a column in one of its own."""
    for at in reversed(range(len(table.header))):
        cells = [row[at] for row in table.rows]
        parts = [PLUS_MINUS.split(cell) for cell in cells]
        pairs = [len(part) == 2 and all(map(has_number, part)) for part in parts]
        if not any(pairs) or not all(pair or is_missing(cell) for pair, cell in zip(pairs, cells, strict=True)):
            continue
        words, unit = split_header(table.header[at])
        own = [{part[k].endswith("%") for part, pair in zip(parts, pairs, strict=True) if pair} for k in (0, 1)]
        if own == [{False}, {True}] and not unit:  # per cent of each value
            unit, parts = "%", [[part[0], part[-1].rstrip("% ")] for part in parts]
        elif own == [{True}, {False}]:
            parts = [[part[0], f"{part[-1]} %"] for part in parts]
        name = f"{words} error [{unit}]" if unit else f"{words} error"
        rows = tuple(
            (*row[:at], *(part if pair else ("", "")), *row[at + 1 :])
            for row, part, pair in zip(table.rows, parts, pairs, strict=True)
        )
        units = table.units_row and (*table.units_row[: at + 1], *table.units_row[at:])
        header = (*table.header[: at + 1], name, *table.header[at + 1 :])
        note = f"{show(table.header[at])}: what follows the plus-minus sign was taken for its standard error."
        table = replace(table, header=header, rows=rows, units_row=units, notes=(*table.notes, note))
    return table
