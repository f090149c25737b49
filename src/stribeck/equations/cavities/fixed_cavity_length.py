r"""A cavity of given length behind a film of the line, whose pressure is sought: the first states of films that re-form.

With the pressure given and the length sought, Newton's iteration moves the frame, and with it the inlet of the film by many of
its own lengths.  With the length given the frame stays where it is, and the pressure enters by constant columns alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups, contact_law
from stribeck.equations.guess import Guess
from stribeck.equations.line import Equations, Fields, Operators
from stribeck.equations.state import State, unknowns_of
from stribeck.numerics.newton import StepControl, root_find
from stribeck.numerics.trace import value_of

__all__ = ["solve_of_length"]


@dataclass(frozen=True, eq=False)
class FixedLengthEquations(Equations):
    """The problem of a cavity whose length is ``given`` in units of that on the mesh; its pressure takes that place."""

    given: float = 1.0

    def stretch_of(self, u: Fields) -> Array:
        """Return the given one."""
        return np.full_like(value_of(u.cavity_stretch), self.given)

    def cavity_pressure_of(self, u: Fields) -> Any:
        """Return the pressure of the cavity, which takes the place of its stretch."""
        return u.cavity_stretch

    def admissible(self, y: Array, dy: Array) -> float:
        """Return the longest fraction of a Newton step that doubles no gap."""
        # Gaps grow fast where the exit moves with the thin inlet; the pressure of the cavity is free.
        at, step = self.layout, dy.copy()
        step[at.cavity_stretch] = 0.0
        return min(super().admissible(y, step), 1.0 / max(1.0, float((dy[at.gap] / y[at.gap]).max())))


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
