"""What a file of measured friction says of all of its rows: in lines above its header, in its name, and in the case."""

import re
from fnmatch import fnmatchcase
from typing import Any

from stribeck.cases.fit_settings import FitSettings, inputs_of_file
from stribeck.files.cells import is_named
from stribeck.files.columns import has_dimension, refuse_late_value, refuse_two_values, si_factor, stated_in
from stribeck.files.text_table import TextTable
from stribeck.fits.rig import PATTERNS, is_same, stated_size
from stribeck.fluids.description import celsius
from stribeck.quantities.units import DIMENSIONS, InputError, show

_OF_FLUID = r"(?:(?:test|sample|oil|fluid|liquid|lubricant|bath|pot|mean) )?"

# What a line above the header may be called that gives an input of all rows.
NAMES = {
    "viscosity": rf"{_OF_FLUID}(?:dynamic )?viscosity|eta",
    "load": PATTERNS["normal_force"],
    "roughness": "roughness|rms roughness|rms height|h rms|rq|sq",
    "temperature": rf"{_OF_FLUID}temp(?:erature)?",
}


def inputs_said(
    table: TextTable, settings: FitSettings, name: str, columns: list[str]
) -> tuple[list[str], dict[str, Any], list[str]]:
    """Return sentences on what a file says of all of its rows, these inputs in SI units, and notes on what was not used."""
    lines, unread = _lines(table, settings, [key for key in NAMES if key not in columns])
    if "preset" not in settings.liquid:
        lines.pop("temperature", None)  # by which nothing is known
    try:
        of_name = {} if settings.file_names is None else settings.file_names.values(name)
    except InputError as problem:
        raise InputError(f"{table.path}: {problem}") from None
    given: dict[str, Any] = {}  # the name of the file counts for more than its lines, and the case for more than its name
    of_case = [settings.files[key] for key in entries_of(settings, name)]
    for rank in ({key: text for key, [(_, text, _), *_] in lines.items()}, of_name, *of_case):
        given = _overruled(given, rank)
    for key, [(size, text, number), *others] in lines.items():
        apart = [row for other, _, row in others if not is_same(size, other, measured=key == "load")]
        if apart and given.get(key) == text:
            refuse_two_values(table, (number, apart[0]), (key, key))
        if given.get(key) == text:
            refuse_late_value(table, number, key)
    if not {"load", "curve"} & {*columns, *given}:
        stated_size(table, PATTERNS["normal_force"], "force")  # two forces on a cylinder, whose load they are not
    found = inputs_of_file(table.path, given, settings.inputs, settings.liquid) if given else {}
    said = [f"{key} {text} by row {row}" for key, [(_, text, row), *_] in lines.items() if given.get(key) == text]
    said += [f"{key} {text} by the name of the file" for key, text in of_name.items() if given.get(key) == text]
    return said, found, [note for key, note in unread.items() if key not in given]


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


def _lines(
    table: TextTable, settings: FitSettings, keys: list[str]
) -> tuple[dict[str, list[tuple[float, str, int]]], dict[str, str]]:
    """Return the different values that lines of text give of inputs, also as text, with their rows; and what was not read."""
    found: dict[str, dict[float, tuple[float, str, int]]] = {}
    unread: dict[str, str] = {}
    for key in keys:
        stated = list(stated_in(table, NAMES[key]))
        known = {number for number, *_ in stated}
        for number, line in (*table.above, *table.between):
            name, _, text = re.split("([:=\t]|$)", line, maxsplit=1)
            if number not in known and re.search("[0-9]", text) and is_named(name, NAMES[key]):
                what = f"{show(text.strip())} of row {number}"
                unread.setdefault(key, f"The {key} {what} was not used: it is no number with a unit.")
        for number, _, value, unit in stated:
            texts = [f"{value} {unit}"] if unit else []
            if unit and key != "temperature" and has_dimension(unit, settings.inputs.quantities[key].dimension):
                kind = settings.inputs.quantities[key].dimension
                # Grams and mPas, which files have and cases do not
                texts.append(f"{float(value) * si_factor(unit, kind, key)!r} {DIMENSIONS[kind].unit}")
            values = [(each, text) for text in texts if (each := _value(key, text, settings)) is not None]
            for size, text in values[:1]:
                found.setdefault(key, {}).setdefault(size, (size, text, number))
            if not values and key != "temperature":
                usual = DIMENSIONS[settings.inputs.quantities[key].dimension].unit
                what = f"{value} {unit}".strip()
                unread.setdefault(key, f"The {key} {what} of row {number} was not used: it is not in {usual} or alike.")
    unread.pop("temperature", None)  # of which a note tells by its column
    return {key: list(values.values()) for key, values in found.items()}, unread


def _value(key: str, text: str, settings: FitSettings) -> float | None:
    """Return the value [SI, degC] that text gives of an input with its unit; None if it gives none."""
    try:
        return celsius(text) if key == "temperature" else settings.inputs.quantities[key].checked(text)
    except InputError:
        return None
