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
from typing import Any

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
    answers: list[Single] = field(default_factory=list)
    """Z: changes of total pressure by mode and of the offset, shape (size + 1, nodes), a few nodes at a time."""
    responses: Single = field(default_factory=lambda: np.zeros((2, 0, 0), dtype=np.float32))
    """Total pressure and gap of Z at the kept nodes, shape (2, nodes, nodes)."""
    linear: CavitatedLinear | None = None
    """The Jacobian that it is about the inverse of."""
    columns: Indices = field(init=False)
    """Cavitated nodes of that, as places among the kept ones."""
    factors: tuple[Any, ...] = field(init=False)

    def include(self, linear: CavitatedLinear) -> None:
        """Add the cavitated nodes that are new."""
        new, old = np.setdiff1d(np.flatnonzero(linear.cavitated), self.nodes), self.nodes.size
        if new.size == 0:
            return
        self.nodes = np.append(self.nodes, new)
        # A ring of nodes at a time: their arrays stay in the cache.
        self.answers += [self._answers(linear, new[at : at + self.mesh.rings]) for at in range(0, new.size, self.mesh.rings)]
        kept, self.responses = self.responses, np.empty((2, self.nodes.size, self.nodes.size), dtype=np.float32)
        self.responses[:, :old, :old] = kept
        deflection, column = linear.equations.operators.deflection.astype(np.float32), 0
        for each in self.answers:
            first, columns = (old if column < old else 0), slice(column, column := column + each.shape[1])
            self.responses[:, first:, columns] = self._at(self.nodes[first:], each, deflection)

    def _answers(self, linear: CavitatedLinear, new: Indices) -> Single:
        """Return the responses to unit residuals at some nodes."""
        mesh, size = self.mesh, self.mesh.size
        own = (np.ones(new.size), new, np.arange(new.size + 1))
        unit = (csc_matrix(own, shape=(size, new.size)) if linear.spread is None else linear.spread[:, new]).tocoo()
        angle, ring = np.divmod(unit.row, mesh.rings)
        waves, modes = mesh.cosines[angle].T * unit.data, np.arange(mesh.modes)[:, None]
        right: Single = np.zeros((size + 1, new.size), dtype=np.float32)
        np.add.at(right, (modes * mesh.rings + ring, unit.col), waves.astype(np.float32))
        return np.asarray(self.banded(right))

    def _at(self, nodes: Indices, answers: Single, deflection: Single) -> Single:
        """Return total pressure and gap of some responses at nodes, shape (2, nodes, responses)."""
        mesh, cosines = self.mesh, self.mesh.cosines.astype(np.float32)
        by_mode, (angle, ring) = answers[:-1].reshape(mesh.modes, mesh.rings, -1), np.divmod(nodes, mesh.rings)
        found = np.empty((2, nodes.size, answers.shape[1]), dtype=np.float32)
        rings = np.unique(ring)
        deflected = np.matmul(deflection[:, rings], by_mode)
        for at, each in enumerate(rings):
            here = np.flatnonzero(ring == each)
            waves = cosines[angle[here]]
            found[0, here], found[1, here] = waves @ by_mode[:, each], waves @ deflected[:, at] + answers[-1]
        return found

    def block(self, linear: CavitatedLinear, among: Indices) -> Array:
        """Return C Z, the film pressures of cavitated nodes under unit residuals; these are places among the kept nodes."""
        total, gap = self.responses
        found, slope = total[np.ix_(among, among)], linear.contact_slope.ravel()[self.nodes[among]]
        touching = np.flatnonzero(slope)
        found[touching] -= slope[touching, None].astype(np.float32) * gap[np.ix_(among[touching], among)]
        return np.asarray(found)

    def of(self, linear: CavitatedLinear) -> Capacitance:
        """Return the preconditioner of a Jacobian: the last one, where GMRES has few nodes to learn that broke or healed."""
        if self.linear is None or (self.linear.cavitated != linear.cavitated).sum() > REBUILD_AT:
            self.include(linear)
            self.linear = linear
            self.columns = np.flatnonzero(linear.cavitated.ravel()[self.nodes])
            if self.columns.size:
                self.factors = lu_factor(self.block(linear, self.columns), overwrite_a=True, check_finite=False)
        return self

    def __call__(self, right: Array) -> Array:
        """Return about what the inverse of the Jacobian makes of a right-hand side."""
        linear, at = self.linear, self.nodes[self.columns]
        assert linear is not None
        rows = np.where(linear.cavitated, 0.0, right[:-1].reshape(self.shape) * linear.stiffness)
        x = self.banded(np.append((self.mesh.cosines.T @ rows).ravel(), right[-1]))
        if not at.size:
            return np.asarray(x)
        missing = right[at] - linear.changes(x).fluid.ravel()[at]
        residuals = np.zeros(self.nodes.size, dtype=np.float32)
        residuals[self.columns] = lapack.sgetrs(*self.factors, missing)[0]
        for each in self.answers:
            x += each @ residuals[: each.shape[1]]
            residuals = residuals[each.shape[1] :]
        return np.asarray(x)


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
            wider = kept.banded.wider_band if is_new else band
            if solved.left > NEGLIGIBLE and wider is not None:
                band, kept = wider, None
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
