"""Following a state along one coordinate, the logarithm of whatever varies: steps, and the targets that lie between them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from stribeck.contacts.line import Groups
from stribeck.numerics.continuation import Path, Steps, march
from stribeck.quantities.outcome import Outcome
from stribeck.solver.corrector import Corrector
from stribeck.solver.infill import SolvedState, interpolate_and_correct
from stribeck.solver.refinement import RefinedState

LONGEST_STEP = math.log(10.0)
SHORTEST_STEP = 1e-3
PREDICTOR_ORDER = 4

AIM = 3
"""What steps aim at where targets may be passed over: the smaller, the shorter the steps, and the better what lies between is
interpolated."""

MIN_SKIPPED = 3
"""Targets that a step has to pass over: filling fewer costs more than as many steps."""

FILL_ORDER = 5
"""Degree of the interpolation between the steps of a path."""

ANCHORS = 8
"""Steps of a path that are kept for it."""


class PathAssembler:
    """The points of a path in their order: its steps, and the targets that lie between them."""

    def __init__(
        self, corrector: Corrector, targets: Sequence[float], on_point: Callable[[float, RefinedState], object] | None
    ) -> None:
        self.corrector = corrector
        self.targets = list(targets)
        self.on_point = on_point
        self.anchors: list[SolvedState] = []
        self.arrived: list[tuple[float, RefinedState]] = []
        self.done: list[tuple[float, RefinedState]] = []
        self.lost: Path[RefinedState] | None = None

    def arrive(self, s: float, point: RefinedState) -> None:
        """Take the next step of the path, and report the points up to it."""
        found = {s: point}
        skipped = self.targets[: self.targets.index(s)] if s in self.targets else []
        self.targets = self.targets[len(skipped) + (s in self.targets) :]
        if self.targets or skipped:
            left, right = self.anchors[-1:], self._anchor(s, point)
            if skipped:
                found = self._found(skipped, left[0], right) | found
                last = self.anchors[-1]
                self.corrector.inverse = last.inverse if last.operators is self.corrector.operators else None
        for c in [*skipped, s]:
            if c not in found:
                break
            self.arrived.append((c, found[c]))
        if len(self.corrector.waiting) >= self.corrector.patience:
            self.release()

    def release(self) -> None:
        """Have the points verified that wait for it, and report all that arrived."""
        verified = self.corrector.verify_waiting()
        self.arrived = [(s, verified.get(point, point)) for s, point in self.arrived]
        while self.arrived and self.lost is None:
            s, point = self.arrived.pop(0)
            if not point.outcome.ok:
                self.lost = Path((), (), point.outcome, 1, point)
                break
            self.done.append((s, point))
            if self.on_point is not None:
                self.on_point(s, point)

    def _anchor(self, s: float, point: RefinedState) -> SolvedState:
        """Return the anchor that a solved point is, and keep it as one to interpolate through."""
        assert self.corrector.operators is not None and self.corrector.fine is not None
        anchor = SolvedState.at(s, point, self.corrector.operators, self.corrector.fine)
        self.anchors = [*self.anchors[-ANCHORS:], anchor]
        return anchor

    def _nearest(self, s: float) -> list[SolvedState]:
        """Return the anchors to interpolate through, the nearest last."""
        return sorted(self.anchors, key=lambda anchor: -abs(anchor.coordinate - s))[-FILL_ORDER - 1 :]

    def _found(self, coordinates: list[float], left: SolvedState, right: SolvedState) -> dict[float, RefinedState]:
        """Return the points between two anchors: all at once on the mesh of either, else on both sides of a step between."""
        found: dict[float, RefinedState] = {}
        missing = coordinates
        for anchor in (right, left) if left.operators is not right.operators else (right,):
            groups = [self.corrector.groups_at(s) for s in missing]
            through = self._nearest(0.5 * (left.coordinate + right.coordinate))
            points = interpolate_and_correct((left, right), anchor, through, missing, groups, self.corrector.rtol)
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

    def _step(self, left: SolvedState, s: float) -> Path[RefinedState]:
        """Return the path from an anchor to ``s``, predicted by interpolation."""
        distance = abs(s - left.coordinate)
        return march(
            lambda c, _: self.corrector(c, [(a.coordinate, a.point) for a in self._nearest(c)]),
            left.coordinate,
            s,
            Steps(distance, distance, min(SHORTEST_STEP, distance)),
            history=[(left.coordinate, left.point)],
        )


def solve_along(
    groups_at: Callable[[float], Groups],
    coordinates: Sequence[float],
    rtol: float,
    on_point: Callable[[float, RefinedState], object] | None = None,
) -> Path[RefinedState]:
    """Return the converged points at ``coordinates``, ascending or descending, and those between that the path needed."""
    targets = [float(s) for s in coordinates]
    corrector = Corrector(groups_at, rtol, postpone=True)
    moving = bool(groups_at(targets[0]).speed > 0)
    assembler = PathAssembler(corrector, targets, on_point)
    path = march(
        corrector,
        targets[0],
        targets[-1],
        Steps(0.5, LONGEST_STEP, SHORTEST_STEP, PREDICTOR_ORDER, AIM if moving else 4, MIN_SKIPPED if moving else None),
        targets=targets,
        stop_when=lambda _: assembler.lost is not None,
        on_point=assembler.arrive,
    )
    if path.outcome is not Outcome.INTERRUPTED:  # then what was reported is kept
        assembler.release()
    end = path if assembler.lost is None else assembler.lost
    points = assembler.done
    return Path(tuple(s for s, _ in points), tuple(point for _, point in points), end.outcome, end.failures, end.failure)
