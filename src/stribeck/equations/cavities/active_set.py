r"""Films of a ball that break: complementarity at the nodes, by a semismooth Newton iteration.

With :math:`R` the weak residual of Reynolds' equation at a node, d the diagonal of its pressure stiffness and
:math:`p_\mathrm{cav}` the least pressure of the film,

.. math:: \min(p_f - p_\mathrm{cav}, R/d) = 0

Nodes with :math:`R/d > p_f - p_\mathrm{cav}` are cavitated: there :math:`p_f = p_\mathrm{cav}` takes the place of Reynolds'
equation.  Asperities go on to carry load in the cavity.  Where the film may re-form the gas at a node goes on downstream,
and the gas g that makes up for the residual, :math:`R = U g`, takes the place of R.

Source: [Hintermueller, Ito and Kunisch 2002] SIAM J. Optim. 13, 865, for the active sets; numerics.md, the ball.

The preconditioner of the full film is banded; a capacitance matrix of the cavitated nodes is added: with
:math:`Z = P^{-1} E`, E the residuals of unit gas at each, and C the rows :math:`p_f` of these nodes,
:math:`x = P^{-1} f + Z \mu` with :math:`C Z \mu = f_E - C P^{-1} f`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt
from scipy.linalg import lapack, lu_factor
from scipy.sparse import csc_matrix

from stribeck._types import Array, Flags, Indices
from stribeck.equations.cavities.system import CavitatedLinear, CavitatedSystem, just_above
from stribeck.equations.damping import longest_step
from stribeck.equations.point.iteration import Iterated, linear_rtol, step_size
from stribeck.equations.point.preconditioner import BandedModes
from stribeck.equations.point.system import LOAD, Unknowns
from stribeck.numerics.fourier_panels import PolarMesh
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

Single = npt.NDArray[np.float32]


@dataclass(eq=False)
class Capacitance:
    """The preconditioner of the full film, and its response to unit residuals at nodes, kept per node."""

    banded: BandedModes
    mesh: PolarMesh
    shape: tuple[int, int]
    nodes: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    answers: Single = field(init=False)
    """Z: changes of total pressure by mode and of the offset, shape (size + 1, nodes)."""
    totals: Single = field(init=False)
    gaps: Single = field(init=False)
    """Z at the nodes of the mesh: total pressure and gap, shape (size, nodes)."""
    last: Preconditioner | None = None

    def __post_init__(self) -> None:
        """Begin without nodes."""
        self.answers, self.totals, self.gaps = (np.zeros((self.mesh.size + last, 0), dtype=np.float32) for last in (1, 0, 0))

    def include(self, linear: CavitatedLinear) -> None:
        """Add the cavitated nodes that are new."""
        new = np.setdiff1d(np.flatnonzero(linear.cavitated), self.nodes)
        if new.size == 0:
            return
        self.nodes = np.append(self.nodes, new)
        # A ring of nodes at a time: their arrays stay in the cache.
        parts = [self._answers(linear, new[at : at + self.mesh.rings]) for at in range(0, new.size, self.mesh.rings)]
        kept = (self.answers, self.totals, self.gaps)
        self.answers, self.totals, self.gaps = (np.hstack(each) for each in zip(kept, *parts, strict=True))

    def _answers(self, linear: CavitatedLinear, new: Indices) -> tuple[Single, Single, Single]:
        """Return the responses to unit residuals at some nodes: by mode, and of total pressure and gap at all nodes."""
        mesh, size = self.mesh, self.mesh.size
        own = (np.ones(new.size), new, np.arange(new.size + 1))
        unit = (csc_matrix(own, shape=(size, new.size)) if linear.spread is None else linear.spread[:, new]).tocoo()
        angle, ring = np.divmod(unit.row, mesh.rings)
        waves, modes = mesh.cosines[angle].T * unit.data, np.arange(mesh.modes)[:, None]
        right: Single = np.zeros((size + 1, new.size), dtype=np.float32)
        np.add.at(right, (modes * mesh.rings + ring, unit.col), waves.astype(np.float32))
        found = self.banded(right)
        by_mode, cosines = found[:-1].reshape(mesh.modes, mesh.rings, -1), mesh.cosines.astype(np.float32)
        deflected = np.matmul(linear.equations.operators.deflection.astype(np.float32), by_mode)
        total = (cosines @ by_mode.reshape(mesh.modes, -1)).reshape(size, -1)
        gap = (cosines @ deflected.reshape(mesh.modes, -1)).reshape(size, -1) + found[-1]
        return found, total, gap

    def block(self, linear: CavitatedLinear, rows: Indices, columns: Indices) -> Array:
        """Return C Z, the film pressures of cavitated nodes under unit residuals; both are places among the kept nodes."""
        at = self.nodes[rows]
        found, slope = self.totals[np.ix_(at, columns)], linear.contact_slope.ravel()[at]
        touching = np.flatnonzero(slope)
        found[touching] -= slope[touching, None].astype(np.float32) * self.gaps[np.ix_(at[touching], columns)]
        return np.asarray(found)

    def of(self, linear: CavitatedLinear) -> Preconditioner:
        """Return the preconditioner of a Jacobian: the last one, where GMRES has few nodes to learn that broke or healed."""
        last = self.last
        if last is None or (last.cavitated != linear.cavitated).sum() > REBUILD_AT:
            self.include(linear)
            self.last = last = Preconditioner(self, linear)
        return last


class Preconditioner:
    """An approximate inverse of a Jacobian with cavitated nodes."""

    def __init__(self, kept: Capacitance, linear: CavitatedLinear) -> None:
        self.kept, self.linear, self.cavitated = kept, linear, linear.cavitated
        self.columns = np.flatnonzero(linear.cavitated.ravel()[kept.nodes])
        self.at = kept.nodes[self.columns]
        if self.at.size:
            square = kept.block(linear, self.columns, self.columns)
            self.factors = lu_factor(square, overwrite_a=True, check_finite=False)

    def __call__(self, right: Array) -> Array:
        """Return about what the inverse of the Jacobian makes of a right-hand side."""
        linear, mesh = self.linear, self.kept.mesh
        rows = np.where(linear.cavitated, 0.0, right[:-1].reshape(linear.cavitated.shape) * linear.stiffness)
        x = self.kept.banded(np.append((mesh.cosines.T @ rows).ravel(), right[-1]))
        if not self.at.size:
            return np.asarray(x)
        missing = right[self.at] - linear.changes(x).fluid.ravel()[self.at]
        residuals = np.zeros(self.kept.nodes.size, dtype=np.float32)
        residuals[self.columns] = lapack.sgetrs(*self.factors, missing)[0]
        return np.asarray(x + self.kept.answers @ residuals)


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
