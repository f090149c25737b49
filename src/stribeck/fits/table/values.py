"""Cells of a laboratory's table in SI units, each checked and named by row and column where it cannot be used."""

from __future__ import annotations

import numpy as np

from stribeck._types import Array
from stribeck.cases.fit_settings import FitSettings
from stribeck.files.columns import BARE, has_dimension, si_factor
from stribeck.files.text_table import TextTable
from stribeck.fits.table.columns import ABSCISSAS, DIMENSION
from stribeck.quantities.units import InputError, show

__all__ = ["Values"]

LARGEST_FRICTION = 10.0  # Friction coefficient from which percent are suspected


class Values:
    """Columns in SI units, NaN where a value is missing; a cell with a unit of its own is read with that."""

    def __init__(self, table: TextTable, settings: FitSettings) -> None:
        self.table, self.settings = table, settings

    def checked(self, column: str, meaning: str) -> Array:
        """Return the values of a column; refuse one that is impossible."""
        values = self.numbers(column, meaning)
        cells = self.table.column(column)
        for i in np.flatnonzero(~np.isnan(values)).tolist():
            values[i] = self._checked(float(values[i]), cells[i], meaning, self._where(i, column))
        return values

    def numbers(self, column: str, meaning: str) -> Array:
        """Return the numbers of a column as they stand."""
        unit = self.settings.units.get(meaning, "")
        return self.table.numbers_of(column, lambda unit, where: self._factor(unit, meaning, where), unit=unit)

    def _where(self, i: int, column: str) -> str:
        return f"{self.table.path}: row {self.table.numbers[i]}, column {show(column)}"

    def _factor(self, unit: str, meaning: str, where: str) -> float:
        if meaning == "hersey_number" and has_dimension(unit or "-", "wavenumber"):
            return si_factor(unit, "wavenumber", meaning)
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
            return si_factor(unit, dimension, meaning)
        except InputError as problem:
            raise InputError(f"{where}: {str(problem).replace(f'{meaning} = ', 'unit ', 1)}") from None

    def _checked(self, value: float, cell: str, meaning: str, where: str) -> float:
        if self.settings.magnitudes and meaning in (*ABSCISSAS, "friction"):
            value = abs(value)
        if meaning == "friction" and value > LARGEST_FRICTION:
            raise InputError(
                f"{where}: a friction coefficient of {value:g} is not plausible; if it is in percent, write [%] in the "
                'header or friction = "%" in [fit.units].'
            )
        if meaning == "error" and value <= 0:
            raise InputError(f"{where}: {show(cell)} must be positive; a standard error of zero would outweigh all rows.")
        if meaning in self.settings.inputs.quantities and meaning != "speed":
            try:
                self.settings.inputs.quantities[meaning].checked(value)
            except InputError as problem:
                raise InputError(f"{where}: {problem}") from None
        return value
