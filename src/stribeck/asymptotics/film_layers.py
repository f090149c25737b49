"""Inlet and outlet of the smooth film, speed group -> 0: how the uniform film passes into the gap of Hertz outside.

They are theory.md Eq. (9), where P - P_H vanishes at both ends, carries no load and does not shift the edge.  The inlet has
one condition more than the outlet, and so a solution for one c only: the film that it lets in.

Source: [BP] Section "Smooth limit", after Snoeijer, Eggers and Venner, Phys. Fluids 25, 101705 (2013); theory.md, section 7.
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

_layer = partial(
    formula,
    uses=("speed",),
    plane="smooth",
    limits=(Limit("speed", 1e-10, 1e-3),),
    small="speed",
    error_order=0.4,
    source="[BP] Section 'Smooth limit', after Snoeijer, Eggers and Venner (2013); solved here",
)


@_layer(worst=0.04)
def gap_inlet(groups: Groups, x: Value) -> Value:
    r"""Return the gap of a slow smooth film at its inlet.

    .. math:: h = \lambda^{3/5} H_\mathrm{in}(\xi), \qquad \xi = -\frac{x + 1}{\lambda^{2/5}}

    Compared with the solver within 5 widths lambda**(2/5) of the edge.  Inside, H tends to :data:`.constants.FILM_CONSTANT`.
    """
    return groups.speed**0.6 * inlet().gap(np.divide(np.subtract(-1.0, x), groups.speed**0.4))


@_layer(worst=0.055)
def gap_outlet(groups: Groups, x: Value) -> Value:
    r"""Return the gap of a slow smooth film at its outlet.

    .. math:: h = \lambda^{3/5} H_\mathrm{out}(\xi), \qquad \xi = \frac{x - 1}{\lambda^{2/5}}

    Compared with the solver within 5 widths lambda**(2/5) of the edge.  The minimum gap is
    :data:`.constants.MINIMUM_CONSTANT` lambda**(3/5), at x = 1 + :data:`.constants.MINIMUM_POSITION` lambda**(2/5).
    """
    return groups.speed**0.6 * outlet().gap(np.divide(np.subtract(x, 1.0), groups.speed**0.4))


@_layer(worst=0.09)
def fluid_pressure_inlet(groups: Groups, x: Value) -> Value:
    r"""Return the fluid pressure of a slow smooth film at its inlet.

    .. math:: p_f = \lambda^{1/5} P_\mathrm{in}(\xi), \qquad \xi = -\frac{x + 1}{\lambda^{2/5}}

    Compared with the solver within 5 widths lambda**(2/5) of the edge.
    """
    return groups.speed**0.2 * inlet().pressure(np.divide(np.subtract(-1.0, x), groups.speed**0.4))


@_layer(worst=0.095)
def fluid_pressure_outlet(groups: Groups, x: Value) -> Value:
    r"""Return the fluid pressure of a slow smooth film at its outlet.

    .. math:: p_f = \lambda^{1/5} P_\mathrm{out}(\xi), \qquad \xi = \frac{x - 1}{\lambda^{2/5}}

    Compared with the solver within 5 widths lambda**(2/5) of the edge.
    """
    return groups.speed**0.2 * outlet().pressure(np.divide(np.subtract(x, 1.0), groups.speed**0.4))


@lru_cache(maxsize=4)
@described(
    "Gap and pressure, the contact at negative coordinates; its ``constant`` is c.",
    kind="Layer",
    raises="If Newton's iteration fails, which it does not at the default panels.",
    error="RuntimeError",
)
def inlet(reach: float = 1e6, width: float = 0.25, order: int = 12) -> Layer:
    """Solve the similarity problem of the inlet, which selects the film.

    Notes
    -----
    c is good to 1e-11 (``test_layers.py``), the fields to 2e-6: a finite reach shifts the edge by some 1/reach.
    """
    return _solve(HalfLine(reach, width, order), None)


@lru_cache(maxsize=4)
def outlet(reach: float = 1e6, width: float = 0.25, order: int = 12, film: float | None = None) -> Layer:
    """Solve the similarity problem of the outlet, for a given c or for that of the inlet; otherwise as :func:`inlet`.

    The minimum gap over c is good to 1e-9 (``test_layers.py``), the fields to 2e-6.
    """
    return _solve(HalfLine(reach, width, order), inlet(reach, width, order).constant if film is None else film)


@one_blas_thread
def _solve(line: HalfLine, film: float | None) -> Layer:
    r"""Solve the inlet (``film`` None) or the outlet, with the gradient of P - P_B at the nodes as unknown.

    The gradient is integrated from both ends, and the two integrals have to meet.  In the inlet that is the equation for c.
    In the outlet it would be one equation too many, because the end of the box in the contact makes a layer of its own, one
    like an inlet: there the second unknown is a pressure that P - P_B keeps at that end, and it vanishes with the reach.
    """
    xi, base, n = line.xi, line.base, len(line.xi)
    D, sign = line.deflection_of_gradient, -1.0 if film is None else 1.0
    scale = (1 + np.abs(xi)) ** -2.5
    rows = np.where(xi > 0, 1 / scale, 1.0)
    kept = np.where(xi < 0, 1.0, 0.0) / line.reach
    of_kept = line.deflection @ kept

    def fields(y: Array) -> tuple[Array, float, Array]:
        """Return the gradient, c and the gap."""
        g = scale * y[:n]
        if film is None:
            return g, y[n], base.gap + y[n] + D @ g
        return g, film, base.gap + film + D @ g + of_kept * y[n]

    def residual(y: Array) -> Array:
        g, c, H = fields(y)
        meeting = line.weights @ g + (0.0 if film is None else y[n] / line.reach)
        return np.append(rows * (sign * (H - c) / H**3 - base.slope - g), meeting)

    def jacobian(y: Array) -> Array:
        _, c, H = fields(y)
        by_gap = sign * (3 * c - 2 * H) / H**4
        matrix = np.zeros((n + 1, n + 1), order="F")
        matrix[:n, :n] = D * scale * (rows * by_gap)[:, None]
        matrix[np.arange(n), np.arange(n)] -= rows * scale
        matrix[n, :n] = line.weights * scale
        matrix[:n, n] = rows * (by_gap - sign / H**3 if film is None else by_gap * of_kept)
        matrix[n, n] = 0.0 if film is None else 1 / line.reach
        return matrix

    def change(y: Array, dy: Array) -> Array:
        H = fields(y)[2]
        return (fields(y + dy)[2] - H) / H

    problem = Dense(
        residual,
        jacobian,
        fraction=lambda y, dy: 0.7 / max(0.7, -float(change(y, dy).min())),
        step_size=lambda y, dy: float(np.abs(change(y, dy)).max()),
    )
    start = np.append(np.zeros(n), 0.5 if film is None else 0.0)
    root = root_find(problem, start, StepControl(1e-11, chord=0.1))
    if not root.outcome.ok:
        raise RuntimeError(f"film layer with reach = {line.reach:g}, order = {line.order}: {root.outcome.value}")
    g, c, H = fields(root.x)
    q = line.integral(g) + (0.0 if film is None else kept * root.x[n])
    return Layer(line, float(c), 0.0, q, H - base.gap - c)
