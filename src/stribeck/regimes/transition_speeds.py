"""A phase diagram read off the atlas: all points at once, transitions located on it."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.atlas.tables import table_for
from stribeck.contacts.friction import BOUNDARY_FLUID_SHARE, HYDRODYNAMIC_CONTACT_SHARE, Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Groups
from stribeck.numerics.events import rising_zeros
from stribeck.numerics.threads import one_blas_thread

POINTS_PER_DECADE = 5  # Of speed, on which passages are seen before each is narrowed

MAX_NARROWINGS = 6  # Rounds of that

NARROW_ENOUGH = 0.2  # Part of the table's error below which the ends of a passage are no longer moved together


@one_blas_thread
def transition_speeds(
    groups: Groups,
    boundary_friction: float,
    beta: float,
    definition: Definition,
    motion: Mapping[str, Any],
    speeds: tuple[float, float] | None = None,
    narrowings: int = MAX_NARROWINGS,
) -> tuple[Array, Array]:
    """Return the speed groups of the transitions of many contacts of one load, off the atlas, and errors of their logarithms.

    They are where the fluid begins to carry more than 5 % of the load and asperities to cause less than 10 % of the friction,
    zero or infinite if they do at all speeds or at none, and of the minimum, or nan; both arrays have the shape (3, n).
    """
    row = table_for(groups)
    roughness = np.atleast_1d(np.asarray(groups.roughness, dtype=float))
    speeds = row.speeds(groups) if speeds is None else speeds
    count = 1 + max(2, math.ceil(POINTS_PER_DECADE * math.log10(speeds[1] / speeds[0])))
    grid = np.log(np.geomspace(*speeds, count))

    bound = HYDRODYNAMIC_CONTACT_SHARE / (1 - HYDRODYNAMIC_CONTACT_SHARE)
    rubbing = boundary_friction * float(RULES[groups.geometry].sliding_factor(groups, motion))

    def signs(s: Array, h: Array) -> Array:
        """Return what passes from below to above zero at each of the three, shape (3, ...)."""
        fluid, contact, viscous, slope = atlas.shares_and_friction(
            Groups(np.exp(s), groups.load, h, **groups.physics), boundary_friction, beta, definition, **motion
        )
        solid, total = np.abs(rubbing * contact), rubbing * contact + viscous
        return np.stack(
            [
                np.log(np.maximum(fluid, 1e-300) / BOUNDARY_FLUID_SHARE),
                np.log(np.maximum(bound * np.abs(viscous), 1e-300) / np.maximum(solid, 1e-300)),
                np.sign(total) * slope / (np.abs(slope) + np.maximum(np.abs(total), 1e-300)),  # of its size, between -1 and 1
            ]
        )

    found, error = _passages(signs, grid, roughness, narrowings, row.error)
    with np.errstate(over="ignore"):
        speed = np.exp(found)
    speed[2, ~np.isfinite(found[2])] = np.nan
    return speed, error


def _passages(
    signs: Callable[[Array, Array], Array], grid: Array, roughness: Array, narrowings: int, stated: float
) -> tuple[Array, Array]:
    """Return the logarithms of the speed at which each function rises through zero in each row, and errors, shape (3, rows).

    The minimum is the last passage, as the printed friction may rise before it falls; of the others it is the first.
    """
    values = signs(*np.broadcast_arrays(grid, roughness[:, None]))
    rising = (values[..., :-1] < 0) & (values[..., 1:] >= 0)
    place = np.argmax(rising, axis=-1)
    place[2] = rising.shape[-1] - 1 - np.argmax(rising[2, :, ::-1], axis=-1)
    some = np.asarray(rising.any(axis=-1))
    found = np.where(values[..., 0] >= 0, -np.inf, np.inf)
    error = np.zeros(found.shape)
    which, rows = np.nonzero(some)
    if not len(rows):
        return found, error
    first = place[which, rows]
    found[which, rows], slopes, apart = rising_zeros(
        lambda s: signs(s, np.broadcast_to(roughness[rows], s.shape))[which, :, np.arange(len(rows))].T,
        np.stack([grid[first], grid[first + 1]]),
        np.stack([values[which, rows, first], values[which, rows, first + 1]]),
        narrowings,
        NARROW_ENOUGH * stated,
    )
    error[which, rows] = stated / np.maximum(slopes, 1e-300) + apart
    return found, error
