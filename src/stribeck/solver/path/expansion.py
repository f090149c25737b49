r"""Taylor series of a state of the line, and of its observables, in the logarithm of the quantity that varies.

The unknowns are those of the equations, with the logarithm of the gap.  The residual is evaluated on jets,
:mod:`stribeck.numerics.jets`; a contact law is a polynomial around each separation.  One factorisation serves all orders, see
:func:`stribeck.numerics.series.implicit_series`.  The observables are jets of the same unknowns.
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
from stribeck.equations.line import Equations, Fields
from stribeck.equations.observables import ROW, measured
from stribeck.numerics.jets import Jet, Tape
from stribeck.numerics.newton import Inverse
from stribeck.numerics.series import implicit_series
from stribeck.quantities.outputs import ALL_NAMES

__all__ = [
    "Direction",
    "Expanded",
    "expand",
    "from_logs",
]

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
    """Return the series of a state and of its observables; at rest ``shifts`` is the series of the shift of its gap."""
    at, law = equations.layout, contact_law(groups)
    w, units = np.zeros((order + 1, at.size)), equations.units(y)
    w[0], units[at.gap] = y, 1.0
    w[0, at.gap] = np.log(y[at.gap])
    if isinstance(law, ScaledLaw):
        near: Any = ContinuedLaw.of(law.shape, y[at.gap] / law.decay_length)
        law = replace(law, shape=near)
    tape = Tape(order)
    here, load = _along(equations, law, groups, direction, tape)
    u = Fields(*(None if part is None else tape.given(part) for part in equations.fields(w)))
    u = u._replace(gap=np.exp(u.gap))
    known: Any = _Known(here.contact(u.gap))
    here = replace(here, law=known)
    _write_series(w, tape, here, u, lambda r: units * inverse(r))
    values, logs = np.full((2, order + 1, len(ALL_NAMES)), np.nan)
    found = _observed(here, u, load, None if equations.is_sliding else tape.given(shifts[:, None]))
    for name, value in found.items():
        values[:, ROW[name]] = value.coefficients[:, 0]
    share = found["contact_load_share"]
    if share.value > 0:
        logs[:, ROW["contact_load_share"]] = np.log(share).coefficients[:, 0]
    return Expanded(w, values, logs)


def _write_series(w: Array, tape: Tape, equations: Equations, u: Fields, inverse: Callable[[Array], Array]) -> None:
    """Write the series of the unknowns, whose jets are ``u``."""
    at, rows = equations.layout, equations.rows(u)
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
    tape.made.clear()  # what is made of these jets from now on has its coefficients at once


def _observed(equations: Equations, u: Fields, load: Any, shift: Jet | None) -> dict[str, Any]:
    """Return the jets of the observables but for the minimum gap, whose place moves; at rest all gaps have a shift."""
    found = {name: value for name, value in measured(equations, u, load).items() if isinstance(value, Jet)}
    found["central_gap"] = gap_beside(equations.operators.mesh, u.gap, 0.0)[0]
    if shift is None:
        return found
    found |= {name: found[name] + shift for name in ("central_gap", "offset")}
    found["minimum_gap"] = found["central_gap"]
    gap, weights = u.gap + shift, equations.operators.mesh.weights
    if np.all(gap.value > 0):
        found["flux_gap"] = (gap**-2.0 @ weights) / (gap**-3.0 @ weights)
    else:
        del found["flux_gap"]
    return found


def _along(equations: Equations, law: Any, groups: Groups, direction: Direction, tape: Tape) -> tuple[Equations, Any]:
    """Return the equations along a path, and the load."""

    def moved(value: Numbers, rate: float) -> Any:
        return value * tape.growth(rate) if rate else value

    by_speed, by_load, by_roughness = direction
    load = moved(groups.load, by_load)
    if isinstance(law, ExponentialLaw | ScaledLaw):
        rate = by_roughness - groups.scaling.roughness_exponent * by_load
        law = replace(law, load=load, decay_length=moved(groups.relative_roughness, rate))
    return replace(equations, speed=moved(groups.speed, by_speed), law=law), load
