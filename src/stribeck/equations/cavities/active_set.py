r"""Films of a ball that break: complementarity at the nodes, by a semismooth Newton iteration.

With :math:`R` the weak residual of Reynolds' equation at a node, d the diagonal of its pressure stiffness and
:math:`p_\mathrm{cav}` the least pressure of the film,

.. math:: \min(p_f - p_\mathrm{cav}, R/d) = 0

Nodes with :math:`R/d > p_f - p_\mathrm{cav}` are cavitated: there :math:`p_f = p_\mathrm{cav}` takes the place of Reynolds'
equation.  Asperities go on to carry load in the cavity.  Where the film may re-form the gas at a node goes on downstream,
and the gas g that makes up for the residual, :math:`R = U g`, takes the place of R.

Source: [Hintermueller, Ito and Kunisch 2002] SIAM J. Optim. 13, 865, for the active sets; numerics.md, the ball.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from stribeck._types import Array, Flags
from stribeck.equations.cavities.capacitance import Capacitance
from stribeck.equations.cavities.system import CavitatedLinear, CavitatedSystem, just_above
from stribeck.equations.damping import longest_step
from stribeck.equations.point.iteration import Iterated, linear_rtol, step_size
from stribeck.equations.point.preconditioner import BandedModes
from stribeck.equations.point.system import LOAD, Unknowns
from stribeck.numerics.krylov import gmres
from stribeck.numerics.settings import (
    BAND,
    GMRES_RTOL,
    HALF_DIGITS,
    MAX_BAND,
    MAX_STEPS,
    NEGLIGIBLE,
    REBUILD_AT,
    SAFETY,
)
from stribeck.quantities.outcome import Outcome


def advect_front(gas: Array, now: Flags, before: Flags, farthest: int) -> Flags:
    """Return the active set after a step, with the film advanced over the nodes that its flow fills."""
    # Behind a rupture line that lies too far upstream one node a step would heal: the flow that ends there is passed on to
    # cavitated neighbours, whose void it fills.
    stays, left, given = before & now, gas.copy(), np.where(before & ~now, gas, 0.0)
    for _ in range(farthest):
        to = np.pad(stays, 1).astype(float)
        share = np.pad(given / np.maximum(to[:-2, 1:-1] + to[2:, 1:-1] + to[1:-1, :-2] + to[1:-1, 2:], 1.0), 1)
        left += share[:-2, 1:-1] + share[2:, 1:-1] + share[1:-1, :-2] + share[1:-1, 2:]
        given = np.where(stays & (left < 0.0), left, 0.0)
        stays &= given == 0.0
    return stays | (now & ~before)


def iterate_cavitated(
    equations: CavitatedSystem,
    start: Unknowns,
    tolerance: float,
    kept: Capacitance | None = None,
    least_part: float = HALF_DIGITS,
) -> Iterated:
    """Return the state of the discrete complementarity problem nearest to ``start``."""
    law, least = equations.law, equations.least
    cavitated = start.fluid <= least
    y = Unknowns(start.gap, np.where(cavitated, least, start.fluid), start.offset)
    band = BAND if kept is None else kept.banded.band
    krylov = factorisations = steps = 0
    size = left = math.inf
    same = near = False

    def now_cavitated(linear: CavitatedLinear, flow: Array) -> Flags:
        gas = linear.passing.gas(flow) * linear.passing.weights
        found = np.asarray(gas / linear.stiffness > y.fluid - least)
        if equations.spread is not None or size > NEGLIGIBLE:
            return found
        return advect_front(gas, found, linear.cavitated, equations.operators.mesh.degree)

    def ended(outcome: Outcome) -> Iterated:
        return Iterated(complementary(y, cavitated, least), outcome, steps, krylov, factorisations, left, kept)

    with np.errstate(all="ignore"):
        residual, linear = equations.residual(y), CavitatedLinear(equations, y, cavitated)
        if kept is not None:  # a neighbour's start is good enough to ask which nodes are cavitated
            cavitated = now_cavitated(linear, residual[1])
            linear.set_active(cavitated)
        while steps < MAX_STEPS:
            right = linear.right(residual)
            if not np.isfinite(right).all():
                return ended(Outcome.NOT_FINITE)
            is_new = kept is None
            if kept is None:
                kept = Capacitance(BandedModes(linear, band), equations.operators.mesh, y.gap.shape)
                factorisations += 1
            wanted = linear_rtol(size, tolerance) if same else GMRES_RTOL
            solved = gmres(linear.product, kept.of(linear), right, wanted, MAX_STEPS)
            krylov += solved.steps
            if not np.isfinite(solved.x).all():
                return ended(Outcome.SINGULAR)
            if solved.left > NEGLIGIBLE and not (is_new and band == MAX_BAND):
                band, kept = MAX_BAND if is_new else band, None
                continue
            step = linear.changes(solved.x, residual[0])
            part = longest_step(law, y.gap, step.gap)
            if not part >= least_part:
                return ended(Outcome.STALLED)
            size = step_size(law, y.gap, step.gap)
            y = y.moved(step, part)
            if part == 1.0:  # what GMRES leaves of a pressure in the cavity would break or heal nodes that hardly flow
                y = replace(y, fluid=np.where(cavitated, least, y.fluid))
            steps += 1
            if solved.steps > REBUILD_AT:
                kept = None
            size = size if part == 1.0 else max(size, 1.0)
            residual = equations.residual(y)
            now = now_cavitated(linear, residual[1])
            same = bool((now == cavitated).all())
            cavitated = now
            # Where a few nodes still break or heal the next step is smaller than this one.
            rest = solved.left if same else SAFETY
            left = SAFETY * size * size + rest * size
            # At slow speed the film pressure is small: a step may be small for the gap and not for the pressure.
            missed = rest * float(np.abs(step.fluid).max() / max(y.fluid.max(), np.finfo(float).tiny))
            near = part == 1.0 and left <= tolerance and missed <= tolerance / NEGLIGIBLE
            if near:
                unbalanced = abs(equations.residual(complementary(y, cavitated, least))[2])
                if unbalanced <= NEGLIGIBLE * tolerance * LOAD:  # friction is read off the load
                    return ended(Outcome.CONVERGED)
                kept = None  # GMRES sees no load with what it was given
            linear = CavitatedLinear(equations, y, cavitated)
        return ended(Outcome.CONVERGED if near else Outcome.STEP_LIMIT)


def complementary(y: Unknowns, cavitated: Flags, least: float) -> Unknowns:
    """Return unknowns whose film has the least pressure where it is cavitated, and only there."""
    return Unknowns(y.gap, np.where(cavitated, least, np.maximum(y.fluid, just_above(least))), y.offset)
