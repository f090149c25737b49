r"""States between two solved ones of a path, many at once.

Where a path is dense, most of its states are not steps but lie between two.  Their guess is interpolated, and one iteration
corrects them all: the unknowns of each in a row, the residuals by matrix products.  The inverse Jacobian of a row is
interpolated between those of the two ends,

.. math:: J^{-1} \approx (1 - t) \, J_a^{-1} + t \, J_b^{-1},

in units of the unknowns, which leaves an error of second order in the distance of the ends.  So nothing is factorised here.
Each state is verified by its own error estimate, as any other is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import contact_law
from stribeck.contacts.line import Groups
from stribeck.equations.error_estimate import FineOperators
from stribeck.equations.line import Equations, Operators
from stribeck.equations.state import StackedStates, State, inverse_on
from stribeck.numerics.continuation import extrapolation_weights
from stribeck.numerics.newton import Inverse, Root
from stribeck.quantities.outcome import Outcome
from stribeck.solver.judgement import stacked, verified
from stribeck.solver.refinement import RefinedState, newton_tolerance

MOST_STEPS = 12

SLOWEST = 0.5
"""Part of the step before it that a step must be within for the row to count as contracting."""


@dataclass(frozen=True, eq=False)
class SolvedState:
    """A solved state of a path, and what it lends to those beside it."""

    coordinate: float
    point: RefinedState
    state: State
    operators: Operators
    fine: FineOperators

    @classmethod
    def at(cls, coordinate: float, point: RefinedState, operators: Operators, fine: FineOperators) -> SolvedState:
        """Return the anchor that a point is, with the operators of a mesh that resolves it."""
        assert point.state is not None
        return cls(coordinate, point, point.state, operators, fine)

    @cached_property
    def inverse(self) -> Inverse:
        """That of the Jacobian at the state on the mesh of the operators, in units of the unknowns."""
        return inverse_on(self.operators, self.state)

    def on(self, operators: Operators) -> Inverse:
        """Return the inverse on the mesh of other operators."""
        return self.inverse if operators is self.operators else inverse_on(operators, self.state)


@dataclass(frozen=True, eq=False)
class _Interval:
    """The rows between two anchors on one mesh, and the inverse Jacobian of each."""

    equations: Equations
    inverses: tuple[Inverse, Inverse]
    parts: Array

    def correction(self, residuals: Array, units: Array) -> Array:
        """Return what removes residuals, shape (..., rows, N + 2), to first order."""
        first, second = (inverse(residuals) for inverse in self.inverses)
        return np.asarray(units * (first + self.parts * (second - first)))


def interpolate_and_correct(
    ends: tuple[SolvedState, SolvedState],
    on: SolvedState,
    through: Sequence[SolvedState],
    coordinates: Sequence[float],
    groups: Sequence[Groups],
    rtol: float,
) -> list[RefinedState]:
    """Return the points at ``coordinates`` between two anchors; none if one of them does not converge.

    Parameters
    ----------
    ends : tuple of SolvedState
        The two.
    on : SolvedState
        That whose mesh is used.
    through : sequence of SolvedState
        Those through which guesses are interpolated.
    coordinates : sequence of float
        Where points are wanted.
    groups : sequence of Groups
        The groups there, of moving contacts.
    rtol : float
        Relative tolerance.

    Returns
    -------
    list of RefinedState
        In the order of the coordinates, each with its outcome.
    """
    operators, fine = on.operators, on.fine
    model = operators.model
    if operators.has_exit or model.film.uses_pressure or any(one.model != model for one in groups):
        return []  # these have unknowns that are not interpolated here, or another model each
    mesh = operators.mesh
    weights = np.stack([extrapolation_weights([a.coordinate for a in through], s) for s in coordinates])
    states = [a.state for a in through]
    at = operators.layout
    known = np.empty((len(states), at.size))
    for row, s in zip(known, states, strict=True):
        row[at.gap], row[at.offset], row[at.flux_gap] = s.log_gap(mesh), s.offset, np.log(s.flux_gap)
    y = weights @ known
    for block in (at.gap, at.flux_gap):
        y[:, block] = np.exp(y[:, block])
    scales = y[:, at.flux_gap] ** 2
    equations, load = stacked(groups, operators, scales)
    first, second = ends
    parts = (np.array(coordinates)[:, None] - first.coordinate) / (second.coordinate - first.coordinate)
    interval = _Interval(equations, (first.on(operators), second.on(operators)), parts)
    guess, tolerance = y, newton_tolerance(rtol)
    y, sizes, rates, steps = _corrected(interval, y, tolerance)
    if not ((sizes <= tolerance) & (rates <= SLOWEST)).all():
        return []
    prediction = np.abs(guess[:, at.gap] / y[:, at.gap] - 1).max(axis=1)
    solved = []
    for i in range(len(groups)):
        own = Equations(operators, float(groups[i].speed), contact_law(groups[i]), float(scales[i, 0]))
        root = Root(y[i], Outcome.CONVERGED, steps, 0, float(sizes[i]), float(rates[i]), 0.0, None)
        solved.append(State(groups[i], own, y[i], root, float(prediction[i])))
    rows = StackedStates(equations, y, load, lambda r: interval.correction(r, equations.units(y)))
    return verified(rows, solved, fine, rtol)


def _corrected(interval: _Interval, y: Array, tolerance: float) -> tuple[Array, Array, Array, int]:
    """Return the unknowns after the iteration, the size of each row's last step, its part of the one before, and steps."""
    equations = interval.equations
    sizes = rates = np.full(len(y), np.inf)
    with np.errstate(all="ignore"):
        for step in range(1, MOST_STEPS + 1):
            units = equations.units(y)
            dy = interval.correction(equations.residual(y), units)
            relative = np.abs(dy / units)
            relative[:, equations.layout.offset] = 0.0
            before, sizes = sizes, relative.max(axis=1)
            rates = sizes / before
            y = y + dy
            if step > 1 and (not (rates.max() <= SLOWEST) or sizes.max() <= tolerance):
                break
    return y, sizes, rates, step
