"""Fluids: what a film of a given gap carries and drags."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

_HOMES = {
    "description": ("Fluid", "Liquid"),
    "effective_medium": ("EffectiveMedium",),
    "flow_factors": ("PatirCheng",),
    "measured_viscosity": ("FlowCurve", "flow_curve", "read_flow_curve"),
    "oils": ("iso_vg", "oil"),
    "presets": ("PRESETS", "glycerol_water", "water"),
    "rheology.eyring": ("Eyring",),
    "rheology.rate_laws": ("Carreau", "Cross", "PowerLaw"),
    "rheology.viscosity": ("Barus", "Constant", "DowsonHigginson", "Incompressible", "Roelands"),
}
__all__, __getattr__, __dir__ = _lazy_names(__name__, _HOMES, has_laws=True)
