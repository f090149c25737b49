"""Following a state along one coordinate: prediction, a mesh kept for as long as it resolves, refinement where it does not.

The coordinate is the logarithm of whatever varies.  The stepping is :func:`continuation.march`; here is what it corrects with.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from .contact_laws import contact_law
from .continuation import Path, march
from .equations import Operators
from .estimate import FineOperators
from .mesh import MeshTooLargeError
from .newton import Factors
from .parameters import Groups
from .refine import Point, converge, judge, mesh_tolerances_for, newton_tolerance, order_for, solvable
from .start import cold_start
from .states import Guess, State, extrapolate, mesh_for, solve_state

LONGEST_STEP = math.log(10.0)
SHORTEST_STEP = 1e-3
PREDICTOR_ORDER = 4

MOST_STEPS = 12
"""Newton and chord steps after which the present mesh is given up."""

CHECK_EVERY = 25
"""Points between two looks at whether a coarser mesh would do."""

WORTH_COARSENING = 0.85
"""Ratio of sizes from which the coarser mesh is taken."""

RELAX = 3.0
"""Factor by which a mesh tolerance that once had to be lowered is raised again at such a look."""


class Follower:
    """Corrector of a path: ``groups_at(s)`` gives the groups at coordinate s.

    It keeps the operators of the present mesh, whose making costs as much as several states.
    """

    def __init__(self, groups_at: Callable[[float], Groups], rtol: float) -> None:
        self.groups_at = groups_at
        self.rtol = rtol
        self.operators: Operators | None = None
        self.fine: FineOperators | None = None
        self.factors: Factors | None = None
        self.since_check = 0
        self.tolerances = mesh_tolerances_for(rtol)

    def __call__(self, s: float, history: Sequence[tuple[float, Point]]) -> Point | None:
        """Return the point at ``s`` predicted from ``history``; from cold where that is empty."""
        groups = self.groups_at(s)
        if not history:
            path = cold_start(solvable(groups))
            return self._adopt(converge(path.states[-1], groups, self.rtol)) if path.outcome.ok else None
        guess = extrapolate([(c, p.state) for c, p in history if p.state is not None], s)
        point = self._on_present_mesh(guess, groups)
        if point is not None and point.outcome.ok:
            return self._kept(point)
        better = guess if point is None or point.state is None else point.state
        return self._adopt(converge(better, groups, self.rtol, self.tolerances))

    def _on_present_mesh(self, guess: Guess, groups: Groups) -> Point | None:
        if self.operators is None or self.fine is None:
            return None
        base, tolerance = solvable(groups), newton_tolerance(self.rtol)
        state = solve_state(base, self.operators, guess, tolerance, MOST_STEPS, self.factors)
        if not state.outcome.ok:
            return None
        point = judge(state, groups, self.fine, self.rtol)
        self.since_check += 1
        if self.since_check >= CHECK_EVERY and point.outcome.ok:
            self._coarsen(state)
        return point

    def _kept(self, point: Point) -> Point:
        """Return the point with its factors kept here, for the next one, instead of there."""
        if point.state is None:
            return point
        same_mesh = self.operators is not None and point.state.mesh is self.operators.mesh
        self.factors = point.state.root.factors if same_mesh else None
        return replace(point, state=point.state.without_factors())

    def _coarsen(self, state: State) -> None:
        """Try wider tolerances from now on, and at once where the mesh they make is clearly smaller than the present one."""
        self.since_check = 0
        tail, gap_tail = mesh_tolerances_for(self.rtol)
        self.tolerances = min(tail, RELAX * self.tolerances[0]), min(gap_tail, RELAX * self.tolerances[1])
        try:
            mesh = mesh_for(state, state.groups, contact_law(state.groups), order_for(self.rtol), *self.tolerances)
        except MeshTooLargeError:
            return
        if mesh.size < WORTH_COARSENING * state.mesh.size:
            self.operators, self.fine = Operators(mesh), FineOperators(mesh)

    def _adopt(self, point: Point) -> Point:
        if point.state is not None and point.outcome.ok:
            self.operators, self.fine = point.state.equations.operators, point.fine
            self.tolerances = point.tolerances or self.tolerances
            self.since_check = 0
        return self._kept(point)


def follow(
    groups_at: Callable[[float], Groups],
    coordinates: Sequence[float],
    rtol: float,
    on_point: Callable[[float, Point], object] | None = None,
) -> Path[Point]:
    """Return the converged points at ``coordinates``, ascending or descending, and those between that the path needed."""
    targets = np.asarray(coordinates, dtype=float)
    return march(
        Follower(groups_at, rtol),
        float(targets[0]),
        float(targets[-1]),
        first_step=0.5,
        max_step=LONGEST_STEP,
        min_step=SHORTEST_STEP,
        order=PREDICTOR_ORDER,
        targets=targets.tolist(),
        on_point=on_point,
    )
