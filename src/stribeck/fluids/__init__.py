"""Fluids: what a film of a given gap carries and drags."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

__all__, __getattr__, __dir__ = _lazy_names(__name__, has_laws=True)
