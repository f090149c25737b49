"""Formatting shared by all reports: numbers with the digits that their errors allow, headlines, notes, tables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.checks.check import Checks
from stribeck.cli.exits import say
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact, in_words, model_words
from stribeck.contacts.groups import Groups
from stribeck.quantities.formats import format_bound, format_si
from stribeck.quantities.input_rows import ROWS
from stribeck.quantities.outputs import GROUPS
from stribeck.solver.base_solution import BaseSolution

if TYPE_CHECKING:
    from rich.console import Console

    from stribeck.cases.case import Case
    from stribeck.curves.landmarks import Landmark
    from stribeck.curves.result import StribeckCurve

# Inputs that a designer can change; alpha and beta follow from the surface.
DESIGN_INPUTS = tuple(row.name for row in ROWS if not row.derived and not row.follows_surface)

MIN_TABLE_WIDTH = 100  # Smallest width of a table [columns].

Sensitivities = dict[str, float]


def hersey_of(solution: BaseSolution, beta: float | None) -> float:
    """Return the Hersey number, of groups by the beta of the contact law."""
    if solution.contact is None and beta is not None:
        return float(solution.groups.hersey_number(beta))
    return solution.hersey_number


def most_sensitive_input(sensitivities: Sensitivities) -> str | None:
    """Return the input to which friction is most sensitive; None if there is none."""
    found = max(DESIGN_INPUTS, key=lambda name: abs(np.nan_to_num(sensitivities[name])))
    return found if abs(np.nan_to_num(sensitivities[found])) > 0 else None


def place(curve: StribeckCurve, value: float, digits: int = 3) -> str:
    """Return a value of the quantity that varies along a curve, with its unit."""
    if curve.contact is None:
        return f"{value:.{digits}g}"
    return format_si(value, curve.contact.INPUTS.quantities[curve.over].dimension, digits)


def mark_texts(curve: StribeckCurve, mark: Landmark) -> tuple[str, str]:
    """Return where a landmark of a curve lies, and the friction there, with the digits that the curve's error allows."""
    return place(curve, mark.value, figures(curve.error_estimate)), digits(mark.friction, curve.error_estimate)


def digits(value: float, error: float) -> str:
    """Return a number with the digits that its relative error allows."""
    if not math.isfinite(value):
        return "none" if math.isnan(value) else "infinite"
    return f"{value:.{figures(error)}g}"


def length(value: float, error: float) -> str:
    """Return a length with the digits that its relative error allows."""
    if not math.isfinite(value):
        return ""
    return format_si(value, "length", figures(error))


def figures(error: float) -> int:
    """Return how many digits a relative error allows, 3 to 4: files and JSON have all of them."""
    return 4 if error <= 0 else min(4, max(3, math.ceil(-math.log10(error))))


def error_text(relative: float) -> str:
    """Return a relative error as text."""
    return f"{relative:.0e}" if math.isfinite(relative) else ""


def part(value: float, error: float) -> str:
    """Return a part of a sum with the digits that its absolute error allows, or a bound."""
    if 0 < value <= error:
        return format_bound(error)
    return digits(value, error / value if value > 0 else error)


def print_head(
    console: Console,
    title: str,
    contact: Contact | None,
    groups: Groups,
    over: str | None = None,
    checks: Checks | None = None,
) -> None:
    """Print whether the model applies if it does not, the headline, the inputs and the groups, without those that vary."""
    print_first(console, checks)
    if title:
        say(console, title, "bold")
    if contact is not None:
        shown = [
            f"{contact.INPUTS.quantities[name].label} {format_si(value, contact.INPUTS.quantities[name].dimension, 4)}"
            for name, value in contact.inputs()
            if name != over
        ]
        say(console, f"Contact: {', '.join(shown)}.")
    constant = []
    for name in GROUPS:
        values = np.asarray(getattr(groups, name))
        if values.ndim == 0 or (len(values) and np.ptp(values) <= 1e-12 * values[0]):
            constant.append(f"{name} {float(values.flat[0]):.6g}")
    say(console, f"Groups: {', '.join(constant)}.")
    if groups.law is not None:
        say(console, law_sentence(groups.law))
    model = model_words(groups, contact)
    if model:
        say(console, f"Model: {model}.")


def law_sentence(law: AsperityLaw) -> str:
    """Return name and parameters of a contact law as a sentence."""
    numbers = in_words(law.parameters)
    return f"Contact law: {law.name}{f' ({numbers})' if numbers else ''}."


def print_outcome(
    console: Console,
    outcome: str,
    error: float,
    notes: Sequence[str],
    checks: Checks | None = None,
    others: Mapping[str, float] | None = None,
) -> None:
    """Print how a solve ended, its error, those of other quantities that are larger, and what :func:`print_first` leaves."""
    larger = sorted(((value, name) for name, value in (others or {}).items() if value > error), reverse=True)
    errors = [f"{value:.1e} of the {name}" for value, name in larger]
    found = ", ".join([*errors, f"{error:.1e} of the rest" if errors else f"{error:.1e}"])
    say(console, f"{outcome} Largest estimated relative error: {found}.")
    for note in notes:
        if checks is None or not checks.covers(note):
            say(console, f"Note: {note}", "yellow")


def print_first(console: Console, checks: Checks | None) -> None:
    """Print first, if a check is outside, that the model does not apply."""
    if checks is not None and checks.first_line:
        say(console, checks.first_line, "bold red")


def print_conversions(console: Console, case: Case | None) -> None:
    """Print the conversions of data-sheet inputs."""
    for sentence in () if case is None else case.conversions:
        say(console, f"Converted: {sentence}")


def conversions_json(case: Case | None) -> dict[str, Any]:
    """Return the conversions of data-sheet inputs; empty if there are none."""
    return {"conversions": list(case.conversions)} if case is not None and case.conversions else {}


def table_of(*columns: str, right: Sequence[int] = ()) -> Any:
    """Return an empty table with these columns."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for i, name in enumerate(columns):
        table.add_column(name, justify="right" if i in right else "left", no_wrap=True)
    return table


def print_table(console: Console, table: Any) -> None:
    """Print a table; in a narrow terminal it is wide rather than cut."""
    from rich.console import Console as Wide

    Wide(file=console.file, width=max(MIN_TABLE_WIDTH, console.width)).print(table)
