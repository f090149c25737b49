"""Friction of many states with its derivatives, for fits: read off the atlas, solved, or whichever holds.

The two parts of the friction come for boundary_friction = beta = 1, so that both may differ from state to state.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.atlas.tables import table_for
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Groups, Physics
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.equations.sensitivity import log_derivatives
from stribeck.quantities.outputs import NAMES
from stribeck.quantities.units import InputError
from stribeck.solver.solve import SolveError

__all__ = ["FrictionParts", "PartsOf", "atlas_parts", "atlas_or_solved_parts", "solved_parts"]


@dataclass(frozen=True)
class FrictionParts:
    """Both parts of the friction of n states for boundary_friction = beta = 1, and their derivatives.

    Parameters
    ----------
    values : ndarray, shape (2, n)
        Contact load share and viscous friction [-].
    slopes : ndarray, shape (2, 3, n)
        Derivatives of each by the logarithms of the groups of speed, load and roughness [-].
    errors : ndarray, shape (2, n)
        Estimated absolute error of the contact load share, and relative error of the viscous friction.
    """

    values: Array
    slopes: Array
    errors: Array


PartsOf = Callable[[Groups], FrictionParts]
"""What gives the parts of the friction of states in a row."""


def atlas_parts(definition: Definition) -> PartsOf:
    """Return the function that reads states off the atlas; it raises InputError outside."""

    def parts(groups: Groups) -> FrictionParts:
        values, by_contact, by_viscous = atlas.friction_parts(groups, definition)
        return FrictionParts(values, np.stack([by_contact, by_viscous]), np.full(values.shape, table_for(groups).error))

    return parts


def solved_parts(definition: Definition, rtol: float) -> PartsOf:
    """Return the function that solves states, those that differ in speed alone as one curve.

    Parameters
    ----------
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    rtol : float
        Relative tolerance of each state.

    Returns
    -------
    callable
        Groups of many states -> their :class:`FrictionParts`; raises SolveError where a state cannot be solved.
    """

    def parts(groups: Groups) -> FrictionParts:
        speed, load, roughness = (np.broadcast_to(g, groups.shape) for g in (groups.speed, groups.load, groups.roughness))
        n = groups.shape[0]
        values, slopes, errors = np.empty((2, n)), np.empty((2, 3, n)), np.empty((2, n))
        pairs, pair_of = np.unique(np.stack([load, roughness], axis=1), axis=0, return_inverse=True)
        for k, (F, h_rms) in enumerate(pairs):
            rows = np.nonzero(pair_of.ravel() == k)[0]
            speeds, at = np.unique(speed[rows], return_inverse=True)
            found = _along(speeds, float(F), float(h_rms), definition, rtol, groups.physics)
            values[:, rows], slopes[:, :, rows], errors[:, rows] = (array[..., at.ravel()] for array in found)
        return FrictionParts(values, slopes, errors)

    return parts


def atlas_or_solved_parts(definition: Definition, rtol: float) -> PartsOf:
    """Return the function that reads the states off the atlas where it holds all of them, and else solves them."""
    quick, slow = atlas_parts(definition), solved_parts(definition, rtol)

    def parts(groups: Groups) -> FrictionParts:
        try:
            return quick(groups)
        except InputError:
            return slow(groups)

    return parts


def _along(
    speeds: Array, load: float, roughness: float, definition: Definition, rtol: float, physics: Physics
) -> tuple[Array, Array, Array]:
    """Return values, slopes and errors of the states of a curve at ascending speeds."""
    # A pair would be taken as a range, and one speed is no curve.
    points = speeds if len(speeds) > 1 else np.append(speeds, 1.1 * speeds)
    groups = Groups(points[0], load, roughness, **physics)
    curve = stribeck_curve(groups, speed=points, points=len(points), rtol=rtol, definition=definition)
    row = NAMES.index(f"viscous_{definition}")
    n = len(speeds)
    if len(curve) < len(points):
        raise SolveError(curve.outcome, None, f"load {load:.6g}, roughness {roughness:.6g}: {curve.outcome.value}")
    values, slopes, errors = np.empty((2, n)), np.empty((2, 3, n)), np.empty((2, n))
    for i, (solution, point) in enumerate(zip(curve.solutions[:n], curve._points[:n], strict=True)):
        assert point.state is not None
        found = solution.observables.array()
        values[:, i] = found[0], found[row]
        derivatives = log_derivatives(point.state)
        slopes[:, :, i] = derivatives["contact_load_share"], derivatives[f"viscous_{definition}"]
        errors[:, i] = solution.relative_errors[[0, row]]
    return values, slopes, errors
