r"""Derivatives of the observables of a ball with respect to groups and inputs, by implicit differentiation of its equations.

.. math:: \frac{dy}{d\ln G} = -J^{-1} \frac{\partial R}{\partial \ln G}

for each group G, or an input that changes numbers of fluid or solid, with the products of Newton's Jacobian at
the state and GMRES.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups, contact_law
from stribeck.equations.point.observables import observables
from stribeck.equations.point.planes import plane_of
from stribeck.equations.point.system import Equations, Linear, Operators, Unknowns
from stribeck.numerics.krylov import Apply, gmres
from stribeck.numerics.settings import EPSILON, HALF_DIGITS, MAX_KRYLOV, NEGLIGIBLE

__all__ = ["LOG_STEP", "Direction", "Measure", "beside", "log_derivatives", "solved"]

Direction = Callable[[float], Groups]
"""Groups, with their model, after a step of the logarithm of a group or an input."""

Measure = Callable[[Equations, Unknowns], Mapping[str, float]]
"""Observables of a state by name."""

LOG_STEP = HALF_DIGITS**0.5  # Step of a logarithm in central differences, whose error is its square


def log_derivatives(
    equations: Equations,
    y: Unknowns,
    directions: Mapping[str, Direction],
    preconditioner: Callable[[Linear, Any], Apply],
    kept: Any = None,
    measure: Measure = observables,
    tolerance: float = EPSILON,
) -> dict[str, Array]:
    """Return the derivatives of all observables along directions."""
    linear = equations.linear(y)
    precondition = preconditioner(linear, kept)
    columns: dict[str, list[float]] = {}
    for name, moved in directions.items():
        near = [beside(equations, moved(sign * LOG_STEP)) for sign in (1.0, -1.0)]
        ahead, behind = (each.residual(y) for each in near)
        shape, flow = ((a - b) / (2 * LOG_STEP) for a, b in zip(ahead[:2], behind[:2], strict=True))
        change = (np.asarray(shape), np.asarray(flow), (ahead[2] - behind[2]) / (2 * LOG_STEP))
        suction_change = (near[0].least - near[1].least) / (2 * LOG_STEP) if math.isfinite(equations.least) else 0.0
        right = linear.sources(change, suction_change)
        x = solved(linear, precondition, right, tolerance)
        if x is None and kept is not None:
            precondition, kept = preconditioner(linear, None), None
            x = solved(linear, precondition, right, tolerance)
        if x is None:
            raise ArithmeticError(f"GMRES did not solve for the derivatives by {name}")
        dy = linear.changes(x, change[0])
        size = LOG_STEP / max(1.0, float(np.abs(dy.gap / y.gap).max()))
        at = [beside(equations, moved(sign * size)) for sign in (1.0, -1.0)]
        values = [
            measure(each, each.with_same_active_set(y.moved(dy, sign * size), y))
            for each, sign in zip(at, (1.0, -1.0), strict=True)
        ]
        for each in values[0]:
            columns.setdefault(each, []).append((values[0][each] - values[1][each]) / (2 * size))
    return {name: np.array(column) for name, column in columns.items()}


def solved(linear: Linear, preconditioner: Apply, right: Array, tolerance: float = EPSILON) -> Array | None:
    """Return the solution of the linear system to a preconditioned residual, or None where GMRES does not reach it."""
    x, rest, left = np.zeros_like(right), right, 1.0
    while True:
        here = max(LOG_STEP, tolerance / left)  # the preconditioner is in single precision: the next round removes its error
        found = gmres(linear.product, preconditioner, rest, here, MAX_KRYLOV)
        if not found.left <= here / NEGLIGIBLE:
            return None
        x, left = x + found.x, left * here
        if left <= tolerance * (1.0 + HALF_DIGITS):
            return x
        rest = right - linear.product(x)


def beside(equations: Equations, here: Groups) -> Equations:
    """Return the equations of other groups on the same mesh."""
    speed, solid, operators = float(here.speed), here.model.solid, equations.operators
    if solid != operators.solid:
        operators = Operators(operators.mesh, solid)
    least = here.model.cavity_pressure if math.isfinite(equations.least) else equations.least
    film = plane_of(here.model.film.at(speed))
    if film == equations.film and speed == equations.speed:
        film = equations.film  # which keeps its last local solutions
    return replace(equations, operators=operators, speed=speed, law=contact_law(here), film=film, least=least)
