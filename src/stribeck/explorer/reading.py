"""Files that the browser sends: a case, measured curves or a surface."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from stribeck.contacts.contact import Contact
from stribeck.explorer.downloads import read_case
from stribeck.explorer.inputs.inputs import from_case
from stribeck.explorer.inputs.url import check_length
from stribeck.explorer.measured import headers_of, read_measured
from stribeck.explorer.scans import read_scan
from stribeck.quantities.units import InputError

Kind = Literal["case", "measured", "scan", "headers"]


def read_file(kind: Kind, name: str, content: bytes, contact: Contact, asked: Mapping[str, Any] | None = None) -> Any:
    """Return what a file holds; of measured curves a table ``[fit]`` may say what the columns are."""
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
