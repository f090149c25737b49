r"""Derivatives of the observables with respect to the groups, by implicit differentiation of the equations.

.. math:: \frac{dy}{d\ln G} = -J^{-1} \frac{\partial R}{\partial \ln G}

for each group G, with the factors of Newton's Jacobian made anew at the state.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import contact_law
from stribeck.equations.line import LOAD, Equations
from stribeck.equations.observables import friction_integrals, friction_scale, observables
from stribeck.equations.state import State

GROUPS = ("speed", "load", "roughness")
FRICTIONS = ("viscous_published", "viscous_balanced")

STEP = 1e-5
"""Relative step of the central differences that carry the change of the unknowns to the friction integrals."""


def log_derivatives(state: State) -> dict[str, Array]:
    """Return the derivatives of contact share and both viscous frictions with respect to ln(group).

    Parameters
    ----------
    state : State
        A converged state with positive speed.

    Returns
    -------
    dict of str to ndarray, shape (3,)
        Those of ``contact_load_share`` and of the two viscous frictions for beta = 1, by name, with respect to speed, load and
        roughness, the other two groups held.

    Notes
    -----
    Relative error about 1e-8 beyond that of the state (``test_sensitivity.py``).
    """
    if not state.equations.operators.is_article:
        return _of_any_film(state)
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


def _of_any_film(state: State) -> dict[str, Array]:
    """Return the same for a film that is not that of the article, by differences along the change of the whole state."""
    equations, y, groups = state.equations, state.y, state.groups
    inverse, units = equations.inverse(y), equations.units(y)
    names = ("contact_load_share", *FRICTIONS)
    found = np.empty((len(names), len(GROUPS)))
    for column, name in enumerate(GROUPS):
        if float(getattr(groups, name)) == 0.0:
            found[:, column] = 0.0
            continue
        dy = units * inverse(equations.parameter_derivative(y, name))
        size = STEP / max(1.0, float(np.abs(dy / units).max()))
        values = []
        for sign in (1.0, -1.0):
            factor = math.exp(sign * size)
            # The relative roughness is the ratio of roughness and load: each group is changed with the others held.
            here = replace(groups, **{name: float(getattr(groups, name)) * factor})  # type: ignore[arg-type]
            beside = Equations(equations.operators, float(here.speed), contact_law(here), equations.flux_scale)
            observed = observables(beside, y + sign * size * dy, float(here.load))
            values.append([getattr(observed, each) for each in names])
        found[:, column] = (np.array(values[0]) - np.array(values[1])) / (2 * size)
    return dict(zip(names, found, strict=True))


def friction_slopes(state: State, boundary_friction: float, beta: float, definition: str) -> Array:
    """Return the derivatives of the friction coefficient with respect to ln(speed), ln(load), ln(roughness)."""
    derivatives = log_derivatives(state)
    return np.asarray(boundary_friction * derivatives["contact_load_share"] + beta * derivatives[f"viscous_{definition}"])
