r"""Taylor series of a state of the line, and of its observables, in the logarithm of the quantity that varies.

The unknowns are those of the equations, with the logarithm of the gap.  The residual of the base model's film is composed
of products and exponentials, whose coefficients follow order by order: each costs two matrix-vector products and one
back-substitution; the contact law is a polynomial around each separation.  For any other film the residual is sampled, see
:func:`stribeck.numerics.series.implicit_series`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.continued import ContinuedLaw
from stribeck.contact_laws.exponential import ExponentialLaw, NoContact
from stribeck.contact_laws.scaled import ScaledLaw
from stribeck.contacts.groups import Groups, contact_law
from stribeck.contacts.model import Model
from stribeck.equations.gap import central_gap
from stribeck.equations.line import LOAD, Equations
from stribeck.equations.observables import ROW, VISCOUS, beyond_panels, friction_scale, observables, observables_of_stacked
from stribeck.equations.operators import Operators, OperatorsOfRows
from stribeck.numerics.newton import Inverse
from stribeck.numerics.panels import reference
from stribeck.numerics.series import (
    Samples,
    along,
    exponential,
    exponential_term,
    implicit_series,
    integral_of_product,
    logarithm,
    product,
    reciprocal,
)
from stribeck.quantities.outputs import ALL_NAMES, NAMES

__all__ = [
    "Direction",
    "Expanded",
    "around_state",
    "expand_any_film",
    "expand_article",
    "from_logs",
    "observables_of_rows",
    "residuals",
]

SHIFTED_COLUMNS = [ROW["central_gap"], ROW["offset"]]
GAP_POWERS = np.array([1.0, -2.0, -3.0])[:, None]  # Of the gap in film and contact
REFINED_ORDERS = 2  # Orders that are refined with their residual: rounding of thin films shows in the first ones
# If refining the first order changes it by more than this fraction, the kept LU is too old and every order is refined: the
# published drag of thin films errs by up to a hundred times as much.
REFINE_ALL_ABOVE = 1e-8
Direction = tuple[float, float, float]  # Derivatives of ln(speed), ln(load), ln(roughness) along a curve


class Expanded(NamedTuple):
    """Taylor coefficients about a state, order by order in the first axis."""

    unknowns: Array  # Coefficients of the unknowns, with the logarithm of the gap
    observables: Array
    logs: Array


def from_logs(equations: Equations, w: Array) -> Array:
    """Return the unknowns from a row that holds the logarithm of the gap."""
    found = w.copy()
    with np.errstate(over="ignore"):  # a prediction out of bounds shows in its gap
        found[..., equations.layout.gap] = np.exp(w[..., equations.layout.gap])
    return found


def _log_unknowns(equations: Equations, y: Array) -> tuple[Array, Array]:
    """Return the unknowns with the logarithm of the gap, and their units."""
    start, units, at = y.copy(), equations.units(y), equations.layout
    start[at.gap] = np.log(y[at.gap])
    units[at.gap] = 1.0
    return start, units


class _Contact:
    """The series of the logarithm of the contact pressure over its largest value, order by order with that of the gap."""

    def __init__(self, groups: Groups, gap: Array, direction: Direction, order: int) -> None:
        law, kappa, scaling = contact_law(groups), float(groups.relative_roughness), groups.scaling
        assert isinstance(law, ExponentialLaw | ScaledLaw)
        rate = direction[2] - scaling.roughness_exponent * direction[1]  # of ln(kappa)
        of = ContinuedLaw.exponential if isinstance(law, ExponentialLaw) else lambda s: ContinuedLaw.of(law.shape, s)
        near = of(gap / kappa)
        log_pressure = law.log_pressure(gap)
        self.top = float(log_pressure.max())
        self.start = log_pressure - self.top
        self.by_gap = None if near.logarithmic else (along(-rate, order) / kappa)[::-1].copy()
        self.reach, self.first = near.reach, (-rate if near.logarithmic else 0.0, -law.pressure_exponent * direction[1])
        self.place_by_log_gap = (1.0 if near.logarithmic else gap / kappa) / near.reach
        self.place = np.zeros((order + 1, gap.size))
        self.powers = np.zeros((len(near.coefficients), order + 1, gap.size))
        self.powers[:, 0] = near.coefficients
        self.by_log_gap = near.coefficients[1] * self.place_by_log_gap

    def term(self, k: int, gap: Array) -> Array:
        """Return the coefficient of order k that follows from lower orders of the log gap alone."""
        place = self.first[0] if k == 1 else 0.0
        self.place[k] = (place if self.by_gap is None else self.by_gap[-1 - k :] @ gap) / self.reach
        if len(self.powers) > 2:
            self.powers[:-1, k] = np.einsum("mjn,jn->mn", self.powers[1:, :k], self.place[k:0:-1])
        else:
            self.powers[0, k] = self.powers[1, 0] * self.place[k]
        return np.asarray(self.powers[0, k] + self.first[1] if k == 1 else self.powers[0, k])

    def add(self, k: int, change: Array) -> None:
        """Add the effect of the log gap's coefficient of order k to the powers of the separation."""
        if len(self.powers) > 2:
            of_place = self.place_by_log_gap * change
            self.place[k] += of_place
            self.powers[:-1, k] += self.powers[1:, 0] * of_place


def expand_article(
    equations: Equations, y: Array, inverse: Inverse, groups: Groups, direction: Direction, shifts: Array, order: int
) -> Expanded:
    """Return the series of a state with the base model's film, order by order."""
    op, at = equations.operators, equations.layout
    start, units = _log_unknowns(equations, y)
    w = np.zeros((order + 1, at.size))
    w[0] = start
    speed = float(equations.speed) * along(direction[0], order)
    contact = None if isinstance(equations.law, NoContact) else _Contact(groups, y[at.gap], direction, order)
    rates = np.repeat(GAP_POWERS, op.mesh.size, axis=1)
    logs = rates * start[at.gap]
    if contact is not None:
        rates, logs = np.vstack([rates, contact.by_log_gap]), np.vstack([logs, contact.start])
    slopes, powers = np.zeros((2, order + 1, *rates.shape))
    powers[0] = np.exp(logs)
    by_logs = rates * powers[0]
    gap, square, cube = (powers[:, row] for row in range(len(GAP_POWERS)))
    gradient_by_log = by_logs[1] - start[at.flux_gap] * by_logs[2]
    gradient, flow = np.zeros((2, order + 1, op.mesh.size))
    gradient[0] = square[0] - cube[0] * start[at.flux_gap]
    flow[0] = speed[0] * gradient[0]
    at_flux, weights, r = at.flux_gap.start, op.mesh.weights, np.empty(at.size)
    top = 0.0 if contact is None else math.exp(contact.top)
    # Convolutions take rows side by side in memory.
    speed_backwards, flux_backwards = speed[::-1].copy(), np.zeros(order + 1)
    flux_backwards[-1] = start[at_flux]
    corrections: list[float] = []
    for k in range(1, order + 1):
        powers[k] = exponential_term(slopes, powers, k)
        if contact is not None:
            of_log = contact.term(k, gap[: k + 1])
            slopes[k, -1] = k * of_log
            powers[k, -1] += of_log * powers[0, -1]
        gradient[k] = square[k] - flux_backwards[-1 - k :] @ cube[: k + 1]
        if equations.is_sliding:
            flow[k] = speed_backwards[-1 - k :] @ gradient[: k + 1]
        inexact = k > REFINED_ORDERS and corrections[1] > REFINE_ALL_ABOVE * corrections[0]
        for _ in range(2 if k <= REFINED_ORDERS or inexact else 1):
            pressure = top * powers[k, -1]
            if equations.is_sliding:
                pressure += op.integral(flow[k])
            r[at.gap] = gap[k] - w[k, at.offset] - op.deflection @ pressure
            r[at.offset] = weights @ pressure
            r[at.flux_gap] = equations.flux_scale * (weights @ gradient[k])
            step = units * inverse(r)
            if k == 1:
                corrections.append(float(np.abs(step[at.gap]).max()))
            w[k] += step
            flux_backwards[-1 - k] = w[k, at_flux]
            change = step[at.gap]
            powers[k] += by_logs * change
            slopes[k] += rates * (k * change)
            if contact is not None:
                contact.add(k, change)
            of_gradient = gradient_by_log * change
            of_gradient -= step[at_flux] * cube[0]
            gradient[k] += of_gradient
            flow[k] += speed[0] * of_gradient
    flux = w[:, at_flux]
    found, found_logs = np.zeros((2, order + 1, len(ALL_NAMES)))
    found[:, len(NAMES) + 1 :] = np.nan
    found_logs[:] = np.nan
    if contact is not None:
        relative, share = powers[:, -1] @ weights / LOAD, ROW["contact_load_share"]
        found[:, share] = top * relative
        found_logs[:, share] = logarithm(relative)
        found_logs[0, share] += contact.top
    found[:, ROW["fluid_load_share"]] = flow @ op.load_of_gradient / LOAD
    found[:, ROW["central_gap"]] = _central_gap(equations, y, w[:, at.gap])
    found[:, ROW["flux_gap"]] = flux
    found[:, ROW["offset"]] = w[:, at.offset.start]
    if equations.is_sliding:
        scale = friction_scale(float(groups.load), float(equations.speed)) * along(direction[0] + 0.5 * direction[1], order)
        for name, integral in zip(VISCOUS, _friction_integrals(equations, gap, square, gradient, flux), strict=True):
            found[:, ROW[name]] = product(scale, integral)
    else:
        found[:, SHIFTED_COLUMNS] += shifts[:, None]
        found[:, ROW["flux_gap"]] = _flux_gap(gap + shifts[:, None], weights)
        found[:, ROW["minimum_gap"]] = found[:, ROW["central_gap"]]
    return Expanded(w, found, found_logs)


def _central_gap(equations: Equations, y: Array, logs: Array) -> Array:
    """Return the series of the gap at zero."""
    mesh = equations.operators.mesh
    first = int(np.searchsorted(mesh.edges, 0.0)) * mesh.order
    at_zero = logs[:, first : first + mesh.order] @ reference(mesh.order).left_end
    at_zero[0] = np.log(central_gap(mesh, y[equations.layout.gap]))
    return exponential(at_zero)


def _flux_gap(gap: Array, weights: Array) -> Array:
    """Return the series of the flux gap of a film at rest; nan where the gap closes."""
    if not gap[0].min() > 0:
        return np.full(len(gap), np.nan)
    u = reciprocal(gap)
    square = product(u, u)
    return product(square @ weights, reciprocal(product(square, u) @ weights))


def _friction_integrals(
    equations: Equations, gap: Array, square: Array, gradient: Array, flux: Array
) -> tuple[Array, Array, Array]:
    """Return the series of shear, pressure-flow and upper-wall friction integrals."""
    # Within the panels they follow from the gap and one over its ``square`` at the nodes; beyond them the gap is interpolated.
    op = equations.operators
    mesh, inner = op.mesh, slice(0, -op.mesh.order)
    x, weights, first_order = beyond_panels(mesh, gap[:1], op.model.solid.far_gap)
    u = reciprocal(np.concatenate([first_order, beyond_panels(mesh, gap[1:], np.zeros_like)[2]]))
    squared, own, projected = product(u, u), mesh.weights[inner], 3 * x**2 * weights
    first = integral_of_product(gap[:, inner], square[:, inner], own) + u @ weights
    second = product(3 * flux, square[:, inner] @ own + squared @ weights)
    moment = gradient[:, inner] @ (3 * mesh.nodes[inner] ** 2 * own) + squared @ projected
    moment -= product(flux, integral_of_product(squared, u, projected))
    return second - 2 * first + moment, 4 * first - second, second - 2 * first


def expand_any_film(
    equations: Equations,
    y: Array,
    inverse: Inverse,
    groups: Groups,
    direction: Direction,
    shifts: Array,
    samples: Samples,
    models: Sequence[Model],
    order: int,
) -> Expanded:
    """Return the series of a state with any film, by sampling the residual."""
    start, units = _log_unknowns(equations, y)
    around, load = around_state(equations, groups, direction, samples.places, models)
    powers = samples.powers(order)

    def local(k: int, w: Array) -> Array:
        return residuals(around, from_logs(equations, powers[:, :k] @ w[:k]))

    unknowns = implicit_series(start, samples, local, lambda k, w, v: v, lambda r: units * inverse(r), order)
    y = from_logs(equations, powers @ unknowns)
    values = observables_of_rows(around, y, load)
    if not equations.is_sliding:
        lacks = samples.powers(len(shifts) - 1) @ shifts
        gap = y[:, equations.layout.gap] + lacks[:, None]
        weights = equations.operators.mesh.weights
        values[:, SHIFTED_COLUMNS] += lacks[:, None]
        values[:, ROW["flux_gap"]] = (gap**-2 @ weights) / (gap**-3 @ weights) if np.all(gap > 0) else np.nan
        values[:, ROW["minimum_gap"]] = values[:, ROW["central_gap"]]
    found = samples.taylor(values, order)
    return Expanded(unknowns, found, np.full_like(found, np.nan))


def residuals(around: Sequence[Equations], y: Array) -> Array:
    """Return the residuals of rows of unknowns, by one system for all rows or one for each."""
    if len(around) == 1:
        return around[0].residual(y)
    return np.stack([one.residual(row) for one, row in zip(around, y, strict=True)])


def observables_of_rows(around: Sequence[Equations], y: Array, load: Array) -> Array:
    """Return the observables of rows of unknowns, shape (rows, n), by one system for all rows or one for each."""
    if len(around) == 1:
        each = observables_of_stacked(around[0], y, load)
    else:
        each = [observables(one, row, own) for one, row, own in zip(around, y, load[:, 0].tolist(), strict=True)]
    return np.array([one.array(in_article=False) for one in each])


def around_state(
    equations: Equations, groups: Groups, direction: Direction, places: Array, models: Sequence[Model]
) -> tuple[list[Equations], Array]:
    """Return the systems at places along a path, stacked in one where possible, and their loads."""
    speed, load, roughness = np.exp(np.outer(places, direction)).T[..., None]
    speed, load, law = float(groups.speed) * speed, float(groups.load) * load, contact_law(groups)
    assert isinstance(law, ExponentialLaw | ScaledLaw | NoContact)
    changes: dict[str, Any] = {}
    if groups.roughness > 0:
        changes = {"load": load, "decay_length": float(groups.roughness) * roughness / load**groups.scaling.roughness_exponent}
    one = equations.operators if not models else _of_rows(equations.operators, models)
    if one is not None:
        return [Equations(one, speed, replace(law, **changes), equations.flux_scale)], load
    each = []
    for row, model in enumerate(models):
        operators = Operators(equations.operators.mesh, model)
        if model.solid == equations.operators.model.solid:
            vars(operators).update(deflection=equations.operators.deflection)
        here: dict[str, Any] = {name: float(value[row, 0]) for name, value in changes.items()}
        each.append(Equations(operators, float(speed[row, 0]), replace(law, **here), equations.flux_scale))
    return each, load


def _of_rows(operators: Operators, models: Sequence[Model]) -> Operators | None:
    """Return operators for models that differ in their solids alone; None if more differs."""
    model = operators.model
    alike = all(replace(each, solid=model.solid) == model for each in models)
    if not alike or operators.has_reformation:
        return None
    return OperatorsOfRows(operators.mesh, model, tuple(each.solid for each in models))
