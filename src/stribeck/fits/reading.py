"""Measured friction of one or several files as one set of curves."""

from __future__ import annotations

import difflib
import glob
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from stribeck.cases.fit_settings import FitSettings
from stribeck.files.writing import path_of
from stribeck.fits.measurements import CHANGE_READ, READ, Measurements, read_file, with_inputs_of_curves
from stribeck.fits.table.stated import entries_of
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.units import InputError, checked_kind, show

__all__ = ["Data", "files_of", "measurements_of", "read_measurements"]

OneOf = str | os.PathLike[str] | Measurements
Data = OneOf | Sequence[OneOf]


@answers_typos
def read_measurements(
    path: str | os.PathLike[str] | Sequence[str | os.PathLike[str]], settings: FitSettings | None = None
) -> Measurements:
    """Read measured friction curves from a text file or a workbook, or from several.

    Parameters
    ----------
    path : str or path-like, or sequence of these
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
    return measurements_of(path, settings)


def measurements_of(data: Data, settings: FitSettings | None = None) -> Measurements:
    """Return the measurements of files, or measurements that were read, as one set of curves."""
    settings = (
        FitSettings() if settings is None else checked_kind("settings", settings, FitSettings, "the FitSettings of a case")
    )
    if isinstance(data, Measurements):
        return data
    several: list[Path | Measurements] = []
    if isinstance(data, str | os.PathLike):
        several += files_of([data])
    else:
        if not isinstance(data, list | tuple):
            raise InputError(f"data = {show(data)}; it must be a path, Measurements, or a list of these.")
        for each in data:
            several += [each] if isinstance(each, Measurements) else files_of([each])
    if not several:
        raise InputError("data is empty; give at least one file of measured friction.")
    paths = [each for each in several if isinstance(each, Path)]
    _check_entries(paths, settings)
    once = list({_key(each): each for each in several}.values())
    read = [each if isinstance(each, Measurements) else read_file(each, settings) for each in once]
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
    near = difflib.get_close_matches(path.name, [each.name for each in folder.iterdir()], 1)
    return f"{path} does not exist; {f'did you mean {folder / near[0]}?' if near else 'check its name and folder.'}"


def _key(each: Path | Measurements) -> object:
    return id(each) if isinstance(each, Measurements) else each.resolve()


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
    _check_same(read, "abscissa", [each.abscissa.replace("_", " ") for each in read], "friction over")
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
        taken=_taken(names, read),
        run_in=tuple(row for each in read for row in each.run_in),
        files=tuple(of_curve),
    )


def _check_same(read: Sequence[Measurements], name: str, values: Sequence[str], what: str) -> None:
    for each, value in zip(read, values, strict=True):
        if value != values[0]:
            raise InputError(
                f"{read[0].path or 'the first data'} has {what} {values[0]}, and {each.path or 'another'} over {value}; files "
                "that are fitted together must have the same."
            )


def _labels(read: Sequence[Measurements]) -> list[str]:
    """Return short names of files that differ: stems, else names, else paths."""
    paths = [Path(each.path or f"data {i}") for i, each in enumerate(read, 1)]
    for names in ([path.stem for path in paths], [path.name for path in paths], [str(path) for path in paths]):
        if len(set(names)) == len(names):
            return names
    return [f"{path} ({i})" for i, path in enumerate(paths, 1)]


def _errors(read: Sequence[Measurements], settings: FitSettings) -> Any:
    """Return the standard errors of all rows; files without any have those of the settings."""
    if all(each.error is None for each in read):
        return None
    relative, absolute = settings.relative_error, settings.absolute_error
    found = []
    for each in read:
        if each.error is None and relative is None and absolute is None:
            with_errors = next(other for other in read if other.error is not None)
            raise InputError(
                f"{each.path or 'some data'} has no errors of friction, and {with_errors.path or 'others'} has; give "
                "relative_error or absolute_error in [fit] for the files without."
            )
        given = np.hypot((relative or 0.0) * each.friction, absolute or 0.0)
        found.append(given if each.error is None else each.error)
    return np.concatenate(found)


def _with_names(names: Sequence[str], sentences: Sequence[tuple[str, ...]]) -> list[str]:
    """Return sentences on files with their names, once for all files where they are the same."""
    found: dict[str, list[str]] = {}
    for name, each in zip(names, sentences, strict=True):
        for sentence in each:
            found.setdefault(sentence, []).append(name)
    return [text if len(of) == len(names) else f"{', '.join(of)}: {text}" for text, of in found.items()]


def _taken(names: Sequence[str], read: Sequence[Measurements]) -> str:
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
