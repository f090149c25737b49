"""The bench: raw files of a rig become Stribeck curves with honest errors."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

__all__, __getattr__, __dir__ = _lazy_names(__name__)
