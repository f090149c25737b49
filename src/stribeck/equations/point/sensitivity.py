r"""Derivatives of the observables of a ball with respect to the groups, by implicit differentiation of its equations.

.. math:: \frac{dy}{d\ln G} = -J^{-1} \frac{\partial R}{\partial \ln G}

for each group G, with the products of Newton's Jacobian at the state and GMRES.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups, contact_law
from stribeck.equations.point.observables import observables
from stribeck.equations.point.preconditioner import BandedModes
from stribeck.equations.point.system import Equations, Linear, Unknowns
from stribeck.numerics.krylov import gmres

__all__ = ["GROUPS", "log_derivatives"]

GROUPS = ("speed", "load", "roughness")

STEP = 1e-4
"""Step of the logarithm of a group in the central differences of the residual, whose error is its square."""

CHANGE = 1e-4
"""Largest relative change of the gap in those of the observables along the change of the unknowns."""

TOLERANCE, MOST, ROUNDS = 1e-6, 90, 3
"""Preconditioned residual that GMRES leaves in each round, its products, and rounds: the preconditioner is in single
precision, and what it hides of the first residual the next round takes away."""


def log_derivatives(
    equations: Equations, y: Unknowns, groups: Groups, band: int, kept: BandedModes | None = None
) -> dict[str, Array]:
    """Return the derivatives of all observables with respect to ln(speed), ln(load) and ln(roughness).

    Parameters
    ----------
    equations : Equations
        The discretised problem of the state.
    y : Unknowns
        Its solution.
    groups : Groups
        Its groups, of positive speed.
    band : int
        Band of a preconditioner that is made.
    kept : BandedModes, optional
        That of the last Newton step.

    Returns
    -------
    dict of str to ndarray, shape (3,)
        By the names of the observables, the other two groups held; zero with respect to a group that is zero.

    Notes
    -----
    They are those of the discrete equations, within 1e-6 of the largest (``test_point_sensitivity.py``).
    """
    linear = Linear(equations, y)
    preconditioner = BandedModes(linear, band) if kept is None else kept
    columns: dict[str, list[float]] = {}
    for name in GROUPS:
        if float(getattr(groups, name)) == 0:
            for each in observables(equations, y):
                columns.setdefault(each, []).append(0.0)
            continue
        ahead, behind = (_beside(equations, groups, name, sign * STEP).residual(y) for sign in (1.0, -1.0))
        shape, flow = ((a - b) / (2 * STEP) for a, b in zip(ahead[:2], behind[:2], strict=True))
        change = (np.asarray(shape), np.asarray(flow), (ahead[2] - behind[2]) / (2 * STEP))
        right = linear.right(change)
        x = _solved(linear, preconditioner, right)
        if x is None and kept is not None:
            preconditioner, kept = BandedModes(linear, band), None
            x = _solved(linear, preconditioner, right)
        if x is None:
            raise ArithmeticError(f"GMRES did not solve for the derivatives by {name}")
        dy = linear.changes(x, change[0])
        size = CHANGE / max(1.0, float(np.abs(dy.gap / y.gap).max()))
        values = [observables(_beside(equations, groups, name, sign * size), y.moved(dy, sign * size)) for sign in (1.0, -1.0)]
        for each in values[0]:
            columns.setdefault(each, []).append((values[0][each] - values[1][each]) / (2 * size))
    return {name: np.array(column) for name, column in columns.items()}


def _solved(linear: Linear, preconditioner: BandedModes, right: Array) -> Array | None:
    """Return the solution of the linear system, or None where GMRES does not reach it."""
    x, rest = np.zeros_like(right), right
    for _ in range(ROUNDS):
        found = gmres(linear.product, preconditioner, rest, TOLERANCE, MOST)
        if not found.left <= 100 * TOLERANCE:
            return None
        x = x + found.x
        rest = right - linear.product(x)
    return x


def _beside(equations: Equations, groups: Groups, name: str, step: float) -> Equations:
    """Return the equations on the same mesh with a step of the logarithm of one group."""
    here = replace(groups, **{name: float(getattr(groups, name)) * math.exp(step)})  # type: ignore[arg-type]
    return replace(equations, speed=float(here.speed), law=contact_law(here))
