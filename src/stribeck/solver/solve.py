"""From groups to a converged solution: start, refinement until the tolerance holds, and the message if it does not."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from numbers import Real
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contact_laws.scaled import law_of
from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Groups
from stribeck.contacts.model import BASE_MODEL, Model
from stribeck.contacts.with_parts import with_parts
from stribeck.equations.error_estimate import SAFETY
from stribeck.equations.observables import Observables, drag_parts
from stribeck.equations.state import THINNEST, State
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.panels import Mesh
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import NAMES
from stribeck.quantities.units import InputError, show
from stribeck.solids import hertz
from stribeck.solids.half_plane import HalfPlane
from stribeck.solver.at_rest import with_positive_gap
from stribeck.solver.base_solution import BaseSolution
from stribeck.solver.cavities.cavity_length import ruptured
from stribeck.solver.cold_start import first_paths
from stribeck.solver.homotopy import is_lost_to_rounding
from stribeck.solver.notes import cavitation_notes, fluid_notes, law_notes, shape_notes
from stribeck.solver.refinement import RefinedState, converge, order_for
from stribeck.solver.solution import Solution

if TYPE_CHECKING:
    from stribeck.contacts.line import LineContact
    from stribeck.contacts.point import PointContact
    from stribeck.solver.point.solution import PointSolution

RTOL_RANGE = (1e-11, 1e-2)
"""Smallest and largest tolerance; double precision reaches none below."""

PROFILE_TAIL = 10.0
"""Legendre tail left in the logarithm of the gap between the nodes of a single solution, in units of its tolerance."""

COARSER = (1e-2, 1e-3, 1e-4, 1e-5)
"""Tolerances on the way to one that cannot be reached at once."""

CLOSING = (0.25, 0.1, 0.03, 0.01)
"""Parts of what longer cavities take from the largest suction that the asked one takes, from which its change is told."""

NEWTON_FAILED = (Outcome.STEP_LIMIT, Outcome.SINGULAR, Outcome.NOT_FINITE, Outcome.STALLED)
"""How Newton's iteration may end but by a solution."""

MIN_ESTIMATE = 0.03
"""Smallest stated error over the tolerance, as smaller estimates are not reliable."""

MIN_ESTIMATE_OF_OTHERS = 0.2
"""The same for films that end, other fluids, flow factors and solids, whose kinks finer nodes see only in part."""

TOO_THIN = (
    "Double precision does not hold this state: on the way to it the film falls below {:.1e} of the Hertz indentation, and "
    "gaps are known to about 4e-15 of that. No value was reached; ask for a larger speed or roughness."
)

SPIKED = 2.5
"""Pressure coefficient times Hertz pressure above which films were seen whose pressure rises to a spike."""

SURE_ESTIMATE = 1e-10
"""Error above which estimates are reliable at smaller tolerances too."""


TESTED = {"speed": (1e-12, 1e6), "load": (1e-8, 10.0), "relative_roughness": (1e-6, 1e3)}
"""Range in which every state is solved (``tests/test_solve_random.py``), speed and roughness zero too; beyond, many are."""


class SolveError(RuntimeError):
    """The solver did not reach the tolerance.

    Parameters
    ----------
    outcome : Outcome
        Why.
    solution : Solution, PointSolution or None
        What was reached, with its error estimate, if there is a state.
    message : str
        The message: the state, the outcome, the accuracy reached.
    """

    def __init__(self, outcome: Outcome, solution: BaseSolution | None, message: str) -> None:
        super().__init__(message)
        self.outcome = outcome
        self.solution = solution


@overload
def solve(
    problem: LineContact,
    *,
    rtol: float = ...,
    law: str | AsperityLaw | None = ...,
    on_failure: Literal["raise", "return"] = ...,
    **parts: Any,
) -> Solution: ...


@overload
def solve(
    problem: PointContact,
    *,
    rtol: float = ...,
    law: str | AsperityLaw | None = ...,
    on_failure: Literal["raise", "return"] = ...,
    **parts: Any,
) -> PointSolution: ...


@overload
def solve(
    problem: Groups | Contact,
    *,
    rtol: float = ...,
    law: str | AsperityLaw | None = ...,
    on_failure: Literal["raise", "return"] = ...,
    **parts: Any,
) -> Any: ...


@one_blas_thread
def solve(
    problem: Groups | Contact,
    *,
    rtol: float = 1e-6,
    law: str | AsperityLaw | None = None,
    on_failure: Literal["raise", "return"] = "raise",
    **parts: Any,
) -> Any:
    r"""Solve one state of the lubricated rough contact, from cold.

    The coupled equations are [BP] Appendix A: contact pressure by the contact law, Reynolds' equation, plane-strain
    elasticity, fixed load.

    Parameters
    ----------
    problem : Groups, LineContact or PointContact
        The state, of a cylinder or of a ball.  Speed zero (at rest), roughness zero (smooth) and both (Hertz, closed form) are
        ordinary inputs.
    rtol : float
        Relative error allowed in every observable, absolute for the load shares; from 1e-11 to 1e-2, for a ball from 1e-8
        and without its minimum film, which has an error of its own.
    law : str or AsperityLaw, optional
        Contact law: an object such as :class:`stribeck.GreenwoodWilliamson`, or the name of one that needs no parameters; that
        of the problem if omitted, by default the exponential law.
    on_failure : {"raise", "return"}
        What to do if the tolerance is not reached: raise :class:`SolveError`, or return the state with its outcome.
    **parts
        ``fluid``, ``cavitation``, ``cavity_pressure``, ``flow_factors``, ``solid`` and ``slide_to_roll`` as in
        :class:`stribeck.LineContact`, instead of those of the problem; with groups in Hertz units, see fluids.md.

    Returns
    -------
    Solution or PointSolution
        Fields, observables, outcome and error estimate, under the same names; that of a ball is a
        :class:`stribeck.PointSolution`.

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
    problem = with_law(problem, law)
    groups, contact = as_groups(with_parts(problem, **parts) if parts else problem)
    rtol = check_rtol(rtol)
    if not isinstance(on_failure, str) or on_failure not in ("raise", "return"):
        raise InputError(f"on_failure = {show(on_failure)}; it must be 'raise' or 'return'.")
    return SOLVERS[groups.geometry](groups, contact, rtol, on_failure)


def _line(groups: Groups, contact: Contact | None, rtol: float, on_failure: str) -> Solution:
    """Return the state of a line contact."""
    if groups.is_hertzian:
        if not isinstance(groups.model.solid, HalfPlane):
            raise InputError(
                f"speed and roughness are zero on a {groups.model.solid.name}: the dry contact of smooth surfaces is known in "
                "closed form on the half-plane alone; give a small speed or roughness."
            )
        return hertz_solution(groups, contact, rtol)
    return finish(solved_point(groups, rtol), groups, contact, rtol, on_failure)


def _point(groups: Groups, contact: Contact | None, rtol: float, on_failure: str) -> PointSolution:
    """Return the state of a point contact."""
    from stribeck.solver.point.solution import finish_point
    from stribeck.solver.point.solve import solve_cold

    return finish_point(solve_cold(groups, rtol), contact, on_failure)


SOLVERS: dict[str, Callable[[Groups, Contact | None, float, str], Any]] = {"line": _line, "point": _point}
"""How one state is solved from cold, by geometry."""


def solved_point(groups: Groups, rtol: float) -> RefinedState:
    """Return the refined state of ``groups`` from cold; raise if no path leads there."""
    far = untested(groups)
    # Near the limits of double precision a guess may overflow: Newton's iteration refuses it, which gives the outcome.
    with np.errstate(all="ignore") if far else nullcontext():
        try:
            base = groups if groups.speed > 0 else with_positive_gap(groups)[0]
        except InputError:  # its roughness leaves the range of groups
            raise SolveError(Outcome.PATH_LOST, None, f"{describe(groups)}: {Outcome.PATH_LOST.value}{far}") from None
        if base.model.cavitation is Cavitation.REFORM:
            return _reforming(base, rtol)
        return _refined(base, groups, rtol, far)


def _refined(base: Groups, groups: Groups, rtol: float, far: str) -> RefinedState:
    """Return the refined state of ``groups`` from the cold start of ``base``; raise if no path leads there."""
    point, outcome, thinnest = None, Outcome.PATH_LOST, math.inf
    for path in first_paths(base):
        if not path.outcome.ok:
            outcome = path.outcome
            if is_lost_to_rounding(path):
                thinnest = min(thinnest, float(path.states[-1].gap.min()))
            continue
        point = _converged(path.states[-1], groups, rtol)
        if not _not_reached(point):
            return point
    if point is None and thinnest < math.inf:
        raise SolveError(Outcome.ROUNDING, None, f"{describe(groups)}: {TOO_THIN.format(thinnest)}{far}")
    if point is None:
        raise SolveError(outcome, None, f"{describe(groups)}: {outcome.value}{spiked(groups)}{far}")
    return point


def _not_reached(point: RefinedState) -> bool:
    """Return whether Newton's iteration failed on a mesh that the state asked for; a coarser one may have a solution."""
    return point.state is None or point.outcome in NEWTON_FAILED


def _converged(start: State, groups: Groups, rtol: float) -> RefinedState:
    """Return the refined state of ``groups`` from a coarse one, by larger tolerances if need be."""
    guess = start
    point = best = converge(guess, groups, rtol, profile_tolerance=PROFILE_TAIL * rtol)
    for coarse in COARSER:
        wanted = _not_reached(point) or (point.outcome is Outcome.ROUNDING and coarse < _error(best))
        if coarse > rtol and wanted and (found := converge(guess, groups, coarse)).state is not None:
            guess = found.state if _not_reached(point) else guess
            best = found if _error(found) < _error(best) else best
    if guess is not start:
        point = converge(guess, groups, rtol, profile_tolerance=PROFILE_TAIL * rtol)
    is_rounding = point.outcome is Outcome.ROUNDING or (best.state is not None and float(best.state.gap.min()) < THINNEST)
    # Rounding grows with the nodes: where it is what is left, a coarse mesh may know more.
    return replace(best, outcome=Outcome.ROUNDING) if is_rounding and _error(best) < _error(point) else point


def _error(point: RefinedState) -> float:
    """Return the stated error of a state; infinite without one."""
    return math.inf if point.estimate is None else point.estimate.total


def _reforming(groups: Groups, rtol: float) -> RefinedState:
    """Return the state of a film that may form anew: the full film if its pressure stays above that of the cavity.

    A cavity at ambient pressure reaches to infinity.
    """
    model, far = groups.model, untested(groups)
    if model.cavity_pressure == 0.0:
        ending = replace(groups, model=replace(model, cavitation=Cavitation.EXIT))
        return replace(_refined(ending, ending, rtol, far), groups=groups)
    full = replace(groups, model=replace(model, cavitation=Cavitation.NONE, cavity_pressure=0.0))
    point = _refined(full, full, rtol, far)
    if point.state is None:
        return replace(point, groups=groups)
    if point.state.lowest_pressure >= model.cavity_pressure:
        return replace(point, groups=groups)
    found = _ruptured(groups, point.state, rtol)
    if found is None or not found.outcome.ok:
        found = _closing(groups, point, rtol)
    return _refined(groups, groups, rtol, far) if found is None else found


def _ruptured(groups: Groups, full: State, rtol: float) -> RefinedState | None:
    """Return the state of a film with a cavity, from that of its full film; None if there is no first one."""
    guess = ruptured(groups, full)
    return None if guess is None else _converged(guess, groups, rtol)


def _closing(groups: Groups, full: RefinedState, rtol: float) -> RefinedState | None:
    """Return the full film with the observables of one whose cavity is too short for a mesh; None if these are not known.

    What a short cavity changes is in proportion to what it takes from the largest suction: two longer ones tell it, and how
    well.
    """
    if full.state is None or full.values is None or full.estimate is None:
        return None
    deepest = full.state.lowest_pressure
    taken = 1.0 - groups.model.cavity_pressure / deepest
    here, told, errors = full.values.array(), list[Array](), full.estimate.discretisation
    for part in CLOSING:
        if taken >= part:
            break
        longer = replace(groups, model=replace(groups.model, cavity_pressure=deepest * (1.0 - taken / part)))
        known = _ruptured(longer, full.state, rtol)
        if known is None or known.values is None or known.estimate is None or not known.outcome.ok:
            continue
        told.append(part * (known.values.array() - here))
        if len(told) == 2:
            changed = here + told[0]
            missed = SAFETY * np.abs(told[1] - told[0])
            estimate = replace(full.estimate, discretisation=errors + missed)
            if not estimate.total <= rtol:
                return None
            values = replace(full.values, **dict(zip(NAMES, changed.tolist(), strict=True)))
            return replace(full, groups=groups, values=values, estimate=estimate)
    return None


def with_law(problem: Groups | Contact, law: str | AsperityLaw | None) -> Groups | Contact:
    """Return the problem with another contact law, unless none is given."""
    if law is None or not isinstance(problem, Groups | Contact):
        return problem
    return replace(problem, law=law_of(law)) if isinstance(problem, Groups) else problem.replace(law=law)


def as_groups(problem: Groups | Contact) -> tuple[Groups, Contact | None]:
    """Return the scalar groups of a problem and its contact, if it has one."""
    if isinstance(problem, Contact):
        return problem.groups, problem
    if not isinstance(problem, Groups):
        raise InputError(
            f"problem = {show(problem)}; it must be a LineContact, PointContact or Groups(speed, load, roughness)."
        )
    if problem.shape != ():
        raise InputError(f"groups have shape {problem.shape}; solve takes one state, use stribeck_curve for many.")
    return problem, None


def check_rtol(rtol: Any) -> float:
    """Return a tolerance, a number of any type, as a float; refuse what is no number or out of range."""
    low, high = RTOL_RANGE
    is_real = isinstance(rtol, Real) and not isinstance(rtol, bool)
    if not is_real or not low <= rtol <= high:
        raise InputError(f"rtol = {show(rtol)}; it must be a number from {low:g}, the limit of double precision, to {high:g}.")
    return float(rtol)


def describe(groups: Groups) -> str:
    """Return the groups in words, for messages."""
    return f"speed {float(groups.speed):.6g}, load {float(groups.load):.6g}, roughness {float(groups.roughness):.6g}"


def untested(groups: Groups) -> str:
    """Return a sentence on groups outside the tested range, to end a message of failure; empty for others."""
    outside = []
    for name, (low, high) in TESTED.items():
        value = float(getattr(groups, name))
        if value != 0 and not low <= value <= high:
            outside.append(f"{name.replace('_', ' ')} {value:.4g} (tested: {low:g} to {high:g})")
    return f" The solver has not been tested for {', '.join(outside)}; check the inputs." if outside else ""


def spiked(groups: Groups) -> str:
    """Return a sentence on the pressure spike of a fluid that stiffens much, to end a message of failure; empty for others."""
    a = groups.model.film.parameters.get("pressure_coefficient", 0.0)
    if not isinstance(a, float) or a <= SPIKED:
        return ""
    return (
        f" Pressure coefficient times Hertz pressure is {a:.2g}: the pressure of a thick film rises to a spike there, as in "
        "hard elastohydrodynamics, and without bound above 4.4 in a full film or above 5.2 in one that ends, earlier in a "
        "fluid that stiffens faster than exponentially. Thinner films, at lower speed, have none."
    )


def finish(point: RefinedState, groups: Groups, contact: Contact | None, rtol: float, on_failure: str = "raise") -> Solution:
    """Return a refined state as a solution, or raise the error of its outcome."""
    solution = solution_of(point, contact, rtol)
    if solution is not None and (point.outcome.ok or on_failure == "return"):
        return solution
    reached = "" if solution is None else f" Achieved: {solution.error_estimate:.1e}, requested: {rtol:.1e}."
    raise SolveError(
        point.outcome, solution, f"{describe(groups)}: {point.outcome.value}{reached}{spiked(groups)}{untested(groups)}"
    )


def minimum_estimate(rtol: float, model: Model) -> float:
    """Return the smallest stated error for a tolerance, with the model of the article or another."""
    least = MIN_ESTIMATE if model == BASE_MODEL else MIN_ESTIMATE_OF_OTHERS
    return max(least * rtol, min(SURE_ESTIMATE, 0.3 * rtol))


def stated_errors(point: RefinedState, rtol: float) -> Array:
    """Return the stated error of each observable of a state, relative to it, absolute for the load shares."""
    assert point.values is not None and point.estimate is not None
    counted = np.maximum(point.estimate.relative, minimum_estimate(rtol, point.groups.model))
    return np.asarray(counted / drag_parts(point.values.array(in_article=False))[: len(counted)])


def solution_of(point: RefinedState, contact: Contact | None, rtol: float) -> Solution | None:
    """Return a refined state as a solution, or None if there is no state."""
    state, values, estimate = point.state, point.values, point.estimate
    if state is None or values is None or estimate is None:
        return None
    return Solution(
        groups=point.groups,
        contact=contact,
        outcome=point.outcome,
        notes=state_notes(point.groups, contact, values, lambda: state, estimate.floor, rtol),
        rtol=rtol,
        law=state.equations.law.name,
        observables=values,
        relative_errors=stated_errors(point, rtol),
        minimum_position_error=estimate.minimum_position,
        rounding_floor=estimate.floor,
        mesh=state.mesh,
        nodal_gap=state.gap,
        gap_shift=with_positive_gap(point.groups)[1],
        nodal_pressures=partial(state.equations.pressures, state.y),
        origin=(state.exit, state.dilation),
        newton_steps=state.root.steps,
    )


def state_notes(
    groups: Groups,
    contact: Contact | None,
    values: Observables,
    state: Callable[[], State],
    floor: float,
    rtol: float,
) -> tuple[str, ...]:
    """Return the notes on a state; ``state()`` is called for its pressures only, ``floor`` is the error by rounding."""
    notes = [*shape_notes(contact), *law_notes(groups, contact, values)]
    if groups.speed > 0 and (contact is not None or groups.model != BASE_MODEL):
        solved = state()
        fluid = solved.equations.pressures(solved.y)[1]
        notes += [] if contact is None else cavitation_notes(contact, fluid)
        if not solved.equations.operators.is_base_model:
            notes += fluid_notes(solved.equations.film, solved.gap, fluid, solved.flux_gap)
    if math.isnan(values.flux_gap):
        notes.append("The gap is negative, so no fluid passes and there is no flux gap.")
    if floor > 0.1 * rtol:
        notes.append(f"Rounding in double precision limits the relative error of this state to {floor:.1e}.")
    return tuple(notes)


def hertz_solution(groups: Groups, contact: Contact | None, rtol: float) -> Solution:
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
        viscous_published=0.0,
        viscous_balanced=0.0,
    )
    return Solution(
        groups=groups,
        contact=contact,
        outcome=Outcome.CONVERGED,
        notes=("Speed and roughness are zero: dry Hertz contact, in closed form.",),
        rtol=rtol,
        law="dry contact",
        observables=values,
        relative_errors=np.full(len(NAMES), float(np.finfo(float).eps)),
        minimum_position_error=1.0,
        rounding_floor=0.0,
        mesh=mesh,
        nodal_gap=hertz.gap(mesh.nodes),
        gap_shift=0.0,
        nodal_pressures=partial(_dry_pressures, mesh),
    )


def _dry_pressures(mesh: Mesh) -> tuple[Array, Array]:
    return hertz.pressure(mesh.nodes), np.zeros(mesh.size)
