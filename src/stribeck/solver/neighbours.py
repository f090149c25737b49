"""States by their groups, with first derivatives: each is solved from the nearest known one, from cold where none is near."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import FAR_PARTS, far_film, far_parts, is_far, log_cut_offs
from stribeck.contacts.groups import Groups
from stribeck.equations.point.observables import WITHIN
from stribeck.equations.sensitivity import Change
from stribeck.numerics.continuation import steady_weights
from stribeck.numerics.dual import Dual
from stribeck.numerics.settings import HALF_DIGITS, MAX_AMPLIFICATION, MAX_STATES, SLOPE_RESIDUAL
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outputs import AREA, GROUPS
from stribeck.solver.path.line_steps import LineSteps
from stribeck.solver.point.estimate import Pair
from stribeck.solver.point.level import predicted
from stribeck.solver.point.sensitivity import derivatives_along, state_derivatives
from stribeck.solver.point.solution import finish_point
from stribeck.solver.point.solve import solve_cold, solve_from
from stribeck.solver.point.state import PointState, measured
from stribeck.solver.solve import hertz_solution

MAX_LOG_DISTANCE = math.log(30.0)  # A state farther than this in the logarithm of any number is no useful start


Line = Sequence[tuple[float, Any]]
"""States along a line through the one that is wanted, which lies at zero; the nearest last."""


class Observed(NamedTuple):
    """Some observables of a state."""

    values: Array  # In the order of the names that were asked for
    slopes: Array  # Derivatives by ln(speed), ln(load) and ln(roughness), and along changes of the model, shape (names, 3 + k)
    errors: Array  # Errors as a solution states them


class Neighbours:
    """Solves states in any order, keeps the last ones, and starts each from the nearest of these."""

    def __init__(self, rtol: float, most: int = MAX_STATES) -> None:
        self.rtol = rtol
        self._steps: dict[str, Any] = {"line": LineSteps(rtol), "point": _BallSteps(rtol)}
        self._known: deque[_Known] = deque(maxlen=most)
        self._last: tuple[_Known, Any] | None = None

    def at(self, groups: Groups) -> Any:
        """Return the state of groups; a failure is in its outcome."""
        steps, here = self._steps[groups.geometry], _Known(groups)
        near, away = self._near(here)
        if near and near[0].groups == groups and near[0].is_own:
            return self._last[1] if self._last is not None and self._last[0] is near[0] else near[0].state
        state = steps.follow(self._line(near, away, steps.order), groups) if near else steps.start(groups)
        if state.outcome.ok:
            here.state = steps.kept(state)
            self._known.appendleft(here)
            self._last = here, state
        return state

    def learn(self, state: Any) -> None:
        """Take a state that was solved elsewhere, to another tolerance, as a neighbour."""
        here = _Known(state.groups)
        here.state, here.is_own = state, False
        self._known.appendleft(here)

    def solved(self, groups: Groups) -> Any:
        """Return the state of groups, or raise SolveError."""
        state = self.at(groups)
        if not state.outcome.ok:
            self._steps[groups.geometry].finish(state, groups, None)
        return state

    @one_blas_thread
    def observed(
        self,
        groups: Groups,
        names: Sequence[str],
        changes: Sequence[Change] = (),
        *,
        by: Sequence[str] = GROUPS,
        inputs: Mapping[str, float],
    ) -> Observed:
        """Return observables of a moving contact with derivatives; ``inputs`` say where the liquid of a ball ends."""
        return Observed(*self._steps[groups.geometry].observed(self.solved(groups), names, changes, by, inputs))

    @one_blas_thread
    def solution(self, groups: Groups, contact: Contact | None = None) -> Any:
        """Return the state of groups, and of their contact, as a solution; raise SolveError where there is none."""
        if groups.geometry == "line" and groups.is_hertzian:
            return hertz_solution(groups, contact, self.rtol)
        return self._steps[groups.geometry].finish(self.at(groups), groups, contact)

    def solution_from_cold(self, groups: Groups, contact: Contact) -> Any:
        """Return the state of a contact from cold, and know it; raise SolveError where there is none."""
        here, steps = _Known(groups), self._steps[groups.geometry]
        here.state = steps.from_cold(groups)
        self._known.appendleft(here)
        return steps.finish(here.state, groups, contact)

    def release(self) -> None:
        """Forget the factors of the last state, which fill the memory."""
        self._last = None

    def _near(self, here: _Known) -> tuple[list[_Known], Array]:
        """Return the states of the same kind around a place, the nearest first, and how far away their places are."""
        alike = [each for each in self._known if each.kind == here.kind]
        away = np.array([each.place for each in alike]).reshape(len(alike), len(here.place)) - here.place
        distances = np.abs(away).max(axis=1)
        order = np.argsort(distances, kind="stable")
        order = order[distances[order] <= MAX_LOG_DISTANCE]
        return [alike[i] for i in order.tolist()], away[order]

    def _line(self, near: Sequence[_Known], away: Array, order: int) -> Line:
        """Return the nearest state, and others that lie on a line with it and the place that is wanted."""
        length = float(np.abs(away[0]).max())
        states = [each.state for each in near]
        if self._last is not None and near[0] is self._last[0]:
            states[0] = self._last[1]  # with its factors
        if length == 0:
            return [(0.0, states[0])]
        direction = away[0] / length
        along = away @ direction / float(direction @ direction)
        straight = np.abs(away - along[:, None] * direction).max(axis=1) <= HALF_DIGITS * length
        line = [(length, states[0])]
        for i in np.flatnonzero(straight).tolist():
            s = float(along[i])
            if len(line) <= order and min(abs(s - other) for other, _ in line) > HALF_DIGITS * length:
                line.append((s, states[i]))
        return line[::-1]


class _Known:
    """A state, its place among others and its kind: all that neighbours share."""

    state: Any = None
    is_own: bool = True  # Whether it holds the tolerance of these neighbours

    def __init__(self, groups: Groups) -> None:
        self.groups = groups
        logs: list[float] = []
        kind: list[Any] = []
        _take_apart([float(groups.speed), float(groups.load), float(groups.roughness), *groups.physics.values()], logs, kind)
        self.place, self.kind = np.array(logs), tuple(kind)


def _take_apart(value: Any, logs: list[float], kind: list[Any]) -> None:
    """Add the logarithms of all numbers of a value to ``logs``, and all else that it consists of to ``kind``."""
    if isinstance(value, float):
        is_log = 0.0 < abs(value) < math.inf
        logs.append(math.log(abs(value)) if is_log else 0.0)
        kind.append((is_log, value > 0))
    elif isinstance(value, np.ndarray):
        kind.append(value.shape)
    elif isinstance(value, list | tuple):
        for each in value:
            _take_apart(each, logs, kind)
    elif is_dataclass(value):
        kind.append(type(value))
        for each in fields(value):
            _take_apart(getattr(value, each.name), logs, kind)
    else:
        kind.append(value if isinstance(value, str | int | None) else type(value))


class _BallSteps:
    """Solves states of balls one from another as :class:`LineSteps` does those of lines; only the last keeps its factors."""

    order = 2  # Degree of the polynomial that predicts a state from those along a line

    def __init__(self, rtol: float) -> None:
        self.rtol = rtol

    def start(self, groups: Groups) -> PointState:
        """Return a state from cold."""
        return solve_cold(groups, self.rtol)

    from_cold = start

    def follow(self, line: Line, groups: Groups) -> PointState:
        """Return a state from those along a line, from cold where that fails."""
        moving = [(s, each) for s, each in line if isinstance(each.work, Pair)]
        weights = steady_weights([s for s, _ in moving], 0.0, MAX_AMPLIFICATION)
        levels = [each.work.fine for _, each in moving[len(moving) - len(weights) :]]
        return solve_from(line[-1][1], groups, self.rtol, predicted(weights, levels) if len(levels) > 1 else None)

    def kept(self, state: PointState) -> PointState:
        """Return the state without the factors that fill the memory."""
        return state.without_factors()

    def observed(
        self, state: Any, names: Sequence[str], changes: Sequence[Change], by: Sequence[str], inputs: Mapping[str, float]
    ) -> tuple[Array, Array, Array]:
        """Return observables with their derivatives and errors; a fluid that thins far out counts up to the liquid's edge."""
        groups = state.groups
        if groups.roughness == 0:  # what touches nowhere has neither
            names = ["contact_load_share" if name == AREA else name for name in names]
        ends_near = WITHIN[0] not in names and not is_far(groups.model, inputs["wetted_radius"])
        cut_offs = None
        if ends_near or WITHIN[0] in names:
            cut_offs = log_cut_offs(float(groups.slope(inputs["beta"])), inputs["wetted_radius"])
        measure = partial(measured, law=groups.law if AREA in names else None, cut_offs=cut_offs)
        known = {name: (value, state.relative_errors[name]) for name, value in state.values.items()}
        if cut_offs is not None:
            here = measure(state.work.fine.equations, state.work.fine.unknowns)
            known |= {name: (here[name], 0.0) for name in WITHIN}
        if AREA in names:
            known[AREA] = state.real_contact_area
        values, errors = np.array([known[name] for name in names]).T
        slopes = state_derivatives(state, by, measure, SLOPE_RESIDUAL * self.rtol)
        if changes:
            directions = {
                str(i): (replace(groups, model=below), replace(groups, model=above), width)
                for i, (below, above, width) in enumerate(changes)
            }
            along = derivatives_along(state, directions, measure, SLOPE_RESIDUAL * self.rtol)
            slopes = {name: np.append(slopes[name], each) for name, each in along.items()}
        found = np.array([slopes.get(name, np.zeros(len(GROUPS))) for name in names])
        if cut_offs is not None and ends_near:
            is_disc = math.isfinite(inputs["wetted_radius"])
            parts = {name: Dual(known[name][0], slopes[name]) for name in (*FAR_PARTS, *WITHIN)}
            speed = float(groups.speed)
            by_speed = Dual(speed, speed * np.eye(found.shape[1])[0])
            for name, part in far_parts(parts, by_speed, cut_offs, is_disc, far_film(groups.model)).items():
                if name in names:
                    row = names.index(name)
                    # What a fluid thins far out depends on where a whole ball ends, which moves with beta.
                    wrong = errors[row] * abs(values[row]) + (0.0 if is_disc else abs(part.value - values[row]))
                    values[row], found[row] = part.value, part.slope
                    errors[row] = wrong / (abs(values[row]) or state.scales[name])
        return values, found, errors

    def finish(self, state: PointState, groups: Groups, contact: Contact | None) -> Any:
        """Return a state as a solution, or raise the error of its outcome."""
        return finish_point(state, contact)
