"""Numbers as short text for people, and a number of a result with all that files, JSON, reports and cards say of it."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from stribeck.quantities.units import DIMENSIONS


def format_si(value: float, dimension: str, digits: int = 3) -> str:
    """Return an SI number as short text with a fitting prefix, such as ``310 µm/s``, that :func:`to_si` reads back."""
    value = float(value)
    steps = DIMENSIONS[dimension].steps
    power = 0
    if value != 0 and math.isfinite(value):
        # Rounding first: 999.9e-6 with three digits is 1 mm, not 1000 µm.
        exponent = int(f"{value:.{digits - 1}e}".partition("e")[2])
        power = max((step for step in steps if step <= exponent), default=min(steps))
    number = f"{value / 10.0**power:.{digits}g}"
    if re.fullmatch(r"-?\d(\.\d+)?e\+0[345]", number):  # 1000 GPa, where there is no larger unit, not 1e+03 GPa
        number = f"{float(number):.0f}"
    return f"{number} {steps[power]}".rstrip()


def format_bound(error: float) -> str:
    """Return a bound by a positive error with one digit, rounded up, such as ``< 4e-08``."""
    digits = f"{error:.0e}"
    if float(digits) < error * (1 - 1e-9):  # rounding of the error itself is no reason
        step = 10.0 ** int(digits.partition("e")[2])
        digits = f"{float(digits) + step:.0e}"
    return f"< {digits if error < 1e-4 else format(float(digits), 'g')}"


def format_error(error: float, dimension: str = "number") -> str:
    """Return an absolute error in SI units with two digits and no power of ten where a prefix can stand for it."""
    number, space, unit = format_si(error, dimension, 2).partition(" ")
    return f"{float(number):g}{space}{unit}"


def figures(error: float) -> int:
    """Return how many digits a relative error allows, 3 to 4: files and JSON have all of them."""
    return 4 if error <= 0 else min(4, max(3, math.ceil(-math.log10(error))))


def format_number(value: float, error: float) -> str:
    """Return a number with the digits that its relative error allows."""
    if not math.isfinite(value):
        return "none" if math.isnan(value) else "infinite"
    return f"{value:.{figures(error)}g}"


def format_factor(factor: float) -> str:
    """Return a factor with three digits, written out up to a million."""
    return f"{float(f'{factor:.3g}'):.0f}" if 999.5 <= factor < 999_500 else f"{factor:.3g}"


def format_percent(part: float, digits: int = 2) -> str:
    """Return a part of a whole (1) in per cent, with ``digits`` significant digits."""
    return f"{float(f'{100 * part:.{digits}g}'):g} %"


MIN_STATED_SHARE = 1e-4  # Smallest share that is worth a number in text; files hold all of them


def format_share(part: float, error: float) -> str:
    """Return a share, 0 to 1, in per cent, or a bound where it is below its absolute error or a ten-thousandth."""
    if 0 < part <= max(error, MIN_STATED_SHARE):
        return f"{format_bound(100 * max(error, MIN_STATED_SHARE))} %"
    return f"{100 * part:.3g} %"


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
        if (self.error != 0 or self.is_bounded) and not math.isnan(self.error):  # shares are exact in some states alone
            found[f"{self.name}_error"] = (self.error, self.unit, f"estimated absolute error of {self.name}")
        for end, value in zip(("low", "high"), self.interval or (), strict=False):
            found[f"{self.name}_{end}_95"] = (value, self.unit, f"{end} end of the 95 % interval of {self.name}")
        return found


def plain_numbers(numbers: Sequence[Number]) -> dict[str, float]:
    """Return numbers and their errors under the names that files have."""
    return {name: value for each in numbers for name, (value, _, _) in each.stated.items()}
