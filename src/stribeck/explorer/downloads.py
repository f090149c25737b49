"""Files of the page: cases and measured curves in; pictures, data and the case that reproduces them out."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from stribeck.cases.case import Case, check_case, parse_toml
from stribeck.contacts.friction import DEFINITIONS
from stribeck.explorer.answer import Answer
from stribeck.explorer.carried import law_words, toml_text
from stribeck.explorer.curves import Curve
from stribeck.explorer.inputs import FIELDS, Inputs, exact_text
from stribeck.explorer.measured import Measured
from stribeck.quantities.units import InputError, show

__all__ = ["KINDS", "View", "case_text", "content", "name_of", "pin_name", "read_case", "shown_name"]

LONGEST_NAME = 80

KINDS = {
    "Picture (PNG)": "png",
    "Picture (SVG)": "svg",
    "Curves (CSV)": "csv",
    "Gap and pressure (CSV)": "profile.csv",
    "Case file of this state (TOML)": "toml",
}
"""What can be downloaded: label and ending."""


@dataclass(frozen=True, eq=False)
class View:
    """What a tab shows.

    Attributes
    ----------
    answer : Answer
        The answer to its inputs.
    pins : sequence of (str, Curve, float)
        Pinned curves: name, curve, Hersey number at 1 m/s.
    measured : tuple of Measured
        Measured curves.
    """

    answer: Answer
    pins: Sequence[tuple[str, Curve, float]] = ()
    measured: tuple[Measured, ...] = ()


def read_case(name: str, content: bytes) -> Case:
    """Return a case from the content of its file.

    Parameters
    ----------
    name : str
        Name of the file, for sentences.
    content : bytes
        Its content.

    Returns
    -------
    Case
        The case.

    Raises
    ------
    InputError
        As :func:`stribeck.load_case`; or if the case names a file, which a page cannot read.
    """
    path = Path(shown_name(name))
    tables = parse_toml(content, path)
    for table, key in (("surface", "spectrum"), ("table", "file")):
        entries = tables.get(table)
        if isinstance(entries, dict) and key in entries:
            raise InputError(
                f"{path}: [{table}] {key} = {show(entries[key])} is a file that the browser did not send; "
                f"start with 'stribeck explore {path}', or write its rows into the case."
            )
    return check_case(tables, path)


def shown_name(name: str) -> str:
    """Return the name of a file as sentences and legends show it: its last part, in one line, at most 80 characters."""
    last = name.replace("\\", "/").rstrip("/").rpartition("/")[2]
    plain = "".join(sign if sign.isprintable() else "_" for sign in last).strip()
    plain = "file" if plain in ("", ".", "..") else plain
    return plain if len(plain) <= LONGEST_NAME else f"{plain[: LONGEST_NAME - 20]}...{plain[-17:]}"


def name_of(kind: str, title: str) -> str:
    """Return the name of a file: the headline in plain letters, and the ending."""
    stem = re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")[:40] or "stribeck"
    return f"{stem}.{kind}" if kind != "profile.csv" else f"{stem}-profile.csv"


def pin_name(inputs: Inputs, start: Inputs, taken: Sequence[str]) -> str:
    """Return what a pinned curve is called: the inputs in which it differs from those at the start."""
    changed = [
        f"{FIELDS[name].label.lower()} {exact_text(inputs, name).replace('*', '·')}"
        for name in FIELDS
        if name != "speed" and getattr(inputs.contact, name) != getattr(start.contact, name)
    ]
    name = ", ".join(changed[:3]) or "start"
    if inputs.definition != start.definition:
        name += f", {inputs.definition}"
    number = 2
    unique = name
    while unique in taken:
        unique, number = f"{name} ({number})", number + 1
    return unique


def content(kind: str, shown: View) -> bytes:
    """Return the content of a file of what is shown.

    Parameters
    ----------
    kind : str
        One of the endings of :data:`KINDS`.
    shown : View
        What is shown.

    Returns
    -------
    bytes
        The content.

    Raises
    ------
    MissingExtraError
        If a picture is wanted and matplotlib is not installed.
    """
    if kind in ("png", "svg"):
        from stribeck.explorer.charts.picture import picture

        return picture(shown, kind)
    text = {"toml": case_text, "csv": curves_text, "profile.csv": profile_text}[kind]
    return text(shown).encode()


def case_text(shown: View) -> str:
    """Return the case file that holds what is shown, and all that the page carries along."""
    inputs, curve = shown.answer.inputs, shown.answer.curve
    law = json.loads(inputs.law) if inputs.law else {}
    rest = json.loads(inputs.rest) if inputs.rest else {}
    contact: dict[str, Any] = {}
    for name, field in FIELDS.items():
        text = exact_text(inputs, name)
        contact[name] = text if field.units else float(text)
    if "law" in law:
        contact["law"] = law["law"]
    tables: dict[str, Any] = {"title": inputs.title} if inputs.title else {}
    tables |= {"notes": rest["notes"]} if "notes" in rest else {}
    tables["contact"] = contact
    if "surface" in law:
        tables["surface"] = {"shape_only": True, **law["surface"]}  # alpha, beta and roughness stand in [contact]
    tables |= {"table": law["table"]} if "table" in law else {}
    if "curve" in rest:
        tables["curve"] = rest["curve"]
    elif curve is not None and not curve.stale:
        ends = [float(curve.speed[0]), float(curve.speed[-1])]
        tables["curve"] = {"over": "speed", "range": ends, "points": len(curve.speed)}
    tables["solver"] = {"rtol": inputs.rtol, "definition": inputs.definition}
    tables |= {"fit": rest["fit"]} if "fit" in rest else {}
    return toml_text(tables)


def curves_text(shown: View) -> str:
    """Return the curve, the pinned and the measured ones as CSV, one below the other."""
    inputs = shown.answer.inputs
    hersey = inputs.contact.viscosity / inputs.contact.load
    curve = shown.answer.curve
    curves = [] if curve is None or curve.stale else [(inputs.title or "present", curve, hersey)]
    file = io.StringIO()
    file.write(_head(shown))
    for name, found, _ in (*curves, *shown.pins):
        file.write(f"# {name}: {found.source}\n")
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(
        [
            "curve",
            "speed [m/s]",
            "hersey_number [1]",
            *(f"friction_{name} [1]" for name in DEFINITIONS),
            "friction_contact [1]",
            "friction_measured [1]",
        ]
    )
    for name, found, factor in (*curves, *shown.pins):
        columns = (found.speed, found.speed * factor, *(found.friction[name] for name in DEFINITIONS), found.contact)
        writer.writerows([name, *map(float, row), ""] for row in zip(*columns, strict=True))
    for each in shown.measured:
        rows = zip(each.speed, each.speed * hersey, each.friction, strict=True)
        writer.writerows([f"measured: {each.name}", float(speed), float(h), "", "", "", float(mu)] for speed, h, mu in rows)
    return file.getvalue()


def profile_text(shown: View) -> str:
    """Return gap and pressures along the contact as CSV."""
    scales, profile = shown.answer.inputs.contact.hertz, shown.answer.profile
    file = io.StringIO()
    file.write(_head(shown))
    file.write("# fields between the nodes of the solution are good to about 1e-4\n")
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["position [m]", "gap [m]", "contact_pressure [Pa]", "fluid_pressure [Pa]"])
    columns = (
        profile.x * scales.half_width,
        profile.gap * scales.indentation,
        profile.contact_pressure * scales.pressure,
        profile.fluid_pressure * scales.pressure,
    )
    writer.writerows(map(float, row) for row in zip(*columns, strict=True))
    return file.getvalue()


def _head(shown: View) -> str:
    inputs, solution = shown.answer.inputs, shown.answer.solution
    lines = [
        f"title: {inputs.title}",
        f"source: stribeck {version('stribeck')}",
        *(f"{name}: {exact_text(inputs, name)}" for name in FIELDS),
        f"contact law: {law_words(inputs.law)}",
        f"definition: {inputs.definition}",
        f"state: rtol {solution.rtol:g}, estimated error {solution.error_estimate:.1e}",
        *(f"note: {note}" for note in solution.notes),
    ]
    return "".join(f"# {' '.join(line.split())}\n" for line in lines)
