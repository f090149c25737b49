"""Contact laws: the pressure of the asperities at a separation of the surfaces."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

_HOMES = {
    "finite_surface": ("FiniteSurface",),
    "function": ("FunctionLaw",),
    "greenwood": ("GreenwoodTripp", "GreenwoodWilliamson"),
    "table": ("TableLaw",),
}
__all__, __getattr__, __dir__ = _lazy_names(__name__, _HOMES, has_laws=True)
