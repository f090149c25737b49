r"""Taylor series of a state of a ball, and of its observables, in the logarithm of the quantity that varies.

Unknowns are the logarithm of the gap and the film pressure at the nodes, and the offset.  The local parts, contact pressure
and flow, are sampled along the path; the rest is linear.  For each order :math:`J w_k = -R_k|_{w_k = 0}` is solved by GMRES
with the Jacobian and the preconditioner of the state, see :func:`stribeck.numerics.series.implicit_series`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups
from stribeck.equations.point.observables import SMOOTH, smooth_observables
from stribeck.equations.point.preconditioner import BandedModes
from stribeck.equations.point.sensitivity import beside, solved
from stribeck.equations.point.system import Equations, Linear, Unknowns
from stribeck.numerics.series import implicit_series, interval

__all__ = ["Expanded", "as_row", "corrected_once", "expand", "from_row"]

SAMPLE_COUNT = 20  # Places at which the equations are evaluated

ORDER_RATIO = 0.4  # Weight of an order between states over that of the order before: states lie near the radius of convergence

MAX_GMRES_RTOL = 1e-4  # Largest relative residual that GMRES may leave in an order

SHARE_COLUMN = SMOOTH.index("contact_load_share")


class Expanded(NamedTuple):
    """Taylor coefficients about a state, order by order in the first axis."""

    unknowns: Array  # Logarithm of the gap, film pressure, offset
    observables: Array  # By :data:`SMOOTH`
    log_share: Array  # Of the logarithm of the share of asperities; nan where they carry nothing


def as_row(y: Unknowns) -> Array:
    """Return unknowns as one row, with the logarithm of the gap."""
    return np.concatenate([np.log(y.gap).ravel(), y.fluid.ravel(), [y.offset]])


def from_row(w: Array, shape: tuple[int, ...]) -> Unknowns:
    """Return the unknowns of a row, fields of shape (modes, rings)."""
    nodes = w.size // 2
    return Unknowns(np.exp(w[:nodes].reshape(shape)), w[nodes:-1].reshape(shape), float(w[-1]))


def expand(
    equations: Equations,
    y: Unknowns,
    preconditioner: BandedModes,
    groups_at: Callable[[float], Groups],
    order: int,
    reach: float,
    tolerance: float,
) -> Expanded | None:
    """Return the series of a state whose film does not break."""
    op, mesh, shape = equations.operators, equations.operators.mesh, y.gap.shape
    samples, linear = interval(reach, SAMPLE_COUNT), Linear(equations, y)
    around = [beside(equations, groups_at(t)) for t in samples.places.tolist()]
    powers, nodes = samples.powers(order), y.gap.size

    unknowns = np.zeros((order + 1, 2 * nodes + 1))
    unknowns[0] = as_row(y)

    def coefficient(k: int) -> Array:
        found = np.empty((len(around), 3 * nodes))
        for one, row, values in zip(around, powers[:, :k] @ unknowns[:k], found, strict=True):
            at = from_row(row, shape)
            values[:nodes], values[nodes : 2 * nodes] = at.gap.ravel(), one.law.pressure(at.gap).ravel()
            values[2 * nodes :] = one.flow(at.gap, at.fluid, at.offset).ravel()
        gap, contact, flow = (samples.weights[k] @ found).reshape(3, *shape)
        by_mode = mesh.to_modes @ contact
        gap = gap - mesh.cosines @ equations.deflect(by_mode)
        return np.concatenate([gap.ravel(), flow.ravel(), [float(op.load_row @ by_mode[0])]])

    found_orders = 0

    def inverse(r: Array) -> Array:
        nonlocal found_orders
        bent = r[:nodes].reshape(shape)
        right = linear.right((bent, r[nodes:-1].reshape(shape), float(r[-1])))
        x = solved(linear, preconditioner, right, min(MAX_GMRES_RTOL, tolerance * ORDER_RATIO**-found_orders))
        found_orders += 1
        if x is None:
            raise ArithmeticError
        change = linear.changes(x, bent)
        return np.concatenate([(change.gap / y.gap).ravel(), change.fluid.ravel(), [change.offset]])

    with np.errstate(all="ignore"):
        try:
            implicit_series(unknowns, coefficient, inverse)
        except ArithmeticError:
            return None
        each = [smooth_observables(one, from_row(w, shape)) for one, w in zip(around, powers @ unknowns, strict=True)]
        values = np.array([[one[name] for name in SMOOTH] for one in each])
        found, logs = samples.taylor(values, order), samples.taylor(np.log(values[:, SHARE_COLUMN]), order)
    return Expanded(unknowns, found, logs if np.isfinite(logs).all() else np.full_like(logs, np.nan))


def corrected_once(equations: Equations, y: Unknowns, preconditioner: BandedModes) -> Array | None:
    """Return the observables, by :data:`SMOOTH`, after one Newton step; None where GMRES does not find it."""
    linear, residual = Linear(equations, y), equations.residual(y)
    x = solved(linear, preconditioner, linear.right(residual), MAX_GMRES_RTOL)
    if x is None:
        return None
    values = smooth_observables(equations, y.moved(linear.changes(x, residual[0]), 1.0))
    return np.array([values[name] for name in SMOOTH])
