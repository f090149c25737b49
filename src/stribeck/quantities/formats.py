"""Numbers as short text for people: with a fitting prefix, the digits that an error allows, in per cent, as a bound."""

from __future__ import annotations

import math
import re

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
