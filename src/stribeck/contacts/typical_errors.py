"""Errors that inputs usually have where nobody measured them on the contact itself."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from stribeck.contacts.contact import Contact
from stribeck.quantities.formats import format_percent


def follows_surface(contact: Contact, errors: Collection[str]) -> bool:
    """Return whether beta moves with an uncertain roughness, as under Persson's law."""
    return "roughness" in errors and "beta" not in errors and contact.law is not None and contact.law.name == "persson"


def typical_errors(contact: Contact, known: Collection[str]) -> dict[str, float]:
    """Return the usual standard error over the value of each input that has none."""
    rows = {name: row for name, row in contact.INPUTS.rows.items() if row.typical_error and name not in known}
    found = {name: row.typical_error for name, row in rows.items() if getattr(contact, name, None)}
    if hasattr(contact.law, "fixed_alpha"):
        found.pop("alpha", None)
    if follows_surface(contact, {*known, *found} - {"beta"}):
        found.pop("beta", None)
    return found


def typical_error_text(contact: Contact, errors: Mapping[str, float]) -> tuple[str, ...]:
    """Return which errors are usual ones, in a sentence; nothing where none is."""
    rows = contact.INPUTS.rows
    named = ", ".join(f"{rows[name].label} {format_percent(error)}" for name, error in errors.items())
    return (f"usual errors where none is given: {named}.",) if named else ()
