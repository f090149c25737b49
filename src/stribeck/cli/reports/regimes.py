"""The regime of a contact in words: the answer that fits a screen, and everything, for Python too."""

from __future__ import annotations

import html
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import stribeck as sb
from stribeck.cli.reports.text import mark_table, mark_texts, outcome_line, report_lines
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.quantities.formats import MIN_STATED_SHARE, format_factor, format_si
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.results import table_lines
from stribeck.quantities.units import InputError, show
from stribeck.regimes.levers import strongest_lever
from stribeck.regimes.overview import Overview, overview_of
from stribeck.regimes.sentences import answer_sentence, regime_sentence, step_text, ways_to
from stribeck.solver.numbers import main_rows

# Numbers that the sentence above the table has.
OF_THE_SENTENCE = ("friction from", "hysteresis", "load on", "Lambda")

NO_ERRORS = (
    'No input has an error, and no number here an interval; uncertainty = "typical" at the top of the case takes usual errors.'
)

MORE = "-v shows all inputs, sensitivities, transitions, intervals and full notes."


def regimes_answer(found: Overview) -> Iterator[str]:
    """Yield what people read first: verdict, regime, the main numbers, the way to other regimes, doubts and notes in short."""
    body = [answer_sentence(found.solution, found.friction), *_main_table(found), *_margin_table(found), *_strongest(found)]
    body.append(NO_ERRORS if found.errors is None else found.errors.probability_sentence)
    return report_lines(found.solution, found.case, found.checks, body, found.notes, MORE)


def regimes_lines(found: Overview) -> Iterator[str]:
    """Yield everything: the regime of a contact, its transitions, the margins, the sensitivity of friction, uncertainty."""
    body = [regime_sentence(found.solution, found.friction), *ways_to(found.margins)]
    body += [*_transition_table(found), *_sensitivity_table(found), *_strongest(found)]
    along = float(found.curve.friction.relative_error.max(initial=0.0))
    others = {"friction": max(found.friction.relative_error, along)}
    body.append(outcome_line(found.curve.outcome.value, found.error_estimate, others))
    body += [f"No sensitivities: {found.no_sensitivities}"] if found.no_sensitivities else []
    body += [] if found.errors is None else [str(found.errors)]
    return report_lines(found.solution, found.case, found.checks, body, found.notes)


def _main_table(found: Overview) -> list[str]:
    """Return the main numbers that the sentence has not, with the 95 % interval where inputs have errors."""
    numbers = main_rows(found.solution, definition=found.curve.definition)
    rows = [(each.label, *each.texts) for each in numbers if not each.label.startswith(OF_THE_SENTENCE)]
    if found.errors is not None:
        spreads = {each.label: each.texts for each in found.errors.spreads}
        rows = [(label, *spreads.get(label.partition(", ")[0], (value, ""))) for label, value, _ in rows]
    minimum = found.curve.minimum
    if minimum is not None:
        where, friction_there = mark_texts(found.curve, minimum)
        rows.append(("minimum of friction", f"{friction_there} at {where}", ""))
    return table_lines([("quantity", "value", "error" if found.errors is None else "95 %"), *rows])


def _margin_table(found: Overview) -> list[str]:
    """Return how far each input is from other regimes, and what 10 % more of it does to friction."""
    contact, targets = found.case.contact, found.margins.targets
    rows = [("input", "value", "friction at +10 %", *(f"to {target}" for target in targets))]
    for margin in found.margins.margins:
        row = contact.INPUTS.quantities[margin.name]
        slope = found.sensitivities.get(margin.name)
        marks = [margin.crossing_into(target) for target in targets]
        # Without its interval, which does not fit.
        steps = [
            "-" if mark is None else step_text(replace(mark, interval_95=None), row.dimension, 3).replace("(to ", "(")
            for mark in marks
        ]
        value = format_si(getattr(contact, margin.name), row.dimension)
        rows.append((margin.name, value, "" if slope is None else _change_text(slope), *steps))
    return table_lines(rows, right=(1, 2))


def _transition_table(found: Overview) -> list[str]:
    marks, speed = found.curve.transitions, found.case.contact.speed
    if not marks:
        return ["This contact has no transition between the boundary plateau and the hydrodynamic branch."]
    return mark_table(found.curve, ["from rest" if speed == 0 else _way(mark.value / speed) for mark in marks])


def _sensitivity_table(found: Overview) -> list[str]:
    """Return by how much friction changes with each input."""
    slopes, contact = found.sensitivities, found.case.contact
    if not slopes:
        return []
    rows, labels = [("input", "value", "sensitivity", "10 % increase gives")], contact.INPUTS.rows
    for name in sorted(slopes, key=lambda name: -abs(slopes[name])):
        value = format_si(getattr(contact, name), labels[name].dimension)
        change = _change_text(slopes[name])
        more = change if change == "no change" else f"{change} friction"
        rows.append((labels[name].label, value, f"{slopes[name]:+.3f}", more))
    return table_lines(rows, right=(1, 2, 3))


def _strongest(found: Overview) -> list[str]:
    most = strongest_lever(found.sensitivities)
    if most is None:
        return []
    slope = found.sensitivities[most]
    factor, way = (0.9, "less") if slope > 0 else (1.1, "more")
    name = found.case.contact.INPUTS.quantities[most].label
    # Friction is the coefficient: a load may lower it and yet raise the force.
    force = f" (the coefficient; the force changes by {100 * (factor ** (1 + slope) - 1):+.2g} %)" if most == "load" else ""
    return [f"Strongest lever: {name}; 10 % {way} lowers friction by {-100 * (factor**slope - 1):.3g} %{force}."]


def _way(factor: float) -> str:
    return f"{format_factor(factor)}x faster" if factor >= 1 else f"{format_factor(1 / factor)}x slower"


def _change_text(slope: float) -> str:
    """Return in per cent by how much friction changes where an input with this sensitivity is larger by a tenth."""
    change = 1.1**slope - 1
    return f"{100 * change:+.2g} %" if abs(change) >= MIN_STATED_SHARE else "no change"


class Explanation(str):
    """Text whose representation is the text itself."""

    def __repr__(self) -> str:
        """Return the text itself."""
        return str(self)

    def _repr_html_(self) -> str:
        return f"<pre style='white-space: pre-wrap'>{html.escape(self)}</pre>"


@answers_typos
def explain(problem: Contact | sb.Case, *, rtol: float = 1e-6, definition: Definition = "balanced") -> Explanation:
    """Explain the regime of a contact: what carries the load, how far the next regimes are, what moves its friction.

    Parameters
    ----------
    problem : LineContact or Case
        The contact, or a case from :func:`stribeck.load_case`, whose tolerance, definition and facts then hold.
    rtol : float
        Relative tolerance of the states.
    definition : {"balanced", "published"}
        Definition of the viscous friction.

    Returns
    -------
    Explanation
        The words of ``stribeck regimes -v``, a string that shows itself as printed.

    Raises
    ------
    InputError
        If ``problem`` is no contact and no case, or an argument is out of range.
    """
    if isinstance(problem, Contact):
        problem = sb.Case(path=Path(), contact=problem, rtol=rtol, definition=definition)
    if not isinstance(problem, sb.Case):
        raise InputError(f"problem = {show(problem)}; give a contact, or a case from load_case.")
    return Explanation("\n".join(regimes_lines(overview_of(problem))))
