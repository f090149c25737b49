"""Workbooks as lines of text: the cells of each sheet separated by tabs, read within bounds."""

import io
import math
import posixpath
import re
import zipfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from pathlib import Path
from types import MappingProxyType
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

# Formats that a workbook does not spell out: of per cent, dates and times
_BUILT_IN = (
    {"9": "0%", "10": "0.00%", "22": "d h"}
    | dict.fromkeys(("14", "15", "16", "17"), "d")
    | dict.fromkeys(("18", "19", "20", "21", "45", "46", "47"), "h")
)
_QUOTED = re.compile(
    r'"[^"]*"|\\.|\[\$[^\]]*\]|\[(?:color ?\d+|black|blue|cyan|green|magenta|red|white|yellow)\]', re.IGNORECASE
)

_CELL = re.compile(r"([A-Z]{1,3})([1-9][0-9]{0,6})")


def sheets_of(path: Path, wanted: str | None = None) -> dict[str, tuple[list[tuple[int, str]], set[int]]]:
    """Return rows of the sheets of a workbook that hold numbers, and which of them are hidden."""
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
    counts = {
        name: sum(has_number(cell) for _, line in lines for cell in line.split("\t")) for name, (lines, _) in sheets.items()
    }
    if not any(counts.values()):
        which = "any of its sheets" if wanted is None else f"the sheet {show(wanted)}"
        raise InputError(f"{path} holds no numbers in {which}; formulas count only after a program has saved them.")
    ordered = sorted(filter(counts.get, counts), key=lambda each: -counts[each])
    return {name: sheets[name] for name in ordered}


def _sheets(
    path: Path, book: zipfile.ZipFile, wanted: str | None
) -> Iterator[tuple[str, tuple[list[tuple[int, str]], set[int]]]]:
    """Yield name, rows and hidden rows of each sheet, or of the one that is wanted."""
    targets: dict[str, str] = {}
    _parse(
        book,
        "xl/_rels/workbook.xml.rels",
        {"Relationship": lambda each, _: targets.update({each["Id"]: each["Target"]})},
    )
    named: list[dict[str, str]] = []
    _parse(book, "xl/workbook.xml", {"sheet": lambda each, _: named.append(each)})
    names = {
        each["name"]: next(targets[value] for key, value in each.items() if key.endswith("id") and value in targets)
        for each in named
    }
    if wanted is not None and wanted not in names:
        raise InputError(f"{path} has no sheet {show(wanted)}; its sheets are {', '.join(map(show, names))}.")
    strings: list[str] = []
    if "xl/sharedStrings.xml" in book.namelist():
        _parse(book, "xl/sharedStrings.xml", {"si": lambda _, text: strings.append(text)})
    formats = _formats(book) if "xl/styles.xml" in book.namelist() else []
    for name, target in names.items():
        if wanted in (None, name):
            rows = _Rows(path, strings, formats)
            part = posixpath.normpath(posixpath.join("/xl", target)).lstrip("/")
            _parse(book, part, {"c": rows.take_cell}, {"row": rows.begin_row})
            yield name, (rows.lines(), rows.hidden)


def _formats(book: zipfile.ZipFile) -> list[str]:
    """Return the number format of each style of cells."""
    codes = dict(_BUILT_IN)
    styles: list[str] = []
    _parse(
        book,
        "xl/styles.xml",
        {"numFmt": lambda each, _: codes.update({each["numFmtId"]: each["formatCode"]})},
        # The styles of cells come after those that they are derived from.
        {"cellXfs": lambda _: styles.clear(), "xf": lambda each: styles.append(each.get("numFmtId", "0"))},
    )
    return [_QUOTED.sub("", codes.get(style, "")).lower() for style in styles]


def _as_shown(value: str, code: str) -> str:
    """Return the number of a cell as its format shows it where that has a unit: in per cent, as a time or a date."""
    number = float(value)
    if not math.isfinite(number):
        return "nan"
    if "%" in code:
        return f"{100 * number:.15g} %"
    if "y" in code or "d" in code:
        return str(datetime(1899, 12, 30) + timedelta(milliseconds=round(number * 86_400_000)))
    return f"{number * 86_400:.12g} s" if "h" in code or "s" in code else value


def _parse(
    book: zipfile.ZipFile,
    part: str,
    take: Mapping[str, Callable[[dict[str, str], str], object]],
    begin: Mapping[str, Callable[[dict[str, str]], object]] = MappingProxyType({}),
) -> None:
    """Give attributes and text of the elements of a part to the functions of their names, at their end or their beginning."""
    # No element is kept: a sheet may have millions.
    parser = expat.ParserCreate(namespace_separator="}")
    parser.buffer_text = True
    own: dict[str, str] = {}
    texts: list[str] = []
    inside: list[str] = []

    def refuse(*_: Any) -> None:
        raise ValueError("it declares entities")

    def started(name: str, attributes: dict[str, str]) -> None:
        nonlocal own
        inside.append(name.rpartition("}")[2])
        if inside[-1] in take:
            own = attributes
            texts.clear()
        if inside[-1] in begin:
            begin[inside[-1]](attributes)

    def heard(text: str) -> None:
        if inside[-1] in ("v", "t") and "rPh" not in inside:  # how a text is pronounced is no part of it
            texts.append(text)

    def ended(_: str) -> None:
        name = inside.pop()
        if name in take:
            take[name](own, "".join(texts))

    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler, parser.CharacterDataHandler, parser.EndElementHandler = started, heard, ended
    with book.open(part) as file:
        parser.ParseFile(file)


@dataclass
class _Rows:
    """The cells of a sheet that hold something."""

    path: Path
    strings: list[str]
    formats: list[str]  # The number format of each style
    cells: dict[int, dict[int, str]] = field(default_factory=dict)
    place: tuple[int, int] = (0, 0)
    widths: dict[int, int] = field(default_factory=dict)
    count: int = 0
    length: int = 0
    hidden: set[int] = field(default_factory=set)  # By a filter, or by hand

    def begin_row(self, attributes: dict[str, str]) -> None:
        self.place = self._checked(int(attributes.get("r", self.place[0] + 1)), 0)
        if attributes.get("hidden") in ("1", "true"):
            self.hidden.add(self.place[0])

    def take_cell(self, attributes: dict[str, str], text: str) -> None:
        row, column = self.place
        at = _CELL.fullmatch(attributes["r"]) if "r" in attributes else None
        if "r" in attributes and at is None:
            raise ValueError(f"a cell is called {show(attributes['r'])}")
        self.place = row, column = self._checked(int(at[2]), _column(at[1])) if at else self._checked(row, column + 1)
        if not text:
            return
        kind = attributes.get("t", "n")
        if kind == "n":
            style = int(attributes.get("s", 0))
            text = _as_shown(text, self.formats[style] if style < len(self.formats) else "")
        elif kind == "s":
            text = self.strings[int(text)]
        elif kind == "b":
            text = "TRUE" if text == "1" else "FALSE"
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
