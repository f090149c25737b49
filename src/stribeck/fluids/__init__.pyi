"""The public names with their types; at run time each is imported on first use."""

from stribeck.fluids.description import Fluid, Liquid
from stribeck.fluids.effective_medium import EffectiveMedium
from stribeck.fluids.flow_factors import PatirCheng
from stribeck.fluids.measured_viscosity import FlowCurve, flow_curve, read_flow_curve
from stribeck.fluids.oils import iso_vg, oil
from stribeck.fluids.presets import PRESETS, glycerol_water, water
from stribeck.fluids.rheology.eyring import Eyring
from stribeck.fluids.rheology.rate_laws import Carreau, Cross, PowerLaw
from stribeck.fluids.rheology.viscosity import Barus, Constant, DowsonHigginson, Incompressible, Roelands

__all__ = [
    "PRESETS",
    "Barus",
    "Carreau",
    "Constant",
    "Cross",
    "DowsonHigginson",
    "EffectiveMedium",
    "Eyring",
    "FlowCurve",
    "Fluid",
    "Incompressible",
    "Liquid",
    "PatirCheng",
    "PowerLaw",
    "Roelands",
    "flow_curve",
    "glycerol_water",
    "iso_vg",
    "oil",
    "read_flow_curve",
    "water",
]
