"""The public names with their types; at run time each is imported on first use."""

from stribeck.profiles.dry import DryContact, dry_contact
from stribeck.profiles.shapes import Cylinder, Grooved, Land, Lip, Worn
from stribeck.profiles.table import Table, from_pressure

__all__ = ["Cylinder", "DryContact", "Grooved", "Land", "Lip", "Table", "Worn", "dry_contact", "from_pressure"]
