"""Tables in files: separator, header, units, steps, decimal sign, encoding and missing values found or refused."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from stribeck.files.cells import (
    NUMBER_WITH_COMMA,
    NUMBER_WITH_POINT,
    SUMMARY,
    has_number,
    is_missing,
    number_of,
    rows_left_out,
    rows_listed,
)
from stribeck.files.headings import Heading, Line, headings_in
from stribeck.files.reading import text_of
from stribeck.files.spreadsheet import SPREADSHEET_ENDINGS, sheets_of
from stribeck.files.text_table import (
    TextTable,
    are_pairs,
    drop_repeated_columns,
    rows_but_statistics,
    split_errors,
    stack_curves,
)
from stribeck.quantities.units import InputError, show

SEPARATORS = {"\t": "tab", ";": "semicolon", ",": "comma", "|": "bar"}

MAX_TABLE_BYTES = 20_000_000

MAX_ROWS = 500_000  # Rows of a table that are read, in about a quarter of a minute
MAX_CELLS = 4_000_000  # Cells of a table that are read, in about a quarter of a minute

STEP_HEADER = "step"  # Header of the column that numbers the tables of a file that has the same header above each

HEADER_ADVICE = "add a header such as 'speed [mm/s];friction' above rows of numbers"

SAMPLE_ROWS = 200  # Rows of each table by which tables are compared

SETTING_RTOL = 0.05  # Relative difference of numbers up to which a column has only one setting

# A cell in quotes of two lines, as spreadsheets have them in headers
_BROKEN_CELL = re.compile(r'((?:^|(?<=[\t;,|]))"[^"\r\n]{1,60})\r?\n([^"\r\n]{0,60}"(?=[\t;,|\r\n]))', re.MULTILINE)

_NO_VALUE = re.compile(r"\bno[ _-]?(?:data|value)\b|\bout of range\b", re.IGNORECASE)


def read_table(
    path: Path,
    header_row: int | None = None,
    expected: str = HEADER_ADVICE,
    knows: Callable[[str], bool] = lambda name: False,
    sheet: str | None = None,
) -> TextTable:
    """Return the cells of a file of columns with a header; curves side by side stand one below another."""
    table, labels = _read(path, header_row, expected, knows, sheet)
    if not labels and are_pairs(table.header, table.rows):
        labels = table.header
        table = replace(table, header=("X", "Y") * (len(labels) // 2), written=("X", "Y"))
    return split_errors(drop_repeated_columns(stack_curves(table, labels)))


def read_numbers(
    path: Path, expected: str, knows: Callable[[str], bool], numbers_in: Callable[[str], int], largest: int
) -> TextTable:
    """Return the cells of a text of at most ``largest`` bytes whose columns need no header, as they stand."""
    return _read(path, None, expected, knows, None, numbers_in, largest)[0]


def _read(
    path: Path,
    header_row: int | None,
    expected: str,
    knows: Callable[[str], bool],
    sheet: str | None,
    numbers_in: Callable[[str], int] | None = None,
    largest: int = MAX_TABLE_BYTES,
) -> tuple[TextTable, tuple[str, ...]]:
    """Return the cells of a file, with a header unless ``numbers_in`` tells rows, and the names of curves side by side."""
    filled_up = path.suffix.lower() in SPREADSHEET_ENDINGS and path.is_file()
    notes: tuple[str, ...] = ()
    hidden = set[int]()
    if filled_up:
        name, lines, others_of_book, hidden = _sheet(path, sheet, knows)
        if others_of_book:
            unread = ", ".join(map(show, others_of_book))
            notes = (f"Sheet {show(name)} read, not {unread}; sheet = ... in [fit] chooses another.",)
            path = Path(f"{path} (sheet {show(name)})")
    else:
        lines = _lines_of_text(path, sheet, numbers_in, largest)
    bare = numbers_in is not None
    try:
        heading, same, others = _heading(path, lines, header_row, expected, knows, bare)
    except InputError as problem:  # of a line, which does not know its file
        said = str(problem)
        raise InputError(said if said.startswith(str(path)) else f"{path}: {said}") from None
    separator, number = heading.separator, lines[heading.at].number
    above = tuple((line.number, line.text) for line in lines[: heading.at])
    header = heading.names
    elsewhere = (
        "" if header_row or expected != HEADER_ADVICE else "; if the header is not in this row, set header_row in [fit]"
    )
    if all(NUMBER_WITH_POINT.fullmatch(cell) or NUMBER_WITH_COMMA.fullmatch(cell) for cell in header):
        raise InputError(f"{path}: row {number} holds numbers, not names of columns; {expected}.")
    if sum(map(bool, header)) < 2 and not bare:
        raise InputError(
            f"{path}: row {number} holds one column, {show(next(filter(None, header), ''))}; "
            f"separate the columns by semicolons, tabs or commas{elsewhere}."
        )
    rows, numbers, steps = _body(path, lines, heading, same, others, filled_up, elsewhere)
    if not rows:
        raise InputError(f"{path} has a header in row {number} and no rows of numbers below it{elsewhere}.")
    tables = [] if bare else [each for each in others if each.rows > 1]
    inside = {i for each in tables for i in range(each.first, each.end)}
    skipped = sum(not line.comment and i not in inside for i, line in enumerate(lines[: heading.first]))
    if skipped and not bare:
        notes += (f"{skipped} row{'s' * (skipped > 1)} of other text above the header skipped.",)
    for other in tables:
        at = lines[other.at].number
        reads = f"; header_row = {at} in [fit] reads it" if expected == HEADER_ADVICE else ""
        notes += (f"A table of {other.rows} rows under another header, in row {at}, left out{reads}.",)
    inside.update(i for each in same for i in range(each.first, each.below))
    below_names = {i for each in same for i in range(each.at + 1, each.below)}  # units, and lines such as Load: 2 N
    taken = set(numbers)
    if taken & hidden:
        filtered = rows_listed(sorted(taken & hidden))
        notes += (f"Rows hidden in the sheet count too: {filtered}; delete those that should not.",)
    left_out = [
        line.number
        for i, line in enumerate(lines[heading.below :], heading.below)
        if not (line.comment or line.number in taken or i in inside)
    ]
    between, below = ([each for each in left_out if (each < numbers[-1]) == inner] for inner in (True, False))
    for text, where in ((between, "of other text between"), (below, "below")):
        if text:
            notes += (rows_left_out(text, f"{where} the numbers"),)
    units = heading.units
    written = tuple(dict.fromkeys(filter(None, header)))
    if len(set(steps)) > 1 and not bare:
        header = (*header, STEP_HEADER)
        rows = [(*row, str(step)) for row, step in zip(rows, steps, strict=True)]
        units = (*units, "") if units else ()
    table = TextTable(
        str(path),
        header,
        tuple(rows),
        tuple(numbers),
        SEPARATORS.get(separator, "space"),
        units_row=units,
        written=written,
        above=above,
        between=tuple(
            (line.number, line.text)
            for i, line in enumerate(lines[heading.at + 1 :], heading.at + 1)
            if line.comment or (line.number not in taken and (i not in inside or i in below_names))
        ),
        unread=(*left_out, *(lines[other.at].number for other in tables)),
        notes=notes,
    )
    return table, heading.labels


def _sheet(path: Path, wanted: str | None, knows: Callable[[str], bool]) -> tuple[str, list[Line], tuple[str, ...], set[int]]:
    """Return name and lines of the sheet with most known names, or else most numbers, other sheets, and hidden rows."""
    book = sheets_of(path, wanted)
    sheets = {name: _check_size(path, filled) for name, (filled, _) in book.items()}
    known = {
        name: max((min(each.known, 2) for each in headings_in(lines, knows)), default=0) for name, lines in sheets.items()
    }
    best = max(sheets, key=lambda name: known[name])
    return best, sheets[best], tuple(name for name in sheets if name != best), book[best][1]


def _lines_of_text(path: Path, sheet: str | None, numbers_in: Callable[[str], int] | None, largest: int) -> list[Line]:
    """Return the lines of a text that are not empty."""
    if sheet is not None:
        raise InputError(f"{path} is no workbook, so that it has no sheet {show(sheet)}; take sheet out of [fit].")
    text = text_of(path, largest, "keep the rows and columns that are wanted", "a text file of columns")
    text = _BROKEN_CELL.sub(r"\1 \2", text)
    lines = ((i, _NO_VALUE.sub("nodata", line).strip("\f\ufeff")) for i, line in enumerate(text.splitlines(), 1))
    filled = [(i, line) for i, line in lines if line.strip(" \t;,|")]
    return _check_size(path, filled) if numbers_in is None else [Line.of(*each, numbers_in) for each in filled]


def _check_size(path: Path, filled: list[tuple[int, str]]) -> list[Line]:
    """Return the lines of a table, or refuse one that would take minutes to read."""
    cells = sum(line.count(mark) for _, line in filled for mark in SEPARATORS)
    for count, most, what in ((len(filled), MAX_ROWS, "rows"), (cells, MAX_CELLS, "cells")):
        if count > most:
            raise InputError(f"{path} has more than {most} {what}; keep the rows and columns of the curve, or means of them.")
    return [Line.of(*each) for each in filled]


def _heading(
    path: Path, lines: list[Line], header_row: int | None, expected: str, knows: Callable[[str], bool], bare: bool
) -> tuple[Heading, list[Heading], list[Heading]]:
    """Return the header of the table that is read, all that repeat it below, and those of other tables."""
    plain = [i for i, line in enumerate(lines) if not line.comment]
    if header_row is not None:
        plain = [i for i in plain if lines[i].number >= header_row]
        if not plain or lines[plain[0]].number != header_row:
            raise InputError(
                f"{path}: row {header_row}, where header_row expects the header, is empty, a comment or not there."
            )
    if not plain:
        raise InputError(f"{path} holds no data; {expected}.")
    found = headings_in(lines, knows, bare=bare)
    if bare and not found:
        raise InputError(f"{path} has no line of numbers; {expected}.")
    tables: dict[tuple[str, tuple[str, ...], int], list[Heading]] = {}
    for each in found:
        text = "" if each.is_bare else lines[each.at].text.strip()
        tables.setdefault((text, each.units, len(each.names)), []).append(each)
    if header_row is not None or not tables:
        there = next((each for each in tables.values() for one in each if one.at == plain[0]), [])
        own = [each for each in there if each.at >= plain[0]] or [Heading.at_line(lines, plain[0])]
        return own[0], own, [each for each in found if each not in own and each.at > plain[0]]
    settings_count = (
        {id(each): min(_count_settings(lines, each, knows), 2) for each in tables.values()} if len(tables) > 1 else {}
    )
    count = {id(each): sum(one.rows for one in each) for each in tables.values()}
    ranked = sorted(tables.values(), key=lambda each: (settings_count.get(id(each), 0), count[id(each)]), reverse=True)
    best = ranked[0]
    for other in ranked[1:]:
        if settings_count[id(other)] == settings_count[id(best)] and 1 < count[id(best)] <= 2 * count[id(other)]:
            (first, one), (second, two) = sorted((lines[each[0].at].number, count[id(each)]) for each in (best, other))
            raise InputError(
                f"{path}: rows {first} and {second} are headers of two tables of {one} and {two} rows; say which one to "
                f"read, header_row = {first} or header_row = {second} in [fit]."
                if expected == HEADER_ADVICE
                else f"{path}: rows {first} and {second} are headers of two tables; {expected}."
            )
    return best[0], best, [each for each in found if each not in best]


def _count_settings(lines: list[Line], headings: list[Heading], knows: Callable[[str], bool]) -> int:
    """Return the number of columns of known names with more than one setting."""
    heading = headings[0]
    telling = 0
    cells = [
        heading.row(line.text, filled_up=True)
        for each in headings
        for line in [line for line in lines[each.below : each.end] if line.numeric][:SAMPLE_ROWS]
        if heading.fits(line)
    ]
    for at, name in enumerate(heading.names):
        if knows(name):
            read = [number_of(row[at].replace(",", "."), ".") for row in cells]
            values = [abs(each[0]) for each in read if each is not None]
            telling += bool(values) and min(values) < (1 - SETTING_RTOL) * max(values)
    return telling


def _body(
    path: Path,
    lines: list[Line],
    heading: Heading,
    same: list[Heading],
    others: list[Heading],
    filled_up: bool,
    elsewhere: str,
) -> tuple[list[tuple[str, ...]], list[int], list[int]]:
    """Return the rows below a header, with number and step of each; the header may come again above each step."""
    again = {at: each for each in same if not each.is_bare for at in (each.first, each.at)}
    apart = {each.first for each in others}
    width, wide = len(heading.names), sum(map(bool, heading.names)) > 2
    rows, numbers, steps = list[tuple[str, ...]](), list[int](), list[int]()
    pending: list[tuple[Line, list[str], int]] = []

    def settle(*, header_follows: bool) -> None:
        """Take rows of another width for text above the next header, or for rows of few numbers; else refuse them."""
        for line, cells, count in pending:
            statistic = SUMMARY.fullmatch(next(filter(None, cells), ""))
            if not (header_follows or statistic) and len(cells) != width and max(line.numbers, count) > wide:
                raise InputError(_ragged(path, line, cells, heading, elsewhere))
        pending.clear()

    step, i, skipping = 1, heading.below, False
    while i < len(lines):
        line = lines[i]
        if i in again:
            settle(header_follows=True)
            step, i, skipping = step + bool(rows), again[i].below, False
            continue
        skipping = skipping or i in apart
        i += 1
        if skipping or line.comment:
            continue
        cells = heading.row(line.text, f"{path}: row {line.number}", filled_up)
        count = sum(map(has_number, cells))
        gap = width == 1 and all(map(is_missing, cells))
        if count == 0 and not (line.numeric or gap) and (len(cells) != width or sum(map(bool, cells)) < 2):
            continue  # text
        if len(cells) != width or (len(same) > 1 and count < 2):
            pending.append((line, cells, count))
        else:
            settle(header_follows=False)
            rows.append(tuple(cells))
            numbers.append(line.number)
            steps.append(step)
    settle(header_follows=False)
    kept = rows_but_statistics(heading.names, rows)
    return [rows[k] for k in kept], [numbers[k] for k in kept], [steps[k] for k in kept]


def _ragged(path: Path, line: Line, cells: list[str], heading: Heading, elsewhere: str) -> str:
    width, separator = len(heading.names), heading.separator
    above = "the rows above have" if heading.is_bare else "the header has"
    problem = f"{path}: row {line.number} has {len(cells)} cell{'s' * (len(cells) != 1)} where {above} {width}"
    other = next((name for mark, name in SEPARATORS.items() if mark != separator and line.text.count(mark) == width - 1), None)
    if separator == "," and len(cells) > width and all(re.fullmatch(r"[+-]?[0-9]+", cell) for cell in cells if cell):
        return f"{problem}; commas cannot both separate columns and begin decimals: export with semicolons or tabs."
    if other and width > 1:
        mark = SEPARATORS.get(separator, "space")
        return f"{problem}: the header is separated by {mark}s and this row by {other}s; use one separator{elsewhere}."
    return f"{problem}; use one separator, and leave a cell empty if a value is missing{elsewhere}."
