"""Refining a state until its estimated error is within a tolerance, and reporting how that ended."""

import math
from dataclasses import dataclass, replace

from stribeck.contacts.groups import Groups, contact_law
from stribeck.equations.enriched import FineOperators
from stribeck.equations.error_estimate import ErrorEstimate, error_estimate
from stribeck.equations.mesh_choice import halvings_for, mesh_for
from stribeck.equations.observables import Observables, observables
from stribeck.equations.operators import Operators
from stribeck.equations.state import Guess, State, solve_state
from stribeck.fluids import newtonian as reynolds
from stribeck.numerics.panels import MeshTooLargeError
from stribeck.numerics.settings import MAX_REFINEMENTS, NEGLIGIBLE, ROUNDING, SAFETY, SHARE
from stribeck.quantities.outcome import Outcome
from stribeck.solver.at_rest import with_positive_gap


def order_for(rtol: float) -> int:
    """Return the number of nodes per panel that reaches ``rtol`` with the fewest unknowns."""
    return 12 if rtol >= 1e-7 else 16


def mesh_tolerances_for(rtol: float) -> tuple[float, float]:
    """Return the Legendre tails to start refinement with; most states reach ``rtol`` with them at once."""
    return min(1e-2, 0.2 * math.sqrt(rtol)), 0.3 * rtol


@dataclass(frozen=True, eq=False)
class RefinedState:
    """A refined state of ``groups`` with observables, errors and outcome."""

    # ``state`` is that of the groups of with_positive_gap; ``estimate`` is None without even a coarse state.

    groups: Groups
    state: State | None
    values: Observables | None
    estimate: ErrorEstimate | None
    outcome: Outcome
    tolerances: tuple[float, float] | None = None
    fine: FineOperators | None = None
    message: str = ""  # Why no path leads to the state


def converge(
    guess: Guess,
    groups: Groups,
    rtol: float,
    tolerances: tuple[float, float] | None = None,
    profile_tolerance: float = math.inf,
    spread: float = 0.0,
) -> RefinedState:
    """Return a guess refined until its error is at most ``rtol``, rounding stops it, or the mesh grows too large."""
    # ``profile_tolerance`` is the tail of the gap between the nodes, which no observable needs.
    base, _ = with_positive_gap(groups)
    law = contact_law(base)
    tail, gap_tail = mesh_tolerances_for(rtol) if tolerances is None else tolerances
    first = tail
    best = RefinedState(groups, None, None, None, Outcome.REFINEMENT_LIMIT)
    halvings = 0
    outcome = Outcome.REFINEMENT_LIMIT
    newton = newton_tolerance(rtol)
    for _ in range(MAX_REFINEMENTS):
        try:
            mesh = mesh_for(guess, base, law, order_for(rtol), tail, gap_tail, profile_tolerance, halvings, spread)
        except MeshTooLargeError:
            profile_tolerance *= 10.0
            tail *= 3.0 if profile_tolerance > 10 * tail else 1.0
            continue
        state = solve_state(base, Operators(mesh, base.model), guess, newton)
        if not state.outcome.ok:
            outcome = state.outcome
            # On a fine first mesh the iteration may fail: a coarser one leads to it.
            if best.state is not None or NEGLIGIBLE * tail > first:
                break
            tail, gap_tail = tail / NEGLIGIBLE, gap_tail / NEGLIGIBLE
            continue
        if isinstance(guess, State):  # the prediction becomes the first state on the way to this one
            state = replace(state, prediction_error=max(state.prediction_error, guess.prediction_error))
        fine, values = FineOperators(mesh), values_of(state, groups)
        estimate = error_estimate(state, values, fine)
        before = math.inf if best.estimate is None else best.estimate.total
        if estimate.total < before:
            best = RefinedState(groups, state, values, estimate, outcome_for(estimate, rtol), (tail, gap_tail), fine)
        if best.outcome.ok:
            return best
        if estimate.total <= 3 * estimate.floor or SHARE * before < estimate.total <= SAFETY**2 * _noise(best):
            outcome = Outcome.ROUNDING
            break
        # An error above the value itself that a finer mesh leaves: no state is near, such as one whose cavity has closed.
        if min(before, estimate.total) > 1.0 and estimate.total > SHARE * before:
            break
        if estimate.of_ends > SHARE * rtol:
            halvings += math.ceil(halvings_for(estimate.of_ends / (SHARE * rtol)))
        tail *= tolerance_factor(math.sqrt(rtol / (estimate.at_nodes + 1e-300)))
        between = tolerance_factor(rtol / (estimate.between_nodes + 1e-300))
        seen = abs(values.minimum_gap) / float(state.gap.min())  # at rest it may be a small difference of two gaps
        if gap_tail * between >= NEGLIGIBLE**2 * rtol * min(1.0, seen):
            gap_tail *= between
        else:
            tail *= between
        guess = state
    if best.estimate is not None and max(best.estimate.floor, _noise(best)) > 0.3 * rtol:
        outcome = Outcome.ROUNDING
    return replace(best, outcome=outcome)


def _noise(point: RefinedState) -> float:
    """Return the relative error that rounding of nodal gaps on small panels may cause in the read gap."""
    return 0.0 if point.state is None else ROUNDING / float(point.state.gap.min())


def tolerance_factor(excess: float) -> float:
    """Return the factor that reduces a mesh tolerance whose error is 1/``excess`` of the allowed one."""
    return 1.0 if excess > 2 else min(0.5, max(0.3, 0.5 * excess))


def verify(state: State, groups: Groups, fine: FineOperators, rtol: float) -> RefinedState:
    """Return the state with observables and errors, converged if these are at most ``rtol``."""
    values = values_of(state, groups)
    estimate = error_estimate(state, values, fine)
    return RefinedState(groups, state, values, estimate, outcome_for(estimate, rtol), fine=fine)


def outcome_for(estimate: ErrorEstimate, rtol: float) -> Outcome:
    """Return whether an estimate is within the tolerance."""
    return Outcome.CONVERGED if estimate.total <= rtol else Outcome.REFINEMENT_LIMIT


def newton_tolerance(rtol: float) -> float:
    """Return the size of the last Newton step that leaves an error far below ``rtol``."""
    return max(1e-11, 1e-2 * rtol)


def values_of(state: State, groups: Groups) -> Observables:
    """Return the observables of ``groups`` from the state solved for it."""
    values = observables(state.equations, state.y, float(groups.load))
    _, shift = with_positive_gap(groups)
    if shift == 0.0:
        return values
    gap = state.gap + shift
    return replace(
        values,
        central_gap=values.central_gap + shift,
        minimum_gap=values.minimum_gap + shift,
        offset=values.offset + shift,
        flux_gap=reynolds.flux_gap(gap, state.mesh.weights) if gap.min() > 0 else math.nan,
    )
