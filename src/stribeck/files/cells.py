"""Cells of tables: what a header says, whether a cell is a number, and which."""

from __future__ import annotations

import csv
import re
from pathlib import Path

from stribeck.quantities.units import InputError

__all__ = ["MISSING", "cells_of", "header_words", "is_called", "number_of", "split_header"]

MISSING = frozenset({"", "-", "--", "---", "na", "n/a", "nan", "null", "none", "#n/a", "#nv", "nv", "?", "bad", "***"})
"""Cells that hold no value, in lower case."""

POINT = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?")
COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+(?:[eE][+-]?[0-9]{1,3})?")
WITH_UNIT = re.compile(r"([+-]?[0-9.,]+(?:[eE][+-]?[0-9]{1,3})?)\s*([A-Za-zµμ%°].*)")
_HEADER = re.compile(r"(.*?)\s*(?:\[(.*)\]|\((.*)\)|(?:\s/\s|\sin\s)(.*))\s*")


def split_header(header: str) -> tuple[str, str]:
    """Return the words of a header and its unit, as of ``speed [mm/s]`` or ``speed / mm/s``; empty where it has none."""
    parts = _HEADER.fullmatch(header)
    if parts is None or not parts[1]:
        return header.strip(), ""
    return parts[1].strip(), next(unit for unit in parts.groups()[1:] if unit is not None).strip()


def header_words(header: str) -> str:
    """Return the words of a header in lower case, without its unit and without signs."""
    return " ".join(re.sub(r"[^0-9a-zµμ]+", " ", split_header(header)[0].lower()).split())


def is_called(header: str, name: str) -> bool:
    """Return whether a name means a header, with or without its unit."""
    return name.strip() in (header, split_header(header)[0])


def number_of(cell: str, decimal: str = ".") -> tuple[float, str] | None:
    """Return the number that a cell holds and its own unit, or None; with ``decimal = ","`` points pass too."""
    text = cell.replace("\N{MINUS SIGN}", "-").strip()
    unit = ""
    bare = POINT.fullmatch(text) or COMMA.fullmatch(text)
    with_unit = None if bare else WITH_UNIT.fullmatch(text)
    if with_unit:
        text, unit = with_unit.groups()
    if decimal == "," and COMMA.fullmatch(text):
        text = text.replace(",", ".")
    return (float(text), unit) if POINT.fullmatch(text) else None


def cells_of(line: str, separator: str, path: Path, number: int) -> list[str]:
    """Return the cells of a line without quotes and white space around them; an empty ``separator`` is white space."""
    if separator and '"' not in line:
        return [cell.replace("\N{NO-BREAK SPACE}", " ").strip() for cell in line.split(separator)]
    if separator:
        try:
            [cells] = csv.reader([line], delimiter=separator, skipinitialspace=True, strict=True)
        except (csv.Error, ValueError) as problem:
            raise InputError(f"{path}: row {number} cannot be split into cells ({problem}); check its quotes.") from None
        return [cell.replace("\N{NO-BREAK SPACE}", " ").strip() for cell in cells]
    words = line.split()
    if not any(mark in line for mark in "[("):
        return words
    cells = []
    for word in words:
        # A unit in brackets belongs to the word before it.
        if cells and (word[0] in "[(" or cells[-1].count("[") > cells[-1].count("]")):
            cells[-1] += f" {word}"
        else:
            cells.append(word)
    return cells


def has_number(cell: str) -> bool:
    return any(sign.isdigit() for sign in cell) and number_of(cell, ",") is not None
