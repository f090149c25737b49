"""The public names with their types; at run time each is imported on first use."""

from stribeck.profiles.cylinder import Cylinder
from stribeck.profiles.dry import DryContact, dry_contact
from stribeck.profiles.grooved import Grooved
from stribeck.profiles.land import Land
from stribeck.profiles.lip import Lip
from stribeck.profiles.table import Table, from_pressure
from stribeck.profiles.worn import Worn

__all__ = ["Cylinder", "DryContact", "Grooved", "Land", "Lip", "Table", "Worn", "dry_contact", "from_pressure"]
