"""Mixed lubrication in the limit of small relative roughness at a fixed fluid number, without elasticity: theory.md Eq. (16).

[BP] Appendix C expands this in the fluid number n to second order; here it is solved.  Neither the edge layers nor the film of
the smooth contact are in it: it holds for n << kappa**(-1/3).

Source: ours, from [BP] Eqs. (thin-film_dl), (contact_pressure_dl), (Hertz); theory.md, section 10.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.documentation import described
from stribeck.asymptotics.formula import Limit, Value, fluid_number, formula
from stribeck.contacts.groups import Groups
from stribeck.numerics.newton import Dense, StepControl, root_find
from stribeck.numerics.panels import reference
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.docstrings import Described
from stribeck.quantities.units import InputError, show

NODES_PER_PANEL = 12  # Gauss points of a panel: contact shares err by 1e-9, down to shares of 1e-5.
PANELS = 32  # Panels of the half-line.
DOMAIN_LENGTH = 30.0  # Where the panels end in artanh(x).

# Fluid number of the first step, over the one at which the first order reaches all of the load.
FIRST_FLUID_NUMBER = 1e-3

LOG_STEP = math.log(3.0)  # Step in the logarithm of the fluid number.

# Fluid number up to which :func:`contact_load_share` answers; above it the film of the inlet is the thicker one by far.
MAX_FLUID_NUMBER = 1e3


@dataclass(frozen=True)
class Wedge(Described):
    """A solution of the limit."""

    x: Annotated[Array, "positions between the edges, shape (n,)", "a"]
    gap: Annotated[Array, "gap H, shape (n,)", "kappa u_Hz"]
    fluid_pressure: Annotated[Array, "fluid pressure, shape (n,)", "p_Hz"]
    flux_gap: Annotated[float, "flux gap H*", "kappa u_Hz"]
    contact_load_share: Annotated[float, "part of the load on asperities", "1"]


@lru_cache(maxsize=256)
@one_blas_thread
@described(
    "Gap, fluid pressure, flux gap, contact share.",
    kind="Wedge",
    raises="If an argument is outside its range, or no solution is reached.",
    fluid_number="Speed group over the square of the relative roughness [-], not negative.",
)
def wedge(load: float, fluid_number: float) -> Wedge:
    """Solve the limit at one load and fluid number."""
    if not 0 < load < 1:
        raise InputError(
            f"load = {show(load)}; nearly smooth static contacts have a positive gap only for loads between 0 and 1."
        )
    if not 0 <= fluid_number < math.inf:
        raise InputError(f"fluid_number = {show(fluid_number)}; it must be a finite number, not negative.")
    x, p_0, weights, integral = _line(load)
    at_rest = -0.5 * math.log(load) - np.log(p_0)
    y = np.append(at_rest, (weights @ at_rest**-2) / (weights @ at_rest**-3))
    first = FIRST_FLUID_NUMBER * float(at_rest.min()) ** 3
    steps = max(0, math.ceil(math.log(fluid_number / first) / LOG_STEP)) if fluid_number > first else 0
    for n in [*np.geomspace(first, fluid_number, steps + 1)[1:]] if steps else [fluid_number]:
        y = _corrected(y, float(n), load, p_0, weights, integral)
    H = y[:-1]
    contact = load**-0.5 * np.exp(-H)
    return Wedge(x, H, p_0 - contact, float(y[-1]), float(2 / math.pi * (weights @ contact)))


@formula(
    plane="mixed",
    limits=(Limit("load", 1e-6, 0.9), Limit("relative_roughness", 0.0, 1e-3), Limit("fluid_number", 0.0, 10.0)),
    undefined="from load 1 and fluid number 1e3 on",
    worst=0.03,
    small="relative_roughness",
    error_order=2 / 3,
    source="ours, from [BP] Eqs. (thin-film_dl), (contact_pressure_dl), (Hertz)",
)
def contact_load_share(groups: Groups) -> Value:
    r"""Return the load share of the asperities in the limit of zero relative roughness at this fluid number.

    .. math:: S = \frac2\pi \int_{-1}^1 F^{-1/2} e^{-H} dx
    """
    lambda_, F, _ = np.broadcast_arrays(groups.speed, groups.load, groups.relative_roughness)
    number = np.where(lambda_ > 0, np.broadcast_to(fluid_number(groups), groups.shape), 0.0)
    states = zip(F.ravel().tolist(), number.ravel().tolist(), strict=True)
    found = [wedge(load, n).contact_load_share if load < 1 and n <= MAX_FLUID_NUMBER else math.nan for load, n in states]
    return np.array(found).reshape(F.shape)[()]


def _line(load: float) -> tuple[Array, Array, Array, Array]:
    """Return positions, Hertz pressure, weights and running integral; see :mod:`slow_contact` for the variable."""
    rule = reference(NODES_PER_PANEL)
    delta = math.acos(math.sqrt(load))
    edges = np.linspace(-1, 1, PANELS + 1) * math.asinh(DOMAIN_LENGTH / delta)
    half = 0.5 * (edges[1] - edges[0])
    v = (edges[:-1, None] + half * (1 + rule.nodes)).ravel()
    u = delta * np.sinh(v)
    p_0 = 1 / np.cosh(u)
    stretch = delta * np.cosh(v) * p_0**2
    whole = np.tile(half * rule.weights, (NODES_PER_PANEL, 1))
    before, inside = np.tri(PANELS, k=-1), np.eye(PANELS)
    from_left = np.kron(before, whole) + np.kron(inside, half * rule.integral)
    to_right = np.kron(before.T, whole) + np.kron(inside, whole - half * rule.integral)
    # From the nearer edge, where the pressures vanish: from the other one rounding would swamp them.
    integral = np.where((v < 0)[:, None], from_left, -to_right)
    return np.tanh(u), p_0, np.tile(half * rule.weights, PANELS) * stretch, integral * stretch


def _corrected(y: Array, n: float, load: float, p_0: Array, weights: Array, integral: Array) -> Array:
    """Return the solution (H, H*) at fluid number n by Newton's iteration from a neighbour's."""

    def residual(y: Array) -> Array:
        H, H_star = y[:-1], y[-1]
        slope = (H - H_star) / H**3
        return np.append((load**-0.5 * np.exp(-H) + n * (integral @ slope)) / p_0 - 1, weights @ slope)

    def jacobian(y: Array) -> Array:
        H, H_star = y[:-1], y[-1]
        by_gap, by_flux = (3 * H_star - 2 * H) / H**4, -(H**-3.0)
        J = np.empty((len(y), len(y)))
        J[:-1, :-1] = n * integral * by_gap / p_0[:, None]
        J[:-1, :-1] -= np.diag(load**-0.5 * np.exp(-H) / p_0)
        J[:-1, -1] = n * (integral @ by_flux) / p_0
        J[-1, :-1], J[-1, -1] = weights * by_gap, weights @ by_flux
        return J

    def admissible(y: Array, dy: Array) -> float:
        # A gap may lose 70 % at a step, and the logarithm of the contact pressure change by 2.
        return float(min(1.0, 0.7 / max(0.7, np.max(-dy / y)), 2.0 / max(2.0, np.abs(dy[:-1]).max())))

    root = root_find(Dense(residual, jacobian, fraction=admissible), y, StepControl(1e-10, max_steps=100))
    if not root.outcome.ok:
        raise InputError(f"load = {load:g}, fluid number = {n:g}: {root.outcome.value}")
    return root.x
