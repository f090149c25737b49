"""What outputs say of a result: its numbers, and the contact or groups behind it with their laws, model and inputs.

Each number has its name, unit, meaning and error; files, JSON, reports and cards read them.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import WithArea, law_attributes
from stribeck.contacts.contact import Contact, part_attributes
from stribeck.contacts.friction import DEFINITIONS, Definition, coefficients
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Groups
from stribeck.quantities.formats import Number
from stribeck.quantities.outputs import (
    AREA_ROWS,
    COLUMNS,
    GROUPS,
    HERTZ,
    UNIT_SUFFIXES,
    UNITS,
    Observable,
    friction_rows,
)

UNSTATED = (math.nan, "", "")  # Of a state that has no such number, or knows no error of it

HERTZ_SIGNS = {"gap": " u_Hz", "width": " a", "pressure": " p_Hz"}  # Behind a number in Hertz units

DIMENSIONS_OF_SCALES = {"gap": "length", "width": "length", "pressure": "pressure"}

# What people read first, beside friction and its parts.
MAIN = (
    "friction_hysteresis",
    "contact_load_share",
    *("central_gap", "central_film_thickness", "minimum_gap", "minimum_film_thickness"),
    *("lambda_ratio", "maximum_pressure"),
)


def numbers_of(
    solution: Any, boundary_friction: float | None = None, beta: float | None = None, with_fields: bool = True
) -> list[Number]:
    """Return the numbers of a state in the order of outputs; what has a scale in Hertz units, then in those of the contact."""
    return [
        *_frictions(solution, boundary_friction, beta, with_fields),
        *_observables(solution),
        *_ratios(solution, beta, with_fields),
        *(Number(name, "", meaning, value, unit=unit) for name, (value, unit, meaning) in _scales(solution).items()),
    ]


def columns_of_states(
    solutions: Sequence[Any], boundary_friction: float | None = None, beta: float | None = None
) -> dict[str, tuple[Array, str, str]]:
    """Return the numbers of states along a curve as columns: values, unit and meaning, each with its errors behind it."""
    # What follows from the fields is left out: a curve is read off a few states, and each of its points would be solved.
    stated = [
        {name: found for each in numbers for name, found in each.stated.items()}
        for numbers in (numbers_of(each, boundary_friction, beta, with_fields=False) for each in solutions)
    ]
    about = {name: (unit, meaning) for row in stated for name, (_, unit, meaning) in row.items()}
    return {name: (np.array([row.get(name, UNSTATED)[0] for row in stated]), *words) for name, words in about.items()}


def report_rows(solution: Any, boundary_friction: float | None = None, beta: float | None = None) -> list[Number]:
    """Return the numbers that reports print, a row each: in SI units where the state has a contact."""
    # The number in SI units has the label of that in Hertz units, and takes its place.
    return list({each.label: each for each in numbers_of(solution, boundary_friction, beta) if each.label}.values())


def main_rows(
    solution: Any,
    boundary_friction: float | None = None,
    beta: float | None = None,
    definition: Definition = "balanced",
) -> list[Number]:
    """Return the handful of them that people read first, with friction by one definition."""
    main = (f"friction_{definition}", "friction_asperities", f"friction_{definition}_fluid", *MAIN)
    return [each for each in report_rows(solution, boundary_friction, beta) if each.name in main]


def si_films(solution: Any) -> dict[str, tuple[float, str, str]]:
    """Return films and Hertz scales in SI units: value, unit and meaning of each; empty for groups alone."""
    rows = {row.film: row for row in solution.outputs.rows if row.film}
    factors = _factors(solution)
    films = {name: getattr(solution, row.name) * factors[row.scale] for name, row in rows.items()} if factors else {}
    return {name: (value, UNITS[rows[name].scale], rows[name].meaning) for name, value in films.items()} | _scales(solution)


def _factors(solution: Any) -> dict[str, float]:
    """Return the Hertz scales of a contact by what they are the scale of; empty for groups alone."""
    hertz = None if solution.contact is None else solution.contact.hertz
    return {} if hertz is None else {"gap": hertz.indentation, "width": hertz.half_width, "pressure": hertz.pressure}


def _scales(solution: Any) -> dict[str, tuple[float, str, str]]:
    hertz = None if solution.contact is None else solution.contact.hertz
    return {} if hertz is None else {name: (getattr(hertz, name.removeprefix("hertz_")), *HERTZ[name]) for name in HERTZ}


def _frictions(solution: Any, boundary_friction: float | None, beta: float | None, with_fields: bool) -> Iterator[Number]:
    """Yield friction by both definitions, its parts, and what stands beside it."""
    found = {each: solution.friction(boundary_friction, beta, each) for each in DEFINITIONS}
    about = {name: said for each in DEFINITIONS for name, (_, said) in (COLUMNS | friction_rows(each)).items()}
    for each, friction in found.items():
        name = f"friction_{each}"
        yield Number(name, f"friction coefficient, {each}", about[name], float(friction), friction.error)
    first = found[DEFINITIONS[0]]
    name = "friction_asperities"
    parts = [(name, "friction from asperities", about[name], first.asperities, first.error)]
    for each, friction in found.items():
        name = f"friction_{each}_fluid"
        parts.append((name, f"friction from the fluid, {each}", about[name], friction.fluid, friction.error))
    yield from (Number(*part, is_bounded=True) for part in parts)
    if solution.groups.model.film.slide != 1.0 and math.isfinite(first.upper):
        of = "force on the cylinder over the load, where friction is that on the substrate"
        yield Number("friction_upper", "friction on the cylinder", of, first.upper, first.error)
    if with_fields and getattr(solution.groups.model.solid, "uses_speed", False):
        slope = float(solution.groups.slope(coefficients(solution.contact, None, beta)[1]))
        of = "friction coefficient of the losses in a viscoelastic body, beside the others"
        value, error = solution.hysteresis_friction * slope, solution.hysteresis_error * slope
        yield Number("friction_hysteresis", "hysteresis friction, apart", of, value, error)


def _observables(solution: Any) -> Iterator[Number]:
    """Yield the observables in Hertz units, each followed by itself in SI units where the contact has them."""
    factors, names = _factors(solution), {row.name for row in solution.outputs.rows}
    for row in solution.outputs.rows:
        if not row.listed or row.name.removesuffix("_error") in names - {row.name}:
            continue
        value, error = float(getattr(solution, row.name)), _error(solution, row)
        sign = HERTZ_SIGNS.get(row.scale, "")
        meaning = row.meaning + UNIT_SUFFIXES[row.scale]
        label = "" if row.name.endswith(("_estimate", "_error")) else row.label
        if not factors:  # groups hold no alpha
            label = label.replace("h_rms", "h_rms/alpha")
        is_position = row.scale == "width"
        if row.name == "minimum_angle":
            yield Number(row.name, label, meaning, value, error, sign="°", factor=180 / math.pi)
            continue
        is_share = row.error == "absolute"
        yield Number(row.name, label, meaning, value, error, sign=sign, crosses_zero=is_position, is_bounded=is_share)
        if row.film and factors:
            scale, unit, dimension = factors[row.scale], UNITS[row.scale], DIMENSIONS_OF_SCALES[row.scale]
            in_si = value * scale, error * scale, unit, dimension
            yield Number(row.film, label, row.meaning, *in_si, crosses_zero=is_position)


def _error(solution: Any, row: Observable) -> float:
    """Return the absolute error of an observable."""
    value = abs(float(getattr(solution, row.name)))
    if row.name == "lambda_ratio":
        relative = _relative_error(solution, "minimum_gap")
        return value * relative if math.isfinite(value) else 0.0
    if row.error:
        # The offset crosses zero where films become thick.
        size = max(value, abs(solution.central_gap)) if row.name == "offset" else value
        return float(absolute_error(row, size, _relative_error(solution, row.name)))
    return float(getattr(solution, f"{row.name}_error", math.nan))


def absolute_error(row: Observable, value: Any, stated: Any) -> Any:
    """Return the absolute error of an observable, given the one that a solution states."""
    if row.error == "absolute":
        return stated
    # That of an end of the film is relative to the larger of its distance and the half-width.
    return stated * (np.maximum(1.0, np.abs(value)) if row.scale == "width" else np.abs(value))


def _relative_error(solution: Any, name: str) -> float:
    """Return the relative error of an observable, which a ball states of its minimum film apart."""
    return float(getattr(solution, f"{name}_error", solution.errors.get(name, math.nan)))


def _ratios(solution: Any, beta: float | None, with_fields: bool) -> Iterator[Number]:
    """Yield what follows of the inputs or of the fields."""
    if with_fields and solution.contact is not None:
        pressure = solution.maximum_pressure
        yield Number(
            "maximum_pressure", "largest pressure", "largest total pressure", pressure, unit="Pa", dimension="pressure"
        )
    if isinstance(solution.groups.law, WithArea):
        area, error, of = solution.central_area_fraction, solution.central_area_fraction_error, "central_area_fraction"
        yield Number(of, "real contact area at x = 0", AREA_ROWS[of][1], area, error)
    if with_fields and getattr(solution.contact, "asperity_friction", None) is not None:
        area, error, of = solution.real_contact_area, solution.real_contact_area_error, "real_contact_area"
        yield Number(of, "real area of contact", AREA_ROWS[of][1], area, error)
    rule = RULES[solution.groups.geometry]
    number = solution.hersey_number
    if solution.contact is None and beta is not None:
        number = float(solution.groups.hersey_number(beta))
    yield Number("hersey_number", f"Hersey number {rule.hersey_symbol}", rule.hersey_name, number, 0.0)


def about_problem(groups: Groups, contact: Contact | None) -> dict[str, Any]:
    """Return it for JSON: what belongs together under one key, in SI units where there is a contact."""
    law = groups.law
    return {
        "geometry": groups.geometry,
        "contact_law": "exponential" if law is None else law.name,
        "contact_law_parameters": {} if law is None else law.parameters,
        "model": part_attributes(groups, contact),
        "inputs": None if contact is None else contact.to_si(),
        "units": None if contact is None else units_of_inputs(contact),
    }


def problem_attributes(groups: Groups, contact: Contact | None, is_smooth: bool, varied: str = "") -> dict[str, Any]:
    """Return it as attributes of a dataset, which are flat; without the input that varies."""
    return {
        "geometry": groups.geometry,
        **law_attributes(groups.law, is_smooth),
        **part_attributes(groups, contact),
        **{f"{name}_group": value for name, value in constant_groups(groups).items()},
        **input_attributes(contact, varied),
    }


def input_attributes(contact: Contact | None, *varied: str) -> dict[str, float | str]:
    """Return the inputs of a contact with their units as attributes, without those that vary."""
    if contact is None:
        return {}
    inputs = {name: value for name, value in contact.inputs() if name not in varied}
    units = units_of_inputs(contact)
    named = ", ".join(f"{name} {units[name]}" for name in inputs)
    return {f"input_{name}": value for name, value in inputs.items()} | {"input_units": named}


def units_of_inputs(contact: Contact) -> dict[str, str]:
    """Return the SI units of the inputs of a contact."""
    return {name: contact.INPUTS.quantities[name].unit for name, _ in contact.inputs()}


def constant_groups(groups: Groups) -> dict[str, float]:
    """Return the groups that are the same in all states."""
    arrays = {name: np.ravel(getattr(groups, name)) for name in GROUPS}
    return {name: float(each[0]) for name, each in arrays.items() if len(each) and np.ptp(each) <= 1e-12 * each[0]}
