"""Many states on one mesh: their stacked equations, and their verification at once.

What a state costs to verify is mostly the number of its array operations; stacked they share them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import contact_law
from stribeck.contacts.line import Groups
from stribeck.equations.error_estimate import FineOperators, error_estimates
from stribeck.equations.line import Equations, Operators
from stribeck.equations.observables import observables_of_stacked
from stribeck.equations.state import StackedStates, State
from stribeck.numerics.newton import Inverse
from stribeck.solver.refinement import RefinedState, reached


def stacked(groups: Sequence[Groups], operators: Operators, flux_scales: Array) -> tuple[Equations, Array]:
    """Return the equations of moving contacts, one a row, and their load groups in a column; ``flux_scales`` is one too."""
    speed, load, roughness = (np.array([[float(getattr(g, name))] for g in groups]) for name in ("speed", "load", "roughness"))
    law = contact_law(Groups(speed, load, roughness, **groups[0].physics))
    return Equations(operators, speed, law, flux_scales), load


def verified(rows: StackedStates, states: Sequence[State], fine: FineOperators, rtol: float) -> list[RefinedState]:
    """Return the points that states are, with observables and error estimates from their ``rows``."""
    values = observables_of_stacked(rows.equations, rows.y, rows.load)
    estimates = error_estimates(rows, values, fine)
    return [
        RefinedState(state.groups, state, value, estimate, reached(estimate, rtol), fine=fine)
        for state, value, estimate in zip(states, values, estimates, strict=True)
    ]


def verify_together(
    states: Sequence[State], inverses: Sequence[Inverse], fine: FineOperators, rtol: float
) -> list[RefinedState]:
    """Return the points that states of moving contacts on one mesh are, each with the inverse that its iteration left."""
    y = np.stack([state.y for state in states])
    scales = np.array([[float(state.equations.flux_scale)] for state in states])
    equations, load = stacked([state.groups for state in states], states[0].equations.operators, scales)
    units = equations.units(y)
    sharing: dict[int, list[int]] = {}
    for i, own in enumerate(inverses):
        sharing.setdefault(id(own), []).append(i)

    def correct(residuals: Array) -> Array:
        found = np.empty_like(residuals)
        for members in sharing.values():
            found[:, members] = inverses[members[0]](residuals[:, members])
        return np.asarray(units * found)

    return verified(StackedStates(equations, y, load, correct), states, fine, rtol)
