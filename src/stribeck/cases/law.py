"""The contact law of a case or sweep file: from its name and the tables that describe the surface."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.cases.rough_surface import RoughSurface
from stribeck.contact_laws.exponential import SpectralExponential
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contact_laws.persson import GAMMA, PerssonLaw, persson_law
from stribeck.contact_laws.scaled import NAMED_LAWS, named_law
from stribeck.contact_laws.spectrum import Spectrum
from stribeck.contact_laws.table import TableLaw
from stribeck.files.text_table import read_two_columns
from stribeck.quantities.schema import numbers_of
from stribeck.quantities.units import InputError, show

__all__ = [
    "ASPERITY_KEYS",
    "INPUTS_OF_SURFACES",
    "LAWS",
    "SURFACE_KEYS",
    "TABLE_KEYS",
    "FIRST_TABLE_BY_LAW",
    "Law",
    "LawOfFile",
    "law_of_file",
    "self_contained",
]

Law = str
"""Name of a contact law in a file."""

LAWS: tuple[Law, ...] = tuple(dict.fromkeys(("exponential", "persson", *NAMED_LAWS, "table")))

SURFACE_KEYS = (
    "h_rms",
    "hurst",
    "q0",
    "q1",
    "roll_off",
    "longest_wavelength",
    "shortest_wavelength",
    "roll_off_wavelength",
    "gamma",
    "spectrum",
    "wavenumber",
    "density",
    "shape_only",
)

# The key that names a file in a table, and the two lists of numbers that may stand in its place.
FILE_KEYS = {"surface": ("spectrum", ("wavenumber", "density")), "table": ("file", ("separation", "pressure"))}

COEFFICIENT_KEYS = ("density", "radius", "deviation")  # Of a surface from which a law makes alpha, beta and roughness

# Keys of the table [asperities]: the surface of a law of asperities, or the numbers of another law.
ASPERITY_KEYS = (*COEFFICIENT_KEYS, *dict.fromkeys(key for law in NAMED_LAWS.values() for key in numbers_of(law)))

TABLE_KEYS = ("file", "separation", "pressure")

INPUTS_OF_SURFACES = ("alpha", "beta", "roughness")  # Inputs of a contact that follow from a table of its surface

NEEDED_TABLE: dict[Law, str] = {"persson": "surface", "table": "table"}
TABLES_BY_LAW: dict[Law, tuple[str, ...]] = {
    **dict.fromkeys(NAMED_LAWS, ("asperities",)),
    "exponential": ("surface",),
    "persson": ("surface",),
    "table": ("table",),
}

# The table that each law may come from, where there is one.
FIRST_TABLE_BY_LAW: dict[Law, str] = {law: names[0] for law, names in TABLES_BY_LAW.items() if names}


@dataclass(frozen=True)
class LawOfFile:
    """A contact law, and what its tables say of alpha, beta and roughness; these are empty where the file gives them."""

    shape: AsperityLaw | None
    coefficients: dict[str, float]


def law_of_file(law: Law, contact: dict[str, Any], tables: dict[str, dict[str, Any] | None], folder: Path) -> LawOfFile:
    """Return the contact law of a file."""
    given = {
        name: {k: v for k, v in entries.items() if v is not None} for name, entries in tables.items() if entries is not None
    }
    for name in given:
        if name not in TABLES_BY_LAW[law]:
            users = " and ".join(repr(other) for other in LAWS if name in TABLES_BY_LAW[other])
            raise InputError(f"the table [{name}] is not used by law = {show(law)}; it belongs to {users}.")
    needed = NEEDED_TABLE.get(law)
    if needed is not None and needed not in given:
        keys = {"surface": "h_rms, hurst, q0 and q1", "table": "file"}[needed]
        raise InputError(f"the table [{needed}] is missing, which law = {show(law)} needs; give {keys} there.")
    if law == "table":
        return LawOfFile(_table(given["table"], contact, folder), {})
    if not given:
        return LawOfFile(named_law(law), {})
    (name,) = given
    if name == "asperities" and not hasattr(NAMED_LAWS[law], "coefficients"):  # numbers of the law, not of the surface
        try:
            return LawOfFile(named_law(law, **given[name]), {})
        except InputError as problem:
            raise InputError(f"[{name}] {problem}") from None
    shape_only = given[name].pop("shape_only", False)
    if not isinstance(shape_only, bool):
        raise InputError(f"[{name}] shape_only = {show(shape_only)} must be true or false, without quotes.")
    doubled = [] if shape_only else [key for key in INPUTS_OF_SURFACES if contact.get(key) is not None]
    if doubled:
        raise InputError(
            f"[contact] {doubled[0]} = {contact[doubled[0]]:g} follows from the table [{name}]; remove one of them."
        )
    try:
        found = _of_asperities(law, given[name]) if name == "asperities" else _of_surface(law, given[name], folder)
    except InputError as problem:
        raise InputError(f"[{name}] {problem}") from None
    return LawOfFile(found.shape, {}) if shape_only else found


def self_contained(law: Law, tables: dict[str, Any], folder: Path, shape: AsperityLaw | None) -> dict[str, Any]:
    """Return the table of a contact law with the numbers of the file that it names in the place of the name."""
    if law == "table":
        assert isinstance(shape, TableLaw)
        return {"table": {"separation": list(shape.separation), "pressure": list(shape.pressure)}}
    if tables.get("surface") is None:
        return {}
    entries = {key: value for key, value in tables["surface"].items() if key != "shape_only"}
    if "spectrum" in entries:
        rows, units = _rows_of_spectrum(folder / entries.pop("spectrum"))
        entries |= {"wavenumber": (rows[:, 0] * units[0]).tolist(), "density": (rows[:, 1] * units[1]).tolist()}
    return {"surface": entries}


def _of_surface(law: Law, entries: dict[str, Any], folder: Path) -> LawOfFile:
    if any(key in entries for key in ("spectrum", "wavenumber", "density")):
        full = _of_spectrum(entries, folder)
    else:
        for name in ("h_rms", "hurst"):
            if name not in entries:
                raise InputError(f"{name} is missing; add {name} = {'0.8' if name == 'hurst' else repr('1 um')}.")
        full = RoughSurface(**entries).law
    if law == "persson":
        return LawOfFile(full, full.coefficients)
    return LawOfFile(SpectralExponential(full.area_slope), full.coefficients)


def _of_spectrum(entries: dict[str, Any], folder: Path) -> PerssonLaw:
    extra = [name for name in entries if name not in ("spectrum", "wavenumber", "density", "gamma")]
    if extra:
        source = "the file of the spectrum" if "spectrum" in entries else "the spectrum"
        raise InputError(f"{extra[0]} = {show(entries[extra[0]])} follows from {source}; remove one of them.")
    gamma = entries.get("gamma", GAMMA)
    if "spectrum" not in entries:
        wavenumber, density = _lists("surface", entries)
        return persson_law(Spectrum(wavenumber, density), gamma)
    path = _file_of("surface", entries, folder)
    rows, units = _rows_of_spectrum(path)
    try:
        return persson_law(Spectrum(rows[:, 0] * units[0], rows[:, 1] * units[1]), gamma)
    except InputError as problem:
        raise InputError(f"{path}: {problem}") from None


def _rows_of_spectrum(path: Path) -> tuple[Array, tuple[float, float]]:
    """Return the rows of the file of a spectrum and the SI values of their units."""
    rows, units = read_two_columns(path, None, {"wavenumber": "wavenumber", "density": "spectral density"})
    assert units is not None
    return rows, units


def _file_of(table: str, entries: dict[str, Any], folder: Path) -> Path:
    """Return the path of the file that a table names; refuse lists of numbers beside it."""
    key, lists = FILE_KEYS[table]
    doubled = [name for name in lists if name in entries]
    if doubled:
        raise InputError(f"{key} = {show(entries[key])} and {doubled[0]} are both given; remove one of them.")
    if not isinstance(entries[key], str):
        raise InputError(f"{key} = {show(entries[key])} must be text in quotes, the name of a CSV file.")
    return folder / str(entries[key])


def _lists(table: str, entries: dict[str, Any]) -> list[Array]:
    """Return the two lists of numbers of a table."""
    found = []
    for name in FILE_KEYS[table][1]:
        values = entries.get(name)
        if values is None:
            raise InputError(f"{name} is missing; add as many numbers as the other list has.")
        numbers = isinstance(values, list) and all(
            isinstance(each, int | float) and not isinstance(each, bool) for each in values
        )
        if not numbers:
            raise InputError(f"{name} = {show(values)} must be a list of numbers, without quotes.")
        found.append(np.array(values, dtype=float))
    if len(found[0]) != len(found[1]):
        first, second = FILE_KEYS[table][1]
        raise InputError(f"{first} has {len(found[0])} numbers and {second} {len(found[1])}; they must have the same length.")
    return found


def _of_asperities(law: Law, entries: dict[str, Any]) -> LawOfFile:
    examples = {"density": "1e10 m^-2", "radius": "10 um", "deviation": "1 um"}
    for name in COEFFICIENT_KEYS:
        if name not in entries:
            raise InputError(f"{name} is missing; add {name} = {show(examples[name])}.")
    return LawOfFile(named_law(law), NAMED_LAWS[law].coefficients(**entries))


def _table(entries: dict[str, Any], contact: dict[str, Any], folder: Path) -> TableLaw:
    if not entries:
        raise InputError(
            "[table] file is missing; add the name of a CSV file with a column of separations and one of pressures."
        )
    needed = {key: contact.get(key) for key in ("alpha", "beta", "roughness", "modulus")}
    E, nu = contact.get("youngs_modulus"), contact.get("poisson_ratio")
    if needed["modulus"] is None and E is not None and nu is not None:
        needed["modulus"] = E / (1 - nu * nu)
    try:
        if "file" not in entries:
            separation, pressure = _lists("table", entries)
            return TableLaw(separation, pressure)
        path = _file_of("table", entries, folder)
    except InputError as problem:
        raise InputError(f"[table] {problem}") from None
    return TableLaw.read(path, **needed)
