"""Files of the page: cases and measured curves in; pictures, data and the case that reproduces them out."""

from __future__ import annotations

import csv
import functools
import io
import json
import re
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from stribeck.cases.case import Case
from stribeck.cases.reading import check_case
from stribeck.contacts.friction import DEFINITIONS
from stribeck.explorer.charts.picture import picture
from stribeck.explorer.curves import Report, hersey_scale
from stribeck.explorer.inputs.carried import model_changes, model_lines, tables_of, toml_text
from stribeck.explorer.inputs.inputs import Inputs, exact_text
from stribeck.explorer.view import View
from stribeck.files.toml import parse_toml
from stribeck.quantities.inputs import si_text
from stribeck.quantities.units import InputError, show

__all__ = ["KINDS", "case_text", "content", "examples", "name_of", "pin_name", "read_case", "shown_name"]

MAX_NAME_LENGTH = 80  # Letters of the name of a downloaded file.

KINDS = {
    "Picture of the curve (PNG)": "curve.png",
    "Picture of the curve (SVG)": "curve.svg",
    "Picture of the fields (PNG)": "state.png",
    "Picture of the fields (SVG)": "state.svg",
    "Curves (CSV)": "csv",
    "Gap and pressure (CSV)": "profile.csv",
    "Case file of this state (TOML)": "toml",
}
"""Downloads: label and ending."""


def read_case(name: str, content: bytes) -> Case:
    """Return a case from the content of its file."""
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


@functools.cache
def examples() -> dict[str, Path]:
    """Return the examples that come with the package, by their titles."""
    here = Path(__file__).parent / "examples"
    folder = here if here.is_dir() else Path(__file__).parents[3] / "examples"
    found = {}
    for path in sorted(folder.glob("*.toml")):
        tables = parse_toml(path.read_bytes(), path)
        if "contact" in tables and not {"fit", "vary"} & tables.keys():
            found[str(tables.get("title", path.stem))] = path
    return found


def shown_name(name: str) -> str:
    """Return the name of a file as sentences and legends show it: its last part, in one line, at most 80 characters."""
    last = name.replace("\\", "/").rstrip("/").rpartition("/")[2]
    plain = "".join(sign if sign.isprintable() else "_" for sign in last).strip()
    plain = "file" if plain in ("", ".", "..") else plain
    return plain if len(plain) <= MAX_NAME_LENGTH else f"{plain[: MAX_NAME_LENGTH - 20]}...{plain[-17:]}"


def name_of(kind: str, title: str) -> str:
    """Return the name of a file: the headline in plain letters, and the ending."""
    stem = re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")[:40] or "stribeck"
    return f"{stem}-{kind}" if "." in kind else f"{stem}.{kind}"


def pin_name(inputs: Inputs, start: Inputs, taken: Sequence[str]) -> str:
    """Return the name of a pinned curve: the inputs in which it differs from the start."""
    changed = [
        f"{shown.label.lower()} {_rounded_text(inputs, name)}"
        for name, shown in inputs.fields.items()
        if name != "speed" and getattr(inputs.contact, name) != getattr(start.contact, name, None)
    ]
    if inputs.model != start.model:
        changed = [*(f"{each}" for each in model_changes(inputs.model, start.model)), *changed]
    name = ", ".join(changed[:3]) or "start"
    if inputs.definition != start.definition:
        name += f", {inputs.definition}"
    number = 2
    unique = name
    while unique in taken:
        unique, number = f"{name} ({number})", number + 1
    return unique


def _rounded_text(inputs: Inputs, name: str) -> str:
    """Return an input as text with four digits: a fitted one has sixteen."""
    value = getattr(inputs.contact, name)
    return "none" if value is None else si_text(float(value), name, 4, inputs.table)


def content(kind: str, shown: View, go_on: Report = lambda part: None) -> bytes:
    """Return the content of a file of what is shown."""
    what, _, ending = kind.partition(".")
    if ending in ("png", "svg"):
        return picture(shown, what, ending, go_on)
    text = {"toml": case_text, "csv": curves_text, "profile.csv": profile_text}[kind]
    return text(shown).encode()


def case_text(shown: View) -> str:
    """Return the case file of the present state, with everything that the page keeps for it."""
    inputs, curve = shown.answer.inputs, shown.answer.curve
    model = tables_of(inputs.model)
    rest = json.loads(inputs.rest) if inputs.rest else {}
    errors = rest.pop("errors", {})
    contact: dict[str, Any] = {name: model.pop(name) for name in ("geometry", "law") if name in model}
    for name, field in inputs.fields.items():
        kept, of = ("entrainment_speed", 0.5) if name == "speed" and _rolls(inputs) else (name, 1.0)
        text = exact_text(inputs, name, of)
        if text:
            error = f" +- {100 * errors[name]!r} %" if name in errors else ""
            contact[kept] = f"{text}{error}" if field.units or error else float(text)
    tables: dict[str, Any] = {"title": inputs.title} if inputs.title else {}
    tables |= {"notes": rest.pop("notes")} if "notes" in rest else {}
    tables["contact"] = contact
    if "surface" in model:
        model["surface"] = {"shape_only": True, **model["surface"]}  # alpha, beta and roughness stand in [contact]
    tables |= model
    if "curve" not in rest and curve is not None and not curve.stale:
        ends = [float(curve.speed[0]), float(curve.speed[-1])]
        tables["curve"] = {"over": "speed", "range": ends, "points": len(curve.speed)}
    return toml_text(tables | rest | {"solver": {"rtol": inputs.rtol, "definition": inputs.definition}})


def _rolls(inputs: Inputs) -> bool:
    """Return whether a case gives the speed as the mean of both surfaces: a ball and a disc that both move."""
    return inputs.table.geometry == "point" and inputs.contact.slide_to_roll != 2


def curves_text(shown: View) -> str:
    """Return the curve, the pinned and the measured ones as CSV, one below the other."""
    inputs = shown.answer.inputs
    hersey = hersey_scale(inputs.contact)
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
        rows = zip(each.speed, each.places(inputs.contact, "hersey") * hersey, each.friction, strict=True)
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
        *(f"{name}: {text}" for name in inputs.fields if (text := exact_text(inputs, name))),
        *model_lines(inputs.model),
        f"definition: {inputs.definition}",
        f"state: rtol {solution.rtol:g}, estimated error {solution.error_estimate:.1e}",
        *(f"note: {note}" for note in solution.notes),
    ]
    return "".join(f"# {' '.join(line.split())}\n" for line in lines)
