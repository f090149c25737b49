"""Asymptotic laws of the model, each with range and source; the solver, which they judge, imports none.

:data:`FORMULAS` is the one list of them: tests, documentation and figures loop over it.
"""

from typing import Any

from stribeck.asymptotics.dry import hertz, rest
from stribeck.asymptotics.formula import Formula, Limit, OutOfRangeWarning
from stribeck.asymptotics.rough import boundary, load_sharing, mixed, perturbation, transitions, uniform
from stribeck.asymptotics.smooth import edge_layer, film_layers, hydrodynamic, large_deformation, small_deformation, wedge

__all__ = [
    "FORMULAS",
    "Formula",
    "Limit",
    "OutOfRangeWarning",
    "boundary",
    "edge_layer",
    "film_layers",
    "hertz",
    "hydrodynamic",
    "large_deformation",
    "load_sharing",
    "mixed",
    "perturbation",
    "rest",
    "small_deformation",
    "transitions",
    "uniform",
    "wedge",
]

FORMULAS: tuple[Formula[Any], ...] = (
    hertz.pressure,
    hertz.gap,
    hertz.offset,
    large_deformation.central_gap_large,
    large_deformation.flux_gap_large,
    large_deformation.minimum_gap_large,
    large_deformation.friction_large,
    small_deformation.central_gap_small,
    small_deformation.flux_gap_small,
    small_deformation.gap_small,
    small_deformation.pressure_small,
    small_deformation.friction_small,
    hydrodynamic.central_gap,
    hydrodynamic.flux_gap,
    hydrodynamic.friction,
    hydrodynamic.friction_uniform,
    film_layers.gap_inlet,
    film_layers.gap_outlet,
    film_layers.fluid_pressure_inlet,
    film_layers.fluid_pressure_outlet,
    rest.gap,
    rest.offset,
    rest.central_gap,
    rest.gap_small_indentation,
    rest.contact_pressure_small_indentation,
    rest.central_gap_small_indentation,
    rest.offset_small_indentation,
    edge_layer.gap,
    edge_layer.contact_pressure,
    perturbation.flux_gap,
    perturbation.fluid_pressure_first,
    perturbation.gap_first,
    perturbation.fluid_pressure_second,
    boundary.fluid_load_share,
    boundary.contact_load_share,
    boundary.viscous_friction,
    boundary.friction,
    wedge.contact_load_share,
    mixed.contact_load_share,
    mixed.friction,
    transitions.speed_boundary_to_mixed,
    transitions.separation_at_minimum,
    transitions.speed_at_minimum,
    transitions.friction_at_minimum,
    load_sharing.speed_at_fluid_share,
    load_sharing.contact_load_share,
    uniform.viscous_friction,
    uniform.friction,
)
"""All formulas, in the order in which a reader meets them: the smooth contact, the contact at rest, what lies between."""
