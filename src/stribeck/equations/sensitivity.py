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
from stribeck.contacts.groups import contact_law
from stribeck.contacts.model import Model
from stribeck.equations.drag import Nodal, drag_gradients, viscous_friction
from stribeck.equations.line import LOAD, Equations
from stribeck.equations.observables import ROW, gradients
from stribeck.equations.operators import Operators
from stribeck.equations.state import State

GROUPS = ("speed", "load", "roughness")
FRICTIONS = ("viscous_published", "viscous_balanced")

LOG_STEP = 1e-5  # Relative step of the central differences for the direct effect of a group


Change = tuple[Model, Model, float]
"""Two models, and the distance of the values that give them."""


def log_derivatives(state: State, changes: Sequence[Change] = ()) -> dict[str, Array]:
    """Return the derivatives of contact share and both viscous frictions with respect to ln(group)."""
    equations, y, load = state.equations, state.y, float(state.groups.load)
    inverse, units = equations.inverse(y), equations.units(y)
    names = ("contact_load_share", *FRICTIONS)
    contact = gradients(equations, y, load)[ROW["contact_load_share"]]
    through = np.stack([contact, *drag_gradients(equations, y, load, None)[: len(FRICTIONS)]])
    found = np.zeros((len(names), len(GROUPS) + len(changes)))
    for column, name in enumerate(GROUPS):
        if float(getattr(state.groups, name)) > 0:
            found[:, column] = through @ (units * inverse(equations.parameter_derivative(y, name)))
    found[:, : len(GROUPS)] += _direct(state)
    for column, (below, above, width) in enumerate(changes, len(GROUPS)):
        first, second = (replace(equations, operators=Operators(state.mesh, model)) for model in (below, above))
        dy = units * inverse((second.residual(y) - first.residual(y)) / width)
        found[:, column] = through @ dy + (_values(second, y[None], load) - _values(first, y[None], load))[0] / width
    return dict(zip(names, found, strict=True))


def _direct(state: State) -> Array:
    """Return the derivatives of observables with respect to the logarithms of the groups, at fixed unknowns."""
    steps = np.eye(len(GROUPS))
    logs = LOG_STEP * np.concatenate([0.0 * steps[:1], -steps, steps])
    moved: dict[str, Any] = {name: getattr(state.groups, name) * np.exp(logs[:, [k]]) for k, name in enumerate(GROUPS)}
    groups, load = replace(state.groups, **moved), float(state.groups.load)
    equations = replace(state.equations, speed=groups.speed, law=contact_law(groups))
    values = _values(equations, np.tile(state.y, (len(logs), 1)), load)
    behind, ahead = np.split(values[1:], 2)
    found = (ahead - behind).T / (2 * LOG_STEP)
    found[1:, GROUPS.index("load")] += 0.5 * values[0, 1:]  # friction goes with the root of the load
    return np.asarray(found)


def _values(equations: Equations, y: Array, load: float) -> Array:
    """Return the load share of asperities and both viscous frictions of stacked states, shape (rows, 3)."""
    op, d, gap = equations.operators, equations.cavity_stretch(y), y[:, equations.layout.gap]
    contact, fluid = equations.pressures(y)
    share = contact @ op.mesh.weights / LOAD * (1.0 if d is None else d[:, 0])
    friction = viscous_friction(equations, y, load, Nodal(op.integral, gap, fluid, op.weights))
    return np.stack([share, *friction[: len(FRICTIONS)]], axis=1)


def friction_slopes(
    state: State, boundary_friction: float, beta: float, definition: str, changes: Sequence[Change] = ()
) -> Array:
    """Return the derivatives of friction by ln(speed), ln(load), ln(roughness), and along the changes of the model."""
    derivatives = log_derivatives(state, changes)
    return np.asarray(boundary_friction * derivatives["contact_load_share"] + beta * derivatives[f"viscous_{definition}"])
