"""The case of a comparison: the preferred law or model that a case file can have, with its fitted values."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from stribeck.cases.case import Case
from stribeck.cases.law import INPUTS_OF_SURFACES, KEYS_OF_SURFACES
from stribeck.cases.model_parts import FILES, FLUID_KINDS, SOURCES_OF_VISCOSITY, fluid_table
from stribeck.cases.reading import load_case
from stribeck.contact_laws.scaled import NAMED_LAWS
from stribeck.contacts.contact import Contact
from stribeck.experiments.compare import Comparison
from stribeck.files.toml import toml_text
from stribeck.files.writing import PathLike
from stribeck.fits.case_file import write_fitted_case
from stribeck.quantities.units import InputError

__all__ = ["write_preferred_case"]


def write_preferred_case(comparison: Comparison, case: Case, path: PathLike, *, force: bool = False) -> str:
    """Write the case of the first law or model that a case file can have, and return its name."""
    for each in comparison.candidates:
        tables = _tables_of(case, each.fit.contact)
        if tables is None:
            continue
        with TemporaryDirectory(prefix="stribeck-") as folder:
            changed = Path(folder) / "case.toml"
            changed.write_text(toml_text(tables), encoding="utf-8")
            write_fitted_case(each.fit, case if tables == case.tables else load_case(changed), path, force=force)
        return each.name
    names = " or ".join(each.name for each in comparison.candidates)
    raise InputError(f"{path} is not written: no case file can have {names}; write the criteria, as in --out laws.csv.")


def _tables_of(case: Case, contact: Contact) -> dict[str, Any] | None:
    """Return the tables of a case with law, fluid and cavitation of a contact; None where no file can have its law."""
    tables, own = dict(case.tables), case.contact
    law, of_case = ("exponential" if each.law is None else each.law.name for each in (contact, own))
    if law != of_case:
        if law not in NAMED_LAWS:
            return None
        tables = {name: table for name, table in tables.items() if name not in KEYS_OF_SURFACES}
        given = {key: value for key, value in tables["contact"].items() if key not in ("ra", "rq")}
        tables["contact"] = given | {"law": law} | {name: getattr(contact, name) for name in INPUTS_OF_SURFACES}
    if contact.fluid.name != own.fluid.name:
        if not SOURCES_OF_VISCOSITY.keys().isdisjoint(tables.get("fluid", {})):
            tables["contact"] = tables["contact"] | {"viscosity": contact.viscosity}
        tables["fluid"] = fluid_table(contact.fluid) or {"model": FLUID_KINDS["rheology"].nothing}
    if (contact.cavitation, contact.cavity_pressure) != (own.cavitation, own.cavity_pressure):
        tables["cavitation"] = {"model": contact.cavitation.value, "cavity_pressure": contact.cavity_pressure}
    for table, key in FILES:
        if tables != case.tables and isinstance(tables.get(table, {}).get(key), str):
            tables[table] = tables[table] | {key: str((case.path.parent / tables[table][key]).resolve())}
    return tables
