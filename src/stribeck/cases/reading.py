"""Case files: a TOML file of quantities with units becomes a checked :class:`Case`.

All problems of a file are reported at once, a sentence each, with the path, the table and the key. Bounds of quantities are
in :mod:`stribeck.quantities.inputs`.
"""

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

from stribeck.cases.case import Case, CurveSettings
from stribeck.cases.fit_settings import FitSettings, check_fit_table
from stribeck.cases.law import INPUTS_OF_SURFACES, law_of_file
from stribeck.cases.model_parts import in_file, preset_facts, preset_source_text, take_parts
from stribeck.cases.tables import error_sentence, example_of, file_model
from stribeck.contact_laws.scaled import NAMED_LAWS
from stribeck.contacts.geometries import CONTACTS, check_geometry
from stribeck.contacts.groups import Geometry
from stribeck.contacts.part_inputs import PART_INPUTS
from stribeck.files.toml import read_toml
from stribeck.files.writing import path_of
from stribeck.quantities.contact_values import check_alternatives
from stribeck.quantities.conversions import read_given
from stribeck.quantities.facts import FACTS, fact_values
from stribeck.quantities.inputs import INPUT_TABLES, InputTable
from stribeck.quantities.uncertain import has_error, split_error
from stribeck.quantities.units import DIMENSIONS, InputError, show

__all__ = ["check_case", "contact_inputs", "geometry_of", "group_inputs", "load_case"]


def load_case(path: str | os.PathLike[str]) -> Case:
    """Read and check a case file.

    Parameters
    ----------
    path : str or path-like
        A TOML file: a table ``[contact]`` (``geometry``, the arguments of :class:`LineContact` or
        :class:`PointContact`, and ``law`` by its name), a table
        ``[surface]``, ``[asperities]`` or ``[table]`` where the law comes from one, and optionally ``[fluid]``,
        ``[cavitation]``, ``[motion]``, ``[flow_factors]`` and ``[solid]`` (see fluids.md), ``[curve]``
        (``over``, ``range``, ``points``), ``[solver]`` (``rtol``, ``definition``), ``[fit]`` (see fitting.md),
        ``[check]`` (facts for :func:`stribeck.check`), ``title`` and ``notes``.

    Returns
    -------
    Case
        The checked case.

    Raises
    ------
    InputError
        Where the file cannot be read, is no TOML, or has unknown, missing or impossible entries: a sentence
        on each line, for all of its problems.
    """
    path = path_of(path)
    return check_case(read_toml(path), path)


def check_case(tables: dict[str, Any], path: Path) -> Case:
    """Return the case of tables that were read."""
    import pydantic

    problems = []
    geometry: Geometry = "line"
    table = dict(tables)
    try:
        geometry, table = geometry_of(tables)
    except InputError as problem:
        problems.append(f"[contact] {problem}")
    inputs = INPUT_TABLES[geometry]
    model = file_model(geometry)
    part_errors = _split_part_errors(table, problems)
    table, parts, wrong = take_parts(table, geometry)
    problems += wrong
    fit = FitSettings(geometry=geometry)
    if "fit" in table:
        try:
            fit = check_fit_table(table.pop("fit"), geometry)
        except InputError as problem:
            problems += str(problem).split("\n")
    errors, conversions = _convert(table, problems, inputs)
    try:
        checked = model(**table).model_dump()
    except pydantic.ValidationError as failure:
        problems += [error_sentence(model, error, inputs) for error in failure.errors(include_url=False)]
    problems += _elasticity_problem(table.get("contact"), inputs) + _missing_from_surface(table)
    facts: dict[str, float] = {}
    if isinstance(table.get("check"), dict):
        for name, value in table["check"].items():
            if name in FACTS:
                try:
                    facts |= fact_values({name: value})
                except InputError as problem:
                    problems.append(f"[check] {problem}")
        try:
            facts = fact_values(facts)
        except InputError as problem:
            problems.append(f"[check] {problem}")
    if not problems:
        law = checked["contact"]["law"]
        try:
            contact = CONTACTS[geometry](**contact_inputs(checked, path.parent), **parts)
        except InputError as problem:
            lines = str(problem).splitlines()
            problems = [line if line.startswith(("[", "the table")) else in_file(line, "contact") for line in lines]
        else:
            if "alpha" in errors and hasattr(contact.law, "fixed_alpha"):
                problems.append(
                    f"[contact] alpha has no error under law = {show(law)}: it is {contact.alpha:g} by definition."
                )
    if problems:
        raise InputError("\n".join(f"{path}: {problem}" for problem in problems))
    return Case(
        path=path,
        contact=contact,
        law=law,
        curve=CurveSettings(**checked["curve"]),
        title=checked["title"],
        notes=checked["notes"],
        fit=replace(
            fit,
            slide_to_roll=FitSettings.of(contact).slide_to_roll,
            scales_surface="surface" in tables and not tables["surface"].get("shape_only", False),
        ),
        facts={**preset_facts(tables), **facts},
        errors={**errors, **part_errors},
        conversions=(*conversions, *preset_source_text(tables, contact.viscosity)),
        tables=tables,
        **checked["solver"],
    )


def geometry_of(tables: dict[str, Any]) -> tuple[Geometry, dict[str, Any]]:
    """Return the geometry of the contact in a file, and the tables without it."""
    found = dict(tables)
    geometry: Geometry = "line"
    for name in ("contact", "groups"):
        if isinstance(found.get(name), dict) and "geometry" in found[name]:
            found[name] = dict(found[name])
            geometry = check_geometry(found[name].pop("geometry"))
    return geometry, found


def _split_part_errors(table: dict[str, Any], problems: list[str]) -> dict[str, float]:
    """Put numbers of fluid and solid without their errors in the place of those with them, and return the errors."""
    errors: dict[str, float] = {}
    for name, row in PART_INPUTS.items():
        numbers = table.get(row.table)
        if isinstance(numbers, dict) and has_error(numbers.get(name)):
            try:
                value, error = split_error(name, numbers[name], row.dimension, row.typical)
            except InputError as problem:
                problems.append(f"[{row.table}] {problem}")
                value, error = row.typical if DIMENSIONS[row.dimension].unit else float(row.typical), None
            table[row.table] = numbers | {name: value}
            errors |= {} if error is None else {name: error}
    return errors


def _convert(table: dict[str, Any], problems: list[str], inputs: InputTable) -> tuple[dict[str, float], tuple[str, ...]]:
    """Put inputs of the contact in the place of those that they follow from, and return their errors and what was done."""
    errors: dict[str, float] = {}
    sentences: tuple[str, ...] = ()
    sheet = table["contact"] if isinstance(table.get("contact"), dict) else {}
    if isinstance(table.get("contact"), dict):
        given = read_given(table["contact"], inputs)
        problems += [f"[contact] {each}" for each in given.problems]
        table["contact"], errors, sentences = given.values, given.errors, given.sentences
    surface = table.get("surface")
    from_sheet = any(name in ("ra", "rq") for name in sheet)
    if from_sheet and isinstance(surface, dict) and not {"h_rms", "spectrum", "shape_only", "wavenumber"} & set(surface):
        table["surface"] = surface | {"h_rms": table["contact"].pop("roughness")}
    elif isinstance(surface, dict) and "h_rms" in surface:
        try:
            height, error = split_error("h_rms", surface["h_rms"], "length", "1 um")
        except InputError as problem:
            problems.append(f"[surface] {problem}")
        else:
            table["surface"] = surface | {"h_rms": height}
            errors |= {} if error is None else {"roughness": error}
    return errors, sentences


def contact_inputs(checked: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Return the arguments of the contact in a checked file, with the contact law made of its tables."""
    inputs = dict(checked["contact"])
    tables = {name: checked[name] for name in ("surface", "asperities", "table")}
    found = law_of_file(inputs.pop("law"), inputs, tables, folder)
    inputs = {name: value for name, value in inputs.items() if value is not None} | found.coefficients
    return inputs | {"law": found.shape}


def group_inputs(checked: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Return the groups and coefficients in a checked file, and ``law``, of which tables give nothing but the shape."""
    inputs = {name: value for name, value in checked["groups"].items() if value is not None}
    tables = {name: checked[name] for name in ("surface", "asperities", "table")}
    return inputs | {"law": law_of_file(inputs.pop("law"), {}, tables, folder).shape}


def _elasticity_problem(contact: Any, inputs: InputTable) -> list[str]:
    if not isinstance(contact, dict):
        return []
    try:
        check_alternatives(contact, inputs)
    except InputError as problem:
        return [f"[contact] {problem}"]
    return []


def _missing_from_surface(table: dict[str, Any]) -> list[str]:
    """Return sentences for inputs that neither ``[contact]`` nor a table of the surface gives."""
    contact = table.get("contact")
    if not isinstance(contact, dict):
        return []
    surface = table.get("surface")
    shape_only = isinstance(surface, dict) and surface.get("shape_only") is True
    of_asperities = "asperities" in table and hasattr(NAMED_LAWS.get(str(contact.get("law"))), "coefficients")
    if not shape_only and ("surface" in table or of_asperities or contact.get("law") == "persson"):
        return []
    return [f"[contact] {key} is missing; {example_of(key)}." for key in INPUTS_OF_SURFACES if key not in contact]
