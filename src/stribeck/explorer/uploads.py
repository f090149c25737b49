"""Files that the page is sent: cases, measured curves, read as fits read them, and surfaces.

A surface, a file of heights, becomes the roughness and Persson's law of the contact.
"""

import re
import tempfile
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path, PurePath
from typing import Any, Literal

from stribeck._types import Array
from stribeck.cases.case import Case
from stribeck.cases.fit_settings import DEFAULT_FREE, FREE_INPUTS, check_fit_table, settings_of
from stribeck.cases.law import SOURCES, law_of_file
from stribeck.cases.reading import check_case
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction_rules import RULES
from stribeck.explorer.curves import hersey_scale
from stribeck.explorer.inputs.inputs import Abscissa, Inputs, from_case, refuse_files
from stribeck.explorer.inputs.url import check_length
from stribeck.files.table_reading import read_table
from stribeck.files.toml import parse_toml
from stribeck.fits.columns import known_name
from stribeck.fits.fit import fit
from stribeck.fits.measurements import Measurements, read_measurements, reading_of
from stribeck.fits.result import Fit
from stribeck.fits.values import ABSCISSAS
from stribeck.quantities.formats import format_si
from stribeck.quantities.units import InputError, listed
from stribeck.surfaces.analysis import analyse
from stribeck.surfaces.files import read_topography
from stribeck.surfaces.several_scans import surface_table


@dataclass(frozen=True, eq=False)
class Measured:
    """A measured Stribeck curve."""

    name: str  # Name of its file, and of the curve where that holds several
    file: str  # Name of its file
    speed: Array  # Sliding speed in the contact that was shown when it was loaded, ascending [m/s]
    friction: Array  # Friction coefficient [-]
    source: Measurements  # All that its file holds
    made: Contact  # That contact, with the inputs that its file gives
    own: tuple[str, ...]  # Names of these inputs

    def places(self, contact: Contact, abscissa: Abscissa) -> Array:
        """Return the speeds at which its points are drawn: their own, or those of the contact with their Hersey number."""
        if contact.INPUTS.geometry != self.made.INPUTS.geometry:
            return self.speed
        measured = contact.replace(**{name: getattr(self.made, name) for name in self.own})
        now, then = (RULES[of.groups.geometry].speed_per(self.source.abscissa, of) for of in (measured, self.made))
        return self.speed * (
            now / then if abscissa == "speed" else now / then * hersey_scale(measured) / hersey_scale(contact)
        )


@dataclass(frozen=True)
class Fitted:
    """What a fit gave."""

    inputs: Inputs  # Those with the fitted values
    report: str  # The values, in a sentence
    found: Fit  # The values with their intervals, the residuals and what is to be known of them

    @property
    def shown(self) -> dict[str, Any]:
        """What the page shows of it."""
        rows, found = self.inputs.table.rows, self.found
        inputs = [
            [each.label.replace(each.name, rows[each.name].label), *(each.texts[k] for k in (0, 1, 3))]
            for each in found.inputs
        ]
        return {"rows": inputs, "said": found.outcome.value, "notes": [*found.quality.messages, *found.notes]}


# What a column of a file may be.
MEANINGS = (*ABSCISSAS, "entrainment_speed", "friction", "friction_force", "normal_force", "error", "curve")


def free_inputs(now: Inputs) -> list[tuple[str, str, bool]]:
    """Return the inputs that a fit may free, with their labels, and whether ``[fit]`` or the default frees them."""
    chosen = now.tables.get("fit", {}).get("free", DEFAULT_FREE)
    return [(name, now.fields[name].label, name in chosen) for name in FREE_INPUTS if name in now.fields]


def reading(measured: Measured) -> str:
    """Return how a file was read and what was left out or assumed, in sentences, as the commands say it."""
    return " ".join([reading_of(measured.source), *measured.source.notes])


def reading_for_fit(now: Inputs, measured: Measured) -> str:
    """Return how a file was read, and what of ``[fit]`` the page does not fit, in sentences."""
    left = [name for name in now.case.fit.free if name not in now.fields]
    by_command = f" The page does not fit {listed(left)}, free in [fit]; stribeck fit does." if left else ""
    return reading(measured) + by_command


def fit_measured(now: Inputs, measured: Measured, on_step: Callable[..., object], free: Sequence[str] = ()) -> Fitted:
    """Fit inputs to the measured curves of a file as the command does: those named, or of the case, or the usual ones."""
    # On the page a surface gives its shape alone; its roughness scales it nevertheless, as where it gives its numbers too.
    settings = replace(now.case.fit, scales_surface="surface" in now.tables)
    found = fit(measured.source, replace(now.case, fit=settings), free=free or None, on_step=on_step)
    values = {each.name: float(getattr(found.contact, each.name)) for each in found.inputs if each.name in now.fields}
    entries = {"beta": found.contact.beta} | values if found.contact.beta != now.contact.beta else values
    after = now.edited(entries, errors=found.errors)
    fitted = ", ".join(f"{now.fields[name].label.lower()} {now.table.text(name, value, 3)}" for name, value in values.items())
    curves = len(measured.source.curves)
    number = "both" if curves == 2 else f"all {curves}"
    target = measured.name if curves == 1 else f"{number} curves of {measured.file}"
    return Fitted(after, f"Fitted to {target}: {fitted}. Undo brings back the values before.", found)


@contextmanager
def lent_file(name: str, content: bytes) -> Iterator[Path]:
    """Lend a file with a content, never under the name that came with it but in sentences."""
    with tempfile.TemporaryDirectory(prefix="stribeck-") as folder:
        path = Path(folder) / f"file{PurePath(name).suffix}"
        path.write_bytes(content)
        try:
            yield path
        except InputError as problem:
            raise InputError(_with_own_name(str(problem), path, name)) from None


def _with_own_name(text: str, path: Path, name: str) -> str:
    """Return sentences with the name that a file came with in the place of its path, or of its own name alone."""
    return re.sub(rf"{re.escape(str(path))}|\b{re.escape(path.name)}", lambda _: name, text)


def headers_of(name: str, content: bytes) -> list[str]:
    """Return the names of the columns of a file."""
    with lent_file(name, content) as path:
        return list(read_table(path, knows=known_name).written)


def read_measured(name: str, content: bytes, contact: Contact, asked: Mapping[str, Any] | None = None) -> list[Measured]:
    r"""Return the measured curves of a file, over the speed; a table ``[fit]`` may say what its columns are, and more.

    .. math:: U = \frac{(\eta U)}{\eta}, \qquad U = \mathrm{Hs} \, \frac{F_N}{\eta},
              \qquad U = \mathrm{Hs} \, \frac{F_N}{\eta R} \text{ of a ball}
    """
    settings = settings_of(contact)
    table = {name: each for name, each in (asked or {}).items() if name not in ("files", "file_names")}  # of several files
    settings = replace(check_fit_table(table, settings.geometry), slide_to_roll=settings.slide_to_roll)
    with lent_file(name, content) as path:
        data = read_measurements(path, settings)
    found, rule = [], RULES[contact.groups.geometry]
    for k, (curve, inputs) in enumerate(zip(data.curves, data.inputs, strict=True)):
        given = {each: value for each, value in inputs.items() if each in rule.hersey_exponents}
        made = contact.replace(**given)
        factor = rule.speed_per(data.abscissa, made)
        mine = data.curve == k
        label = name if len(data.curves) == 1 else f"{name}: {curve}"
        found.append(Measured(label, name, data.values[mine] * factor, data.friction[mine], data, made, tuple(given)))
    return found


# Endings of files that hold heights and nothing else; text may also hold measured friction.
SCAN_ENDINGS = (".x3p", ".sur", ".pro", ".al3d", ".sdf", ".opd", ".plux", ".xyz")


MAX_NAME_LENGTH = 80  # Letters of the name of a file, as sentences and legends show it.


def shown_name(name: str) -> str:
    """Return the name of a file as sentences and legends show it: its last part, in one line, at most 80 characters."""
    last = name.replace("\\", "/").rstrip("/").rpartition("/")[2]
    plain = "".join(sign if sign.isprintable() else "_" for sign in last).strip()
    plain = "file" if plain in ("", ".", "..") else plain
    return plain if len(plain) <= MAX_NAME_LENGTH else f"{plain[: MAX_NAME_LENGTH - 20]}...{plain[-17:]}"


def read_case(name: str, content: bytes) -> Case:
    """Return a case from the content of its file."""
    path = Path(shown_name(name))
    tables = parse_toml(content, path)
    try:
        refuse_files(tables, f"start with 'stribeck explore {path}', or write its rows into the case")
    except InputError as problem:
        raise InputError(f"{path}: {problem}") from None
    return check_case(tables, path)


@dataclass(frozen=True)
class Scan:
    """A measured surface."""

    table: dict[str, Any]  # The table `[surface]` of a case
    report: str  # What was found, in a sentence


def read_scan(name: str, content: bytes) -> Scan:
    """Return the surface of a file of heights."""
    shown = shown_name(name)
    try:
        with lent_file(shown, content) as path:
            surface = analyse(read_topography(path))
    except InputError as problem:  # without advice on options of the command, which the page does not have
        raise InputError(re.sub(r"add --[^;]*?, or write it", "write it", str(problem))) from None
    alpha, beta = surface.limits
    notes = "".join(f" {_with_own_name(note, path, shown)}" for note in surface.notes)
    height = format_si(surface.roughness.h_rms, "length")
    limit = f"alpha {alpha.value:.3g} ({alpha.interval}), beta {beta.value:.3g} ({beta.interval}), at 95 %"
    report = f"Surface of {shown}: rms height {height}, {limit}.{notes}"
    return Scan(tomllib.loads(surface_table(surface, has_errors=False))["surface"], report)


def with_scan(now: Inputs, scan: Scan) -> Inputs:
    """Return the inputs on a measured surface: its roughness and Persson's law, with alpha and beta of its spectrum."""
    tables = {name: table for name, table in now.tables.items() if name not in SOURCES}
    tables["contact"] |= {"law": "persson"}
    tables["surface"] = scan.table | {"shape_only": True}
    _, found = law_of_file("persson", {}, {"surface": scan.table}, Path())
    roughness = now.table.quantities["roughness"].checked(scan.table["h_rms"])
    return now.edited({"roughness": roughness, "alpha": found["alpha"], "beta": found["beta"]}, tables)


Kind = Literal["case", "measured", "scan", "headers"]


def read_file(kind: Kind, name: str, content: bytes, contact: Contact, asked: Mapping[str, Any] | None = None) -> Any:
    """Return what a file holds; of measured curves a table ``[fit]`` may say how they are read."""
    name = shown_name(name)
    try:
        if kind == "case":
            found = from_case(read_case(name, content))
            check_length(found)
            return found
        if kind == "headers":
            return headers_of(name, content)
        return read_scan(name, content) if kind == "scan" else _of_text(name, content, contact, asked)
    except (MemoryError, RecursionError):
        raise InputError(f"{name} needs too much memory; send a smaller file.") from None


def _of_text(name: str, content: bytes, contact: Contact, asked: Mapping[str, Any] | None) -> Any:
    """Return the measured curves of a text file, or else the surface whose heights it holds."""
    try:
        return read_measured(name, content, contact, asked)
    except InputError as problem:
        try:
            return read_scan(name, content)
        except InputError as other:
            raise InputError(f"{problem} As a file of heights: {other}") from None
