"""Columns of a table by what they are called, in SI units, and what lines above it say of all rows."""

import contextlib
import functools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from stribeck._types import Array
from stribeck.files.cells import (
    NUMBER_WITH_UNIT,
    THOUSANDS,
    decimal_of,
    is_named,
    number_of,
    rows_listed,
    split_header,
    thousands_in,
)
from stribeck.files.table_reading import STEP_HEADER, read_table
from stribeck.files.text_table import PLUS_MINUS, TextTable
from stribeck.files.writing import PathLike, path_of
from stribeck.quantities.units import InputError, RowError, show, to_si

BARE = {"%": 0.01, "percent": 0.01, "‰": 0.001} | dict.fromkeys(
    ("", "-", "–", "—", "/", "1", "N/N", "none", "dimensionless", "unitless"), 1.0
)  # Units of a bare number

IN_WORDS = {"time": "seconds", "length": "metres"}  # SI units of columns that may leave theirs out

STANDARD_GRAVITY = 9.80665  # [m/s^2]

_MASS = re.compile(r"(?:[mk]?g|gram|gr|lb)f?|k?p")  # also as kilopond
_TURNS_PER_SECOND = re.compile(r"(?:U/s|1/s|Hz|s\^?[-−]1|s⁻¹)")

_STATED = re.compile(
    r"\W*(?P<name>[^:;,=\t\[(]*?)\s*(?:[\[(](?P<before>[^\])]*)[\])])?\s*[:;,=\t][\s:;,=]*"
    rf"(?P<value>(?:{THOUSANDS.pattern}|[-+]?[0-9]+(?:[.,][0-9]+)?)(?:[eE][-+]?[0-9]+)?)"
    rf"(?:{PLUS_MINUS.pattern}[0-9.,]+)?\s*[;,\t]?\s*[\[(]?(?P<after>(?:[A-Za-zµμ°%][^;,:=\t\])]*)?)[\])]?[\s;,]*"
)


def is_called_or_signed(header: str, pattern: str) -> bool:
    """Return whether the words of a header match a pattern, or its letter with its primes, as E''."""
    # Primes are signs that a comparison of words leaves out.
    return is_named(header, pattern) or re.fullmatch(pattern, split_header(header)[0].strip().lower()) is not None


@functools.cache
def has_dimension(unit: str, dimension: str) -> bool:
    """Return whether a unit is one of a dimension."""
    try:
        si_factor(unit, dimension, "unit")
    except InputError:
        return False
    return True


def si_factor(unit: str, dimension: str, name: str) -> float:
    """Return the SI value of a unit; grams press as their weight, and turns are of a shaft."""
    text = unit.strip()
    if dimension == "force" and _MASS.fullmatch(text):
        return {"m": 1e-6, "k": 1.0, "l": 0.45359237}.get(text[0], 1e-3) * STANDARD_GRAVITY
    if dimension == "rotation" and _TURNS_PER_SECOND.fullmatch(text):
        return 2 * math.pi
    if dimension == "rotation":
        text = text.replace("°", "deg")
    if dimension == "viscosity":
        text = re.sub("(?<=Pa)s$", "*s", text)  # mPas, as rheometers write it, can be nothing else
    if dimension == "number":
        if text not in BARE:
            raise InputError(f"{name} = {show(text)}; the column holds bare numbers, or numbers in %.")
        return BARE[text]
    return to_si(f"1 {text}", dimension, name)


@dataclass(frozen=True)
class Column:
    """A column that a reader wants."""

    pattern: str  # What its header is called, in lower case
    dimension: str  # Of its unit; one of "number" needs none
    units: Mapping[str, float] | None = None  # Its units with their SI values, where a dimension says too little
    is_bare: bool = False  # Whether its unit may be left out, which then is that of SI
    preferred: tuple[str, ...] = ()  # What those are called that are taken of several, the first most of all

    def names_in(self, table: TextTable) -> list[str]:
        """Return the headers that may be it; of several those with a unit of its dimension, or that are preferred."""
        names = [name for name in dict.fromkeys(table.header) if name and is_called_or_signed(name, self.pattern)]
        if len(names) > 1:
            units = self.units or ()
            names = [name for name in names if table.unit(name) in units or has_dimension(table.unit(name), self.dimension)]
        for pattern in self.preferred:
            names = [name for name in names if len(names) > 1 and is_called_or_signed(name, pattern)] or names
        return names

    def is_in(self, table: TextTable) -> bool:
        """Return whether one header may be it and has a unit of it."""
        names = self.names_in(table)
        unit = table.unit(names[0]) if names else ""
        known = (unit in self.units) if self.units is not None else has_dimension(unit, self.dimension)
        return len(names) == 1 and (known if unit else self.is_bare or self.dimension == "number")

    def numbers(self, table: TextTable, header: str, *, gaps: bool) -> tuple[Array, set[str]]:
        """Return its numbers in SI units, and their units in the file."""
        units = set[str]()

        def factor(unit: str, where: str) -> float:
            units.add(unit)
            if not unit and self.is_bare:
                return 1.0
            if self.units is None:
                return si_factor(unit, self.dimension, f"{where}: unit")
            if unit not in self.units:
                raise InputError(f"{where}: the unit {show(unit)} is not one of {', '.join(self.units)}.")
            return self.units[unit]

        return table.numbers_of(header, factor, gaps=gaps), units


@dataclass(frozen=True)
class Columns:
    """Columns of a file in SI units."""

    table: TextTable
    in_si: dict[str, Array]
    headers: dict[str, str]
    units: dict[str, set[str]]  # Units of the numbers of each column in the file
    rows: tuple[int, ...]  # Row of the file in which each number stands
    notes: tuple[str, ...]  # On rows left out and on what was taken for granted

    @contextlib.contextmanager
    def named(self) -> Iterator[None]:
        """Name the file, and its row, in the refusal of what is made of the columns."""
        try:
            yield
        except RowError as problem:
            raise InputError(f"{self.table.path}: {problem.placed(f'row {self.rows[problem.index]}')}") from None
        except InputError as problem:
            raise InputError(f"{self.table.path}: {problem}") from None


def read_columns(path: PathLike, advice: str, *choices: Mapping[str, Column], gaps: bool = False) -> Columns:
    """Return the columns of the first choice that is all there, or of which also all units fit if there is one.

    Rows with ``gaps`` or text are left out, or else refused.
    """
    file = path_of(path)
    known = [column for choice in choices for column in choice.values()]
    table = read_table(
        file, expected=advice, knows=lambda name: any(is_called_or_signed(name, each.pattern) for each in known)
    )
    if table.unread and not gaps:
        rows = rows_listed(sorted(table.unread))
        raise InputError(f"{file}: no numbers of the table above in row {rows}; take text out, or begin its rows with #.")
    there = [choice for choice in choices if all(each.names_in(table) for each in choice.values())]
    fitting = (choice for choice in there if all(each.is_in(table) for each in choice.values()))
    wanted = next(fitting, (*there, *choices)[0])
    found, units, taken, bare = {}, dict[str, set[str]](), dict[str, str](), list[str]()
    for name, column in wanted.items():
        headers = column.names_in(table)
        unit = table.unit(headers[0]) if headers else ""
        without = bool(headers) and not (unit or column.is_bare or column.dimension == "number")
        if len(headers) != 1 or without:
            which = f"{len(headers)} of which may be" if len(headers) > 1 else "none of which is"
            said = f"in which {show(headers[0])} has no unit" if without else f"{which} the {name}"
            raise InputError(f"{file}: the header is {show(', '.join(table.header))}, {said}; {advice}.")
        if not gaps:  # who makes something of the whole table has no notes
            decimal_of(thousands_in(table.column(headers[0])), ".", file, f"column {show(headers[0])}")
        found[name], units[name] = column.numbers(table, headers[0], gaps=gaps)
        taken[name] = headers[0]
        if column.is_bare and not unit:
            bare.append(f"{show(headers[0])} was read in {IN_WORDS[column.dimension]}, as its header has no unit.")
    whole = ~np.isnan(list(found.values())).any(axis=0)
    empty = rows_listed(np.array(table.numbers)[~whole])
    notes = [*table.notes, *table.thousands_noted([*taken.values()]), *bare]
    if STEP_HEADER in table.header:
        notes.append(f"{len(set(table.column(STEP_HEADER)))} tables with the same header were read as one.")
    notes += [f"Rows with an empty cell left out: {empty}."] if empty else []
    places = tuple(np.array(table.numbers)[whole].tolist())
    in_si = {name: values[whole] for name, values in found.items()}
    return Columns(table, in_si, taken, units, places, tuple(notes))


def refuse_two_values(table: TextTable, rows: Sequence[int], names: Sequence[str]) -> NoReturn:
    """Refuse a file whose lines give two values of one quantity, of which no row says which is its own."""
    first, second = rows
    said = show(names[0]) if names[0] == names[1] else f"{show(names[0])} and {show(names[1])}"
    raise InputError(
        f"{table.path}: rows {first} and {second} give two values of {said}, and no row of numbers says which is its own; "
        "write a column with its unit, say one for all in the case ([fit.files], track_radius or arm in [fit]), or split "
        "the file."
    )


def refuse_late_value(table: TextTable, row: int, name: str) -> None:
    """Refuse a file in which a line gives a quantity between the rows of numbers, of which those above it have none."""
    if table.numbers[0] < row < table.numbers[-1]:
        raise InputError(
            f"{table.path}: row {row} gives {show(name)} between the rows of numbers, and nothing says that of those above "
            "it; write a column with its unit, say one for all in the case ([fit.files], track_radius or arm in [fit]), or "
            "split the file."
        )


def stated_in(table: TextTable, pattern: str) -> Iterator[tuple[int, str, str, str]]:
    """Yield row, name, number and unit of each quantity that is called so and that lines of text give, above or between."""
    for number, name, value, unit in _stated(table):
        if is_named(name, pattern):
            yield number, name, decimal_of(value, table.decimal_sign, table.path, f"row {number}") if unit else value, unit


def _stated(table: TextTable) -> Iterator[tuple[int, str, str, str]]:
    """Yield row, name, number as written and unit of each quantity that lines of text give."""
    lines = (*table.above, *table.between)
    texts = [text.replace('"', "") for _, text in lines]
    for (number, _), text, below in zip(lines, texts, [*texts[1:], ""], strict=False):
        # One quantity in a line, several in it, or names whose values stand below.
        pieces = [text, *re.split(r"[;,|]\s+|\t|(?<=[\])]),", text)]
        found = [each for each in (_STATED.fullmatch(piece.strip()) for piece in pieces) if each]
        for each in found:
            unit = PLUS_MINUS.split(each["before"] or each["after"] or "")[0].strip()
            yield number, each["name"], each["value"], unit
        mark = next((mark for mark in "\t;," if mark in text), "")
        if found or not mark:
            continue
        for header, cell in zip(text.split(mark), below.split(mark), strict=False):
            name, unit = split_header(header.strip())
            parts = NUMBER_WITH_UNIT.fullmatch(cell.strip())
            value, own = parts.groups() if parts else (cell.strip(), "")
            if number_of(value, "," if "," in value else "."):
                yield number, name, value, own or unit
