"""What a file of measured friction says of all of its rows: in lines above its header, in its name, and in the case."""

from __future__ import annotations

from collections.abc import Iterator
from fnmatch import fnmatchcase
from typing import Any

from stribeck.cases.fit_settings import FitSettings, inputs_of_file
from stribeck.files.columns import stated_in
from stribeck.files.text_table import TextTable
from stribeck.fits.rig import PATTERNS
from stribeck.fluids.description import celsius
from stribeck.quantities.units import InputError

__all__ = ["entries_of", "inputs_said"]

_OF_FLUID = r"(?:(?:test|sample|oil|fluid|liquid|lubricant|bath|pot|mean) )?"

# What a line above the header may be called that gives an input of all rows.
NAMES = {
    "viscosity": rf"{_OF_FLUID}(?:dynamic )?viscosity|eta",
    "load": PATTERNS["normal_force"],
    "roughness": "roughness|rms roughness|rms height|h rms|rq|sq",
    "temperature": rf"{_OF_FLUID}temp(?:erature)?",
}


def inputs_said(table: TextTable, settings: FitSettings, name: str, columns: list[str]) -> tuple[list[str], dict[str, Any]]:
    """Return sentences on what a file says of all of its rows, and these inputs in SI units.

    Its name counts for more than its lines, and the case for more than its name.
    """
    path = table.path
    lines = {key: each for key, each in _lines(table, settings) if key not in columns}
    if "temperature" in lines and "preset" not in settings.liquid:
        del lines["temperature"]  # by which nothing is known
    try:
        of_name = {} if settings.file_names is None else settings.file_names.values(name)
    except InputError as problem:
        raise InputError(f"{path}: {problem}") from None
    given: dict[str, Any] = {}
    of_case = [settings.files[key] for key in entries_of(settings, name)]
    for rank in ({key: text for key, (text, _) in lines.items()}, of_name, *of_case):
        given = _overruled(given, rank)
    found = inputs_of_file(path, given, settings.inputs, settings.liquid) if given else {}
    said = [f"{key} {text} by row {number}" for key, (text, number) in lines.items() if given.get(key) == text]
    said += [f"{key} {text} by the name of the file" for key, text in of_name.items() if given.get(key) == text]
    return said, found


def entries_of(settings: FitSettings, name: str) -> list[str]:
    """Return the keys of [fit.files] that name a file, the most general first."""
    found = [key for key in settings.files if key == name or fnmatchcase(name, key)]
    return sorted(found, key=lambda key: (key == name, len(key)))


def _overruled(table: dict[str, Any], by: dict[str, Any]) -> dict[str, Any]:
    """Return a table with what one of a higher rank has: a viscosity or a liquid takes the place of the other."""
    fluid = by.get("fluid")
    liquid = fluid if isinstance(fluid, dict) else {}
    without: set[str] = {"temperature"} if "temperature" in liquid or "viscosity" in by else set()
    without |= {"viscosity"} if "temperature" in by or "preset" in liquid else set()
    return {key: value for key, value in table.items() if key not in without} | by


def _lines(table: TextTable, settings: FitSettings) -> Iterator[tuple[str, tuple[str, int]]]:
    """Yield each input that lines above the header give once, with its text and row."""
    found: dict[str, dict[str, int]] = {}
    for key, pattern in NAMES.items():
        for number, _, value, unit in stated_in(table, pattern):
            if unit and _is_value(key, f"{value} {unit}", settings):
                found.setdefault(key, {}).setdefault(f"{value} {unit}", number)
    for key, values in found.items():
        if len(values) == 1:
            yield key, next(iter(values.items()))


def _is_value(key: str, text: str, settings: FitSettings) -> bool:
    """Return whether text is a value of an input with its unit."""
    try:
        celsius(text) if key == "temperature" else settings.inputs.quantities[key].checked(text)
    except InputError:
        return False
    return True
