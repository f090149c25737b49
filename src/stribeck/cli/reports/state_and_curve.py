"""A state and a curve in words: the answer that fits a screen, and everything. Nothing is computed here."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from stribeck.cli.reports.text import all_lines, answer_lines, mark_table, number_lines, outcome_line, place
from stribeck.contacts.friction import DEFINITIONS
from stribeck.contacts.regime import regime_of
from stribeck.quantities.results import table_lines
from stribeck.regimes.sentences import answer_sentence
from stribeck.solver.base_solution import BaseSolution
from stribeck.solver.numbers import main_rows, report_rows

if TYPE_CHECKING:
    from stribeck.cases.case import Case
    from stribeck.checks.check import Checks
    from stribeck.curves.result import StribeckCurve
    from stribeck.regimes.verdict import CurveVerdict

MORE_OF_STATE = "-v shows inputs, all films and positions, both frictions and full notes."

MORE_OF_CURVE = "-v shows inputs, errors and full notes; -o FILE writes points, --plot FILE draws."


def solution_answer(
    solution: BaseSolution,
    case: Case | None,
    boundary_friction: float | None = None,
    beta: float | None = None,
    checks: Checks | None = None,
) -> Iterator[str]:
    """Yield what people read first of a state: verdict, regime, the main numbers, doubts and notes in short."""
    definition = case.definition if case else "balanced"
    body = [answer_sentence(solution, solution.friction(boundary_friction, beta, definition))]
    body += _coefficients(solution, boundary_friction, beta)
    body += number_lines(main_rows(solution, boundary_friction, beta, definition))
    body += [] if solution.outcome.ok else [solution.outcome.value]
    return answer_lines(case, checks, body, solution.notes_for(boundary_friction, beta), MORE_OF_STATE)


def solution_lines(
    solution: BaseSolution,
    case: Case | None,
    boundary_friction: float | None = None,
    beta: float | None = None,
    checks: Checks | None = None,
) -> Iterator[str]:
    """Yield everything about one state, as a table with units and errors."""
    body = _coefficients(solution, boundary_friction, beta)
    body += number_lines(report_rows(solution, boundary_friction, beta))
    body.append(f"Regime: {regime_of(solution.fluid_load_share, solution.friction(boundary_friction, beta).contact_share)}.")
    # The tolerance holds neither the minimum film of a ball nor the sum of the parts of friction.
    friction = max(solution.friction(boundary_friction, beta, each).relative_error for each in DEFINITIONS)
    others = {"minimum film": getattr(solution, "minimum_gap_error", 0.0), "friction": friction}
    body.append(outcome_line(solution.outcome.value, solution.error_estimate, others))
    return all_lines(case, solution, checks, body, solution.notes_for(boundary_friction, beta))


def _coefficients(solution: BaseSolution, boundary_friction: float | None, beta: float | None) -> list[str]:
    if solution.contact is not None:
        return []
    dry, slope = (1.0 if value is None else value for value in (boundary_friction, beta))
    return [f"Friction is for boundary_friction = {dry:g} and beta = {slope:g}: --boundary-friction, --beta."]


def curve_answer(curve: StribeckCurve, case: Case | None, verdict: CurveVerdict) -> Iterator[str]:
    """Yield what people read first of a curve: verdict, regimes, transitions, doubts and notes in short."""
    body, errors = [*_regime_lines(curve)], verdict.errors
    if errors is not None:
        friction = errors["friction"].text
        body.append(f"At the {curve.over} of the contact itself: friction {friction}; {errors.probabilities}.")
    return answer_lines(case, verdict.checks, body, curve.notes, MORE_OF_CURVE)


def curve_lines(curve: StribeckCurve, case: Case | None, verdict: CurveVerdict) -> Iterator[str]:
    """Yield what a curve holds: inputs, regimes, transitions, what errors leave open, error, notes."""
    if verdict.headline and verdict.checks is not None and not verdict.checks.first_line:
        yield verdict.headline
    body, errors = [*_regime_lines(curve)], verdict.errors
    if errors is not None:
        body.append(f"At the {curve.over} of the contact itself, {place(curve, getattr(errors.contact, curve.over), 4)}:")
        body.append(str(errors))
    friction = {"friction": float(curve.friction.relative_error.max(initial=0.0))}
    body.append(outcome_line(curve.outcome.value, curve.error_estimate, friction))
    yield from all_lines(case, curve, verdict.checks, body, curve.notes, curve.over)


def _regime_lines(curve: StribeckCurve) -> Iterator[str]:
    """Yield the range of a curve, its regimes and its transitions."""
    low, high = place(curve, curve.values[0]), place(curve, curve.values[-1])
    yield f"{len(curve)} point{'s' * (len(curve) > 1)}, {curve.over} {low} to {high}."
    ranges = [(regime, place(curve, first), place(curve, last)) for regime, first, last in curve.regime_ranges]
    yield from table_lines([("regime", "from", "to"), *ranges], right=(1, 2))
    if curve.transitions:
        yield from mark_table(curve)
    if curve.minimum is None:
        yield "Friction has no minimum inside this range."
