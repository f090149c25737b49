"""Cells of a laboratory's table in SI units, each checked and named by row and column where it cannot be used."""

from __future__ import annotations

import re

from stribeck.cases.fit_settings import FitSettings
from stribeck.files.cells import MISSING_CELLS, number_of, split_header
from stribeck.files.text_table import TextTable
from stribeck.fits.table.columns import ABSCISSAS
from stribeck.fits.table.units import BARE, DIMENSION, has_dimension, si_factor
from stribeck.quantities.units import InputError, show, to_si

__all__ = ["Values"]

THOUSANDS = re.compile(r"[+-]?[0-9]{1,3}(?:[,.' ][0-9]{3})+(?:[.,][0-9]+)?$")

LARGEST_FRICTION = 10.0  # Friction coefficient from which percent are suspected


class Values:
    """Cells in SI units; a cell with a unit of its own is read with that."""

    def __init__(self, table: TextTable, settings: FitSettings) -> None:
        self.table, self.settings = table, settings
        self.decimals: dict[str, str] = {}
        self.factors: dict[tuple[str, str], float] = {}

    def value(self, i: int, column: str, meaning: str) -> float | None:
        """Return a value in SI units, None where it is missing; refuse one that is impossible."""
        value = self.number(i, column, meaning)
        if value is None:
            return None
        return self._checked(value, self.table.rows[i][self.table.header.index(column)], meaning, self._where(i, column))

    def number(self, i: int, column: str, meaning: str) -> float | None:
        """Return a number in SI units as it stands, None where it is missing."""
        at = self.table.header.index(column)
        cell = self.table.rows[i][at]
        if cell.lower() in MISSING_CELLS:
            return None
        if column not in self.decimals:
            self.decimals[column] = "," if self.table.decimal_comma([column]) else "."
        found = number_of(cell, self.decimals[column])
        if found is None:
            thousands = "write it without marks between thousands"
            advice = thousands if THOUSANDS.match(cell) else "leave the cell empty where a value is missing"
            raise InputError(f"{self._where(i, column)}: {show(cell)} is not a number; {advice}.")
        number, unit = found
        return number * (self._factor(unit, meaning, self._where(i, column)) if unit else self._unit(column, at, meaning))

    def _where(self, i: int, column: str) -> str:
        return f"{self.table.path}: row {self.table.numbers[i]}, column {show(column)}"

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
            return to_si(f"1 {unit}", dimension, meaning)
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
