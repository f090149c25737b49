"""A state, a curve and the regime of a contact in words: the answer that fits a screen, and with -v everything."""

from __future__ import annotations

import html
import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import stribeck as sb
from stribeck.contacts.contact import Contact, in_words, model_words
from stribeck.contacts.friction import DEFINITIONS, Definition, regime_of
from stribeck.quantities.formats import MIN_STATED_SHARE, figures, format_factor, format_number, format_percent, format_si
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.results import table_lines
from stribeck.quantities.units import InputError, show
from stribeck.regimes.advice import answer_sentence, regime_sentence, step_text, strongest_lever, ways_to
from stribeck.solver.base_solution import BaseSolution
from stribeck.solver.numbers import constant_groups, main_rows, report_rows

if TYPE_CHECKING:
    from stribeck.cases.case import Case
    from stribeck.checks.check import Checks
    from stribeck.curves.regime import Landmark
    from stribeck.curves.result import StribeckCurve
    from stribeck.quantities.formats import Number
    from stribeck.regimes.overview import CurveVerdict, Overview

SCREEN_WIDTH = 80  # Columns of the terminal for which notes of an answer are shortened.

NOTE_LINES = 3  # Lines of such a terminal that the notes of an answer may take together.


def report_lines(
    result: BaseSolution | StribeckCurve,
    case: Case | None,
    checks: Checks | None,
    body: Iterable[str],
    notes: Sequence[str],
    more: str = "",
) -> Iterator[str]:
    """Yield whether the model applies, of what contact, numbers and notes: in short and how to see ``more``, or everything."""
    first = "" if checks is None else checks.first_line or (checks.headline if more else "")
    yield from filter(None, (first, case.title if case else ""))
    yield from () if more else _constant(result)
    yield from body
    if not more:
        yield from (*_doubts(checks, notes, is_full=True), *conversion_lines(case))
        return
    # A first line that says much leaves less room below.
    room = NOTE_LINES - (len(checks.first_line) // SCREEN_WIDTH if checks is not None else 0)
    yield from _shortened(_doubts(checks, notes), max(1, room))
    yield more


def _constant(result: BaseSolution | StribeckCurve) -> Iterator[str]:
    """Yield the inputs, groups and parts of the model that do not vary."""
    contact, groups, over = result.contact, result.groups, getattr(result, "over", None)
    if contact is not None:
        rows = contact.INPUTS.quantities
        inputs = [(rows[name], value) for name, value in contact.inputs() if name != over]
        yield f"Contact: {', '.join(f'{row.label} {format_si(value, row.dimension, 4)}' for row, value in inputs)}."
    constant = (f"{name} {value:.6g}" for name, value in constant_groups(groups).items())
    yield f"Groups: {', '.join(constant)}."
    if groups.law is not None:
        numbers = in_words(groups.law.parameters, si=True)
        yield f"Contact law: {groups.law.name}{f' ({numbers})' if numbers else ''}."
    model = model_words(groups, contact)
    if model:
        yield f"Model: {model}."


def number_lines(numbers: Sequence[Number]) -> list[str]:
    """Return numbers as a table of values with their errors."""
    return table_lines([("quantity", "value", "error"), *((each.label, *each.texts) for each in numbers)])


def place(curve: StribeckCurve, value: float, digits: int = 3) -> str:
    """Return a value of the quantity that varies along a curve, with its unit."""
    from stribeck.curves.result import path_of  # loaded with the curve, and not for a state

    return path_of(curve).source.coordinate.text(value, digits)


def mark_texts(curve: StribeckCurve, mark: Landmark) -> tuple[str, str]:
    """Return where a landmark of a curve lies, and the friction there, with the digits that the curve's error allows."""
    return place(curve, mark.value, figures(curve.error_estimate)), format_number(mark.friction, curve.error_estimate)


def mark_table(curve: StribeckCurve, changes: Sequence[str] = ()) -> list[str]:
    """Return the transitions of a curve, with what it takes to get there where that is given."""
    rows = [("transition", str(curve.over), *(["change"] if changes else []), f"friction, {curve.definition}")]
    for i, mark in enumerate(curve.transitions):
        where, friction = mark_texts(curve, mark)
        rows.append((str(mark.name), where, *changes[i : i + 1], friction))
    return table_lines(rows, right=(1, len(rows[0]) - 1))


def outcome_line(outcome: str, error: float, others: Mapping[str, float]) -> str:
    """Return how a solve ended, its error, and those of other quantities that are larger."""
    larger = sorted(((value, name) for name, value in others.items() if value > error), reverse=True)
    errors = [f"{value:.1e} of the {name}" for value, name in larger]
    found = ", ".join([*errors, f"{error:.1e} of the rest" if errors else f"{error:.1e}"])
    return f"{outcome} Largest estimated relative error: {found}."


def conversion_lines(case: Case | None) -> list[str]:
    """Return the conversions of data-sheet inputs; empty if there are none."""
    return [f"Converted: {sentence}" for sentence in case.conversions] if case else []


def _doubts(checks: Checks | None, notes: Sequence[str], *, is_full: bool = False) -> list[str]:
    """Return what the first line leaves of doubtful checks and of notes; each once, in full as a note, which says more."""
    said = [f"Note: {note}" for note in notes if checks is None or not checks.covers(note, doubts=not is_full)]
    if checks is None:
        return said
    doubts = (each.sentence for each in checks.with_verdict("doubtful") if each.sentence not in checks.first_line)
    told = tuple(notes) if is_full else ()
    left = (each for each in doubts if not any(note.startswith(each.rstrip(".")) for note in told))
    return [*(f"Doubtful: {each}" for each in left), *said]


def _shortened(sentences: Sequence[str], room: int) -> list[str]:
    """Return as many sentences as there are lines for, shortened to these lines of a terminal."""
    lines = max(1, room // max(1, len(sentences)))
    return [textwrap.shorten(each, lines * SCREEN_WIDTH, placeholder=" ...") for each in sentences[:room]]


MORE_OF_STATE = "-v shows inputs, all films and positions, both frictions and full notes."

MORE_OF_CURVE = "-v shows inputs, errors, full notes; -o FILE writes points, --plot FILE draws."


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
        share = solution.friction(*given, definition).contact_share
        body.append(f"Regime: {regime_of(solution.fluid_load_share, share)}.")
        # The tolerance holds neither the minimum film of a ball nor the sum of the parts of friction.
        friction = max(solution.friction(*given, each).relative_error for each in DEFINITIONS)
        others = {"minimum film": getattr(solution, "minimum_gap_error", 0.0), "friction": friction}
        body.append(outcome_line(solution.outcome.value, solution.error_estimate, others))
    else:
        body.insert(0, answer_sentence(solution, solution.friction(*given, definition)))
        body += number_lines(main_rows(solution, *given, definition))
        body += [] if solution.outcome.ok else [solution.outcome.value]
    return report_lines(solution, case, checks, body, solution.notes_for(*given, definition), "" if verbose else MORE_OF_STATE)


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


# Numbers that the sentence above the table has.
OF_THE_SENTENCE = ("friction from", "hysteresis", "load on", "Lambda")

NO_ERRORS = 'No input has an error; uncertainty = "typical" at the top of the case adds them.'

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
        rows = [(label, *spreads.get(label, (value, ""))) for label, value, _ in rows]
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
    rows, labels = [("input", "value", "sensitivity", "10 % increase gives about")], contact.INPUTS.rows
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
    return [f"Strongest lever: {name}; 10 % {way} lowers friction by {format_percent(1 - factor**slope)}{force}."]


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
    from stribeck.regimes.overview import overview_of

    if isinstance(problem, Contact):
        problem = sb.Case(path=Path(), contact=problem, rtol=rtol, definition=definition)
    if not isinstance(problem, sb.Case):
        raise InputError(f"problem = {show(problem)}; give a contact, or a case from load_case.")
    return Explanation("\n".join(regimes_lines(overview_of(problem))))
