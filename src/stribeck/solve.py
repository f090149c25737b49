"""From groups to a converged solution: start, refinement until the tolerance holds, and what to say where it does not."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np

from . import hertz, reynolds
from ._types import Array
from .contact_laws import contact_law
from .equations import Operators
from .estimate import ErrorEstimate, FineOperators, error_estimate
from .mesh import Mesh, MeshTooLarge
from .newton import Outcome
from .observables import NAMES, Observables, observables
from .parameters import Groups, LineContact
from .solution import Solution, law_notes
from .start import cold_start
from .states import Guess, State, mesh_for, solve_state
from .threads import one_blas_thread
from .units import InputError, show

RTOL_RANGE = (1e-11, 1e-2)
"""Tolerances that may be asked for; below, double precision reaches no state."""

QUASISTATIC_LOAD = 0.01
"""At speed zero the load only shifts the gap: heavier contacts are solved at this load, where all gaps are positive."""

MAX_REFINEMENTS = 12

LEAST_ESTIMATE = 3e-2
"""Part of the tolerance below which no error is stated: estimates so small were not checked."""

LEAST_GAP_TAIL = 0.02
"""Part of the tolerance below which resolving the gap where it is read off alone does not help."""

CLEARLY_FINER = 1.1
"""Ratio of mesh sizes from which the difference of two solutions measures the error of the coarser."""


class SolveError(RuntimeError):
    """A solve that did not reach its tolerance.

    Parameters
    ----------
    outcome : Outcome
        Why.
    solution : Solution or None
        What was reached, with its error estimate, if there is a state.
    message : str
        The sentence shown: the state, the outcome, what was reached.
    """

    def __init__(self, outcome: Outcome, solution: Solution | None, message: str) -> None:
        super().__init__(message)
        self.outcome = outcome
        self.solution = solution


def order_for(rtol: float) -> int:
    """Return the nodes per panel that reach ``rtol`` with the fewest unknowns."""
    return 12 if rtol >= 1e-7 else 16


def mesh_tolerances_for(rtol: float) -> tuple[float, float]:
    """Return the Legendre tails to start refinement with; most states reach ``rtol`` with them at once."""
    return min(1e-2, 0.4 * math.sqrt(rtol)), 0.3 * rtol


@one_blas_thread
def solve(
    problem: Groups | LineContact, *, rtol: float = 1e-6, on_failure: Literal["raise", "return"] = "raise"
) -> Solution:
    r"""Solve one state of the lubricated rough contact, from cold.

    The coupled equations are [BP] Appendix A: contact pressure exponential in the gap, Reynolds' equation, plane-strain
    elasticity, fixed load.

    Parameters
    ----------
    problem : Groups or LineContact
        The state.  Speed zero (quasistatic), roughness zero (smooth) and both (Hertz, closed form) are ordinary inputs.
    rtol : float
        Relative error allowed in every observable, absolute for the load shares; from 1e-11 to 1e-2.
    on_failure : {"raise", "return"}
        What to do where the tolerance was not reached: raise :class:`SolveError` or return what there is, with its outcome.

    Returns
    -------
    Solution
        Fields, observables, outcome and error estimate.

    Raises
    ------
    InputError
        If an argument is outside its range.
    SolveError
        If the solve failed, unless ``on_failure="return"`` and there is a state to return.

    Notes
    -----
    Tested cold over speed 1e-12 to 1e6 and 0, load 1e-8 to 10, relative roughness 1e-6 to 1e3 and 0
    (``tests/test_solve_random.py``).  The error estimate covers the true error in at least 95 % of random states.

    Source: [BP] Appendix A; theory.md Eqs. (1)-(5); numerics.md for the scheme.
    """
    groups, contact = as_groups(problem)
    check_rtol(rtol)
    if on_failure not in ("raise", "return"):
        raise InputError(f"on_failure = {show(on_failure)}; it must be 'raise' or 'return'.")
    if groups.speed == 0 and groups.roughness == 0:
        return hertz_solution(groups, contact, rtol)
    path = cold_start(solvable(groups))
    if not path.outcome.ok:
        raise SolveError(path.outcome, None, f"{describe(groups)}: {path.outcome.value}")
    point = converge(path.states[-1], groups, rtol)
    return finish(point, groups, contact, rtol, on_failure)


def as_groups(problem: Groups | LineContact) -> tuple[Groups, LineContact | None]:
    """Return the scalar groups of a problem and its contact, if it has one."""
    if isinstance(problem, LineContact):
        return problem.groups, problem
    if not isinstance(problem, Groups):
        raise InputError(f"problem = {show(problem)}; it must be a LineContact or Groups(speed, load, roughness).")
    if problem.shape != ():
        raise InputError(f"groups have shape {problem.shape}; solve takes one state, use stribeck_curve for many.")
    return problem, None


def check_rtol(rtol: float) -> None:
    """Refuse a tolerance that is no number or out of range."""
    low, high = RTOL_RANGE
    if isinstance(rtol, bool) or not isinstance(rtol, int | float) or not low <= rtol <= high:
        raise InputError(
            f"rtol = {show(rtol)}; it must be a number from {low:g}, what double precision can give, to {high:g}."
        )


def describe(groups: Groups) -> str:
    """Return the groups in words, for messages."""
    return f"speed {float(groups.speed):.6g}, load {float(groups.load):.6g}, roughness {float(groups.roughness):.6g}"


def solvable(groups: Groups) -> Groups:
    """Return the groups that are solved for: at speed zero the load is lowered until all gaps are positive."""
    if groups.speed > 0 or groups.load <= QUASISTATIC_LOAD:
        return groups
    return Groups(0.0, QUASISTATIC_LOAD, QUASISTATIC_LOAD * groups.relative_roughness)


def quasistatic_shift(groups: Groups) -> float:
    r"""Return by how much the gap of ``groups`` lies above that of :func:`solvable`.

    .. math:: \Delta h = -\frac{\kappa}{2} \ln \frac{\bar F_N}{\bar F_N'}

    Exact at speed zero, where the solution depends on kappa alone but for this shift of gap and offset.
    """
    if solvable(groups) is groups:
        return 0.0
    return -0.5 * float(groups.relative_roughness) * math.log(float(groups.load / solvable(groups).load))


@dataclass(frozen=True, eq=False)
class Point:
    """A refined state of ``groups``, its observables and their errors, and how the refinement ended.

    ``state`` is that of :func:`solvable` groups; ``estimate`` is None where not even a coarse state was found.
    """

    groups: Groups
    state: State | None
    values: Observables | None
    estimate: ErrorEstimate | None
    outcome: Outcome
    tolerances: tuple[float, float] | None = None
    fine: FineOperators | None = None

    @property
    def effort(self) -> float:
        """What :func:`continuation.march` steers by."""
        return 4.0 if self.state is None else self.state.effort


def converge(
    guess: Guess, groups: Groups, rtol: float, tolerances: tuple[float, float] | None = None
) -> Point:
    """Refine a guess until the estimated error is at most ``rtol``, rounding stops it, or the mesh grows too large.

    ``tolerances`` are the Legendre tails to start with, see :func:`states.mesh_for`; the point tells with which it ended.
    """
    base = solvable(groups)
    law = contact_law(base)
    tail, gap_tail = mesh_tolerances_for(rtol) if tolerances is None else tolerances
    best = Point(groups, None, None, None, Outcome.REFINEMENT_LIMIT)
    last: tuple[int, Array] | None = None
    outcome = Outcome.REFINEMENT_LIMIT
    for _ in range(MAX_REFINEMENTS):
        try:
            mesh = mesh_for(guess, base, law, order_for(rtol), tail, gap_tail)
        except MeshTooLarge:
            tail *= 3.0
            continue
        state = solve_state(base, Operators(mesh), guess, newton_tolerance(rtol))
        if not state.outcome.ok:
            outcome = state.outcome
            break
        point = replace(judge(state, groups, FineOperators(mesh), rtol), tolerances=(tail, gap_tail))
        assert point.estimate is not None and point.values is not None
        if last is not None and mesh.size >= CLEARLY_FINER * last[0]:
            estimate = point.estimate.at_most(np.abs(point.values.array() - last[1]))
            point = replace(point, estimate=estimate, outcome=reached(estimate, rtol))
        last = mesh.size, point.values.array()
        if point.outcome.ok:
            return point
        if best.estimate is None or point.estimate.total < best.estimate.total:
            best = point
        if point.estimate.total <= 3 * point.estimate.floor:
            break
        tail *= shrink(math.sqrt(rtol / (point.estimate.at_nodes + 1e-300)))
        between = shrink(rtol / (point.estimate.between_nodes + 1e-300))
        if gap_tail * between >= LEAST_GAP_TAIL * rtol:
            gap_tail *= between
        else:
            tail *= between
        guess = state
    if best.estimate is not None and best.estimate.floor > 0.3 * rtol:
        outcome = Outcome.ROUNDING
    return replace(best, outcome=outcome)


def shrink(excess: float) -> float:
    """Return the factor for a mesh tolerance whose error exceeds what is allowed by 1/``excess``."""
    return 1.0 if excess > 2 else min(0.5, max(0.3, 0.5 * excess))


def judge(state: State, groups: Groups, fine: FineOperators, rtol: float) -> Point:
    """Return the state with its observables and their errors; it counts as converged if these are at most ``rtol``."""
    values = values_of(state, groups)
    estimate = error_estimate(state, values, fine)
    return Point(groups, state, values, estimate, reached(estimate, rtol), fine=fine)


def reached(estimate: ErrorEstimate, rtol: float) -> Outcome:
    """Return whether an estimate holds the tolerance."""
    return Outcome.CONVERGED if estimate.total <= rtol else Outcome.REFINEMENT_LIMIT


def newton_tolerance(rtol: float) -> float:
    """Return the size of the last Newton step: what is left after it is far below ``rtol``."""
    return max(1e-11, 1e-2 * rtol)


def values_of(state: State, groups: Groups) -> Observables:
    """Return the observables of ``groups`` from the state solved for it."""
    values = observables(state.equations, state.y, float(groups.load))
    if solvable(groups) is groups:
        return values
    shift = quasistatic_shift(groups)
    gap = state.gap + shift
    return replace(
        values,
        central_gap=values.central_gap + shift,
        minimum_gap=values.minimum_gap + shift,
        offset=values.offset + shift,
        flux_gap=reynolds.flux_gap(gap, state.mesh.weights) if gap.min() > 0 else math.nan,
    )


def finish(
    point: Point, groups: Groups, contact: LineContact | None, rtol: float, on_failure: str = "raise"
) -> Solution:
    """Return the solution that a refined state is, or raise what its outcome asks for."""
    solution = solution_of(point, contact, rtol)
    if solution is not None and (point.outcome.ok or on_failure == "return"):
        return solution
    reached = "" if solution is None else f" Reached: {solution.error_estimate:.1e}, asked: {rtol:.1e}."
    raise SolveError(point.outcome, solution, f"{describe(groups)}: {point.outcome.value}{reached}")


def solution_of(point: Point, contact: LineContact | None, rtol: float) -> Solution | None:
    """Return the solution that a refined state is, or None where there is no state."""
    state, values, estimate = point.state, point.values, point.estimate
    if state is None or values is None or estimate is None:
        return None
    notes = list(law_notes(point.groups, contact, values))
    if math.isnan(values.flux_gap):
        notes.append("The gap is negative, so that no fluid passes: there is no flux gap.")
    if estimate.floor > 0.1 * rtol:
        notes.append(f"Rounding in double precision bounds the relative error of this state at {estimate.floor:.1e}.")
    return Solution(
        groups=point.groups,
        contact=contact,
        outcome=point.outcome,
        notes=tuple(notes),
        rtol=rtol,
        law=state.equations.law.name,
        observables=values,
        relative_errors=np.maximum(estimate.relative, LEAST_ESTIMATE * rtol),
        rounding_floor=estimate.floor,
        mesh=state.mesh,
        nodal_gap=state.gap,
        gap_shift=quasistatic_shift(point.groups),
        nodal_pressures=partial(state.equations.pressures, state.y),
        newton_steps=state.root.steps,
    )


def hertz_solution(groups: Groups, contact: LineContact | None, rtol: float) -> Solution:
    """Return the closed form of the dry, smooth contact on a mesh graded towards its edges."""
    towards_edge = 1 - 0.5 ** np.arange(1, 45)
    beyond_edge = 1 + 0.5 ** np.arange(1, 45)
    positive = np.concatenate([towards_edge, [1.0], beyond_edge[::-1], [2.0, 4.0, 8.0, 16.0]])
    mesh = Mesh(np.concatenate([-positive[::-1], [0.0], positive]), order_for(rtol))
    values = Observables(
        contact_load_share=1.0,
        fluid_load_share=0.0,
        central_gap=0.0,
        minimum_gap=0.0,
        minimum_position=0.0,
        flux_gap=0.0,
        offset=hertz.OFFSET,
        viscous_paper=0.0,
        viscous_balanced=0.0,
    )
    return Solution(
        groups=groups,
        contact=contact,
        outcome=Outcome.CONVERGED,
        notes=("Speed and roughness are zero: the dry contact of Hertz, in closed form.",),
        rtol=rtol,
        law="dry contact",
        observables=values,
        relative_errors=np.full(len(NAMES), float(np.finfo(float).eps)),
        rounding_floor=0.0,
        mesh=mesh,
        nodal_gap=hertz.gap(mesh.nodes),
        gap_shift=0.0,
        nodal_pressures=partial(_dry_pressures, mesh),
    )


def _dry_pressures(mesh: Mesh) -> tuple[Array, Array]:
    return hertz.pressure(mesh.nodes), np.zeros(mesh.size)
