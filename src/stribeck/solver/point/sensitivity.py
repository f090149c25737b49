r"""Derivatives of the observables of a solved ball with respect to its groups, and to numbers of its fluid and solid.

.. math:: \frac{dy}{d\ln G} = -J^{-1} \frac{\partial R}{\partial \ln G}

for each group G, or an input that changes numbers of fluid or solid, with the products of Newton's Jacobian at
the state and GMRES.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups, contact_law
from stribeck.equations.cavities.active_set import Capacitance
from stribeck.equations.cavities.system import CavitatedLinear
from stribeck.equations.point.observables import observables
from stribeck.equations.point.planes import plane_of
from stribeck.equations.point.preconditioner import BandedModes
from stribeck.equations.point.system import Equations, Linear, Operators, Unknowns
from stribeck.numerics.krylov import Apply, gmres
from stribeck.numerics.settings import COARSE_RTOL, EPSILON, HALF_DIGITS, LOG_STEP, MAX_BAND, MAX_STEPS, NEGLIGIBLE
from stribeck.quantities.outputs import GROUPS
from stribeck.solver.point.estimate import Pair
from stribeck.solver.point.state import PointState

Direction = tuple[Groups, Groups, float]
"""Groups, with their model, behind and ahead of a state along a logarithm, and the distance of both."""

Measure = Callable[[Equations, Unknowns], Mapping[str, float]]
"""Observables of a state by name."""


def state_derivatives(
    state: PointState, by: Sequence[str] = GROUPS, measure: Measure = observables, tolerance: float = EPSILON
) -> dict[str, Array]:
    """Return the derivatives of all observables with respect to ln(speed), ln(load) and ln(roughness)."""
    groups = state.groups
    alive = {name: _by_group(groups, name) for name in GROUPS if name in by and float(getattr(groups, name)) > 0}
    if not alive:
        fine = state.work.fine
        return {name: np.zeros(len(GROUPS)) for name in measure(fine.equations, fine.unknowns)}
    found = derivatives_along(state, alive, measure, tolerance)
    zero = np.array([name not in alive for name in GROUPS])
    columns = np.cumsum(~zero) - 1
    return {name: np.where(zero, 0.0, column[columns]) for name, column in found.items()}


def _by_group(groups: Groups, name: str) -> Direction:
    """Return the direction of a group."""
    here = float(getattr(groups, name))
    behind, ahead = (replace(groups, **{name: here * math.exp(step)}) for step in (-LOG_STEP, LOG_STEP))  # type: ignore[arg-type]
    return behind, ahead, 2 * LOG_STEP


def derivatives_along(
    state: PointState, directions: Mapping[str, Direction], measure: Measure = observables, tolerance: float = EPSILON
) -> dict[str, Array]:
    """Return the derivatives of all observables along directions, to a relative tolerance."""
    changes = changes_along(state, directions, tolerance)
    columns = [measured_change(state, directions[name], change, measure) for name, change in changes.items()]
    return {name: np.array([column[name] for column in columns]) for name in columns[0]}


def changes_along(state: PointState, directions: Mapping[str, Direction], tolerance: float) -> dict[str, Unknowns]:
    """Return the derivatives of the unknowns along directions, to a relative tolerance."""
    pair = state.work
    assert isinstance(pair, Pair)
    equations, y, kept = pair.fine.equations, pair.fine.unknowns, pair.fine.iterated.preconditioner
    linear = equations.linear(y)
    precondition = _preconditioner(linear, kept)
    found: dict[str, Unknowns] = {}
    for name, (*ends, width) in directions.items():
        near = [_beside(equations, each) for each in ends]
        behind, ahead = (each.residual(y) for each in near)
        shape, flow = ((a - b) / width for a, b in zip(ahead[:2], behind[:2], strict=True))
        change = (np.asarray(shape), np.asarray(flow), (ahead[2] - behind[2]) / width)
        suction_change = (near[1].least - near[0].least) / width if math.isfinite(equations.least) else 0.0
        right = linear.sources(change, suction_change)
        x = _solved(linear, precondition, right, tolerance)
        if x is None and kept is not None:
            precondition, kept = _preconditioner(linear, None), None
            x = _solved(linear, precondition, right, tolerance)
        if x is None:
            raise ArithmeticError(f"GMRES did not solve for the derivatives by {name}")
        found[name] = linear.changes(x, change[0])
    return found


def measured_change(
    state: PointState, direction: Direction, change: Unknowns, measure: Measure = observables
) -> dict[str, float]:
    """Return the derivatives of all observables along a direction, from those of the unknowns."""
    equations, y, (*ends, width) = state.work.fine.equations, state.work.fine.unknowns, direction
    size = LOG_STEP / max(1.0, float(np.abs(change.gap / y.gap).max()))
    at_ends = [(each, y) for each in (_beside(equations, end) for end in ends)]
    moved = [(equations, y.moved(change, step)) for step in (-size, size)]
    values = [measure(each, each.with_same_active_set(there, y)) for each, there in (*at_ends, *moved)]
    before, after, less, more = (np.array([*each.values()]) for each in values)
    return dict(zip(values[0], ((after - before) / width + (more - less) / (2 * size)).tolist(), strict=True))


def _preconditioner(linear: Linear, kept: Any) -> Apply:
    """Return the preconditioner that Newton's iteration kept, or that of this Jacobian."""
    if not isinstance(linear, CavitatedLinear):
        return BandedModes(linear, MAX_BAND) if kept is None else kept
    if kept is None:
        kept = Capacitance(BandedModes(linear, MAX_BAND), linear.equations.operators.mesh, linear.cavitated.shape)
    return kept.of(linear)  # type: ignore[no-any-return]


def _solved(linear: Linear, preconditioner: Apply, right: Array, tolerance: float) -> Array | None:
    """Return the solution of the linear system to a preconditioned residual, or None where GMRES does not reach it."""
    x, rest, left = np.zeros_like(right), right, 1.0
    while True:
        # The preconditioner is in single precision: the next round removes its error.
        here = max(NEGLIGIBLE * COARSE_RTOL, tolerance / left)
        found = gmres(linear.product, preconditioner, rest, here, MAX_STEPS)
        if not found.left <= here / NEGLIGIBLE:
            return None
        x, left = x + found.x, left * here
        if left <= tolerance * (1.0 + HALF_DIGITS):
            return x
        rest = right - linear.product(x)


def _beside(equations: Equations, here: Groups) -> Equations:
    """Return the equations of other groups on the same mesh."""
    speed, solid, operators = float(here.speed), here.model.solid, equations.operators
    if solid != operators.solid:
        operators = Operators(operators.mesh, solid)
    least = here.model.cavity_pressure if math.isfinite(equations.least) else equations.least
    film = plane_of(here.model.film.at(speed))
    if film == equations.film and speed == equations.speed:
        film = equations.film  # which keeps its last local solutions
    return replace(equations, operators=operators, speed=speed, law=contact_law(here), film=film, least=least)
