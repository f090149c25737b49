"""A number of a result with its name, unit, meaning and error: what files, JSON, reports and cards say of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from stribeck.quantities.formats import figures, format_bound, format_error, format_number, format_si


@dataclass(frozen=True)
class Number:
    """One number of a result."""

    name: str  # In files and JSON
    label: str  # In reports; empty for what they leave out
    meaning: str  # Long name in files
    value: float
    error: float = math.nan  # Estimated absolute error in the unit of the value; 0 for what is exact, nan where none is known
    unit: str = "1"  # In files
    dimension: str = "number"
    sign: str = ""  # Behind the number in reports, where it has no dimension
    factor: float = 1.0  # To the unit of that sign
    crosses_zero: bool = False  # Whether reports print zero where the number is smaller than its error
    interval: tuple[float, float] | None = None  # With 95 % probability
    is_bounded: bool = False  # Whether reports print the error as a bound where the number is positive and smaller

    @property
    def texts(self) -> tuple[str, str]:
        """Value and error as reports print them."""
        value, error = self.value * self.factor, self.error * self.factor
        if not math.isfinite(value):
            return "none" if math.isnan(value) else "infinite", ""
        known = "" if not 0 < error < math.inf else f"± {format_error(error, self.dimension)}{self.sign}"
        if self.interval is not None:
            low, high = (
                format_si(end, self.dimension) if self.dimension != "number" else f"{end:.3g}" for end in self.interval
            )
            known = f"{f'{low} to' if self.interval[0] else 'at most'} {high} (95 %)"
        if self.crosses_zero and abs(value) <= error:
            value = 0.0
        if self.dimension != "number":
            digits = 3 if math.isnan(error) else figures(error / abs(value) if value else error)
            return format_si(value, self.dimension, digits), known
        if self.is_bounded and 0 < value <= error:
            return f"{format_bound(error)}{self.sign}", ""
        if math.isnan(error):
            return f"{value:.4g}{self.sign}", known
        return f"{format_number(value, abs(error / value) if value else error)}{self.sign}", known

    @property
    def stated(self) -> dict[str, tuple[float, str, str]]:
        """Value, unit and meaning of the number and of its error or interval, under the names that files have."""
        found = {self.name: (self.value, self.unit, self.meaning)}
        if self.error != 0 and not math.isnan(self.error):
            found[f"{self.name}_error"] = (self.error, self.unit, f"estimated absolute error of {self.name}")
        for end, value in zip(("low", "high"), self.interval or (), strict=False):
            found[f"{self.name}_{end}_95"] = (value, self.unit, f"{end} end of the 95 % interval of {self.name}")
        return found


def plain_numbers(numbers: Sequence[Number]) -> dict[str, float]:
    """Return numbers and their errors under the names that files have."""
    return {name: value for each in numbers for name, (value, _, _) in each.stated.items()}
