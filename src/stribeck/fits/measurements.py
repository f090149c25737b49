"""Measured friction curves: a laboratory's table becomes rows of speed, friction and error in SI units, curve by curve.

Every value that is refused is named with its row and column; what is left out or assumed is said in a note.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array, Indices
from stribeck.cases.fit_settings import FitSettings
from stribeck.files.cells import rows_listed, split_header
from stribeck.files.datasets import Column
from stribeck.files.results import Exported, Labelled
from stribeck.files.table_reading import read_table
from stribeck.files.text_table import TextTable
from stribeck.files.writing import PathLike, path_of
from stribeck.fits.table.columns import abscissa_of, columns_of, has_column, known_name, with_errors_named
from stribeck.fits.table.repeats import Row, average_repeats
from stribeck.fits.table.rig import prepared, temperature_note
from stribeck.fits.table.stated import inputs_said
from stribeck.fits.table.strokes import without_stops
from stribeck.fits.table.values import Abscissa, checked
from stribeck.quantities.formats import format_si
from stribeck.quantities.results import ByValue, Shown
from stribeck.quantities.units import InputError, show

__all__ = ["Measurements", "read_file", "with_inputs_of_curves"]

# Around what each column was taken for
READ, CHANGE_READ = "Read: ", ". To change this, name the columns in [fit.columns] of the case."

UNITS = {"speed": "m s-1", "speed_viscosity": "Pa m", "hersey_number": "1", "hersey_per_length": "m-1"}


@dataclass(frozen=True, eq=False, repr=False)
class Measurements(Exported, Shown, ByValue):
    """Measured friction in SI units, each curve in order of increasing speed; its dataset has them along ``row``."""

    _picture = "stribeck.plot.fit.plot_measurements"

    abscissa: Annotated[
        Abscissa,
        "what friction was measured against: U, eta U, the Hersey number eta U/F_N of a line or eta U R/F_N of a "
        "ball, or eta U/F_N of a ball; U is the sum of the surface speeds, twice their mean",
    ]
    values: Annotated[Array, "its values [m/s, Pa m, 1 or 1/m], shape (n,)"]
    friction: Annotated[Array, "friction coefficient [-], shape (n,)"]
    error: Annotated[Array | None, "its standard error [-] where the file gives one, shape (n,)"]
    curve: Annotated[Indices, "number of the curve to which each row belongs, shape (n,)"]
    curves: Annotated[tuple[str, ...], "names of the curves"]
    inputs: Annotated[
        tuple[dict[str, float], ...], "for each curve, inputs of the contact in SI units in which it differs from the case"
    ]
    rows: Annotated[Indices, "row of the file in which each stands, counted from 1, shape (n,)"]
    path: Annotated[str, "the file; empty where there is none"] = ""
    notes: Annotated[tuple[str, ...], "what was left out or assumed, one sentence each"] = field(default=())
    taken: Annotated[str, "what each column was taken for, and how to change that"] = ""
    run_in: Annotated[tuple[int, ...], "rows of the file that look like run-in"] = ()
    files: Annotated[
        tuple[str, ...], "for each curve the file that it is from, where several files were read; empty otherwise"
    ] = ()

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
        names, files = (np.array(each, dtype=object) for each in (self.curves, self.files))
        found: dict[str, Column] = {
            **({"file": ("row", files[self.curve], "1", "file of the row")} if self.files else {}),
            "curve": ("row", names[self.curve], "1", "name of the curve"),
            self.abscissa: ("row", self.values, UNITS[self.abscissa], self.abscissa.replace("_", " ")),
            "friction": ("row", self.friction, "1", "measured friction coefficient"),
        }
        if self.error is not None:
            found["error"] = ("row", self.error, "1", "standard error of the measured friction coefficient")
        return found

    def _labelled(self) -> Labelled:
        rows: dict[str, Column] = {"row": ("row", self.rows, "1", "row of the file")}
        return self.columns(), rows, {"title": "Measured friction", "file": self.path}


def read_file(path: PathLike, settings: FitSettings) -> Measurements:
    """Return the measured friction curves of one file, with what its name and the settings say of it."""
    table = with_errors_named(read_table(path_of(path), settings.header_row, knows=known_name, sheet=settings.sheet))
    written = table.header
    asked = settings
    table, made, run, settings, of_rig = prepared(table, asked, lambda meaning: has_column(table, asked, meaning))
    columns = columns_of(table, settings)
    idle = [name for name in asked.units if name not in (*columns, *of_rig)]
    against = abscissa_of(table, columns, settings)
    abscissa: Abscissa = "hersey_number" if against == "hersey_per_length" else against
    table = without_stops(table, columns[abscissa][0], columns["friction"], settings)
    rows: list[Row] = []
    runs: list[str] = []
    empty: list[int] = []
    frictions = columns["friction"]
    given = [name for name in columns if name in settings.inputs.quantities and name not in ("speed", "boundary_friction")]
    places = checked(table, columns[abscissa][0], abscissa, settings)
    labels = table.column(columns["curve"][0]) if "curve" in columns else [""] * len(places)
    series = {name: checked(table, columns[name][0], name, settings) for name in given}
    measured = {name: checked(table, name, "friction", settings) for name in frictions}
    errors = checked(table, columns["error"][0], "error", settings) if "error" in columns else np.ones(len(places))
    of_runs = table.column(run) if run else [""] * len(places)
    for i, number in enumerate(table.numbers):
        inputs = {name: float(values[i]) for name, values in series.items()}
        for column, frictions_there in measured.items():
            place, mu, error = float(places[i]), float(frictions_there[i]), float(errors[i])
            if any(map(math.isnan, (place, mu, error, *inputs.values()))):
                empty.append(number)
                continue
            name = labels[i] if len(frictions) == 1 else f"{labels[i]} {split_header(column)[0]}".strip()
            rows.append((name, number, place, mu, error, inputs))
            runs.append(of_runs[i])
    if not rows:
        raise InputError(f"{path}: no row holds both {abscissa.replace('_', ' ')} and friction; check the columns.")
    averaged = None
    if "error" not in columns and settings.repeats is not False and (run or settings.repeats):
        averaged = average_repeats(rows, runs, settings.run_in == "keep")
        rows = rows if averaged is None else averaged.rows
    names, of_row, differing = _curves(table.path, rows, settings, "curve" in columns or len(frictions) > 1)
    said, of_file = inputs_said(table, settings, Path(path).name, given)
    differing = tuple({**of_file, **inputs} for inputs in differing)
    order = sorted(range(len(rows)), key=lambda i: (of_row[i], rows[i][2], rows[i][1]))
    found = Measurements(
        path=str(path),
        abscissa=against,
        values=np.array([rows[i][2] for i in order]),
        friction=np.array([rows[i][3] for i in order]),
        error=np.array([rows[i][4] for i in order]) if "error" in columns or (averaged and averaged.has_errors) else None,
        curve=np.array([of_row[i] for i in order]),
        curves=names,
        inputs=differing,
        rows=np.array([rows[i][1] for i in order]),
        notes=(
            *_notes(table, columns, empty, made, run),
            *map(_idle, idle),
            *temperature_note(table),
            *(() if averaged is None else averaged.notes),
        ),
        taken=_taken(columns, written, (*made, *said), run),
        run_in=() if averaged is None else averaged.run_in,
    )
    _check_spread(found, frictions)
    return found


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
    return tuple(labels), of_row, tuple(inputs for _, inputs in first)


def with_inputs_of_curves(data: Measurements, settings: FitSettings) -> Measurements:
    """Return the measurements with the inputs that the settings have for each curve."""
    unknown = [name for name in settings.curves if name not in data.curves]
    if unknown:
        known = ", ".join(data.curves)
        raise InputError(f"{data.path}: no curve is called {show(unknown[0])}, as [fit.curves] has it; there are {known}.")
    pairs = zip(data.curves, data.inputs, strict=True)
    return replace(data, inputs=tuple({**inputs, **settings.curves.get(label, {})} for label, inputs in pairs))


def _label(inputs: dict[str, float], of_all: list[dict[str, float]], settings: FitSettings) -> str:
    """Return what the inputs of a curve are in which the curves differ, with units."""
    rows = settings.inputs.quantities
    differing = [name for name in inputs if len({each.get(name) for each in of_all}) > 1]
    return ", ".join(f"{rows[name].label} {format_si(inputs[name], rows[name].dimension, 4)}" for name in differing) or "data"


def _taken(columns: dict[str, list[str]], written: tuple[str, ...], made: tuple[str, ...], run: str) -> str:
    """Return what each column of the file was taken for, after the sentences on those that were made of others."""
    parts = [
        f"{' and '.join(map(show, names))} as {meaning.replace('_', ' ')}"
        for meaning, names in columns.items()
        if set(names) <= set(written)
    ]
    parts = [*made, *parts, *([f"{show(run)} as run"] if run else [])]
    return f"{READ}{'; '.join(parts)}{CHANGE_READ}"


def _notes(
    table: TextTable, columns: dict[str, list[str]], empty: list[int], made: tuple[str, ...] = (), run: str = ""
) -> tuple[str, ...]:
    notes = list(table.notes)
    used = {name for names in columns.values() for name in names}
    told = " ".join(made)
    if table.decimal_comma([name for name in table.written if name in used or show(name) in told]):
        notes.append("Numbers were read with decimal commas.")
    if empty:
        count = f"{len(empty)} row{'s' * (len(empty) != 1)}"
        notes.append(f"{count} without a value left out: {rows_listed(sorted(set(empty)))}.")
    unused = [name for name in table.header if name and name not in used and name != run and show(name) not in told]
    if unused:
        notes.append(f"Columns not used: {', '.join(unused)}.")
    return tuple(notes)


def _idle(meaning: str) -> str:
    """Return the sentence on a unit of something that the file does not have."""
    return f"No column was taken for {meaning.replace('_', ' ')}, of which [fit.units] has the unit."


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
