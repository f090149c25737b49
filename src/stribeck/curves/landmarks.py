"""Landmarks of a curve, the minimum and the transitions: roots of its series, or states solved there."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.contacts.friction import Definition, Friction
from stribeck.contacts.regime import friction_share
from stribeck.curves.coordinate import Coordinate
from stribeck.curves.function import CurvePoint, solved_at, within
from stribeck.curves.regime import Transition, excess
from stribeck.equations.observables import ROW
from stribeck.equations.sensitivity import friction_slopes
from stribeck.numerics.newton import root_between
from stribeck.numerics.threads import one_blas_thread
from stribeck.solver.path.line_path import POSITION
from stribeck.solver.path.path import SolvedPath
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solution import Solution
from stribeck.solver.solve import solution_of
from stribeck.solver.solve_error import SolveError, describe

__all__ = ["STATES_RTOL", "Landmark", "Landmarks", "Place", "friction_at"]

LOCATION_TOLERANCE = 1e-9
"""Relative tolerance to which a minimum or a transition is located on states; their errors are added to it."""

STATES_RTOL = 1e-6
"""Largest tolerance of these states unless another is asked for: a coarse curve has few of them, and they are its headline."""

PARTS = 0.5 - 0.5 * np.cos(np.pi * np.arange(9) / 9)
"""Where a function is evaluated between two solved states, as fractions of the interval."""

STEP = 1e-20
"""Step into the complex plane for a derivative."""

WIDTH = 1e-3
"""Step along the coordinate for other derivatives."""

NEAR = 0.5
"""Distance along the coordinate up to which the mesh of one landmark may serve another."""

MOST_POLISHES = 4
"""Most states solved for one landmark: each squares the error."""


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
        The state.
    error : float
        Estimated relative error of ``value``, by the errors of the observables [-]; nan for a ball.
    """

    name: str
    value: float
    friction: float
    solution: Solution = field(repr=False)
    error: float = math.nan


class Place(NamedTuple):
    """Where a landmark is: coordinate, its estimated error, and the state."""

    coordinate: float
    error: float
    solution: Solution


def friction_at(friction: Friction) -> float:
    """Return the friction at a landmark, zero where it vanishes within its error."""
    return friction.total if abs(friction.total) > friction.error else 0.0


class Landmarks:
    """The search for landmarks on one path, whose friction is ``rubbing`` times the load share of asperities, and viscous."""

    def __init__(self, path: SolvedPath, coordinate: Coordinate, rtol: float) -> None:
        self.path, self.coordinate, self.rtol = path, coordinate, rtol
        self.moves = bool(coordinate.groups_at(float(path.coordinates[0])).speed > 0)
        self.places = path.places(PARTS)
        self.rows = path.smooth(self.places)
        self.solved: dict[float, RefinedState] = {}

    def place(self, mark: Transition, rubbing: float, beta: float, definition: Definition, accepted: float) -> Place | None:
        """Return where a transition or the minimum lies, for coefficients of the friction; None where the path holds none."""
        viscous = ROW[f"viscous_{definition}"]

        def parts(rows: Array) -> tuple[Array, Array]:
            return rubbing * rows[:, ROW["contact_load_share"]], beta * rows[:, viscous]

        def slope(point: RefinedState) -> float:
            assert point.state is not None
            return float(friction_slopes(point.state, rubbing, beta, definition) @ self.coordinate.direction)

        def above(rows: Array) -> Array:
            contact, other = parts(rows)
            return np.asarray(excess(mark, rows[:, ROW["fluid_load_share"]], friction_share(contact, other)))

        def total(rows: Array) -> Array:
            return np.add(*parts(rows))

        if mark is not Transition.MINIMUM:
            return self._first(above, accepted)
        if not self.moves:  # at rest the friction is that of the dry contact along the whole curve
            return None
        # Friction that changes its sign is least, by its size, where it vanishes.
        return self._first(total, accepted) or self._lowest(total, slope, accepted)

    def _lowest(
        self, function: Callable[[Array], Array], slope_of: Callable[[RefinedState], float], accepted: float
    ) -> Place | None:
        """Return the minimum of the size of a function of the observables inside the path, or None.

        It is read off the path where the errors of that are at most ``accepted``, else off a state.
        """
        places, values = self._known(function)
        if not len(values):  # friction beyond double precision along the whole path
            return None
        i = int(np.argmin(np.abs(values)))
        if not 0 < i < len(places) - 1:
            return None

        def slope(s: float) -> float:
            return float(function(self.path.smooth(np.array([s + STEP * 1j]))).imag[0] / STEP)

        def doubt(s: float, row: Array, errors: Array) -> float:
            """Of the slope: errors change along an interval as the polynomials do."""
            length = max(self.path.intervals[int(self.path.interval_of(np.array([s]))[0])].length, WIDTH)
            near = np.array([s - WIDTH, s + WIDTH])
            before, after = (self._doubt(function, *each) for each in zip(near.tolist(), *self.path.at(near), strict=True))
            return 2 * self._doubt(function, s, row, errors) / length + abs(after - before) / (2 * WIDTH)

        return self._polished(slope, float(places[i - 1]), float(places[i + 1]), slope_of, doubt, accepted)

    def _first(self, function: Callable[[Array], Array], accepted: float) -> Place | None:
        """Return the first zero of a function of the observables, ascending, or None; ``accepted`` as for :meth:`_lowest`."""
        places, values = self._known(function)
        crossings = np.nonzero(np.diff(np.sign(values)))[0]
        if not len(crossings):
            return None
        i = int(crossings[0])

        def value(s: float) -> float:
            return float(function(self.path.smooth(np.array([s])))[0])

        def of(point: RefinedState) -> float:
            assert point.values is not None
            return float(function(point.values.array()[None])[0])

        def doubt(s: float, row: Array, errors: Array) -> float:
            return self._doubt(function, s, row, errors)

        return self._polished(value, float(places[i]), float(places[i + 1]), of, doubt, accepted)

    def _known(self, function: Callable[[Array], Array]) -> tuple[Array, Array]:
        """Return the coordinates at which a function of the observables is known, and its values.

        Close to where a cavity opens no series holds.
        """
        values = function(self.rows)
        known = np.isfinite(values)
        return self.places[known], values[known]

    def _doubt(self, function: Callable[[Array], Array], s: float, row: Array, errors: Array) -> float:
        """Return the error of a function of the observables from theirs, in units of the scales of the path."""
        slopes = function(row + STEP * 1j * np.eye(len(row))).imag / STEP
        sizes = errors * self.path.problem.scales(row[None], np.array([s]))[0]
        used = slopes != 0
        return float(np.abs(slopes[used]) @ sizes[used])

    def _solved_at(self, s: float, rtol: float) -> RefinedState:
        """Return the state at a coordinate; the mesh of the nearest one solved before for a landmark is tried first."""
        near = min(self.solved, key=lambda each: abs(each - s), default=math.inf)
        point = solved_at(self.path, s, rtol, self.solved[near] if abs(near - s) <= NEAR else None)
        self.solved[s] = point
        return point

    @one_blas_thread
    def _polished(
        self,
        at: Callable[[float], float],
        low: float,
        high: float,
        of: Callable[[RefinedState], float],
        doubt: Callable[[float, Array, Array], float],
        accepted: float,
    ) -> Place | None:
        s = root_between(at, low, high, LOCATION_TOLERANCE)
        if s is None:
            return None
        width, rtol = min(WIDTH, 0.1 * (high - low)), min(self.rtol, accepted)
        slope = (at(s + width) - at(s - width)) / (2 * width)
        (row,), (errors,) = self.path.at(np.array([s]))
        if within(self.path, row[None], errors[None], accepted)[0]:
            solution: Solution | None = CurvePoint(self.coordinate, self.path, s, row, errors, rtol)
        else:
            for _ in range(MOST_POLISHES):
                point = self._solved_at(s, rtol)
                if point.state is None or point.values is None:
                    raise SolveError(point.outcome, None, f"{describe(self.coordinate.groups_at(s))}: {point.outcome.value}")
                step = -of(point) / slope
                if abs(step) <= LOCATION_TOLERANCE or not abs(step) < high - low:
                    break
                s = s + step
            solution = solution_of(point, self.coordinate.contact_at(s), rtol)
        assert solution is not None
        row[:POSITION], known = solution.observables.array(in_article=False), solution.counted_errors
        errors[: len(known)] = known
        return Place(s, LOCATION_TOLERANCE + doubt(s, row, errors) / abs(slope), solution)
