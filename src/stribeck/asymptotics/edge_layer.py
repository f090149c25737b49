r"""The edge of a rough contact at rest: how its logarithmic gap passes into the gap of Hertz outside.

With :math:`\xi` from the edge at :math:`1 - \kappa` outwards in units of :math:`\kappa^{2/3}`, and :math:`P = e^{-H}`,

.. math::

    H = H_H - \tfrac12 \ln2 - \frac1\pi \int (P - P_H) \ln|\xi - \eta| \, d\eta, \qquad \int (P - P_H) \, d\eta = \frac\pi2 ,

which matches theory.md Eq. (8).

Source: [BP] Appendix B, with the principal value of 1/(xi - eta) for the printed 1/\|x - y\|; theory.md, section 7.
"""

from __future__ import annotations

from functools import lru_cache, partial

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.documentation import described
from stribeck.asymptotics.formula import Limit, Value, formula
from stribeck.asymptotics.half_line import HalfLine, Layer
from stribeck.contacts.groups import Groups
from stribeck.numerics.newton import Dense, StepControl, root_find
from stribeck.numerics.threads import one_blas_thread

LAYER_LOAD = 0.5 * np.pi  # Integral of P - P_H over the layer.


def coordinate(x: Value, edge: Value, kappa: Value) -> Array:
    """Return the distance from an edge in widths of its layer."""
    return np.divide(np.abs(x) - edge, np.power(kappa, 2 / 3))


at_edge = partial(
    formula,
    plane="rest",
    limits=(Limit("load", 1e-4, 0.5), Limit("relative_roughness", 1e-6, 1e-2)),
    small="relative_roughness",
    error_order=2 / 3,
    source="[BP] Appendix B; the edge at 1 - kappa is ours",
)


@at_edge(uses=("load", "relative_roughness"), worst=0.025)
def gap(groups: Groups, x: Value, printed: bool = False) -> Value:
    r"""Return the gap at the edges of a rough contact at rest.

    .. math:: h = \kappa \left[-\tfrac12 \ln F - \tfrac13 \ln\kappa + H(\xi)\right], \qquad
        \xi = \frac{|x| - 1 + \kappa}{\kappa^{2/3}}

    printed : Put the edge at 1 as [BP] do, and not at 1 - kappa.

    Compared with the solver within 5 widths of the edge; as printed the error is 8 % and falls as kappa**(1/3) only.
    H(0) is :data:`.constants.EDGE_GAP`.
    """
    kappa = groups.relative_roughness
    H = layer().gap(coordinate(x, 1.0 if printed else 1.0 - kappa, kappa))
    return kappa * (-0.5 * np.log(groups.load) - np.log(kappa) / 3 + H)


@at_edge(uses=("relative_roughness",), worst=0.07)
def contact_pressure(groups: Groups, x: Value, printed: bool = False) -> Value:
    r"""Return the contact pressure at the edges of a rough contact at rest.

    .. math:: p_c = \kappa^{1/3} e^{-H(\xi)}, \qquad \xi = \frac{|x| - 1 + \kappa}{\kappa^{2/3}}

    printed : Put the edge at 1 as [BP] do, and not at 1 - kappa.

    Compared with the solver within 5 widths of the edge; as printed the error is 9 % and falls as kappa**(1/3) only.
    """
    kappa = groups.relative_roughness
    return kappa ** (1 / 3) * np.exp(-layer().gap(coordinate(x, 1.0 if printed else 1.0 - kappa, kappa)))


@lru_cache(maxsize=4)
@one_blas_thread
@described(
    "Gap and pressure, the contact at negative coordinates.",
    kind="Layer",
    raises="If Newton's iteration fails, which it does not at the default panels.",
    error="RuntimeError",
)
def layer(reach: float = 1e5, width: float = 0.5, order: int = 12) -> Layer:
    r"""Solve the similarity problem of the edge.

    Unknown at the nodes is u of :math:`H = u - \ln P_1`, with :math:`P_1` :attr:`.half_line.Base.root`, so that
    small differences of large pressures are exact; it is scaled by its decay inside.

    Notes
    -----
    H(0) is good to 2e-11 (``test_layers.py``); beyond the box :math:`H - H_H` continues as its far field.
    """
    line = HalfLine(reach, width, order)
    base, D = line.base, line.deflection
    known = -np.log(base.root) - base.gap + 0.5 * np.log(2)
    scale = np.where(line.xi < 0, (1 + np.abs(line.xi)) ** -2.0, 1.0)

    def excess(y: Array) -> Array:
        return np.asarray(base.root * np.expm1(-scale * y) + base.root_excess)

    def residual(y: Array) -> Array:
        return np.asarray(scale * y + known - D @ excess(y))

    def jacobian(y: Array) -> Array:
        matrix = D * (base.root * np.exp(-scale * y) * scale)
        matrix[np.diag_indices(len(y))] += scale
        return matrix

    start = np.where(line.xi > 0, np.maximum(0.0, base.gap + np.log(base.root)), 0.0) / scale
    problem = Dense(
        residual,
        jacobian,
        step_size=lambda y, dy: float(np.abs(dy * scale * base.root * np.exp(-scale * y)).max()),
    )
    root = root_find(problem, start, StepControl(1e-11))
    if not root.outcome.ok:
        raise RuntimeError(f"edge layer with reach = {reach:g}, width = {width:g}, order = {order}: {root.outcome.value}")
    q = excess(root.x)
    return Layer(line, -0.5 * np.log(2), LAYER_LOAD, q, D @ q)
