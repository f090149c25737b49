r"""Derivatives of the observables with respect to the groups, by implicit differentiation of the equations.

.. math:: \frac{dy}{d\ln G} = -J^{-1} \frac{\partial R}{\partial \ln G}

for each group G, with the factors of Newton's Jacobian made anew at the state.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import contact_law
from stribeck.contacts.model import Model
from stribeck.equations.line import LOAD, Equations
from stribeck.equations.observables import ROW, friction_integrals, friction_scale, gradients, observables
from stribeck.equations.operators import Operators
from stribeck.equations.state import State

GROUPS = ("speed", "load", "roughness")
FRICTIONS = ("viscous_published", "viscous_balanced")

STEP = 1e-5
"""Relative step of the central differences that carry the change of the unknowns to the friction integrals."""


Change = tuple[Model, Model, float]
"""Two models, and the distance of the values that give them."""


def log_derivatives(state: State, changes: Sequence[Change] = ()) -> dict[str, Array]:
    """Return the derivatives of contact share and both viscous frictions with respect to ln(group).

    Parameters
    ----------
    state : State
        A converged state with positive speed.
    changes : sequence of tuple
        Models below and above that of the state, and their distance.

    Returns
    -------
    dict of str to ndarray, shape (3 + changes,)
        Those of ``contact_load_share`` and of the two viscous frictions for beta = 1, by name, with respect to speed, load and
        roughness, the other two groups held, and along the changes of the model.

    Notes
    -----
    Those of the friction are the differences of solved states within 1e-6 (``test_regimes.py``).
    """
    if changes or not state.equations.operators.is_article:
        return _of_any_film(state, changes)
    equations, y = state.equations, state.y
    mesh, law, load = state.mesh, equations.law, float(state.groups.load)
    at = equations.layout
    h, h_star = y[at.gap], state.flux_gap
    scale = friction_scale(load, equations.speed)
    inverse, units = equations.inverse(y), equations.units(y)
    pressure = law.pressure(h)
    slope = law.slope(h, pressure)
    found = observables(equations, y, load)
    viscous = np.array([getattr(found, name) for name in FRICTIONS])
    direct = {"speed": 1.0, "load": 0.5, "roughness": 0.0}
    share, frictions = np.empty(len(GROUPS)), np.empty((len(FRICTIONS), len(GROUPS)))
    for column, name in enumerate(GROUPS):
        dy = units * inverse(equations.parameter_derivative(y, name))
        dh, dm = dy[at.gap], float(dy[at.flux_gap.start])
        change = slope * dh
        if name == "load":
            change = change + law.load_derivative(h, pressure)
        elif name == "roughness":
            change = change + law.roughness_derivative(h, pressure)
        share[column] = mesh.weights @ change / LOAD
        size = STEP / max(1e-300, float(np.abs(dh / h).max()))
        ahead = friction_integrals(mesh, h + size * dh, h_star + size * dm)
        behind = friction_integrals(mesh, h - size * dh, h_star - size * dm)
        frictions[:, column] = scale * (ahead - behind) / (2 * size) + direct[name] * viscous
    return {"contact_load_share": share} | dict(zip(FRICTIONS, frictions, strict=True))


def _of_any_film(state: State, changes: Sequence[Change] = ()) -> dict[str, Array]:
    """Return the same for a film other than the article's.

    The direct effect of a group or the model, at fixed unknowns, is a difference; the rest comes through the unknowns.
    """
    equations, y, load = state.equations, state.y, float(state.groups.load)
    inverse, units = equations.inverse(y), equations.units(y)
    names = ("contact_load_share", *FRICTIONS)
    through = gradients(equations, y, load)[[ROW[name] for name in names]]
    found = np.zeros((len(names), len(GROUPS) + len(changes)))
    for column, name in enumerate(GROUPS):
        if float(getattr(state.groups, name)) > 0:
            found[:, column] = through @ (units * inverse(equations.parameter_derivative(y, name)))
    for column, name in enumerate(GROUPS):
        found[:, column] += _direct(state, name, names)
    for column, (below, above, width) in enumerate(changes, len(GROUPS)):
        first, second = (replace(equations, operators=Operators(state.mesh, model)) for model in (below, above))
        dy = units * inverse((second.residual(y) - first.residual(y)) / width)
        found[:, column] = through @ dy + _difference(first, second, y, load, names) / width
    return dict(zip(names, found, strict=True))


def _direct(state: State, name: str, names: Sequence[str]) -> Array:
    """Return the derivatives of observables with respect to the logarithm of a group, at fixed unknowns."""
    value, found = float(getattr(state.groups, name)), []
    for step in (-STEP, STEP):
        changed: dict[str, Any] = {name: value * math.exp(step)}
        groups = replace(state.groups, **changed)
        equations = replace(state.equations, speed=float(groups.speed), law=contact_law(groups))
        seen = observables(equations, state.y, float(groups.load))
        found.append(np.array([getattr(seen, each) for each in names]))
    return np.asarray((found[1] - found[0]) / (2 * STEP))


def _difference(below: Equations, above: Equations, y: Array, load: float, names: Sequence[str]) -> Array:
    """Return the difference of observables of the same unknowns under two equations."""
    first, second = (observables(each, y, load) for each in (below, above))
    return np.array([getattr(second, name) - getattr(first, name) for name in names])


def friction_slopes(
    state: State, boundary_friction: float, beta: float, definition: str, changes: Sequence[Change] = ()
) -> Array:
    """Return the derivatives of the friction coefficient with respect to ln(speed), ln(load), ln(roughness).

    Those along changes of the model, as :func:`log_derivatives` takes them, follow.
    """
    derivatives = log_derivatives(state, changes)
    return np.asarray(boundary_friction * derivatives["contact_load_share"] + beta * derivatives[f"viscous_{definition}"])
