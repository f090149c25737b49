"""Correcting a path: prediction, a mesh kept for as long as it resolves, refinement where it does not.

The stepping is :func:`continuation.march`; here is what it corrects with.
"""

from __future__ import annotations

import math
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
from stribeck.solver.judgement import verify_together
from stribeck.solver.refinement import RefinedState, converge, mesh_tolerances_for, newton_tolerance, order_for, verify

MOST_STEPS = 16
"""Newton and chord steps after which the present mesh is given up."""

ROUGH = 1e-2
"""Error of a prediction from which the mesh that was made for it is looked at again: it is finer than need be."""

MOST_WAITING = 8
"""Points that may wait to be verified together."""

WAITING_NODES = 4000
"""Nodes that they may have in all: each may keep the factors of a matrix as large as its own."""

PATIENCE = 0.6
"""How many wait where the errors at the nodes are as large as the tolerance; the smaller they are, the more."""

FINER_THAN_NEEDED = 0.1
"""Part of the tolerance below which the errors at the nodes call for a coarser mesh."""

CHECK_EVERY = 25
"""Points between two looks at whether a coarser mesh would do."""

WORTH_COARSENING = 0.85
"""Ratio of sizes from which the coarser mesh is taken."""

RELAX = 3.0
"""Factor by which a mesh tolerance that once had to be lowered is raised again at such a look."""


class Corrector:
    """Solve the states of a path from predictions: ``groups_at(s)`` gives the groups at coordinate s.

    It keeps the operators of the present mesh, whose making costs as much as several states.  With ``postpone`` a state on it
    that looks resolved is verified later, together with others, by :meth:`verify_waiting`.
    """

    def __init__(self, groups_at: Callable[[float], Groups], rtol: float, postpone: bool = False) -> None:
        self.groups_at = groups_at
        self.rtol = rtol
        self.postpone = postpone
        self.waiting: list[tuple[RefinedState, Inverse]] = []
        self.at_nodes = math.inf  # error there of the last point that was verified, in units of rtol
        self.operators: Operators | None = None
        self.fine: FineOperators | None = None
        self.inverse: Inverse | None = None
        self.since_check = 0
        self.tolerances = mesh_tolerances_for(rtol)

    def __call__(self, s: float, history: Sequence[tuple[float, RefinedState]]) -> RefinedState | None:
        """Return the point at ``s`` predicted from ``history``; from cold where that is empty."""
        groups = self.groups_at(s)
        if groups.model.cavitation is Cavitation.REFORM and groups.speed > 0:  # cavities come and go along a path
            from stribeck.solver.solve import solved_point

            return solved_point(groups, self.rtol)
        if not history:
            path = first_path(with_positive_gap(groups)[0])
            if path.outcome is Outcome.INTERRUPTED:
                raise KeyboardInterrupt
            return self._adopt(converge(path.states[-1], groups, self.rtol)) if path.outcome.ok else None
        guess = extrapolate([(c, p.state) for c, p in history if p.state is not None], s)
        point = self._on_present_mesh(guess, groups, self.postpone and bool(groups.speed > 0))
        if point is not None and point.outcome.ok:
            return self._kept(point)
        if point is None or point.state is None:
            return self._adopt(converge(guess, groups, self.rtol, self.tolerances))
        if self.at_nodes < FINER_THAN_NEEDED:  # the panels of the central and the minimum gap failed alone
            self._relax()
        refined = converge(point.state, groups, self.rtol, self.tolerances)
        adopted = self._adopt(refined)
        if adopted.state is not None and adopted.outcome.ok and adopted.state.prediction_error > ROUGH:
            self._coarsen(adopted.state)
        return adopted

    def verify_waiting(self) -> dict[RefinedState, RefinedState]:
        """Return the points that waited, each with what it became: verified, and solved anew where its mesh was too coarse."""
        waiting, self.waiting = self.waiting, []
        found: dict[RefinedState, RefinedState] = {}
        for fine in {point.fine: None for point, _ in waiting}:
            points, inverses = zip(*(pair for pair in waiting if pair[0].fine is fine), strict=True)
            assert fine is not None
            verified = verify_together([point.state for point in points], inverses, fine, self.rtol)
            found |= zip(points, verified, strict=True)
        if waiting:
            self._learn(found[waiting[-1][0]])
        return {point: verified if verified.outcome.ok else self._again(verified) for point, verified in found.items()}

    @property
    def patience(self) -> int:
        """How many points may wait: the better the mesh resolved the last one, the more."""
        size = 1 if self.operators is None else self.operators.mesh.size
        return max(1, min(MOST_WAITING, WAITING_NODES // size, int(PATIENCE / math.sqrt(self.at_nodes + 1e-300))))

    def _learn(self, point: RefinedState) -> RefinedState:
        """Return the point, and keep what it tells of the mesh."""
        if point.estimate is not None:
            self.at_nodes = point.estimate.at_nodes / self.rtol
        return point

    def _again(self, point: RefinedState) -> RefinedState:
        """Return a point whose mesh was too coarse: on the present one where that is another, else on a finer one."""
        assert point.state is not None
        if self.operators is not None and self.operators.mesh is not point.state.mesh:
            again = self._on_present_mesh(point.state, point.groups, postpone=False)
            if again is not None and again.outcome.ok:
                return self._kept(again)
        return self._adopt(converge(point.state, point.groups, self.rtol, self.tolerances))

    def _on_present_mesh(self, guess: Guess, groups: Groups, postpone: bool) -> RefinedState | None:
        if self.operators is None or self.fine is None:
            return None
        base, tolerance = with_positive_gap(groups)[0], newton_tolerance(self.rtol)
        if base.model != self.operators.model:
            self.operators, self.inverse = Operators(self.operators.mesh, base.model), None
        state = solve_state(base, self.operators, guess, tolerance, MOST_STEPS, self.inverse)
        if not state.outcome.ok:
            return None
        if postpone:
            resolved = gap_is_resolved(state.mesh, state.gap, self.rtol)
            outcome = Outcome.CONVERGED if resolved else Outcome.REFINEMENT_LIMIT
            point = RefinedState(groups, state, None, None, outcome, fine=self.fine)
        else:
            point = self._learn(verify(state, groups, self.fine, self.rtol))
        self.since_check += 1
        if self.since_check >= CHECK_EVERY and point.outcome.ok:
            self._coarsen(state)
        return point

    def _kept(self, point: RefinedState) -> RefinedState:
        """Return the point with its inverse kept here, for the next one, instead of there."""
        if point.state is None:
            return point
        same_mesh = self.operators is not None and point.state.mesh is self.operators.mesh
        inverse = point.state.root.inverse
        self.inverse = inverse if same_mesh else None
        kept = replace(point, state=point.state.without_inverse())
        if kept.estimate is None and kept.outcome.ok and inverse is not None:
            self.waiting.append((kept, inverse))
        return kept

    def _coarsen(self, state: State) -> None:
        """Try wider tolerances from now on, and at once where the mesh they make is clearly smaller than the present one."""
        self.since_check = 0
        self._relax()
        try:
            mesh = mesh_for(state, state.groups, contact_law(state.groups), order_for(self.rtol), *self.tolerances)
        except MeshTooLargeError:
            return
        if mesh.size < WORTH_COARSENING * state.mesh.size:
            self.operators, self.fine, self.inverse = Operators(mesh, state.groups.model), FineOperators(mesh), None

    def _relax(self) -> None:
        """Widen the tolerances, up to those that a first mesh has."""
        tail, gap_tail = mesh_tolerances_for(self.rtol)
        self.tolerances = min(tail, RELAX * self.tolerances[0]), min(gap_tail, RELAX * self.tolerances[1])

    def _adopt(self, point: RefinedState) -> RefinedState:
        if point.state is not None and point.outcome.ok:
            self.operators, self.fine = point.state.equations.operators, point.fine
            self.tolerances = point.tolerances or self.tolerances
            self.since_check = 0
            self._learn(point)
        return self._kept(point)
