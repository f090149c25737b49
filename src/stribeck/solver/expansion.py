r"""Taylor series of a state of the line in the logarithm of what varies, and of its observables.

The unknowns are those of the equations, the gap by its logarithm.  In a film of the article an order costs the evaluation of
film and contact law around the state, two matrix-vector products and one back-substitution, in any other that of the whole
residual, see :func:`stribeck.numerics.series.implicit_series`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.continued import ContinuedLaw
from stribeck.contact_laws.exponential import ExponentialLaw, NoContact
from stribeck.contact_laws.scaled import ScaledLaw
from stribeck.contacts.groups import Groups, contact_law
from stribeck.contacts.model import Model
from stribeck.equations.line import LOAD, Equations, Operators
from stribeck.equations.observables import ROW, observables, observables_of_stacked, smooth_observables
from stribeck.fluids import newtonian
from stribeck.numerics.newton import Inverse
from stribeck.numerics.series import Samples, implicit_series
from stribeck.quantities.outputs import ALL_NAMES

__all__ = ["Direction", "Expanded", "expand"]

SHIFTED = [ROW["central_gap"], ROW["offset"]]

Direction = tuple[float, float, float]
"""Derivatives of ln(speed), ln(load), ln(roughness) along a curve."""


class Around(NamedTuple):
    """What is solved around a state, at samples in rows.

    Attributes
    ----------
    equations : Equations
        The equations, all speeds and laws in columns; None where the model varies along the path.
    load : ndarray
        Load groups, a column.
    shifts : ndarray
        What the gap lacks, see :func:`stribeck.solver.at_rest.with_positive_gap`.
    each : tuple of Equations
        Those of each sample where the model varies, else none.
    """

    equations: Equations | None
    load: Array
    shifts: Array
    each: tuple[Equations, ...] = ()


class Expanded(NamedTuple):
    """Taylor coefficients about a state, order by order in the first axis.

    Attributes
    ----------
    y : ndarray
        Unknowns of the state, corrected once more with the Jacobian at it.
    inverse : Inverse
        That of this Jacobian.
    unknowns : ndarray, shape (K + 1, unknowns)
        Those of the unknowns, of the gap its logarithm.
    aliased : float
        What coefficients beyond those that the samples tell may add to the pressures at the samples.
    observables, logs : ndarray, shape (K + 1, n)
        Those of the observables, none of the minimum gap; of the share of asperities its logarithm too, else nan.
    """

    y: Array
    inverse: Inverse
    unknowns: Array
    aliased: float
    observables: Array
    logs: Array


def around(
    equations: Equations,
    gap: Array,
    groups: Groups,
    direction: Direction,
    samples: Samples,
    shifts: Array,
    models: Sequence[Model],
) -> Around:
    """Return the equations around those of a state.

    Parameters
    ----------
    equations : Equations
        Of the state.
    gap : ndarray
        Its gap at the nodes.
    groups : Groups
        Its groups.
    direction : tuple of float
        Derivatives of ln(speed), ln(load), ln(roughness).
    samples : Samples
        Where along the path.
    shifts : ndarray
        What the gap lacks there.
    models : sequence of Model
        The model there; none where it does not vary.
    """
    speed, load, roughness = np.exp(np.outer(samples.places, direction)).T[..., None]
    speed, load, law = float(groups.speed) * speed, float(groups.load) * load, contact_law(groups)
    assert isinstance(law, ExponentialLaw | ScaledLaw | NoContact)
    changes: dict[str, Any] = {}
    if groups.roughness > 0:
        changes = {"load": load, "decay_length": float(groups.roughness) * roughness / load**groups.scaling.roughness_exponent}
        if isinstance(law, ScaledLaw) and np.iscomplexobj(samples.places):
            changes["shape"] = ContinuedLaw.of(law.shape, gap / float(groups.relative_roughness))
    if not models:
        return Around(Equations(equations.operators, speed, replace(law, **changes), equations.flux_scale), load, shifts)
    each = []
    for row, model in enumerate(models):
        operators = Operators(equations.operators.mesh, model)
        if model.solid == equations.operators.model.solid:
            vars(operators)["deflection"] = equations.operators.deflection
        here: dict[str, Any] = {name: float(value[row, 0]) for name, value in changes.items()}
        alone = replace(law, **here)
        each.append(Equations(operators, float(speed[row, 0]), alone, equations.flux_scale))
    return Around(None, load, shifts, tuple(each))


def expand(equations: Equations, y: Array, around: Around, samples: Samples, order: int) -> Expanded:
    """Return the series of a state.

    Parameters
    ----------
    equations : Equations
        Of the state.
    y : ndarray
        Its unknowns, converged.
    around : Around
        The equations around it.
    samples : Samples
        Where these are.
    order : int
        The highest order.

    Returns
    -------
    Expanded
        The coefficients.
    """
    inverse, units = equations.inverse(y), equations.units(y)
    y = y + units * inverse(equations.residual(y))
    at = equations.layout
    start = y.copy()
    start[at.gap] = np.log(y[at.gap])
    units[at.gap] = 1.0

    def correct(r: Array) -> Array:
        return np.asarray(units * inverse(r))

    series = _of_article if around.equations is not None and equations.operators.is_article else _of_any_film
    found, aliased = series(equations, start, around, samples, correct, order)
    return Expanded(y, inverse, found, aliased, *_observables(equations, around, found, samples))


def from_logs(equations: Equations, w: Array) -> Array:
    """Return unknowns from those with the logarithm of the gap."""
    found = w.copy()
    found[..., equations.layout.gap] = np.exp(w[..., equations.layout.gap])
    return found


def _of_article(
    equations: Equations, start: Array, around: Around, samples: Samples, correct: Callable[[Array], Array], order: int
) -> tuple[Array, float]:
    """Return the series of the unknowns of a film of the article, and what is aliased.

    What is nonlinear is local: the gradient of the film and the contact law, each at its node.  They alone are sampled.
    """
    assert around.equations is not None
    op, at, law, speed = equations.operators, equations.layout, around.equations.law, around.equations.speed
    n, powers = op.mesh.size, samples.powers(order)
    contact, gradient, flow = (slice(k * n, (k + 1) * n) for k in range(3))
    last: list[Array] = []
    gap = np.zeros((order + 1, n))
    gap[0] = np.exp(start[at.gap])

    def local(k: int, w: Array) -> Array:
        for i in range(max(1, k - 1), k + 1):  # that before was without the last coefficient of the logarithm
            gap[i] = _exponential(w[:, at.gap], gap, i)
        h, m = powers[:, : k + 1] @ gap[: k + 1], powers[:, :k] @ w[:k, at.flux_gap]
        found = np.empty((len(h), 3 * n), dtype=h.dtype)
        found[:, contact] = law.pressure(h)
        found[:, gradient] = newtonian.gradient(h, m)
        np.multiply(speed, found[:, gradient], out=found[:, flow])
        last[:] = [found]
        return found

    def residual(k: int, w: Array, v: Array) -> Array:
        r = np.empty(at.size)
        r[at.gap] = gap[k] - op.deflection @ v[contact]
        r[at.offset] = op.mesh.weights @ v[contact]
        r[at.flux_gap] = equations.flux_scale * (op.mesh.weights @ v[gradient])
        if equations.is_sliding:
            r[at.gap] -= op.deflection_of_gradient @ v[flow]
            r[at.offset] += op.load_of_gradient @ v[flow]
        return r

    found = implicit_series(start, samples, local, residual, correct, order)
    pressures = np.hstack([last[0][:, contact], last[0][:, flow]])
    return found, samples.aliased(pressures)


def _of_any_film(
    equations: Equations, start: Array, around: Around, samples: Samples, correct: Callable[[Array], Array], order: int
) -> tuple[Array, float]:
    """Return the series of the unknowns of any film, of which the whole residual is sampled, and zero."""
    powers = samples.powers(order)

    def local(k: int, w: Array) -> Array:
        y = from_logs(equations, powers[:, :k] @ w[:k])
        if around.equations is not None:
            return around.equations.residual(y)
        return np.stack([one.residual(row) for one, row in zip(around.each, y, strict=True)])

    return implicit_series(start, samples, local, lambda k, w, v: v, correct, order), 0.0


def _exponential(logs: Array, values: Array, k: int) -> Array:
    """Return the coefficient of order k of an exponential, those of its argument and the lower ones of itself given."""
    return np.asarray(np.einsum("k,kn,kn->n", np.arange(1, k + 1) / k, logs[1 : k + 1], values[k - 1 :: -1][:k]))


def _observables(equations: Equations, around: Around, found: Array, samples: Samples) -> tuple[Array, Array]:
    """Return the coefficients of the observables and of their logarithms."""
    order = len(found) - 1
    y = from_logs(equations, samples.powers(order) @ found)
    if around.equations is not None and equations.operators.is_article:
        values = smooth_observables(around.equations, y, around.load).T
    else:
        rows = zip(around.each, y, around.load[:, 0].tolist(), strict=False)
        found_each = [observables(one, row, load) for one, row, load in rows]
        if around.equations is not None:
            found_each = observables_of_stacked(around.equations, y, around.load)
        values = np.array([one.array(in_article=False) for one in found_each])
    if not equations.is_sliding:
        gap = y[:, equations.layout.gap] + around.shifts[:, None]
        weights = equations.operators.mesh.weights
        values[:, SHIFTED] += around.shifts[:, None]
        values[:, ROW["flux_gap"]] = (gap**-2 @ weights) / (gap**-3 @ weights) if np.all(gap.real > 0) else np.nan
        values[:, ROW["minimum_gap"]] = values[:, ROW["central_gap"]]
    values = np.hstack([values, np.full((len(values), len(ALL_NAMES) - values.shape[1]), np.nan)])
    series, logs = samples.taylor(values, order), np.full((order + 1, len(ALL_NAMES)), np.nan)
    law = None if around.equations is None else around.equations.law
    if law is not None and np.any(law.decay_length) and equations.operators.is_article:
        # Relative to the pressure where it is largest, that of a tiny share neither underflows nor winds around zero.
        log_p = law.log_pressure(y[:, equations.layout.gap])
        largest = log_p[:, int(np.argmax(log_p.real.mean(axis=0)))]
        share = np.exp(log_p - largest[:, None]) @ equations.operators.mesh.weights / LOAD
        logs[:, ROW["contact_load_share"]] = samples.taylor(largest + np.log(share), order)
    return series, logs
