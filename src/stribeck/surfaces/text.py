"""Heights from plain text: CSV, TSV and XYZ files of any separator, decimal comma or point, with declared units.

One column is heights along a line, two are position and height, three x, y and height of a grid in any order, many a matrix
with a line of the scan in each row.  Columns that number the rows, and empty ones, count for nothing.
"""

import math
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from stribeck._types import Array
from stribeck.files.cells import (
    NUMBER_WITH_POINT,
    has_number,
    is_missing,
    normalised_header,
    read_as,
    rows_left_out,
    thousands_in,
)
from stribeck.files.reading import text_of
from stribeck.files.table_reading import read_numbers
from stribeck.files.text_table import TextTable
from stribeck.quantities.units import MAX_NUMBER, InputError, show, to_si
from stribeck.surfaces.text_header import Header, header_of, unit_of
from stribeck.surfaces.topography import MIN_POINTS, Topography, check_missing

Spacing = str | float | Sequence[str | float] | None
"""The distance between points as it is given: one for all axes, or one each."""

TEXT_ENDINGS = (".csv", ".tsv", ".txt", ".dat", ".xyz")  # Endings of plain text files

# Sizes of numbers that instruments write for a missing point
MISSING_CODES = {10.0**n - 1 for n in range(3, 8)} | {32767.0, 32768.0, 65535.0, 2147483647.0, 2147483648.0}

MAX_GRID_DEVIATION = 0.02  # Largest deviation of a position from the even grid, over the spacing

MOST_EMPTY = 4  # Points of a grid over those with a height from which the positions are no such grid

SPACING_RTOL = 0.005  # Relative difference of spacings, one given and one in the file, up to which they agree: files round

MAX_FILE_BYTES = 1_000_000_000

# What columns of heights and of their places are called, without units
_HEIGHT = re.compile(r"z|heights?|profile(?: height)?|höhe|topography|elevation")
_PLACE = re.compile(r"[xy]|(?:[xy] )?(?:positions?|distance|lateral|length|coordinate)|weg")

_COUNTER = re.compile(r"|#|n|i|nr|no|idx|index|id|row|line|point|punkt|sample|pt|number|count|unnamed 0", re.IGNORECASE)


@dataclass(frozen=True)
class _Table:
    """Numbers of a file with the line of each row, names and units of the columns, and what stands above them."""

    values: Array
    cells: list[list[str]]
    lines: list[int]
    names: list[str]
    units: list[str | None]
    header: Header
    notes: tuple[str, ...]


def read_text(path: Path, *, unit: str | None, height_unit: str | None, spacing: Spacing) -> Topography:
    """Read heights from a text file."""
    table = _table(path)
    columns = table.values.shape[1]
    if 3 < columns < MIN_POINTS[2] and any(table.names):
        raise InputError(
            f"{path} has {columns} columns ({', '.join(map(show, table.names))}); keep two for a line, position and height, "
            "or three for a map, x, y and height."
        )
    positions = {1: 0, 2: 1, 3: 2}.get(columns, 0)
    called = list(map(normalised_header, table.names))
    if positions and _PLACE.fullmatch(called[-1]) and any(map(_HEIGHT.fullmatch, called)):
        raise InputError(
            f"{path}: the columns are {', '.join(map(show, table.names))}; heights stand in the last column, behind "
            "their places."
        )
    declared = table.units[positions] if columns <= 3 else table.units[0]
    z_name = "height_unit" if height_unit else "unit"
    lateral, vertical = table.header.lateral, declared or table.header.vertical
    x_units = [own or lateral for own in table.units[:positions]]
    z_factor = _factor(path, z_name, height_unit or unit, vertical, "heights", next(filter(None, x_units), lateral))
    if positions == 0:
        return _without_positions(path, table, spacing, z_factor, unit)
    samples, lines = table.header.samples, table.header.lines
    if columns == 2 and samples and lines and lines[0] > 1 and samples[0] * lines[0] == len(table.lines):
        raise InputError(
            f"{path} declares {show(samples[1])} and {show(lines[1])}, so that its two columns are two channels of a map; "
            "keep that of the heights."
        )
    if spacing is not None:
        raise InputError(f"{path} has positions, so spacing = {show(spacing)} is redundant; leave it out.")
    x_factors = [_factor(path, "unit", unit, x_unit, "positions", vertical) for x_unit in x_units]
    places = table.values[:, :positions] * np.array(x_factors)
    bad = np.isnan(places).any(axis=1)
    if bad.any():
        raise InputError(f"{path}: line {table.lines[int(np.argmax(bad))]} has no position; remove or correct the line.")
    z = table.values[:, positions] * z_factor
    rounding = [_rounding([row[i] for row in table.cells]) * x_factors[i] for i in range(positions)]
    if positions == 1:
        return _line(path, places[:, 0], z, table, rounding[0])
    steps = np.diff(places[:, 0])
    if len(steps) > 1 and (np.all(steps > 0) or np.all(steps < 0)) and np.unique(places[:, 1]).size > 1:
        names = f" ({', '.join(map(show, table.names))})" if any(table.names) else ""
        raise InputError(
            f"{path} has three columns{names} and another first number in each row: are they x and two heights of a line, or "
            "x, y and height of a map? Keep position and one height of a line in two columns; a map has each x with several y."
        )
    return _map(path, places, z, table, rounding)


def _without_positions(path: Path, table: _Table, spacing: Spacing, z_factor: float, unit: str | None) -> Topography:
    """Return heights whose distance is given, declared above them, or along their edges."""
    values, notes = table.values, list(table.notes)
    found: tuple[tuple[float, str] | None, ...] = (None, None)
    if values.shape[1] > 1:
        values, found = _without_edges(path, table, unit, notes)
    # A row of the file is a line of the scan, and the first axis is along it.
    z = _in_lines(path, values[:, 0], table.header, notes) if values.shape[1] == 1 else values.T
    jumps = np.diff(table.lines)
    if (z.ndim == 1 or values.shape[1] > 1) and np.unique(jumps).size > 1:  # what stands behind would move up
        line = table.lines[int(np.argmax(jumps != np.bincount(jumps).argmax()))] + 1
        raise InputError(
            f"{path}: line {line}, between heights, holds none; write nan where points are missing, or take it out."
        )
    found = found[: z.ndim]
    if not any(found):
        found = table.header.spacing(path, z.shape)
    given = spacing_of(spacing, z.ndim)
    steps = []
    for axis, declared in enumerate(found):
        if declared is None and given is None:
            what = "one column" if values.shape[1] == 1 else f"{values.shape[1]} columns, a matrix of heights"
            raise InputError(
                f"{path} has {what} without positions; give the distance between points with --spacing '0.5 um' "
                "(in Python spacing='0.5 um')."
            )
        if declared is not None and given is not None and not math.isclose(given[axis], declared[0], rel_tol=SPACING_RTOL):
            raise InputError(
                f"{path} declares {declared[0] * 1e6:.4g} um between points along {'xy'[axis]} ({show(declared[1])}), but "
                f"spacing = {show(spacing)}; leave out the wrong one."
            )
        steps.append(given[axis] if declared is None and given is not None else declared[0] if declared is not None else 0.0)
    lines = list(dict.fromkeys(declared[1] for declared in found if declared is not None))
    if lines:
        apart = " x ".join(f"{step * 1e6:.4g}" for step in steps)
        notes.append(f"Points are {apart} um apart, as declared by {' and '.join(map(show, lines))}.")
    return Topography(z * z_factor, tuple(steps), source=path.name, notes=tuple(notes))


def _in_lines(path: Path, z: Array, header: Header, notes: list[str]) -> Array:
    """Return heights of one column as the map whose samples per line and lines are declared above them, if they are."""
    samples, lines = header.samples, header.lines
    if samples is None or (lines is None and samples[0] == z.size):
        return z
    if lines is None or samples[0] * lines[0] != z.size:
        said = show(samples[1]) + (f" and {show(lines[1])}" if lines else " and no number of lines, as in 'Lines: 64'")
        raise InputError(f"{path} has {z.size} heights in one column, but declares {said}; correct what is declared.")
    if lines[0] == 1:
        return z
    notes.append(f"The column holds {lines[0]} lines of {samples[0]} heights, as declared by {show(samples[1])}.")
    return z.reshape(lines[0], samples[0]).T


def spacing_of(spacing: Spacing, axes: int) -> list[float] | None:
    """Return the distance between points that was given for each axis [m]."""
    if spacing is None:
        return None
    parts = re.split(r"\s*(?:[x×;]|,\s)\s*", spacing.strip()) if isinstance(spacing, str) else spacing
    if not isinstance(parts, list | tuple):
        parts = [spacing]
    if len(parts) not in (1, axes):
        raise InputError(f"spacing = {show(spacing)}: give one distance, or one for each axis, as in '1 um x 0.5 um'.")
    if len(parts) == 1:
        parts = [*parts] * axes
    return [to_si(part, "length", "spacing", "0.5 um") for part in parts]


def _without_edges(
    path: Path, table: _Table, unit: str | None, notes: list[str]
) -> tuple[Array, tuple[tuple[float, str] | None, ...]]:
    """Return a matrix without a first row and column that hold positions or numbers of lines, and the steps they declare."""
    values = table.values
    column, row = values[:, 0], values[0]
    on_left = _is_even(column[1:]) and (_is_even(column) or _is_even(row[1:]))
    on_top = _is_even(row[1:]) and (_is_even(row) or _is_even(column[1:]))
    if not (on_left or on_top):
        return values, (None, None)
    axes = [row[1:] if on_left else row] if on_top else []
    axes += [column[1:] if on_top else column] if on_left else []
    kept = values[int(on_top) :, int(on_left) :]
    if all(abs(axis[1] - axis[0]) == 1 and axis[0] in (0, 1) for axis in axes):
        what = " and ".join(["row"] * on_top + ["column"] * on_left)
        notes.append(f"The first {what} numbers the points and was left out.")
        return kept, (None, None)
    if not (on_left and on_top):
        edge = "row" if on_top else "column"
        raise InputError(
            f"{path}: the first {edge} of the matrix rises in even steps, as positions do; remove it and give the distance "
            "between points with --spacing, or write x, y and height in three columns."
        )
    factor = _factor(path, "unit", unit, table.header.lateral or table.units[0], "positions", None)
    return kept, (
        (float(abs(row[-1] - row[1])) / (row.size - 2) * factor, "positions in the first row"),
        (float(abs(column[-1] - column[1])) / (column.size - 2) * factor, "positions in the first column"),
    )


def _is_even(values: Array) -> bool:
    """Return whether numbers rise or fall in steps as even as no rough line's heights."""
    steps = np.diff(values)
    mean = float(steps.mean()) if len(steps) > 3 else 0.0
    return bool(mean != 0 and np.isfinite(mean) and np.all(np.abs(steps - mean) < 0.05 * abs(mean)))


def _rounding(cells: list[str]) -> float:
    """Return the smallest step in which positions are written, in their unit."""
    decimals, digits, largest = 0, 1, 0.0
    for cell in cells:
        mantissa, _, exponent = cell.lower().replace(",", ".").lstrip("+-").partition("e")
        decimals = max(decimals, len(mantissa.partition(".")[2]) - int(exponent or 0))
        digits = max(digits, len(mantissa.replace(".", "").lstrip("0")))
        largest = max(largest, float(f"{mantissa}e{exponent or 0}"))
    by_digits = 10.0 ** (math.floor(math.log10(largest)) + 1 - digits) if largest > 0 else 0.0
    return float(max(10.0**-decimals, by_digits))


def _even_grid(x: Array, rounding: float, number: Array | None = None) -> tuple[float, float]:
    """Return the step of the even grid nearest to rising positions, and how far they are off it beyond their rounding.

    They are one after another unless their ``number`` on the grid is given.
    """
    count = np.arange(x.size) if number is None else number
    step, start = np.polyfit(count - count.mean(), x, 1)
    off = np.abs(x - start - step * (count - count.mean())).max()
    # A line through rounded positions may itself be off by a little of the rounding.
    return float(step), float(off - 0.6 * rounding)


def _line(path: Path, x: Array, z: Array, table: _Table, rounding: float) -> Topography:
    lines, notes = table.lines, list(table.notes)
    order = np.argsort(x, kind="stable")
    if np.any(np.diff(order) != 1) and np.any(np.diff(order) != -1):
        notes.append("Positions were not in order; they were sorted.")
    x, z = x[order], z[order]
    steps = np.diff(x)
    if x.size < 2 or not np.all(steps > 0):
        where = lines[int(order[int(np.argmin(steps)) + 1])] if x.size > 1 else lines[0]
        raise InputError(f"{path}: line {where} has the same position as another one; a profile has one height at each.")
    step, off = _even_grid(x, rounding)
    if off <= MAX_GRID_DEVIATION * step:
        return Topography(z, (step,), source=path.name, notes=tuple(notes))
    check_missing(z, path.name)
    # Points without a height may not be in the file; single steps are those nearer to the usual one than to two of it.
    number = np.rint((x - x[0]) / steps[steps < 1.5 * np.median(steps)].mean())
    step, off = _even_grid(x, rounding, number)
    if off <= MAX_GRID_DEVIATION * step and np.all(np.diff(number) > 0) and number[-1] < MOST_EMPTY * x.size:
        heights = np.full(int(number[-1]) + 1, np.nan)
        heights[number.astype(int)] = z
        return Topography(heights, (step,), source=path.name, notes=tuple(notes))
    widest, good = float(steps.max()), np.isfinite(z)
    count = int(round((x[-1] - x[0]) / widest)) + 1
    even = np.linspace(x[0], x[-1], count)
    notes.append(f"Positions are uneven; heights were interpolated to the widest step, {widest:.3g} m.")
    # Straight lines between points take power from short waves, up to a few of the widest steps.
    return Topography(
        np.interp(even, x[good], z[good]), (widest,), source=path.name, notes=tuple(notes), resolution=8 * widest
    )


def _map(path: Path, places: Array, z: Array, table: _Table, rounding: list[float]) -> Topography:
    lines = table.lines
    index, steps, shape = [], [], []
    for axis, name in enumerate("xy"):
        values = np.unique(places[:, axis])
        # Values that differ by rounding only are the same line of the grid.
        span = values[-1] - values[0]
        gaps = np.diff(values)
        values = values[np.concatenate([[True], gaps > 1e-6 * span])]
        gaps = gaps[gaps > 1e-6 * span]
        if span <= 0 or gaps.size == 0:
            raise InputError(f"{path}: all points have the same {name}; a profile has two columns, position and height.")
        step, off = _even_grid(values, rounding[axis])
        if off <= MAX_GRID_DEVIATION * step:  # each value is a line of the grid, rounded or not
            nearest = np.rint((places[:, axis] - values[0]) / step)
        else:
            step = float(np.median(gaps))
            place = (places[:, axis] - values[0]) / step
            nearest = np.rint(place)
            apart = np.abs(place - nearest)
            if apart.max() > 0.1:
                line = lines[int(np.argmax(apart))]
                raise InputError(
                    f"{path}: line {line} does not lie on an even grid in {name} with the step {step:.4g} m; "
                    "interpolate the points to a grid first."
                )
            step = float(span / nearest.max())
        index.append(nearest.astype(int))
        steps.append(step)
        shape.append(int(nearest.max()) + 1)
    if shape[0] * shape[1] > MOST_EMPTY * z.size:
        raise InputError(
            f"{path}: {z.size} points on a grid of {shape[0]} x {shape[1]} leave most of the grid empty; check x and y."
        )
    flat = index[0] * shape[1] + index[1]
    _, first, counts = np.unique(flat, return_index=True, return_counts=True)
    if counts.max() > 1:
        place_of = int(np.flatnonzero(flat == flat[first[int(np.argmax(counts))]])[1])
        raise InputError(f"{path}: line {lines[place_of]} repeats the position of an earlier line; keep one height for each.")
    heights = np.full(shape, np.nan)
    heights[index[0], index[1]] = z
    return Topography(heights, tuple(steps), source=path.name, notes=table.notes)


def _factor(path: Path, name: str, given: str | None, declared: str | None, what: str, other: str | None) -> float:
    """Return the length in m of one unit, from the option or from the header, which may declare only the ``other`` one."""
    if given is None and declared is None:
        option, argument = "--unit um, and --height-unit nm where heights have another one", "unit='um', height_unit='nm'"
        if other and what == "heights":
            option, argument = "--height-unit um", "height_unit='um'"
        elif other:
            option, argument = f"--unit um --height-unit {other}", f"unit='um', height_unit={show(other)}"
        raise InputError(
            f"{path} does not declare the unit of its {what}; add {option} (in Python {argument}), "
            "or write it in the header as in 'x (um), z (nm)'."
        )
    factors = [
        to_si(f"1 {text}", "length", name if text is given else f"{path}: the unit of {what}")
        for text in (given, declared)
        if text
    ]
    if len(factors) == 2 and not math.isclose(*factors):
        raise InputError(f"{path} declares its {what} in {declared}, but {name} = {show(given)}; leave out the wrong one.")
    return factors[0]


def _table(path: Path) -> _Table:
    expected = "give lines of heights, with positions or without"
    found = read_numbers(path, expected, lambda name: unit_of(name) is not None, _numbers_in, MAX_FILE_BYTES)
    notes = list(found.notes)
    below = _rows_of_words_below(found.rows)
    if below:
        notes.append(rows_left_out(found.numbers[-below:], "below the numbers"))
        found = replace(found, rows=found.rows[:-below], numbers=found.numbers[:-below])
    found = _with_decimal_commas(path, found)
    cells, numbers, width = [list(row) for row in found.rows], list(found.numbers), len(found.header)
    names = list(found.header)
    if found.units_row:
        names = [f"{name} ({unit})" if unit else name for name, unit in zip(names, found.units_row, strict=True)]
    # Columns without a height hold nothing, but in a map they may be points that were missed.
    kept = [j for j in range(width) if (width >= MIN_POINTS[2] and j > 0) or any(row[j] for row in cells)]
    if any(names) and len(kept) > 1 and _is_counter(names, [row[kept[0]] for row in cells], kept):
        notes.append("The first column numbers the points and was left out.")
        kept = kept[1:]
    cells = [[row[j] for j in kept] for row in cells]
    comma = False
    if found.separator != "comma" and any("," in cell for row in cells for cell in row):
        called = tuple(names[j] or str(j + 1) for j in kept)
        shown = replace(found, header=called, rows=tuple(map(tuple, cells)))
        comma = not any("." in cell for row in cells for cell in row) or shown.decimal_comma(called)
    above = [*(line for _, line in found.above), ";".join(found.header)]
    header = header_of(path, (line.lstrip("#%;!*/ ") for line in above), "," if comma else ".")
    notes += [f"Heights are as they stand in the file: {show(line)} was not applied." for line in header.scales]
    values, missing_notes = _values(path, cells, numbers, comma=comma, codes=header.codes)
    if not any(names) and values.shape[1] == 3 and _numbers_rows(values[:, 0]) and _is_even(values[:, 1]):
        notes.append("The first column numbers the points and was left out.")
        values, cells = values[:, 1:], [row[1:] for row in cells]
    names = [names[j] for j in kept] if any(names) else [""] * values.shape[1]
    units = [unit_of(name) for name in names]
    if len(units) > 3 and any(units):
        units = [next(unit for unit in units if unit)] * len(units)
    return _Table(values, cells, numbers, names, units, header, (*notes, *_thousands_notes(cells, names), *missing_notes))


def _rows_of_words_below(rows: Sequence[Sequence[str]]) -> int:
    """Return how many rows below those of numbers begin with a word, as ``Ra;0.41`` does."""
    first = [next(filter(None, row), "") for row in reversed(rows)]
    return next((k for k, cell in enumerate(first) if is_missing(cell) or has_number(cell)), 0)


def _with_decimal_commas(path: Path, table: TextTable) -> TextTable:
    """Return a table of one column whose decimal commas split it in two as one column; refuse it without a name."""
    of_pairs = len(table.header) == 2 and table.separator == "comma"
    if not of_pairs or not all(re.fullmatch(r"[+-]?\d+,\d+([eE][+-]?\d+)?", ",".join(row)) for row in table.rows):
        return table
    first, name = table.header
    if not (first or name):
        raise InputError(
            f"{path}: '{','.join(table.rows[0])}' may be two columns or one number with a decimal comma; write points, or ; "
            "between columns."
        )
    if first or _numbers_rows(np.array([float(row[0]) for row in table.rows])):
        return table
    # A header such as ',z (um)' names two columns.
    above = text_of(path, MAX_FILE_BYTES, "crop the scan", "text").splitlines()[: table.numbers[0] - 1]
    if "," in next((line for line in reversed(above) if "".join(name.split()) in "".join(line.split())), ","):
        return table
    units = tuple(filter(None, table.units_row))[:1]
    rows = tuple((",".join(row),) for row in table.rows)
    return replace(table, header=(name,), units_row=units, rows=rows, separator="space")


def _thousands_notes(cells: list[list[str]], names: list[str]) -> list[str]:
    """Return how columns were read in which every mark may stand between thousands."""
    if len(names) > 3:
        columns: list[tuple[str, Iterator[str]]] = [("", (cell for row in cells for cell in row))]
    else:
        columns = [(name or str(j + 1), (row[j] for row in cells)) for j, name in enumerate(names)]
    found = ((name, thousands_in(column)) for name, column in columns)
    return [f"Column {show(name)}: {read_as(cell)}" if name else read_as(cell) for name, cell in found if cell]


def _numbers_in(line: str) -> int:
    """Return how many numbers a line holds; none where another cell is neither a number nor missing."""
    cells = [cell for cell in (part.strip('" ') for part in re.split(r"[;\t, |]+", line)) if cell]
    numbers = sum(NUMBER_WITH_POINT.fullmatch(cell) is not None for cell in cells)
    return numbers if numbers + sum(map(is_missing, cells)) >= len(cells) else 0


def _values(
    path: Path, cells: list[list[str]], numbers: list[int], *, comma: bool, codes: tuple[float, ...]
) -> tuple[Array, list[str]]:
    """Return the numbers in cells, NaN where they hold no height, and which codes stand for that."""
    values = np.empty((len(cells), len(cells[0])))
    for k, row in enumerate(cells):
        for j, cell in enumerate(row):
            try:
                values[k, j] = math.nan if is_missing(cell) else float(cell.replace(",", ".") if comma else cell)
            except ValueError:
                raise InputError(f"{path}: line {numbers[k]}, column {j + 1} is {show(cell)}, not a number.") from None
    # Positions are left as they are: only heights may be missing.
    z = values if values.shape[1] > 3 else values[:, -1]
    beyond = ~np.isfinite(z) & ~np.isnan(z) | (np.abs(z) >= MAX_NUMBER)
    words = Counter(cell for row in cells for cell in (row if len(row) > 3 else row[-1:]) if cell and is_missing(cell))
    notes = [_missing_note(count, "read", show(word)) for word, count in words.items()]
    for code in np.unique(z[beyond & np.isfinite(z)]):
        notes.append(_missing_note(int((z == code).sum()), "hold", f"{code:g}, a code for no height,"))
    z[beyond] = np.nan
    return values, notes + mark_codes(z, codes)


def mark_codes(z: Array, declared: tuple[float, ...] = ()) -> list[str]:
    """Put NaN in the place of numbers that stand for no height, and return a note on each."""
    notes, codes = [], sorted({*declared} | {sign * size for size in MISSING_CODES for sign in (-1, 1)})
    heights = np.sort(z[~np.isin(z, codes) & ~np.isnan(z)])
    for code in codes:
        here = z == code
        if not here.any():
            continue
        # Heights lie nearer to one another than the nearest of them to a code.
        if code in declared or (heights.size > 1 and np.abs(heights - code).min() > np.diff(heights).max()):
            notes.append(_missing_note(int(here.sum()), "hold", f"{code:g}, a code for no height,"))
            z[here] = np.nan
    return notes


def _missing_note(count: int, verb: str, what: str) -> str:
    if count == 1:
        return f"1 point {verb}s {what} and counts as missing."
    return f"{count} points {verb} {what} and count as missing."


def _is_counter(names: list[str], cells: list[str], kept: list[int]) -> bool:
    """Return whether a first column numbers the rows, by its name and its numbers."""
    name = re.sub(r"[^0-9A-Za-z#]+", " ", names[kept[0]]).strip()
    others = any(unit_of(names[j]) for j in kept[1:])
    if not _COUNTER.fullmatch(name) or (name == "" and not others):
        return False
    try:
        return _numbers_rows(np.array([float(cell) for cell in cells]))
    except ValueError:
        return False


def _numbers_rows(values: Array) -> bool:
    return bool(values[0] in (0, 1) and np.all(np.diff(values) == 1))
