"""The Stribeck curve of a ball: its states from neighbour to neighbour, its minimum and its transitions on solved states."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Groups
from stribeck.curves.coordinate import Coordinate
from stribeck.curves.landmarks import Landmark
from stribeck.curves.regime import BOUNDARY_FLUID_SHARE, HYDRODYNAMIC_CONTACT_SHARE, Transition
from stribeck.curves.result import StribeckCurve
from stribeck.numerics.newton import root_between
from stribeck.quantities.outcome import Outcome
from stribeck.solver.point.finish import finish_point
from stribeck.solver.point.path import NeighbourSolver
from stribeck.solver.point.solution import PointSolution, solution_of
from stribeck.solver.point.solve import RTOL_RANGE
from stribeck.solver.point.state import PointState
from stribeck.solver.solve import SolveError, describe

__all__ = ["PointCurve", "point_curve", "point_speeds"]

LOCATION_TOLERANCE = 1e-7
"""Relative tolerance to which a transition is located; its own error is that of the solved states."""

MINIMUM_WIDTH = 0.8
"""Width of the logarithms around a minimum on which friction is a polynomial."""

MINIMUM_NODES = 7
"""Solved states that it goes through."""

SLOWEST, FASTEST = 1e-8, 1e3
"""Speed groups between which a curve lies that chooses its range."""

COARSE = 1e-3
"""Tolerance of the states on which the range is found."""

PLATEAU, BRANCH = 1e-3, 1e-2
"""Change of the load share over a decade of speed, and asperities' part of the friction, below which the curve ends."""


@dataclass(frozen=True, eq=False)
class PointCurve(StribeckCurve):
    """Converged states of a ball along one coordinate, and the friction on them; see :class:`stribeck.StribeckCurve`."""

    solutions: tuple[PointSolution, ...] = field(kw_only=True)  # type: ignore[assignment]
    _solver: NeighbourSolver = field(kw_only=True, repr=False, compare=False)

    @property
    def hydrodynamic_friction(self) -> Array:
        """Nothing: the law of the paper for smooth surfaces is one of the line."""
        return np.full(len(self), math.nan)

    def _friction_of(self, boundary_friction: float, beta: float, definition: Definition) -> Array:
        found = [s.friction(boundary_friction, beta, definition) for s in self.solutions]
        return np.array([[f.contact, f.viscous, f.total, f.error] for f in found]).reshape(-1, 4)

    def _at(self, s: float) -> PointSolution:
        """Return the solution at a coordinate."""
        return finish_point(self._solver(s), self._path.contact_at(s))

    def _total(self, solution: PointSolution) -> float:
        return solution.friction(self.boundary_friction, self.beta, self.definition).total

    def _contact_share(self, solution: PointSolution) -> float:
        friction = solution.friction(self.boundary_friction, self.beta, self.definition)
        return friction.contact / friction.total if friction.total > 0 else 0.0

    def _mark(self, name: Transition, s: float) -> Landmark:
        solution = self._at(s)
        return Landmark(name, math.exp(s), self._total(solution), solution)  # type: ignore[arg-type]

    @cached_property
    def minimum(self) -> Landmark | None:
        """The friction minimum, on a polynomial through solved states around it; None where the curve has none inside."""
        moves = bool(np.all(np.asarray(self.groups.speed) > 0))
        i = int(np.argmin(self.friction)) if moves and len(self) > 2 else 0
        if not 0 < i < len(self) - 1:
            return None
        low, middle, high = np.log(self.values[i - 1 : i + 2]).tolist()
        try:
            while high - low > MINIMUM_WIDTH:
                new = 0.5 * (low + middle) if middle - low > high - middle else 0.5 * (middle + high)
                first, second = sorted((middle, new))
                if self._total(self._at(first)) < self._total(self._at(second)):
                    low, middle, high = low, first, second
                else:
                    low, middle, high = first, second, high
            nodes = np.cos(np.pi * (np.arange(MINIMUM_NODES) + 0.5) / MINIMUM_NODES)
            centre, half = 0.5 * (low + high), 0.5 * (high - low)
            values = [math.log(self._total(self._at(centre + half * node))) for node in nodes.tolist()]
            polynomial = np.polynomial.Chebyshev.fit(nodes, values, MINIMUM_NODES - 1, domain=[-1, 1])
            roots = [root.real for root in polynomial.deriv().roots() if abs(root.imag) < 1e-9 and abs(root.real) <= 1]
            if not roots:
                return None
            return self._mark(Transition.MINIMUM, centre + half * min(roots, key=lambda root: float(polynomial(root))))
        except SolveError:
            return None

    def landmark(self, name: Transition) -> Landmark | None:
        """Return one transition, or None where the curve does not hold it."""
        return next((mark for mark in self.transitions if mark.name == name), None)

    @cached_property
    def transitions(self) -> tuple[Landmark, ...]:
        """The boundaries between regimes, where the load is shared in halves, and the friction minimum, ascending."""
        fluid = self.observable("fluid_load_share")
        contact = self.friction_contact / np.maximum(self.friction, 1e-300)
        found = [
            self.minimum,
            self._crossing(Transition.BOUNDARY_END, fluid, lambda s: s.fluid_load_share, BOUNDARY_FLUID_SHARE),
            self._crossing(Transition.EQUAL_SHARES, fluid, lambda s: s.fluid_load_share, 0.5),
            self._crossing(Transition.HYDRODYNAMIC_START, contact, self._contact_share, HYDRODYNAMIC_CONTACT_SHARE),
        ]
        return tuple(sorted((mark for mark in found if mark is not None), key=lambda mark: mark.value))

    def _crossing(self, name: Transition, values: Array, of: Callable[[PointSolution], float], line: float) -> Landmark | None:
        """Return where a number of the solved state passes a line first, or None."""
        crossings = np.nonzero(np.diff(np.sign(values - line)))[0]
        if not len(crossings):
            return None

        def excess(s: float) -> float:
            return of(self._at(s)) - line

        ends = np.log(self.values[crossings[0] : crossings[0] + 2]).tolist()
        try:
            place = root_between(excess, ends[0], ends[1], LOCATION_TOLERANCE)
            return None if place is None else self._mark(name, place)
        except SolveError:
            return None


def point_curve(
    coordinate: Coordinate,
    values: Array,
    rtol: float,
    on_point: Callable[[int, int], object] | None,
    **settings: Any,
) -> PointCurve:
    """Return the curve of a ball.

    Parameters
    ----------
    coordinate : Coordinate
        What varies.
    values : ndarray
        Its values, ascending.
    rtol : float
        Relative tolerance of each state, at least 1e-8.
    on_point : callable, optional
        ``on_point(done, points)`` is called after each point.
    **settings : object
        ``boundary_friction``, ``beta`` and ``definition``.

    Returns
    -------
    PointCurve
        All points that converged; after Ctrl-C those that were finished.

    Raises
    ------
    SolveError
        If no state can be solved.
    """
    contact = coordinate.base if isinstance(coordinate.base, Contact) else None
    solver = NeighbourSolver(coordinate.groups_at, max(rtol, RTOL_RANGE[0]))
    solutions: list[PointSolution] = []
    where: list[float] = []
    outcome, failed = Outcome.CONVERGED, None
    try:
        for done, value in enumerate(values[::-1].tolist(), 1):  # from fast to slow, as films are smooth there
            s = math.log(value)
            state = solver(s)
            if state.outcome.ok:
                solutions.append(solution_of(solver.states[s], coordinate.contact_at(s)))
                where.append(value)
            else:
                outcome, failed = state.outcome, state
            if on_point is not None:
                on_point(done, len(values))
    except KeyboardInterrupt:
        outcome = Outcome.INTERRUPTED
    if not solutions:
        if failed is not None:
            finish_point(failed, contact)
        raise SolveError(outcome, None, f"{describe(coordinate.groups_at(math.log(values[-1])))}: {outcome.value}")
    return PointCurve(
        over=coordinate.over,
        values=np.array(where[::-1]),
        solutions=tuple(solutions[::-1]),
        contact=contact,
        rtol=rtol,
        outcome=outcome,
        requested=len(values),
        _path=coordinate,
        _solver=solver,
        **settings,
    )


def point_speeds(groups: Groups, boundary_friction: float, beta: float, definition: Definition) -> tuple[float, float]:
    """Return the speed groups from the boundary plateau of a ball to its hydrodynamic branch.

    They are found on coarse states a decade apart, down from the speed at which the smooth film is thirty times the
    roughness; smooth surfaces have no plateau, and their curve covers eight decades up to speed 10.
    """
    from dataclasses import replace

    kappa = float(groups.relative_roughness)
    if kappa == 0:
        return SLOWEST, 10.0
    solver = NeighbourSolver(lambda s: replace(groups, speed=math.exp(s)), COARSE)
    top = min(FASTEST, max(1e-6, (30 * kappa / 0.42) ** (1 / 0.6)))
    high, low, share = top, top, None

    def contact_part(state: PointState) -> float:
        friction = solution_of(state, None).friction(boundary_friction, beta, definition)
        return friction.contact / friction.total if friction.total > 0 else 0.0

    while low > SLOWEST:
        state = solver(math.log(low))
        if not state.outcome.ok:
            break
        if contact_part(state) < BRANCH:
            high = low
        found = float(state.values["fluid_load_share"])
        if share is not None and abs(share - found) < PLATEAU and state.values["contact_load_share"] > 0.1:
            break
        share, low = found, low / 10
    return max(low, SLOWEST), min(10 * high, FASTEST)
