"""What the functions of stribeck return: states, curves, batches, sweeps, fits, checks and their parts."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

__all__, __getattr__, __dir__ = _lazy_names(__name__)
