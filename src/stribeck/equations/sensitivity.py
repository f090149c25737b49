r"""Derivatives of the observables with respect to the groups and the model, by implicit differentiation of the equations.

.. math:: \frac{dy}{d\ln G} = -J^{-1} \frac{\partial R}{\partial \ln G}

for each group G, with the factors of Newton's Jacobian made anew at the state.  The friction of all films is that of
:mod:`stribeck.equations.drag`: in thin films the closed form for the article's film errs with the moment of the pressure.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups, Model
from stribeck.equations.observables import ROW, area_derivatives, changes, measured
from stribeck.equations.operators import Operators
from stribeck.equations.state import State
from stribeck.numerics.settings import EPSILON
from stribeck.numerics.trace import Trace
from stribeck.quantities.outputs import ALL_NAMES, AREA

GROUPS = ("speed", "load", "roughness")

Change = tuple[Model, Model, float]
"""Two models, and the distance of the values that give them."""


def log_derivatives(state: State, beside: Sequence[Change] = ()) -> dict[str, Array]:
    """Return the derivatives of all observables with respect to ln(group), and along changes of the model.

    Among them is the real area of contact, where the law knows it.
    """
    found, forces = _partials(state, np.eye(len(GROUPS)), beside)
    moves = _moves(state, forces)
    found += _changes(state, moves)
    return dict(zip((*ALL_NAMES, AREA), (*found.T, area_derivatives(state, moves)), strict=True))


def derivatives_along(state: State, groups_at: Callable[[float], Groups], s: float) -> tuple[Array, Array]:
    """Return the derivatives of all observables, and of the unknowns, along a path of groups, with its model."""
    step = EPSILON ** (1 / 3)  # where truncation and rounding of a central difference are alike
    below, above = groups_at(s - step), groups_at(s + step)
    ends = np.array([[float(getattr(groups, name)) for name in GROUPS] for groups in (below, above)])
    direction = np.zeros(len(GROUPS))
    direction[(ends > 0).all(axis=0)] = np.diff(np.log(ends[:, (ends > 0).all(axis=0)]), axis=0)[0] / (2 * step)
    beside = [] if below.model == above.model else [(below.model, above.model, 2 * step)]
    found, forces = _partials(state, direction[None], beside)
    move = _moves(state, forces.sum(axis=0))
    return found.sum(axis=0) + _changes(state, move), move


def _changes(state: State, moves: Array) -> Array:
    """Return the changes of the observables with those of the unknowns."""
    return changes(state.equations, state.y, float(state.groups.load), state.minimum_position, moves)


def _moves(state: State, forces: Array) -> Array:
    """Return the changes of the unknowns under changes of the residual."""
    inverse, units = state.equations.inverse(state.y), state.equations.units(state.y)
    return np.stack([units * inverse(each) for each in np.atleast_2d(forces)]).reshape(forces.shape)


def _partials(state: State, directions: Array, beside: Sequence[Change]) -> tuple[Array, Array]:
    """Return the derivatives of the observables and of the residual at fixed unknowns, along directions of ln(groups)."""
    equations, y, load = state.equations, state.y, float(state.groups.load)
    count = len(directions) + len(beside)
    found, forces = np.zeros((count, len(ALL_NAMES))), np.zeros((count, y.size))
    for rates, name in zip(directions.T, GROUPS, strict=True):
        if float(getattr(state.groups, name)) > 0 and rates.any():
            by_group = np.zeros(len(ALL_NAMES))
            for each, value in measured(equations, equations.fields(y), load, name).items():
                by_group[ROW[each]] = _by(value, name)
            found[: len(directions)] += rates[:, None] * by_group
            forces[: len(directions)] += rates[:, None] * equations.parameter_derivative(y, name)
    for k, (below, above, width) in enumerate(beside, len(directions)):
        # Of a film that may re-form, with a cavity or without.
        first, second = (
            replace(equations, operators=Operators(state.mesh, with_ending_of(state, model))) for model in (below, above)
        )
        before, after = (measured(each, each.fields(y), load) for each in (first, second))
        for each, value in after.items():
            found[k, ROW[each]] = float(value[0] - before[each][0]) / width
        forces[k] = (second.residual(y) - first.residual(y)) / width
    return found, forces


def with_ending_of(state: State, model: Model) -> Model:
    """Return a model with the cavitation of a state."""
    cavitation = state.groups.model.cavitation
    if model.cavitation is cavitation:
        return model
    return replace(model, cavitation=cavitation, cavity_pressure=0.0)


def _by(value: Any, name: str) -> float:
    """Return the derivative of a number by the logarithm of a group."""
    return float(np.sum(value.columns.get(name, 0.0))) if isinstance(value, Trace) else 0.0
