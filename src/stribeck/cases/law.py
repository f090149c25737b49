"""The contact law of a case or sweep file: from its name and the tables that describe the surface."""

import functools
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.cases.tables import AS_GIVEN, NUMBERS, TRUTH, Key, Keys, one_of
from stribeck.contact_laws.exponential import SpectralExponential
from stribeck.contact_laws.greenwood import SUMMITS
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contact_laws.persson import GAMMA, GAMMA_INPUT, persson_law
from stribeck.contact_laws.scaled import NAMED_LAWS, named_law
from stribeck.contact_laws.spectrum import SelfAffine, Spectrum
from stribeck.contact_laws.table import TableLaw
from stribeck.contacts.forms import Form
from stribeck.contacts.inputs import InputTable, read_inputs
from stribeck.quantities.schema import Input, numbers_of
from stribeck.quantities.units import InputError, show

Law = str
"""Name of a contact law in a file."""

ERRORS_OF_SURFACES = {"alpha_error": "alpha", "beta_error": "beta"}  # Keys of relative errors, and of what they are

Made = tuple[AsperityLaw | None, dict[str, float]]  # A contact law, and alpha, beta and roughness where its tables give them

INPUTS_OF_SURFACES = ("alpha", "beta", "roughness")  # Inputs of a contact that follow from a table of its surface


def _of_wavelength(of: str, which: str, typical: str, without: str = "") -> Form:
    """Return how a wave number follows from a wavelength."""
    name, label = f"{which.replace('-', '_')}_wavelength", f"{which} wavelength"
    length = Input(name=name, label=label, dimension="length", typical=typical, without=without)
    meaning = "" if without else f"the wave number of the {which} roughness"
    return Form(of=of, inputs=(length,), value=lambda wavelength: 2 * math.pi / wavelength, meaning=meaning)


# The numbers of a self-affine surface; each cut-off is given as a wave number or as a wavelength.
SURFACE = InputTable(
    SelfAffine,
    (
        _of_wavelength("q0", "longest", "150 um"),
        _of_wavelength("q1", "shortest", "1.5 um"),
        _of_wavelength("roll_off", "roll-off", "20 um", without="no roll-off"),
    ),
)


class Source(NamedTuple):
    """A table of a file from which contact laws are made; its keys are checked by what is made of them."""

    laws: tuple[Law, ...]  # The laws that may come from it
    keys: tuple[str, ...]
    make: Callable[[Law, dict[str, Any], dict[str, Any], Path], Made]  # Of the law, the table, the contact and the folder
    file: str = ""  # The key that names a file
    lists: tuple[str, ...] = ()  # The two lists of numbers that may stand in its place


def law_of_file(law: Law, contact: dict[str, Any], tables: dict[str, dict[str, Any]], folder: Path) -> Made:
    """Return the contact law of a file, and what its tables say of alpha, beta and roughness."""
    given = {name: dict(entries) for name, entries in tables.items()}
    for name in given:
        if law not in SOURCES[name].laws:
            users = " and ".join(map(repr, SOURCES[name].laws))
            raise InputError(f"the table [{name}] is not used by law = {show(law)}; it belongs to {users}.")
    needed = NEEDED_TABLE.get(law)
    if needed is not None and needed not in given:
        keys = {"surface": "h_rms, hurst, q0 and q1", "table": "file"}[needed]
        raise InputError(f"the table [{needed}] is missing, which law = {show(law)} needs; give {keys} there.")
    if not given:
        return named_law(law), {}
    [(name, entries)] = given.items()
    try:
        shape_only = TRUTH("shape_only", entries.pop("shape_only", False))
        shape, coefficients = SOURCES[name].make(law, entries, contact, folder)
    except InputError as problem:
        raise InputError("\n".join(f"[{name}] {line}" for line in str(problem).splitlines())) from None
    if shape_only:
        return shape, {}
    doubled = [key for key in INPUTS_OF_SURFACES if coefficients and contact.get(key) is not None]
    if doubled:
        key = doubled[0]
        height = ", by its h_rms (ra and rq are a roughness too)" if key == "roughness" and "h_rms" in entries else ""
        raise InputError(f"[contact] {key} = {contact[key]:g} follows from the table [{name}]{height}; remove one of them.")
    return shape, coefficients


def self_contained(law: Law, tables: dict[str, Any], folder: Path, shape: AsperityLaw | None) -> dict[str, Any]:
    """Return the table of a contact law with the numbers of the file that it names in the place of the name."""
    if law == "table":
        assert isinstance(shape, TableLaw)
        return {"table": {"separation": list(shape.separation), "pressure": list(shape.pressure)}}
    if tables.get("surface") is None:
        return {}
    entries = {key: value for key, value in tables["surface"].items() if key != "shape_only"}
    if "spectrum" in entries:
        found = _of_spectrum(entries, folder)
        del entries["spectrum"]
        entries |= {"wavenumber": found.wavenumber.tolist(), "density": found.density.tolist()}
    return {"surface": entries}


def _of_surface(law: Law, entries: dict[str, Any], contact: dict[str, Any], folder: Path) -> Made:
    """Return the law of a surface by the numbers of its spectrum, or by the spectrum itself."""
    entries = {key: value for key, value in entries.items() if key not in ERRORS_OF_SURFACES}
    measured = [key for key in ("spectrum", "wavenumber", "density") if key in entries]
    if measured:
        extra = [name for name in entries if name not in (*measured, "gamma")]
        if extra:
            source = "the file of the spectrum" if "spectrum" in entries else "the spectrum"
            raise InputError(f"{extra[0]} = {show(entries[extra[0]])} follows from {source}; remove one of them.")
        full = _law_of(_of_spectrum(entries, folder), entries.get("gamma", GAMMA))
    else:
        gamma = GAMMA_INPUT.checked(entries.pop("gamma", GAMMA))
        full = _law_of(SelfAffine(**read_inputs(entries, SURFACE).checked()), gamma)
    return (full if law == "persson" else SpectralExponential(full.area_slope), full.coefficients)


# A law takes half a second, and a page reads its case at each move of a slider.
_law_of = functools.lru_cache(maxsize=16)(persson_law)


def _of_spectrum(entries: dict[str, Any], folder: Path) -> Spectrum:
    """Return the spectrum of the file that a table names, or of its lists."""
    path = _file_of("surface", entries, folder)
    if path is None:
        return Spectrum(*_lists("surface", entries))
    from stribeck.files.columns import Column, read_columns  # slow to import, and most cases name no file

    density = r"((power )?spectral )?density|psd|c|c\(q\)"
    columns = {"wavenumber": Column("wave ?number|q", "wavenumber"), "density": Column(density, "spectral density")}
    found = read_columns(path, "the first line must be 'wavenumber [1/m], density [m^4]', with the units of the file", columns)
    with found.named():
        return Spectrum(**found.in_si)


def _of_asperities(law: Law, entries: dict[str, Any], contact: dict[str, Any], folder: Path) -> Made:
    """Return a law with the numbers of its own, or with what it makes of those of the surface."""
    if not hasattr(NAMED_LAWS[law], "coefficients"):
        return named_law(law, **entries), {}
    for name, row in SUMMITS.items():
        if name not in entries:
            raise InputError(f"{name} is missing; {row.advice}.")
    return (named_law(law), NAMED_LAWS[law].coefficients(**entries))


def _of_table(law: Law, entries: dict[str, Any], contact: dict[str, Any], folder: Path) -> Made:
    """Return the law of a table, whose units are those of the contact."""
    if not entries:
        raise InputError("file is missing; add the name of a CSV file with a column of separations and one of pressures.")
    path = _file_of("table", entries, folder)
    if path is None:
        return (TableLaw(*_lists("table", entries)), {})
    return (TableLaw.read(path, **{key: contact.get(key) for key in (*INPUTS_OF_SURFACES, "modulus")}), {})


def _file_of(table: str, entries: dict[str, Any], folder: Path) -> Path | None:
    """Return the path of the file that a table names, None where lists of numbers stand in its place."""
    key, lists = SOURCES[table].file, SOURCES[table].lists
    if key not in entries:
        return None
    doubled = [name for name in lists if name in entries]
    if doubled:
        raise InputError(f"{key} = {show(entries[key])} and {doubled[0]} are both given; remove one of them.")
    if not isinstance(entries[key], str):
        raise InputError(f"{key} = {show(entries[key])} must be text in quotes, the name of a CSV file.")
    return folder / str(entries[key])


def _lists(table: str, entries: dict[str, Any]) -> tuple[Array, Array]:
    """Return the two lists of numbers of a table."""
    names, found = SOURCES[table].lists, list[Array]()
    for name in names:
        if name not in entries:
            raise InputError(f"{name} is missing; add as many numbers as the other list has.")
        found.append(np.array(NUMBERS(name, entries[name]), dtype=float))
    one, other = found
    if len(one) != len(other):
        raise InputError(f"{names[0]} has {len(one)} numbers and {names[1]} {len(other)}; they must have the same length.")
    return one, other


# The tables that describe a surface. Those of a law that no name alone makes are needed.
SOURCES = {
    "surface": Source(
        ("exponential", "persson"),
        (*SURFACE.quantities, "gamma", "spectrum", "wavenumber", "density", "shape_only", *ERRORS_OF_SURFACES),
        _of_surface,
        "spectrum",
        ("wavenumber", "density"),
    ),
    "asperities": Source(
        tuple(law for law in NAMED_LAWS if law != "exponential"),
        (*SUMMITS, *dict.fromkeys(key for law in NAMED_LAWS.values() for key in numbers_of(law))),
        _of_asperities,
    ),
    "table": Source(("table",), ("file", "separation", "pressure"), _of_table, "file", ("separation", "pressure")),
}

LAWS: tuple[Law, ...] = tuple(law for source in SOURCES.values() for law in source.laws)

NEEDED_TABLE = {law: name for name, source in SOURCES.items() for law in source.laws if law not in NAMED_LAWS}

KEYS_OF_SURFACES: dict[str, Keys] = {name: dict.fromkeys(source.keys, AS_GIVEN) for name, source in SOURCES.items()}

LAW_KEY = Key(one_of(*LAWS), "exponential")  # The key that names a law
