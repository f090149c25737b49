"""The numbers of an answer, each with its error, as rows and as HTML."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from html import escape

from stribeck.contacts.friction import Definition
from stribeck.contacts.geometries import INPUT_TABLES
from stribeck.explorer.answer import Answer
from stribeck.quantities.formats import format_factor, format_percent, format_si
from stribeck.quantities.number import Number
from stribeck.regimes.margin_scan import Crossing
from stribeck.regimes.margins import RegimeMargins
from stribeck.regimes.sentences import ways_to
from stribeck.solver.base_solution import BaseSolution, regime_of_state
from stribeck.solver.numbers import report_rows

# Numbers of a state that the page leaves to files: the parts of friction, and where the film is least.
LEFT_OUT = (
    *("friction_asperities", "friction_balanced_fluid", "friction_published_fluid"),
    *("minimum_film_position", "minimum_film_radius", "minimum_angle", "undeformed_height"),
)

# Rows that stand side by side for pinned contacts.
COMPARED = ("central_film_thickness", "minimum_film_thickness", "lambda_ratio", "fluid_load_share", "hersey_number")

TRANSITION_LABELS = {
    "boundary": "Speed at end of boundary regime",
    "hydrodynamic": "Speed at start of hydrodynamic regime",
    "minimum": "Speed of minimum friction",
}

# The regime that is entered where a transition is passed.
ENTERED = {
    ("boundary", "boundary"): "mixed",
    ("mixed", "boundary"): "boundary",
    ("mixed", "hydrodynamic"): "hydrodynamic",
    ("hydrodynamic", "hydrodynamic"): "mixed",
}

MEANINGS = {
    "boundary": "the fluid carries at most 5 % of the load",
    "mixed": "fluid and asperities both carry the load",
    "hydrodynamic": "asperities cause at most 10 % of the friction",
}


@dataclass(frozen=True)
class Row:
    """One number."""

    key: str  # Its name in the package
    label: str  # Its name in words
    value: float  # The number, in SI units
    error: float  # Its estimated absolute error; zero for what follows from the inputs alone, nan where it is not known
    text: str  # The number as shown, with its unit
    tip: str = ""  # The error of the solver, for a tooltip
    interval: str = ""  # The 95 % interval by the errors of the inputs; empty where none are given


def numbers(answer: Answer) -> list[Row]:
    """Return the numbers of the state with their intervals, and the nearest transitions."""
    spread, films = answer.spread, {row.name: row.film for row in answer.solution.outputs.rows if row.film}
    known = {} if spread is None else {each.name: _plain(each.texts[1]) for each in spread.spreads}
    names = {films.get(name, name): text for name, text in known.items()}
    names[f"friction_{answer.inputs.case.definition}"] = known.get("friction", "")
    rows = state_rows(answer.solution, answer.inputs.case.definition)
    return [*(replace(row, interval=names.get(row.key, "")) for row in rows), *_transition_rows(answer)]


def state_rows(solution: BaseSolution, definition: Definition) -> Iterator[Row]:
    """Yield the numbers of a state that the page shows, with the share of asperities in its friction."""
    friction = solution.friction(definition=definition)
    share = friction.contact_share, friction.relative_error
    numbers = [each for each in report_rows(solution) if each.name not in LEFT_OUT]
    for each in (*numbers, Number("contact_friction_share", "share of asperities in friction", "", *share)):
        value, error = map(_plain, each.texts)
        tip = "from the inputs" if each.error == 0 else error
        yield Row(each.name, each.label[0].upper() + each.label[1:], each.value, each.error, value, tip)


def _transition_rows(answer: Answer) -> Iterator[Row]:
    """Yield by which factor of the speed boundary lubrication ends and hydrodynamic lubrication begins."""
    speed = answer.inputs.contact.speed
    margins = answer.margins if isinstance(answer.margins, RegimeMargins) and "margins" not in answer.stale else None
    over = {} if margins is None else {each.name: each for each in margins.margins}
    for name, label in TRANSITION_LABELS.items():
        key = f"speed_factor_{name}"
        mark = None if answer.curve is None else answer.curve.marks.get(name)
        if mark is None:
            yield Row(key, label, math.nan, math.nan, "not solved yet" if "curve" in answer.stale else "none")
            continue
        factor = mark.value / speed if speed > 0 else math.inf
        text = _plain(format_si(mark.value, "speed"))
        text = f"{text} ({_times(factor)})" if speed > 0 else text
        tip = "located on solved states" if math.isnan(mark.error) else f"± {format_percent(mark.error, 1)}"
        entered = ENTERED.get((answer.regime, name), "")
        crossing = over["speed"].crossing_into(entered) if "speed" in over else None
        yield Row(key, label, factor, factor * mark.error, text, tip, "" if crossing is None else _interval(crossing))


def _interval(mark: Crossing) -> str:
    """Return the 95 % interval of a factor, which is multiplied with or divided by as the factor itself."""
    if mark.interval_95 is None:
        return ""
    larger = mark.factor >= 1
    low, high = sorted(mark.interval_95 if larger else (1 / end for end in mark.interval_95))
    return f"{'×' if larger else '÷'} {format_factor(low)} to {format_factor(high)}"


def _times(factor: float) -> str:
    return f"× {format_factor(factor)}" if factor >= 1 else f"÷ {format_factor(1 / factor)}"


def _plain(text: str) -> str:
    return text.replace("*", "·")


def numbers_html(answer: Answer, rows: Sequence[Row]) -> str:
    """Return regime, numbers and notes as HTML; each value stands in full in ``data-value``."""
    notes = [note for note in answer.solution.notes if not answer.checks.covers(note)]
    notes += [] if answer.spread is None else answer.spread.sources
    head = '<tr><td></td><td></td><th scope="col">95 %</th></tr>' if any(row.interval for row in rows) else ""
    regime = f'<div class="regime {answer.regime}" data-key="regime" data-value="{answer.regime}">{answer.regime}'
    lines = "".join(map(_line, rows))
    return f"{regime}<small>{MEANINGS[answer.regime]}</small></div><table>{head}{lines}</table>{notes_html(notes)}"


def _line(row: Row) -> str:
    solver = f"error of the solver: {row.tip}" if row.tip.startswith("±") else row.tip
    tip = f' title="{escape(solver)}"' if solver else ""
    return (
        f'<tr data-key="{row.key}" data-value="{row.value!r}" data-error="{row.error!r}">'
        f'<th scope="row">{escape(row.label)}</th><td{tip}>{escape(row.text)}</td><td>{escape(row.interval)}</td></tr>'
    )


def verdict_html(answer: Answer) -> str:
    """Return the verdict of the checks as HTML: what ``stribeck check`` says first, and the sentences behind it."""
    checks = answer.checks
    look = f'class="verdict {checks.verdict}" data-key="verdict" data-value="{checks.verdict}"'
    if not checks.said:
        return f"<p {look}>{escape(checks.headline)}</p>"
    more = "".join(f"<p>{escape(each.sentence)}</p>" for each in checks.said)
    opened = " open" if checks.verdict == "outside" else ""
    return f"<details {look}{opened}><summary>{escape(checks.headline)}</summary>{more}</details>"


def notes_html(notes: Iterable[str]) -> str:
    """Return notes as HTML."""
    found = "".join(f'<p class="note">{escape(note)}</p>' for note in notes if note)
    return found.replace("lambda ", "λ ").replace("wetted_radius", "a radius of the wetted disc")


def comparison_html(answer: Answer) -> str:
    """Return numbers of the pinned contacts beside those of the present one; empty where nothing is pinned."""
    if not answer.pins:
        return ""
    states: list[tuple[str, BaseSolution, Definition]] = [("present", answer.solution, answer.inputs.case.definition)]
    states += [(pin.name, pin.state, pin.definition) for pin in answer.pins]
    found: dict[str, list[str]] = {"": [], "Regime": [], "Friction µ": []}
    for name, state, definition in states:
        rows = {row.key: row for row in state_rows(state, definition)}
        said = {"": name, "Regime": regime_of_state(state, definition), "Friction µ": rows[f"friction_{definition}"].text}
        for label, text in (said | {rows[key].label: rows[key].text for key in COMPARED}).items():
            found.setdefault(label, []).append(text)
    head, *lines = found.items()
    cells = "".join(f'<th scope="col">{escape(name)}</th>' for name in head[1])
    html = [f"<table><tr><td></td>{cells}</tr>"]
    for label, texts in lines:
        html.append(f'<tr><th scope="row">{escape(label)}</th>{"".join(f"<td>{escape(text)}</td>" for text in texts)}</tr>')
    return "".join([*html, "</table>"])


def margins_html(margins: RegimeMargins) -> str:
    """Return the margins to the next regimes in each input as HTML."""
    lines = ["<table><tr><td></td>", *(f'<th scope="col">to {target}</th>' for target in margins.targets), "</tr>"]
    for margin in margins.margins:
        lines.append(f'<tr data-key="{margin.name}"><th scope="row">{margin.name}</th>')
        for target in margins.targets:
            mark = margin.crossing_into(target)
            if mark is None:
                another = margin.less is not None or margin.more is not None  # at which the search that way ended
                lines.append(f"<td>{'not directly' if another else 'not reachable'}</td>")
                continue
            value = _plain(format_si(mark.value, INPUT_TABLES[margins.geometry].quantities[margin.name].dimension))
            factor = f"{_times(mark.factor)} " if 0 < mark.factor < math.inf else ""
            interval = f"<br><small>95 %: {_interval(mark)}</small>" if mark.interval_95 is not None else ""
            lines.append(f'<td data-value="{mark.factor!r}">{factor}<small>({escape(value)})</small>{interval}</td>')
        lines.append("</tr>")
    exact = (f'<p class="caption">{escape(line)}</p>' for line in ways_to(margins) if "exact" in line)
    return "".join([*lines, "</table>", *exact, notes_html(margins.notes)])
