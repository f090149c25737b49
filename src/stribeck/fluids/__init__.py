"""Fluids: what a film of a given gap carries and drags."""

from importlib import import_module as _import_module

_HOMES = {
    "description": ("Fluid",),
    "effective_medium": ("EffectiveMedium",),
    "flow_factors": ("PatirCheng",),
    "presets": ("PRESETS", "Liquid", "glycerol_water", "water"),
    "rate_laws": ("Carreau", "Cross", "Eyring", "PowerLaw"),
    "viscosity": ("Barus", "Constant", "DowsonHigginson", "Incompressible", "Roelands"),
}
__all__ = sorted(name for names in _HOMES.values() for name in names)


def __getattr__(name: str) -> object:
    """Import a public name on its first use."""
    for module, names in _HOMES.items():
        if name in names:
            found = globals()[name] = getattr(_import_module(f"stribeck.fluids.{module}"), name)
            return found
    raise AttributeError(f"module 'stribeck.fluids' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
