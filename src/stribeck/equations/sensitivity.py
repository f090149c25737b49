r"""Derivatives of the observables with respect to the groups, by implicit differentiation of the equations.

.. math:: \frac{dy}{d\ln G} = -J^{-1} \frac{\partial R}{\partial \ln G}

for each group G, with the factors of Newton's Jacobian made anew at the state.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from stribeck._types import Array
from stribeck.equations.line import LOAD
from stribeck.equations.observables import NAMES, friction_integrals, friction_scale, observables
from stribeck.equations.state import State

GROUPS = ("speed", "load", "roughness")

STEP = 1e-5
"""Relative step of the central differences that carry the change of the unknowns to the friction integrals."""


def log_derivatives(state: State) -> Array:
    """Return the derivatives of contact share and both viscous frictions with respect to ln(group).

    Parameters
    ----------
    state : State
        A converged state with positive speed.

    Returns
    -------
    ndarray, shape (3, 3)
        Rows: contact load share, ``viscous_paper``, ``viscous_balanced`` for beta = 1; columns: speed, load, roughness,
        the other two groups held.

    Notes
    -----
    Relative error about 1e-8 beyond that of the state (``test_sensitivity.py``).
    """
    equations, y = state.equations, state.y
    mesh, law, load = state.mesh, equations.law, float(state.groups.load)
    h, h_star = y[:-2], float(y[-1])
    scale = friction_scale(load, equations.speed)
    factors = lu_factor(equations.jacobian(y), check_finite=False)
    pressure = law.pressure(h)
    slope = law.slope(h, pressure)
    found = observables(equations, y, load)
    viscous = np.array([found.viscous_paper, found.viscous_balanced])
    direct = {"speed": 1.0, "load": 0.5, "roughness": 0.0}
    result = np.empty((3, 3))
    for column, name in enumerate(GROUPS):
        dy = -lu_solve(factors, equations.parameter_derivative(y, name), check_finite=False)
        change = slope * dy[:-2]
        if name == "load":
            change = change + law.load_derivative(h, pressure)
        elif name == "roughness":
            change = change + law.roughness_derivative(h, pressure)
        result[0, column] = mesh.weights @ change / LOAD
        size = STEP / max(1e-300, float(np.abs(dy[:-2] / h).max()))
        ahead = friction_integrals(mesh, h + size * dy[:-2], h_star + size * float(dy[-1]))
        behind = friction_integrals(mesh, h - size * dy[:-2], h_star - size * float(dy[-1]))
        result[1:, column] = scale * (ahead - behind) / (2 * size) + direct[name] * viscous
    return result


def friction_slopes(state: State, mu0: float, beta: float, definition: str) -> Array:
    """Return the derivatives of the friction coefficient with respect to ln(speed), ln(load), ln(roughness)."""
    derivatives = log_derivatives(state)
    row = NAMES.index(f"viscous_{definition}") - NAMES.index("viscous_paper") + 1
    return np.asarray(mu0 * derivatives[0] + beta * derivatives[row])
