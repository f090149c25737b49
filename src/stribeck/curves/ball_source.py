"""Curves of balls: observables off solved states with their slopes."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import log_cut_offs
from stribeck.contacts.friction_rules import RULES
from stribeck.curves.coordinate import Coordinate
from stribeck.curves.source import Coefficients, Parts, Progress, Readings, Source
from stribeck.equations.point.observables import OBSERVABLES
from stribeck.numerics.continuation import follow
from stribeck.numerics.settings import MAX_LOG_STEP, WINDOW
from stribeck.quantities.outcome import Outcome
from stribeck.solver.path.hermite_path import HermitePath, Knot
from stribeck.solver.point.knots import BallKnots
from stribeck.solver.point.solution import PointSolution, finish_point, solution_of
from stribeck.solver.point.solve import RTOL_RANGE
from stribeck.solver.solve_error import SolveError, describe

SLOPE_LOG_STEP = 1e-4  # Step of ln(value) in central differences of the friction, for its minimum


def _readings(solutions: Sequence[PointSolution]) -> Readings:
    """Return what solutions at places of the path have."""
    states = [one.state for one in solutions]
    stated = [each.relative_errors for each in states]

    return Readings(
        names=OBSERVABLES,
        values={name: np.array([each.values[name] for each in states]) for name in OBSERVABLES},
        relative_errors=np.array([[each[name] for name in OBSERVABLES] for each in stated]).reshape(-1, len(OBSERVABLES)),
        position_error=np.array([one.minimum_radius_error for one in solutions]),
        error_estimate=max((one.error_estimate for one in solutions), default=math.nan),
        terms=_terms,
        made=partial(tuple, solutions),
    )


def _terms(read: Readings, *coefficients: Any) -> Array:
    """Return both parts of the friction of solutions, their sum and its error, shape (n, 4)."""
    found = [one.friction(*coefficients) for one in read.solutions]
    return np.array([[f.asperities, f.fluid, f.total, f.error] for f in found]).reshape(-1, 4)


@dataclass(frozen=True, eq=False)
class BallSource(Source):
    """Numbers of a ball along a path."""

    coordinate: Coordinate
    rtol: float
    path: HermitePath = field(compare=False)

    def read(self, s: Array, rtol: float | None = None) -> Readings:
        """Return the solutions at places."""
        problem: BallKnots = self.path.problem
        states = problem.states_at(self.path, s)
        contacts = map(self.coordinate.contact_at, s.tolist())
        return _readings([solution_of(state, contact) for state, contact in zip(states, contacts, strict=True)])

    def parts(self, s: Array, coefficients: Coefficients) -> Parts:
        """Return the load share of the fluid and both parts of the friction."""
        found = self.read(s)
        contact, viscous = found.friction_terms(*coefficients)[:, :2].T
        return found.values["fluid_load_share"], contact, viscous

    def slopes(self, s: Array, coefficients: Coefficients) -> Array:
        """Return the derivatives of the friction by the coordinate."""
        ahead, behind = (sum(self.parts(s + step, coefficients)[1:]) for step in (SLOPE_LOG_STEP, -SLOPE_LOG_STEP))
        return np.asarray((ahead - behind) / (2 * SLOPE_LOG_STEP))

    def solved(self, s: float, rtol: float) -> PointSolution:
        """Return the solution at a place, solved to a tolerance."""
        problem: BallKnots = self.path.problem
        state = problem.solved_at(self.path, s, max(rtol, RTOL_RANGE[0]))
        return finish_point(state, self.coordinate.contact_at(s))


@dataclass(frozen=True)
class CutOffs:
    """The logarithms of the radii up to which friction by shear and by pressure counts, along a curve."""

    coordinate: Coordinate
    beta: float

    def __call__(self, s: float) -> tuple[float, float]:
        """Return both at a coordinate."""
        wetted = float(RULES["point"].of_contact(self.coordinate.contact_at(s))["wetted_radius"])
        by_shear, by_pressure = log_cut_offs(float(self.coordinate.groups_at(s).slope(self.beta)), wetted)
        return float(by_shear), float(by_pressure)


def _first_state(problem: BallKnots, start: float, end: float) -> tuple[Knot | None, Outcome]:
    """Return the first state from fast to slow that can be solved, and why none is faster."""
    outcome, step = Outcome.CONVERGED, MAX_LOG_STEP / WINDOW
    try:
        while isinstance(found := problem.solve(start), Outcome):
            outcome = found
            if start - end <= step:
                return None, outcome
            start -= step
    except KeyboardInterrupt:
        return None, Outcome.INTERRUPTED
    return found, outcome


def ball_source(
    coordinate: Coordinate,
    values: Array,
    rtol: float,
    beta: float,
    on_point: Callable[[int, int], object] | None = None,
    ends: Array | None = None,
    has_area: bool = False,
) -> tuple[BallSource, Array, Readings]:
    """Return the path of a ball from fast to slow, which may be continued to ``ends``, and the points that it has."""
    # The film is smooth at high speed.
    start, places, rtol_of_states = coordinate.groups_at(math.log(values[-1])), np.log(values), max(rtol, RTOL_RANGE[0])
    ends = values[[0, -1]] if ends is None else ends
    # Friction follows from the observables alone if the far film has a closed form up to where it ends.
    inputs = [RULES["point"].of_contact(coordinate.contact_at(math.log(end))) for end in ends]
    is_closed = RULES["point"].is_enough(coordinate.groups_at(math.log(ends[-1])).model, inputs)
    problem = BallKnots(coordinate.groups_at, rtol_of_states, None if is_closed else CutOffs(coordinate, beta), has_area)
    fastest, failure = _first_state(problem, float(places[-1]), float(places[0]))
    path = HermitePath(problem, (), failure)
    if fastest is not None:
        path = follow(problem, fastest, float(places[0]), rtol_of_states, Progress(places, on_point))
    problem.release()
    if not len(path.coordinates):
        if problem.failure is not None:
            finish_point(problem.failure, coordinate.base if isinstance(coordinate.base, Contact) else None)
        raise SolveError(path.outcome, None, f"{describe(start)}: {path.outcome.value}")
    source, found, missing = BallSource(coordinate, rtol, path), {}, failure if path.outcome.ok else path.outcome
    try:
        for value in coordinate.inside(values, source.ends)[::-1].tolist():
            [solution] = source.read(np.log([value])).solutions
            if solution.outcome.ok:
                found[value] = solution
            else:
                missing = solution.outcome
    except KeyboardInterrupt:
        missing = Outcome.INTERRUPTED
    if not found:
        raise SolveError(missing, None, f"{describe(start)}: {missing.value}")
    where = sorted(found)
    points = _readings([found[value] for value in where])
    return source.along(replace(path, outcome=missing)), np.array(where), points
