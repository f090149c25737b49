"""Measured surfaces on the page: a file of heights becomes the roughness and Persson's law of the contact."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from stribeck.cases.law import SOURCES, law_of_file
from stribeck.contacts.contact import Contact
from stribeck.explorer.downloads import read_case, shown_name
from stribeck.explorer.inputs.inputs import Inputs, from_case
from stribeck.explorer.inputs.url import check_length
from stribeck.explorer.measured import headers_of, lent_file, read_measured
from stribeck.quantities.formats import format_si
from stribeck.quantities.units import InputError
from stribeck.surfaces.analysis import analyse
from stribeck.surfaces.case_table import surface_table
from stribeck.surfaces.files import read_topography

# Endings of files that hold heights and nothing else; text may also hold measured friction.
SCAN_ENDINGS = (".x3p", ".sur", ".pro", ".al3d", ".sdf", ".opd", ".plux", ".xyz")


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
    notes = f" {' '.join(surface.notes)}" if surface.notes else ""
    height = format_si(surface.roughness.h_rms, "length")
    limit = f"alpha {alpha.value:.3g} ({alpha.interval}), beta {beta.value:.3g} ({beta.interval}), at 95 %"
    report = f"Surface of {shown}: rms height {height}, {limit}.{notes}"
    return Scan(tomllib.loads(surface_table(surface, has_errors=False))["surface"], report.replace(str(path), shown))


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
    """Return what a file holds; of measured curves a table ``[fit]`` may say what the columns are."""
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
        if asked:
            raise
        try:
            return read_scan(name, content)
        except InputError as other:
            raise InputError(f"{problem} As a file of heights: {other}") from None
