"""How the observables of a solved ball answer to its groups."""

from __future__ import annotations

from stribeck._types import Array
from stribeck.contacts.model import ARTICLE
from stribeck.equations.point.sensitivity import log_derivatives
from stribeck.quantities.units import InputError
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

    Raises
    ------
    InputError
        If the fluid, its cavitation or the solid is not that of the article.
    """
    if state.groups.model != ARTICLE:
        raise InputError(
            "derivatives of a ball are for a Newtonian fluid that does not cavitate, on a half-space; fits and sensitivities "
            "of a ball leave other fluids, cavitation and solids out."
        )
    pair = state.work
    assert isinstance(pair, Pair)
    level = pair.fine
    band = band_for(level.equations.speed, level.equations.law)
    return log_derivatives(level.equations, level.unknowns, state.groups, band, level.iterated.preconditioner)
