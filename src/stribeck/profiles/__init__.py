"""Profiles: the shape of the rigid body of a line contact, where it is no parabola."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

_HOMES = {
    "cylinder": ("Cylinder",),
    "dry": ("DryContact", "dry_contact"),
    "grooved": ("Grooved",),
    "land": ("Land",),
    "lip": ("Lip",),
    "table": ("Table", "from_pressure"),
    "worn": ("Worn",),
}
__all__, __getattr__, __dir__ = _lazy_names(__name__, _HOMES, has_laws=True)
