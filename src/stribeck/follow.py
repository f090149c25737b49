"""Following a state along one coordinate: prediction, a mesh kept for as long as it resolves, refinement where it does not.

The coordinate is the logarithm of whatever varies.  The stepping is :func:`continuation.march`; here is what it corrects with.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from .contact_laws import contact_law
from .continuation import Path, march
from .equations import Operators
from .estimate import FineOperators, reads_off
from .fill import Anchor, between
from .mesh import MeshTooLargeError
from .newton import Factors, Outcome
from .parameters import Groups
from .refine import Point, converge, judge, mesh_tolerances_for, newton_tolerance, order_for, solvable
from .start import cold_start
from .states import Guess, State, extrapolate, mesh_for, solve_state
from .together import judge_together

LONGEST_STEP = math.log(10.0)
SHORTEST_STEP = 1e-3
PREDICTOR_ORDER = 4

AIM = 3
"""What steps aim at where targets may be passed over: the smaller, the shorter the steps, and the better what lies between is
interpolated."""

LEAST_SKIPPED = 3
"""Targets that a step has to pass over: filling fewer costs more than as many steps."""

ROUGH = 1e-2
"""Error of a prediction from which the mesh that was made for it is looked at again: it is finer than need be."""

FILL_ORDER = 5
"""Degree of the interpolation between the steps of a path."""

ANCHORS = 8
"""Steps of a path that are kept for it."""

MOST_WAITING = 8
"""Points that may wait to be judged together."""

PATIENCE = 0.6
"""How many wait where the errors at the nodes are as large as the tolerance; the smaller they are, the more."""

MOST_STEPS = 16
"""Newton and chord steps after which the present mesh is given up."""

FINER_THAN_NEEDED = 0.1
"""Part of the tolerance below which the errors at the nodes call for a coarser mesh."""

CHECK_EVERY = 25
"""Points between two looks at whether a coarser mesh would do."""

WORTH_COARSENING = 0.85
"""Ratio of sizes from which the coarser mesh is taken."""

RELAX = 3.0
"""Factor by which a mesh tolerance that once had to be lowered is raised again at such a look."""


class Follower:
    """Corrector of a path: ``groups_at(s)`` gives the groups at coordinate s.

    It keeps the operators of the present mesh, whose making costs as much as several states.  With ``postpone`` a state on it
    that looks resolved is judged later, together with others, by :meth:`judge_waiting`.
    """

    def __init__(self, groups_at: Callable[[float], Groups], rtol: float, postpone: bool = False) -> None:
        self.groups_at = groups_at
        self.rtol = rtol
        self.postpone = postpone
        self.waiting: list[tuple[Point, Factors]] = []
        self.at_nodes = math.inf  # error there of the last point that was judged, in units of rtol
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
        point = self._on_present_mesh(guess, groups, self.postpone and bool(groups.speed > 0))
        if point is not None and point.outcome.ok:
            return self._kept(point)
        if point is None or point.state is None:
            return self._adopt(converge(guess, groups, self.rtol, self.tolerances))
        if self.at_nodes < FINER_THAN_NEEDED:  # the panels of the central and the least gap failed alone
            self._relax()
        refined = converge(point.state, groups, self.rtol, self.tolerances)
        adopted = self._adopt(refined)
        if adopted.state is not None and adopted.outcome.ok and adopted.state.prediction_error > ROUGH:
            self._coarsen(adopted.state)
        return adopted

    def judge_waiting(self) -> dict[Point, Point]:
        """Return the points that waited, each with what it became: judged, and solved anew where its mesh was too coarse."""
        waiting, self.waiting = self.waiting, []
        found: dict[Point, Point] = {}
        for fine in {point.fine: None for point, _ in waiting}:
            points, factors = zip(*(pair for pair in waiting if pair[0].fine is fine), strict=True)
            assert fine is not None
            judged = judge_together([point.state for point in points], factors, fine, self.rtol)
            found |= zip(points, judged, strict=True)
        if waiting:
            self._learn(found[waiting[-1][0]])
        return {point: judged if judged.outcome.ok else self._again(judged) for point, judged in found.items()}

    @property
    def patience(self) -> int:
        """How many points may wait: the better the mesh resolved the last one, the more."""
        return max(1, min(MOST_WAITING, int(PATIENCE / math.sqrt(self.at_nodes + 1e-300))))

    def _learn(self, point: Point) -> Point:
        """Return the point, and keep what it tells of the mesh."""
        if point.estimate is not None:
            self.at_nodes = point.estimate.at_nodes / self.rtol
        return point

    def _again(self, point: Point) -> Point:
        """Return a point whose mesh was too coarse: on the present one where that is another, else on a finer one."""
        assert point.state is not None
        if self.operators is not None and self.operators.mesh is not point.state.mesh:
            again = self._on_present_mesh(point.state, point.groups, postpone=False)
            if again is not None and again.outcome.ok:
                return self._kept(again)
        return self._adopt(converge(point.state, point.groups, self.rtol, self.tolerances))

    def _on_present_mesh(self, guess: Guess, groups: Groups, postpone: bool) -> Point | None:
        if self.operators is None or self.fine is None:
            return None
        base, tolerance = solvable(groups), newton_tolerance(self.rtol)
        state = solve_state(base, self.operators, guess, tolerance, MOST_STEPS, self.factors)
        if not state.outcome.ok:
            return None
        if postpone:
            resolved = reads_off(state.mesh, state.gap, self.rtol)
            outcome = Outcome.CONVERGED if resolved else Outcome.REFINEMENT_LIMIT
            point = Point(groups, state, None, None, outcome, fine=self.fine)
        else:
            point = self._learn(judge(state, groups, self.fine, self.rtol))
        self.since_check += 1
        if self.since_check >= CHECK_EVERY and point.outcome.ok:
            self._coarsen(state)
        return point

    def _kept(self, point: Point) -> Point:
        """Return the point with its factors kept here, for the next one, instead of there."""
        if point.state is None:
            return point
        same_mesh = self.operators is not None and point.state.mesh is self.operators.mesh
        factors = point.state.root.factors
        self.factors = factors if same_mesh else None
        kept = replace(point, state=point.state.without_factors())
        if kept.estimate is None and kept.outcome.ok and factors is not None:
            self.waiting.append((kept, factors))
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
            self.operators, self.fine, self.factors = Operators(mesh), FineOperators(mesh), None

    def _relax(self) -> None:
        """Widen the tolerances, up to those that a first mesh has."""
        tail, gap_tail = mesh_tolerances_for(self.rtol)
        self.tolerances = min(tail, RELAX * self.tolerances[0]), min(gap_tail, RELAX * self.tolerances[1])

    def _adopt(self, point: Point) -> Point:
        if point.state is not None and point.outcome.ok:
            self.operators, self.fine = point.state.equations.operators, point.fine
            self.tolerances = point.tolerances or self.tolerances
            self.since_check = 0
            self._learn(point)
        return self._kept(point)


class Filling:
    """The points of a path in their order: its steps, and the targets that lie between them."""

    def __init__(
        self, follower: Follower, targets: Sequence[float], on_point: Callable[[float, Point], object] | None
    ) -> None:
        self.follower = follower
        self.targets = list(targets)
        self.on_point = on_point
        self.anchors: list[Anchor] = []
        self.arrived: list[tuple[float, Point]] = []
        self.done: list[tuple[float, Point]] = []
        self.lost: Path[Point] | None = None

    def arrive(self, s: float, point: Point) -> None:
        """Take the next step of the path, and report the points up to it."""
        found = {s: point}
        skipped = self.targets[: self.targets.index(s)] if s in self.targets else []
        self.targets = self.targets[len(skipped) + (s in self.targets) :]
        if self.targets or skipped:
            left, right = self.anchors[-1:], self._anchor(s, point)
            if skipped:
                found = self._found(skipped, left[0], right) | found
                last = self.anchors[-1]
                self.follower.factors = last.factors if last.operators is self.follower.operators else None
        for c in [*skipped, s]:
            if c not in found:
                break
            self.arrived.append((c, found[c]))
        if len(self.follower.waiting) >= self.follower.patience:
            self.release()

    def release(self, report: bool = True) -> None:
        """Have the points judged that wait for it, and report all that arrived."""
        judged = self.follower.judge_waiting()
        self.arrived = [(s, judged.get(point, point)) for s, point in self.arrived]
        while self.arrived and self.lost is None:
            s, point = self.arrived.pop(0)
            if not point.outcome.ok:
                self.lost = Path((), (), point.outcome, 1, point)
                break
            self.done.append((s, point))
            if report and self.on_point is not None:
                self.on_point(s, point)

    def _anchor(self, s: float, point: Point) -> Anchor:
        """Return the anchor that a solved point is, and keep it as one to interpolate through."""
        assert self.follower.operators is not None and self.follower.fine is not None
        anchor = Anchor.at(s, point, self.follower.operators, self.follower.fine)
        self.anchors = [*self.anchors[-ANCHORS:], anchor]
        return anchor

    def _nearest(self, s: float) -> list[Anchor]:
        """Return the anchors to interpolate through, the nearest last."""
        return sorted(self.anchors, key=lambda anchor: -abs(anchor.coordinate - s))[-FILL_ORDER - 1 :]

    def _found(self, coordinates: list[float], left: Anchor, right: Anchor) -> dict[float, Point]:
        """Return the points between two anchors: all at once on the mesh of either, else on both sides of a step between."""
        found: dict[float, Point] = {}
        missing = coordinates
        for anchor in (right, left) if left.operators is not right.operators else (right,):
            groups = [self.follower.groups_at(s) for s in missing]
            through = self._nearest(0.5 * (left.coordinate + right.coordinate))
            points = between((left, right), anchor, through, missing, groups, self.follower.rtol)
            found |= {s: p for s, p in zip(missing, points, strict=False) if p.outcome.ok}
            missing = [s for s in missing if s not in found]
            if not missing:
                return found
        half = len(missing) // 2
        path = self._step(left, missing[half])
        if not path.outcome.ok:
            self.lost = path
            return found
        middle = self._anchor(missing[half], path.states[-1])
        found[middle.coordinate] = middle.point
        for part, ends in ((missing[:half], (left, middle)), (missing[half + 1 :], (middle, right))):
            if part and self.lost is None:
                found |= self._found(part, *ends)
        return found

    def _step(self, left: Anchor, s: float) -> Path[Point]:
        """Return the path from an anchor to ``s``, predicted by interpolation."""
        return march(
            lambda c, _: self.follower(c, [(a.coordinate, a.point) for a in self._nearest(c)]),
            left.coordinate,
            s,
            first_step=abs(s - left.coordinate),
            max_step=abs(s - left.coordinate),
            min_step=min(SHORTEST_STEP, abs(s - left.coordinate)),
            history=[(left.coordinate, left.point)],
        )


def follow(
    groups_at: Callable[[float], Groups],
    coordinates: Sequence[float],
    rtol: float,
    on_point: Callable[[float, Point], object] | None = None,
) -> Path[Point]:
    """Return the converged points at ``coordinates``, ascending or descending, and those between that the path needed."""
    targets = [float(s) for s in coordinates]
    follower = Follower(groups_at, rtol, postpone=True)
    moving = bool(groups_at(targets[0]).speed > 0)
    filling = Filling(follower, targets, on_point)
    path = march(
        follower,
        targets[0],
        targets[-1],
        first_step=0.5,
        max_step=LONGEST_STEP,
        min_step=SHORTEST_STEP,
        order=PREDICTOR_ORDER,
        aim=AIM if moving else 4,
        targets=targets,
        skip=LEAST_SKIPPED if moving else None,
        stop_when=lambda _: filling.lost is not None,
        on_point=filling.arrive,
    )
    filling.release(report=path.outcome is not Outcome.INTERRUPTED)
    end = path if filling.lost is None else filling.lost
    points = filling.done
    return Path(tuple(s for s, _ in points), tuple(point for _, point in points), end.outcome, end.failures, end.failure)
