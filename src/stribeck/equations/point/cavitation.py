r"""The film of a ball that ends at ambient pressure: complementarity at the nodes, by a semismooth Newton iteration.

With :math:`R` the weak residual of Reynolds' equation at a node and d the diagonal of its pressure stiffness,

.. math:: \min(p_f, R/d) = 0

Nodes with :math:`R/d > p_f` are torn: there :math:`p_f = 0` takes the place of Reynolds' equation.  Asperities go on to carry
load in the cavity.  The film ruptures along one line and does not form anew, so that mass is conserved.

The preconditioner is the banded one of the full film, with a capacitance matrix of the torn nodes: with :math:`Z = P^{-1} E`,
E their unit residuals, and C the rows :math:`p_f` of these nodes, :math:`x = P^{-1} f + Z \mu` with
:math:`C Z \mu = f_E - C P^{-1} f`.

Far from the contact the pressure is :math:`g(\theta) \, r/h^2` and ruptures along :math:`x = |y|/3`; load and deflection of
what lies beyond the rim are that of this law.

Source: [Hintermueller, Ito and Kunisch 2002] SIAM J. Optim. 13, 865, for the active sets; numerics.md, the ball.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import partial
from typing import ClassVar

import numpy as np
import numpy.typing as npt
from scipy.linalg import lu_factor, lu_solve

from stribeck._types import Array, Flags, Indices
from stribeck.contacts.cut_off import CAVITATED, FarFilm
from stribeck.equations.damping import longest_step
from stribeck.equations.point.far_field import particular
from stribeck.equations.point.iteration import SMALLEST_PART, Iterated, step_size
from stribeck.equations.point.preconditioner import BandedModes
from stribeck.equations.point.system import Equations, Linear, Unknowns
from stribeck.equations.point.wake import shear_missing
from stribeck.numerics.fourier_panels import PolarMesh, lobatto, radau
from stribeck.numerics.krylov import gmres
from stribeck.quantities.outcome import Outcome

Single = npt.NDArray[np.float32]

MOST_STEPS = 40
"""Steps after which the iteration is given up."""

MOST_KRYLOV = 60
"""Steps of GMRES for one of these."""

LINEAR = 1e-3
"""Relative error of a step that GMRES may leave; less near the solution."""

FEW = 0.15
"""Nodes that break or heal, over those that the factors of the capacitance matrix are for, up to which these serve."""

FLUID = 10.0
"""Part of the film pressure that GMRES may leave over that of the gap."""

WORN = 12
"""Steps of GMRES from which the next step makes its own preconditioner."""


@dataclass(frozen=True, eq=False)
class CavitatedEquations(Equations):
    """The discretised problem of a film that ends at ambient pressure."""

    far: ClassVar[FarFilm] = CAVITATED
    least: ClassVar[float] = 0.0

    @property
    def load_row(self) -> Array:
        """Weights of the load on the axisymmetric mode, with what lies beyond the rim, shape (rings,)."""
        row = self.operators.load_row.copy()
        row[-1] += 2.0 * math.pi * self.operators.mesh.rim**2
        return row

    def deflect(self, by_mode: Array) -> Array:
        """Return the deflection by mode; beyond the rim all modes fall as r**-3."""
        found = self.operators.deflect(by_mode)
        beyond = self.operators.deflection_from_beyond * by_mode[:, -1:]
        beyond[1] = 0.0  # that of mode one is in the operator
        return np.asarray(found + beyond)

    def rim_slope(self, p: Array, offset: float) -> Array:
        """Return the radial derivative of the film pressure at the rim: it falls as that of the full film."""
        return self.rim_rates(offset) @ p

    def rim_rates(self, offset: float) -> Array:
        """Return the derivative of :meth:`rim_slope` by the pressure, shape (angles, angles)."""
        mesh = self.operators.mesh
        first, slope = particular(np.array([mesh.rim]), offset, 1.0, bulge=self.operators.bulge)
        return np.eye(mesh.modes) * float(slope[0] / first[0])

    def shear_missing(self, y: Unknowns) -> Array:
        """Return by how much the shear over h on each ring is less for the dry streaks of the wake, shape (rings,)."""
        return shear_missing(self.operators.mesh, y.gap, y.fluid, partial(self.film.sheared, self.speed))


def stiffness(linear: Linear) -> Array:
    """Return the diagonal of the pressure stiffness at the nodes, shape (modes, rings)."""
    mesh = linear.equations.operators.mesh
    squares = np.tile(lobatto(mesh.degree).derivative ** 2, (mesh.panels, 1, 1))
    squares[0] = radau(mesh.degree).derivative ** 2
    radial = np.matmul((linear.film.radial_of_pressure / mesh.stretch**2)[:, :, None, :], squares)[:, :, 0, :]
    return np.asarray(mesh.gathered(radial) + (mesh.angular_derivative**2).T @ linear.film.angular_of_pressure)


class TornLinear(Linear):
    """The Jacobian at a state with torn nodes; rows of R_2 at the nodes, over the stiffness."""

    def __init__(self, equations: Equations, y: Unknowns, torn: Flags) -> None:
        super().__init__(equations, y)
        self.stiffness, self.torn = stiffness(self), torn

    def product(self, x: Array) -> Array:
        """Return the change of the rows at the nodes and of the load."""
        change = self.changes(x)
        rows = np.where(self.torn, change.fluid, self.flow(change.fluid, change.gap) / self.stiffness)
        return np.append(rows.ravel(), self.equations.load_row @ x[: self.equations.operators.mesh.rings])

    def right(self, residual: tuple[Array, Array, float]) -> Array:
        """Return the right-hand side of the step."""
        shape, flow, load = residual
        moved = self.flow(self.contact_slope * shape, -shape)
        rows = np.where(self.torn, -self.y.fluid - self.contact_slope * shape, -(flow + moved) / self.stiffness)
        return np.append(rows.ravel(), -load)


@dataclass(eq=False)
class Capacitance:
    """The preconditioner of the full film, and what unit residuals at nodes do by it, kept per node."""

    banded: BandedModes
    mesh: PolarMesh
    shape: tuple[int, int]
    nodes: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    answers: Single = field(default_factory=lambda: np.zeros((0, 0), dtype=np.float32))
    """Z: changes of total pressure by mode and of the offset, shape (size + 1, nodes)."""
    totals: Single = field(default_factory=lambda: np.zeros((0, 0), dtype=np.float32))
    gaps: Single = field(default_factory=lambda: np.zeros((0, 0), dtype=np.float32))
    """The same at the nodes of the mesh, shape (size, nodes)."""
    last: _Factors | None = None

    def include(self, linear: TornLinear) -> None:
        """Add the torn nodes that are new."""
        new = np.setdiff1d(np.flatnonzero(linear.torn), self.nodes)
        if new.size == 0:
            return
        mesh, size = self.mesh, self.mesh.size
        unit = np.zeros((mesh.modes, mesh.rings, new.size), dtype=np.float32)
        angle, ring = np.divmod(new, mesh.rings)
        unit[:, ring, np.arange(new.size)] = mesh.cosines[angle].T
        right = np.zeros((size + 1, new.size))
        right[:-1] = unit.reshape(size, -1)
        found = self.banded(right)
        by_mode = found[:-1].reshape(mesh.modes, mesh.rings, -1)
        deflected = np.matmul(linear.equations.operators.deflection, by_mode).reshape(mesh.modes, -1)
        total = (mesh.cosines @ by_mode.reshape(mesh.modes, -1)).reshape(size, -1)
        gap = (mesh.cosines @ deflected).reshape(size, -1) + found[-1]
        parts = [each.astype(np.float32) for each in (found, total, gap)]
        if self.nodes.size:
            old = (self.answers, self.totals, self.gaps)
            parts = [np.hstack(pair) for pair in zip(old, parts, strict=True)]
        self.answers, self.totals, self.gaps = parts
        self.nodes = np.append(self.nodes, new)

    def block(self, linear: TornLinear, rows: Indices, columns: Indices) -> Array:
        """Return C Z, the film pressures of torn nodes under unit residuals; both are places among the kept nodes."""
        at = self.nodes[rows]
        found, slope = self.totals[np.ix_(at, columns)], linear.contact_slope.ravel()[at]
        touching = np.flatnonzero(slope)
        found[touching] -= slope[touching, None].astype(np.float32) * self.gaps[np.ix_(at[touching], columns)]
        return np.asarray(found)

    def of(self, linear: TornLinear) -> _Preconditioner:
        """Return the preconditioner of a Jacobian, by the factors of the last one where few other nodes are torn."""
        self.include(linear)
        torn = linear.torn.ravel()[self.nodes]
        if self.last is not None:
            before = np.zeros(torn.size, dtype=bool)
            before[self.last.columns] = True
            if (before != torn).sum() <= FEW * self.last.columns.size:
                return _Preconditioner(self, linear, self.last, np.flatnonzero(torn & ~before), np.flatnonzero(before & ~torn))
        self.last = _Factors(np.flatnonzero(torn), None)
        if self.last.columns.size:
            square = self.block(linear, self.last.columns, self.last.columns)
            self.last = _Factors(self.last.columns, lu_factor(square, overwrite_a=True, check_finite=False))
        nothing = np.zeros(0, dtype=np.intp)
        return _Preconditioner(self, linear, self.last, nothing, nothing)


@dataclass(frozen=True, eq=False)
class _Factors:
    """Factors of the capacitance matrix of some of the kept nodes."""

    columns: Indices
    factors: tuple[Array, npt.NDArray[np.int32]] | None

    def solve(self, right: Array) -> Array:
        """Return what unit residuals do away with film pressures at these nodes."""
        if self.factors is None:
            return right
        return np.asarray(lu_solve(self.factors, right.astype(np.float32), check_finite=False))


class _Preconditioner:
    """About the inverse of a Jacobian with torn nodes.

    Nodes that are torn, or torn no more, since the factors were made border these: the first have residuals beside those of
    the factors, for the second these vanish.
    """

    def __init__(self, kept: Capacitance, linear: TornLinear, base: _Factors, added: Indices, removed: Indices) -> None:
        self.kept, self.linear, self.base = kept, linear, base
        self.columns = np.concatenate([base.columns, added])
        self.at, self.added = kept.nodes[self.columns], added.size
        self.corner: tuple[Array, npt.NDArray[np.int32]] | None = None
        if added.size + removed.size:
            self.place = np.flatnonzero(np.isin(base.columns, removed))
            units = np.zeros((base.columns.size, removed.size), dtype=np.float32)
            units[self.place, np.arange(removed.size)] = 1.0
            self.border = base.solve(np.hstack([-kept.block(linear, base.columns, added), units]))
            self.rows = kept.block(linear, added, self.columns)
            corner = self._bordered(self.border)
            corner[: added.size, : added.size] += self.rows[:, base.columns.size :]
            self.corner = lu_factor(corner, check_finite=False)

    def _bordered(self, old: Array) -> Array:
        """Return what residuals at the nodes of the factors do to the conditions of those that border them."""
        return np.concatenate([self.rows[:, : self.base.columns.size] @ old, old[self.place]])

    def __call__(self, right: Array) -> Array:
        linear, mesh = self.linear, self.kept.mesh
        rows = np.where(linear.torn, 0.0, right[:-1].reshape(linear.torn.shape) * linear.stiffness)
        x = self.kept.banded(np.append((mesh.cosines.T @ rows).ravel(), right[-1]))
        if not self.at.size:
            return x
        missing = right[self.at] - linear.changes(x).fluid.ravel()[self.at]
        old = self.base.solve(missing[: self.base.columns.size])
        new = missing[self.base.columns.size :]
        if self.corner is not None:
            conditions = -self._bordered(old)
            conditions[: self.added] += new
            found = lu_solve(self.corner, conditions, check_finite=False)
            old, new = old + self.border @ found, found[: self.added]
        residuals = np.zeros(self.kept.nodes.size, dtype=np.float32)
        residuals[self.columns] = np.concatenate([old, new])
        return np.asarray(x + self.kept.answers @ residuals)


def iterate_cavitated(
    equations: CavitatedEquations,
    start: Unknowns,
    tolerance: float,
    band: int,
    kept: Capacitance | None = None,
    max_steps: int = MOST_STEPS,
) -> Iterated:
    """Return the state of the discrete complementarity problem nearest to ``start``.

    Parameters
    ----------
    equations : CavitatedEquations
        The discretised problem.
    start : Unknowns
        First iterate; nodes without a positive film pressure are torn at first.
    tolerance : float
        Relative error of the gap that the iteration may leave.
    band : int
        Band of the preconditioner of the full film.
    kept : Capacitance, optional
        Preconditioner of a neighbour on the same mesh.
    max_steps : int
        Largest number of steps.

    Returns
    -------
    Iterated
        A failure is returned in its outcome.  The film pressure is zero at torn nodes, and only there.
    """
    law = equations.law
    torn = start.fluid <= 0.0
    y = Unknowns(start.gap, np.where(torn, 0.0, np.maximum(start.fluid, 0.0)), start.offset)
    krylov = factorisations = steps = 0
    left, size = math.inf, math.inf
    if kept is not None:  # a neighbour's start is good enough to ask which nodes are torn
        torn = equations.flow(y.gap, y.fluid, y.offset) / stiffness(Linear(equations, y)) > y.fluid

    def ended(outcome: Outcome) -> Iterated:
        fluid = np.where(torn, 0.0, np.maximum(y.fluid, np.finfo(float).tiny))
        there = Unknowns(y.gap, fluid, y.offset)
        return Iterated(there, outcome, steps, krylov, factorisations, left, kept)

    with np.errstate(all="ignore"):
        while steps < max_steps:
            linear = TornLinear(equations, y, torn)
            residual = equations.residual(y)
            right = linear.right(residual)
            if not np.isfinite(right).all():
                return ended(Outcome.NOT_FINITE)
            if kept is None:
                kept = Capacitance(BandedModes(linear, band), equations.operators.mesh, y.gap.shape)
                factorisations += 1
            wanted = min(LINEAR, 0.1 * size)
            solved = gmres(linear.product, kept.of(linear), right, max(wanted, 0.1 * tolerance), MOST_KRYLOV)
            krylov += solved.steps
            if not np.isfinite(solved.x).all():
                return ended(Outcome.SINGULAR)
            step = linear.changes(solved.x, residual[0])
            part = longest_step(law, y.gap, step.gap)
            if not part >= SMALLEST_PART:
                return ended(Outcome.STALLED)
            size = step_size(law, y.gap, step.gap)
            y = y.moved(step, part)
            steps += 1
            if solved.steps > WORN:
                kept = None
            flow = equations.flow(y.gap, y.fluid, y.offset)
            now = flow / linear.stiffness > y.fluid
            same = bool((now == torn).all())
            torn = now
            if part < 1.0:
                size = max(size, 1.0)
                continue
            left = 3.0 * size * size + solved.left * size
            # Slow, the film pressure is small, and a step that is small for the gap may not be so for it.
            missed = solved.left * float(np.abs(step.fluid).max() / max(y.fluid.max(), np.finfo(float).tiny))
            if same and left <= tolerance and missed <= FLUID * tolerance:
                return ended(Outcome.CONVERGED)
        return ended(Outcome.STEP_LIMIT)
