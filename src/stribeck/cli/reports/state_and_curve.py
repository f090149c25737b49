"""A state and a curve in words: what the commands print. Nothing is computed here but percentages."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from stribeck.checks.check import Checks
from stribeck.cli.exits import say
from stribeck.cli.reports.printing import (
    digits,
    error_text,
    hersey_of,
    length,
    mark_texts,
    part,
    place,
    print_head,
    print_outcome,
    print_table,
    table_of,
)
from stribeck.cli.reports.regimes import print_uncertainty
from stribeck.contacts.friction import DEFINITIONS
from stribeck.contacts.friction_rules import RULES
from stribeck.curves.regime import regime_of
from stribeck.quantities.formats import format_si
from stribeck.solver.base_solution import BaseSolution, hysteresis_coefficient
from stribeck.uncertainty.result import Uncertainty

if TYPE_CHECKING:
    from rich.console import Console

    from stribeck.curves.result import StribeckCurve

__all__ = ["print_curve", "print_solution"]

DEFAULT_PRINT_ERROR = 1e-3  # Relative error with which numbers are printed that state none.


def print_solution(
    console: Console,
    solution: BaseSolution,
    title: str,
    boundary_friction: float | None = None,
    beta: float | None = None,
    checks: Checks | None = None,
) -> None:
    """Print one state as a table with units and errors."""
    print_head(console, title, solution.contact, solution.groups, checks=checks)
    if solution.contact is None:
        dry, slope = (1.0 if value is None else value for value in (boundary_friction, beta))
        say(console, f"Friction is for boundary_friction = {dry:g} and beta = {slope:g}: --boundary-friction, --beta.")
    columns = (0, 1, 3) if solution.contact is None else (0, 1, 2, 3)
    table = table_of(*(("quantity", "value", "in SI", "error")[i] for i in columns))
    for row in _solution_rows(solution, boundary_friction, beta):
        table.add_row(*(row[i] for i in columns))
    print_table(console, table)
    # The tolerance holds neither the minimum film of a ball nor the sum of the parts of friction.
    friction = max(solution.friction(boundary_friction, beta, each).relative_error for each in DEFINITIONS)
    others = {"minimum film": getattr(solution, "minimum_gap_error", 0.0), "friction": friction}
    print_outcome(
        console, solution.outcome.value, solution.error_estimate, solution.notes_for(boundary_friction, beta), checks, others
    )


def _solution_rows(
    solution: BaseSolution, boundary_friction: float | None, beta: float | None
) -> Iterator[tuple[str, str, str, str]]:
    errors = solution.errors
    for definition in DEFINITIONS:
        f = solution.friction(boundary_friction, beta, definition)
        yield f"friction coefficient ({definition})", digits(f.total, f.relative_error), "", error_text(f.relative_error)
        yield "  from asperities", part(f.contact, f.error), "", ""
        yield "  from the fluid", part(f.viscous, f.error), "", ""
        if definition == "balanced" and solution.groups.model.film.slide != 1.0 and math.isfinite(f.upper):
            yield "  on the cylinder", part(f.upper, f.error), "", ""
    lost = hysteresis_coefficient(solution, beta)
    if lost is not None:
        yield "hysteresis friction, apart", digits(lost, DEFAULT_PRINT_ERROR), "", ""
    rows = solution.outputs.rows
    for row in (row for row in rows if row.error == "absolute"):
        yield row.label, part(getattr(solution, row.name), errors[row.name]), "", error_text(errors[row.name])
    scales = None if solution.contact is None else solution.contact.hertz
    for row in (row for row in rows if row.scale == "gap"):
        value, error = getattr(solution, row.name), errors[row.name]
        si = "" if scales is None else length(value * scales.indentation, error)
        unit = " u_Hz" if math.isfinite(value) else ""
        yield row.label, f"{digits(value, error)}{unit}", si, error_text(error)
    for row in (row for row in rows if row.scale == "width" and not row.name.endswith("_error")):
        place = getattr(solution, row.name)
        if math.isnan(place):  # a film whose suction ends no film
            continue
        # That of an end of the film is relative to the larger of its distance and the half-width.
        wrong = errors[row.name] * max(1.0, abs(place)) if row.name in errors else getattr(solution, f"{row.name}_error")
        # To 1e-4 of the half-width: of a symmetric film only rounding remains, and a position in picometres says nothing.
        place = round(place, 4) + 0.0
        si = "" if scales is None else length(place * scales.half_width, 1e-4)
        yield row.label, f"{place:.4g} a", si, f"{wrong:.0e} a"
    for row in (row for row in rows if row.scale == "pressure"):
        value, error = getattr(solution, row.name), errors[row.name]
        si = "" if scales is None else format_si(value * scales.pressure, "pressure", 4)
        yield row.label, f"{digits(value, error)} p_Hz", si, error_text(error)
    if "minimum_angle" in solution.outputs.listed:
        angle, wrong = math.degrees(solution.minimum_angle), math.degrees(solution.minimum_angle_error)
        yield "angle of minimum film", f"{angle:.3g}°", "", f"{float(f'{wrong:.2g}'):g}°"
    yield "Lambda (minimum film over h_rms)", digits(solution.lambda_ratio, 1e-4), "", ""
    if not math.isnan(solution.central_area_fraction):
        area, error = solution.central_area_fraction, solution.central_area_fraction_error
        yield "real contact area at x = 0", part(area, error), "", error_text(error / area) if area > 0 else ""
    regime = regime_of(solution.fluid_load_share, solution.friction(boundary_friction, beta).contact_share)
    yield f"Hersey number {RULES[solution.groups.geometry].hersey_symbol}", f"{hersey_of(solution, beta):.4g}", "", ""
    yield "regime", regime, "", ""


def print_curve(
    console: Console,
    curve: StribeckCurve,
    title: str,
    files: Sequence[str],
    checks: Checks | None = None,
    errors: Uncertainty | None = None,
    verdict: str = "",
) -> None:
    """Print what a curve holds: inputs, regimes, transitions, what errors leave open, error, notes, files."""
    if verdict and checks is not None and not checks.first_line:
        say(console, verdict)
    print_head(console, title, curve.contact, curve.groups, curve.over, checks)
    low, high = place(curve, curve.values[0]), place(curve, curve.values[-1])
    say(console, f"{len(curve)} point{'s' * (len(curve) > 1)}, {curve.over} {low} to {high}.")
    table = table_of("regime", "from", "to", right=(1, 2))
    for regime, first, last in curve.regime_ranges:
        table.add_row(regime, place(curve, first), place(curve, last))
    print_table(console, table)
    if curve.transitions:
        table = table_of("transition", curve.over, "friction", right=(1, 2))
        for mark in curve.transitions:
            table.add_row(mark.name, *mark_texts(curve, mark))
        print_table(console, table)
    if curve.minimum is None:
        say(console, "Friction has no minimum inside this range.")
    if errors is not None:
        say(console, f"At the {curve.over} of the contact itself, {place(curve, getattr(errors.contact, curve.over), 4)}:")
        print_uncertainty(console, errors)
    friction = {"friction": float(curve.friction.relative_error.max(initial=0.0))}
    print_outcome(console, curve.outcome.value, curve.error_estimate, curve.notes, checks, friction)
    for name in files:
        say(console, f"Written: {name}")
