"""The Stribeck curve of a ball: a function through solved states, with its minimum and its transitions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import log_cut_offs
from stribeck.contacts.friction import Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Groups
from stribeck.curves.base_curve import END_ROUNDING
from stribeck.curves.coordinate import Coordinate
from stribeck.curves.function import CurveValues, Progress, observed
from stribeck.curves.landmarks import Landmark, friction_at, vanishing
from stribeck.curves.regime import Transition
from stribeck.curves.result import StribeckCurve
from stribeck.equations.point.observables import OBSERVABLES
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.events import first_zero, least_by_slope
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import GROUPS
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.path.hermite_path import HermitePath, interpolate_to
from stribeck.solver.path.path import SolvedPath, follow
from stribeck.solver.point.curve_path import PointProblem
from stribeck.solver.point.knots import BallKnots
from stribeck.solver.point.solution import PointSolution, finish_point, solution_of
from stribeck.solver.point.solve import RTOL_RANGE
from stribeck.solver.point.state import PointState
from stribeck.solver.solve_error import SolveError, describe

__all__ = ["PointCurve", "point_curve", "point_speeds"]

LOCATION_LOG_TOLERANCE = 1e-7  # Change of ln(value) to which a landmark is located, whose own error is that of the curve
SLOPE_LOG_STEP = 1e-4  # Step of ln(value) in central differences of the friction, for its minimum
INTERVAL_FRACTIONS = np.arange(8) / 8  # Places of an interval at which landmarks are searched for
MIN_SPEED, MAX_SPEED = 1e-8, 1e3  # Speed groups between which a curve chooses its own range
RANGE_RTOL = 1e-3  # Tolerance of the states on which the range is found
PLATEAU_SHARE_CHANGE = 1e-3  # Change of the load share over a decade of speed below which the boundary plateau is reached
BRANCH_CONTACT_SHARE = 1e-2  # Part of the friction caused by asperities below which the hydrodynamic branch is reached


@dataclass(frozen=True, eq=False, repr=False)
class PointCurve(StribeckCurve):
    """States of a ball along one coordinate, and the friction on them; see :class:`stribeck.StribeckCurve`."""

    solutions: tuple[PointSolution, ...] = field(kw_only=True)  # type: ignore[assignment]
    _function: Any = field(kw_only=True, repr=False, compare=False)  # of Taylor series, or of solved states with their slopes

    def _read(self, places: Array) -> tuple[PointSolution, ...]:
        """Return the solutions at coordinates, read off the curve."""
        return tuple(_solutions(self._function, self._path, places))

    def observable(self, name: str) -> Array:
        """Return an attribute of every solution as an array."""
        return observed(self.solutions, name)

    @property
    def error_estimate(self) -> float:
        """Largest estimated relative error over all points."""
        return max((s.error_estimate for s in self.solutions), default=math.nan)

    def _values(self, value: Any, s: Array) -> CurveValues:
        def shown(column: list[Any]) -> Any:
            return np.array(column) if np.ndim(value) else column[0]

        solutions = self._read(s)
        states = [one.state for one in solutions]
        friction = [one.friction(self.boundary_friction, self.beta, self.definition) for one in solutions]
        return CurveValues(
            value=value,
            values={name: shown([state.values[name] for state in states]) for name in OBSERVABLES},
            relative_errors=np.array(shown([[state.relative_errors[name] for name in OBSERVABLES] for state in states])),
            minimum_position_error=shown([one.minimum_radius_error for one in solutions]),
            friction_contact=shown([one.contact for one in friction]),
            friction_viscous=shown([one.viscous for one in friction]),
            friction=shown([one.total for one in friction]),
            friction_error=shown([one.error for one in friction]),
            names=OBSERVABLES,
        )

    def _solution_at(self, s: float) -> PointSolution:  # type: ignore[override]
        return finish_point(self._function.problem.solved_at(self._function, s), self._path.contact_at(s))

    def _along(self, path: SolvedPath | HermitePath, values: Array, requested: int) -> PointCurve:
        solutions = tuple(_solutions(path, self._path, np.log(values)))
        return replace(self, values=values, solutions=solutions, outcome=path.outcome, requested=requested, _function=path)

    def _friction_of(self, boundary_friction: float, beta: float, definition: Definition) -> Array:
        found = [s.friction(boundary_friction, beta, definition) for s in self.solutions]
        return np.array([[f.contact, f.viscous, f.total, f.error] for f in found]).reshape(-1, 4)

    @cached_property
    def _at_unit(self) -> tuple[Groups, dict[str, Any], float]:
        """The groups where what varies is one, what friction hangs on there, and that of asperities over their load share."""
        rule, start = RULES["point"], self._path.groups_at(0.0)
        inputs: dict[str, Any] = dict(rule.of_contact(self._path.contact_at(0.0))) | {"beta": self.beta}
        if self.contact is None:
            inputs["slide_to_roll"] = 2.0 * start.model.film.slide
        return start, inputs, self.boundary_friction * float(rule.sliding_factor(start, inputs))

    def _parts_at(self, s: Array) -> tuple[Array, Array, Array]:
        """Return the load share of the fluid and both parts of the friction at coordinates."""
        rule, path = RULES["point"], self._function
        if isinstance(path, HermitePath):
            solutions = self._read(s)
            friction = [one.friction(self.boundary_friction, self.beta, self.definition) for one in solutions]
            fluid = np.array([one.fluid_load_share for one in solutions])
            return fluid, np.array([each.contact for each in friction]), np.array([each.viscous for each in friction])
        start, known, rubbing = self._at_unit
        rows = dict(zip(path.problem.names, path.smooth(s).T, strict=True))
        rates = dict(zip(GROUPS, self._path.direction.tolist(), strict=True))
        speed, load = (float(getattr(start, name)) * np.exp(rates[name] * s) for name in ("speed", "load"))
        inputs = dict(known)
        if math.isfinite(inputs["wetted_radius"]):
            inputs["wetted_radius"] *= np.exp(rule.exponents["wetted_radius"].get(self.over, 0.0) * s)
        viscous = rule.viscous(rows, speed, load, inputs, self.definition)
        return rows["fluid_load_share"], rubbing * rows["contact_load_share"], viscous

    @cached_property
    def _searched(self) -> tuple[Array, Array, Array, Array]:
        """Coordinates at which landmarks are searched for; there the fluid's load share and both parts of the friction."""
        places = self._function.places(INTERVAL_FRACTIONS)
        return places, *self._parts_at(places)

    def _accepted(self, rtol: float | None) -> float:
        return self.rtol

    def _find(self, mark: Transition, accepted: float) -> Landmark | None:
        if mark is Transition.MINIMUM and not bool(np.all(np.asarray(self.groups.speed) > 0)):
            return None
        places, *parts = self._searched
        values = vanishing(mark, *parts)

        def at(s: float) -> float:
            return float(vanishing(mark, *self._parts_at(np.array([s])))[0])

        def slope(s: float) -> float:
            return at(s + SLOPE_LOG_STEP) - at(s - SLOPE_LOG_STEP)

        event, size = first_zero(at, places, values, LOCATION_LOG_TOLERANCE), np.abs(values)
        if event is None and mark is Transition.MINIMUM and np.ptp(size) > self.rtol * size.max():
            event = least_by_slope(slope, places, size, LOCATION_LOG_TOLERANCE)
        if event is None:
            return None
        try:
            [solution] = self._read(np.array([event.place]))
        except SolveError:
            return None
        friction = solution.friction(self.boundary_friction, self.beta, self.definition)
        return Landmark(mark, math.exp(event.place), friction_at(friction), solution, over=self.over)


def _solutions(path: SolvedPath | HermitePath, coordinate: Coordinate, places: Array) -> Iterator[PointSolution]:
    problem = path.problem
    assert isinstance(problem, PointProblem | BallKnots)
    for s, state in zip(places.tolist(), problem.states_at(path, places), strict=True):  # type: ignore[arg-type]
        yield solution_of(state, coordinate.contact_at(s))


def _has_closed_friction(coordinate: Coordinate, ends: Array) -> bool:
    """Return whether the friction follows from the observables alone: the far film has a closed form up to where it ends."""
    rule = RULES["point"]
    inputs = [rule.of_contact(coordinate.contact_at(math.log(end))) for end in ends]
    return rule.is_enough(coordinate.groups_at(math.log(ends[-1])).model, inputs)


def point_curve(
    coordinate: Coordinate,
    values: Array,
    rtol: float,
    on_point: Callable[[int, int], object] | None,
    **settings: Any,
) -> PointCurve:
    """Return the curve of a ball, from fast to slow, as the film is smooth at high speed."""
    start, places, rtol_of_states = coordinate.groups_at(math.log(values[-1])), np.log(values), max(rtol, RTOL_RANGE[0])
    is_closed = _has_closed_friction(coordinate, values[[0, -1]])
    has_series = start.speed > 0 and start.model.cavitation is Cavitation.NONE and is_closed and coordinate.is_uniform(values)
    progress = Progress(places, on_point)
    problem: PointProblem | BallKnots
    path: SolvedPath | HermitePath
    if has_series:
        problem = PointProblem(coordinate.groups_at, rtol_of_states)
        path = follow(problem, float(places[-1]), float(places[0]), rtol_of_states, progress)
    else:
        cut_offs = None if is_closed else CutOffs(coordinate, settings["beta"])
        problem = BallKnots(coordinate.groups_at, rtol_of_states, cut_offs)
        path = interpolate_to(problem, float(places[-1]), float(places[0]), rtol_of_states, progress)
    problem.release()
    contact = coordinate.base if isinstance(coordinate.base, Contact) else None
    if not len(path.coordinates):
        if problem.failure is not None:
            finish_point(problem.failure, contact)
        raise SolveError(path.outcome, None, f"{describe(start)}: {path.outcome.value}")
    low, high = path.coordinates[[0, -1]]
    asked = values[(places >= low - END_ROUNDING) & (places <= high + END_ROUNDING)]
    found: dict[float, PointSolution] = {}
    try:
        for value, solution in zip(asked[::-1].tolist(), _solutions(path, coordinate, np.log(asked[::-1])), strict=True):
            if solution.outcome.ok:
                found[value] = solution
            else:
                path = replace(path, outcome=solution.outcome)
    except KeyboardInterrupt:
        path = replace(path, outcome=Outcome.INTERRUPTED)
    if not found:
        raise SolveError(path.outcome, None, f"{describe(start)}: {path.outcome.value}")
    where = sorted(found)
    return PointCurve(
        over=coordinate.over,
        values=np.array(where),
        solutions=tuple(found[value] for value in where),
        contact=contact,
        rtol=rtol,
        outcome=path.outcome,
        requested=len(values),
        _path=coordinate,
        _function=path,
        **settings,
    )


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


def point_speeds(groups: Groups, boundary_friction: float, beta: float, definition: Definition) -> tuple[float, float]:
    """Return the speed groups from the boundary plateau of a ball to its hydrodynamic branch.

    They are found on coarse states a decade apart, down from the speed at which the smooth film is thirty times the
    roughness, or from the first below it that is solved, to the last that is; smooth surfaces have no plateau, and their
    curve covers eight decades up to speed 10.
    """
    kappa = float(groups.relative_roughness)
    if kappa == 0:
        return MIN_SPEED, 10.0
    neighbours = Neighbours(RANGE_RTOL)
    fastest, low, share = MAX_SPEED, min(MAX_SPEED, max(1e-6, (30 * kappa / 0.42) ** (1 / 0.6))), None
    high = low

    def contact_part(state: PointState) -> float:
        return solution_of(state, None).friction(boundary_friction, beta, definition).contact_share

    while low > MIN_SPEED:
        state = neighbours.at(replace(groups, speed=low))
        if not state.outcome.ok:
            if share is not None:  # slower ones are not solved
                low *= 10
                break
            fastest = low = high = low / 10
            continue
        if contact_part(state) < BRANCH_CONTACT_SHARE:
            high = low
        found = float(state.values["fluid_load_share"])
        if share is not None and abs(share - found) < PLATEAU_SHARE_CHANGE and state.values["contact_load_share"] > 0.1:
            break
        share, low = found, low / 10
    return max(low, MIN_SPEED), min(10 * high, fastest)
