"""States of the line along a path on which a cavity behind the contact opens, grows and closes.

Nodes of such a film move with both ends of its cavity, so that the inlet passes through them: series of nodal gaps converge on
a small part of the interval on which those of the observables do.  Only the observables are expanded here, to few orders.  The
next state is solved from the gap of the last one at the same places, and each interval is compared with a state in its middle.

Where the cavity closes, observables have a kink.  Between a full film and one with a cavity they are the series of the full
film and a linear share of what it misses at the other end, all of which is stated as their error.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups
from stribeck.equations.observables import ROW
from stribeck.equations.prediction import SeenFrom
from stribeck.equations.sensitivity import with_ending_of
from stribeck.equations.state import State
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.newton import Inverse
from stribeck.numerics.series import interval, radius
from stribeck.numerics.settings import (
    CAVITY_ORDER,
    EPSILON,
    HALF_DIGITS,
    MIN_LOG_STEP,
    NEGLIGIBLE,
    SAFETY,
    SAMPLE_RADIUS_RATIO,
    SAMPLED_ORDER,
    STEP_GROWTH,
)
from stribeck.quantities.outcome import Outcome
from stribeck.solver.at_rest import shift_along
from stribeck.solver.path.expansion import Direction, Expanded, expand
from stribeck.solver.path.line_path import (
    POSITION,
    READ_COLUMNS,
    SERIES_COLUMNS,
    LineProblem,
)
from stribeck.solver.path.path import Expansion
from stribeck.solver.refinement import RefinedState, converge

__all__ = ["line_problem"]


def line_problem(
    groups_at: Callable[[float], Groups],
    direction: Direction,
    rtol: float,
    uniform: bool = True,
) -> LineProblem:
    """Return the states of the line along a path, by how its film ends."""
    groups = groups_at(0.0)
    may_open = groups.model.cavitation is Cavitation.REFORM and groups.speed > 0
    if may_open and groups.model.cavity_pressure < 0:
        return ReformingLine(groups_at, direction, rtol, uniform)
    return (EndingLine if may_open else LineProblem)(groups_at, direction, rtol, uniform)


class EndingLine(LineProblem):
    """The states of a film with a cavity at ambient pressure, which reaches to infinity."""

    def __init__(
        self,
        groups_at: Callable[[float], Groups],
        direction: Direction,
        rtol: float,
        uniform: bool,
    ) -> None:
        def ending_at(s: float) -> Groups:
            groups = groups_at(s)
            return replace(groups, model=replace(groups.model, cavitation=Cavitation.EXIT))

        super().__init__(ending_at, direction, rtol, uniform)
        self.asked_at = groups_at

    def point_at(
        self, left: Expansion, right: Expansion, s: float, rtol: float | None = None, near: RefinedState | None = None
    ) -> RefinedState:
        """Return the verified state between two expansions, labelled with the requested groups."""
        if near is not None and near.state is not None:
            near = replace(near, groups=near.state.groups)
        return replace(super().point_at(left, right, s, rtol, near), groups=self.asked_at(s))


class ReformingLine(LineProblem):
    """The states of a film that may have a cavity."""

    def __init__(self, groups_at: Callable[[float], Groups], direction: Direction, rtol: float, uniform: bool) -> None:
        super().__init__(groups_at, direction, rtol, uniform)
        self.reach = NEGLIGIBLE * MIN_LOG_STEP
        self.known: dict[float, RefinedState | None] = {}

    def solve(self, s: float, near: Sequence[Expansion]) -> Expansion | Outcome:
        """Return the expanded state at ``s``."""
        refined = self._solved(s, near)
        if refined is not None and refined.state is not None:
            self.order = CAVITY_ORDER if has_cavity(refined.state) else SAMPLED_ORDER
        return self._accepted(s, refined, near)

    def _solved(self, s: float, near: Sequence[Expansion]) -> RefinedState | None:
        """Return the state at ``s`` from the nearest neighbour if that has a cavity, else from cold."""
        if s not in self.known:
            last = min(near, key=lambda one: abs(one.coordinate - s), default=None)
            guess = None if last is None else _predict_at_same_places(last, s)
            found = None if guess is None else self.corrector.solve(guess, self.groups_at(s))
            if found is None or not found.outcome.ok:
                found = self.corrector.cold(self.groups_at(s))
            self.known[s] = found
        return self.known[s]

    def _sampled(self, s: float, state: State, inverse: Inverse, near: float) -> tuple[Expanded, float]:
        """Return the series of a film with a cavity, and the radius of the observables' series alone."""
        if not has_cavity(state):
            return super()._sampled(s, state, inverse, near)
        reach, shortest = self.reach, HALF_DIGITS**0.5
        while True:
            samples = interval(reach)
            direction = shift_along(self.groups_at(s), state.groups, self.direction, len(samples.weights) - 1)
            models = (
                [] if self.uniform else [with_ending_of(state, self.groups_at(s + t).model) for t in samples.places.tolist()]
            )
            found = expand(state.equations, state.y, inverse, state.groups, *direction, self.order, samples, models)
            own = radius(found.unknowns[:, : state.mesh.size], reach)
            if not (np.isfinite(own) and np.isfinite(found.unknowns).all()):
                own = 0.0
            if reach <= max(shortest, STEP_GROWTH * SAMPLE_RADIUS_RATIO * own):
                break
            reach = max(shortest, NEGLIGIBLE * reach, SAMPLE_RADIUS_RATIO * own)
        self.reach = max(shortest, SAMPLE_RADIUS_RATIO * own)
        columns = [*SERIES_COLUMNS, ROW["minimum_gap"], ROW["exit_position"], ROW["reformation_position"]]
        of_values = found.observables[:, columns] / self.scales(found.observables[:1], np.array([s]))[:, columns]
        return found, radius(of_values, reach)

    def checked_error(self, left: Expansion, right: Expansion, parts: Array, values: Callable[[], Array]) -> Array:
        """Return the difference from a state in the middle, or zero between films with and without a cavity."""
        if not has_cavity(left.point.state) and not has_cavity(right.point.state):
            return super().checked_error(left, right, parts, values)
        found = np.zeros(POSITION + 1)
        if has_cavity(left.point.state) != has_cavity(right.point.state):
            return found
        middle = self._middle(left, right)
        if middle is None:
            return np.full(POSITION + 1, np.inf)
        place = 0.5 * (left.coordinate + right.coordinate)
        known = values()[int(np.argmin(np.abs(parts - 0.5)))]
        scales = self.scales(known[None], np.array([place]))[0]
        wrong = np.abs(middle - known) / scales
        found[:POSITION] = SAFETY * np.where(np.isfinite(known), np.nan_to_num(wrong, nan=np.inf), 0.0)[:POSITION]
        return found

    def _middle(self, left: Expansion, right: Expansion) -> Array | None:
        """Return observables and minimum position midway between two states."""
        point = self._solved(0.5 * (left.coordinate + right.coordinate), [left, right])
        if point is None or point.values is None or not point.outcome.ok:
            return None
        return np.array([*point.values.array(), point.values.minimum_position])

    def read(self, left: Expansion, right: Expansion, parts: Array) -> tuple[Array, Array, Sequence[int]]:
        """Return the minimum position by a parabola, or all observables where a cavity opens or closes."""
        cavitated = [has_cavity(end.point.state) for end in (left, right)]
        if not any(cavitated):
            return super().read(left, right, parts)
        if cavitated[0] is not cavitated[1]:
            return self._opening(left, right, parts)
        ends = [end.series[0, POSITION] for end in (left, right)]
        middle = self._middle(left, right)
        straight = ends[0] + parts * (ends[1] - ends[0])
        bend = 0.0 if middle is None else float(middle[POSITION]) - 0.5 * (ends[0] + ends[1])
        values = straight + 4 * bend * parts * (1 - parts)
        errors = np.full(len(parts), max(left.errors[POSITION], right.errors[POSITION]) + abs(bend))
        return values[:, None], errors[:, None], [POSITION]

    def _opening(self, left: Expansion, right: Expansion, parts: Array) -> tuple[Array, Array, Sequence[int]]:
        """Return all observables between a full film and one with a cavity."""
        # They are the series of the full film and a linear share of its misfit at the other end, all of which is stated as the
        # error.
        full, other, way = (right, left, 1 - parts) if has_cavity(left.point.state) else (left, right, parts)
        distance = other.coordinate - full.coordinate
        series = full.series.copy()
        series[1:, READ_COLUMNS] = 0.0
        powers = (way * distance)[:, None] ** np.arange(len(series))
        missing = other.series[0] - distance ** np.arange(len(series)) @ series
        values = powers @ series + way[:, None] * missing
        ends = np.stack([left.series[0], right.series[0]])
        scales = self.scales(ends, np.array([left.coordinate, right.coordinate])).max(axis=0)
        scales[POSITION] = 1.0
        columns = np.flatnonzero(np.isfinite(missing)).tolist()
        errors = np.maximum(left.errors, right.errors) + np.abs(missing) / scales
        return values[:, columns], np.tile(errors[columns], (len(parts), 1)), columns

    def read_scales(self, values: Array) -> Array:
        """Return scales of observables without a series, of which only the sizes count."""
        return np.maximum(np.abs(values).min(axis=0), 1e-3) if values.size else np.empty(0)

    def guess_at(self, left: Expansion, right: Expansion, s: float) -> State:
        """Return a state between two expansions as a guess."""
        if not has_cavity(left.point.state) and not has_cavity(right.point.state):
            return super().guess_at(left, right, s)
        point = self._solved(s, [left, right])
        if point is None or point.state is None:
            nearest: State = min(left, right, key=lambda one: abs(one.coordinate - s)).point.state
            return nearest
        return point.state

    def point_at(
        self, left: Expansion, right: Expansion, s: float, rtol: float | None = None, near: RefinedState | None = None
    ) -> RefinedState:
        """Return the verified state between two expansions, refined if its mesh is too coarse."""
        if not has_cavity(left.point.state) and not has_cavity(right.point.state):
            return super().point_at(left, right, s, rtol, near)
        rtol = self.tolerance if rtol is None else rtol
        point, groups = self._solved(s, [left, right]), self.groups_at(s)
        if point is None or point.state is None:
            return RefinedState(groups, None, None, None, Outcome.PATH_LOST)
        if point.estimate is not None and point.estimate.total <= rtol:
            return replace(point, outcome=Outcome.CONVERGED)
        return replace(converge(point.state, replace(groups, model=point.state.groups.model), rtol), groups=groups)


def has_cavity(state: State) -> bool:
    """Return whether a state has a cavity with a reformation behind it."""
    return state.equations.operators.has_reformation


@dataclass(frozen=True, eq=False)
class _ShiftedGuess(SeenFrom):
    """The guess of a cavitated film from another: its gap at the same places, changed to first order."""

    flux: float = 0.0
    change: Array | None = None

    @property
    def flux_gap(self) -> float:
        """Predicted flux gap."""
        return self.flux

    def fields(self, x: Array) -> Array:
        """Return the logarithm of the gap and the fluid pressure at ``x``."""
        found = super().fields(x)
        if self.change is not None:
            found[0] += self.state.mesh.interpolate(
                self.change[None], (x + self.exit - self.state.exit) / self.state.cavity_stretch
            )[0]
        return found


def _predict_at_same_places(last: Expansion, s: float) -> _ShiftedGuess | None:
    """Return the guess of the state at ``s`` from a cavitated one; None from a full film, or from too far."""
    state: State = last.point.state
    if not has_cavity(state):
        return None
    at, mesh, distance = state.equations.layout, state.mesh, s - last.coordinate
    slope = last.point.unknowns[1]
    exit_slope, stretch_slope = slope[at.exit][0], slope[at.cavity_stretch][0]
    length = distance * stretch_slope / state.cavity_stretch
    if abs(length) > 1:
        return None
    step = EPSILON ** (1 / 3)  # where truncation and rounding of a central difference are alike
    ahead, behind = (state.fields(mesh.nodes + each)[0] for each in (step, -step))
    along = (ahead - behind) / (2 * step)
    moved = along * (exit_slope + stretch_slope * mesh.nodes) / state.cavity_stretch
    change = distance * (slope[at.gap] - moved)
    flux = state.flux_gap * float(np.exp(distance * slope[at.flux_gap][0] / state.flux_gap))
    pressure = state.groups.model.cavity_pressure
    reformation = state.reformation * state.cavity_stretch * float(np.exp(length))
    return _ShiftedGuess(state, state.exit + distance * exit_slope, reformation, pressure, flux=flux, change=change)
