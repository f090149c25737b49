"""Solids: the deflection of a surface under a pressure."""

from importlib import import_module as _import_module

_HOMES = {
    "half_plane": ("HalfPlane",),
    "layer": ("Layer",),
    "two_bodies": ("TwoBodies",),
    "viscoelastic": ("Prony", "StandardLinearSolid", "hysteresis_friction"),
}
__all__ = sorted(name for names in _HOMES.values() for name in names)


def __getattr__(name: str) -> object:
    """Import a public name on its first use."""
    for module, names in _HOMES.items():
        if name in names:
            found = globals()[name] = getattr(_import_module(f"stribeck.solids.{module}"), name)
            return found
    raise AttributeError(f"module 'stribeck.solids' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
