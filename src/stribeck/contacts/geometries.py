"""The contacts by geometry: what ``geometry = "line"`` or ``"point"`` stands for, in files and in groups."""

from __future__ import annotations

from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Geometry, check_geometry
from stribeck.contacts.inputs import InputTable
from stribeck.contacts.line import LineContact
from stribeck.contacts.point import PointContact

__all__ = ["CONTACTS", "INPUT_TABLES", "LETTERS", "LINE", "POINT", "check_geometry"]

# The contact of each geometry, by name.
CONTACTS: dict[Geometry, type[Contact]] = {"line": LineContact, "point": PointContact}

# The inputs by geometry.
INPUT_TABLES: dict[str, InputTable] = {name: contact.INPUTS for name, contact in CONTACTS.items()}

LINE, POINT = LineContact.INPUTS, PointContact.INPUTS

# Symbols of the article and of the field, and the inputs that they stand for.
LETTERS = {letter: name for table in (POINT, LINE) for name, row in table.quantities.items() for letter in row.letters}
