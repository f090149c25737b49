"""Measured friction curves: a laboratory's table becomes rows of speed, friction and error in SI units, curve by curve.

Every value that is refused is named with its row and column; what is left out or assumed is said in a note.
"""

from __future__ import annotations

import math
import os
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from stribeck._types import Array, Indices
from stribeck.cases.fit_settings import FitSettings
from stribeck.files.cells import MISSING, header_words, is_called, number_of, split_header
from stribeck.files.datasets import Column, new_dataset
from stribeck.files.results import Exported
from stribeck.files.text_table import TextTable, read_table
from stribeck.fits.rig import MADE_RATIO, MADE_SPEED, PATTERNS, RIG, Row, average_repeats, prepared
from stribeck.quantities.formats import format_si
from stribeck.quantities.input_rows import ROWS
from stribeck.quantities.inputs import quantity
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.results import ByValue, Shown
from stribeck.quantities.units import InputError, show, to_si

if TYPE_CHECKING:
    import xarray

__all__ = ["Measurements", "read_measurements"]

Abscissa = Literal["speed", "speed_viscosity", "hersey_number"]

ABSCISSAS: tuple[Abscissa, ...] = ("speed", "speed_viscosity", "hersey_number")

UNITS = {"speed": "m s-1", "speed_viscosity": "Pa m", "hersey_number": "1"}

DIMENSION = {"speed": "speed", "speed_viscosity": "drag", "hersey_number": "number", "friction": "number", "error": "number"}

WORDS = {
    "speed": {"speed", "velocity", "sliding speed", "sliding velocity", "u", "v"},
    "speed_viscosity": {"eta u", "etau", "speed viscosity", "viscosity speed", "viscosity times speed"},
    "hersey_number": {"hersey", "hersey number"},
    "friction": {
        *("friction", "friction coefficient", "coefficient of friction", "cof", "mu", "µ", "μ"),
        *("friction coeff", "traction coeff", "traction coefficient"),
    },
    "error": {"error", "friction error", "mu error", "uncertainty", "standard error", "standard deviation", "std", "sigma"},
    "curve": {"curve", "series", "sample"},
    MADE_RATIO: {"slide to roll"},
} | {
    row.name: {row.name.replace("_", " "), *row.headers}
    for row in ROWS
    if not row.derived and row.name not in ("speed", "boundary_friction")
}
"""Headers that say what a column is, in lower case; in other languages [fit.columns] says it."""

LARGEST_FRICTION = 10.0
"""Friction coefficient from which percent are suspected."""

BARE = {"": 1.0, "-": 1.0, "1": 1.0, "%": 0.01, "percent": 0.01, "‰": 0.001}
"""Units of a friction coefficient."""

_FORCE = re.compile(r"force|kraft|\(m?N\)|\[m?N\]", re.IGNORECASE)


@dataclass(frozen=True, eq=False, repr=False)
class Measurements(Exported, Shown, ByValue):
    """Measured friction in SI units, each curve in order of increasing speed.

    Attributes
    ----------
    path : str
        The file; empty where there is none.
    abscissa : {"speed", "speed_viscosity", "hersey_number"}
        What friction was measured against; the speed in it is the sum of the surface speeds, twice their mean.
    values : ndarray, shape (n,)
        Its values [m/s, Pa m or 1].
    friction : ndarray, shape (n,)
        Friction coefficient [-].
    error : ndarray, shape (n,), or None
        Its standard error [-] where the file gives one.
    curve : ndarray of int, shape (n,)
        Number of the curve to which each row belongs.
    curves : tuple of str
        Names of the curves.
    inputs : tuple of dict
        For each curve, inputs of the contact in SI units in which it differs from the case.
    rows : ndarray of int, shape (n,)
        Row of the file in which each stands, counted from 1.
    notes : tuple of str
        What was left out or assumed, one sentence each.
    taken : str
        What each column was taken for, and how to change that.
    run_in : tuple of int
        Rows of the file that look like run-in.
    """

    abscissa: Abscissa
    values: Array
    friction: Array
    error: Array | None
    curve: Indices
    curves: tuple[str, ...]
    inputs: tuple[dict[str, float], ...]
    rows: Indices
    path: str = ""
    notes: tuple[str, ...] = field(default=())
    taken: str = ""
    run_in: tuple[int, ...] = ()

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.friction)

    def columns(self) -> dict[str, Column]:
        """Return curve, abscissa, friction and its error along ``row``, as columns of a dataset.

        Returns
        -------
        dict of str to tuple
            Dimension, values, unit and long name of each, as of :func:`stribeck.files.datasets.new_dataset`.
        """
        names = np.array(self.curves, dtype=object)
        found: dict[str, Column] = {
            "curve": ("row", names[self.curve], "1", "name of the curve"),
            self.abscissa: ("row", self.values, UNITS[self.abscissa], self.abscissa.replace("_", " ")),
            "friction": ("row", self.friction, "1", "measured friction coefficient"),
        }
        if self.error is not None:
            found["error"] = ("row", self.error, "1", "standard error of the measured friction coefficient")
        return found

    def to_dataset(self) -> xarray.Dataset:
        """Return the rows as an xarray Dataset.

        Returns
        -------
        xarray.Dataset
            Along ``row`` of the file: curve, abscissa, friction, and its error where the file gives one; needs the extra
            ``data``.

        Raises
        ------
        MissingExtraError
            If xarray is not installed.
        """
        rows: dict[str, Column] = {"row": ("row", self.rows, "1", "row of the file")}
        return new_dataset(self.columns(), rows, {"title": "Measured friction", "file": self.path})

    def _draw(self, path: Any, **options: Any) -> Any:
        from stribeck.fits.plot import plot_measurements

        return plot_measurements(self, path, **options)


@answers_typos
def read_measurements(path: str | os.PathLike[str], settings: FitSettings | None = None) -> Measurements:
    """Read measured friction curves from a text file.

    Parameters
    ----------
    path : str or path-like
        Columns apart by tab, semicolon, comma or spaces, with a header such as ``speed [mm/s];friction [%]``: friction, one of
        speed (the sum of both surfaces', twice a mean or entrainment speed), viscosity times speed and Hersey number, and
        where wanted its standard error, the name of the curve, and inputs of the contact in which curves differ.
    settings : FitSettings, optional
        The ``[fit]`` table of a case: columns in another language, units that no header gives.

    Returns
    -------
    Measurements
        The rows that hold speed and friction.

    Raises
    ------
    InputError
        If the file cannot be read, or a value be used; the sentence names row and column.
    """
    settings = settings or FitSettings()
    table = read_table(Path(path), settings.header_row)
    written = table.header
    table, made, run = prepared(table, settings, lambda meaning: _has(table, settings, meaning))
    columns = _columns(table, settings)
    abscissa = _abscissa(table, columns)
    reader = _Reader(table, settings)
    rows: list[Row] = []
    runs: list[str] = []
    empty: list[int] = []
    frictions = columns["friction"]
    given = [name for name in columns if name in settings.inputs.quantities and name not in ("speed", "boundary_friction")]
    for i, number in enumerate(table.numbers):
        place = reader.value(i, columns[abscissa][0], abscissa)
        label = table.rows[i][table.header.index(columns["curve"][0])] if "curve" in columns else ""
        inputs = {name: reader.value(i, columns[name][0], name) for name in given}
        for column in frictions:
            mu = reader.value(i, column, "friction")
            error = reader.value(i, columns["error"][0], "error") if "error" in columns else 1.0
            if place is None or mu is None or error is None or None in inputs.values():
                empty.append(number)
                continue
            name = label if len(frictions) == 1 else f"{label} {split_header(column)[0]}".strip()
            known = {key: value for key, value in inputs.items() if value is not None}
            rows.append((name, number, place, mu, error, known))
            runs.append(table.rows[i][table.header.index(run)] if run else "")
    if not rows:
        raise InputError(f"{path}: no row holds both {abscissa.replace('_', ' ')} and friction; check the columns.")
    averaged = None
    if "error" not in columns and settings.repeats is not False and (run or settings.repeats):
        averaged = average_repeats(rows, runs, settings.run_in == "keep")
        rows = rows if averaged is None else averaged.rows
    names, of_row, differing = _curves(table.path, rows, settings, "curve" in columns or len(frictions) > 1)
    order = sorted(range(len(rows)), key=lambda i: (of_row[i], rows[i][2], rows[i][1]))
    found = Measurements(
        path=str(path),
        abscissa=abscissa,
        values=np.array([rows[i][2] for i in order]),
        friction=np.array([rows[i][3] for i in order]),
        error=np.array([rows[i][4] for i in order]) if "error" in columns or averaged is not None else None,
        curve=np.array([of_row[i] for i in order]),
        curves=names,
        inputs=differing,
        rows=np.array([rows[i][1] for i in order]),
        notes=(*_notes(table, columns, empty, made, run), *(() if averaged is None else averaged.notes)),
        taken=_taken(columns, written, made, run),
        run_in=() if averaged is None else averaged.run_in,
    )
    _check_spread(found, frictions)
    return found


class _Reader:
    """Cells in SI units; a cell with a unit of its own is read with that."""

    def __init__(self, table: TextTable, settings: FitSettings) -> None:
        self.table, self.settings = table, settings
        self.decimal = "," if table.decimal_comma else "."
        self.factors: dict[tuple[str, str], float] = {}

    def value(self, i: int, column: str, meaning: str) -> float | None:
        """Return a value in SI units, None where it is missing."""
        at = self.table.header.index(column)
        cell = self.table.rows[i][at]
        where = f"{self.table.path}: row {self.table.numbers[i]}, column {show(column)}"
        if cell.lower() in MISSING:
            return None
        found = number_of(cell, self.decimal)
        if found is None:
            raise InputError(f"{where}: {show(cell)} is not a number; leave the cell empty where a value is missing.")
        number, unit = found
        value = number * (self._factor(unit, meaning, where) if unit else self._unit(column, at, meaning))
        return self._checked(value, cell, meaning, where)

    def _unit(self, column: str, at: int, meaning: str) -> float:
        """Return the SI value of the unit of a column: that of [fit.units], of the header, or of a row of units."""
        key = (column, meaning)
        if key not in self.factors:
            row = self.table.units_row[at] if self.table.units_row else ""
            unit = self.settings.units.get(meaning) or split_header(column)[1] or row
            where = f"{self.table.path}: column {show(column)}"
            self.factors[key] = self._factor(unit, meaning, where)
        return self.factors[key]

    def _factor(self, unit: str, meaning: str, where: str) -> float:
        dimension = DIMENSION.get(meaning) or self.settings.inputs.quantities[meaning].dimension
        if dimension == "number":
            if unit not in BARE:
                raise InputError(f"{where} has the unit {show(unit)}; {meaning.replace('_', ' ')} is a bare number or in %.")
            return BARE[unit]
        if not unit:
            noun = meaning.replace("_", " ")
            raise InputError(
                f"{where} has no unit; write it in the header, as in '{noun} [mm/s]', or {meaning} = \"mm/s\" in [fit.units]."
                if dimension == "speed"
                else f"{where} has no unit; write it in the header, in brackets, or in [fit.units] under {meaning}."
            )
        try:
            return to_si(f"1 {unit}", dimension, meaning)
        except InputError as problem:
            raise InputError(f"{where}: {str(problem).replace(f'{meaning} = ', 'unit ', 1)}") from None

    def _checked(self, value: float, cell: str, meaning: str, where: str) -> float:
        if self.settings.magnitudes and meaning in (*ABSCISSAS, "friction"):
            value = abs(value)
        if meaning in ABSCISSAS and value <= 0:
            kind = "negative" if value < 0 else "zero, which is static friction and not a point of the curve"
            raise InputError(
                f"{where}: {show(cell)} is {kind}; take the row out, or set magnitudes = true in [fit] where the sign "
                "is the direction of a stroke."
                if value < 0
                else f"{where}: {show(cell)} is {kind}; take the row out."
            )
        if meaning == "friction" and value <= 0:
            raise InputError(
                f"{where}: {show(cell)} must be positive; take the row out, correct the zero of the force, or set "
                "magnitudes = true in [fit] where the sign is the direction of a stroke."
            )
        if meaning == "friction" and value > LARGEST_FRICTION:
            raise InputError(
                f"{where}: a friction coefficient of {value:g} is not plausible; if it is in percent, write [%] in the "
                'header or friction = "%" in [fit.units].'
            )
        if meaning == "error" and value <= 0:
            raise InputError(f"{where}: {show(cell)} must be positive; a standard error of zero would outweigh all rows.")
        if meaning in self.settings.inputs.quantities and meaning != "speed":
            try:
                quantity(meaning, value, self.settings.inputs)
            except InputError as problem:
                raise InputError(f"{where}: {problem}") from None
        return value


def _columns(table: TextTable, settings: FitSettings) -> dict[str, list[str]]:
    """Return what is in the file -> headers of its columns."""
    found: dict[str, list[str]] = {}
    for meaning, wanted in settings.columns.items():
        texts = wanted if isinstance(wanted, list) else [wanted]
        if meaning in RIG:
            continue
        for text in texts:
            same = [name for name in table.header if is_called(name, text)]
            if len(same) != 1:
                raise InputError(
                    f"{table.path}: {_listed(table)}, none called {show(text)}, which [fit.columns] has as {meaning}."
                )
            found.setdefault(meaning, []).append(same[0])
    declared = {name for names in found.values() for name in names}
    declared |= {name for name in table.header if _declared_for_rig(name, settings)}
    for name in table.header:
        words = header_words(name)
        for meaning, known in WORDS.items():
            if name in declared or words not in known or meaning in settings.columns:
                continue
            if meaning == "speed" and MADE_SPEED in table.header and name != MADE_SPEED:
                continue
            if meaning in found:
                raise InputError(
                    f"{table.path}: the columns {show(found[meaning][0])} and {show(name)} both look like {meaning}; "
                    f"say which in [fit.columns] of the case."
                )
            found[meaning] = [name]
    if "friction" not in found or not any(name in found for name in ABSCISSAS):
        missing = ["speed"] * (not any(name in found for name in ABSCISSAS)) + ["friction"] * ("friction" not in found)
        used = {name for names in found.values() for name in names}
        unknown = [name for name in table.header if name not in used] or [""]
        speeds = [name for name in unknown if re.search(r"/\s*(s|min|h)\b", split_header(name)[1])]
        bare = [name for name in unknown if name not in speeds and split_header(name)[1] in BARE and not _FORCE.search(name)]
        if "friction" in missing and not bare and any(_FORCE.search(name) for name in unknown):
            raise InputError(
                f"{table.path}: {_listed(table)}, none of which is a friction coefficient; a force is none: add a column "
                "friction, the friction force over the normal force."
            )
        examples = {"speed": (speeds or unknown)[0], "friction": (bare or unknown)[-1]}
        raise InputError(
            f"{table.path}: {_listed(table)}, none of which is known as {' or '.join(missing)}; say which in [fit.columns] of "
            f"the case, as in {' and '.join(f'{name} = {show(examples[name])}' for name in missing)}."
        )
    return found


def _listed(table: TextTable) -> str:
    return f"the columns are {', '.join(show(name) for name in table.header if name)} (separated by {table.separator}s)"


def _abscissa(table: TextTable, columns: dict[str, list[str]]) -> Abscissa:
    there = [name for name in ABSCISSAS if name in columns]
    if len(there) > 1:
        # Speed is what was set; the others follow from it.
        if "speed" in there:
            return "speed"
        raise InputError(f"{table.path}: the file has {' and '.join(there)}; keep one of them.")
    return there[0]


def _curves(
    path: str, rows: list[Row], settings: FitSettings, named: bool
) -> tuple[tuple[str, ...], list[int], tuple[dict[str, float], ...]]:
    """Return names of the curves, the curve of each row, and the inputs of each curve."""
    keys: dict[Any, int] = {}
    of_row, first = list[int](), list[tuple[int, dict[str, float]]]()
    for name, number, _, _, _, inputs in rows:
        key: Any = name if named else tuple(inputs.items())
        if key not in keys:
            keys[key] = len(keys)
            first.append((number, inputs))
        at = keys[key]
        for quantity_name, value in inputs.items():
            if first[at][1][quantity_name] != value:
                raise InputError(
                    f"{path}: row {number} has {quantity_name} {value:g} where row {first[at][0]} of the same curve, "
                    f"{show(name)}, has {first[at][1][quantity_name]:g} (SI); give them different names."
                )
        of_row.append(at)
    labels = list(keys) if named else [_label(each, [inputs for _, inputs in first], settings) for _, each in first]
    unknown = [name for name in settings.curves if name not in labels]
    if unknown:
        known = ", ".join(labels)
        raise InputError(f"{path}: no curve is called {show(unknown[0])}, as [fit.curves] has it; there are {known}.")
    inputs_of = tuple({**first[i][1], **settings.curves.get(label, {})} for i, label in enumerate(labels))
    return tuple(labels), of_row, inputs_of


def _label(inputs: dict[str, float], of_all: list[dict[str, float]], settings: FitSettings) -> str:
    """Return what the inputs of a curve are in which the curves differ, with units."""
    rows = settings.inputs.quantities
    differing = [name for name in inputs if len({each.get(name) for each in of_all}) > 1]
    return ", ".join(f"{rows[name].label} {format_si(inputs[name], rows[name].dimension, 4)}" for name in differing) or "data"


def _has(table: TextTable, settings: FitSettings, meaning: str) -> bool:
    """Return whether a table has an unambiguous column of friction, or of an abscissa."""
    wanted = ABSCISSAS if meaning == "speed" else (meaning,)
    if any(each in settings.columns for each in wanted):
        return True
    words = {header_words(name) for name in table.header if not _declared_for_rig(name, settings)}
    # Beside these a sliding speed is the difference of the surface speeds, and the speed their sum.
    rolling = [PATTERNS[each] for each in ("slide_to_roll", "entrainment_speed", "surface_speeds")]
    rolls = any(re.fullmatch(pattern, word) for pattern in rolling for word in words)
    sliding = {"sliding speed", "sliding velocity"} if rolls else set()
    return any(words & (WORDS[each] - sliding) for each in wanted)


def _declared_for_rig(name: str, settings: FitSettings) -> bool:
    """Return whether the settings say that a column is one of a rig."""
    texts = [text for meaning in RIG for text in np.atleast_1d(settings.columns.get(meaning, [])).tolist()]
    return any(is_called(name, text) for text in texts)


def _taken(columns: dict[str, list[str]], written: tuple[str, ...], made: tuple[str, ...], run: str) -> str:
    """Return what each column of the file was taken for, after the sentences on those that were made of others."""
    parts = [
        f"{' and '.join(map(show, names))} as {meaning.replace('_', ' ')}"
        for meaning, names in columns.items()
        if set(names) <= set(written)
    ]
    parts = [*made, *parts, *([f"{show(run)} as run"] if run else [])]
    return f"Read: {'; '.join(parts)}. To change this, name the columns in [fit.columns] of the case."


def _notes(
    table: TextTable, columns: dict[str, list[str]], empty: list[int], made: tuple[str, ...] = (), run: str = ""
) -> tuple[str, ...]:
    notes = []
    if table.skipped:
        notes.append(f"{table.skipped} row{'s' * (table.skipped > 1)} of other text above the header skipped.")
    if table.decimal_comma:
        notes.append("Numbers were read with decimal commas.")
    if empty:
        rows = ", ".join(map(str, sorted(set(empty))[:10])) + (", ..." if len(set(empty)) > 10 else "")
        notes.append(f"{len(empty)} row{'s' * (len(empty) != 1)} without a value left out: {rows}.")
    used = {name for names in columns.values() for name in names}
    told = " ".join(made)
    unused = [name for name in table.header if name and name not in used and name != run and show(name) not in told]
    if unused:
        notes.append(f"Columns not used: {', '.join(unused)}.")
    return tuple(notes)


def _check_spread(data: Measurements, frictions: list[str]) -> None:
    """Refuse data without a curve: a single speed, or the same friction in all rows."""
    first, last = int(data.rows.min()), int(data.rows.max())
    if len(data) > 1 and np.ptp(data.values) == 0:
        raise InputError(
            f"{data.path}: rows {first} to {last} all have the same {data.abscissa.replace('_', ' ')}; a curve needs several."
        )
    if len(data) > 2 and np.ptp(data.friction) <= 1e-12 * data.friction.max():
        raise InputError(
            f"{data.path}: column {show(frictions[0])} has the same value {data.friction[0]:g} in all rows {first} to {last}; "
            "a constant curve shows only a plateau: check the sensor, or measure at more speeds."
        )
    if not math.isfinite(float(data.values.max()) / float(data.values.min())):
        raise InputError(f"{data.path}: the {data.abscissa} spans more than double precision holds; check its unit.")
