"""The contacts by geometry: what ``geometry = "line"`` or ``"point"`` stands for, in files and in groups."""

from __future__ import annotations

from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Geometry, check_geometry
from stribeck.contacts.line import LineContact
from stribeck.contacts.point import PointContact

__all__ = ["CONTACTS", "check_geometry"]

# The contact of each geometry, by name.
CONTACTS: dict[Geometry, type[Contact]] = {"line": LineContact, "point": PointContact}
