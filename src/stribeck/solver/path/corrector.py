"""Correcting a prediction: on the mesh of the previous state while it resolves, else on a refined one."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import replace

from stribeck.contacts.groups import Groups
from stribeck.equations.error_estimate import FineOperators, gap_is_resolved
from stribeck.equations.guess import Guess
from stribeck.equations.line import Operators
from stribeck.equations.state import State, solve_state
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.newton import Inverse
from stribeck.numerics.settings import MAX_BYTES, NEGLIGIBLE, SHARE, STEP_GROWTH
from stribeck.solver.at_rest import with_positive_gap
from stribeck.solver.cold_start import first_path
from stribeck.solver.refinement import RefinedState, converge, mesh_tolerances_for, newton_tolerance, verify


class Corrector:
    """Solves states one from another, on one mesh while that resolves them."""

    # The operators of the mesh cost as much as several states.  The inverse of a neighbour's Jacobian, with which the
    # iteration ends, may misjudge a defect by half: with ``own_inverse`` states are verified with their own.

    def __init__(self, rtol: float, own_inverse: bool = False) -> None:
        self.rtol = rtol
        self.own_inverse = own_inverse
        self.operators: Operators | None = None
        self.fine: FineOperators | None = None
        self.inverse: Inverse | None = None
        self.left: deque[tuple[Operators, FineOperators | None]] = deque()
        self.tolerances = self._widest

    def cold(self, groups: Groups) -> RefinedState | None:
        """Return the state of ``groups`` from cold; None if no path leads there."""
        if _cavity_may_vanish(groups):
            return self._kept(solve_cold_line(groups, self.rtol))
        path = first_path(with_positive_gap(groups)[0])
        if not path.outcome.ok:
            return None
        return self._adopt(
            converge(path.states[-1], groups, self.rtol, self.tolerances, spread=NEGLIGIBLE, own_inverse=self.own_inverse)
        )

    def solve(self, guess: Guess, groups: Groups, spread: float = 0.0) -> RefinedState:
        """Return the state of ``groups`` from a guess; ``spread`` as for :func:`stribeck.equations.mesh_choice.mesh_for`."""
        if not _cavity_may_vanish(groups):
            return self._solve(guess, groups, spread)
        re_forms = guess.reformation < math.inf
        if isinstance(guess, State) or re_forms:  # one with as many unknowns as the state before
            model = guess.groups.model if isinstance(guess, State) and not re_forms else groups.model
            point = self._solve(guess, replace(groups, model=model), spread)
            if point.outcome.ok and keeps_cavity(point, groups):
                return replace(point, groups=groups)
        return self._kept(solve_cold_line(groups, self.rtol))

    def move_to(self, point: RefinedState) -> None:
        """Take the mesh of a state that was solved before."""
        if point.state is None or point.state.mesh is (None if self.operators is None else self.operators.mesh):
            return
        operators = point.state.equations.operators
        self.left = deque(each for each in self.left if each[0] is not operators)
        self._change_to(operators, point.fine)
        self.inverse = None

    def _solve(self, guess: Guess, groups: Groups, spread: float) -> RefinedState:
        base = with_positive_gap(groups)[0]
        if self.operators is not None and self.fine is not None:
            if base.model != self.operators.model:
                self.operators, self.inverse = Operators(self.operators.mesh, base.model), None
            state = solve_state(
                base,
                self.operators,
                guess,
                newton_tolerance(self.rtol, self.own_inverse),
                kept=self.inverse,
            )
            if state.outcome.ok:
                if self._is_resolved(state, spread):
                    own = state.corrected() if self.own_inverse else state
                    point = verify(own, groups, self.fine, self.rtol)
                    if point.outcome.ok:
                        kept = self._kept(point)
                        return point if self.own_inverse else kept
                guess = state
        return self._adopt(converge(guess, groups, self.rtol, self.tolerances, spread=spread, own_inverse=self.own_inverse))

    def _is_resolved(self, state: State, spread: float) -> bool:
        centre = -state.exit / state.cavity_stretch
        part = SHARE if spread > 0 else 1.0
        return gap_is_resolved(state.mesh, state.gap, part * self.rtol, centre=centre, spread=spread)

    def _kept(self, point: RefinedState) -> RefinedState:
        """Return the state without its inverse, which the corrector keeps for the next state."""
        if point.state is None:
            return point
        same_mesh = self.operators is not None and point.state.mesh is self.operators.mesh
        self.inverse = point.state.root.inverse if same_mesh else None
        return replace(point, state=point.state.without_inverse())

    @property
    def _widest(self) -> tuple[float, float]:
        """Mesh tolerances of a first mesh; that of a path resolves the minimum of neighbouring gaps too."""
        tail, gap_tail = mesh_tolerances_for(self.rtol)
        return tail, NEGLIGIBLE * gap_tail if self.own_inverse else gap_tail

    def _relax(self) -> None:
        """Widen the mesh tolerances by a factor, up to those of a first mesh."""
        tail, gap_tail = self._widest
        self.tolerances = min(tail, STEP_GROWTH * self.tolerances[0]), min(gap_tail, STEP_GROWTH * self.tolerances[1])

    def _change_to(self, operators: Operators, fine: FineOperators | None) -> None:
        """Take another mesh, and drop the largest operators of the meshes left longest ago."""
        if self.operators is not None:
            vars(self.operators).pop("deflecting", None)
            self.left.append((self.operators, self.fine))
        while sum(each.mesh.nodes.nbytes * each.mesh.size for each, _ in self.left) > MAX_BYTES:
            for operators_left in filter(None, self.left.popleft()):
                for name in ("deflection", "_of_highest"):
                    vars(operators_left).pop(name, None)
        self.operators, self.fine = operators, fine

    def _adopt(self, point: RefinedState) -> RefinedState:
        if point.state is not None and point.outcome.ok:
            self._change_to(point.state.equations.operators, point.fine)
            self.tolerances = point.tolerances or self.tolerances
            self._relax()
        kept = self._kept(point)
        return point if self.own_inverse else kept


def _cavity_may_vanish(groups: Groups) -> bool:
    """Return whether a film may have a cavity or none, so that neighbours may have other unknowns."""
    return with_positive_gap(groups)[0].model.cavitation is Cavitation.REFORM


def keeps_cavity(point: RefinedState, groups: Groups) -> bool:
    """Return whether a state has a cavity, or is a full film whose suction would not rupture it."""
    state = point.state
    if state is None or state.groups.model.cavitation is not Cavitation.NONE:
        return True
    return state.lowest_pressure >= groups.model.cavity_pressure


def solve_cold_line(groups: Groups, rtol: float) -> RefinedState:
    """Return the state from cold, with the outcome of the failure if there was one."""
    from stribeck.solver.solve import solved_point
    from stribeck.solver.solve_error import SolveError

    try:
        return solved_point(groups, rtol)
    except SolveError as failure:
        return RefinedState(groups, None, None, None, failure.outcome, message=str(failure))
