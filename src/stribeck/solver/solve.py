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
from stribeck.contacts.groups import BASE_MODEL, Groups, Model
from stribeck.contacts.notes import cavitation_notes, fluid_notes, law_notes, pocket_notes, shape_notes
from stribeck.contacts.with_parts import with_parts
from stribeck.equations.observables import ROW, Observables, drag_parts
from stribeck.equations.state import State
from stribeck.fluids.fluid import Cavitation
from stribeck.numerics.continuation import StepPath
from stribeck.numerics.panels import Mesh
from stribeck.numerics.settings import MAX_RTOL, MIN_RTOL, NEGLIGIBLE, SAFETY
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.units import InputError, show
from stribeck.solids import hertz
from stribeck.solids.half_plane import HalfPlane
from stribeck.solver.at_rest import with_positive_gap
from stribeck.solver.cold_start import first_path, is_lost_to_rounding, path_to_cavity
from stribeck.solver.refinement import RefinedState, converge, order_for
from stribeck.solver.solution import Solution
from stribeck.solver.solve_error import SolveError, describe

if TYPE_CHECKING:
    from stribeck.contacts.geometries import LineContact, PointContact
    from stribeck.solver.point.solution import PointSolution

TOO_THIN = (
    "Double precision does not hold this state: on the way to it the film falls below {:.1e} of the Hertz indentation, and "
    "gaps are known to about 4e-15 of that. No value was reached; ask for a larger speed or roughness."
)

# Ranges in which every state is solved (test_solve_random.py), speed and roughness zero too; many are outside.
TESTED_RANGES = {"speed": (1e-12, 1e6), "load": (1e-8, 10.0), "relative_roughness": (1e-6, 1e3)}


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
        (less than 1e-4 in a film that ends, or 2e-3 in one that re-forms, counts as that) and without its minimum film, which
        has an error of its own.
    law : str or AsperityLaw, optional
        Contact law: an object such as :class:`stribeck.contact_laws.GreenwoodWilliamson`, or the name of one that needs no
        parameters; that of the problem if omitted, by default the exponential law.
    on_failure : {"raise", "return"}
        What to do if the tolerance is not reached: raise :class:`SolveError`, or return the state with its outcome.
    **parts
        ``fluid``, ``cavitation``, ``cavity_pressure``, ``flow_factors``, ``solid``, ``profile`` and ``slide_to_roll`` as in
        :class:`stribeck.LineContact`, instead of those of the problem; with groups in Hertz units, see fluids.md.

    Returns
    -------
    Solution or PointSolution
        Fields, observables, outcome and error estimate, under the same names; that of a ball is a
        :class:`stribeck.results.PointSolution`.

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


def _solve_line(groups: Groups, contact: Contact | None, rtol: float, on_failure: str) -> Solution:
    """Return the state of a line contact."""
    if groups.is_hertzian:
        solid, profile = groups.model.solid, groups.model.profile
        if not (isinstance(solid, HalfPlane) and profile.is_parabola):
            under = "" if profile.is_parabola else f" under {profile.name}"
            raise InputError(
                f"speed and roughness are zero on a {solid.name}{under}: the dry contact of smooth surfaces is known in "
                "closed form of a cylinder on the half-plane alone; give a small speed or roughness."
            )
        return hertz_solution(groups, contact, rtol)
    return finish(solved_point(groups, rtol), groups, contact, rtol, on_failure)


def _solve_point(groups: Groups, contact: Contact | None, rtol: float, on_failure: str) -> PointSolution:
    """Return the state of a point contact."""
    # Here, as the solver of balls loads scipy.sparse, which a cylinder does not need (test_solve_loads_no_more_than_it_needs)
    from stribeck.solver.point.solution import finish_point
    from stribeck.solver.point.solve import solve_cold

    return finish_point(solve_cold(groups, rtol), contact, on_failure)


# How one state is solved from cold, by geometry.
SOLVERS: dict[str, Callable[[Groups, Contact | None, float, str], Any]] = {"line": _solve_line, "point": _solve_point}


def solved_point(groups: Groups, rtol: float) -> RefinedState:
    """Return the refined state of ``groups`` from cold; raise if no path leads there."""
    far = untested_note(groups)
    # Near the limits of double precision a guess may overflow: Newton's iteration refuses it, which gives the outcome.
    with np.errstate(all="ignore") if far else nullcontext():
        try:
            base = groups if groups.speed > 0 else with_positive_gap(groups)[0]
        except InputError:  # its roughness leaves the range of groups
            raise SolveError(Outcome.PATH_LOST, None, f"{describe(groups)}: {Outcome.PATH_LOST.value}{far}") from None
        if base.model.cavitation is Cavitation.REFORM:
            return _solve_reforming(base, rtol)
        return _solve_by_path(first_path(base), groups, rtol)


def _solve_by_path(path: StepPath[State], groups: Groups, rtol: float) -> RefinedState:
    """Return the refined state of ``groups`` from the end of a path from cold; raise if it does not arrive."""
    if path.outcome.ok:
        return _refined(path.states[-1], groups, rtol)
    far = untested_note(groups)
    if is_lost_to_rounding(path):
        thinnest = float(path.states[-1].gap.min())
        raise SolveError(Outcome.ROUNDING, None, f"{describe(groups)}: {TOO_THIN.format(thinnest)}{far}")
    raise SolveError(path.outcome, None, f"{describe(groups)}: {path.outcome.value}{spike_note(groups)}{far}")


def _refined(start: State, groups: Groups, rtol: float) -> RefinedState:
    """Return the refined state of ``groups`` from a coarse one."""
    return converge(start, groups, rtol, profile_tolerance=rtol / NEGLIGIBLE)


def _solve_reforming(groups: Groups, rtol: float) -> RefinedState:
    """Return the full film if its pressure stays above the cavity pressure, else the film with a cavity."""
    model, base = groups.model, with_positive_gap(groups)[0]
    if base.model.cavitation is not Cavitation.REFORM:  # its cavity is at ambient pressure
        return _solve_by_path(first_path(base), groups, rtol)
    full = replace(groups, model=replace(model, cavitation=Cavitation.NONE, cavity_pressure=0.0))
    path, deepest = first_path(full), -math.inf
    if path.outcome.ok:
        point = _refined(path.states[-1], full, rtol)
        deepest = deepest if point.state is None else point.state.lowest_pressure
        if deepest >= model.cavity_pressure:
            return replace(point, groups=groups)
    return _solve_by_path(path_to_cavity(groups, deepest), groups, rtol)


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
            f"problem = {show(problem)}; it must be a LineContact, PointContact or Groups(speed, load, roughness)"
            + ("; give the contact of the case, case.contact." if hasattr(problem, "contact") else ".")
        )
    if problem.shape != ():
        raise InputError(f"groups have shape {problem.shape}; solve takes one state, use stribeck_curve for many.")
    return problem, None


def check_rtol(rtol: Any) -> float:
    """Return a tolerance as a float, or refuse one that is no number or out of range."""
    is_real = isinstance(rtol, Real) and not isinstance(rtol, bool)
    if not is_real or not MIN_RTOL <= rtol <= MAX_RTOL:
        raise InputError(
            f"rtol = {show(rtol)}; it must be a number from {MIN_RTOL:g}, the limit of double precision, to {MAX_RTOL:g}."
        )
    return float(rtol)


def untested_note(groups: Groups) -> str:
    """Return the end of a failure message for groups outside the tested range, else an empty string."""
    outside = []
    for name, (low, high) in TESTED_RANGES.items():
        value = float(getattr(groups, name))
        if value != 0 and not low <= value <= high:
            outside.append(f"{name.replace('_', ' ')} {value:.4g} (tested: {low:g} to {high:g})")
    return f" The solver has not been tested for {', '.join(outside)}; check the inputs." if outside else ""


def spike_note(groups: Groups) -> str:
    """Return the end of a failure message for a fluid with a pressure spike, else an empty string."""
    a = groups.model.film.parameters.get("pressure_coefficient", 0.0)
    if not isinstance(a, float) or a == 0.0:
        return ""
    return (
        f" Pressure coefficient times Hertz pressure is {a:.2g}: from about 2.5 on the pressure of a thick film rises to a "
        "spike, as in hard elastohydrodynamics, and without bound above 4.4 in a full film or above 5.2 in one that ends, "
        "earlier in a fluid that stiffens faster than exponentially. Thinner films, at lower speed, have none."
    )


def finish(point: RefinedState, groups: Groups, contact: Contact | None, rtol: float, on_failure: str = "raise") -> Solution:
    """Return a refined state as a solution, or raise the error of its outcome."""
    solution = solution_of(point, contact, rtol)
    if solution is not None and (point.outcome.ok or on_failure == "return"):
        return solution
    reached = "" if solution is None else f" Achieved: {solution.error_estimate:.1e}, requested: {rtol:.1e}."
    raise SolveError(
        point.outcome,
        solution,
        point.message or f"{describe(groups)}: {point.outcome.value}{reached}{spike_note(groups)}{untested_note(groups)}",
    )


def minimum_estimate(rtol: float, model: Model) -> float:
    """Return the smallest stated error for a tolerance and a model, whose kinks finer nodes see only in part."""
    if not model.profile.is_parabola:  # between the nodes beside a kink of the shape the gap is known to no more
        return rtol
    return (NEGLIGIBLE if model == BASE_MODEL else SAFETY * NEGLIGIBLE) * rtol


def stated_errors(counted: Array, values: Array, groups: Groups, rtol: float) -> Array:
    """Return the stated errors of values by those that a tolerance counts: relative, absolute for the load shares."""
    found = np.maximum(counted, minimum_estimate(rtol, groups.model))
    if groups.roughness == 0 and groups.speed > 0:  # smooth surfaces in a film touch nowhere
        found[..., ROW["contact_load_share"]] = 0.0
    return np.asarray(found / drag_parts(values)[..., : found.shape[-1]])


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
        relative_errors=stated_errors(estimate.relative, values.array(), point.groups, rtol),
        minimum_position_error=estimate.minimum_position,
        rounding_floor=estimate.floor,
        mesh=state.mesh,
        nodal_gap=state.gap,
        gap_shift=with_positive_gap(point.groups)[1],
        nodal_pressures=partial(state.equations.pressures, state.y),
        origin=(state.exit, state.cavity_stretch),
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
    """Return the notes on a state, whose pressures ``state()`` gives and whose rounding is ``floor``."""
    notes = [*shape_notes(contact), *law_notes(groups, contact, values)]
    if groups.speed > 0 and (contact is not None or groups.model != BASE_MODEL):
        solved = state()
        fluid = solved.equations.pressures(solved.y)[1]
        notes += [] if contact is None else cavitation_notes(contact, solved.lowest_pressure)
        if groups.model.cavitation is Cavitation.EXIT:
            notes += pocket_notes(solved.lowest_pressure)
        if not solved.equations.operators.is_base_model:
            notes += fluid_notes(solved.equations.film, solved.gap, fluid, solved.flux_gap)
    if math.isnan(values.flux_gap):
        notes.append("The gap is negative, so no fluid passes and there is no flux gap.")
    if floor > NEGLIGIBLE * rtol:
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
        offset=hertz.HERTZ_OFFSET,
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
        relative_errors=np.where(np.isnan(values.array()), np.nan, np.finfo(float).eps),
        minimum_position_error=1.0,
        rounding_floor=0.0,
        mesh=mesh,
        nodal_gap=hertz.gap(mesh.nodes),
        gap_shift=0.0,
        nodal_pressures=partial(_dry_pressures, mesh),
    )


def _dry_pressures(mesh: Mesh) -> tuple[Array, Array]:
    return hertz.pressure(mesh.nodes), np.zeros(mesh.size)
