r"""Derivatives of the observables with respect to the groups and the model, by implicit differentiation of the equations.

.. math:: \frac{dy}{d\ln G} = -J^{-1} \frac{\partial R}{\partial \ln G}

for each group G, with the factors of Newton's Jacobian made anew at the state.  The friction of all films is that of
:mod:`stribeck.equations.drag`: in thin films the closed form for the article's film errs with the moment of the pressure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.model import Model
from stribeck.equations.observables import ROW, changes, measured
from stribeck.equations.operators import Operators
from stribeck.equations.state import State
from stribeck.numerics.trace import Trace
from stribeck.quantities.outputs import ALL_NAMES

GROUPS = ("speed", "load", "roughness")

Change = tuple[Model, Model, float]
"""Two models, and the distance of the values that give them."""


def log_derivatives(state: State, beside: Sequence[Change] = ()) -> dict[str, Array]:
    """Return the derivatives of all observables with respect to ln(group), and along changes of the model."""
    equations, y, load = state.equations, state.y, float(state.groups.load)
    inverse, units = equations.inverse(y), equations.units(y)
    count = len(GROUPS) + len(beside)
    found, moves = np.zeros((count, len(ALL_NAMES))), np.zeros((count, y.size))
    for k, name in enumerate(GROUPS):
        if float(getattr(state.groups, name)) > 0:
            for each, value in measured(equations, equations.fields(y), load, name).items():
                found[k, ROW[each]] = _by(value, name)
            moves[k] = units * inverse(equations.parameter_derivative(y, name))
    for k, (below, above, width) in enumerate(beside, len(GROUPS)):
        # Of a film that may re-form, with a cavity or without.
        first, second = (
            replace(equations, operators=Operators(state.mesh, with_ending_of(state, model))) for model in (below, above)
        )
        before, after = (measured(each, each.fields(y), load) for each in (first, second))
        for each, value in after.items():
            found[k, ROW[each]] = float(value[0] - before[each][0]) / width
        moves[k] = units * inverse((second.residual(y) - first.residual(y)) / width)
    found += changes(equations, y, load, moves)
    return dict(zip(ALL_NAMES, found.T, strict=True))


def with_ending_of(state: State, model: Model) -> Model:
    """Return a model with the cavitation of a state."""
    cavitation = state.groups.model.cavitation
    if model.cavitation is cavitation:
        return model
    return replace(model, cavitation=cavitation, cavity_pressure=0.0)


def _by(value: Any, name: str) -> float:
    """Return the derivative of a number by the logarithm of a group."""
    return float(np.sum(value.columns.get(name, 0.0))) if isinstance(value, Trace) else 0.0


def friction_slopes(
    state: State, boundary_friction: float, beta: float, definition: str, changes: Sequence[Change] = ()
) -> Array:
    """Return the derivatives of friction by ln(speed), ln(load), ln(roughness), and along the changes of the model."""
    derivatives = log_derivatives(state, changes)
    return np.asarray(boundary_friction * derivatives["contact_load_share"] + beta * derivatives[f"viscous_{definition}"])
