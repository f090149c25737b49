"""Case files: TOML with units becomes a checked :class:`Case`; all problems are reported at once, a sentence each."""

import os
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

from stribeck.cases.case import (
    DEFAULT_POINTS_AND_RTOL,
    FACTS,
    Axis,
    Case,
    CurveSettings,
    StrokeSettings,
    curve_range,
    fact_values,
    stroke_settings,
)
from stribeck.cases.case import KEYS as KEYS_OF_STROKE
from stribeck.cases.fit_settings import FitSettings, check_fit_table, with_bench_keys
from stribeck.cases.law import ERRORS_OF_SURFACES, INPUTS_OF_SURFACES, KEYS_OF_SURFACES, LAW_KEY, SURFACE, law_of_file
from stribeck.cases.model_parts import PART_TABLES, in_file, take_parts
from stribeck.cases.tables import AS_GIVEN, HEAD, Key, Keys, noted, one_of, read_tables, tolerance, whole
from stribeck.contact_laws.law import own_inputs
from stribeck.contact_laws.scaled import NAMED_LAWS
from stribeck.contacts.contact import IN_PLACE_OF
from stribeck.contacts.friction import DEFINITIONS
from stribeck.contacts.geometries import CONTACTS, INPUT_TABLES
from stribeck.contacts.groups import Geometry, check_geometry
from stribeck.contacts.inputs import (
    InputTable,
    ReadInputs,
    check_motion,
    follows_surface,
    read_inputs,
    typical_error_text,
    typical_errors,
)
from stribeck.contacts.parts import PART_INPUTS
from stribeck.files.toml import read_toml
from stribeck.files.writing import path_of
from stribeck.quantities.schema import has_error, relative_error, split_error
from stribeck.quantities.standard_errors import StandardErrors, errors_of_sources, with_proportional
from stribeck.quantities.units import InputError, show


def load_case(path: str | os.PathLike[str]) -> Case:
    """Read and check a case file.

    Parameters
    ----------
    path : str or path-like
        A TOML file: a table ``[contact]`` (``geometry``, the arguments of :class:`LineContact` or
        :class:`PointContact`, and ``law`` by its name), a table
        ``[surface]``, ``[asperities]`` or ``[table]`` where the law comes from one, and optionally ``[fluid]``,
        ``[cavitation]``, ``[flow_factors]`` and ``[solid]`` (see fluids.md), ``[curve]``
        (``over``, ``range``, ``points``), ``[stroke]`` (see strokes.md),
        ``[solver]`` (``rtol``, ``definition``), ``[fit]`` (see fitting.md), ``[bench]`` (see
        bench.md), ``[correlations]`` of the errors of inputs (see data_sheet.md), ``[check]`` (facts for
        :func:`stribeck.check`), ``title`` and ``notes``.

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


def load_rig(path: str | os.PathLike[str]) -> FitSettings:
    """Return what a case says of the files of a rig, or a file with the table ``[bench]`` alone."""
    path = path_of(path)
    tables = read_toml(path)
    if set(tables) != {"bench"}:
        return check_case(tables, path).bench
    try:
        return with_bench_keys(FitSettings(), tables, "bench")
    except InputError as problem:
        _refuse(path, str(problem).splitlines())
        raise


def check_case(tables: dict[str, Any], path: Path) -> Case:
    """Return the case of tables that were read."""
    problems: list[str] = []
    geometry, table = geometry_of(tables, problems)
    inputs = INPUT_TABLES[geometry]
    errors = _split_errors(table, problems)
    model = take_parts(table, path.parent)
    table, parts = model.rest, model.parts
    elsewhere = tuple(own for part, own in IN_PLACE_OF.items() if parts.get(part, tables.get(part)) is not None)
    problems += model.problems
    fit = bench = FitSettings(geometry=geometry)
    fit_table, bench_table, correlations = (table.pop(name, {}) for name in ("fit", "bench", "correlations"))
    with noted(problems):
        fit = check_fit_table(fit_table, geometry, tables.get("fluid"))
        bench = with_bench_keys(fit, {"bench": bench_table}, "bench")
    found = _read_contact(table, problems, inputs, elsewhere)
    checked = read_tables(table, _keys_of_case(geometry), problems)
    facts: dict[str, float] = {}
    with noted(problems, "check"):
        facts = fact_values(checked.get("check", {}))
    curve = checked.get("curve", {})
    if "range" in curve and table["curve"].get("over", curve["over"]) == curve["over"]:
        with noted(problems, "curve"):
            curve["range"] = curve_range(curve["range"], curve["over"], inputs)
    stroke: StrokeSettings | None = None
    if "stroke" in table and "stroke" in checked:
        with noted(problems, "stroke"):
            stroke = stroke_settings(checked["stroke"])
    if "contact" not in table:
        problems.append("the table [contact] is missing.")
    _refuse(path, problems)
    given = dict(checked["contact"])
    law = given.pop("law")
    try:
        surface = {name: checked[name] for name in KEYS_OF_SURFACES if name in checked}
        shape, coefficients = law_of_file(law, given, surface, path.parent)
        contact = CONTACTS[geometry].of_kept(given | coefficients | parts, shape)
    except InputError as problem:
        _refuse(path, [in_file(line, "contact") for line in str(problem).splitlines()])
    if "alpha" in found.errors and hasattr(contact.law, "fixed_alpha"):
        _refuse(path, [f"[contact] alpha has no error under law = {show(law)}: it is {contact.alpha:g} by definition."])
    known = errors_of_sources(found.errors) | errors
    scales_surface = "surface" in tables and not tables["surface"].get("shape_only", False)
    follows = scales_surface and "roughness" in known and "beta" not in known and not follows_surface(contact, known)
    try:
        if follows:  # so that [correlations] may name it
            known |= {"beta": known["roughness"]}
        stated = StandardErrors(known, correlations)
        stated.correlations = known.correlations | stated.correlations
        if follows:  # what the height goes with, beta does
            stated = with_proportional(stated, "beta", "roughness")
        known = StandardErrors(known, stated.nested)
    except InputError as problem:
        _refuse(path, [f"[correlations] {problem}"])
    of_contact: dict[str, Any] = {"slide_to_roll": contact.slide_to_roll, "scales_surface": scales_surface}
    typical = typical_errors(contact, known) if checked["uncertainty"] == "typical" else {}
    return Case(
        path=path,
        contact=contact,
        law=law,
        curve=CurveSettings(**curve),
        stroke=stroke,
        title=checked["title"],
        notes=checked["notes"],
        fit=replace(fit, **of_contact),
        bench=replace(bench, **of_contact),
        facts={
            **model.facts,
            **(stroke.facts if stroke else {}),
            **{name: found.given[name] for name in FACTS.keys() & found.given.keys()},
            **facts,
        },
        errors=known | typical,
        conversions=(
            *found.sentences,
            *model.sentences,
            *typical_error_text(contact, typical),
        ),
        tables=tables,
        **checked["solver"],
    )


def _refuse(path: Path, problems: list[str]) -> None:
    if problems:
        raise InputError("\n".join(f"{path}: {problem}" for problem in problems))


def _keys_of_case(geometry: Geometry) -> dict[str, Keys]:
    """Return what the tables of a case may have; those without keys here were read before."""
    points, rtol = DEFAULT_POINTS_AND_RTOL[geometry]
    return {
        "contact": {**dict.fromkeys((*INPUT_TABLES[geometry].quantities, "slide_to_roll"), AS_GIVEN), "law": LAW_KEY},
        "curve": {
            "over": Key(one_of(*get_args(Axis)), CurveSettings.over),
            "range": AS_GIVEN,
            "points": Key(whole(2, 100_000), points),
        },
        "stroke": KEYS_OF_STROKE,
        "solver": keys_of_solver(rtol),
        **KEYS_OF_SURFACES,
        **dict.fromkeys((*PART_TABLES, "fit", "bench", "correlations"), {}),
        "check": dict.fromkeys(FACTS, Key(lambda name, value: FACTS[name].checked(value))),
        "": HEAD,
    }


def keys_of_solver(rtol: float) -> Keys:
    """Return what ``[solver]`` may have."""
    return {"rtol": tolerance(rtol), "definition": Key(one_of(*DEFINITIONS), Case.definition)}


def geometry_of(tables: dict[str, Any], problems: list[str]) -> tuple[Geometry, dict[str, Any]]:
    """Return the geometry of the contact in a file, that of a line where it is wrong, and the tables without it."""
    found = dict(tables)
    geometry: Geometry = "line"
    for name in ("contact", "groups"):
        if isinstance(found.get(name), dict) and "geometry" in found[name]:
            found[name] = dict(found[name])
            with noted(problems, name):
                geometry = check_geometry(found[name].pop("geometry"))
    return geometry, found


# Table, number and name of what may have an error, but for ``[contact]``.
UNCERTAIN = (
    *((row.table, row, name) for name, row in PART_INPUTS.items()),
    ("surface", SURFACE.kept["h_rms"], "roughness"),
)


def _split_errors(table: dict[str, Any], problems: list[str]) -> dict[str, float]:
    """Put numbers without their errors in the place of those with them, and return the errors."""
    errors: dict[str, float] = {}
    for where, row, name in UNCERTAIN:
        numbers = table.get(where)
        if isinstance(numbers, dict) and has_error(numbers.get(row.name)):
            table[where] = numbers | {row.name: row.typical_value}
            with noted(problems, where):
                value, error = split_error(row.name, numbers[row.name], row.dimension, row.typical)
                table[where] = numbers | {row.name: value}
                if error is not None and numbers.get("shape_only") is not True:  # the height of a shape is no input
                    errors[name] = error
    surface = table.get("surface")
    given = surface if isinstance(surface, dict) else {}
    for key in ERRORS_OF_SURFACES.keys() & given.keys():
        with noted(problems, "surface"):
            errors[ERRORS_OF_SURFACES[key]] = relative_error(key, 1.0, given[key], "number")
    return errors


def _read_contact(table: dict[str, Any], problems: list[str], inputs: InputTable, elsewhere: tuple[str, ...]) -> ReadInputs:
    """Put the inputs that a contact keeps in the place of those that are given, and return what is known of them."""
    contact, surface = table.get("contact"), table.get("surface")
    if not isinstance(contact, dict):
        return ReadInputs()
    given = {name: value for name, value in contact.items() if name in inputs.quantities}
    elsewhere = (*_given_by_surface(table), *elsewhere)
    own = {} if "alpha" in elsewhere else own_inputs(NAMED_LAWS.get(str(contact.get("law"))))
    found = read_inputs(own | given, inputs, elsewhere, has_errors=True)
    problems += [f"[contact] {problem}" for problem in found.problems]
    with noted(problems, "contact"):
        check_motion(given, inputs)
    table["contact"] = {name: value for name, value in contact.items() if name not in given} | found.values
    if isinstance(surface, dict):
        heights = {"h_rms", "spectrum", "shape_only", "wavenumber"}
        if not given.keys().isdisjoint(("ra", "rq")) and heights.isdisjoint(surface):
            table["surface"] = surface | {"h_rms": table["contact"].pop("roughness")}
    return found


def _given_by_surface(table: dict[str, Any]) -> tuple[str, ...]:
    """Return the inputs that a table of the surface gives, in the place of ``[contact]``."""
    contact, surface = table["contact"], table.get("surface")
    shape_only = isinstance(surface, dict) and surface.get("shape_only") is True
    of_asperities = "asperities" in table and hasattr(NAMED_LAWS.get(str(contact.get("law"))), "coefficients")
    given = not shape_only and ("surface" in table or of_asperities or contact.get("law") == "persson")
    return INPUTS_OF_SURFACES if given else ()
