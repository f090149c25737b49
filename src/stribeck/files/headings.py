"""Headers of tables in text: which line names the columns, which gives units, which names curves side by side."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Self

from stribeck.files.cells import (
    FORMULA_ERROR,
    MISSING_CELLS,
    NUMBER_WITH_UNIT,
    cells_of,
    has_number,
    is_missing,
    looks_like_units,
)

# Separators of columns beside white space; the first of several in a line wins.
COLUMN_SEPARATORS = ("\t", ";", ",", "|")

WIDE_SPACE = "  "  # Separates names of several words in columns that are aligned by spaces

SAMPLE_LINES = 200  # Lines of numbers by which the layout of rows without names is found

# Names of a last column of which programs leave the cells out where nothing was remarked
REMARK = re.compile("(?:comment|remark|note|bemerkung|kommentar)(?:s|en)?", re.IGNORECASE)

MAX_HEADING_LINES = 4  # Lines above rows of numbers that may name columns, units and curves


@dataclass(frozen=True)
class Line:
    """A line that is not empty."""

    number: int  # Row in the file
    text: str  # Text without the sign of a comment
    comment: bool  # Whether the line began with the sign of a comment
    numbers: int  # Number of cells that are numbers
    numeric: bool  # Whether it is a row of the table

    @classmethod
    def of(cls, number: int, text: str, numbers_in: Callable[[str], int] | None = None) -> Self:
        """Return a line of a file, a row where two of its cells or more are numbers, or ``numbers_in`` counts one."""
        comment = text.lstrip().startswith("#") and not FORMULA_ERROR.match(text.lstrip())
        text = text.lstrip().lstrip("#") if comment else text
        numbers = 0 if comment else (numbers_in or _numbers_in)(text)
        return cls(number, text, comment, numbers, numbers > (numbers_in is None))


@dataclass(frozen=True)
class Heading:
    """The lines between text or numbers above and the numbers of a table."""

    at: int  # Place of the names among the lines
    first: int  # Place of the first line that belongs to the table
    below: int  # Place of the first line below the heading
    separator: str  # Separator of the columns; empty for white space
    names: tuple[str, ...]  # The names, empty for a column without one
    units: tuple[str, ...] = ()  # Units below the names; empty if there are none
    labels: tuple[str, ...] = ()  # Names of curves above the names or below them; empty if there are none
    known: int = 0  # Names that the caller knows
    end: int = 0  # Place of the next heading, or the number of lines
    rows: int = 0  # Lines of numbers below it

    @property
    def is_bare(self) -> bool:
        """Whether it stands for the names that rows of numbers do not have."""
        return self.at == self.below

    @classmethod
    def missing_above(cls, lines: Sequence[Line], i: int) -> Self:
        """Return the heading of rows without names, which begin at a line."""
        end = next((k for k in range(i, len(lines)) if not lines[k].numeric), len(lines))
        sample = lines[i : min(end, i + SAMPLE_LINES)]
        separator = separator_of([line.text for line in sample])
        filled = [[bool(cell) for cell in cells_of(line.text, separator, f"row {line.number}")] for line in sample]
        width = max(len(each) - each[::-1].index(True) for each in filled if len(each) <= len(filled[0]))
        heading = cls(at=i, first=i, below=i, separator=separator, names=("",) * width)
        while width > 1 and i and all(map(is_missing, heading._padded(lines[i - 1]) or ("0",))):
            i -= 1  # rows in which nothing was measured
        return replace(heading, at=i, first=i, below=i)

    @classmethod
    def at_line(cls, lines: Sequence[Line], i: int) -> Self:
        """Return the heading whose names stand in a line, whatever is below."""
        separator = _separator(lines[i].text)
        names = tuple(cells_of(lines[i].text, separator, f"row {lines[i].number}"))
        below = i + 1
        while below < min(len(lines), i + MAX_HEADING_LINES) and not lines[below].comment and not lines[below].numbers:
            below += 1
        plain = cls(at=i, first=i, below=below, separator=separator, names=names)
        return plain if below == len(lines) else plain._with_others(lines, range(i, below))

    def row(self, text: str, where: str = "", filled_up: bool = False) -> list[str]:
        """Return the cells of a row, with as many as there are names if what differs is empty."""
        width = len(self.names)
        cells = cells_of(text, self.separator, where)
        while len(cells) > width and not cells[-1]:
            cells.pop()
        if len(cells) != width and self.separator == "\t":
            by_spaces = cells_of(text, "")
            cells = by_spaces if len(by_spaces) == width else cells
        unwritten = [name for name in self.names[len(cells) :] if name and not REMARK.fullmatch(name)]
        if 0 < len(cells) < width and (filled_up or not (self.is_bare or unwritten)):
            cells += [""] * (width - len(cells))
        return cells

    def fits(self, line: Line) -> bool:
        """Return whether a line has a cell for each name."""
        return len(self.row(line.text, filled_up=self.separator == "\t")) == len(self.names)

    def holds_numbers(self, line: Line) -> bool:
        """Return whether a line holds a number and nothing else but missing values, as the first row of a table may."""
        cells = self._padded(line)
        return (
            any(map(has_number, cells))
            and all(has_number(cell) or is_missing(cell) for cell in cells)
            and not _are_units(cells)
        )

    def _with_others(self, lines: Sequence[Line], stack: Sequence[int]) -> Self:
        """Return the heading with the units and labels that other lines of the stack give."""
        units: tuple[str, ...] = ()
        labels: tuple[str, ...] = ()
        first = self.at
        for i in sorted(stack, key=lambda i: (i < self.at, abs(i - self.at))):
            cells = () if i == self.at else tuple(self._padded(lines[i]))
            if not cells:
                continue
            if i > self.at and not units and _are_units(cells):
                units = tuple("" if cell.lower() in MISSING_CELLS else cell.strip("[]()") for cell in cells)
            elif not labels and self._distinguishes_columns(cells):
                labels, first = cells, min(first, i)
        return replace(self, units=units, labels=labels, first=first)

    def _padded(self, line: Line) -> list[str]:
        cells = self.row(line.text, filled_up=True)
        return cells if len(cells) == len(self.names) else []

    def _distinguishes_columns(self, labels: Sequence[str]) -> bool:
        """Return whether labels tell columns of the same name apart."""
        starts = [i for i, label in enumerate(labels) if label]
        blocks = [self.names[i:j] for i, j in zip(starts, [*starts[1:], len(self.names)], strict=True)]
        repeated = {name for name in self.names if name and self.names.count(name) > 1}
        return len({labels[i] for i in starts}) == len(starts) > 1 and all(
            repeated & set(block) and all(block.count(name) < 2 for name in repeated) for block in blocks
        )


def headings_in(lines: Sequence[Line], knows: Callable[[str], bool], *, bare: bool = False) -> list[Heading]:
    """Return the headings of all tables among lines, from above; ``bare`` also those of rows without names."""
    found: list[Heading] = []
    stack: list[int] = []
    comments: list[int] = []
    for i, line in enumerate(lines):
        if line.comment:
            comments.append(i)
        elif not line.numeric:
            stack.append(i)
        else:
            if stack or (comments and not found):
                # A comment names the columns only where nothing else does.
                heading = _best(lines, stack[-MAX_HEADING_LINES:], i, knows, 2 - bare) or (
                    _best(lines, comments[-MAX_HEADING_LINES:], i, knows, 2 - bare) if not found else None
                )
                if heading:
                    found.append(heading)
            if bare and (not found or (found[-1].below < i and not any(found[-1].fits(lines[k]) for k in stack) and stack)):
                found.append(Heading.missing_above(lines, i))
            stack, comments = [], []
    ends = [*(each.first for each in found), len(lines)][1:]
    counts = [sum(line.numeric for line in lines[each.below : end]) for each, end in zip(found, ends, strict=False)]
    return [replace(each, end=end, rows=rows) for each, end, rows in zip(found, ends, counts, strict=False)]


def _best(
    lines: Sequence[Line], stack: Sequence[int], below: int, knows: Callable[[str], bool], fewest: int
) -> Heading | None:
    """Return the heading of rows of numbers whose names are known best, or most, or stand highest; None if none fits."""
    fitting = []
    for i in stack:
        for mark in _separators(lines[i]):
            names = tuple(_names(lines[i].text, mark))
            given = [name for name in names if not is_missing(name)]
            separator = separator_of([lines[below].text]) if lines[i].comment or not mark.strip() else mark
            heading = Heading(at=i, first=i, below=below, separator=separator, names=names)
            if not mark and not heading.fits(lines[below]):
                heading = replace(heading, names=("", *names))  # numbers of the rows have no name
            # Cells that tabs leave empty at the end are of names that tabs separate, and not of the words of a sentence.
            few = mark != separator and len(cells_of(lines[below].text, separator)) < len(names)
            if few or len(given) < fewest or any(map(has_number, names)) or not heading.fits(lines[below]):
                continue
            fitting.append(replace(heading, known=len({name for name in given if knows(name)})))
            break
    if not fitting:
        return None
    best = max(fitting, key=lambda each: (not _are_units(each.names), each.known, sum(map(bool, each.names)), -each.at))
    first = next((i for i in stack if i > best.at and best.holds_numbers(lines[i])), below)
    others = [i for i in stack if i < first]
    above = best.at - 1  # labels such as 1 N;;2 N, which are numbers too
    if above >= 0 and above not in others and all(map(NUMBER_WITH_UNIT.fullmatch, filter(None, best._padded(lines[above])))):
        others.append(above)
    return replace(best._with_others(lines, others), below=first)


def _separators(line: Line) -> tuple[str, ...]:
    """Return what may separate names in a line; a comment need not have the separator of the numbers."""
    marks = tuple(mark for mark in COLUMN_SEPARATORS if mark in line.text)
    if line.comment:
        return (*marks, "", WIDE_SPACE)
    return marks[:1] or ("", WIDE_SPACE)


def _names(text: str, mark: str) -> list[str]:
    return re.split(r"\s{2,}", text.strip()) if mark == WIDE_SPACE else cells_of(text, mark)


def separator_of(rows: Sequence[str]) -> str:
    """Return what separates the numbers of rows, in which a comma may be the decimal sign; empty for white space."""
    if all(";" in row for row in rows):
        return ";"
    if all("\t" in row and not re.search(r"[^\t] +[^\t ]", row.strip()) for row in rows):
        return "\t"
    if all("|" in row for row in rows):
        return "|"
    decimal = all(re.fullmatch(r"\S+(\s+\S+)+", row.strip()) and not re.search(r",\s|\s,", row.strip()) for row in rows)
    return "" if decimal or not any("," in row for row in rows) else ","


def _separator(text: str) -> str:
    return next((mark for mark in COLUMN_SEPARATORS if mark in text), "")


def _numbers_in(text: str) -> int:
    """Return how many cells of a line are numbers, taken for several where its quotes are wrong."""
    cells = cells_of(text, _separator(text))
    return sum(map(has_number, cells)) if cells else sum(sign.isdigit() for sign in text)


def _are_units(cells: Sequence[str]) -> bool:
    """Return whether most cells are units, and not all of these numbers such as 1, the unit of a ratio."""
    given = [cell for cell in cells if cell.lower() not in MISSING_CELLS]
    return 2 * sum(map(looks_like_units, given)) > len(given) and not all(map(has_number, given))
