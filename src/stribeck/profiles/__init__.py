"""Profiles: the shape of the rigid body of a line contact, where it is no parabola."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

__all__, __getattr__, __dir__ = _lazy_names(__name__, has_laws=True)
