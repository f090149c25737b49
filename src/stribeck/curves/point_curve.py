"""The Stribeck curve of a ball: its states from neighbour to neighbour, its minimum and its transitions on solved states."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, Friction
from stribeck.contacts.friction_rules import COMPLEX_STEP, RULES
from stribeck.contacts.groups import Groups
from stribeck.contacts.regime import HYDRODYNAMIC_CONTACT_SHARE, friction_share
from stribeck.curves.coordinate import Coordinate
from stribeck.curves.function import CurveValues, Progress, observed
from stribeck.curves.landmarks import Landmark, friction_at, places_of
from stribeck.curves.regime import Transition, check_transition, excess
from stribeck.curves.result import StribeckCurve
from stribeck.equations.point.observables import OBSERVABLES, SMOOTH
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.newton import root_between
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import GROUPS
from stribeck.solver.path.path import SolvedPath, follow
from stribeck.solver.point.curve_path import CurveState, PointProblem
from stribeck.solver.point.path import NeighbourSolver
from stribeck.solver.point.solution import PointSolution, finish_point, solution_of
from stribeck.solver.point.solve import RTOL_RANGE
from stribeck.solver.point.state import PointState
from stribeck.solver.solve import SolveError, describe

__all__ = ["PointCurve", "point_curve", "point_speeds"]

LOCATION_TOLERANCE = 1e-7
"""Relative tolerance to which a transition is located; its own error is that of the solved states."""

SOLVED_LOCATION = 1e-2
"""The same over the tolerance of the states, where each place that is looked at is a state to solve."""

MINIMUM_WIDTH = 0.8
"""Width of the logarithms around a minimum on which friction is a polynomial."""

MINIMUM_NODES = 7
"""Solved states on this polynomial."""

SLOWEST, FASTEST = 1e-8, 1e3
"""Smallest and largest speed group of a curve that chooses its own range."""

COARSE = 1e-3
"""Tolerance of the states on which the range is found."""

PLATEAU, BRANCH = 1e-3, 1e-2
"""The curve ends where the load share changes by less than this over a decade of speed, and asperities cause less than this
part of the friction."""


@dataclass(frozen=True, eq=False, repr=False)
class PointCurve(StribeckCurve):
    """Converged states of a ball along one coordinate, and the friction on them; see :class:`stribeck.StribeckCurve`.

    Films that break, fluids that thin, liquid that ends near the contact and contacts at rest: known at their points only.
    """

    solutions: tuple[PointSolution, ...] = field(kw_only=True)  # type: ignore[assignment]
    _solver: NeighbourSolver = field(kw_only=True, repr=False, compare=False)

    def observable(self, name: str) -> Array:
        """Return an attribute of every solution as an array."""
        return observed(self.solutions, name)

    @property
    def error_estimate(self) -> float:
        """Largest estimated relative error over all points."""
        return max((s.error_estimate for s in self.solutions), default=math.nan)

    @property
    def hydrodynamic_friction(self) -> Array:
        """None: the article's law for smooth surfaces is of the line contact."""
        return np.full(len(self), math.nan)

    def _values(self, value: Any, s: Array) -> CurveValues:
        def shown(column: list[Any]) -> Any:
            return np.array(column) if np.ndim(value) else column[0]

        states = [_state_at(self._solved_path, each) for each in s.tolist()]
        solutions = [solution_of(state, self._path.contact_at(each)) for state, each in zip(states, s.tolist(), strict=True)]
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
        path = self._solved_path
        assert isinstance(path.problem, PointProblem)
        return finish_point(path.problem.solved_at(path, s), self._path.contact_at(s))

    def _along(self, path: SolvedPath, values: Array, requested: int) -> PointCurve:
        solutions = tuple(_solutions(path, self._path, np.log(values)))
        return replace(self, values=values, solutions=solutions, outcome=path.outcome, requested=requested, _function=path)

    def _solved_at(self, values: Array, on_point: Callable[[int, int], object] | None) -> PointCurve:
        solutions, where, _, outcome, failed = _point_by_point(self._path, values, self._solver, on_point)
        if not solutions and failed is not None:
            finish_point(failed, self.contact)
        return replace(self, values=where, solutions=solutions, outcome=outcome, requested=len(values))

    def _friction_of(self, boundary_friction: float, beta: float, definition: Definition) -> Array:
        found = [s.friction(boundary_friction, beta, definition) for s in self.solutions]
        return np.array([[f.contact, f.viscous, f.total, f.error] for f in found]).reshape(-1, 4)

    def _at(self, s: float) -> tuple[PointSolution, Friction]:
        """Return the solution at a coordinate, read off the function if there is one, else solved, and its friction."""
        contact = self._path.contact_at(s)
        known = None if self._function is None else _state_at(self._function, s)
        solution = finish_point(self._solver(s), contact) if known is None else solution_of(known, contact)
        return solution, solution.friction(self.boundary_friction, self.beta, self.definition)

    def _mark(self, name: Transition, s: float) -> Landmark:
        solution, friction = self._at(s)
        return Landmark(name, math.exp(s), friction_at(friction), solution)  # type: ignore[arg-type]

    @property
    def _ended_early(self) -> bool:
        """Whether Ctrl-C ended a curve whose marks are found by solving more states."""
        return self._function is None and self.outcome is Outcome.INTERRUPTED

    @cached_property
    def _at_unit(self) -> tuple[Groups, dict[str, Any], float]:
        """The groups where what varies is one, what friction hangs on there, and that of asperities over their load share."""
        rule, start = RULES["point"], self._path.groups_at(0.0)
        inputs: dict[str, Any] = dict(rule.of_contact(self._path.contact_at(0.0))) | {"beta": self.beta}
        if self.contact is None:
            inputs["slide_to_roll"] = 2.0 * start.model.film.slide
        return start, inputs, self.boundary_friction * float(rule.sliding_factor(start, inputs))

    def _parts_at(self, s: Array) -> tuple[Array, Array, Array]:
        """Return the load share of the fluid and both parts of the friction at real or complex coordinates."""
        rule, (start, known, rubbing) = RULES["point"], self._at_unit
        rows = dict(zip(SMOOTH, self._solved_path.smooth(s).T, strict=True))
        rates = dict(zip(GROUPS, self._path.direction.tolist(), strict=True))
        speed, load = (float(getattr(start, name)) * np.exp(rates[name] * s) for name in ("speed", "load"))
        inputs = dict(known)
        if math.isfinite(inputs["wetted_radius"]):
            inputs["wetted_radius"] *= np.exp(rule.exponents["wetted_radius"].get(self.over, 0.0) * s)
        viscous = rule.viscous(rows, speed, load, inputs, self.definition)
        return rows["fluid_load_share"], rubbing * rows["contact_load_share"], viscous

    @cached_property
    def minimum(self) -> Landmark | None:
        """The minimum of the size of the friction; None where the curve has none inside, or where it would be solved for."""
        if self._ended_early or not bool(np.all(np.asarray(self.groups.speed) > 0)):
            return None
        if self._function is None:
            places, total = np.log(self.values), np.asarray(self.friction)
        else:
            places = places_of(self._solved_path)
            total = np.add(*self._parts_at(places)[1:])
        # Friction that changes its sign is least, by its size, where it vanishes.
        crossing = self._crossing(Transition.MINIMUM, places, total)
        if crossing is not None:
            return crossing
        return self._lowest_of_points() if self._function is None else self._lowest_of_function(places, np.abs(total))

    def _lowest_of_function(self, places: Array, size: Array) -> Landmark | None:
        i = int(np.argmin(size))
        if not 0 < i < len(places) - 1 or np.ptp(size) <= self.rtol * size.max():
            return None

        def slope(s: float) -> float:
            return float(np.add(*self._parts_at(np.array([s + COMPLEX_STEP * 1j]))[1:])[0].imag / COMPLEX_STEP)

        place = root_between(slope, float(places[i - 1]), float(places[i + 1]), LOCATION_TOLERANCE)
        return None if place is None else self._mark(Transition.MINIMUM, place)

    def _lowest_of_points(self) -> Landmark | None:
        """Return the minimum on a polynomial through solved states around it."""
        try:
            around = self._around_the_lowest()
            if around is None:
                return None
            low, middle, high = around
            while high - low > MINIMUM_WIDTH:
                new = 0.5 * (low + middle) if middle - low > high - middle else 0.5 * (middle + high)
                first, second = sorted((middle, new))
                if abs(self._at(first)[1]) < abs(self._at(second)[1]):
                    low, middle, high = low, first, second
                else:
                    low, middle, high = first, second, high
            nodes = np.cos(np.pi * (np.arange(MINIMUM_NODES) + 0.5) / MINIMUM_NODES)
            centre, half = 0.5 * (low + high), 0.5 * (high - low)
            values = [math.log(abs(self._at(centre + half * node)[1])) for node in nodes.tolist()]
            polynomial = np.polynomial.Chebyshev.fit(nodes, values, MINIMUM_NODES - 1, domain=[-1, 1])
            roots = [root.real for root in polynomial.deriv().roots() if abs(root.imag) < 1e-9 and abs(root.real) <= 1]
            if not roots:
                return None
            lowest = float(min(roots, key=lambda root: float(polynomial(root))))
            return self._mark(Transition.MINIMUM, centre + half * lowest)
        except SolveError:
            return None

    def _around_the_lowest(self) -> tuple[float, float, float] | None:
        """Return three places of which the middle one has the least friction.

        Where the fluid causes the friction of the lowest point, and that is the last, the minimum may hide before it.
        """
        size, places = np.abs(self.friction.total), np.log(self.values).tolist()
        i = int(np.argmin(size))
        if 0 < i < len(self) - 1:
            return places[i - 1], places[i], places[i + 1]
        if len(self) < 2 or abs(self.friction_contact[i]) > HYDRODYNAMIC_CONTACT_SHARE * float(size[i]):
            return None
        end, inner = places[i], places[1 if i == 0 else -2]
        while abs(end - inner) > MINIMUM_WIDTH:
            middle = 0.5 * (inner + end)
            if abs(self._at(middle)[1]) < size[i]:
                return min(inner, end), middle, max(inner, end)
            inner = middle
        return None

    def landmark(self, name: str, rtol: float | None = None) -> Landmark | None:
        """Return one transition, or None where the curve does not hold it; it is read off the curve, without the others."""
        mark = check_transition(name)
        if mark is Transition.MINIMUM:
            return self.minimum
        if self._ended_early:
            return None
        places, fluid, share = self._shares
        return self._crossing(mark, places, excess(mark, fluid, share))

    @cached_property
    def _shares(self) -> tuple[Array, Array, Array]:
        """Coordinates, and there the share of the fluid in the load and that of asperities in the friction."""
        if self._function is None:
            fluid, contact, total = self.observable("fluid_load_share"), self.friction_contact, np.asarray(self.friction)
            places, share = np.log(self.values), friction_share(contact, total - contact)
        else:
            places = places_of(self._solved_path)
            fluid, share = self._shares_at(places)
        return places, fluid, share

    def _shares_at(self, s: Array) -> tuple[Array, Array]:
        """Return the load share of the fluid, and that of asperities in friction, at coordinates of a function."""
        fluid, contact, viscous = self._parts_at(s)
        return fluid, friction_share(contact, viscous)

    def _excess(self, name: Transition, s: float) -> float:
        """Return by how much the criterion of a transition exceeds its threshold; the friction, for where it vanishes."""
        if name is Transition.MINIMUM:
            at = np.array([s])
            return self._at(s)[1].total if self._function is None else float(np.add(*self._parts_at(at)[1:])[0])
        if self._function is not None:
            fluid, share = self._shares_at(np.array([s]))
            return float(excess(name, fluid, share)[0])
        solution, friction = self._at(s)
        return excess(name, solution.fluid_load_share, friction.contact_share)

    def _crossing(self, name: Transition, places: Array, above: Array) -> Landmark | None:
        """Return the first transition of this name between the given coordinates, or None."""
        crossings = np.nonzero(np.diff(np.sign(above)))[0]
        if not len(crossings):
            return None
        low, high = places[crossings[0] : crossings[0] + 2].tolist()
        try:
            near = LOCATION_TOLERANCE if self.is_function else max(LOCATION_TOLERANCE, SOLVED_LOCATION * self.rtol)
            place = root_between(lambda s: self._excess(name, s), low, high, near)
            return None if place is None else self._mark(name, place)
        except SolveError:
            return None


def _state_at(path: SolvedPath, s: float) -> PointState:
    """Return the state of a path at a coordinate: read off the function, or solved where its error exceeds the tolerance."""
    problem = path.problem
    assert isinstance(problem, PointProblem)
    row, errors = (each[0] for each in path.at(np.array([s])))
    return CurveState(problem, path, s, row, errors) if (errors <= problem.allowed).all() else problem.solved_at(path, s)


def _solutions(path: SolvedPath, coordinate: Coordinate, places: Array) -> Iterator[PointSolution]:
    for s in places.tolist():
        yield finish_point(_state_at(path, s), coordinate.contact_at(s))


def point_curve(
    coordinate: Coordinate,
    values: Array,
    rtol: float,
    on_point: Callable[[int, int], object] | None,
    **settings: Any,
) -> PointCurve:
    """Return the curve of a ball."""
    start, rule = coordinate.groups_at(math.log(values[-1])), RULES["point"]
    is_function = (
        start.speed > 0
        and start.model.cavitation is Cavitation.NONE
        and rule.is_enough(start.model, [rule.of_contact(coordinate.contact_at(math.log(end))) for end in values[[0, -1]]])
        and coordinate.is_uniform(values)
    )
    trace = _followed if is_function else _point_by_point
    solver = NeighbourSolver(coordinate.groups_at, max(rtol, RTOL_RANGE[0]))
    solutions, where, path, outcome, failed = trace(coordinate, values, solver, on_point)
    contact = coordinate.base if isinstance(coordinate.base, Contact) else None
    if not solutions:
        if failed is not None:
            finish_point(failed, contact)
        raise SolveError(outcome, None, f"{describe(start)}: {outcome.value}")
    return PointCurve(
        over=coordinate.over,
        values=where,
        solutions=solutions,
        contact=contact,
        rtol=rtol,
        outcome=outcome,
        requested=len(values),
        _path=coordinate,
        _function=path,
        _solver=solver,
        **settings,
    )


_Traced = tuple[tuple[PointSolution, ...], Array, SolvedPath | None, Outcome, PointState | None]


def _followed(
    coordinate: Coordinate, values: Array, solver: NeighbourSolver, on_point: Callable[[int, int], object] | None
) -> _Traced:
    """Return the points of a curve, read off its function, from fast to slow, as the film is smooth at high speed."""
    problem, places = PointProblem(coordinate.groups_at, solver.rtol), np.log(values)
    path = follow(problem, float(places[-1]), float(places[0]), solver.rtol, Progress(places, on_point))
    problem.release()
    known = values[places >= path.coordinates[0]] if path.intervals else values[:0]
    solutions: tuple[PointSolution, ...] = ()
    try:
        for solution in _solutions(path, coordinate, np.log(known)[::-1]):
            solutions = solution, *solutions
    except KeyboardInterrupt:
        path = replace(path, outcome=Outcome.INTERRUPTED)
        known = known[len(known) - len(solutions) :]
    return solutions, known, path, path.outcome, problem.failure


def _point_by_point(
    coordinate: Coordinate, values: Array, solver: NeighbourSolver, on_point: Callable[[int, int], object] | None
) -> _Traced:
    """Return the points of a curve, each solved from its neighbour, from fast to slow or from where states are known."""
    found: dict[float, PointSolution] = {}
    outcome, failed = Outcome.CONVERGED, None
    slow, fast = (min((abs(s - math.log(end)) for s in solver.states), default=0.0) for end in values[[0, -1]])
    try:
        for done, value in enumerate(values.tolist() if slow < fast else values[::-1].tolist(), 1):
            s = math.log(value)
            state = solver(s)
            solution = solution_of(solver.states[s], coordinate.contact_at(s)) if state.outcome.ok else None
            if solution is not None and solution.outcome.ok:
                found[value] = solution
            elif solution is not None:
                outcome = solution.outcome
            else:
                outcome, failed = state.outcome, state
            if on_point is not None:
                on_point(done, len(values))
    except KeyboardInterrupt:
        outcome = Outcome.INTERRUPTED
    where = sorted(found)
    return tuple(found[value] for value in where), np.array(where), None, outcome, failed


def point_speeds(groups: Groups, boundary_friction: float, beta: float, definition: Definition) -> tuple[float, float]:
    """Return the speed groups from the boundary plateau of a ball to its hydrodynamic branch.

    They are found on coarse states a decade apart, down from the speed at which the smooth film is thirty times the
    roughness, or from the first below it that is solved, to the last that is; smooth surfaces have no plateau, and their
    curve covers eight decades up to speed 10.
    """
    kappa = float(groups.relative_roughness)
    if kappa == 0:
        return SLOWEST, 10.0
    solver = NeighbourSolver(lambda s: replace(groups, speed=math.exp(s)), COARSE)
    fastest, low, share = FASTEST, min(FASTEST, max(1e-6, (30 * kappa / 0.42) ** (1 / 0.6))), None
    high = low

    def contact_part(state: PointState) -> float:
        return solution_of(state, None).friction(boundary_friction, beta, definition).contact_share

    while low > SLOWEST:
        state = solver(math.log(low))
        if not state.outcome.ok:
            if share is not None:  # slower ones are not solved
                low *= 10
                break
            fastest = low = high = low / 10
            continue
        if contact_part(state) < BRANCH:
            high = low
        found = float(state.values["fluid_load_share"])
        if share is not None and abs(share - found) < PLATEAU and state.values["contact_load_share"] > 0.1:
            break
        share, low = found, low / 10
    return max(low, SLOWEST), min(10 * high, fastest)
