"""The contacts by geometry: what ``geometry = "line"`` or ``"point"`` stands for, in files and in groups."""

from __future__ import annotations

from typing import cast, get_args

from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Geometry
from stribeck.contacts.line import LineContact
from stribeck.contacts.point import PointContact
from stribeck.quantities.units import InputError, show

__all__ = ["CONTACTS", "check_geometry"]

CONTACTS: dict[Geometry, type[Contact]] = {"line": LineContact, "point": PointContact}
"""The contact of each geometry, by name."""


def check_geometry(geometry: object) -> Geometry:
    """Return ``geometry`` if it is a key of :data:`CONTACTS`."""
    for known in get_args(Geometry):
        if isinstance(geometry, str) and geometry == known:
            return cast("Geometry", known)
    allowed = " or ".join(map(repr, CONTACTS))
    raise InputError(f"geometry = {show(geometry)}; it must be {allowed}: a cylinder or a ball.")
