r"""A cavity of given length behind a film of the line, whose pressure is sought: the first states of films that re-form.

With the pressure given and the length sought, Newton's iteration moves the frame, and with it the inlet of the film by many of
its own lengths.  With the length given the frame stays where it is, and the pressure enters by constant columns alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import contact_law
from stribeck.contacts.line import Groups
from stribeck.equations.guess import Guess
from stribeck.equations.line import Equations, Operators
from stribeck.equations.state import State, unknowns_of
from stribeck.numerics.newton import StepControl, root_find

__all__ = ["solve_of_length"]


@dataclass(frozen=True, eq=False)
class FixedLengthEquations(Equations):
    """The problem of a cavity whose length is ``given`` in units of that on the mesh; its pressure takes that place."""

    given: float = 1.0

    def cavity_stretch(self, y: Array) -> Array:
        """Return the given one, a column of stacked states."""
        return np.full_like(y[..., self.layout.cavity_stretch], self.given)

    def cavity_pressure(self, y: Array) -> Array:
        """Return the pressure of the cavity, a column of stacked states."""
        return np.asarray(y[..., self.layout.cavity_stretch])

    def admissible(self, y: Array, dy: Array) -> float:
        """Return the longest fraction of a Newton step that doubles no gap."""
        # Gaps grow fast where the exit moves with the thin inlet; the pressure of the cavity is free.
        at, step = self.layout, dy.copy()
        step[at.cavity_stretch] = 0.0
        return min(super().admissible(y, step), 1.0 / max(1.0, float((dy[at.gap] / y[at.gap]).max())))

    def by_cavity_stretch_alone(self, y: Array, d: float, g: Array) -> Array:
        """Return the derivative of the residual with respect to that pressure, at a fixed fluid pressure."""
        found = np.zeros(y.size - self.layout.offset.start + g.size)
        found[-3:] = self.flux_scale / self.speed * np.array([-1.0, 0.0, 1.0])
        return found

    def fluid_by_cavity_stretch(self, g: Array, d: float, by_pressure: Array | None) -> Array:
        """Return the derivative of the fluid pressure by the cavity pressure, which takes the place of the stretch."""
        return self.operators.in_cavity


def solve_of_length(groups: Groups, operators: Operators, guess: Guess, tolerance: float, max_steps: int) -> State:
    """Return the state whose cavity has the length of the guess, of groups with the pressure that was found in it."""
    given = guess.cavity_stretch * guess.reformation / operators.mesh.reformation
    equations = FixedLengthEquations(operators, float(groups.speed), contact_law(groups), guess.flux_gap**2, given)
    start, pressure = unknowns_of(equations, guess), equations.layout.cavity_stretch
    start[pressure] = groups.model.cavity_pressure
    root = root_find(equations, start, StepControl(tolerance, max_steps))
    found = replace(groups.model, cavity_pressure=float(root.x[pressure][0]))
    y = root.x.copy()
    y[pressure] = given
    own = Equations(Operators(operators.mesh, found), equations.speed, equations.law, equations.flux_scale)
    return State(replace(groups, model=found), own, y, replace(root, x=y, inverse=None), 0.0)
