"""Newton's iteration for the point contact: damped steps by GMRES, with a preconditioner that is kept while it serves.

Steps are not exact, so that :func:`stribeck.numerics.newton.root_find`, whose chord steps need exact inverses, does not
fit.  Each step chooses how small its linear residual must be, and the stopping test counts both errors, that of the
linearisation and that of GMRES.

Source: [Deuflhard 2011] Newton Methods for Nonlinear Problems, section 2.1.5 (inexact steps); theory.md, the ball.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw, local_decay_length
from stribeck.equations.damping import longest_step
from stribeck.equations.point.preconditioner import BandedModes
from stribeck.equations.point.system import Equations, Linear, Unknowns
from stribeck.numerics.krylov import gmres
from stribeck.quantities.outcome import Outcome

MAX_KRYLOV = 60  # Steps of GMRES for one step of Newton's iteration

REBUILD_AT = 12  # GMRES steps above which the next Newton step has a new preconditioner

REBUILD_AT_NEAR_SOLUTION = 16  # REBUILD_AT near the solution, where few Newton steps are left to gain from it

MAX_BAND = 16  # Band of a new preconditioner if one with a narrower band does not serve

MAX_POOR_STEPS = 4  # Newton steps that a preconditioner of MAX_BAND may leave poorly solved

NEAR_SOLUTION_STEP = 0.03  # Size of a step below which the solution is near

MIN_STEP_FRACTION = 1e-6  # A step damped below this part of Newton's makes no progress

GMRES_RTOL = 3e-2  # Relative error of a Newton step that GMRES may leave

ACCEPTED_RESIDUAL = 0.1  # Error above which a kept preconditioner is given up

MIN_CURVATURE = 3.0  # Factor from the square of a step to the error after it, if no two steps are known to measure it


@dataclass(frozen=True, eq=False)
class Iterated:
    """Where Newton's iteration ended."""

    unknowns: Unknowns  # The last iterate
    outcome: Outcome  # How it ended
    steps: int  # Its cost
    krylov_steps: int  # Its cost
    factorisations: int  # Its cost
    left: float  # Estimated relative error of the gap after the iteration
    preconditioner: Any  # The last one, for neighbours


def step_size(law: ContactLaw, h: Array, dh: Array, load_scale: float = 1.0) -> float:
    """Return the size of a step relative to the length over which the equations bend: the gap, and the decay of contact."""
    size = np.abs(dh) / h
    if np.all(law.decay_length > 0):
        weight = np.minimum(1.0, law.pressure(h) / load_scale)
        size = np.maximum(size, weight * np.abs(dh) / local_decay_length(law, h))
    return float(size.max())


def iterate(
    equations: Equations,
    start: Unknowns,
    tolerance: float,
    band: int,
    kept: BandedModes | None = None,
    max_steps: int = 40,
) -> Iterated:
    """Return the state of the discrete equations nearest to ``start``."""
    y, law = start, equations.law
    preconditioner = kept
    krylov = factorisations = steps = 0
    before = size = math.inf
    left = math.inf
    widened, poor = False, 0

    def ended(outcome: Outcome) -> Iterated:
        return Iterated(y, outcome, steps, krylov, factorisations, left, preconditioner)

    with np.errstate(all="ignore"):
        while steps < max_steps:
            residual, linear = equations.residual(y), Linear(equations, y)
            right = linear.right(residual)
            if not np.isfinite(right).all():
                return ended(Outcome.NOT_FINITE)
            wanted = min(GMRES_RTOL, 0.1 * size) if size < NEAR_SOLUTION_STEP else GMRES_RTOL
            solved = None
            if preconditioner is not None:
                solved = _solved(linear, preconditioner, right, residual[0], wanted, 2 * REBUILD_AT_NEAR_SOLUTION)
                krylov += solved.steps
                if not solved.accepted:
                    solved = None
            if solved is None or preconditioner is None:
                preconditioner = BandedModes(linear, band)
                factorisations += 1
                solved = _solved(linear, preconditioner, right, residual[0], wanted, MAX_KRYLOV)
                krylov += solved.steps
                poor += not solved.accepted
                if widened and poor > MAX_POOR_STEPS:
                    return ended(Outcome.SINGULAR)
                if not solved.accepted and band < min(MAX_BAND, preconditioner.shape[0] - 1):
                    band, widened, preconditioner = MAX_BAND, True, None
                    continue
            if not np.isfinite(solved.x).all():
                return ended(Outcome.SINGULAR)
            step = solved.step
            part = longest_step(law, y.gap, step.gap)
            if not part >= MIN_STEP_FRACTION:
                return ended(Outcome.STALLED)
            before, size = size, step_size(law, y.gap, step.gap)
            if not math.isfinite(size):
                return ended(Outcome.NOT_FINITE)
            y = y.moved(step, part)
            steps += 1
            if part < 1.0:
                size, preconditioner = max(size, 1.0), None
                continue
            bending = max(MIN_CURVATURE, min(100.0, size / before**2)) if math.isfinite(before) else MIN_CURVATURE
            left = bending * size * size + solved.missed
            if left <= tolerance:
                return ended(Outcome.CONVERGED)
            if solved.steps > (REBUILD_AT_NEAR_SOLUTION if size < NEAR_SOLUTION_STEP else REBUILD_AT):
                preconditioner = None
        return ended(Outcome.STEP_LIMIT)


@dataclass(frozen=True, eq=False)
class _Step:
    """A Newton step, the number of GMRES steps it took, and the size of its error in the gap."""

    x: Array
    step: Unknowns
    steps: int
    missed: float
    accepted: bool


def _solved(linear: Linear, preconditioner: BandedModes, right: Array, shape: Array, wanted: float, most: int) -> _Step:
    """Return the Newton step whose gap errs by at most ``wanted`` times its size, if ``most`` GMRES steps suffice."""
    # A small preconditioned residual in the pressure may still be a large one in the gap, where that is stiff against it: the
    # residual of this solution shows it, and gives a further correction.
    law, h = linear.equations.law, linear.y.gap
    x, rest, steps, tolerance = np.zeros_like(right), right, 0, wanted
    while True:
        solved = gmres(linear.product, preconditioner, rest, tolerance, most - steps)
        x, steps = x + solved.x, steps + solved.steps
        rest = right - linear.product(x)
        correction = preconditioner(rest)
        step = linear.changes(x, shape)
        missed, size = step_size(law, h, linear.changes(correction).gap), step_size(law, h, step.gap)
        if not math.isfinite(missed + size):
            return _Step(x, step, steps, math.inf, False)
        if missed <= wanted * size or steps >= most:
            # The correction is accurate to the contraction of GMRES, which is far below one.
            x = x + correction
            return _Step(x, linear.changes(x, shape), steps + 1, 0.1 * missed, missed <= max(wanted, ACCEPTED_RESIDUAL) * size)
        tolerance = max(1e-9, 0.1 * wanted * size / missed)
