"""The case file of a fit: read before it, and written after it with the fitted values and where they come from."""

from __future__ import annotations

import math
import os
import re
from importlib.metadata import version
from pathlib import Path
from typing import Any

from stribeck.cases.case import Case
from stribeck.cases.reading import load_case
from stribeck.contacts.line import InputError
from stribeck.files.toml import read_toml
from stribeck.files.writing import PathLike, atomic_write
from stribeck.fits.result import Fit, FittedInput
from stribeck.quantities.formats import format_si
from stribeck.quantities.part_inputs import PART_INPUTS, fitted_rows

__all__ = ["format_interval", "format_value", "load_fit_case", "write_fitted_case"]

DIGITS = 10
"""Digits of the values in the file, enough to solve the same state again."""

AGREEMENT = 1e-8
"""Relative difference that rounding to these digits may leave."""

_TABLE = re.compile(r"\s*\[+\s*([^\]]*?)\s*\]+\s*(?:#.*)?")


def load_fit_case(data: object, path: PathLike) -> Case:
    """Read the case file of a fit; say so if it and the data were swapped.

    Parameters
    ----------
    data : object
        What was given as data: the path of a file, or measurements.
    path : str or path-like
        The case file.

    Returns
    -------
    Case
        The checked case.

    Raises
    ------
    InputError
        As :func:`stribeck.load_case`; or if the data are a case file and the case file is none.
    """
    if isinstance(data, str | os.PathLike) and "contact" in _tables(data) and not _tables(path) and Path(path).is_file():
        raise InputError(
            f"{data} and {path} look swapped: {data} is a case file and {path} is not. "
            f"Measured friction comes first, then the case: {path} {data}."
        )
    return load_case(path)


def _tables(path: PathLike) -> dict[str, Any]:
    """Return the tables of a TOML file; none if it is not one."""
    try:
        return read_toml(Path(path))
    except InputError:
        return {}


def write_fitted_case(fit: Fit, case: Case, path: PathLike, *, force: bool = False) -> None:
    """Write the case of a fit with the fitted values, everything else as it was.

    Parameters
    ----------
    fit : Fit
        The fit, converged.
    case : Case
        The case that it began from.
    path : str or path-like
        File to write, ending in ``.toml``.
    force : bool
        Whether an existing file is replaced.

    Raises
    ------
    InputError
        If the fit did not converge, the file cannot be written, or the case is written in a way that hides its values.
    """
    if not fit.converged:
        raise InputError(f"no fitted case is written. {fit.outcome.value}")
    text = case.path.read_text(encoding="utf-8-sig")
    with atomic_write(path, (".toml",), force=force) as temporary:
        temporary.write_text(_fitted_text(text, fit), encoding="utf-8")
        try:
            back = load_case(temporary).contact
        except InputError as problem:
            raise InputError(str(problem).replace(str(temporary), str(path))) from None
        for name in fitted_rows(fit.contact.INPUTS):
            kept = getattr(back, name, None)
            if kept is not None and not math.isclose(kept, getattr(fit.contact, name), rel_tol=AGREEMENT):
                table, key = _place(name)
                raise InputError(
                    f"{path} cannot be written, as {case.path} does not have {key} on a line of its own in [{table}]; "
                    "write it there."
                )


def _fitted_text(text: str, fit: Fit) -> str:
    values = {each.name: getattr(fit.contact, each.name, None) for each in fit.inputs}
    new = {name: value for name, value in values.items() if value is not None}
    names = {_place(name): name for name in new}
    table, lines = "", list[str]()
    written = set[str]()
    for line in text.splitlines():
        head = _TABLE.fullmatch(line)
        if head:
            if table == "contact":
                lines += _added(new, written, fit)
            table = head[1]
        key = re.match(r"\s*(\w+)\s*=", line)
        name = names.get((table, key[1]), key[1] if table == "contact" else "") if key else ""
        if name == "youngs_modulus" and "modulus" in new:
            youngs = fit.contact.modulus * (1 - _poisson(text) ** 2)
            lines += [
                f"# before the fit: {line.strip()}",
                *_comments("modulus", fit),
                f'{name} = "{format_si(youngs, "pressure", DIGITS)}"',
            ]
            written.add("modulus")
        elif name in new:
            lines += [f"# before the fit: {line.strip()}", *_comments(name, fit), _entry(name, new[name], fit)]
            written.add(name)
        else:
            lines.append(line)
    if table == "contact":
        lines += _added(new, written, fit)
    said = fit.quality.messages[0] if fit.quality.messages else "No systematic misfit detected in its residuals."
    about = [f"# Fitted by stribeck {version('stribeck')} to {Path(fit.data.path).name}. {fit.outcome.value} {said}"]
    return "\n".join([*about, *lines]) + "\n"


def _poisson(text: str) -> float:
    found = re.search(r"^\s*poisson_ratio\s*=\s*([0-9.eE+-]+)", text, re.MULTILINE)
    return float(found[1]) if found else 0.0


def _added(new: dict[str, float], written: set[str], fit: Fit) -> list[str]:
    """Return lines for inputs that the table did not have, as those of a surface."""
    lines = []
    for name, value in new.items():
        if name not in written and name not in PART_INPUTS:
            lines += [*_comments(name, fit), _entry(name, value, fit)]
            written.add(name)
    return lines


def _comments(name: str, fit: Fit) -> list[str]:
    return [
        f"# {each.label}: 95 % {format_interval(each, 0.95)}" + ("" if each.curve is None else f", value {format_value(each)}")
        for each in fit.inputs
        if each.name == name
    ]


def _entry(name: str, value: float, fit: Fit) -> str:
    dimension, (_, key) = fitted_rows(fit.contact.INPUTS)[name].dimension, _place(name)
    text = format_si(value, dimension, DIGITS)
    return f"{key} = {text}" if dimension == "number" else f'{key} = "{text}"'


def _place(name: str) -> tuple[str, str]:
    """Return the table and the key under which a case file has an input."""
    row = PART_INPUTS.get(name)
    return ("contact", name) if row is None else (row.table, row.key)


def format_value(each: FittedInput, value: float | None = None, digits: int = 4) -> str:
    """Return a value of a fitted input as short text with its unit.

    Parameters
    ----------
    each : FittedInput
        The input.
    value : float, optional
        Another value of it than the fitted one.
    digits : int
        Significant digits.

    Returns
    -------
    str
        The text.
    """
    value = each.value if value is None else value
    return f"{value:.{digits}g}" if each.is_factor else format_si(value, each.dimension, digits)


def format_interval(each: FittedInput, level: float) -> str:
    """Return an interval of a fitted input in words.

    Parameters
    ----------
    each : FittedInput
        The input.
    level : float
        0.68 or 0.95.

    Returns
    -------
    str
        Its ends, or which of them is open.
    """
    low, high = each.interval_68 if level < 0.9 else each.interval_95
    if low == 0 and math.isinf(high):
        return "open"
    if low == 0:
        return f"below {format_value(each, high)}"
    if math.isinf(high):
        return f"above {format_value(each, low)}"
    return f"{format_value(each, low)} to {format_value(each, high)}"
