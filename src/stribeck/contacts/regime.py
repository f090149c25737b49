"""The lubrication regime of a state, by the shares of fluid and asperities in load and friction."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from stribeck._types import Array, Indices
from stribeck.quantities.units import to_si

Regime = Literal["boundary", "mixed", "hydrodynamic"]

# The regimes in the order of rising speed; their places are their numbers.
REGIMES: tuple[Regime, ...] = ("boundary", "mixed", "hydrodynamic")

# Part of the load on the fluid up to which lubrication is called boundary: friction is within 5 % of the plateau.
BOUNDARY_FLUID_SHARE = 0.05

# Part of the friction from asperities up to which lubrication is called hydrodynamic: at the friction minimum of smooth
# contacts asperities give about 2/(2 + 3 Lambda), 6 to 18 % for Lambda from 10 to 3.
HYDRODYNAMIC_CONTACT_SHARE = 0.1


MIN_FRICTION = 1e-300  # Smallest friction in a quotient


def friction_share(contact: Any, viscous: Any) -> Any:
    """Return the part of the friction that asperities cause, by size as signs may differ, zero without friction."""
    size = np.abs(contact)
    return size / np.maximum(size + np.abs(viscous), MIN_FRICTION)


def regime_of(fluid_load_share: float, contact_friction_share: float) -> Regime:
    """Return the regime from the fluid load share and the fraction of friction that asperities cause.

    Parameters
    ----------
    fluid_load_share : float
        Part of the load that the fluid carries [-].
    contact_friction_share : float
        Contact part of the friction over all of it [-].

    Returns
    -------
    str
        ``"hydrodynamic"`` where asperities cause at most 10 % of the friction, else ``"boundary"`` where the fluid carries
        at most 5 % of the load, else ``"mixed"``.

    Raises
    ------
    InputError
        If one is no number.
    """
    fluid = to_si(fluid_load_share, "number", "fluid_load_share")
    contact = to_si(contact_friction_share, "number", "contact_friction_share")
    return REGIMES[int(regime_numbers(np.array(fluid), np.array(contact)))]


def regime_numbers(fluid_load_share: Array, contact_friction_share: Array) -> Indices:
    """Return the places in :data:`REGIMES` of the regimes of many states, by the rule of :func:`regime_of`."""
    slow = np.where(fluid_load_share <= BOUNDARY_FLUID_SHARE, REGIMES.index("boundary"), REGIMES.index("mixed"))
    return np.where(contact_friction_share <= HYDRODYNAMIC_CONTACT_SHARE, REGIMES.index("hydrodynamic"), slow)
