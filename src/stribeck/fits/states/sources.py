"""How the states of a fit are obtained: off the atlas, solved, or read between solved ones."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.atlas.tables import table_for
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Groups
from stribeck.fits.states.interpolation import Between
from stribeck.fits.states.parts import FrictionParts, Made, ModelChange, PartsOf
from stribeck.fits.states.solved import OnState, solved_parts
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    from stribeck.fits.model import FrictionModel

__all__ = ["Ways", "atlas_or", "atlas_parts", "between", "in_atlas", "rtol_of_states", "ways_of"]


FAR_DOUBT = 1e-2  # Doubt up to which curves are read between solved ones, see :mod:`stribeck.numerics.scattered`


# Smallest and largest tolerance of states of balls that the noise of the data may ask for: what a rig resolves lies between
# them.  That of the case holds where it is larger.
BALL_RTOL = 1e-4, 1e-3

ERROR_SHARE = 1 / 3  # Tolerance of states over the standard error of a common factor on the friction, which it widens by 5 %


class Ways(NamedTuple):
    """How the states of a fit are obtained."""

    quick: PartsOf | Between  # For the search, and for the values that the fit returns
    solved: PartsOf | Between  # For the search, and for the values that the fit returns


def ways_of(model: FrictionModel, definition: Definition, rtol: float, on_state: OnState) -> Ways:
    """Return how the states of a fit are obtained: off the atlas where one holds, else read between solved ones."""
    solved = Made(solved_parts, model, definition, rtol, on_state=on_state)
    return Ways(Made(atlas_or, solved, definition), solved) if in_atlas(model) else between(solved)


def rtol_of_states(model: FrictionModel, rtol: float, relative_noise: Array | float = math.inf) -> float:
    """Return the tolerance of solved states, given that of the case and the relative noise of each row where it is known."""
    if model.contact.groups.geometry == "line":  # which takes milliseconds at any tolerance
        return rtol
    low, high = BALL_RTOL
    with np.errstate(divide="ignore"):
        standard_error = np.sum(np.broadcast_to(relative_noise, len(model.data)) ** -2.0) ** -0.5
    return max(rtol, min(max(low, ERROR_SHARE * float(standard_error)), high))


def in_atlas(model: FrictionModel) -> bool:
    """Return whether a table holds for all contacts of a fit, wherever in its box their states lie."""
    kinds = {each.groups.model for each in model.contacts}
    return len(kinds) == 1 and not any(model.moving) and atlas.for_groups(model.contact.groups) is not None


def atlas_parts(definition: Definition) -> PartsOf:
    """Return the function that reads states off the atlas; it raises InputError outside."""

    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        values, slopes = atlas.friction_parts(groups, definition)
        error = np.full(values.shape, table_for(groups).error)
        return FrictionParts(values, slopes, error, definition)

    return parts


def atlas_or(slow: PartsOf, definition: Definition) -> PartsOf:
    """Return the function that reads the states off the atlas where it holds all of them, and else takes the ``slow`` way."""
    quick = atlas_parts(definition)

    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        try:
            return quick(groups, changes)
        except InputError:
            return slow(groups, changes)

    return parts


def between(solve: PartsOf) -> Ways:
    """Return how to search on curves that are read between solved ones, and end on solved ones."""
    quick = Between(solve, FAR_DOUBT)
    return Ways(quick, replace(quick, doubt=0.0))
