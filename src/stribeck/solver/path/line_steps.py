"""States of the line one from another: on the mesh of the previous state while it resolves, else on a refined one."""

import math
from collections import deque
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Groups
from stribeck.equations.enriched import FineOperators
from stribeck.equations.error_estimate import gap_is_resolved
from stribeck.equations.observables import ROW, area_of_state
from stribeck.equations.operators import Operators
from stribeck.equations.sensitivity import Change, log_derivatives
from stribeck.equations.state import Guess, State, extrapolate, solve_state
from stribeck.fluids.fluid import Cavitation
from stribeck.numerics.newton import Inverse
from stribeck.numerics.settings import MAX_BYTES, NEGLIGIBLE, SHARE, STEP_GROWTH
from stribeck.quantities.outputs import AREA
from stribeck.solver.at_rest import with_positive_gap
from stribeck.solver.cold_start import first_path
from stribeck.solver.refinement import RefinedState, converge, mesh_tolerances_for, newton_tolerance, verify
from stribeck.solver.solution import Solution
from stribeck.solver.solve import finish, solved_point, stated_errors
from stribeck.solver.solve_error import SolveError


class LineSteps:
    """Solves states of the line one from another, on one mesh while that resolves them."""

    # The operators of the mesh cost as much as several states.

    order = 4  # Degree of the polynomial that predicts a state from those along a line

    def __init__(self, rtol: float) -> None:
        self.rtol = rtol
        self.operators: Operators | None = None
        self.fine: FineOperators | None = None
        self.inverse: Inverse | None = None
        self.left: deque[tuple[Operators, FineOperators | None]] = deque()
        self.tolerances = mesh_tolerances_for(rtol)

    def start(self, groups: Groups) -> RefinedState:
        """Return a state from cold."""
        path = None if _cavity_may_vanish(groups) else first_path(with_positive_gap(groups)[0])
        if path is not None and path.outcome.ok:
            found = self._adopt(converge(path.states[-1], groups, self.rtol, self.tolerances, spread=NEGLIGIBLE))
            if found.outcome.ok:
                return found
        return self._kept(solve_cold_line(groups, self.rtol))

    def from_cold(self, groups: Groups) -> RefinedState:
        """Return a state from cold, on the mesh that suits it best."""
        return solve_cold_line(groups, self.rtol)

    def follow(self, line: Sequence[tuple[float, RefinedState]], groups: Groups) -> RefinedState:
        """Return a state from those along a line, the nearest last, from cold where that fails."""
        with suppress(SolveError, FloatingPointError, np.linalg.LinAlgError):
            self.move_to(line[-1][1])
            known = [(s, each.state) for s, each in line if each.state is not None]
            # Of films that may re-form, with a cavity or without.
            ending = known[-1][1].groups.model.cavitation
            found = self.solve(extrapolate([each for each in known if each[1].groups.model.cavitation is ending], 0.0), groups)
            if found.outcome.ok:
                return found
        return self.start(groups)

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

    def kept(self, state: RefinedState) -> RefinedState:
        """Return the state, whose operators may be dropped."""
        return state

    def observed(
        self,
        state: RefinedState,
        names: Sequence[str],
        changes: Sequence[Change],
        by: Sequence[str],
        inputs: Mapping[str, float],
    ) -> tuple[Array, Array, Array]:
        """Return observables with their derivatives and errors, those by all groups at once."""
        assert state.state is not None and state.values is not None and state.estimate is not None
        values = state.values.array()
        stated = stated_errors(state.estimate.relative, values, state.groups, self.rtol)
        known = dict(zip(ROW, zip(values, stated, strict=False), strict=False))
        if AREA in names:
            known[AREA] = area_of_state(state.state, float(known["contact_load_share"][1]))
        values, errors = np.array([known[name] for name in names]).T
        derivatives = log_derivatives(state.state, changes)
        return values, np.stack([derivatives[name] for name in names]), errors

    def finish(self, state: RefinedState, groups: Groups, contact: Contact | None) -> Solution:
        """Return a state as a solution, or raise the error of its outcome."""
        return finish(state, groups, contact, self.rtol)

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
            state = solve_state(base, self.operators, guess, newton_tolerance(self.rtol), kept=self.inverse)
            if state.outcome.ok:
                if self._is_resolved(state, spread):
                    point = verify(state, groups, self.fine, self.rtol)
                    if point.outcome.ok:
                        return self._kept(point)
                guess = state
        return self._adopt(converge(guess, groups, self.rtol, self.tolerances, spread=spread))

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

    def _relax(self) -> None:
        """Widen the mesh tolerances by a factor, up to those of a first mesh."""
        tail, gap_tail = mesh_tolerances_for(self.rtol)
        self.tolerances = min(tail, STEP_GROWTH * self.tolerances[0]), min(gap_tail, STEP_GROWTH * self.tolerances[1])

    def _change_to(self, operators: Operators, fine: FineOperators | None) -> None:
        """Take another mesh, and drop the largest operators of the meshes left longest ago."""
        if self.operators is not None:
            vars(self.operators).pop("deflecting", None)
            self.left.append((self.operators, self.fine))
        while sum(each.mesh.nodes.nbytes * each.mesh.size for each, _ in self.left) > MAX_BYTES:
            for operators_left in filter(None, self.left.popleft()):
                for name in ("deflection", "of_highest"):
                    vars(operators_left).pop(name, None)
        self.operators, self.fine = operators, fine

    def _adopt(self, point: RefinedState) -> RefinedState:
        if point.state is not None and point.outcome.ok:
            self._change_to(point.state.equations.operators, point.fine)
            self.tolerances = point.tolerances or self.tolerances
            self._relax()
        return self._kept(point)


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
    try:
        return solved_point(groups, rtol)
    except SolveError as failure:
        return RefinedState(groups, None, None, None, failure.outcome, message=str(failure))
