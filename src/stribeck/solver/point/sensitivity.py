"""How the observables of a solved ball answer to its groups."""

from __future__ import annotations

from stribeck._types import Array
from stribeck.equations.point.sensitivity import log_derivatives
from stribeck.solver.point.level import band_for
from stribeck.solver.point.refinement import Pair
from stribeck.solver.point.state import PointState

__all__ = ["state_derivatives"]


def state_derivatives(state: PointState) -> dict[str, Array]:
    """Return the derivatives of all observables with respect to ln(speed), ln(load) and ln(roughness).

    Parameters
    ----------
    state : PointState
        A converged state of positive speed, as the solver returned it.

    Returns
    -------
    dict of str to ndarray, shape (3,)
        By the names of the observables.
    """
    pair = state.work
    assert isinstance(pair, Pair)
    level = pair.fine
    band = band_for(level.equations.speed, level.equations.law)
    return log_derivatives(level.equations, level.unknowns, state.groups, band, level.iterated.preconditioner)
