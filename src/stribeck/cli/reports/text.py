"""Text shared by all reports: the answer that fits a screen, everything with -v, tables of numbers, notes."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from stribeck.contacts.contact import in_words, model_words
from stribeck.quantities.formats import figures, format_number, format_si
from stribeck.quantities.results import table_lines
from stribeck.solver.about import constant_groups

if TYPE_CHECKING:
    from stribeck.cases.case import Case
    from stribeck.checks.check import Checks
    from stribeck.curves.landmarks import Landmark
    from stribeck.curves.result import StribeckCurve
    from stribeck.quantities.number import Number
    from stribeck.solver.base_solution import BaseSolution

SCREEN_WIDTH = 80  # Columns of the terminal for which notes of an answer are shortened.

NOTE_LINES = 4  # Lines of such a terminal that the notes of an answer may take together.


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
    if more:
        yield from _doubts(checks, notes)
        yield more
        return
    yield from (f"Note: {note}" for note in notes if checks is None or not checks.covers(note))
    yield from conversion_lines(case)


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
        numbers = in_words(groups.law.parameters)
        yield f"Contact law: {groups.law.name}{f' ({numbers})' if numbers else ''}."
    model = model_words(groups, contact)
    if model:
        yield f"Model: {model}."


def number_lines(numbers: Sequence[Number]) -> list[str]:
    """Return numbers as a table of values with their errors."""
    return table_lines([("quantity", "value", "error"), *((each.label, *each.texts) for each in numbers)])


def place(curve: StribeckCurve, value: float, digits: int = 3) -> str:
    """Return a value of the quantity that varies along a curve, with its unit."""
    if curve.contact is None:
        return f"{value:.{digits}g}"
    return format_si(value, curve.contact.INPUTS.quantities[curve.over].dimension, digits)


def mark_texts(curve: StribeckCurve, mark: Landmark) -> tuple[str, str]:
    """Return where a landmark of a curve lies, and the friction there, with the digits that the curve's error allows."""
    return place(curve, mark.value, figures(curve.error_estimate)), format_number(mark.friction, curve.error_estimate)


def mark_table(curve: StribeckCurve, changes: Sequence[str] = ()) -> list[str]:
    """Return the transitions of a curve, with what it takes to get there where that is given."""
    rows = [("transition", str(curve.over), *(["change"] if changes else []), "friction")]
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


def _doubts(checks: Checks | None, notes: Sequence[str]) -> list[str]:
    """Return what the first line leaves of doubtful checks and of notes, shortened to a few lines of a terminal."""
    sentences = [f"Note: {note}" for note in notes if checks is None or not checks.covers(note, doubts=True)]
    if checks is not None:
        doubtful = (each.sentence for each in checks.with_verdict("doubtful") if each.sentence not in checks.first_line)
        sentences = [*(f"Doubtful: {sentence}" for sentence in doubtful), *sentences]
    # A first line that says much leaves less room below.
    room = max(1, NOTE_LINES - (len(checks.first_line) // SCREEN_WIDTH if checks is not None else 0))
    lines = max(1, room // max(1, len(sentences)))
    return [textwrap.shorten(each, lines * SCREEN_WIDTH, placeholder=" ...") for each in sentences[:room]]
