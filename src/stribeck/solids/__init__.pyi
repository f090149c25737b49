"""The public names with their types; at run time each is imported on first use."""

from stribeck.solids.half_plane import HalfPlane
from stribeck.solids.layer import Layer
from stribeck.solids.prony_fit import PronyFit, fit_prony, from_master_curve
from stribeck.solids.two_bodies import TwoBodies
from stribeck.solids.viscoelastic import Prony, StandardLinearSolid, hysteresis_friction

__all__ = [
    "HalfPlane",
    "Layer",
    "Prony",
    "PronyFit",
    "StandardLinearSolid",
    "TwoBodies",
    "fit_prony",
    "from_master_curve",
    "hysteresis_friction",
]
