"""What a state of the solver becomes for users: a solution, or an error that says what failed."""

from __future__ import annotations

import math

from stribeck.contacts.contact import Contact
from stribeck.solver.point.solution import PointSolution, solution_of
from stribeck.solver.point.state import OBSERVABLES, PointState
from stribeck.solver.solve import SolveError, describe

__all__ = ["finish_point"]


def finish_point(state: PointState, contact: Contact | None, on_failure: str = "raise") -> PointSolution:
    """Return the solution that a state is, or raise what its outcome asks for.

    Parameters
    ----------
    state : PointState
        What was reached.
    contact : Contact or None
        The contact in SI units it came from.
    on_failure : {"raise", "return"}
        What to do where the tolerance was not reached.

    Returns
    -------
    PointSolution
        The solution.

    Raises
    ------
    SolveError
        If the state failed, unless ``on_failure`` is ``"return"`` and there is one to return.
    """
    is_there = all(math.isfinite(state.values.get(name, math.nan)) for name in OBSERVABLES)
    solution = solution_of(state, contact) if is_there else None
    if solution is not None and (state.outcome.ok or on_failure == "return"):
        return solution
    reached = "" if solution is None else f" Achieved: {solution.error_estimate:.1e}, requested: {state.rtol:.1e}."
    raise SolveError(state.outcome, solution, f"{describe(state.groups)}, of a ball: {state.outcome.value}{reached}")
