"""The lubrication regime of a state, and where its numbers come from: solved, or read off the atlas."""

from __future__ import annotations

from enum import StrEnum
from typing import Literal

from stribeck.quantities.units import InputError, show

Regime = Literal["boundary", "mixed", "hydrodynamic"]
Method = Literal["solver", "atlas"]

METHODS: tuple[Method, ...] = ("solver", "atlas")
"""Where states come from: solved, or read off :mod:`stribeck.atlas`."""

BOUNDARY_FLUID_SHARE = 0.05
"""Part of the load on the fluid up to which lubrication is called boundary: friction is within 5 % of the plateau."""

HYDRODYNAMIC_CONTACT_SHARE = 0.1
"""Part of the friction from asperities up to which lubrication is called hydrodynamic; at the friction minimum of smooth
contacts it is about 2/(2 + 3 Lambda), 6 to 18 % for Lambda from 10 to 3."""


class Transition(StrEnum):
    """The places of a curve that have a name; the value is what outputs call them."""

    BOUNDARY_END = f"fluid carries {BOUNDARY_FLUID_SHARE:.0%} of the load"
    EQUAL_SHARES = "fluid carries 50% of the load"
    HYDRODYNAMIC_START = f"asperities cause {HYDRODYNAMIC_CONTACT_SHARE:.0%} of the friction"
    MINIMUM = "minimum of friction"


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
    """
    if contact_friction_share <= HYDRODYNAMIC_CONTACT_SHARE:
        return "hydrodynamic"
    return "boundary" if fluid_load_share <= BOUNDARY_FLUID_SHARE else "mixed"


def check_method(method: str) -> Method:
    """Return ``method`` if it is one of the two."""
    for known in METHODS:
        if isinstance(method, str) and method == known:
            return known
    raise InputError(f"method = {show(method)}; it must be {' or '.join(map(repr, METHODS))}.")
