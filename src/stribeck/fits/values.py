"""Columns of a laboratory's table: which the case names, their units, and their cells in SI units.

A cell that cannot be used is named by row and column; one with a unit of its own is read with that.
"""

import re
from typing import Literal

import numpy as np

from stribeck._types import Array
from stribeck.cases.fit_settings import FitSettings
from stribeck.files.cells import is_called, is_named, normalised_header
from stribeck.files.columns import BARE, has_dimension, si_factor
from stribeck.files.text_table import TextTable
from stribeck.quantities.units import DIMENSIONS, InputError, show

Abscissa = Literal["speed", "speed_viscosity", "hersey_number", "hersey_per_length"]

ABSCISSAS: tuple[Abscissa, ...] = ("speed", "speed_viscosity", "hersey_number")

# Dimension of what a column may hold beside inputs of the contact; a column of another one is something else.
DIMENSION = {
    "speed": "speed",
    "speed_viscosity": "drag",
    "hersey_number": "number",
    "friction": "number",
    "error": "number",
    "entrainment_speed": "speed",
    "sliding_speed": "speed",
    "surface_speeds": "speed",
    "slide_to_roll": "number",
    "friction_force": "force",
    "normal_force": "force",
    "rotation": "rotation",
    "torque": "torque",
}

UNITS = {"speed": "mm/s", "rotation": "rpm", "torque": "mN m"}  # Units of examples where rigs have other ones than cases

LARGEST_FRICTION = 10.0  # Friction coefficient from which percent are suspected

MADE_FRICTION = "friction of forces"  # Header of the column of friction that was made of forces


def what_may_be_wrong(name: str) -> str:
    """Return what a user checks where a column holds no plausible friction."""
    if name == MADE_FRICTION:
        return "check the units of the forces, the torque and its arm"
    return 'if it is in percent, write [%] in the header or friction = "%" in [fit.units]'


def named_in_case(table: TextTable, settings: FitSettings, meaning: str, error: str = "") -> list[str]:
    """Return the headers that the case has for a column, one for each of its texts; ``error`` is what errors are called."""
    wanted, found = settings.columns[meaning], list[str]()
    for text in wanted if isinstance(wanted, list) else [wanted]:
        same = [name for name in table.header if is_called(name, text)]
        if not same and meaning == "error":  # one of several of a name: that of friction
            same = [name for name in table.header if name.endswith(f" {text}") and is_named(name, error)]
        if not same:
            raise InputError(f"{table.path}: {listed(table)}, none called {show(text)}, which [fit.columns] has as {meaning}.")
        found.append(same[0])
    return found


def undeclared(table: TextTable, settings: FitSettings) -> list[str]:
    """Return the headers of which the case does not say what they are."""
    texts = [text for wanted in settings.columns.values() for text in np.atleast_1d(wanted).tolist()]
    return [name for name in table.header if name and not any(is_called(name, text) for text in texts)]


def listed(table: TextTable) -> str:
    """Return the sentence that lists the columns of a file."""
    return f"the columns are {', '.join(map(show, table.written))} (separated by {table.separator}s)"


def is_set(name: str) -> bool:
    """Return whether a column holds what was asked of the rig and not what it measured."""
    return re.search(r"\b(?:nominal|set|target)\b", normalised_header(name)) is not None


def dimension_of(meaning: str, settings: FitSettings) -> str:
    """Return the dimension of what a column may hold."""
    return DIMENSION.get(meaning) or settings.inputs.quantities[meaning].dimension


def unit_in(table: TextTable, name: str, meaning: str, settings: FitSettings) -> str:
    """Return the unit of a column: that of [fit.units], or as the file has it; one that is called RPM needs none."""
    unit = settings.units.get(meaning)
    if meaning == "normal_force" and normalised_header(name) == "load":
        unit = unit or settings.units.get("load")
    unit = unit or table.unit(name)
    if not unit and DIMENSION.get(meaning) == "speed":
        unit = settings.units.get("speed", "")
    return "rpm" if meaning == "rotation" and not unit and normalised_header(name) == "rpm" else unit


def numbers(table: TextTable, name: str, meaning: str, settings: FitSettings) -> Array:
    """Return the numbers of a column in SI units as they stand, NaN where a value is missing."""
    dimension = dimension_of(meaning, settings)
    noun = "a slide-to-roll ratio" if meaning == "slide_to_roll" else meaning.replace("_", " ")

    def factor(unit: str, where: str) -> float:
        if meaning == "hersey_number" and has_dimension(unit or "-", "wavenumber"):
            return si_factor(unit, "wavenumber", meaning)
        if dimension == "number":
            if unit not in BARE:
                raise InputError(f"{where} has the unit {show(unit)}; {noun} is a bare number or in %.")
            return BARE[unit]
        if not unit:
            example = UNITS.get(dimension) or DIMENSIONS[dimension].example.partition(" ")[2]
            raise InputError(
                f"{where} has no unit; write it in the header, as in '{name} [{example}]', or {meaning} = {show(example)} in "
                "[fit.units]."
            )
        return si_factor(unit, dimension, f"{where}: unit")

    return table.numbers_of(name, factor, unit=unit_in(table, name, meaning, settings))


def checked(table: TextTable, name: str, meaning: str, settings: FitSettings) -> Array:
    """Return the numbers of a column in SI units; refuse one that is impossible."""
    values, cells = numbers(table, name, meaning, settings), table.column(name)
    if settings.magnitudes and meaning in (*ABSCISSAS, "friction"):
        values = np.abs(values)
    for i in np.flatnonzero(~np.isnan(values)).tolist():
        value, where = float(values[i]), f"{table.path}: row {table.numbers[i]}, column {show(name)}"
        if meaning == "friction" and value > LARGEST_FRICTION:
            raise InputError(f"{where}: a friction coefficient of {value:g} is not plausible; {what_may_be_wrong(name)}.")
        if meaning == "error" and value <= 0:
            raise InputError(f"{where}: {show(cells[i])} must be positive; a standard error of zero would outweigh all rows.")
        if meaning in settings.inputs.quantities and meaning != "speed":
            try:
                settings.inputs.quantities[meaning].checked(value)
            except InputError as problem:
                raise InputError(f"{where}: {problem}") from None
    return values
