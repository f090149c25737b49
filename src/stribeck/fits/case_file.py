"""The case file of a fit: read before it, and written after it with the fitted values and where they come from."""

import json
import math
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from stribeck.cases.case import Case
from stribeck.cases.fit_settings import settings_of
from stribeck.cases.law import ERRORS_OF_SURFACES, INPUTS_OF_SURFACES
from stribeck.cases.model_parts import FILES
from stribeck.cases.reading import load_case
from stribeck.contact_laws.table import TableLaw
from stribeck.contacts.contact import Contact
from stribeck.contacts.parts import PART_INPUTS
from stribeck.files.toml import read_toml
from stribeck.files.writing import PathLike, atomic_write
from stribeck.fits.result import Fit, FittedInput
from stribeck.quantities.formats import format_si
from stribeck.quantities.schema import has_error, split_error
from stribeck.quantities.standard_errors import StandardErrors, correlation_table
from stribeck.quantities.units import InputError, show

DIGITS = 10  # Digits of the values in the file, enough to solve the same state again

AGREEMENT = 1e-8  # Relative difference that rounding to these digits may leave

TRIAL_FACTOR = 1.01  # Factor on free inputs by which it is tried before a fit whether its case can be written

# Keys of a table `[surface]` with a measured spectrum, which has no height of its own.
SPECTRUM = {"spectrum", "wavenumber", "density"}

_TABLE = re.compile(r"\s*\[+\s*([^\]]*?)\s*\]+\s*(?:#.*)?")


def case_of(data: object, case: PathLike | Case | Contact) -> Case:
    """Return the case of a fit, read if need be, or that of a contact alone; say so if its file and the data were swapped."""
    if isinstance(case, Case):
        return case
    if isinstance(case, Contact):
        return Case(Path(), case, fit=settings_of(case))
    if not isinstance(case, str | os.PathLike):
        raise InputError(f"case = {show(case)}; it must be the path of a case file, a Case, LineContact or PointContact.")
    if isinstance(data, str | os.PathLike) and "contact" in _tables(data) and not _tables(case) and Path(case).is_file():
        raise InputError(
            f"{data} and {case} look swapped: {data} is a case file and {case} is not. "
            f"Measured friction comes first, then the case: {case} {data}."
        )
    return load_case(case)


def _tables(path: PathLike) -> dict[str, Any]:
    """Return the tables of a TOML file; none if it is not one."""
    try:
        return read_toml(Path(path))
    except InputError:
        return {}


def check_fitted_case(case: Case, names: Sequence[str], path: PathLike) -> None:
    """Refuse a fit whose case could not be written afterwards."""
    contact = case.contact
    known = {name: value for name in names if (value := getattr(contact, name, None))}
    if case.fit.scales_surface and "beta" not in known and "roughness" in known:
        known["beta"] = contact.beta
    changed = contact.replace(**{name: value * TRIAL_FACTOR for name, value in known.items()})
    with TemporaryDirectory() as folder:
        _write(case, changed, [name for name in names if name in known], Path(folder) / "case.toml", path)


def write_fitted_case(fit: Fit, case: Case, path: PathLike, *, force: bool = False) -> None:
    """Write the case of a fit with the fitted values, everything else as it was."""
    if not fit.converged:
        raise InputError(f"no fitted case is written. {fit.outcome.value}")
    with atomic_write(path, (".toml",), force=force) as temporary:
        _write(case, fit.contact, list(dict.fromkeys(each.name for each in fit.inputs)), temporary, path, fit)


def _about(fit: Fit) -> str:
    """Return the line that says where fitted values are from."""
    sources = ", ".join(dict.fromkeys(fit.data.files)) or Path(fit.data.path).name
    said = fit.quality.messages[0] if fit.quality.messages else "No systematic misfit detected in its residuals."
    return f"# Fitted by stribeck {version('stribeck')} to {sources}. {fit.outcome.value} {said}"


def _write(
    case: Case, contact: Contact, names: Sequence[str], temporary: Path, path: PathLike, fit: Fit | None = None
) -> None:
    """Write the case with the values of a contact, as a fit gives them, and check that what is read back is that contact."""
    inputs = () if fit is None else fit.inputs
    factors = {each.name: each.value for each in inputs if each.is_factor and each.curve is None}
    edits = _edits(case, contact, names, StandardErrors() if fit is None else fit.errors, inputs)
    for kind in ("curves", "files"):  # the values of all curves have the factor that they share
        for owner, given in case.tables.get("fit", {}).get(kind, {}).items():
            for name in given.keys() & factors.keys():
                row = contact.INPUTS.rows[name]
                line = _entry(name, row.checked(given[name]) * factors[name], row.dimension)
                edits.at |= {(f"fit.{kind}.{key}", name): [line] for key in (owner, json.dumps(owner), f"'{owner}'")}
    text = case.path.read_text(encoding="utf-8-sig")
    temporary.write_text(
        "\n".join([*([] if fit is None else [_about(fit)]), *_edited(text, edits, case.path.parent)]) + "\n", encoding="utf-8"
    )
    try:
        back = load_case(temporary).contact
    except InputError as problem:
        raise InputError(str(problem).replace(str(temporary), str(path))) from None
    for name in contact.INPUTS.rows:
        value, kept = getattr(contact, name, None), getattr(back, name, None)
        if value is not None and (kept is None or not math.isclose(kept, value, rel_tol=AGREEMENT)):
            table, key = _place(name)
            raise InputError(
                f"{path} cannot be written, as {case.path} does not have {key} on a line of its own in [{table}]; "
                "write it there in the place of what it follows from."
            )


@dataclass
class _Edits:
    """Lines of a case file in the place of keys, and at the end of tables."""

    at: dict[tuple[str, str], list[str]]
    added: dict[str, list[str]]
    removed: set[str]
    end: list[str] = field(default_factory=list)  # Of the file

    def put(self, table: str, key: str, lines: list[str], instead: Sequence[str] = ()) -> None:
        """Put lines in the place of a key of a table, or of others that say the same, else at its end."""
        first, *others = instead or [key]
        self.at[table, first] = lines
        self.at |= {(table, other): [] for other in others}


def _edits(
    case: Case, contact: Contact, names: Sequence[str], of_names: StandardErrors, fitted_inputs: Sequence[FittedInput]
) -> _Edits:
    """Return what changes in the file of a case whose contact has other values of some inputs."""
    errors = StandardErrors({name: each for name, each in case.errors.items() if name not in names}) | of_names
    edits, given, fitted = _Edits({}, {}, set()), case.tables.get("contact", {}), set(names)
    from_table = [table for table in ("surface", "asperities") if table in case.tables]
    free_of_table = [name for name in INPUTS_OF_SURFACES if name in names] if from_table else []
    if free_of_table and not case.tables[from_table[0]].get("shape_only", False):
        table = from_table[0]
        edits.at |= {(table, key): [] for key in ERRORS_OF_SURFACES}  # beta follows the height, or has its own in [contact]
        sheet = [key for key in ("ra", "rq") if key in given]
        if free_of_table == ["roughness"] and case.fit.scales_surface and not SPECTRUM & set(case.tables[table]):
            left = {name: each for name, each in errors.items() if name not in ERRORS_OF_SURFACES.values()}
            errors = StandardErrors(left) | of_names
            lines = [
                *_comments("roughness", fitted_inputs),
                _entry("h_rms", contact.roughness, "length", of_names.get("roughness")),
            ]
            lines += [f'beta_error = "{100 * of_names["beta"]:.4g} %"'] if "beta" in of_names else []
            if sheet:
                edits.at |= {("contact", key): [] for key in sheet}
                edits.added[table] = lines
            else:
                edits.put(table, "h_rms", lines)
        else:
            lines = ["# The shape alone; the numbers stand in [contact].", "shape_only = true"]
            if table == "surface":
                edits.added[table] = [*lines, *([_entry("h_rms", case.contact.roughness, "length")] if sheet else [])]
            else:  # of asperities nothing is left beside these numbers
                edits.removed.add(table)
            edits.at |= {("contact", key): [] for key in sheet}
            edits.added["contact"] = [
                line
                for name in INPUTS_OF_SURFACES
                for line in (*_comments(name, fitted_inputs), _entry_of(name, contact, errors))
            ]
        names = [name for name in names if name not in INPUTS_OF_SURFACES]
    for name in names:
        value = getattr(contact, name, None)
        if value is None:
            continue
        place, key = _place(name)
        lines = [*_comments(name, fitted_inputs), _entry_of(name, contact, errors)]
        stands_for = contact.INPUTS.stands_for
        instead = [each for each in given if stands_for.get(each, each) == name] if place == "contact" else []
        if instead == ["youngs_modulus", "poisson_ratio"]:
            youngs = contact.modulus * (1 - _number(given["poisson_ratio"]) ** 2)
            edits.put(place, "youngs_modulus", [*lines[:-1], _entry("youngs_modulus", youngs, "pressure", errors.get(name))])
            if has_error(given["poisson_ratio"]):  # the error of the fit is that of both
                edits.put(place, "poisson_ratio", [_entry("poisson_ratio", _number(given["poisson_ratio"]), "number")])
        else:
            edits.put(place, key, lines, instead)
    kept = {frozenset((a, b)): each for a, others in case.tables.get("correlations", {}).items() for b, each in others.items()}
    kept |= case.errors.correlations  # that of a height with beta is in no table
    held = errors.keys() - fitted - of_names.keys()
    errors.correlations = {pair: each for pair, each in kept.items() if pair <= held} | of_names.correlations
    edits.removed.add("correlations")
    edits.end = correlation_table(errors)
    if (
        isinstance(contact.law, TableLaw)
        and "file" in case.tables.get("table", {})
        and {*INPUTS_OF_SURFACES, "modulus"} & set(names)
    ):
        # The numbers of a file in SI units are those of the contact that it was measured with.
        rows = {"separation": contact.law.separation, "pressure": contact.law.pressure}
        edits.at["table", "file"] = [f"{key} = {[float(each) for each in values]}" for key, values in rows.items()]
    return edits


def _edited(text: str, edits: _Edits, folder: Path) -> list[str]:
    """Return the lines of a file after the edits; files that it names are found from anywhere."""
    table, lines = "", list[str]()
    for line in [*text.splitlines(), "[]"]:
        if head := _TABLE.fullmatch(line):
            lines += edits.added.get(table, [])
            table = head[1]
        whole = re.split(r"[.\s=]", (table or line).strip())[0].strip("'\"")  # a line before all tables may be one
        if whole in edits.removed and line.strip():
            lines.append(f"# before the fit: {line.strip()}")
            continue
        key = re.match(r"\s*(\w+)\s*=", line)
        new = edits.at.get((table, key[1])) if key else None
        if new is not None:
            lines += [f"# before the fit: {line.strip()}", *new]
        elif key and (table, key[1]) in FILES:
            lines.append(_found_from_anywhere(line, folder))
        else:
            lines.append(line)
    return lines[:-1] + edits.end


def _found_from_anywhere(line: str, folder: Path) -> str:
    """Return a line that names a file beside the case, with the whole path."""
    named = re.fullmatch(r"(\s*\w+\s*=\s*)(['\"])(.+?)\2(.*)", line)
    return line if named is None else f"{named[1]}{json.dumps(str((folder / named[3]).resolve()))}{named[4]}"


def _number(value: Any) -> float:
    """Return a number of a case file without its error."""
    if has_error(value):
        value, _ = split_error("poisson_ratio", value, "number", "0.5")
    return float(value)


def _comments(name: str, inputs: Sequence[FittedInput]) -> list[str]:
    values = ((each, "" if each.curve is None else f", value {each.texts[0]}") for each in inputs if each.name == name)
    return [f"# {each.label}: 95 % {each.texts[3]}{value}" for each, value in values]


def _entry_of(name: str, contact: Contact, errors: StandardErrors) -> str:
    _, key = _place(name)
    return _entry(key, getattr(contact, name), contact.INPUTS.rows[name].dimension, errors.get(name))


def _entry(key: str, value: float, dimension: str, error: float | None = None) -> str:
    text = format_si(value, dimension, DIGITS)
    if error is not None:
        return f'{key} = "{text} +- {100 * error:.4g} %"'
    return f"{key} = {text}" if dimension == "number" else f'{key} = "{text}"'


def _place(name: str) -> tuple[str, str]:
    """Return the table and the key under which a case file has an input."""
    row = PART_INPUTS.get(name)
    return ("contact", name) if row is None else (row.table, row.name)
