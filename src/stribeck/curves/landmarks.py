"""Landmarks of a curve, the minimum and the transitions: roots of its series, or states solved there."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from stribeck._types import Array
from stribeck.curves.coordinate import Coordinate
from stribeck.curves.function import CurvePoint, solved_at, within
from stribeck.numerics.newton import root_between
from stribeck.numerics.threads import one_blas_thread
from stribeck.solver.path import SolvedPath
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solution import Solution
from stribeck.solver.solve import SolveError, describe, solution_of

__all__ = ["Landmark", "Landmarks", "places_of"]

LOCATION_TOLERANCE = 1e-9
"""Relative tolerance to which a minimum or a transition is located; its own error is that of the curve there."""

STATES_RTOL = 1e-6
"""Largest tolerance of these states: a coarse curve has a few of them, and they are its headline."""

PARTS = 0.5 - 0.5 * np.cos(np.pi * np.arange(9) / 9)
"""Where a function is evaluated between two solved states, as fractions of the interval."""

STEP = 1e-20
"""Step into the complex plane for a derivative."""

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
    """

    name: str
    value: float
    friction: float
    solution: Solution = field(repr=False)


def places_of(path: SolvedPath) -> Array:
    """Return the coordinates of a path at which landmarks are searched for."""
    inside = [interval.left.coordinate + PARTS * interval.length for interval in path.intervals]
    return np.append(np.concatenate(inside), path.coordinates[-1])


class Landmarks:
    """The search for landmarks on one path."""

    def __init__(self, path: SolvedPath, coordinate: Coordinate, rtol: float) -> None:
        self.path, self.coordinate, self.rtol = path, coordinate, rtol
        self.moves = bool(coordinate.groups_at(float(path.coordinates[0])).speed > 0)
        self.places = places_of(path)
        self.rows = path.smooth(self.places)

    def lowest(
        self, function: Callable[[Array], Array], slope_of: Callable[[RefinedState], float]
    ) -> tuple[float, Solution] | None:
        """Return the coordinate and the state of the minimum of a function of the observables inside the path, or None."""
        places, values = self._known(function)
        i = int(np.argmin(values))
        if not 0 < i < len(places) - 1:
            return None

        def slope(s: Array) -> Array:
            return np.asarray(function(self.path.smooth(np.asarray(s + STEP * 1j))).imag / STEP)

        low, high = places[i - 1], places[i + 1]
        return self._polished(slope, float(low), float(high), slope_of)

    def first(self, function: Callable[[Array], Array], of: Callable[[RefinedState], float]) -> tuple[float, Solution] | None:
        """Return the coordinate and the state of the first zero of a function of the observables, ascending, or None."""
        places, values = self._known(function)
        crossings = np.nonzero(np.diff(np.sign(values)))[0]
        if not len(crossings):
            return None
        i = int(crossings[0])

        def value(s: Array) -> Array:
            return function(self.path.smooth(s))

        return self._polished(value, float(places[i]), float(places[i + 1]), of)

    def _known(self, function: Callable[[Array], Array]) -> tuple[Array, Array]:
        """Return the coordinates at which a function of the observables is known, and its values.

        Close to where a cavity opens no series holds.
        """
        values = function(self.rows)
        known = np.isfinite(values)
        return self.places[known], values[known]

    @one_blas_thread
    def _polished(
        self, function: Callable[[Array], Array], low: float, high: float, of: Callable[[RefinedState], float]
    ) -> tuple[float, Solution] | None:
        def at(s: float) -> float:
            return float(function(np.array([s]))[0])

        s = root_between(at, low, high, LOCATION_TOLERANCE)
        if s is None:
            return None
        rows, errors = self.path.at(np.array([s]))
        if within(self.path, rows, errors, min(self.rtol, STATES_RTOL))[0]:
            return math.exp(s), CurvePoint(self.coordinate, self.path, s, rows[0], errors[0], self.rtol)
        width = min(1e-3, 0.1 * (high - low))
        slope = (at(s + width) - at(s - width)) / (2 * width)
        for _ in range(MOST_POLISHES):
            point = solved_at(self.path, s, min(self.rtol, STATES_RTOL))
            if point.state is None or point.values is None:
                raise SolveError(point.outcome, None, f"{describe(self.coordinate.groups_at(s))}: {point.outcome.value}")
            step = -of(point) / slope
            if abs(step) <= LOCATION_TOLERANCE or not abs(step) < high - low:
                break
            s = s + step
        solution = solution_of(point, self.coordinate.contact_at(s), self.rtol)
        assert solution is not None
        return math.exp(s), solution
