"""Case files: a TOML file of quantities with units becomes a checked :class:`Case`.

All problems of a file are reported at once, a sentence each, with the path, the table and the key. Bounds of quantities are
in :mod:`stribeck.quantities.inputs`.
"""

import functools
import os
import re
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from stribeck.cases.fit_settings import FitSettings, check_fit_table
from stribeck.cases.law import ASPERITIES, FROM_TABLES, LAWS, SURFACE, TABLE, Law, law_of_file
from stribeck.cases.model_parts import preset_facts, preset_said, take_parts
from stribeck.contacts.contact import Contact
from stribeck.contacts.geometries import CONTACTS, check_geometry
from stribeck.contacts.groups import Geometry
from stribeck.files.reading import read_bounded
from stribeck.quantities.conversions import GIVEN, read_given
from stribeck.quantities.facts import FACTS, fact_values
from stribeck.quantities.hints import ELSEWHERE, MEANT, advice_on
from stribeck.quantities.inputs import INPUT_TABLES, LINE, InputTable, check_alternatives, quantity
from stribeck.quantities.uncertain import split_error
from stribeck.quantities.units import DIMENSIONS, InputError, show

__all__ = [
    "Case",
    "CurveSettings",
    "check_case",
    "curve_range",
    "error_sentence",
    "example_of",
    "load_case",
    "parse_toml",
    "read_toml",
]

Axis = Literal["speed", "load", "roughness"]
Definition = Literal["balanced", "published"]

_LARGEST_FILE = 1_000_000  # [byte]

_DEEPEST = 16
_MOST_PARTS = 64

# For 20 000 parts Python's parser takes half a minute, so that these are looked for before it sees the text.  Texts may
# hold a few that look like it.
_PART = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
_DEEP_KEY = re.compile(rf"(?<![A-Za-z0-9_-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{_MOST_PARTS}}}")

# What Python's parser says of slips that are frequent, and what to do about them.
_SLIPS = {
    "Expected newline or end of document after a statement": 'a value with a unit needs quotes, as in radius = "10 mm"',
    "Cannot overwrite a value": "a key may occur only once in its table",
}


@dataclass(frozen=True)
class CurveSettings:
    """The ``[curve]`` table of a case.

    Parameters
    ----------
    over : {"speed", "load", "roughness"}
        The quantity that varies along the curve.
    range : tuple of float, optional
        Its lowest and highest value in SI units; None is the automatic range.
    points : int
        Number of states on the curve.
    """

    over: Axis = "speed"
    range: tuple[float, float] | None = None
    points: int = 101


@dataclass(frozen=True)
class Case:
    """One case file, checked, with its quantities in SI units.

    Parameters
    ----------
    path : pathlib.Path
        The file.
    contact : Contact or PointContact
        The quantities of the ``[contact]`` table.
    law : {"exponential", "persson", "greenwood-williamson", "greenwood-tripp", "table"}
        Name of the contact law of the ``[contact]`` table; the law itself is ``contact.law``.
    curve : CurveSettings
        The ``[curve]`` table.
    rtol : float
        Relative tolerance asked of the solver, from the ``[solver]`` table.
    definition : {"balanced", "published"}
        Which friction force the outputs show, from the ``[solver]`` table.
    title : str
        Headline for outputs; empty if the file has none.
    notes : str
        Free text; empty if the file has none.
    fit : FitSettings
        The ``[fit]`` table, for :func:`stribeck.fit`.
    facts : dict
        The ``[check]`` table, for :func:`stribeck.check`, in SI units.
    errors : dict
        Relative standard errors of the inputs that have one.
    conversions : tuple of str
        Conversions of data-sheet inputs, one sentence each.
    tables : dict
        All tables and keys of the file as written.
    """

    path: Path
    contact: Contact
    law: Law = "exponential"
    curve: CurveSettings = field(default_factory=CurveSettings)
    rtol: float = 1e-6
    definition: Definition = "balanced"
    title: str = ""
    notes: str = ""
    fit: FitSettings = field(default_factory=FitSettings)
    facts: dict[str, float] = field(default_factory=dict)
    errors: dict[str, float] = field(default_factory=dict)
    conversions: tuple[str, ...] = ()
    tables: dict[str, Any] = field(default_factory=dict, repr=False, compare=False)


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
    path = Path(path)
    return check_case(read_toml(path), path)


def check_case(tables: dict[str, Any], path: Path) -> Case:
    """Return the case of tables that were read.

    Parameters
    ----------
    tables : dict
        The tables of a case file, as TOML gives them.
    path : pathlib.Path
        Where they come from, for sentences; files that they name lie beside it.

    Returns
    -------
    Case
        The checked case.

    Raises
    ------
    InputError
        As in :func:`load_case`.
    """
    import pydantic

    problems = []
    geometry: Geometry = "line"
    table = dict(tables)
    try:
        geometry, table = geometry_of(tables)
    except InputError as problem:
        problems.append(f"[contact] {problem}")
    inputs = INPUT_TABLES[geometry]
    model = _model(geometry)
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
    if not problems:
        law = checked["contact"]["law"]
        try:
            contact = CONTACTS[geometry](**contact_inputs(checked, path.parent), **parts)
        except InputError as problem:
            text = str(problem)
            problems = [line if line.startswith(("[", "the table")) else f"[contact] {line}" for line in text.splitlines()]
    if problems:
        raise InputError("\n".join(f"{path}: {problem}" for problem in problems))
    return Case(
        path=path,
        contact=contact,
        law=law,
        curve=CurveSettings(**checked["curve"]),
        title=checked["title"],
        notes=checked["notes"],
        fit=fit,
        facts={**preset_facts(tables), **facts},
        errors=errors,
        conversions=(*conversions, *preset_said(tables, contact.viscosity)),
        tables=tables,
        **checked["solver"],
    )


def geometry_of(tables: dict[str, Any]) -> tuple[Geometry, dict[str, Any]]:
    """Return the geometry of the contact in a file, and the tables without it.

    Parameters
    ----------
    tables : dict
        The tables as written in the file.

    Returns
    -------
    str
        ``"line"`` unless ``[contact]`` or ``[groups]`` says otherwise.
    dict
        The tables, without that key.

    Raises
    ------
    InputError
        Where it is no geometry.
    """
    found = dict(tables)
    geometry: Geometry = "line"
    for name in ("contact", "groups"):
        if isinstance(found.get(name), dict) and "geometry" in found[name]:
            found[name] = dict(found[name])
            geometry = check_geometry(found[name].pop("geometry"))
    return geometry, found


def _convert(table: dict[str, Any], problems: list[str], inputs: InputTable) -> tuple[dict[str, float], tuple[str, ...]]:
    """Put inputs of the contact in the place of those that they follow from, and return their errors and what was done."""
    errors: dict[str, float] = {}
    said: tuple[str, ...] = ()
    sheet = table["contact"] if isinstance(table.get("contact"), dict) else {}
    if isinstance(table.get("contact"), dict):
        given = read_given(table["contact"], inputs)
        problems += [f"[contact] {each}" for each in given.problems]
        table["contact"], errors, said = given.values, given.errors, given.said
    surface = table.get("surface")
    from_sheet = any(name in ("ra", "rq") for name in sheet)
    if from_sheet and isinstance(surface, dict) and not {"h_rms", "spectrum", "shape_only", "wavenumber"} & set(surface):
        table["surface"] = surface | {"h_rms": table["contact"].pop("roughness")}
    elif isinstance(surface, dict) and "h_rms" in surface:
        try:
            height, error = split_error("h_rms", surface["h_rms"], "length")
        except InputError as problem:
            problems.append(f"[surface] {problem}")
        else:
            table["surface"] = surface | {"h_rms": height}
            errors |= {} if error is None else {"roughness": error}
    return errors, said


def contact_inputs(checked: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Return the arguments of the contact in a checked file, with the contact law made of its tables.

    Parameters
    ----------
    checked : dict
        The tables ``contact``, ``surface``, ``asperities`` and ``table``.
    folder : pathlib.Path
        Where files that they name lie.

    Returns
    -------
    dict
        The arguments that are given, and ``law``.

    Raises
    ------
    InputError
        Where the law or its tables are wrong, or an input is missing that they do not give.
    """
    inputs = dict(checked["contact"])
    tables = {name: checked[name] for name in ("surface", "asperities", "table")}
    found = law_of_file(inputs.pop("law"), inputs, tables, folder)
    inputs = {name: value for name, value in inputs.items() if value is not None} | found.coefficients
    return inputs | {"law": found.shape}


def group_inputs(checked: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Return the groups and coefficients in a checked file, and ``law``, of which tables give nothing but the shape.

    Parameters
    ----------
    checked : dict
        The tables ``groups``, ``surface``, ``asperities`` and ``table``.
    folder : pathlib.Path
        Where files that they name lie.

    Returns
    -------
    dict
        Those that are given, and ``law``.

    Raises
    ------
    InputError
        Where the law or its tables are wrong.
    """
    inputs = {name: value for name, value in checked["groups"].items() if value is not None}
    tables = {name: checked[name] for name in ("surface", "asperities", "table")}
    return inputs | {"law": law_of_file(inputs.pop("law"), {}, tables, folder).shape}


@functools.cache
def surface_table(keys: tuple[str, ...]) -> Any:
    """Return the pydantic model of a table with optional keys, which its own reader checks."""
    from pydantic import ConfigDict, create_model

    fields: dict[str, Any] = dict.fromkeys(keys, (Any, None))
    return create_model("_".join(keys), __config__=ConfigDict(extra="forbid"), **fields)


def read_toml(path: Path, kind: str = "case file", needed: str = "[contact]") -> dict[str, Any]:
    """Return the tables of a TOML file.

    Parameters
    ----------
    path : pathlib.Path
        The file.
    kind : str
        What the file is, for sentences.
    needed : str
        The table without which it says nothing.

    Returns
    -------
    dict
        What the file says, at least one entry.

    Raises
    ------
    InputError
        Where the file cannot be read, is too large, empty or no TOML.
    """
    try:
        content = read_bounded(path, _LARGEST_FILE)
    except (OSError, ValueError) as problem:
        reason = getattr(problem, "strerror", problem)
        received = f"{path} is a directory" if path.is_dir() else f"{path} cannot be read ({reason})"
        raise InputError(f"{received}; give the path of a TOML {kind}.") from None
    return parse_toml(content, path, kind, needed)


def parse_toml(content: bytes, path: Path, kind: str = "case file", needed: str = "[contact]") -> dict[str, Any]:
    """Return the tables of the content of a TOML file.

    Parameters
    ----------
    content : bytes
        The content.
    path : pathlib.Path
        Where it comes from, for sentences.
    kind, needed : str
        As in :func:`read_toml`.

    Returns
    -------
    dict
        What the file says, at least one entry.

    Raises
    ------
    InputError
        If it is too large, empty or no TOML.
    """
    if len(content) > _LARGEST_FILE:
        raise InputError(f"{path} has more than {_LARGEST_FILE} bytes; a {kind} is a short TOML file.")
    try:
        # Some editors write a byte-order mark, which TOML does not know.
        text = content.decode("utf-8-sig")
        if _DEEP_KEY.search(text):
            raise ValueError(f"a key has more than {_MOST_PARTS} parts")
        table = tomllib.loads(text)
        if _depth(table) > _DEEPEST:
            raise ValueError(f"tables or lists are nested more than {_DEEPEST} deep")
    except UnicodeDecodeError as problem:
        raise InputError(f"{path} is not text (byte {problem.start} is not UTF-8); a {kind} is a short TOML file.") from None
    except (ValueError, RecursionError) as problem:
        said = " ".join(str(problem).split())
        advice = "".join(f"; {advice}" for slip, advice in _SLIPS.items() if said.startswith(slip))
        raise InputError(f"{path} is not valid TOML: {said}{advice}.") from None
    if not table:
        raise InputError(f"{path} is empty; a {kind} needs at least the table {needed}.")
    return table


def _depth(table: Any) -> int:
    """Return how deep tables and lists lie in each other."""
    depth, level = 0, [table]
    while level:
        depth += 1
        inner = [value.values() if isinstance(value, dict) else value for value in level]
        level = [value for values in inner for value in values if isinstance(value, dict | list)]
    return depth


@functools.cache
def _model(geometry: str) -> Any:
    """Return the pydantic model of a case file of a geometry, made on first use because pydantic is slow to import."""
    from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo, create_model

    def check_quantity(value: Any, info: ValidationInfo) -> float:
        return quantity(str(info.field_name), value, inputs)

    def check_range(value: Any, info: ValidationInfo) -> tuple[float, float] | None:
        return curve_range(value, info.data["over"], inputs) if "over" in info.data else None

    inputs = INPUT_TABLES[geometry]

    # A description completes the sentence "... must be ..." for what pydantic refuses by itself.
    number = Annotated[float, BeforeValidator(check_quantity)]
    text = Annotated[str, Field(strict=True, description="text in quotes")]

    class Table(BaseModel):
        model_config = ConfigDict(extra="forbid")

    optional = inputs.choices | set(FROM_TABLES)
    keys: dict[str, Any] = {name: (number | None, None) if name in optional else (number, ...) for name in inputs.quantities}
    keys["law"] = (Annotated[Law, Field(description=f"one of {', '.join(map(repr, LAWS))}")], Case.law)
    contact_table = create_model("Contact", __base__=Table, **keys)

    class Curve(Table):
        over: Annotated[Axis, Field(description="'speed', 'load' or 'roughness'")] = CurveSettings.over
        range: Annotated[Any, BeforeValidator(check_range)] = None
        points: Annotated[int, Field(strict=True, ge=2, le=100_000, description="a whole number from 2 to 100000")] = (
            CurveSettings.points
        )

    class Solver(Table):
        rtol: Annotated[
            float,
            Field(strict=True, ge=1e-11, le=1e-2, description="a number from 1e-11 to 1e-2, without quotes"),
        ] = Case.rtol
        definition: Annotated[Definition, Field(description="'balanced' or 'published'")] = Case.definition

    class File(Table):
        contact: Annotated[contact_table, Field(description="a table, [contact]")]  # type: ignore[valid-type]
        curve: Annotated[Curve, Field(description="a table, [curve]", default_factory=Curve)]
        solver: Annotated[Solver, Field(description="a table, [solver]", default_factory=Solver)]
        surface: Annotated[surface_table(SURFACE), Field(description="a table, [surface]")] = None  # type: ignore[valid-type]
        asperities: Annotated[surface_table(ASPERITIES), Field(description="a table, [asperities]")] = None  # type: ignore[valid-type]
        check: Annotated[surface_table(tuple(FACTS)), Field(description="a table, [check]")] = None  # type: ignore[valid-type]
        table: Annotated[surface_table(TABLE), Field(description="a table, [table]")] = None  # type: ignore[valid-type]
        title: text = Case.title
        notes: text = Case.notes

    return File


def curve_range(value: Any, over: str, inputs: InputTable = LINE) -> tuple[float, float]:
    """Return the ends of a curve in SI units.

    Parameters
    ----------
    value : object
        A list of two values with units or in SI.
    over : str
        What varies.
    inputs : InputTable
        The inputs of the geometry.

    Returns
    -------
    tuple of float
        The lowest and the highest value.

    Raises
    ------
    InputError
        Where these are no two positive values, the lowest first.
    """
    if not isinstance(value, list) or len(value) != 2:
        raise InputError(f"range = {show(value)} must be a list of two values, the lowest and the highest {over}.")
    low, high = (_range_end(end, over, inputs) for end in value)
    if not low < high:
        raise InputError(f"range = {show(value)} must increase; write the lowest {over} first.")
    return low, high


def _range_end(value: Any, over: str, inputs: InputTable) -> float:
    try:
        result = quantity(over, value, inputs)
    except InputError as problem:
        raise InputError(f"in range, {problem}") from None
    if result == 0:
        raise InputError(f"in range, {over} = {show(value)} must be positive, because the curve is logarithmic.")
    return result


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
    if not shape_only and ("surface" in table or "asperities" in table or contact.get("law") == "persson"):
        return []
    return [f"[contact] {key} is missing; {example_of(key)}." for key in FROM_TABLES if key not in contact]


def error_sentence(file: Any, error: Any, inputs: InputTable = LINE) -> str:
    """Return the sentence for one of pydantic's errors in a ``file`` of tables."""
    *tables, key = [str(part) for part in error["loc"][:2]]
    model = file.model_fields[tables[0]].annotation if tables else file
    where = f"[{tables[0]}] " if tables else ""
    shown = key if key.isprintable() else repr(key)
    if error["type"] == "missing":
        return f"{where}{key} is missing; {example_of(key, inputs)}." if tables else f"the table [{key}] is missing."
    if error["type"] == "extra_forbidden":
        return f"{where}{shown} = {show(error['input'])} is not a known key; {_nearest(file, model, key)}."
    if error["type"] == "value_error":
        return f"{where}{error['ctx']['error']}"
    return f"{where}{key} = {show(error['input'])} must be {model.model_fields[key].description}."


def example_of(key: str, inputs: InputTable = LINE) -> str:
    """Return the advice to add a quantity, with a typical value and where it is from."""
    wanted = inputs.quantities[key]
    value = f'"{wanted.typical}"' if DIMENSIONS[wanted.dimension].unit else wanted.typical
    other = f", {ELSEWHERE[key]}" if key in ELSEWHERE else ""
    return f"add {DIMENSIONS[wanted.dimension].noun}, for example {key} = {value} ({wanted.source}){other}"


def _nearest(file: Any, model: Any, key: str) -> str:
    known = [*model.model_fields, *(GIVEN if "radius" in model.model_fields else ())]
    meant = MEANT.get(key, key)
    advice = advice_on(key, known)
    if advice:
        return advice
    for name, info in file.model_fields.items():
        if model is not info.annotation and meant in getattr(info.annotation, "model_fields", {}):
            return f"it belongs in the table [{name}]"
    if meant in file.model_fields:
        return "it belongs at the top of the file, before the first table"
    return f"known are {', '.join(known)}"
