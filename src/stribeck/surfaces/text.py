"""Heights from plain text: CSV, TSV and XYZ files of any separator, decimal comma or point, with declared units.

What the columns are follows from their number: 1 heights along a line; 2 position and height; 3 x, y and height of the
points of a grid, in any order; more a matrix of heights, a line of the scan in each row.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from stribeck._types import Array
from stribeck.files.cells import MISSING, cells_of
from stribeck.files.reading import text_of
from stribeck.files.text_table import values_of
from stribeck.quantities.units import InputError, show, to_si
from stribeck.surfaces.topography import Topography

__all__ = ["TEXT", "read_text"]

TEXT = (".csv", ".tsv", ".txt", ".dat", ".xyz")
"""Endings of plain text files."""

INFINITE = {"inf", "-inf"}
"""Text that some instruments write for a missing point."""

UNEVEN = 0.02
"""Largest deviation of a position from the even grid, over the spacing, that passes for even."""

LARGEST_FILE = 1_000_000_000  # [byte]

_UNIT_IN_HEADER = re.compile(r"[\[(]\s*([^\])]+?)\s*[\])]|[,/_ ]\s*(nm|µm|μm|um|mm|cm|m|Å)\s*$")


@dataclass(frozen=True)
class _Table:
    """Numbers of a file with the line of each row, and the units that its header declares."""

    values: Array
    lines: list[int]
    units: list[str | None]


def read_text(
    path: Path,
    *,
    unit: str | None = None,
    height_unit: str | None = None,
    spacing: str | float | None = None,
) -> Topography:
    """Read heights from a text file.

    Parameters
    ----------
    path : pathlib.Path
        The file.
    unit : str, optional
        Unit of positions, and of heights where ``height_unit`` is not given, such as ``"um"``.
    height_unit : str, optional
        Unit of heights.
    spacing : str or float, optional
        Distance between points, with its unit or in m, where the file has no positions.

    Returns
    -------
    Topography
        The heights in m.

    Raises
    ------
    InputError
        Where the file cannot be read, declares no unit, or a row is wrong; the line and the column are named.
    """
    table = _table(path)
    columns = table.values.shape[1]
    positions = {1: 0, 2: 1, 3: 2}.get(columns, 0)
    heights = table.units[positions : positions + 1][0] if columns <= 3 else table.units[0]
    z_factor = _factor(path, "height_unit" if height_unit else "unit", height_unit or unit, heights, "heights")
    if positions == 0:
        if spacing is None:
            what = "one column" if columns == 1 else f"{columns} columns, a matrix of heights"
            raise InputError(
                f"{path} has {what} without positions; give the distance between points with --spacing '0.5 um' "
                "(in Python spacing='0.5 um')."
            )
        step = to_si(spacing, "length", "spacing", "0.5 um")
        z = table.values * z_factor
        # A row of the file is a line of the scan, and the first axis is along it.
        return Topography(z[:, 0] if columns == 1 else z.T, (step,) * (1 if columns == 1 else 2), source=path.name)
    if spacing is not None:
        raise InputError(f"{path} has positions, so spacing = {show(spacing)} is redundant; leave it out.")
    x_factors = [_factor(path, "unit", unit, table.units[i], "positions") for i in range(positions)]
    places = table.values[:, :positions] * np.array(x_factors)
    bad = np.isnan(places).any(axis=1)
    if bad.any():
        raise InputError(f"{path}: line {table.lines[int(np.argmax(bad))]} has no position; remove or correct the line.")
    z = table.values[:, positions] * z_factor
    return _line(path, places[:, 0], z, table.lines) if positions == 1 else _map(path, places, z, table.lines)


def _line(path: Path, x: Array, z: Array, lines: list[int]) -> Topography:
    order, notes = np.argsort(x, kind="stable"), []
    if np.any(np.diff(order) != 1) and np.any(np.diff(order) != -1):
        notes.append("Positions were not in order; they were sorted.")
    x, z = x[order], z[order]
    steps = np.diff(x)
    if x.size < 2 or not np.all(steps > 0):
        where = lines[int(order[int(np.argmin(steps)) + 1])] if x.size > 1 else lines[0]
        raise InputError(f"{path}: line {where} has the same position as another one; a profile has one height at each.")
    step = float((x[-1] - x[0]) / (x.size - 1))
    even = x[0] + step * np.arange(x.size)
    if np.abs(x - even).max() <= UNEVEN * step:
        return Topography(z, (step,), source=path.name, notes=tuple(notes))
    widest, good = float(steps.max()), np.isfinite(z)
    if good.sum() < 2:
        raise InputError(f"{path}: fewer than two points have a height.")
    count = int(round((x[-1] - x[0]) / widest)) + 1
    even = np.linspace(x[0], x[-1], count)
    notes.append(f"Positions are uneven; heights were interpolated to the widest step, {widest:.3g} m.")
    # Straight lines between points take power from short waves, up to a few of the widest steps.
    return Topography(
        np.interp(even, x[good], z[good]), (widest,), source=path.name, notes=tuple(notes), resolution=8 * widest
    )


def _map(path: Path, places: Array, z: Array, lines: list[int]) -> Topography:
    index, steps, shape = [], [], []
    for axis, name in enumerate("xy"):
        values = np.unique(places[:, axis])
        # Values that differ by rounding only are the same line of the grid.
        span = values[-1] - values[0]
        gaps = np.diff(values)
        gaps = gaps[gaps > 1e-6 * span]
        if span <= 0 or gaps.size == 0:
            raise InputError(f"{path}: all points have the same {name}; a profile has two columns, position and height.")
        step = float(np.median(gaps))
        place = (places[:, axis] - values[0]) / step
        nearest = np.rint(place)
        off = np.abs(place - nearest)
        if off.max() > 0.1:
            line = lines[int(np.argmax(off))]
            raise InputError(
                f"{path}: line {line} does not lie on an even grid in {name} with the step {step:.4g} m; "
                "interpolate the points to a grid first."
            )
        index.append(nearest.astype(int))
        steps.append(float(span / nearest.max()))
        shape.append(int(nearest.max()) + 1)
    if shape[0] * shape[1] > 4 * z.size:
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
    return Topography(heights, tuple(steps), source=path.name)


def _factor(path: Path, name: str, given: str | None, declared: str | None, what: str) -> float:
    """Return the length in m of one unit, from the option or from the header."""
    if given is None and declared is None:
        raise InputError(
            f"{path} does not declare the unit of its {what}; add --unit um, and --height-unit nm where "
            f"heights have another one "
            "(in Python unit='um', height_unit='nm'), or write it in the header as in 'x (um), z (nm)'."
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
    text = text_of(path, LARGEST_FILE, "crop the scan", "a text file of heights")
    rows = [(i, line.strip()) for i, line in enumerate(text.splitlines(), 1)]
    rows = [(i, line) for i, line in rows if line]
    start = next((k for k, (_, line) in enumerate(rows) if _is_data(line)), None)
    if start is None:
        raise InputError(f"{path} has no line of numbers.")
    body = [(i, line) for i, line in rows[start:] if not line.startswith(("#", "%"))]
    separator, comma = _dialect(path, [line for _, line in body[:200]])
    numbers, cells = [i for i, _ in body], [cells_of(line, separator, path, i) for i, line in body]
    if separator and len(cells[0]) > 1 and all(not row[-1] for row in cells):
        cells = [row[:-1] for row in cells]  # a separator at the end of each line makes no column
    width = len(cells[0])
    for number, row in zip(numbers, cells, strict=True):
        if len(row) != width:
            raise InputError(
                f"{path}: line {number} has {len(row)} columns where the lines above have {width}; "
                "correct the line, or check separator and decimal comma."
            )
    header = [line.lstrip("#%; ") for _, line in rows[:start]]
    values = values_of(path, cells, numbers, comma=comma)
    values[np.isinf(values)] = np.nan
    return _Table(values, numbers, _units(header, separator or None, width))


def _is_data(line: str) -> bool:
    cells = [cell.strip().strip('"') for cell in re.split(r"[;\t, ]+", line) if cell.strip()]
    numbers = [cell for cell in cells if re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", cell)]
    return bool(numbers) and all(cell in numbers or cell.lower() in MISSING | INFINITE for cell in cells)


def _dialect(path: Path, sample: list[str]) -> tuple[str, bool]:
    """Return separator (empty is white space) and whether the comma is the decimal sign."""
    if all(";" in line for line in sample):
        return ";", any("," in line for line in sample)
    if all("\t" in line and not re.search(r"[^\t] +[^\t ]", line) for line in sample):
        return "\t", any("," in line for line in sample)
    if not any("," in line for line in sample):
        return "", False
    if all(re.fullmatch(r"\S+(\s+\S+)+", line) and not re.search(r",\s|\s,", line) for line in sample):
        return "", True
    if all(re.fullmatch(r"[+-]?\d+,\d+([eE][+-]?\d+)?", line) for line in sample):
        raise InputError(
            f"{path}: '{sample[0]}' may be two columns or one number with a decimal comma; write points, or ; between columns."
        )
    return ",", False


def _units(header: list[str], separator: str | None, width: int) -> list[str | None]:
    """Return the unit that the last header line with as many columns declares for each."""
    for line in reversed(header):
        cells = line.rstrip(separator).split(separator)
        found = [_UNIT_IN_HEADER.search(cell.strip().strip('"')) for cell in cells]
        units = [match and (match[1] or match[2]) for match in found]
        if separator is None and any(units):
            units = [match[1] or match[2] for match in _UNIT_IN_HEADER.finditer(line)]
        if len(units) == width and any(units):
            return [unit or None for unit in units]
        named = re.search(r"unit\w*\s*[:=]\s*(\S+)", line, re.IGNORECASE)
        if named:
            return [named[1].strip(",;")] * width
    return [None] * width
