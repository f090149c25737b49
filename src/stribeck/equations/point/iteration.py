"""Newton's iteration for the point contact: damped steps by GMRES, with a preconditioner that is kept while it serves.

Steps are not exact, so that :func:`stribeck.numerics.newton.root_find`, whose chord steps need exact inverses, does not
fit.  Each step chooses how small its linear residual must be, and the stopping test counts both errors, that of the
linearisation and that of GMRES.

Source: [Deuflhard 2011] Newton Methods for Nonlinear Problems, section 2.1.5 (inexact steps); theory.md, the ball.
"""

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
from stribeck.numerics.settings import (
    BAND,
    GMRES_RTOL,
    HALF_DIGITS,
    MAX_STEPS,
    NEGLIGIBLE,
    SAFETY,
)
from stribeck.quantities.outcome import Outcome


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


def linear_rtol(size: float, tolerance: float) -> float:
    """Return the relative error of a Newton step that GMRES may leave, by the size of the step before."""
    # The step after this one is of second order in it, and no error far below the tolerance counts.
    return min(GMRES_RTOL, NEGLIGIBLE * max(size, tolerance / size))


def iterate(
    equations: Equations, start: Unknowns, tolerance: float, kept: BandedModes | None = None, least_part: float = HALF_DIGITS
) -> Iterated:
    """Return the state of the discrete equations nearest to ``start``; it stalls where less than a part of a step is safe."""
    y, law, preconditioner, band = start, equations.law, kept, BAND if kept is None else kept.band
    krylov = factorisations = steps = 0
    size = left = math.inf

    def ended(outcome: Outcome) -> Iterated:
        return Iterated(y, outcome, steps, krylov, factorisations, left, preconditioner)

    with np.errstate(all="ignore"):
        while steps < MAX_STEPS:
            residual, linear = equations.residual(y), Linear(equations, y)
            right = linear.right(residual)
            if not np.isfinite(right).all():
                return ended(Outcome.NOT_FINITE)
            is_new = preconditioner is None
            if preconditioner is None:
                preconditioner = BandedModes(linear, band)
                factorisations += 1
            solved = _solved(linear, preconditioner, right, residual[0], linear_rtol(size, tolerance))
            krylov += solved.steps
            if not solved.accepted:
                wider = preconditioner.wider_band if is_new else band
                if wider is None:
                    return ended(Outcome.SINGULAR)
                band, preconditioner = wider, None
                continue
            step = solved.step
            part = longest_step(law, y.gap, step.gap)
            if not part >= least_part:
                return ended(Outcome.STALLED)
            before, size = size, step_size(law, y.gap, step.gap)
            y = y.moved(step, part)
            steps += 1
            if part < 1.0:
                size, preconditioner = max(size, 1.0), None
                continue
            bending = max(1.0, size / before**2)
            left = SAFETY * bending * size * size + solved.missed
            if left <= tolerance:
                return ended(Outcome.CONVERGED)
        return ended(Outcome.STEP_LIMIT)


@dataclass(frozen=True, eq=False)
class _Step:
    """A Newton step, the number of GMRES steps it took, and the size of its error in the gap."""

    x: Array
    step: Unknowns
    steps: int
    missed: float
    accepted: bool


def _solved(linear: Linear, preconditioner: BandedModes, right: Array, shape: Array, wanted: float) -> _Step:
    """Return the Newton step whose gap errs by at most ``wanted`` times its size, if the GMRES steps suffice."""
    # A small preconditioned residual in the pressure may still be a large one in the gap, where that is stiff against it: the
    # residual of this solution shows it, and gives a further correction.
    law, h = linear.equations.law, linear.y.gap
    x, rest, steps, tolerance = np.zeros_like(right), right, 0, wanted
    while True:
        solved = gmres(linear.product, preconditioner, rest, tolerance, MAX_STEPS - steps)
        x, steps = x + solved.x, steps + solved.steps
        rest = right - linear.product(x)
        correction = preconditioner(rest)
        step = linear.changes(x, shape)
        missed, size = step_size(law, h, linear.changes(correction).gap), step_size(law, h, step.gap)
        if not math.isfinite(missed + size):
            return _Step(x, step, steps, math.inf, False)
        if missed <= wanted * size or steps >= MAX_STEPS:
            # The correction is accurate to the contraction of GMRES, which is far below one.
            x = x + correction
            accepted = missed <= max(wanted, NEGLIGIBLE) * size
            return _Step(x, linear.changes(x, shape), steps + 1, NEGLIGIBLE * missed, accepted)
        tolerance = max(HALF_DIGITS, NEGLIGIBLE * wanted * size / missed)
