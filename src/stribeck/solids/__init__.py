"""Solids: the deflection of a surface under a pressure."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

__all__, __getattr__, __dir__ = _lazy_names(__name__, has_laws=True)
