r"""Taylor series of a state of the line, and of its observables, in the logarithm of the quantity that varies.

The unknowns are those of the equations, with the logarithm of the gap.  Where film and law are known by formulas, the residual
is evaluated on jets, :mod:`stribeck.numerics.jets`; a contact law is a polynomial around each separation.  Any other residual
is sampled along the path.  One factorisation serves all orders, see :func:`stribeck.numerics.series.implicit_series`.  The
observables are sampled on the series of the state.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.contact_laws.continued import ContinuedLaw
from stribeck.contact_laws.exponential import ExponentialLaw
from stribeck.contact_laws.scaled import ScaledLaw
from stribeck.contacts.groups import Groups, contact_law
from stribeck.contacts.model import Model
from stribeck.equations.line import LOAD, Equations, Fields
from stribeck.equations.observables import ROW, central_gaps, measured, observables, observables_of_stacked
from stribeck.equations.operators import Operators, OperatorsOfRows
from stribeck.numerics.jets import Tape
from stribeck.numerics.newton import Inverse
from stribeck.numerics.series import Samples, circle, implicit_series, radius
from stribeck.numerics.settings import SAMPLE_RADIUS_RATIO
from stribeck.numerics.trace import act
from stribeck.quantities.outputs import ALL_NAMES

__all__ = [
    "Direction",
    "Expanded",
    "around_state",
    "expand",
    "from_logs",
    "observables_of_rows",
    "residuals",
]

SHIFTED_COLUMNS = [ROW["central_gap"], ROW["offset"]]
Direction = tuple[float, float, float]  # Derivatives of ln(speed), ln(load), ln(roughness) along a curve


class Expanded(NamedTuple):
    """Taylor coefficients about a state, order by order in the first axis."""

    unknowns: Array  # Coefficients of the unknowns, with the logarithm of the gap
    observables: Array
    logs: Array  # Of logarithms of observables; nan where there are none


def from_logs(equations: Equations, w: Array) -> Array:
    """Return the unknowns from a row that holds the logarithm of the gap."""
    found = w.copy()
    with np.errstate(over="ignore"):  # a prediction out of bounds shows in its gap
        found[..., equations.layout.gap] = np.exp(w[..., equations.layout.gap])
    return found


class _Known(NamedTuple):
    """A contact law by its pressure at the gaps where it is asked for."""

    values: Any

    def pressure(self, gap: Any) -> Any:
        """Return the contact pressure."""
        return self.values


def expand(
    equations: Equations,
    y: Array,
    inverse: Inverse,
    groups: Groups,
    direction: Direction,
    shifts: Array,
    order: int,
    samples: Samples | None = None,
    models: Sequence[Model] = (),
) -> Expanded:
    """Return the series of a state: by jets, or by samples of films and laws that are known by their values alone."""
    at, law = equations.layout, contact_law(groups)
    w, units = np.zeros((order + 1, at.size)), equations.units(y)
    w[0], units[at.gap] = y, 1.0
    w[0, at.gap] = np.log(y[at.gap])
    logs = np.full((order + 1, len(ALL_NAMES)), np.nan)
    if samples is None:
        if isinstance(law, ScaledLaw):
            near: Any = ContinuedLaw.of(law.shape, y[at.gap] / law.decay_length)
            law = replace(law, shape=near)
        tape = Tape(order)
        here, _ = along(equations, law, groups, direction, tape.growth)
        gap, contact, logs[:, ROW["contact_load_share"]] = _by_jets(here, tape, w, lambda r: units * inverse(r))
        samples = circle(SAMPLE_RADIUS_RATIO * radius(w[:, at.gap]), order)
        powers = samples.powers(order)
        around, load = around_state(equations, _Known(powers @ contact), groups, direction, samples.places, models)
        y = powers @ w
        y[:, at.gap] = powers @ gap
    else:
        around, load = around_state(equations, law, groups, direction, samples.places, models)
        powers, weights = samples.powers(order), samples.weights

        def sampled(k: int) -> Array:
            return np.asarray(weights[k] @ residuals(around, from_logs(equations, powers[:, :k] @ w[:k])))

        implicit_series(w, sampled, lambda r: units * inverse(r))
        y = from_logs(equations, powers @ w)
    values = observables_of_rows(around, y, load)
    if not equations.is_sliding:
        lacks = samples.powers(len(shifts) - 1) @ shifts
        gap, of_load = y[:, at.gap] + lacks[:, None], equations.operators.mesh.weights
        values[:, SHIFTED_COLUMNS] += lacks[:, None]
        values[:, ROW["flux_gap"]] = (gap**-2 @ of_load) / (gap**-3 @ of_load) if np.all(gap > 0) else np.nan
        values[:, ROW["minimum_gap"]] = values[:, ROW["central_gap"]]
    return Expanded(w, samples.taylor(values, order), logs)


def _by_jets(equations: Equations, tape: Tape, w: Array, inverse: Callable[[Array], Array]) -> tuple[Array, Array, Any]:
    """Write the series of the unknowns; return those of the gap, of the contact pressure and of ln(contact share)."""
    at = equations.layout
    u = Fields(*(None if part is None else tape.given(part) for part in equations.fields(w)))
    u = u._replace(gap=np.exp(u.gap))
    contact = equations.contact(u.gap)
    known: Any = _Known(contact)
    rows = replace(equations, law=known).rows(u)
    blocks = [(getattr(at, name), row) for name, row in zip(Fields._fields, rows, strict=True) if row is not None]
    tape.keep(row for _, row in blocks)
    found = np.empty(at.size)

    def coefficient(k: int) -> Array:
        tape.fill(k)
        for block, row in blocks:
            found[block] = row.coefficients[k]
        return found

    implicit_series(w, coefficient, inverse, refines=True)
    tape.settle()
    share = act(equations.operators.panel_load, contact) / LOAD
    log_share = np.log(share).coefficients[:, 0] if share.value > 0 else np.nan
    tape.made.clear()
    return u.gap.coefficients, contact.coefficients, log_share


def along(
    equations: Equations, law: Any, groups: Groups, direction: Direction, growth: Callable[[float], Any]
) -> tuple[Equations, Any]:
    """Return the equations along a path and the load; ``growth`` gives the exponential of a rate times the coordinate."""

    def moved(value: Numbers, rate: float) -> Any:
        return value * growth(rate) if rate else value

    by_speed, by_load, by_roughness = direction
    load = moved(groups.load, by_load)
    if isinstance(law, ExponentialLaw | ScaledLaw):
        rate = by_roughness - groups.scaling.roughness_exponent * by_load
        law = replace(law, load=load, decay_length=moved(groups.relative_roughness, rate))
    return replace(equations, speed=moved(groups.speed, by_speed), law=law), load


def observables_of_rows(around: Sequence[Equations], y: Array, load: Array) -> Array:
    """Return the observables of rows of unknowns, shape (rows, n), by one system for all rows or one for each."""
    if np.iscomplexobj(y):
        (one,), found = around, np.full((len(y), len(ALL_NAMES)), np.nan, complex)
        for name, value in measured(one, one.fields(y), load).items():
            found[:, ROW[name]] = value[:, 0]
        found[:, ROW["central_gap"]] = central_gaps(one, one.fields(y))
        return found
    if len(around) == 1:
        each = observables_of_stacked(around[0], y, load)
    else:
        each = [observables(one, row, own) for one, row, own in zip(around, y, load[:, 0].tolist(), strict=True)]
    return np.array([one.array() for one in each])


def residuals(around: Sequence[Equations], y: Array) -> Array:
    """Return the residuals of rows of unknowns, by one system for all rows or one for each."""
    if len(around) == 1:
        return around[0].residual(y)
    return np.stack([one.residual(row) for one, row in zip(around, y, strict=True)])


def around_state(
    equations: Equations, law: Any, groups: Groups, direction: Direction, places: Array, models: Sequence[Model]
) -> tuple[list[Equations], Array]:
    """Return the systems at places along a path, stacked in one where possible, and their loads."""
    stacked, load = along(equations, law, groups, direction, partial(_grown, places[:, None]))
    one = equations.operators if not models else _of_rows(equations.operators, models)
    if one is not None:
        return [replace(stacked, operators=one)], load * np.ones((len(places), 1))
    each = []
    for place, model in zip(places.tolist(), models, strict=True):
        operators = Operators(equations.operators.mesh, model)
        if model.solid == equations.operators.model.solid:
            vars(operators).update(deflection=equations.operators.deflection)
        here, _ = along(equations, law, groups, direction, partial(_grown, place))
        each.append(replace(here, operators=operators))
    return each, load * np.ones((len(places), 1))


def _grown(t: Any, rate: float) -> Any:
    return np.exp(rate * t)


def _of_rows(operators: Operators, models: Sequence[Model]) -> Operators | None:
    """Return operators for models that differ in their solids alone; None if more differs."""
    model = operators.model
    alike = all(replace(each, solid=model.solid) == model for each in models)
    if not alike or operators.has_reformation:
        return None
    return OperatorsOfRows(operators.mesh, model, tuple(each.solid for each in models))
