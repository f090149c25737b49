"""Contact laws: the pressure of the asperities at a separation of the surfaces."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

__all__, __getattr__, __dir__ = _lazy_names(__name__, has_laws=True)
