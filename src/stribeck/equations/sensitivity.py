r"""Derivatives of the observables with respect to the groups, by implicit differentiation of the equations.

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
from stribeck.equations.line import Equations
from stribeck.equations.observables import ROW, changes, measured
from stribeck.equations.operators import Operators
from stribeck.equations.state import State
from stribeck.numerics.trace import Trace

GROUPS = ("speed", "load", "roughness")
DIFFERENTIATED = ("contact_load_share", "viscous_published", "viscous_balanced")

Change = tuple[Model, Model, float]
"""Two models, and the distance of the values that give them."""


def log_derivatives(state: State, beside: Sequence[Change] = ()) -> dict[str, Array]:
    """Return the derivatives of contact share and both viscous frictions with respect to ln(group)."""
    equations, y, load = state.equations, state.y, float(state.groups.load)
    inverse, units = equations.inverse(y), equations.units(y)
    direct, moves = np.zeros((len(GROUPS) + len(beside), len(DIFFERENTIATED))), np.zeros((len(GROUPS) + len(beside), y.size))
    for k, name in enumerate(GROUPS):
        if float(getattr(state.groups, name)) > 0:
            at_fixed = measured(equations, equations.fields(y), load, name)
            direct[k] = [_by(at_fixed[each], name) for each in DIFFERENTIATED]
            moves[k] = units * inverse(equations.parameter_derivative(y, name))
    for k, (below, above, width) in enumerate(beside, len(GROUPS)):
        first, second = (replace(equations, operators=Operators(state.mesh, model)) for model in (below, above))
        direct[k] = (_values(second, y, load) - _values(first, y, load)) / width
        moves[k] = units * inverse((second.residual(y) - first.residual(y)) / width)
    found = direct + changes(equations, y, load, moves)[:, [ROW[name] for name in DIFFERENTIATED]]
    return dict(zip(DIFFERENTIATED, found.T, strict=True))


def _by(value: Any, name: str) -> float:
    """Return the derivative of a number by the logarithm of a group."""
    return float(np.sum(value.columns.get(name, 0.0))) if isinstance(value, Trace) else 0.0


def _values(equations: Equations, y: Array, load: float) -> Array:
    """Return the observables that are differentiated."""
    found = measured(equations, equations.fields(y), load)
    return np.array([float(found[name][0]) for name in DIFFERENTIATED])


def friction_slopes(
    state: State, boundary_friction: float, beta: float, definition: str, changes: Sequence[Change] = ()
) -> Array:
    """Return the derivatives of friction by ln(speed), ln(load), ln(roughness), and along the changes of the model."""
    derivatives = log_derivatives(state, changes)
    return np.asarray(boundary_friction * derivatives["contact_load_share"] + beta * derivatives[f"viscous_{definition}"])
