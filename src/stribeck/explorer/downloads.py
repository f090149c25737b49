"""Files of the page: cases and measured curves in; pictures, data and the case that reproduces them out."""

from __future__ import annotations

import csv
import io
import json
import re
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from stribeck.cases.case import Case, load_case
from stribeck.contacts.friction import DEFINITIONS
from stribeck.explorer.answer import Answer
from stribeck.explorer.curves import Curve
from stribeck.explorer.inputs import FIELDS, Inputs, exact_text
from stribeck.explorer.measured import Measured
from stribeck.quantities.units import InputError

__all__ = ["KINDS", "Shown", "case_text", "content", "name_of", "pin_name", "read_case"]

KINDS = {
    "Picture (PNG)": "png",
    "Picture (SVG)": "svg",
    "Curves (CSV)": "csv",
    "Gap and pressure (CSV)": "profile.csv",
    "Case that reproduces it (TOML)": "toml",
}
"""What can be downloaded: label and ending."""


@dataclass(frozen=True, eq=False)
class Shown:
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
    """Return a case from the content of its file; sentences about it name the file alone."""
    plain = re.sub(r"[^\w.+-]", "_", Path(name).name)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / plain
        path.write_bytes(content)
        try:
            return load_case(path)
        except InputError as problem:
            raise InputError(str(problem).replace(str(path), name)) from None


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


def content(kind: str, shown: Shown) -> bytes:
    """Return the content of a file of what is shown.

    Parameters
    ----------
    kind : str
        One of the endings of :data:`KINDS`.
    shown : Shown
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


def case_text(shown: Shown) -> str:
    """Return the case file with exactly the inputs that are shown."""
    inputs, curve = shown.answer.inputs, shown.answer.curve
    lines = [f"title = {json.dumps(inputs.title, ensure_ascii=False)}"] if inputs.title else []
    lines.append("\n[contact]")
    for name, field in FIELDS.items():
        text = exact_text(inputs, name)
        lines.append(f'{name} = "{text}"' if field.units else f"{name} = {float(text)!r}")
    if curve is not None and not curve.stale:
        ends = float(curve.speed[0]), float(curve.speed[-1])
        lines += ["\n[curve]", 'over = "speed"', f"range = [{ends[0]!r}, {ends[1]!r}]  # m/s", f"points = {len(curve.speed)}"]
    lines += ["\n[solver]", f"rtol = {shown.answer.solution.rtol!r}", f'definition = "{inputs.definition}"']
    return "\n".join(lines).lstrip() + "\n"


def curves_text(shown: Shown) -> str:
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
        ]
    )
    for name, found, factor in (*curves, *shown.pins):
        columns = (found.speed, found.speed * factor, *(found.friction[name] for name in DEFINITIONS), found.contact)
        writer.writerows([name, *map(float, row)] for row in zip(*columns, strict=True))
    for each in shown.measured:
        rows = zip(each.speed, each.speed * hersey, each.friction, strict=True)
        writer.writerows([f"measured: {each.name}", float(speed), float(h), float(mu), "", ""] for speed, h, mu in rows)
    return file.getvalue()


def profile_text(shown: Shown) -> str:
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


def _head(shown: Shown) -> str:
    inputs, solution = shown.answer.inputs, shown.answer.solution
    lines = [
        f"title: {inputs.title}",
        f"source: stribeck {version('stribeck')}",
        *(f"{name}: {exact_text(inputs, name)}" for name in FIELDS),
        f"definition: {inputs.definition}",
        f"state: rtol {solution.rtol:g}, estimated error {solution.error_estimate:.1e}",
        *(f"note: {note}" for note in solution.notes),
    ]
    return "".join(f"# {line}\n" for line in lines)
