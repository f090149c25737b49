"""The contact law of a case or sweep file: from its name and the tables that describe the surface."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from stribeck.cases.rough_surface import RoughSurface
from stribeck.contact_laws.exponential import ExponentialShape
from stribeck.contact_laws.greenwood import GreenwoodTripp, GreenwoodWilliamson
from stribeck.contact_laws.law import LawShape
from stribeck.contact_laws.persson import GAMMA, PerssonLaw, persson_law
from stribeck.contact_laws.scaled import NAMED
from stribeck.contact_laws.spectrum import Spectrum
from stribeck.contact_laws.table import TableLaw
from stribeck.files.two_columns import read_two_columns
from stribeck.quantities.units import InputError, show

__all__ = ["ASPERITIES", "FROM_TABLES", "LAWS", "SURFACE", "TABLE", "TABLES_OF", "Law", "LawOfFile", "law_of_file"]

Law = Literal["exponential", "persson", "greenwood-williamson", "greenwood-tripp", "table"]

LAWS: tuple[Law, ...] = get_args(Law)

SURFACE = (
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
)
"""Keys of the table ``[surface]``."""

ASPERITIES = ("density", "radius", "deviation")
"""Keys of the table ``[asperities]``."""

TABLE = ("file",)
"""Key of the table ``[table]``."""

FROM_TABLES = ("alpha", "beta", "roughness")
"""Inputs of a contact that follow from a table of its surface."""

NEEDED: dict[Law, str] = {"persson": "surface", "table": "table"}
MAY_HAVE: dict[Law, tuple[str, ...]] = {
    "exponential": ("surface",),
    "persson": ("surface",),
    "greenwood-williamson": ("asperities",),
    "greenwood-tripp": ("asperities",),
    "table": ("table",),
}


TABLES_OF: dict[Law, str] = {law: names[0] for law, names in MAY_HAVE.items() if names}
"""The table that each law may come from, where there is one."""


@dataclass(frozen=True)
class LawOfFile:
    """A contact law, and what its tables say of alpha, beta and roughness; these are empty where the file gives them."""

    shape: LawShape | None
    coefficients: dict[str, float]


def law_of_file(law: Law, contact: dict[str, Any], tables: dict[str, dict[str, Any] | None], folder: Path) -> LawOfFile:
    """Return the contact law of a file.

    Parameters
    ----------
    law : str
        Its name.
    contact : dict
        The quantities of the table ``[contact]``, in SI units; None where not given.
    tables : dict
        By name, the tables ``surface``, ``asperities`` and ``table``; None where the file has none.
    folder : pathlib.Path
        Where files that it names lie.

    Returns
    -------
    LawOfFile
        The law.

    Raises
    ------
    InputError
        Where a table is missing, is one that the law does not use, has a wrong entry, or says what ``[contact]`` says too.
    """
    given = {
        name: {k: v for k, v in entries.items() if v is not None} for name, entries in tables.items() if entries is not None
    }
    for name in given:
        if name not in MAY_HAVE[law]:
            users = " and ".join(repr(other) for other in LAWS if name in MAY_HAVE[other])
            raise InputError(f"the table [{name}] is of no use to law = {show(law)}; it belongs to {users}.")
    needed = NEEDED.get(law)
    if needed is not None and needed not in given:
        keys = {"surface": "h_rms, hurst, q0 and q1", "table": "file"}[needed]
        raise InputError(f"the table [{needed}] is missing, which law = {show(law)} needs; give {keys} there.")
    if law == "table":
        return LawOfFile(_table(given["table"], contact, folder), {})
    if not given:
        return LawOfFile(NAMED[law], {})
    (name,) = given
    doubled = [key for key in FROM_TABLES if contact.get(key) is not None]
    if doubled:
        raise InputError(
            f"[contact] {doubled[0]} = {contact[doubled[0]]:g} follows from the table [{name}]; remove one of them."
        )
    try:
        return _of_asperities(law, given[name]) if name == "asperities" else _of_surface(law, given[name], folder)
    except InputError as problem:
        raise InputError(f"[{name}] {problem}") from None


def _of_surface(law: Law, entries: dict[str, Any], folder: Path) -> LawOfFile:
    if "spectrum" in entries:
        full = _of_spectrum(entries, folder)
    else:
        for name in ("h_rms", "hurst"):
            if name not in entries:
                raise InputError(f"{name} is missing; add {name} = {'0.8' if name == 'hurst' else repr('1 um')}.")
        full = RoughSurface(**entries).law
    if law == "persson":
        return LawOfFile(full, full.coefficients)
    return LawOfFile(ExponentialShape(full.area_slope), full.coefficients)


def _of_spectrum(entries: dict[str, Any], folder: Path) -> PerssonLaw:
    extra = [name for name in entries if name not in ("spectrum", "gamma")]
    if extra:
        raise InputError(f"{extra[0]} = {show(entries[extra[0]])} follows from the file of the spectrum; remove one of them.")
    if not isinstance(entries["spectrum"], str):
        raise InputError(f"spectrum = {show(entries['spectrum'])} must be text in quotes, the name of a CSV file.")
    path = folder / entries["spectrum"]
    rows, units = read_two_columns(path, None, {"wavenumber": "wavenumber", "density": "spectral density"})
    assert units is not None
    try:
        spectrum = Spectrum(rows[:, 0] * units[0], rows[:, 1] * units[1])
        return persson_law(spectrum, entries.get("gamma", GAMMA))
    except InputError as problem:
        raise InputError(f"{path}: {problem}") from None


def _of_asperities(law: Law, entries: dict[str, Any]) -> LawOfFile:
    examples = {"density": "1e10 m^-2", "radius": "10 um", "deviation": "1 um"}
    for name in ASPERITIES:
        if name not in entries:
            raise InputError(f"{name} is missing; add {name} = {show(examples[name])}.")
    shape = GreenwoodWilliamson() if law == "greenwood-williamson" else GreenwoodTripp()
    return LawOfFile(shape, shape.coefficients(**entries))


def _table(entries: dict[str, Any], contact: dict[str, Any], folder: Path) -> TableLaw:
    if "file" not in entries:
        raise InputError(
            "[table] file is missing; add the name of a CSV file with a column of separations and one of pressures."
        )
    needed = {key: contact.get(key) for key in ("alpha", "beta", "roughness", "modulus")}
    E, nu = contact.get("youngs_modulus"), contact.get("poisson_ratio")
    if needed["modulus"] is None and E is not None and nu is not None:
        needed["modulus"] = E / (1 - nu * nu)
    if not isinstance(entries["file"], str):
        raise InputError(f"[table] file = {show(entries['file'])} must be text in quotes, the name of a CSV file.")
    return TableLaw.read(folder / entries["file"], **needed)
