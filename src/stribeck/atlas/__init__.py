"""The atlas: solved states of a box of groups as smooth functions."""

from stribeck.atlas.reading import (
    BOX,
    central_gap,
    contact_load_share,
    covers,
    fluid_load_share,
    flux_gap,
    for_groups,
    friction,
    friction_derivatives,
    friction_parts,
    holds_for,
    info,
    minimum_gap,
    offset,
    shares_and_friction,
    viscous_friction,
)

__all__ = [
    "BOX",
    "info",
    "central_gap",
    "contact_load_share",
    "covers",
    "flux_gap",
    "fluid_load_share",
    "for_groups",
    "friction",
    "friction_derivatives",
    "friction_parts",
    "holds_for",
    "minimum_gap",
    "offset",
    "shares_and_friction",
    "viscous_friction",
]
