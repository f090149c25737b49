"""A film of the line that ends at a given place: the first states of films with a free exit.

The frame of a film that ends moves with the exit, and with it the edges of thin films and of pressed asperities, by many of
their own lengths: Newton's iteration, which takes fields in that frame as linear in its place, then goes to and fro.  With the
exit given the frame stays where it is; from there to there fields are carried as a whole.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups, contact_law
from stribeck.equations.guess import Guess
from stribeck.equations.line import Equations, Operators
from stribeck.equations.state import State, unknowns_of
from stribeck.numerics.newton import Inverse, StepControl, root_find

__all__ = ["distance_to_flux_gap", "solve_at_fixed_exit"]


@dataclass(frozen=True, eq=False)
class FixedExitEquations(Equations):
    """The problem of a film whose exit stays: the gradient of the pressure there is left as it is."""

    def inverse(self, y: Array) -> Inverse:
        """Return the inverse of the Jacobian without the row and the column of the exit."""
        return _FixedExitInverse(super().inverse(y), self.layout.exit.start, y.size)


@dataclass(frozen=True, eq=False)
class _FixedExitInverse:
    """An inverse that leaves one unknown as it is, and the residual of its row."""

    free: Inverse
    held: int
    size: int

    @property
    def is_finite(self) -> bool:
        """Whether the inverse is finite."""
        return self.free.is_finite

    def __call__(self, residuals: Array) -> Array:
        """Return the steps in units of the unknowns."""
        unit = np.zeros(self.size)
        unit[self.held] = 1.0
        step, by_row = self.free(residuals), self.free(unit)
        return np.asarray(step - step[..., self.held, None] / by_row[self.held] * by_row)


def solve_at_fixed_exit(
    groups: Groups, operators: Operators, guess: Guess, tolerance: float, max_steps: int
) -> tuple[State, Array]:
    """Return the state whose film ends at the exit of the guess, and Newton's step from there with a free exit."""
    equations = FixedExitEquations(operators, float(groups.speed), contact_law(groups), guess.flux_gap**2)
    root = root_find(equations, unknowns_of(equations, guess), StepControl(tolerance, max_steps))
    free = Equations(operators, equations.speed, equations.law, equations.flux_scale)
    step = np.zeros_like(root.x)
    if root.outcome.ok:
        step = free.units(root.x) * free.inverse(root.x)(free.residual(root.x))
    return State(groups, free, root.x, replace(root, inverse=None), 0.0), step


def distance_to_flux_gap(state: State) -> float:
    """Return the distance from the exit to where the gap grows through the flux gap; infinite if it does not."""
    # There the flux needs no pressure, and the film ends.  The pressure gradient vanishes at infinity too: from beyond its
    # maximum Newton's step points there.
    equations, at = state.equations, state.equations.layout
    x, pressure = state.mesh.nodes, state.y[at.pressure] if equations.film.uses_pressure else None
    rising = equations.ending.gradient(state.gap, pressure, state.y[at.flux_gap]) > 0
    if equations.residual(state.y)[at.exit.start] > 0:
        return float(np.max(x[(x < 0) & ~rising], initial=-np.inf))
    return float(np.min(x[(x > 0) & rising], initial=np.inf))
