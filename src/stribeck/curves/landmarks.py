"""Landmarks of a curve, the minimum and the transitions: located between its points, on states solved for it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from stribeck._types import Array
from stribeck.curves.coordinate import Coordinate
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outcome import Outcome
from stribeck.solver.corrector import Corrector
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solution import Solution
from stribeck.solver.solve import SolveError, describe, solution_of

__all__ = ["Landmark", "locate"]

LOCATION_TOLERANCE = 1e-9
"""Relative tolerance to which a minimum or a transition is located; its own error is that of the solved states."""

WIDENINGS = (0, 2, 8, 32, 128)
"""Points by which the search for a landmark widens on both sides."""


@dataclass(frozen=True)
class Landmark:
    """A characteristic point of a curve: its position and the solution there.

    Attributes
    ----------
    name : str
        What it is, in words.
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


@one_blas_thread
def locate(
    function: Callable[[RefinedState], float],
    first: int,
    last: int,
    *,
    coordinate: Coordinate,
    values: Array,
    points: Sequence[RefinedState],
    rtol: float,
) -> tuple[float, Solution] | None:
    """Return where ``function`` of the solved state vanishes between two points, and the state there, or None.

    Where points are dense their own errors hide between which two it is: the search then widens.
    """
    corrector = Corrector(coordinate.groups_at, min(rtol, 1e-8))
    solved: dict[float, RefinedState] = {}
    found: dict[float, float] = {}

    def at(s: float) -> float:
        # The search asks for its ends twice, where another prediction would round otherwise and may turn a sign.
        if s in found:
            return found[s]
        nearest = sorted(known, key=lambda pair: -abs(pair[0] - s))
        point = corrector(s, nearest[-3:])
        if point is None or point.state is None:
            raise SolveError(Outcome.PATH_LOST, None, f"{describe(coordinate.groups_at(s))}: {Outcome.PATH_LOST.value}")
        solved[s] = point
        found[s] = function(point)
        return found[s]

    for wider in WIDENINGS:
        ends = max(0, first - wider), min(len(points) - 1, last + wider)
        known = [(float(np.log(values[i])), points[i]) for i in range(ends[0], ends[1] + 1)]
        low, high = known[0][0], known[-1][0]
        if at(low) * at(high) <= 0:
            break
    else:
        return None
    # Imported here because it takes longer than the rest of the package, and few uses get here.
    from scipy.optimize import brentq

    s = float(brentq(at, low, high, xtol=LOCATION_TOLERANCE, rtol=1e-14))
    if s not in solved:
        at(s)
    solution = solution_of(solved[s], coordinate.contact_at(s), rtol)
    assert solution is not None
    return math.exp(s), solution
