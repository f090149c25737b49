"""Values with an uncertainty: ``"1.0 +- 0.2 um"``, ``"46 cSt +- 5 %"`` or a table of value and error."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

from stribeck.quantities.formats import format_percent
from stribeck.quantities.units import DIMENSIONS, InputError, show, to_si

MAX_RELATIVE_ERROR = 3.0  # Relative error beyond which a value has no information

_PLUS_MINUS = r"(?:\+\s*/?\s*-|±)"
_VALUE_WITH_ERROR = re.compile(rf"\s*(\S+)\s*(.*?)\s*{_PLUS_MINUS}\s*([0-9.eE+-]+)\s*(.*?)\s*", re.DOTALL)


def has_error(value: Any) -> bool:
    """Return whether a value is written with its error."""
    return isinstance(value, Mapping) or (isinstance(value, str) and re.search(_PLUS_MINUS, value) is not None)


def split_error(name: str, value: Any, dimension: str, example: str = "") -> tuple[Any, float | None]:
    """Return a value without its error, and that error relative to it."""
    if not has_error(value):
        return value, None
    if isinstance(value, Mapping):
        if set(value) != {"value", "error"}:
            raise InputError(f"{name} = {show(dict(value))} must be a table of value and error, such as "
                             f"{{ value = {show(example or DIMENSIONS[dimension].example)}, error = '20 %' }}.")  # fmt: skip
        center, error = value["value"], value["error"]
        if not (isinstance(error, str) and error.strip().endswith("%")):
            error = _number(f"the error of {name}", error, dimension)
    else:
        parts = _VALUE_WITH_ERROR.fullmatch(value)
        if parts is None:
            raise InputError(f"{name} = {show(value)} cannot be read; write it as '1.0 +- 0.2 um' or '1.0 um +- 20 %'.")
        number, unit, size, last = parts.groups()
        if last == "%":
            center, error = f"{number} {unit}", f"{size} %"
        else:
            center = f"{number} {unit or last}"
            error = _number(f"the error of {name}", f"{size} {last or unit}", dimension)
    known = _number(name, center, dimension, example)
    relative = _percent(name, error) if isinstance(error, str) else float(error) / known if known else math.inf
    if not 0 < relative <= MAX_RELATIVE_ERROR:
        raise InputError(
            f"{name} = {show(value)} has an error of {format_percent(relative, 3)}; it must be positive and below "
            f"{100 * MAX_RELATIVE_ERROR:.0f} % of a positive value."
        )
    return known, relative


def relative_error(name: str, value: float, error: Any, dimension: str) -> float:
    """Return the error of a value over it, given as text (``"20 %"``, ``"0.2 um"``) or as a number in SI units."""
    return float(split_error(name, {"value": value, "error": error}, dimension)[1] or 0.0)


def _number(name: str, value: Any, dimension: str, example: str = "") -> float:
    """Return a value in SI units; a bare number as text counts where there is no unit."""
    if isinstance(value, str) and not DIMENSIONS[dimension].unit:
        try:
            return float(value)
        except ValueError:
            raise InputError(f"{name} = {show(value)} must be a bare number.") from None
    return to_si(value, dimension, name, example)


def _percent(name: str, text: str) -> float:
    try:
        return float(text.strip().removesuffix("%")) / 100
    except ValueError:
        raise InputError(f"the error of {name} = {show(text)} is not a number of per cent.") from None
