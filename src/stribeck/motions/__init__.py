"""Motions of a stroke: the sliding speed over time."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

__all__, __getattr__, __dir__ = _lazy_names(__name__, has_laws=True)
