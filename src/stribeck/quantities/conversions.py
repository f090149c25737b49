"""The table of conversions: inputs as data sheets have them, and the inputs of a contact that follow from them.

Contacts and case files take them; each is applied first, and reported: what follows from what, by which formula.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from stribeck.quantities.formats import format_si
from stribeck.quantities.inputs import LINE, InputTable
from stribeck.quantities.schema import Input
from stribeck.quantities.uncertain import has_error, split_error
from stribeck.quantities.units import InputError, show, to_si

__all__ = ["CONVERSIONS", "GIVEN", "Conversion", "Given", "GivenInput", "convert_inputs", "read_given"]


@dataclass(frozen=True)
class GivenInput:
    """One input as a data sheet has it."""

    name: str  # Name in Python and files
    dimension: str  # Kind of quantity
    typical: str  # Example with a unit
    usual: tuple[float, float] = (0.0, math.inf)  # Range in which the conversion holds, in SI units


@dataclass(frozen=True)
class Conversion:
    """How an input of a contact follows from others."""

    of: str  # The input that follows
    inputs: tuple[GivenInput, ...]  # Inputs that are converted, all together
    value: Callable[..., float]  # Value of the result from the inputs, in SI units
    formula: str  # For people
    source: str  # For people
    error: float = 0.0  # Standard error of the formula itself over the value
    besides: dict[str, float] = field(default_factory=dict)  # Other inputs that it takes for granted where they are not given
    geometry: str = ""  # The geometry that it is for; empty for all


def modulus_of_shore_a(hardness: float) -> float:
    """Return Young's modulus [Pa] of rubber of a Shore A hardness."""
    return 0.0981e6 * (56 + 7.62336 * hardness) / (0.137505 * (254 - 2.54 * hardness))


def modulus_of_shore_d(hardness: float) -> float:
    """Return Young's modulus [Pa] of an elastomer of a Shore D hardness."""
    return float(1e6 * 10 ** (0.0235 * (hardness + 50) - 0.6403))


# The conversions. A new one is a row here.
CONVERSIONS = (
    Conversion(
        "youngs_modulus",
        (GivenInput("shore_a", "number", "70", (20, 90)),),
        modulus_of_shore_a,
        "E = 0.0981 (56 + 7.62336 S)/(0.137505 (254 - 2.54 S)) MPa",
        "Gent 1958; other relations differ by a factor of up to 2",
        0.3,
        {"poisson_ratio": 0.5},
    ),
    Conversion(
        "youngs_modulus",
        (GivenInput("shore_d", "number", "50", (30, 85)),),
        modulus_of_shore_d,
        "lg(E/MPa) = 0.0235 (S + 50) - 0.6403",
        "Qi, Joyce and Boyce 2003",
        0.4,
        {"poisson_ratio": 0.5},
    ),
    Conversion(
        "roughness",
        (GivenInput("ra", "length", "0.4 um"),),
        lambda ra: math.sqrt(math.pi / 2) * ra,
        "Rq = (pi/2)^(1/2) Ra",
        "Gaussian heights; 1.1 to 1.4 on machined surfaces",
        0.1,
    ),
    Conversion("roughness", (GivenInput("rq", "length", "0.5 um"),), lambda rq: rq, "h_rms = Rq", "ISO 21920"),
    Conversion(
        "viscosity",
        (GivenInput("kinematic_viscosity", "kinematic", "46 cSt"), GivenInput("density", "density", "870 kg/m^3")),
        lambda nu, rho: nu * rho,
        "eta = nu rho",
        "definition",
    ),
    Conversion(
        "speed",
        (GivenInput("rotational_speed", "rotation", "1500 rpm"), GivenInput("shaft_diameter", "length", "30 mm")),
        lambda omega, diameter: omega * diameter / 2,
        "U = omega d/2, the counterface at rest",
        "definition",
    ),
    Conversion(
        "load",
        (GivenInput("force", "force", "50 N"), GivenInput("width", "length", "20 mm")),
        lambda force, width: force / width,
        "load = force/width",
        "definition",
        geometry="line",
    ),
    Conversion(
        "load", (GivenInput("force", "force", "1.3 N"),), lambda force: force, "load = force", "definition", geometry="point"
    ),
)

GIVEN = {each.name: each for row in CONVERSIONS for each in row.inputs}  # Inputs of data sheets by name

_TURNS = re.compile(r"hz|1\s*/\s*s\b|s\s*\^?\s*-1|s⁻¹", re.IGNORECASE)


@dataclass(frozen=True)
class Given:
    """Inputs of a contact, as conversions leave them."""

    values: dict[str, Any]  # By name: what was made of others in SI units, the rest as it was given
    errors: dict[str, float]  # Standard errors over the values, where known
    sentences: tuple[str, ...]  # One sentence for each conversion
    problems: tuple[str, ...] = ()


def read_given(given: Mapping[str, Any], table: InputTable = LINE) -> Given:
    """Return inputs of a contact from inputs as data sheets have them."""
    values: dict[str, Any] = {}
    errors: dict[str, float] = {}
    problems = []
    for name, value in given.items():
        kind = _row(name, table) if name in GIVEN or name in table.quantities else None
        values[name] = value
        if kind is not None and has_error(value):
            try:
                values[name], error = split_error(name, value, kind.dimension, kind.typical)
                errors[name] = error or 0.0
            except InputError as problem:
                problems.append(str(problem))
                values[name] = _typical(name, table)
    sentences = []
    for row in CONVERSIONS:
        wrong = row.geometry not in ("", table.geometry)
        if wrong or not any(values.get(each.name) is not None for each in row.inputs):
            continue
        try:
            sentences.append(_convert(row, values, errors, given, table))
        except InputError as problem:
            problems.append(str(problem))
            if values.get(row.of) is None:
                values[row.of] = _typical(row.of, table)
                values |= {name: each for name, each in row.besides.items() if values.get(name) is None}
    for name in [name for name in values if name in GIVEN and values[name] is not None and not problems]:
        problems.append(f"{name} = {show(given[name])} is not an input of a {table.contact}; remove it.")
    values = {name: value for name, value in values.items() if name not in GIVEN}
    return Given(values, errors, tuple(sentences), tuple(problems))


def convert_inputs(given: Mapping[str, Any], table: InputTable = LINE) -> dict[str, Any]:
    """Return inputs of a contact with those of data sheets converted, values with errors left to be refused."""
    if not any(given.get(name) is not None for name in GIVEN):
        return {name: value for name, value in given.items() if name not in GIVEN}
    found = read_given({name: value for name, value in given.items() if name in GIVEN or not has_error(value)}, table)
    if found.problems:
        raise InputError("\n".join(found.problems))
    return {name: value for name, value in given.items() if name not in GIVEN} | found.values


def _typical(name: str, table: InputTable) -> float:
    """Return a typical value of an input in SI units."""
    row = _row(name, table)
    return float(row.typical) if row.dimension == "number" else to_si(row.typical, row.dimension, name)


def _row(name: str, table: InputTable) -> Input | GivenInput:
    """Return the row of an input of data sheets or contacts."""
    return GIVEN[name] if name in GIVEN else table.quantities[name]


def _convert(
    row: Conversion, values: dict[str, Any], errors: dict[str, float], given: Mapping[str, Any], table: InputTable
) -> str:
    """Replace the inputs of a conversion by its result, and return a sentence on that."""
    names = [each.name for each in row.inputs]
    there = [name for name in names if values.get(name) is not None]
    shown = " and ".join(f"{name} = {_given_text(given[name])}" for name in there)
    missing = [each for each in row.inputs if each.name not in there]
    if missing:
        raise InputError(f"{shown} needs {missing[0].name} too, as in {missing[0].name} = {show(missing[0].typical)}.")
    if values.get(row.of) is not None:
        raise InputError(
            f"{row.of} = {_given_text(given.get(row.of, values[row.of]))} and {shown} are both given; remove one of them."
        )
    numbers = [_si(each, values.pop(each.name)) for each in row.inputs]
    result = row.value(*numbers)
    own = [errors.pop(name, 0.0) for name in names]
    slopes = [_slope(row, numbers, i) for i in range(len(numbers))]
    error = math.sqrt(row.error**2 + sum((slope * each) ** 2 for slope, each in zip(slopes, own, strict=True)))
    if error:
        errors[row.of] = error
    values[row.of] = result
    assumed = {name: value for name, value in row.besides.items() if values.get(name) is None}
    values |= assumed
    about = f", known to about {100 * row.error:.0f} %" if row.error else ""
    besides = "".join(f", {name} = {value:g} assumed" for name, value in assumed.items())
    made = f"{row.of} = {format_si(result, table.quantities[row.of].dimension, 4)} from {shown}"
    return f"{made}: {row.formula} ({row.source}{about}){besides}."


def _given_text(value: Any) -> str:
    """Return a value as it was given, ``{ value, error }`` as people write it."""
    if isinstance(value, Mapping) and value.keys() == {"value", "error"}:
        return show(f"{value['value']} +- {value['error']}")
    return show(value)


def _slope(row: Conversion, numbers: list[float], i: int) -> float:
    """Return d ln(result)/d ln(input)."""
    step = 1e-4
    ahead, behind = ([each * math.exp(sign * step * (k == i)) for k, each in enumerate(numbers)] for sign in (1, -1))
    return (math.log(row.value(*ahead)) - math.log(row.value(*behind))) / (2 * step)


def _si(each: GivenInput, value: Any) -> float:
    if each.dimension == "rotation" and isinstance(value, str) and _TURNS.search(value):
        raise InputError(f"{each.name} = {show(value)} may mean turns or radians per second; write it in rpm or rad/s.")
    number = to_si(value, each.dimension, each.name, each.typical)
    low, high = each.usual
    if number <= 0 or not low <= number <= high:
        allowed = f"between {low:g} and {high:g}, where the relation holds" if high < math.inf else "positive"
        raise InputError(f"{each.name} = {show(value)} must be {allowed}.")
    return number
