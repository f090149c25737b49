"""Correcting a prediction: on the mesh of the previous state while it resolves, else on a refined one."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import replace

from stribeck.contacts.groups import contact_law
from stribeck.contacts.line import Groups
from stribeck.equations.error_estimate import FineOperators, gap_is_resolved
from stribeck.equations.guess import Guess
from stribeck.equations.line import Operators
from stribeck.equations.prediction import extrapolate
from stribeck.equations.state import State, mesh_for, solve_state
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.newton import Inverse
from stribeck.numerics.panels import MeshTooLargeError
from stribeck.quantities.outcome import Outcome
from stribeck.solver.at_rest import with_positive_gap
from stribeck.solver.cold_start import first_path
from stribeck.solver.refinement import RefinedState, converge, mesh_tolerances_for, newton_tolerance, order_for, verify

MOST_STEPS = 16
"""Newton and chord steps after which the current mesh is given up."""

ROUGH = 1e-4
"""Tolerance of Newton's iteration for a state from which a mesh is chosen."""

FAR_OFF = 1e-3
"""Error of a guess above which such a state tells whether the current mesh resolves it."""

LEFT = 2e7
"""Entries of the operators of meshes left last that are kept, as what lies between states is judged with them: those of all
meshes of a curve of hundreds of states take gigabytes."""

ON_THE_WAY = 0.4
"""Part of the tolerance to which a kept mesh must resolve the gap around its minimum: on the way there from the last state it
may resolve it worse, and halving that way would not help."""

CHECK_EVERY = 25
"""States between two tests of whether a coarser mesh would do."""

WORTH_COARSENING = 0.85
"""Ratio of sizes from which the coarser mesh is taken."""

RELAX = 3.0
"""Factor by which mesh tolerances are raised again after they had to be lowered."""

FIRST_SPREAD = 0.1
"""Distance from its minimum up to which the gap of a first state is resolved: it moves to the next one."""

MOVING = 0.5
"""Part of the tolerances of a mesh that moves with the end of a film: the contact passes through its panels."""


class Corrector:
    """Solve states one after another: ``groups_at(s)`` gives the groups at coordinate s.

    It keeps the operators of the current mesh, which cost as much as several states.  Its meshes resolve the gap to
    ``gap_part`` of the usual tolerance where the gap is read off.

    With ``own_inverse`` states are verified with the inverse of their own Jacobian, and hold it; else they hold none.  That of
    a neighbour, with which the iteration ends, may be wrong by half in what a defect does.
    """

    def __init__(
        self, groups_at: Callable[[float], Groups], rtol: float, gap_part: float = 1.0, own_inverse: bool = False
    ) -> None:
        self.groups_at = groups_at
        self.rtol = rtol
        self.gap_part = gap_part
        self.own_inverse = own_inverse
        self.operators: Operators | None = None
        self.fine: FineOperators | None = None
        self.inverse: Inverse | None = None
        self.since_check = 0
        self.left: deque[tuple[Operators, FineOperators | None]] = deque()
        self.tolerances = self._widest

    def __call__(self, s: float, history: Sequence[tuple[float, RefinedState]]) -> RefinedState | None:
        """Return the state at ``s`` predicted from ``history``; from cold if that is empty."""
        groups = self.groups_at(s)
        if not history:
            return self.cold(groups)
        return self.solve(extrapolate([(c, p.state) for c, p in history if p.state is not None], s), groups)

    def cold(self, groups: Groups) -> RefinedState | None:
        """Return the state of ``groups`` from cold; None if no path leads there."""
        if _cavity_may_vanish(groups):
            return self._kept(from_cold(groups, self.rtol))
        path = first_path(with_positive_gap(groups)[0])
        if path.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if not path.outcome.ok:
            return None
        return self._adopt(converge(path.states[-1], groups, self.rtol, spread=FIRST_SPREAD, own_inverse=self.own_inverse))

    def solve(self, guess: Guess, groups: Groups, spread: float = 0.0) -> RefinedState:
        """Return the state of ``groups`` from a guess; ``spread`` as for :func:`stribeck.equations.state.mesh_for`."""
        if not _cavity_may_vanish(groups):
            return self._solve(guess, groups, spread)
        forms_anew = guess.restart < math.inf
        if isinstance(guess, State) or forms_anew:  # one with as many unknowns as the state before
            model = guess.groups.model if isinstance(guess, State) and not forms_anew else groups.model
            point = self._solve(guess, replace(groups, model=model), spread)
            if point.outcome.ok and keeps_cavity(point, groups):
                return replace(point, groups=groups)
        return self._kept(from_cold(groups, self.rtol))

    def _solve(self, guess: Guess, groups: Groups, spread: float) -> RefinedState:
        base = with_positive_gap(groups)[0]
        if self.operators is not None and self.fine is not None:
            if base.model != self.operators.model:
                self.operators, self.inverse = Operators(self.operators.mesh, base.model), None
            state = self._on_kept_mesh(guess, base, spread)
            if state.outcome.ok:
                if self._is_resolved(state, spread):
                    own = state.corrected() if self.own_inverse else state
                    point = verify(own, groups, self.fine, self.rtol)
                    if point.outcome.ok:
                        self._look_for_coarser(state)
                        kept = self._kept(point)
                        return point if self.own_inverse else kept
                guess = state
        part = 1.0 if base.model.cavitation is Cavitation.NONE else MOVING
        tail, gap_tail = self.tolerances
        tolerances = part * tail, part * gap_tail
        return self._adopt(converge(guess, groups, self.rtol, tolerances, spread=spread, own_inverse=self.own_inverse))

    def _on_kept_mesh(self, guess: Guess, base: Groups, spread: float) -> State:
        """Return the state on the current mesh; only a rough one if it is far from the guess and needs a finer mesh anyhow."""
        assert self.operators is not None
        rough = solve_state(base, self.operators, guess, ROUGH, MOST_STEPS, self.inverse)
        if not rough.outcome.ok:
            return rough
        if rough.prediction_error > FAR_OFF and not self._is_resolved(rough, spread):
            return rough
        if self.own_inverse and rough.root.last_step * rough.root.contraction <= newton_tolerance(self.rtol, own_inverse=True):
            return rough
        state = solve_state(base, self.operators, rough, newton_tolerance(self.rtol), MOST_STEPS, rough.root.inverse)
        return replace(state, prediction_error=max(state.prediction_error, rough.prediction_error))

    def _is_resolved(self, state: State, spread: float) -> bool:
        centre = -state.exit / state.dilation
        part = ON_THE_WAY if spread > 0 else 1.0
        return gap_is_resolved(state.mesh, state.gap, part * self.rtol, centre=centre, spread=spread)

    def _kept(self, point: RefinedState) -> RefinedState:
        """Return the state without its inverse, which is kept here for the next one."""
        if point.state is None:
            return point
        same_mesh = self.operators is not None and point.state.mesh is self.operators.mesh
        self.inverse = point.state.root.inverse if same_mesh else None
        return replace(point, state=point.state.without_inverse())

    def _look_for_coarser(self, state: State) -> None:
        """From time to time, take the mesh for wider tolerances if it is clearly smaller than the current one."""
        self.since_check += 1
        if self.since_check < CHECK_EVERY:
            return
        self.since_check = 0
        self._relax()
        try:
            mesh = mesh_for(state, state.groups, contact_law(state.groups), order_for(self.rtol), *self.tolerances)
        except MeshTooLargeError:
            return
        if mesh.size < WORTH_COARSENING * state.mesh.size:
            self._change_to(Operators(mesh, state.groups.model), FineOperators(mesh))
            self.inverse = None

    @property
    def _widest(self) -> tuple[float, float]:
        """The tolerances of a first mesh."""
        tail, gap_tail = mesh_tolerances_for(self.rtol)
        return tail, self.gap_part * gap_tail

    def _relax(self) -> None:
        """Widen the tolerances, up to the widest."""
        tail, gap_tail = self._widest
        self.tolerances = min(tail, RELAX * self.tolerances[0]), min(gap_tail, RELAX * self.tolerances[1])

    def move_to(self, operators: Operators, fine: FineOperators) -> None:
        """Go on with a mesh that is known already."""
        if self.operators is None or self.operators.mesh is not operators.mesh:
            self._change_to(operators, fine)
            self.inverse = None

    def _change_to(self, operators: Operators, fine: FineOperators | None) -> None:
        """Take another mesh; of the operators of those that were left, the largest are made anew if they are asked for."""
        if self.operators is not None:
            vars(self.operators).pop("deflection_of_gradient", None)
            self.left.append((self.operators, self.fine))
        while sum(each.mesh.size**2 for each, _ in self.left) > LEFT:
            for operators_left in filter(None, self.left.popleft()):
                for name in ("deflection", "_of_highest"):
                    vars(operators_left).pop(name, None)
        self.operators, self.fine = operators, fine

    def _adopt(self, point: RefinedState) -> RefinedState:
        if point.state is not None and point.outcome.ok:
            self._change_to(point.state.equations.operators, point.fine)
            self.tolerances = point.tolerances or self.tolerances
            self._relax()
            self.since_check = 0
        kept = self._kept(point)
        return point if self.own_inverse else kept


def _cavity_may_vanish(groups: Groups) -> bool:
    """Return whether a film may have a cavity or none: neighbours may then have other unknowns."""
    return groups.model.cavitation is Cavitation.REFORM and bool(groups.speed > 0)


def keeps_cavity(point: RefinedState, groups: Groups) -> bool:
    """Return whether a state may stay as it is: one with a cavity always, a full film if its suction would not rupture it."""
    state = point.state
    if state is None or state.groups.model.cavitation is not Cavitation.NONE:
        return True
    return state.lowest_pressure >= groups.model.cavity_pressure


def from_cold(groups: Groups, rtol: float) -> RefinedState:
    """Return the state from cold, with the outcome of the failure if there was one."""
    from stribeck.solver.solve import SolveError, solved_point

    try:
        return solved_point(groups, rtol)
    except SolveError as failure:
        return RefinedState(groups, None, None, None, failure.outcome)
