"""Measured friction curves: a laboratory's table becomes rows of speed, friction and error in SI units, curve by curve.

Every value that is refused is named with its row and column; what is left out or assumed is said in a note.
"""

from __future__ import annotations

import glob
import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array, Indices
from stribeck.cases.fit_settings import FitSettings
from stribeck.files.cells import rows_left_out, split_header
from stribeck.files.columns import BARE
from stribeck.files.datasets import Column
from stribeck.files.results import Exported, Labelled
from stribeck.files.table_reading import read_table
from stribeck.files.text_table import TextTable
from stribeck.files.writing import PathLike, path_of
from stribeck.fits.columns import abscissa_of, columns_of, curve_labels, has_column, known_name, with_errors_named
from stribeck.fits.repeats import Averaged, Row, average_repeats
from stribeck.fits.rig import prepared, temperature_note
from stribeck.fits.stated import entries_of, inputs_said
from stribeck.fits.strokes import without_codes_of_forces, without_stops
from stribeck.fits.values import Abscissa, checked, unit_in
from stribeck.quantities.formats import format_si
from stribeck.quantities.keywords import answers_typos, nearest
from stribeck.quantities.results import ByValue, Shown
from stribeck.quantities.units import InputError, checked_kind, show

# Around what each column was taken for
READ, CHANGE_READ = "Read: ", ". To change this, name the columns in [fit.columns] of the case."

UNITS = {"speed": "m/s", "speed_viscosity": "Pa m", "hersey_number": "1", "hersey_per_length": "1/m"}


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

    @property
    def _columns(self) -> dict[str, Column]:
        """Curve, abscissa, friction and its error along ``row``, as columns of a dataset."""
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
        return self._columns, rows, {"title": "Measured friction", "file": self.path}


def error_of(data: Measurements, settings: FitSettings) -> Array | None:
    """Return the standard error of friction of each row, or that of the settings; None where there is none."""
    relative, absolute = settings.relative_error, settings.absolute_error
    if data.error is not None or relative is absolute is None:
        return data.error
    return np.asarray(np.hypot((relative or 0.0) * data.friction, absolute or 0.0))


def read_file(path: PathLike, settings: FitSettings) -> Measurements:
    """Return the measured friction curves of one file, with what its name and the settings say of it."""
    table = with_errors_named(read_table(path_of(path), settings.header_row, knows=known_name, sheet=settings.sheet))
    table = without_codes_of_forces(table, settings)
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
    labels = curve_labels(table, columns)
    series = {name: checked(table, columns[name][0], name, settings) for name in given}
    measured = {name: checked(table, name, "friction", settings) for name in frictions}
    errors = checked(table, columns["error"][0], "error", settings) if "error" in columns else np.ones(len(places))
    # Where friction has no per cent, those of its error are of the friction.
    units = [
        BARE.get(unit_in(table, columns[each][0], each, settings), 1.0) for each in ("friction", "error") if each in columns
    ]
    is_relative = units[0] == 1.0 and units[-1] < 1.0
    if "error" in columns and units[0] < 1.0 and not unit_in(table, columns["error"][0], "error", settings):
        raise InputError(
            f"{table.path}: {show(columns['error'][0])} has no unit beside friction in %; write [%] in its header if it is in "
            "the same unit, or [-], or error = '%' in [fit.units]."
        )
    of_runs = table.column(run) if run else [""] * len(places)
    for i, number in enumerate(table.numbers):
        inputs = {name: float(values[i]) for name, values in series.items()}
        for column, frictions_there in measured.items():
            place, mu, error = float(places[i]), float(frictions_there[i]), float(errors[i])
            if any(map(math.isnan, (place, mu, error, *inputs.values()))):
                empty.append(number)
                continue
            error *= abs(mu) if is_relative else 1.0
            name = labels[i] if len(frictions) == 1 else f"{labels[i]} {split_header(column)[0]}".strip()
            rows.append((name, number, place, mu, error, inputs))
            runs.append(of_runs[i])
    if not rows:
        raise InputError(f"{path}: no row holds both {abscissa.replace('_', ' ')} and friction; check the columns.")
    averaged = Averaged(rows, (), (), "error" in columns)
    if "error" not in columns and settings.repeats is not False and (run or settings.repeats):
        averaged = average_repeats(rows, runs, settings.run_in == "keep")
        rows = averaged.rows
    names, of_row, differing = _curves(table.path, rows, settings, "curve" in columns or len(frictions) > 1)
    said, of_file, unused = inputs_said(table, settings, Path(path).name, list(columns))
    differing = tuple({**of_file, **inputs} for inputs in differing)
    order = sorted(range(len(rows)), key=lambda i: (of_row[i], rows[i][2], rows[i][1]))
    found = Measurements(
        path=str(path),
        abscissa=against,
        values=np.array([rows[i][2] for i in order]),
        friction=np.array([rows[i][3] for i in order]),
        error=np.array([rows[i][4] for i in order]) if averaged.has_errors else None,
        curve=np.array([of_row[i] for i in order]),
        curves=names,
        inputs=differing,
        rows=np.array([rows[i][1] for i in order]),
        notes=(
            *_notes(table, columns, empty, made, run),
            *(f"No column was taken for {each.replace('_', ' ')}, of which [fit.units] has the unit." for each in idle),
            *([f"{show(columns['error'][0])} is of the friction in each row."] if is_relative else []),
            *temperature_note(table),
            *unused,
            *averaged.notes,
        ),
        taken=_taken(columns, written, (*made, *said), run),
        run_in=averaged.run_in,
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


def _taken(columns: dict[str, list[str]], written: tuple[str, ...], made: Sequence[str], run: str) -> str:
    """Return what each column of the file was taken for, after the sentences on those that were made of others."""
    parts = [
        f"{' and '.join(map(show, names))} as {meaning.replace('_', ' ')}"
        for meaning, names in columns.items()
        if set(names) <= set(written)
    ]
    parts = [*made, *parts, *([f"{show(run)} as run"] if run else [])]
    return f"{READ}{'; '.join(parts)}{CHANGE_READ}"


def reading_of(data: Measurements) -> str:
    """Return what each column of the files was taken for, without how to change it."""
    return data.taken.replace(CHANGE_READ, ".")


def _notes(
    table: TextTable, columns: dict[str, list[str]], empty: list[int], made: Sequence[str], run: str
) -> tuple[str, ...]:
    notes = list(table.notes)
    used = {name for names in columns.values() for name in names}
    told = " ".join(made)
    if table.decimal_comma([name for name in table.written if name in used or show(name) in told]):
        notes.append("Numbers were read with decimal commas.")
    notes += table.thousands_noted([name for name in table.written if name in used])
    if empty:
        notes.append(rows_left_out(sorted(set(empty)), "without a value"))
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


OneOf = str | os.PathLike[str] | Measurements
Data = OneOf | Sequence[OneOf]


@answers_typos
def read_measurements(path: Data, settings: FitSettings | None = None) -> Measurements:
    """Read measured friction curves from a text file or a workbook, or from several.

    Parameters
    ----------
    path : str or path-like or Measurements, or sequence of these
        Columns apart by tab, semicolon, comma or spaces, with a header such as ``speed [mm/s];friction [%]``: friction, one of
        speed (the sum of both surfaces', twice a mean or entrainment speed), viscosity times speed and Hersey number, and
        where wanted its standard error, the name of the curve, and inputs of the contact in which curves differ.  Several
        files, and globs such as ``"run_*.csv"``, become one set of curves, which have the names of their files.
    settings : FitSettings, optional
        The ``[fit]`` table of a case: columns in another language, units that no header gives, and what names of files mean.

    Returns
    -------
    Measurements
        The rows that hold speed and friction.

    Raises
    ------
    InputError
        If the file cannot be read, or a value be used; the sentence names row and column.
    """
    settings = FitSettings() if settings is None else settings
    checked_kind("settings", settings, FitSettings, "the FitSettings of a case")
    if isinstance(path, Measurements):
        return path
    given = [path] if isinstance(path, str | os.PathLike) else path
    if not isinstance(given, list | tuple):
        raise InputError(f"data = {show(path)}; it must be a path, Measurements, or a list of these.")
    several: list[Path | Measurements] = []
    for each in given:
        several += [each] if isinstance(each, Measurements) else files_of([each])
    if not several:
        raise InputError("data is empty; give at least one file of measured friction.")
    paths = [each for each in several if isinstance(each, Path)]
    _check_entries(paths, settings)
    once = {id(each) if isinstance(each, Measurements) else each.resolve(): each for each in several}
    read = [each if isinstance(each, Measurements) else read_file(each, settings) for each in once.values()]
    return with_inputs_of_curves(read[0] if len(read) == 1 else _joined(read, settings), settings)


def files_of(paths: Sequence[Any]) -> list[Path]:
    """Return the files of paths and globs; a glob without a file is refused, and a lone missing file is left to its reader."""
    found: list[Path] = []
    for each in paths:
        path = path_of(each, "data")
        if not path.exists() and glob.has_magic(str(path)):
            matches = sorted(glob.glob(str(path)))
            if not matches:
                raise InputError(f"{path} matches no file; give the names of the files, or another glob.")
            found += map(Path, matches)
        else:
            found.append(path)
    return found


def missing_text(path: Path) -> str:
    """Return the sentence on a file that does not exist, with the one in its folder that may be meant."""
    folder = path.parent
    if not folder.is_dir():
        return f"{path} does not exist, nor does its folder {folder}."
    near = nearest(path.name, [each.name for each in folder.iterdir()])
    return f"{path} does not exist; {f'did you mean {folder / near}?' if near else 'check its name and folder.'}"


def _check_entries(paths: Sequence[Path], settings: FitSettings) -> None:
    """Refuse a key of [fit.files] that names no file where a file has no entry: one of them is misspelt."""
    if not paths or not settings.files:
        return
    used = {path.name: entries_of(settings, path.name) for path in paths}
    idle = [key for key in settings.files if not any(key in keys for keys in used.values())]
    without = [name for name, keys in used.items() if not keys]
    if idle and without:
        raise InputError(
            f"no file is called {show(idle[0])}, as [fit.files] has it, and {show(without[0])} has no entry there; "
            "make the names agree, or take the entry out."
        )


def _joined(read: Sequence[Measurements], settings: FitSettings) -> Measurements:
    """Return the curves of several files as one set."""
    first = read[0]
    for each in read:
        if each.abscissa != first.abscissa:
            over, other = (one.abscissa.replace("_", " ") for one in (first, each))
            raise InputError(
                f"{first.path or 'the first data'} has friction over {over}, and {each.path or 'another'} over {other}; files "
                "that are fitted together must have the same."
            )
    names = _labels(read)
    curves, inputs, of_curve, numbers = list[str](), list[dict[str, Any]](), list[str](), list[Any]()
    for name, each in zip(names, read, strict=True):
        numbers.append(each.curve + len(curves))
        curves += [name] if len(each.curves) == 1 else [f"{name}: {curve}" for curve in each.curves]
        inputs += each.inputs
        of_curve += each.files or [name] * len(each.curves)
    errors = _errors(read, settings)
    return Measurements(
        abscissa=first.abscissa,
        values=np.concatenate([each.values for each in read]),
        friction=np.concatenate([each.friction for each in read]),
        error=errors,
        curve=np.concatenate(numbers),
        curves=tuple(curves),
        inputs=tuple(inputs),
        rows=np.concatenate([each.rows for each in read]),
        path=_listed([each.path or name for name, each in zip(names, read, strict=True)]),
        notes=(*_with_names(names, [each.notes for each in read]), *_same_rows(names, read)),
        taken=_taken_of_all(names, read),
        run_in=tuple(row for each in read for row in each.run_in),
        files=tuple(of_curve),
    )


def _labels(read: Sequence[Measurements]) -> list[str]:
    """Return short names of files that differ: stems, else names, else paths."""
    paths = [Path(each.path or f"data {i}") for i, each in enumerate(read, 1)]
    for names in ([path.stem for path in paths], [path.name for path in paths], [str(path) for path in paths]):
        if len(set(names)) == len(names):
            return names
    return [f"{path} ({i})" for i, path in enumerate(paths, 1)]


def _errors(read: Sequence[Measurements], settings: FitSettings) -> Array | None:
    """Return the standard errors of all rows; files without any have those of the settings."""
    with_errors = next((each for each in read if each.error is not None), None)
    if with_errors is None:
        return None
    found = []
    for each in read:
        error = error_of(each, settings)
        if error is None:
            raise InputError(
                f"{each.path or 'some data'} has no errors of friction, and {with_errors.path or 'others'} has; give "
                "relative_error or absolute_error in [fit] for the files without."
            )
        found.append(error)
    return np.concatenate(found)


def _with_names(names: Sequence[str], sentences: Sequence[tuple[str, ...]]) -> list[str]:
    """Return sentences on files with their names, once for all files where they are the same."""
    found: dict[str, list[str]] = {}
    for name, each in zip(names, sentences, strict=True):
        for sentence in each:
            found.setdefault(sentence, []).append(name)
    return [text if len(of) == len(names) else f"{', '.join(of)}: {text}" for text, of in found.items()]


def _taken_of_all(names: Sequence[str], read: Sequence[Measurements]) -> str:
    """Return what the columns of all files were taken for, then what each has for itself."""
    parts = [each.taken.removeprefix(READ).removesuffix(CHANGE_READ).split("; ") if each.taken else [] for each in read]
    shared = [part for part in parts[0] if all(part in each for each in parts)]
    own = ["; ".join(part for part in each if part not in shared) for each in parts]
    texts = [*shared, *(f"{name}: {text}" for name, text in zip(names, own, strict=True) if text)]
    return f"{READ}{'; '.join(texts)}{CHANGE_READ}" if texts else ""


def _same_rows(names: Sequence[str], read: Sequence[Measurements]) -> list[str]:
    """Return a sentence on files that hold the same rows, which count twice."""
    found, seen = [], dict[bytes, str]()
    for name, each in zip(names, read, strict=True):
        key = each.values.tobytes() + each.friction.tobytes()
        if key in seen:
            found.append(f"{name} holds the same rows as {seen[key]}; they count twice, which makes intervals too narrow.")
        seen.setdefault(key, name)
    return found


def _listed(paths: Sequence[str]) -> str:
    most = 4
    return ", ".join([*paths[:most], *([f"{len(paths) - most} more"] if len(paths) > most else [])])
