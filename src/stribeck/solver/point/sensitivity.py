"""How the observables of a solved ball answer to its groups, and to the numbers of its fluid and solid."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups
from stribeck.equations.point.sensitivity import Direction, log_derivatives
from stribeck.fluids.cavitation import Cavitation
from stribeck.quantities.units import InputError
from stribeck.solver.point.level import band_for
from stribeck.solver.point.refinement import Pair
from stribeck.solver.point.state import PointState

__all__ = ["GROUPS", "derivatives_along", "state_derivatives"]

GROUPS = ("speed", "load", "roughness")


def state_derivatives(state: PointState) -> dict[str, Array]:
    """Return the derivatives of all observables with respect to ln(speed), ln(load) and ln(roughness).

    Parameters
    ----------
    state : PointState
        A converged state of positive speed, as the solver returned it.

    Returns
    -------
    dict of str to ndarray, shape (3,)
        By the names of the observables, the other two groups and the model held; zero with respect to a group that is zero.

    Raises
    ------
    InputError
        If the film breaks.
    """
    groups = state.groups
    alive = {name: partial(_moved, groups, name) for name in GROUPS if float(getattr(groups, name)) > 0}
    found = derivatives_along(state, alive)
    zero = np.array([name not in alive for name in GROUPS])
    columns = np.cumsum(~zero) - 1
    return {name: np.where(zero, 0.0, column[columns]) for name, column in found.items()}


def derivatives_along(state: PointState, directions: Mapping[str, Direction]) -> dict[str, Array]:
    """Return the derivatives of all observables along directions.

    Parameters
    ----------
    state : PointState
        As for :func:`state_derivatives`.
    directions : mapping of str to callable
        The groups, with their model, after a step of a logarithm.

    Returns
    -------
    dict of str to ndarray
        By the names of the observables, one number for each direction.

    Raises
    ------
    InputError
        If the film breaks.
    """
    if state.groups.model.cavitation is not Cavitation.NONE:
        raise InputError(
            f"cavitation = {str(state.groups.model.cavitation)!r}: derivatives of a ball are for a film that does not break, "
            "'none'; sensitivities of a ball leave cavitation out."
        )
    pair = state.work
    assert isinstance(pair, Pair)
    level = pair.fine
    band = band_for(level.equations.speed, level.equations.law)
    return log_derivatives(level.equations, level.unknowns, directions, band, level.iterated.preconditioner)


def _moved(groups: Groups, name: str, step: float) -> Groups:
    return replace(groups, **{name: float(getattr(groups, name)) * math.exp(step)})  # type: ignore[arg-type]
