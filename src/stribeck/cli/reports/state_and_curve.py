"""A state and a curve in words: the answer that fits a screen, and everything. Nothing is computed here."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from stribeck.cli.reports.text import mark_table, number_lines, outcome_line, place, report_lines
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


def solution_lines(
    solution: BaseSolution,
    case: Case | None,
    boundary_friction: float | None = None,
    beta: float | None = None,
    checks: Checks | None = None,
    verbose: bool = False,
) -> Iterator[str]:
    """Yield what people read of a state: verdict, regime, the main numbers, doubts and notes in short, or everything."""
    given, definition = (boundary_friction, beta), case.definition if case else "balanced"
    body = _coefficients(solution, *given)
    if verbose:
        body += number_lines(report_rows(solution, *given))
        body.append(f"Regime: {regime_of(solution.fluid_load_share, solution.friction(*given).contact_share)}.")
        # The tolerance holds neither the minimum film of a ball nor the sum of the parts of friction.
        friction = max(solution.friction(*given, each).relative_error for each in DEFINITIONS)
        others = {"minimum film": getattr(solution, "minimum_gap_error", 0.0), "friction": friction}
        body.append(outcome_line(solution.outcome.value, solution.error_estimate, others))
    else:
        body.insert(0, answer_sentence(solution, solution.friction(*given, definition)))
        body += number_lines(main_rows(solution, *given, definition))
        body += [] if solution.outcome.ok else [solution.outcome.value]
    return report_lines(solution, case, checks, body, solution.notes_for(*given), "" if verbose else MORE_OF_STATE)


def _coefficients(solution: BaseSolution, boundary_friction: float | None, beta: float | None) -> list[str]:
    if solution.contact is not None:
        return []
    dry, slope = (1.0 if value is None else value for value in (boundary_friction, beta))
    return [f"Friction is for boundary_friction = {dry:g} and beta = {slope:g}: --boundary-friction, --beta."]


def curve_lines(curve: StribeckCurve, case: Case | None, verdict: CurveVerdict, verbose: bool = False) -> Iterator[str]:
    """Yield what people read of a curve: verdict, regimes, transitions, doubts and notes in short, or everything."""
    body, errors = [*_regime_lines(curve)], verdict.errors
    if verbose:
        if verdict.headline and verdict.checks is not None and not verdict.checks.first_line:
            yield verdict.headline
        if errors is not None:
            body.append(f"At the {curve.over} of the contact itself, {place(curve, getattr(errors.contact, curve.over), 4)}:")
            body.append(str(errors))
        friction = {"friction": float(curve.friction.relative_error.max(initial=0.0))}
        body.append(outcome_line(curve.outcome.value, curve.error_estimate, friction))
    elif errors is not None:
        friction_text = errors["friction"].text
        body.append(f"At the {curve.over} of the contact itself: friction {friction_text}; {errors.probabilities}.")
    yield from report_lines(curve, case, verdict.checks, body, curve.notes, "" if verbose else MORE_OF_CURVE)


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
