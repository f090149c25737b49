"""Solids: the deflection of a surface under a pressure."""

from stribeck.quantities.lazy import lazy_names as _lazy_names

_HOMES = {
    "half_plane": ("HalfPlane",),
    "layer": ("Layer",),
    "prony_fit": ("PronyFit", "fit_prony", "from_master_curve"),
    "two_bodies": ("TwoBodies",),
    "viscoelastic": ("Prony", "StandardLinearSolid", "hysteresis_friction"),
}
__all__, __getattr__, __dir__ = _lazy_names(__name__, _HOMES, has_laws=True)
