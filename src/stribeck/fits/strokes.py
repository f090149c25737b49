"""Rows of strokes to and fro: those at rest, and those in which friction has not turned round with the speed."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stribeck._types import Array, Flags
from stribeck.cases.fit_settings import FitSettings
from stribeck.files.cells import rows_left_out, rows_listed
from stribeck.files.text_table import TextTable
from stribeck.fits.rig import column_of
from stribeck.quantities.units import MAX_NUMBER, InputError, show
from stribeck.surfaces.text import MISSING_CODES

REST_SPEED = 1e-9  # Speed over the largest of the file below which it is zero but for rounding


def without_codes(table: TextTable, abscissa: str, friction: Sequence[str]) -> TextTable:
    """Return the table with empty cells for friction that programs write as missing; refuse a speed like that."""
    coded = _are_codes(table.values(abscissa))
    if coded.any():
        code = table.column(abscissa)[int(np.flatnonzero(coded)[0])]
        raise InputError(
            f"{table.path}: column {show(abscissa)} has {show(code)} in row {rows_listed(_numbers(table, coded))}, which "
            "programs write where a value is missing; leave such cells empty."
        )
    for name in friction:
        table = _without(table, name, _are_codes(table.values(name)))
    return table


def without_codes_of_forces(table: TextTable, settings: FitSettings) -> TextTable:
    """Return the table with empty cells for forces that programs write as missing or as beyond the range of a sensor."""
    names = (column_of(table, meaning, settings) for meaning in ("normal_force", "friction_force", "torque"))
    for name in filter(None, names):
        values = table.values(name)
        coded = _are_codes(values) | np.isin(values, list(MISSING_CODES))
        rest = values[~coded & ~np.isnan(values)]
        # A force may be 999 mN; a code is more than twice any other.
        table = _without(table, name, coded & (np.abs(values) > 2 * np.max(np.abs(rest), initial=0.0)))
    return table


def _are_codes(values: Array) -> Flags:
    """Return which numbers stand for none, whatever the others are."""
    return np.asarray(np.isin(values, [-size for size in MISSING_CODES]) | (np.abs(values) >= MAX_NUMBER))


def without_stops(table: TextTable, abscissa: str, friction: Sequence[str], settings: FitSettings) -> TextTable:
    """Return the table without rows at rest and reversals, if its signs are directions of strokes."""
    table = without_codes(table, abscissa, friction)
    speeds = table.values(abscissa)
    frictions = {name: table.values(name) for name in friction}
    largest = np.nanmax(np.abs(speeds), initial=0.0)
    rest = np.abs(speeds) <= REST_SPEED * largest
    if settings.magnitudes:
        return _moving(table, speeds, rest, list(frictions.values()))
    still = "is zero, which is static friction and no point of the curve"
    kinds = [  # column, rows, and what is said of one and of several of them
        (abscissa, speeds == 0, still, "zero (static friction)"),
        (abscissa, speeds < 0, "is negative", "negative"),
        *((name, mu <= 0, "must be positive", "not positive") for name, mu in frictions.items()),
    ]
    there = [each for each in kinds if each[1].any()]
    if not there:
        return table
    said = " and ".join(_sentence(table, *each) for each in there)
    if len(there) == 1 and there[0][2] == still:
        raise InputError(
            f"{table.path}: {said}; take such rows out, or set magnitudes = true in [fit], which leaves them out."
        )
    raise InputError(
        f"{table.path}: {said}; where signs are directions of strokes, set magnitudes = true in [fit], which leaves "
        "rows at rest and reversals out (repeats = true puts rows at the same speed together); otherwise take the rows out "
        "or correct the zero of the force."
    )


def _moving(table: TextTable, speeds: Array, rest: Flags, frictions: list[Array]) -> TextTable:
    """Return the table without rows at rest, without friction, and with friction of the other direction."""
    idle = np.logical_or.reduce([mu == 0 for mu in frictions])
    turning = np.zeros(len(speeds), dtype=bool)
    for mu in frictions:
        direction = np.sign(speeds * mu)[~rest]
        # Without both signs in both columns, one of them has been made a magnitude before.
        if all((values[~rest] < 0).any() and (values[~rest] > 0).any() for values in (speeds, mu)):
            usual = 1.0 if np.nansum(direction) >= 0 else -1.0
            turning |= np.sign(speeds * mu) == -usual
    notes = []
    for rows, what in (
        (rest, "at rest"),
        (idle & ~rest, "without friction"),
        (turning & ~rest & ~idle, "in which friction has not turned round with the speed"),
    ):
        if rows.any():
            notes.append(rows_left_out(_numbers(table, rows), what))
    kept = ~(rest | idle | turning)
    if not kept.any():
        raise InputError(f"{table.path}: no row is in motion; check the columns of speed and friction.")
    return replace(table.of_rows(kept), notes=(*table.notes, *notes))


def _without(table: TextTable, name: str, coded: Flags) -> TextTable:
    """Return the table with empty cells in place of codes of missing values."""
    if not coded.any():
        return table
    code = table.column(name)[int(np.flatnonzero(coded)[0])]
    return emptied(table, name, coded, f"with {show(code)} in {show(name)}, a missing value,")


def emptied(table: TextTable, name: str, out: Flags, which: str) -> TextTable:
    """Return the table with some empty cells, which a note counts and says why."""
    at = table.header.index(name)
    rows = tuple((*row[:at], "", *row[at + 1 :]) if each else row for row, each in zip(table.rows, out, strict=True))
    return replace(table, rows=rows, notes=(*table.notes, rows_left_out(_numbers(table, out), which)))


def _sentence(table: TextTable, name: str, rows: Flags, one: str, several: str) -> str:
    first, *others = _numbers(table, rows)
    if not others:
        return f"row {first}, column {show(name)}: {show(table.column(name)[int(np.argmax(rows))])} {one}"
    return f"column {show(name)} is {several} in {1 + len(others)} rows ({rows_listed([first, *others])})"


def _numbers(table: TextTable, rows: Flags) -> list[int]:
    return [table.numbers[i] for i in np.flatnonzero(rows)]
