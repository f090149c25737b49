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
from stribeck.equations.cavities.capacitance import Capacitance, Preconditioner
from stribeck.equations.cavities.system import CavitatedLinear, CavitatedSystem, just_above
from stribeck.equations.damping import longest_step
from stribeck.equations.point.iteration import MIN_STEP_FRACTION, Iterated, step_size
from stribeck.equations.point.preconditioner import BandedModes
from stribeck.equations.point.system import LOAD, Unknowns
from stribeck.numerics.krylov import gmres
from stribeck.quantities.outcome import Outcome

MAX_STEPS = 40  # Most Newton steps

MAX_KRYLOV_STEPS = 60  # Most GMRES steps of a Newton step

GMRES_RTOL = 1e-3  # Relative error of a step that GMRES may leave; less near the solution

GMRES_RTOL_ACTIVE_SET = 3e-2  # Relative error of a step that GMRES may leave while the active set changes

LOAD_RTOL_FACTOR = 5e-3  # Relative error of the load over the tolerance of the gap: friction is read off the load

# Tolerance of the gap up to which load and film pressure are held to their factors: states of a larger one serve to compare
# meshes, and a load that misses less would cost steps for nothing.
STRICT_RTOL = 1e-6

CONTRACTION_ACTIVE_SET = 2.0  # Remaining error over the size of the last step if the active set changed in that step

# Relative residual of the film pressure that GMRES may leave over the tolerance of the gap, up to STRICT_RTOL: slow films
# carry little, and a mesh for comparison would show their flow worse than it is.
PRESSURE_RTOL_FACTOR = 10.0

MAX_CORRECTIONS = 3  # Corrections by the last Jacobian of a state that is converged but for its load

MAX_CORRECTION_RESIDUAL = 0.3  # Relative residual that GMRES may leave in such a correction

MAX_FRONT_NODES = 10  # Most nodes that the rupture line may move downstream in one step

FRONT_STEP = 0.1  # Largest relative step of the gap after which the rupture line moves by more than one node

REBUILD_PRECONDITIONER_AT = 4.0  # GMRES steps per digit above which the next Newton step has a new preconditioner

REFACTOR_AT = 2.0  # GMRES steps per digit above which the capacitance matrix of a neighbouring state is factorised again


def advect_front(gas: Array, now: Flags, before: Flags) -> Flags:
    """Return the active set after a step, with the film advanced over the nodes that its flow fills."""
    # Behind a rupture line that lies too far upstream one node a step would heal: the flow that ends there is passed on to
    # cavitated neighbours, whose void it fills.
    stays, left, given = before & now, gas.copy(), np.where(before & ~now, gas, 0.0)
    for _ in range(MAX_FRONT_NODES):
        if not given.any():
            break
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
    band: int,
    kept: Capacitance | None = None,
    max_steps: int = MAX_STEPS,
) -> Iterated:
    """Return the state of the discrete complementarity problem nearest to ``start``."""
    law, least = equations.law, equations.least
    cavitated = start.fluid <= least
    y = Unknowns(start.gap, np.where(cavitated, least, start.fluid), start.offset)
    krylov = factorisations = steps = 0
    left, size, same, near = math.inf, math.inf, False, False
    before = None if kept is None else kept.last

    def now_cavitated(linear: CavitatedLinear, flow: Array) -> Flags:
        gas = linear.passing.gas(flow) * linear.passing.weights
        found = np.asarray(gas / linear.stiffness > y.fluid - least)
        return advect_front(gas, found, linear.cavitated) if size <= FRONT_STEP and equations.spread is None else found

    def ended(outcome: Outcome) -> Iterated:
        return Iterated(complementary(y, cavitated, least), outcome, steps, krylov, factorisations, left, kept)

    with np.errstate(all="ignore"):
        residual, linear = equations.residual(y), CavitatedLinear(equations, y, cavitated)
        if kept is not None:  # a neighbour's start is good enough to ask which nodes are cavitated
            cavitated = now_cavitated(linear, residual[1])
            linear.set_active(cavitated)
        while steps < max_steps:
            right = linear.right(residual)
            if not np.isfinite(right).all():
                return ended(Outcome.NOT_FINITE)
            if kept is None:
                kept = Capacitance(BandedModes(linear, band), equations.operators.mesh, y.gap.shape)
                factorisations += 1
            wanted = GMRES_RTOL_ACTIVE_SET
            if same:
                wanted = min(
                    GMRES_RTOL_ACTIVE_SET, max(GMRES_RTOL * min(1.0, size / GMRES_RTOL_ACTIVE_SET), 0.3 * tolerance / size)
                )
            precondition = kept.of(linear)
            solved = gmres(linear.product, precondition, right, wanted, MAX_KRYLOV_STEPS)
            krylov += solved.steps
            if not np.isfinite(solved.x).all():
                return ended(Outcome.SINGULAR)
            step = linear.changes(solved.x, residual[0])
            part = longest_step(law, y.gap, step.gap)
            if not part >= MIN_STEP_FRACTION:
                return ended(Outcome.STALLED)
            size = step_size(law, y.gap, step.gap)
            y = y.moved(step, part)
            if part == 1.0:  # what GMRES leaves of a pressure in the cavity would break or heal nodes that hardly flow
                y = replace(y, fluid=np.where(cavitated, least, y.fluid))
            steps += 1
            if solved.steps > -REBUILD_PRECONDITIONER_AT * math.log10(wanted):
                kept = None
            elif kept.last is before and solved.steps > -REFACTOR_AT * math.log10(wanted):
                kept.last = None
            size = size if part == 1.0 else max(size, 1.0)
            residual = equations.residual(y)
            now = now_cavitated(linear, residual[1])
            same = bool((now == cavitated).all())
            cavitated = now
            # Where a few nodes still break or heal the next step is smaller than this one.
            rest = solved.left if same else CONTRACTION_ACTIVE_SET
            left = 3.0 * size * size + rest * size
            # At slow speed the film pressure is small: a step may be small for the gap and not for the pressure.
            missed = rest * float(np.abs(step.fluid).max() / max(y.fluid.max(), np.finfo(float).tiny))
            near = part == 1.0 and left <= tolerance and missed <= PRESSURE_RTOL_FACTOR * min(tolerance, STRICT_RTOL)
            if near:
                least_load = LOAD_RTOL_FACTOR * tolerance * max(1.0, tolerance / STRICT_RTOL) * LOAD
                y, residual, more = balanced(linear, precondition, complementary(y, cavitated, least), least_load)
                krylov += more
                if abs(residual[2]) <= least_load:
                    return ended(Outcome.CONVERGED)
                if kept is not None:  # GMRES sees no load with what it was given
                    kept.last = None
            linear = CavitatedLinear(equations, y, cavitated)
        return ended(Outcome.CONVERGED if near else Outcome.STEP_LIMIT)


def complementary(y: Unknowns, cavitated: Flags, least: float) -> Unknowns:
    """Return unknowns whose film has the least pressure where it is cavitated, and only there."""
    return Unknowns(y.gap, np.where(cavitated, least, np.maximum(y.fluid, just_above(least))), y.offset)


def balanced(
    linear: CavitatedLinear, precondition: Preconditioner, y: Unknowns, unbalanced: float
) -> tuple[Unknowns, tuple[Array, Array, float], int]:
    """Return complementary unknowns whose load error is at most ``unbalanced``, their residual, and the steps taken."""
    # The corrections are those of the last Jacobian, as the active set stays the same.
    equations, cavitated, steps = linear.equations, y.fluid <= linear.least, 0
    residual = equations.residual(y)
    for _ in range(MAX_CORRECTIONS):
        if not abs(residual[2]) > unbalanced:
            break
        wanted = max(GMRES_RTOL, min(MAX_CORRECTION_RESIDUAL, 0.3 * unbalanced / abs(residual[2])))
        solved = gmres(linear.product, precondition, linear.sources(residual, 0.0), wanted, MAX_KRYLOV_STEPS)
        steps += solved.steps
        y = complementary(y.moved(linear.changes(solved.x, residual[0]), 1.0), cavitated, linear.least)
        residual = equations.residual(y)
    return y, residual, steps
