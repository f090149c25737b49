"""Landmarks of a curve, the minimum and the transitions: roots of its series, or states solved there."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.contacts.friction import Definition, Friction
from stribeck.contacts.regime import friction_share
from stribeck.curves.coordinate import Coordinate
from stribeck.curves.function import CurvePoint, solved_at, within
from stribeck.curves.regime import Transition, excess
from stribeck.equations.observables import ROW
from stribeck.equations.sensitivity import friction_slopes
from stribeck.numerics.events import Event, first_zero, least_by_slope
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outputs import GROUPS
from stribeck.solver.path.line_path import POSITION
from stribeck.solver.path.path import SolvedPath
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solution import Solution
from stribeck.solver.solve import solution_of
from stribeck.solver.solve_error import SolveError, describe

__all__ = ["MAX_STATE_RTOL", "Landmark", "Landmarks", "Place", "friction_at", "vanishing"]

LOCATION_LOG_TOLERANCE = 1e-9  # Change of ln(value) to which a landmark is located; errors of its state are added
MAX_STATE_RTOL = 1e-6  # Largest rtol of a landmark's state unless another is asked for: landmarks are a curve's headline
INTERVAL_FRACTIONS = 0.5 - 0.5 * np.cos(np.pi * np.arange(9) / 9)  # Places of an interval at which functions are evaluated
COMPLEX_STEP = 1e-20  # Imaginary step of a derivative, which cancels nothing
LOG_STEP = 1e-3  # Step of ln(value) in derivatives by real differences
MESH_LOG_DISTANCE = 0.5  # Distance of ln(value) up to which the mesh of one landmark's state is tried at another
MAX_POLISH_STATES = 4  # Most states solved for one landmark: each squares the error


@dataclass(frozen=True)
class Landmark:
    """A characteristic point of a curve: its position and the solution there.

    Attributes
    ----------
    name : str
        Its name.
    value : float
        Where along the curve: group [-], or SI where the curve has a contact.
    friction : float
        Total friction coefficient there [-].
    solution : Solution
        The state; None off the atlas.
    error : float
        Estimated relative error of ``value``, by the errors of the observables [-]; nan for a ball.
    over : {"speed", "load", "roughness"}
        What the curve runs over: ``value`` is also the attribute of that name, as ``curve.minimum.speed``.
    """

    name: str
    value: float
    friction: float
    solution: Any = field(default=None, repr=False)
    error: float = math.nan
    over: str = field(default="speed", repr=False)

    def __getattr__(self, name: str) -> float:
        """Return the value by the name of what the curve runs over."""
        if name in GROUPS and name == vars(self).get("over"):
            return self.value
        raise AttributeError(f"a landmark over {vars(self).get('over')} has no attribute {name!r}")


class Place(NamedTuple):
    """Where a landmark is: coordinate, its estimated error, and the state."""

    coordinate: float
    error: float
    solution: Solution


def friction_at(friction: Friction) -> float:
    """Return the friction at a landmark, zero where it vanishes within its error."""
    return friction.total if abs(friction.total) > friction.error else 0.0


def vanishing(mark: Transition, fluid: Array, contact: Array, viscous: Array) -> Array:
    """Return what vanishes at a transition, from the fluid's load share and both parts of the friction."""
    # Of the minimum the friction itself: where it changes its sign its size is least.
    if mark is Transition.MINIMUM:
        return np.asarray(contact + viscous)
    return np.asarray(excess(mark, fluid, friction_share(contact, viscous)))


class Landmarks:
    """The search for landmarks on one path, whose friction is ``rubbing`` times the load share of asperities, and viscous."""

    def __init__(self, path: SolvedPath, coordinate: Coordinate, rtol: float) -> None:
        self.path, self.coordinate, self.rtol = path, coordinate, rtol
        self.moves = bool(coordinate.groups_at(float(path.coordinates[0])).speed > 0)
        self.places = path.places(INTERVAL_FRACTIONS)
        self.rows = path.smooth(self.places)
        self.solved: dict[float, RefinedState] = {}

    @one_blas_thread
    def place(self, mark: Transition, rubbing: float, beta: float, definition: Definition, accepted: float) -> Place | None:
        """Return where a transition or the minimum lies, for coefficients of the friction; None where the path holds none.

        It is read off the path where the errors of the observables are at most ``accepted``, else off a state.
        """
        if mark is Transition.MINIMUM and not self.moves:  # at rest the friction is that of the dry contact everywhere
            return None
        fluid, contact, viscous = (ROW[name] for name in ("fluid_load_share", "contact_load_share", f"viscous_{definition}"))

        def function(rows: Array) -> Array:
            return vanishing(mark, rows[:, fluid], rubbing * rows[:, contact], beta * rows[:, viscous])

        def at(s: float) -> float:
            return float(function(self.path.smooth(np.array([s])))[0])

        def slope(s: float) -> float:
            return float(function(self.path.smooth(np.array([s + COMPLEX_STEP * 1j]))).imag[0] / COMPLEX_STEP)

        def at_state(point: RefinedState) -> float:
            assert point.values is not None
            return float(function(point.values.array()[None])[0])

        def slope_at_state(point: RefinedState) -> float:
            assert point.state is not None
            return float(friction_slopes(point.state, rubbing, beta, definition) @ self.coordinate.direction)

        def doubt(s: float, row: Array, errors: Array) -> float:
            return self._doubt(function, s, row, errors)

        def doubt_of_slope(s: float, row: Array, errors: Array) -> float:
            # Errors change along an interval as its polynomials do.
            length = max(self.path.intervals[int(self.path.interval_of(np.array([s]))[0])].length, LOG_STEP)
            near = np.array([s - LOG_STEP, s + LOG_STEP])
            before, after = (doubt(*each) for each in zip(near.tolist(), *self.path.at(near), strict=True))
            return 2 * doubt(s, row, errors) / length + abs(after - before) / (2 * LOG_STEP)

        values = function(self.rows)
        known = np.isfinite(values)  # no series holds close to where a cavity opens
        places, values = self.places[known], values[known]
        event = first_zero(at, places, values, LOCATION_LOG_TOLERANCE)
        if event is not None:
            return self._polished(event, at_state, doubt, accepted)
        lowest = mark is Transition.MINIMUM and least_by_slope(slope, places, np.abs(values), LOCATION_LOG_TOLERANCE)
        return self._polished(lowest, slope_at_state, doubt_of_slope, accepted) if lowest else None

    def _doubt(self, function: Callable[[Array], Array], s: float, row: Array, errors: Array) -> float:
        """Return the error of a function of the observables from theirs, in units of the scales of the path."""
        slopes = function(row + COMPLEX_STEP * 1j * np.eye(len(row))).imag / COMPLEX_STEP
        sizes = errors * self.path.problem.scales(row[None], np.array([s]))[0]
        used = slopes != 0
        return float(np.abs(slopes[used]) @ sizes[used])

    def _solved_at(self, s: float, rtol: float) -> RefinedState:
        """Return the state at a coordinate; the mesh of the nearest one solved before for a landmark is tried first."""
        near = min(self.solved, key=lambda each: abs(each - s), default=math.inf)
        point = solved_at(self.path, s, rtol, self.solved[near] if abs(near - s) <= MESH_LOG_DISTANCE else None)
        self.solved[s] = point
        return point

    def _polished(
        self,
        event: Event,
        at_state: Callable[[RefinedState], float],
        doubt: Callable[[float, Array, Array], float],
        accepted: float,
    ) -> Place:
        """Return the place of an event to ``accepted``, with its error and state."""
        at, s, span = event.function, event.place, event.high - event.low
        width, rtol = min(LOG_STEP, 0.1 * span), min(self.rtol, accepted)
        slope = (at(s + width) - at(s - width)) / (2 * width)
        (row,), (errors,) = self.path.at(np.array([s]))
        if within(self.path, row[None], errors[None], accepted)[0]:
            solution: Solution | None = CurvePoint(self.coordinate, self.path, s, row, errors, rtol)
        else:
            for _ in range(MAX_POLISH_STATES):
                point = self._solved_at(s, rtol)
                if point.state is None or point.values is None:
                    raise SolveError(point.outcome, None, f"{describe(self.coordinate.groups_at(s))}: {point.outcome.value}")
                step = -at_state(point) / slope
                if abs(step) <= LOCATION_LOG_TOLERANCE or not abs(step) < span:
                    break
                s = s + step
            solution = solution_of(point, self.coordinate.contact_at(s), rtol)
        assert solution is not None
        row[:POSITION], known = solution.observables.array(in_article=False), solution.counted_errors
        errors[: len(known)] = known
        return Place(s, LOCATION_LOG_TOLERANCE + doubt(s, row, errors) / abs(slope), solution)
