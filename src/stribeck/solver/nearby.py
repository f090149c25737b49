"""States of a contact that is changed by hand: each starts from the last one, in a millisecond instead of thirty."""

from __future__ import annotations

import math

import numpy as np

from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Groups
from stribeck.equations.state import State
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outcome import Outcome
from stribeck.solver.path.corrector import Corrector
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solution import Solution
from stribeck.solver.solve import as_groups, check_rtol, finish, hertz_solution, solved_point
from stribeck.solver.solve_error import SolveError

__all__ = ["WarmStartSolver"]

MAX_GROUP_RATIO = 30.0  # Change of a group beyond which the last state is no guess of the next


class WarmStartSolver:
    """Solves one state after another, each from the last one if that is close, else from cold."""

    def __init__(self, rtol: float = 1e-6) -> None:
        rtol = check_rtol(rtol)
        self.rtol = rtol
        self._target = Groups(0.0, 1.0, 0.0)
        self._corrector = Corrector(lambda _: self._target, rtol)
        self._last: RefinedState | None = None

    @one_blas_thread
    def __call__(self, problem: Groups | Contact) -> Solution:
        """Return the state of a contact or of its groups."""
        groups, contact = as_groups(problem)
        if groups.is_hertzian:
            return hertz_solution(groups, contact, self.rtol)
        point = self._from_last(groups)
        if point is None:
            point = solved_point(groups, self.rtol)
            self._corrector = Corrector(lambda _: self._target, self.rtol)
        solution = finish(point, groups, contact, self.rtol)
        self._last = point
        return solution

    @property
    def state(self) -> State:
        """The last state in the unknowns of the equations."""
        if self._last is None or self._last.state is None:
            raise ValueError("no state has been solved yet")
        return self._last.state

    def beside(self) -> WarmStartSolver:
        """Return another solver that starts from the last state of this one."""
        other = WarmStartSolver(self.rtol)
        other._last = self._last
        return other

    def _from_last(self, groups: Groups) -> RefinedState | None:
        """Return the state that Newton's iteration finds from the last one, or None."""
        if self._last is None or not _are_close(self._last.groups, groups):
            return None
        self._target = groups
        try:
            point = self._corrector(1.0, [(0.0, self._last)])
        except (SolveError, FloatingPointError, np.linalg.LinAlgError):
            return None
        if point is None or point.state is None or point.outcome is not Outcome.CONVERGED:
            return None
        return point


def _are_close(last: Groups, new: Groups) -> bool:
    """Return whether no group changed by more than a factor, or from or to zero."""
    for name in ("speed", "load", "roughness"):
        before, after = float(getattr(last, name)), float(getattr(new, name))
        if (before == 0) != (after == 0) or (before and abs(math.log(after / before)) > math.log(MAX_GROUP_RATIO)):
            return False
    return True
