"""The mesh that resolves a guess: where panels are halved, and which fields decide that."""

from __future__ import annotations

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw
from stribeck.contacts.line import Groups
from stribeck.equations.guess import Guess, RowsGuess
from stribeck.equations.state import State
from stribeck.numerics.panels import Mesh, adapt

ROUNDING = 1e-9
"""Relative rounding of what tells where a panel lies."""

LONG_REACH_ORDER = 14
"""Nodes a panel from which the panel through infinity begins twice as far out, to keep up with them: the logarithm in the
gap limits its order."""


def mesh_for(
    guess: Guess | RowsGuess,
    groups: Groups,
    law: ContactLaw,
    order: int,
    tolerance: float,
    gap_tolerance: float = 1e-2,
    profile_tolerance: float = np.inf,
) -> Mesh:
    """Return the coarsest mesh that resolves a guess, or those of many states that are to share it.

    Parameters
    ----------
    guess : Guess or RowsGuess
        The fields to resolve: contact and fluid pressure to ``tolerance``, relative to what a Hertz pressure has at that
        distance from its edge, the square root of the half-width of the panel; the viscous shear 1/h, relative to that at
        zero, to ``tolerance`` too, the logarithm of the gap to ten times that.
    groups : Groups
        Scalar groups; columns for states in rows.
    law : ContactLaw
        Contact pressure from the gap.
    order : int
        Nodes a panel.
    tolerance : float
        Legendre tail allowed on each panel.
    profile_tolerance : float
        That of the logarithm of the gap on all other panels, where it is below ten times ``tolerance``.
    gap_tolerance : float
        That of the logarithm of the gap on the panels where the central and the least gap are read off.

    Raises
    ------
    MeshTooLargeError
        If more panels are needed than :data:`mesh.MAX_PANELS`.
    """
    central_gap = np.exp(guess.fields(np.zeros(1))[0])
    width = np.sqrt(1.0 + central_gap)
    scale = 2.0 ** round(float(np.log2(width).mean()))

    def fields(x: Array, half_widths: Array, stretch: Array) -> Array:
        flat = x.ravel()
        found = guess.fields(flat)
        gap = np.exp(found[0])
        if len(found) == 2:
            fluid = found[1]
        else:
            slopes = groups.speed * (gap - guess.flux_gap) / gap**3
            fluid = slopes * np.repeat(half_widths, x.shape[1])
        edge_scale = np.minimum(1.0, half_widths / width) ** 0.5
        pressures = width / np.repeat(edge_scale, x.shape[1], axis=-1) * np.stack([law.pressure(gap), fluid])
        nodal = (*gap.shape[:-1], *x.shape)
        shape = (found[0] - np.log(scale**2 + flat * flat)).reshape(nodal)
        centres = x.mean(axis=1)
        at_zero = np.abs(centres) <= (1 + ROUNDING) * half_widths
        read_off = at_zero | (np.abs(centres - guess.least_position) <= half_widths)
        read_off &= stretch[:, 0] == 1.0
        weight = max(0.1, tolerance / profile_tolerance)
        shape = shape * np.where(read_off, max(weight, tolerance / gap_tolerance), weight)[..., None]
        shear = (np.exp(-found[0]) * central_gap).reshape(nodal)
        return np.concatenate([stretch * pressures.reshape(2, *nodal), shape[None], shear[None]])

    start = guess.mesh if isinstance(guess, State) else None
    reach = (8 if order < LONG_REACH_ORDER else 16) * scale
    return adapt(fields, scale, reach, order, tolerance, start)
