r"""Taylor series of a state of the line, and of its observables, in the logarithm of the quantity that varies.

The unknowns are those of the equations, with the logarithm of the gap.  The residual is evaluated on jets,
:mod:`stribeck.numerics.jets`; a contact law is a polynomial around each separation.  One factorisation serves all orders, see
:func:`stribeck.numerics.series.implicit_series`.  The observables are sampled on the series of the state.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.contact_laws.exponential import ExponentialLaw
from stribeck.contact_laws.scaled import ContinuedLaw, ScaledLaw
from stribeck.contacts.groups import Groups, contact_law
from stribeck.equations.gap import gap_beside
from stribeck.equations.line import LOAD, Equations, Fields
from stribeck.equations.observables import ROW, measured
from stribeck.numerics.jets import Tape
from stribeck.numerics.newton import Inverse
from stribeck.numerics.series import circle, implicit_series, radius
from stribeck.numerics.settings import SAMPLE_RADIUS_RATIO
from stribeck.numerics.trace import act
from stribeck.quantities.outputs import ALL_NAMES

__all__ = [
    "Direction",
    "Expanded",
    "expand",
    "from_logs",
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
    equations: Equations, y: Array, inverse: Inverse, groups: Groups, direction: Direction, shifts: Array, order: int
) -> Expanded:
    """Return the series of a state by jets, and of its observables by samples of these series on a circle."""
    at, law = equations.layout, contact_law(groups)
    w, units = np.zeros((order + 1, at.size)), equations.units(y)
    w[0], units[at.gap] = y, 1.0
    w[0, at.gap] = np.log(y[at.gap])
    logs = np.full((order + 1, len(ALL_NAMES)), np.nan)
    if isinstance(law, ScaledLaw):
        near: Any = ContinuedLaw.of(law.shape, y[at.gap] / law.decay_length)
        law = replace(law, shape=near)
    tape = Tape(order)
    here, _ = along(equations, law, groups, direction, tape.growth)
    gap, contact, logs[:, ROW["contact_load_share"]] = _by_jets(here, tape, w, lambda r: units * inverse(r))
    samples = circle(SAMPLE_RADIUS_RATIO * radius(w[:, at.gap]), order)
    powers = samples.powers(order)
    places = samples.places[:, None]
    around, load = along(equations, _Known(powers @ contact), groups, direction, lambda rate: np.exp(rate * places))
    rows = powers @ w
    rows[:, at.gap] = powers @ gap
    values = _observables_of_rows(around, rows, load * np.ones((len(rows), 1)))
    if not equations.is_sliding:
        lacks = samples.powers(len(shifts) - 1) @ shifts
        gap, of_load = rows[:, at.gap] + lacks[:, None], equations.operators.mesh.weights
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


def _observables_of_rows(equations: Equations, y: Array, load: Array) -> Array:
    """Return the observables of rows of complex unknowns, shape (rows, n)."""
    found, fields = np.full((len(y), len(ALL_NAMES)), np.nan, complex), equations.fields(y)
    for name, value in measured(equations, fields, load).items():
        found[:, ROW[name]] = value[:, 0]
    found[:, ROW["central_gap"]] = gap_beside(equations.operators.mesh, fields.gap, 0.0)[0]
    return found
