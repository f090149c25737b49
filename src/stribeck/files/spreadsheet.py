"""Workbooks as lines of text: the cells of each sheet separated by tabs, read within bounds."""

from __future__ import annotations

import io
import math
import posixpath
import re
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat

from stribeck.files.cells import has_number
from stribeck.files.reading import content_of
from stribeck.quantities.units import InputError, show

SPREADSHEET_ENDINGS = (".xlsx", ".xlsm")

# Also the letters in a sheet: many cells may refer to one long text
MAX_WORKBOOK_BYTES = 20_000_000

# Size of the parts of a workbook once they are unpacked; a small file may unpack to any size
MAX_XML_BYTES = 100_000_000

MAX_SHEET_CELLS = 2_000_000  # Cells of a sheet, with the empty ones before the last of each row

MAX_SHEET_ROWS = 1_048_576  # Rows that a sheet can have
MAX_SHEET_COLUMNS = 16_384  # Columns that a sheet can have

_CELL = re.compile(r"([A-Z]{1,3})([1-9][0-9]{0,6})")


def sheets_of(path: Path, wanted: str | None = None) -> dict[str, list[tuple[int, str]]]:
    """Return the sheets of a workbook that hold numbers."""
    content = content_of(path, MAX_WORKBOOK_BYTES, "a workbook")
    if len(content) > MAX_WORKBOOK_BYTES:
        raise InputError(f"{path} has more than {MAX_WORKBOOK_BYTES} bytes; keep the sheet with the measured rows.")
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as book:
            size = sum(each.file_size for each in book.infolist() if each.filename.endswith((".xml", ".rels")))
            if size > MAX_XML_BYTES:
                raise InputError(f"{path} unpacks to more than {MAX_XML_BYTES} bytes; keep the sheet with the measured rows.")
            sheets = dict(_sheets(path, book, wanted))
    except InputError:
        raise
    except Exception as problem:  # zip and XML raise errors of many kinds, and each means the same
        message = " ".join(str(problem).split())
        raise InputError(f"{path} cannot be read as a spreadsheet ({message}); export it as CSV.") from None
    counts = {name: sum(has_number(cell) for _, line in lines for cell in line.split("\t")) for name, lines in sheets.items()}
    if not any(counts.values()):
        which = "any of its sheets" if wanted is None else f"the sheet {show(wanted)}"
        raise InputError(f"{path} holds no numbers in {which}; formulas count only after a program has saved them.")
    ordered = sorted(filter(counts.get, counts), key=lambda each: -counts[each])
    return {name: sheets[name] for name in ordered}


def _sheets(path: Path, book: zipfile.ZipFile, wanted: str | None) -> Iterator[tuple[str, list[tuple[int, str]]]]:
    """Yield name and rows of each sheet, or of the one that is wanted."""
    target_of = {
        each["Id"]: posixpath.normpath(posixpath.join("/xl", each["Target"])).lstrip("/")
        for each in _elements(book, "xl/_rels/workbook.xml.rels", "Relationship")
    }
    names = {
        each["name"]: target_of[next(value for key, value in each.items() if key.endswith("id") and value in target_of)]
        for each in _elements(book, "xl/workbook.xml", "sheet")
    }
    if wanted is not None and wanted not in names:
        raise InputError(f"{path} has no sheet {show(wanted)}; its sheets are {', '.join(map(show, names))}.")
    strings = _SharedStrings()
    if "xl/sharedStrings.xml" in book.namelist():
        _parse(book, "xl/sharedStrings.xml", strings)
    for name, part in names.items():
        if wanted in (None, name):
            rows = _Rows(path, strings.found)
            _parse(book, part, rows)
            yield name, rows.lines()


class _Handler:
    """Handler of the elements of a part of a workbook, whose names come without a namespace."""

    def begin(self, name: str, attributes: dict[str, str]) -> None:
        """Take the beginning of an element."""

    def end(self, name: str) -> None:
        """Take the end of an element."""

    def text(self, text: str) -> None:
        """Take text inside of an element."""


def _parse(book: zipfile.ZipFile, part: str, handler: _Handler) -> None:
    """Give the elements of a part to a handler without keeping any."""
    parser = expat.ParserCreate(namespace_separator="}")
    parser.buffer_text = True

    def refuse(*_: Any) -> None:
        raise ValueError("it declares entities")

    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler = lambda name, attributes: handler.begin(name.rpartition("}")[2], attributes)
    parser.EndElementHandler = lambda name: handler.end(name.rpartition("}")[2])
    parser.CharacterDataHandler = handler.text
    with book.open(part) as file:
        parser.ParseFile(file)


def _elements(book: zipfile.ZipFile, part: str, wanted: str) -> list[dict[str, str]]:
    """Return the attributes of all elements of a name."""
    found: list[dict[str, str]] = []

    class Attributes(_Handler):
        def begin(self, name: str, attributes: dict[str, str]) -> None:
            if name == wanted:
                found.append(attributes)

    _parse(book, part, Attributes())
    return found


class _SharedStrings(_Handler):
    """The table of texts to which cells refer."""

    def __init__(self) -> None:
        self.found: list[str] = []
        self.parts: list[str] | None = None
        self.phonetic = False

    def begin(self, name: str, attributes: dict[str, str]) -> None:
        if name == "si":
            self.found.append("")
        self.phonetic = self.phonetic or name == "rPh"
        if name == "t" and not self.phonetic:
            self.parts = []

    def text(self, text: str) -> None:
        if self.parts is not None:
            self.parts.append(text)

    def end(self, name: str) -> None:
        if name == "rPh":
            self.phonetic = False
        if name == "t" and self.parts is not None:
            self.found[-1] += "".join(self.parts)
            self.parts = None


@dataclass
class _Rows(_Handler):
    """The cells of a sheet that hold something."""

    path: Path
    strings: list[str]
    cells: dict[int, dict[int, str]] = field(default_factory=dict)
    place: tuple[int, int] = (0, 0)
    kind: str = ""
    parts: list[str] = field(default_factory=list)
    listening: bool = False
    widths: dict[int, int] = field(default_factory=dict)
    count: int = 0
    length: int = 0

    def begin(self, name: str, attributes: dict[str, str]) -> None:
        row, column = self.place
        if name == "row":
            self.place = self._checked(int(attributes.get("r", row + 1)), 0)
        elif name == "c":
            at = _CELL.fullmatch(attributes["r"]) if "r" in attributes else None
            if "r" in attributes and at is None:
                raise ValueError(f"a cell is called {show(attributes['r'])}")
            self.place = self._checked(int(at[2]), _column(at[1])) if at else self._checked(row, column + 1)
            self.kind, self.parts = attributes.get("t", "n"), []
        self.listening = name in ("v", "t")

    def text(self, text: str) -> None:
        if self.listening:
            self.parts.append(text)

    def end(self, name: str) -> None:
        self.listening = False
        if name != "c" or not self.parts:
            return
        row, column = self.place
        text = _TEXTS.get(self.kind, str)("".join(self.parts)) if self.kind != "s" else self.strings[int("".join(self.parts))]
        self.length += len(text)
        if self.length > MAX_WORKBOOK_BYTES:
            raise InputError(
                f"{self.path} holds more than {MAX_WORKBOOK_BYTES} letters; keep the sheet with the measured rows."
            )
        self.count += max(0, column - self.widths.get(row, 0))
        if self.count > MAX_SHEET_CELLS:
            raise InputError(f"{self.path} has more than {MAX_SHEET_CELLS} cells; keep the sheet with the measured rows.")
        self.widths[row] = max(column, self.widths.get(row, 0))
        text = " ".join(text.split())
        self.cells.setdefault(row, {})[column] = '"{}"'.format(text.replace('"', '""')) if '"' in text else text

    def _checked(self, row: int, column: int) -> tuple[int, int]:
        if not 0 < row <= MAX_SHEET_ROWS or not 0 <= column <= MAX_SHEET_COLUMNS:
            raise ValueError(f"it has a cell in row {row}, column {column}")
        return row, column

    def lines(self) -> list[tuple[int, str]]:
        """Return the rows as lines, each up to its last cell that is filled."""
        return [
            (row, "\t".join(cells.get(i, "") for i in range(1, self.widths[row] + 1)))
            for row, cells in sorted(self.cells.items())
        ]


def _column(letters: str) -> int:
    number = 0
    for letter in letters:
        number = 26 * number + ord(letter) - ord("A") + 1
    return number


def _number(text: str) -> str:
    return text if math.isfinite(float(text)) else "nan"


def _truth(text: str) -> str:
    return "TRUE" if text == "1" else "FALSE"


_TEXTS: dict[str, Callable[[str], str]] = {"n": _number, "b": _truth}
