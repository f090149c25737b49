"""Text with units to SI numbers, at the border of the package: no other module knows what a unit is.

Only the unit is handed to pint, which reads "1,5 MPa" as 15 MPa and "10 mPas" as ten millipascals.
"""

from __future__ import annotations

import functools
import math
import numbers
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stribeck._types import Array


class InputError(ValueError):
    """A value given by the user cannot be used; the message says why and what to try."""


class RowError(InputError):
    """One of many values cannot be used; in the text of the message ``{row}`` stands for its place."""

    def __init__(self, text: str, index: int, place: str) -> None:
        super().__init__(text, index, place)  # all of them, as a process hands an error over by its arguments
        self.index, self.place = index, place

    def __str__(self) -> str:
        """Return the message."""
        return self.placed(self.place)

    def placed(self, place: str) -> str:
        """Return the message with the place that a reader of files knows."""
        return str(self.args[0]).replace("{row}", place)


@dataclass(frozen=True)
class Dimension:
    """A kind of quantity: what it is called, its SI unit, an example, and the units that display it."""

    noun: str  # The kind of quantity with its article, for sentences
    unit: str  # SI unit, empty for a bare number
    example: str  # Text that :func:`to_si` accepts
    steps: dict[int, str]  # Power of ten -> unit, for :func:`format_si`


def _prefixed(unit: str, powers: tuple[int, ...]) -> dict[int, str]:
    prefix = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
    return {power: prefix[power] + unit for power in powers}


DIMENSIONS = {
    "length": Dimension("a length", "m", "10 mm", _prefixed("m", (-12, -9, -6, -3, 0, 3))),
    "wavenumber": Dimension("a wave number", "1/m", "1e5 1/m", {0: "1/m", 3: "1/mm", 6: "1/µm", 9: "1/nm"}),
    "speed": Dimension("a speed", "m/s", "0.1 m/s", _prefixed("m/s", (-12, -9, -6, -3, 0, 3))),
    "pressure": Dimension("a pressure", "Pa", "2.1 MPa", _prefixed("Pa", (-3, 0, 3, 6, 9))),
    "viscosity": Dimension("a viscosity", "Pa*s", "10 mPa*s", _prefixed("Pa*s", (-6, -3, 0, 3, 6))),
    "load": Dimension("a load per unit length", "N/m", "50 N/m", _prefixed("N/m", (-6, -3, 0, 3, 6))),
    "force": Dimension("a force", "N", "1.3 N", _prefixed("N", (-9, -6, -3, 0, 3))),
    "drag": Dimension("a viscosity times a speed", "Pa*m", "2 mPa*m", _prefixed("Pa*m", (-9, -6, -3, 0, 3))),
    "spectral density": Dimension("a spectral density of heights", "m^4", "1e-20 m^4", {0: "m^4"}),
    "rate": Dimension("a rate", "1/s", "1e6 1/s", {0: "1/s"}),
    "density": Dimension("a density", "kg/m^3", "870 kg/m^3", {0: "kg/m^3"}),
    "conductivity": Dimension("a thermal conductivity", "W/m/K", "0.15 W/m/K", {0: "W/m/K"}),
    "kinematic": Dimension("a kinematic viscosity", "m^2/s", "46 cSt", {-6: "mm^2/s", 0: "m^2/s"}),
    "angle": Dimension("an angle", "rad", "45 deg", {0: "rad"}),
    "rotation": Dimension("an angular velocity", "rad/s", "1500 rpm", {0: "rad/s"}),
    "torque": Dimension("a torque", "N*m", "2 mN*m", _prefixed("N*m", (-9, -6, -3, 0, 3))),
    "per kelvin": Dimension("a relative change per kelvin", "1/K", "0.04 1/K", {0: "1/K"}),
    "per area": Dimension("a number per area", "1/m^2", "1e10 1/m^2", {0: "1/m^2"}),
    "surface energy": Dimension("a surface energy", "J/m^2", "50 mJ/m^2", _prefixed("J/m^2", (-6, -3, 0))),
    "diffusivity": Dimension("a diffusivity", "m^2/s", "1e-9 m^2/s", {0: "m^2/s"}),
    "permeability": Dimension("a permeability", "m^2", "1e-18 m^2", {0: "m^2"}),
    "time": Dimension("a time", "s", "1 ms", _prefixed("s", (-9, -6, -3, 0))),
    "pressure coefficient": Dimension(
        "an inverse pressure", "1/Pa", "15 1/GPa", {-9: "1/GPa", -6: "1/MPa", -3: "1/kPa", 0: "1/Pa"}
    ),
    "number": Dimension("a bare number", "", "0.5", {0: ""}),
}

MAX_NUMBER = 1e30  # Size of a number that is no measured value in any unit: 1e37, or the largest number of a float

# What pint may find in the text, so that a sentence can name it; wider than what the package accepts.
_NOUNS = {kind.unit: kind.noun for kind in DIMENSIONS.values() if kind.unit not in ("", "rad")} | {
    "m^2": "an area",
    "Pa*s": "a dynamic viscosity",
    "m^2/s": "a kinematic viscosity",
    "kg": "a mass",
    "K": "a temperature",
    "dimensionless": "a bare number",
}

# What to do about a unit of another kind: what was found, and the SI unit of what is expected.
_HINTS = {
    ("N", "N/m"): "a force is the load of a ball, PointContact or geometry = 'point'; that of a cylinder, LineContact or "
    "geometry = 'line', is the force divided by its length",
    ("N/m", "N"): "a load per unit length is that of a cylinder, LineContact or geometry = 'line'; that of a ball, "
    "PointContact or geometry = 'point', is the whole force",
    ("kg", "N"): "a mass presses with 9.81 N/kg",
    ("kg", "N/m"): "a mass presses with 9.81 N/kg; divide the force on a cylinder by its length",
    ("m^2/s", "Pa*s"): "give it as kinematic_viscosity, with the density; or multiply it by the density",
    ("1/s", "m/s"): "give it as rotational_speed, with the shaft_diameter; or multiply the angular velocity in rad/s by "
    "the radius of the shaft or track",
}

# Bounded, because the number becomes an exact fraction and 1e999999999 would fill the memory.
_NUMBER = re.compile(r"\s*([+-]?(?:[0-9]{1,40}\.?[0-9]{0,40}|\.[0-9]{1,40})(?:[eE][+-]?[0-9]{1,3})?)\s*(.*?)\s*", re.DOTALL)
_PERCENT = re.compile(r"\s*([0-9]{1,9}(?:\.[0-9]{0,9})?)\s*%\s*")
_ROUGHNESS = re.compile(r"R[aq](?![A-Za-z])", re.IGNORECASE)
_HARDNESS = re.compile(r"shore|irhd", re.IGNORECASE)
FROM_HARDNESS = "write shore_a = 70 or shore_d = 50, a bare number, in place of the modulus"
# Turns per minute
_TURNS = re.compile(r"(?:r\.?p\.?m\.?|(?:[rU]|tr)/min|1? ?/ ?min|min\^?[-−]1|min⁻¹)", re.IGNORECASE)
_EXPONENT = re.compile(r"(?:\^|\*\*)\s*(?:[+-]?[0-9]|\(\s*[+-]?[0-9]\s*\))")
_UNIT = re.compile(r"(?:1 ?/)?[A-Za-zµμÅ_#()*/ ]*", re.ASCII)
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_MAX_UNIT_LETTERS = 40  # A longer text is no unit, and slow to parse


def to_si(value: Any, dimension: str, name: str, example: str = "") -> float:
    """Return text with a unit, a quantity of pint or a number in SI units as a float in SI units, or refuse it by its name."""
    if type(value) is float and math.isfinite(value):
        return value
    kind = replace(DIMENSIONS[dimension], example=example) if example else DIMENSIONS[dimension]
    value = _text_of_quantity(value, kind)
    exact = _from_text(value, kind, name) if isinstance(value, str) else value
    if isinstance(exact, bool) or not isinstance(exact, numbers.Real):
        raise InputError(f"{name} = {show(value)} is not a single real number; {_advice(kind)}.")
    try:
        result = float(exact)
    except OverflowError:
        result = math.inf
    if not math.isfinite(result):
        raise InputError(f"{name} = {show(value)} is not a finite number in double precision; {_advice(kind)}.")
    return result


def checked_kind(name: str, value: Any, kinds: type | tuple[type, ...], allowed: str) -> Any:
    """Return an argument if it is an instance of what may be given, or refuse it in a sentence that says what that is."""
    if not isinstance(value, kinds):
        raise InputError(f"{name} = {show(value)}; it must be {allowed}.")
    return value


def checked_word(name: str, value: Any, words: Iterable[str], about: str = "") -> str:
    """Return one of several words, or refuse anything else in a sentence that names them, and what they are about."""
    known = tuple(words)
    if isinstance(value, str) and value in known:
        return value
    shown = [repr(str(each)) for each in known]
    allowed = f"one of {', '.join(shown)}" if len(shown) > 3 else listed(shown, "or")
    raise InputError(f"{name} = {show(value)} must be {allowed}{about}.")


def checked_count(name: str, value: Any, low: int, high: int | None = None) -> int:
    """Return a whole number in a range, or refuse anything else."""
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= (value if high is None else high):
        end = "on" if high is None else f"to {high}"
        raise InputError(f"{name} = {show(value)}; it must be a whole number from {low} {end}.")
    return value


def checked_callback(name: str, value: Any) -> Any:
    """Return a function to be called during the work, or None; refuse anything else before the work begins."""
    if value is not None and not callable(value):
        raise InputError(f"{name} = {show(value)}; it must be a function, or None.")
    return value


def read_number(name: str, text: str) -> float:
    """Return a bare number that was typed; what it may be is for its user to say."""
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{name} = {show(text)} is not a number; write it as 0.001 or 1e-3.") from None


def number_or_text(text: str) -> float | str:
    """Return text without a unit as the number that it is."""
    try:
        return float(text)
    except ValueError:
        return text


def listed(words: Iterable[str], last: str = "and") -> str:
    """Return words as a sentence lists them: one, two and three."""
    *most, end = words
    return f"{', '.join(most)} {last} {end}" if most else end


def show(value: Any) -> str:
    """Return ``repr(value)`` on one line and short enough for a sentence."""
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # Python writes no whole number of more than 4300 digits
        text = f"a {type(value).__name__} that is too long to be written"
    return text if len(text) <= 60 else text[:57] + "..."


def _text_of_quantity(value: Any, kind: Dimension) -> Any:
    """Return a quantity of pint as text, which has its own sentences for what is wrong; another value as it is."""
    if not (hasattr(value, "magnitude") and hasattr(value, "units")):
        return value
    number = value.magnitude
    if not isinstance(number, numbers.Real) or not math.isfinite(number):
        return number
    units = "" if not str(value.units) or str(value.units) == "dimensionless" else str(value.units)
    if not units and not kind.unit:
        return float(number)
    return f"{float(number)!r} {units}".rstrip()


def _advice(kind: Dimension) -> str:
    if not kind.unit:
        return f"write a bare number without quotes, such as {kind.example}"
    return f"write {kind.noun} with its unit, such as '{kind.example}', or a bare number in {kind.unit}"


def _from_text(text: str, kind: Dimension, name: str) -> Fraction:
    received = f"{name} = {show(text)}"
    if not kind.unit:
        percent = _PERCENT.fullmatch(text)
        advice = f"write {float(percent[1]) / 100:.6g}" if percent else _advice(kind)
        raise InputError(f"{received} is text, but a number is expected; {advice}.")
    if kind.unit == "Pa" and _HARDNESS.search(text):
        raise InputError(f"{received} is a hardness, not a modulus; {FROM_HARDNESS}.")
    if "+-" in text or "±" in text:
        raise InputError(
            f"{received} has an error, for which there is no place here; a case file takes it, and "
            "stribeck.propagate(contact, {name: error})."
        )
    if "," in text:
        raise InputError(f"{received} has a comma; write a decimal point and no thousands separator, as in '{kind.example}'.")
    parts = _NUMBER.fullmatch(text.replace("\N{MINUS SIGN}", "-"))
    if parts is None:
        if found := _ROUGHNESS.match(text):
            raise InputError(f"{received} begins with its kind; write {found[0].lower()} = '0.4 um' in place of {name}.")
        raise InputError(f"{received} does not begin with a number; {_advice(kind)}.")
    number, unit = parts.groups()
    if not unit:
        raise InputError(
            f"{received} has no unit; add one, as in '{number} {kind.unit}', "
            f"or drop the quotes: a bare number is in {kind.unit}."
        )
    return Fraction(number) * _factor(unit, kind, received)


def _factor(unit: str, kind: Dimension, received: str) -> Fraction:
    """Return the exact SI value of one ``unit``, or raise the sentence that begins with ``received``."""
    unit = "rpm" if _TURNS.fullmatch(unit) and kind.unit == "rad/s" else re.sub(r"\bRPM\b", "rpm", unit)
    unit = re.sub(r"\brev\b", "revolution", unit, flags=re.IGNORECASE)
    unit = re.sub(r"(⁻?[⁰¹²³⁴⁵⁶⁷⁸⁹]+)", lambda found: "^" + found[1].translate(_SUPERSCRIPTS), unit)
    unit = re.sub(r"(?<=[A-Za-z])([-−]?)(?=[1-4](?![0-9A-Za-z]))", r"^\1", unit).replace("−", "-")  # as in mm2 s-1
    unit = re.sub(r"\b([nuµμmck]?N)-?([cm]?m)\b", r"\1*\2", unit) if kind.unit == "N*m" else unit
    unit = re.sub(r"(?<=[A-Za-z])\s*[.·⋅]\s*(?=[A-Za-z])", "*", unit)
    for power, known in kind.steps.items():
        if unit in (known, known.replace("µ", "u")):  # without pint, which takes longer to import than a solve
            return Fraction(10) ** power
    import pint

    # pint evaluates what it is given and m^9^9^9^9 would never end: units, products, one-digit powers pass.
    shape = _EXPONENT.sub("#", unit)
    if len(unit) > _MAX_UNIT_LETTERS or not _UNIT.fullmatch(shape) or re.search(r"\*\*|#[\s()]*#", shape):
        raise InputError(f"{received} is not a number with a unit; {_advice(kind)}.")

    registry = _registry()
    for symbol in re.findall(r"\w+", shape):
        _refuse_plural_symbol(symbol, registry, received)
    try:
        parsed = registry.parse_units(unit)
        factor, base = registry.get_base_units(parsed)
    except pint.UndefinedUnitError as problem:
        unknown: Any = problem.unit_names  # declared a tuple, at times a str
        unknown = unknown if isinstance(unknown, str) else unknown[0]
        raise InputError(
            f"{received} has the unknown unit '{unknown}' (upper and lower case differ); {_advice(kind)}."
        ) from None
    except Exception:  # pint's parser leaks errors of many kinds, and each means the same to the user
        raise InputError(f"{received} has a unit that cannot be read; {_advice(kind)}.") from None
    if base.dimensionality != registry.parse_units(kind.unit).dimensionality:
        found = next((text for text in _NOUNS if base.dimensionality == registry.parse_units(text).dimensionality), None)
        message = f"{received} is {_noun(found, base)}; expected {kind.noun} such as '{kind.example}'"
        hint = _HINTS.get((found or "", kind.unit))
        raise InputError(f"{message}: {hint}." if hint else f"{message}.")
    if kind.unit == "rad/s" and "radian" not in str(base):
        raise InputError(f"{received} may mean turns or radians; write it in rpm or rad/s.")
    if kind.unit == "1/s" and "radian" in str(base):
        raise InputError(f"{received} is an angular velocity; expected how often in a time, such as '2 Hz' or '120 1/min'.")
    return Fraction(factor)


def _refuse_plural_symbol(symbol: str, registry: Any, received: str) -> None:
    # pint strips a plural s from symbols too, and "mPas" (meant: mPa*s) would silently become a pressure.
    singular = symbol[:-1]
    candidates = registry.parse_unit_name(symbol)
    if not symbol.endswith("s") or not candidates:
        return
    prefix, unit, _ = candidates[0]
    if singular == registry.get_symbol(prefix + unit) and singular != unit:
        raise InputError(
            f"{received} has the ambiguous unit '{symbol}'; write '{singular}*s' for the product with "
            f"seconds, or '{singular}'."
        )


def _noun(found: str | None, unit: Any) -> str:
    if found == "dimensionless" and "radian" in str(unit):
        return "an angle"
    if found is not None:
        return _NOUNS[found]
    powers = (f"{name.strip('[]')}^{float(power):g}" for name, power in unit.dimensionality.items())
    return f"of dimension {' '.join(powers)}"


@functools.cache
def _registry() -> Any:
    import pint

    # Fractions, because with floats "2.5 um" is 2.4999999999999998e-06.
    return pint.UnitRegistry(cache_folder=None, non_int_type=Fraction)


def real_array(name: str, value: Any) -> Array:
    """Return numbers or arrays of numbers as float64; refuse text, truth values, complex numbers and ragged lists."""
    import numpy as np  # not for a command that only shows its help

    try:
        found = np.asarray(value)
    except ValueError:  # ragged lists
        found = np.asarray(None)
    if found.size and found.dtype.kind not in "iuf":
        raise InputError(f"{name} = {show(value)} is not made of real numbers; give a number or an array of them.")
    with np.errstate(over="ignore"):
        return found.astype(np.float64)


def positive_columns(columns: Mapping[str, Any], advice: Mapping[str, str] = MappingProxyType({})) -> list[Array]:
    """Return columns of as many numbers above zero, in the order of the first; a refusal adds the advice on a column."""
    import numpy as np  # not for a command that only shows its help

    found = {name: real_array(name, values) for name, values in columns.items()}
    shapes = [each.shape for each in found.values()]
    if len(shapes[0]) != 1 or len(set(shapes)) > 1:
        said = listed(f"{name} of shape {each.shape}" for name, each in found.items())
        raise InputError(f"{said}; give columns of as many numbers.")
    for name, values in found.items():
        wrong = np.flatnonzero(~((values > 0) & (values < MAX_NUMBER)))
        if wrong.size:
            text = (
                f"{name} holds {values[wrong[0]]:g}, {{row}}; all values must be finite and above zero.{advice.get(name, '')}"
            )
            raise RowError(text, int(wrong[0]), f"value {wrong[0] + 1} of {values.size}")
    order = np.argsort(found[next(iter(found))], kind="stable")
    return [values[order] for values in found.values()]
