"""The atlas: solved states of a box of groups as smooth functions."""

from stribeck.atlas.lookup import friction_terms
from stribeck.atlas.reading import (
    central_gap,
    contact_load_share,
    fluid_load_share,
    flux_gap,
    friction,
    friction_derivatives,
    friction_parts,
    info,
    minimum_gap,
    offset,
    shares_and_friction,
    viscous_friction,
)
from stribeck.atlas.tables import BOX, covers, for_groups, holds_for

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
    "friction_terms",
    "holds_for",
    "minimum_gap",
    "offset",
    "shares_and_friction",
    "viscous_friction",
]
