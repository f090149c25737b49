"""The regime of a contact in words: its transitions, the margins to them, and the sensitivity of friction."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stribeck.checks.check import Checks
from stribeck.cli.exits import say
from stribeck.cli.reports.printing import (
    Sensitivities,
    mark_texts,
    most_sensitive_input,
    print_head,
    print_outcome,
    print_table,
    table_of,
)
from stribeck.contacts.contact import Contact
from stribeck.contacts.part_inputs import all_input_rows
from stribeck.curves.landmarks import Landmark
from stribeck.curves.result import StribeckCurve
from stribeck.quantities.formats import MIN_STATED_SHARE, format_factor, format_si
from stribeck.regimes.margins import RegimeMargins
from stribeck.regimes.sentences import regime_sentence, ways_to
from stribeck.solver.base_solution import BaseSolution
from stribeck.uncertainty.result import Uncertainty

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["print_regimes"]


def print_regimes(
    console: Console,
    solution: BaseSolution,
    sensitivities: Sensitivities,
    curve: StribeckCurve,
    margins: RegimeMargins,
    title: str,
    checks: Checks | None = None,
) -> None:
    """Print the regime of a contact, its transitions, the margins and the sensitivity of friction."""
    contact = solution.contact
    assert contact is not None
    print_head(console, title, contact, solution.groups, checks=checks)
    friction = solution.friction(definition=curve.definition)
    say(console, regime_sentence(solution, curve.definition))
    for line in ways_to(margins):
        say(console, line)
    if curve.transitions:
        table = table_of("transition", "speed", "change", "friction", right=(1, 3))
        for mark in curve.transitions:
            where, friction_there = mark_texts(curve, mark)
            table.add_row(mark.name, where, _way(mark, contact.speed), friction_there)
        print_table(console, table)
    else:
        say(
            console,
            "This contact has no transition between the boundary plateau and the hydrodynamic branch.",
        )
    _print_sensitivities(console, contact, sensitivities)
    notes = [*solution.notes, *curve.minimum_notes, *margins.notes]
    error = max(solution.error_estimate, curve.error_estimate)
    others = {"friction": max(friction.relative_error, float(curve.friction.relative_error.max(initial=0.0)))}
    print_outcome(console, curve.outcome.value, error, notes, checks, others)


def _print_sensitivities(console: Console, contact: Contact, sensitivities: Sensitivities) -> None:
    """Print by how much friction changes with each input, and with which most."""
    if not sensitivities:
        return
    table = table_of("input", "value", "sensitivity", "10 % increase gives", right=(1, 2, 3))
    rows = all_input_rows(contact.INPUTS)
    for name in sorted(sensitivities, key=lambda name: -abs(sensitivities[name])):
        value, slope = getattr(contact, name), sensitivities[name]
        table.add_row(
            rows[name].label,
            format_si(value, rows[name].dimension),
            f"{slope:+.3f}",
            _change_text(_change(1.1, slope)),
        )
    print_table(console, table)
    most = most_sensitive_input(sensitivities)
    if most is not None:
        slope = sensitivities[most]
        factor = 0.9 if slope > 0 else 1.1
        way, gain = "less" if slope > 0 else "more", f"{-100 * _change(factor, slope):.3g} %"
        name = contact.INPUTS.quantities[most].label
        say(console, f"Friction is most sensitive to {name}: 10 % {way} lowers friction by {gain}, other inputs fixed.")


def print_uncertainty(console: Console, found: Uncertainty) -> None:
    """Print the uncertainty of friction, films, transitions and regime."""
    table = table_of("with errors of the inputs", "value", "95 %", right=(1, 2))
    for each in found.spreads:
        table.add_row(each.label, *each.texts)
    print_table(console, table)
    say(console, f"Probability of each regime: {found.probabilities}.")
    for sentence in found.sources:
        say(console, sentence)


def _way(mark: Landmark, speed: float) -> str:
    if speed == 0:
        return "from rest"
    factor = mark.value / speed
    return f"{format_factor(factor)}x faster" if factor >= 1 else f"{format_factor(1 / factor)}x slower"


def _change_text(change: float) -> str:
    """Return a relative change of friction in per cent."""
    return f"{100 * change:+.2g} % friction" if abs(change) >= MIN_STATED_SHARE else "no change"


def _change(factor: float, slope: float) -> float:
    """Return the relative change of friction where an input with this sensitivity is multiplied."""
    return float(factor**slope - 1)
