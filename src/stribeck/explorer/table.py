"""The numbers of an answer, each with its error, as rows and as HTML."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from html import escape

from stribeck.contacts.friction import Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.explorer.answer import Answer
from stribeck.explorer.curves import Transition
from stribeck.quantities.formats import format_factor, format_si
from stribeck.quantities.inputs import INPUT_TABLES
from stribeck.quantities.outputs import RUPTURE_ROWS
from stribeck.regimes.margin_scan import Crossing
from stribeck.regimes.margins import RegimeMargins
from stribeck.regimes.sentences import ways_to
from stribeck.solver.base_solution import BaseSolution, regime_of_state

__all__ = ["Row", "comparison_html", "curve_notes_html", "margins_html", "numbers", "numbers_html", "verdict_html"]

MAX_DIGITS = 4  # Digits of a number in the table.


@dataclass(frozen=True)
class Row:
    """One number."""

    key: str  # Its name in the package
    label: str  # Its name in words
    value: float  # The number, in SI units
    error: float  # Its estimated absolute error; zero for what follows from the inputs alone, nan where it is not known
    text: str  # The number as shown, with its unit
    error_text: str  # The error of the solver as shown, in a tooltip
    interval: str = ""  # The 95 % interval by the errors of the inputs; empty where none are given


def numbers(answer: Answer, margins: RegimeMargins | None = None) -> list[Row]:
    """Return friction by both definitions, shares, films and their ends, ratios and the nearest transitions."""
    solution, contact = answer.solution, answer.inputs.contact
    errors, scales = solution.errors, contact.hertz
    rows = []
    for definition, name in (("balanced", "Friction µ, balanced"), ("published", "Friction µ, as published")):
        friction = solution.friction(definition=definition)
        rows.append(_row(f"friction_{definition}", name, friction.total, friction.error))
    chosen = solution.friction(definition=answer.inputs.definition)
    if chosen.total != 0:
        error = chosen.error / (abs(chosen.contact) + abs(chosen.viscous))
        rows.append(_share("contact_friction_share", "Friction from asperities", chosen.contact_share, error))
    observed = solution.outputs.rows
    for each in (each for each in observed[::-1] if each.error == "absolute"):
        rows.append(_share(each.name, each.label.capitalize(), getattr(solution, each.name), errors[each.name]))
    film_errors = errors | {"minimum_gap": getattr(solution, "minimum_gap_error", errors.get("minimum_gap", math.nan))}
    for each in (each for each in observed if each.film and each.scale == "gap"):
        film, error = getattr(solution, each.name) * scales.indentation, film_errors.get(each.name, math.nan)
        rows.append(_row(each.film, each.label.capitalize(), film, abs(film) * error, "length"))
    for each in (each for each in observed if each in RUPTURE_ROWS):
        place, a = getattr(solution, each.name), scales.half_width
        if math.isfinite(place):
            rows.append(
                _row(each.film, each.label.capitalize(), place * a, max(abs(place), 1.0) * errors[each.name] * a, "length")
            )
    ratio = solution.lambda_ratio
    rows.append(
        _row("lambda_ratio", "Lambda ratio h<sub>min</sub>/h<sub>rms</sub>", ratio, abs(ratio) * film_errors["minimum_gap"])
    )
    symbol = RULES[contact.groups.geometry].hersey_symbol.replace("F_N", "F<sub>N</sub>")
    rows.append(_row("hersey_number", f"Hersey number {symbol}", contact.hersey_number, 0.0))
    known = _intervals(answer)
    rows = [replace(row, interval=known.get(row.key, "")) for row in rows]
    return rows + _transition_rows(answer, margins)


def _intervals(answer: Answer) -> dict[str, str]:
    """Return the 95 % interval of each number that the errors of the inputs leave open."""
    if answer.spread is None:
        return {}
    films = {each.name: each.film for each in answer.solution.outputs.rows if each.film}
    named = {"friction": f"friction_{answer.inputs.definition}", **films}
    found = {}
    for each in answer.spread.spreads:
        ends = each.interval_95
        if each.name.endswith("_share"):
            text = " to ".join(f"{100 * end:.3g}" for end in ends) + " %"
        else:
            text = " to ".join(format_si(end, each.dimension).replace("*", "·") for end in ends)
        found[named.get(each.name, each.name)] = text
    return found


def _transition_rows(answer: Answer, margins: RegimeMargins | None) -> list[Row]:
    """Return by which factor of the speed boundary lubrication ends and hydrodynamic lubrication begins."""
    names = {
        "boundary": "Speed at end of boundary regime",
        "hydrodynamic": "Speed at start of hydrodynamic regime",
        "minimum": "Speed of minimum friction",
    }
    rows = []
    for name, label in names.items():
        mark = None if answer.curve is None else answer.curve.transition(name)
        key = f"speed_factor_{name}"
        if mark is None:
            waits = answer.curve is None or answer.curve.stale
            rows.append(Row(key, label, math.nan, math.nan, "not solved yet" if waits else "none", ""))
            continue
        text = format_si(mark.speed, "speed").replace("*", "·")
        speed = answer.inputs.contact.speed
        factor = mark.speed / speed if speed > 0 else math.inf
        if speed > 0:
            text = f"{text} ({_times(factor)})"
        interval = _factor_interval(answer.regime, name, margins)
        rows.append(Row(key, label, factor, factor * mark.error, text, _relative(mark), interval))
    return rows


def _factor_interval(regime: str, name: str, margins: RegimeMargins | None) -> str:
    """Return the 95 % interval of the factor in speed to a transition that ends the present regime."""
    into = {("boundary", "boundary"): "mixed", ("mixed", "boundary"): "boundary"}
    into |= {("mixed", "hydrodynamic"): "hydrodynamic", ("hydrodynamic", "hydrodynamic"): "mixed"}
    speeds = None if margins is None else next((each for each in margins.margins if each.name == "speed"), None)
    mark = None if speeds is None else speeds.crossing_into(into.get((regime, name), ""))
    return "" if mark is None else _interval(mark)


def _interval(mark: Crossing) -> str:
    """Return the 95 % interval of a factor, which is multiplied with or divided by as the factor itself."""
    if mark.interval_95 is None:
        return ""
    larger = mark.factor >= 1
    low, high = sorted(mark.interval_95 if larger else (1 / end for end in mark.interval_95))
    return f"{'×' if larger else '÷'} {format_factor(low)} to {format_factor(high)}"


def _relative(mark: Transition) -> str:
    return "located on solved states" if math.isnan(mark.error) else f"± {_small(100 * mark.error)} %"


def _times(factor: float) -> str:
    return f"× {format_factor(factor)}" if factor >= 1 else f"÷ {format_factor(1 / factor)}"


def _share(key: str, label: str, value: float, error: float) -> Row:
    if value <= error:
        return Row(key, label, value, error, f"< {_small(100 * error)} %", "")
    text = f"{100 * value:.{_count(value, error)}g} %"
    return Row(key, label, value, error, text, f"± {_small(100 * error)} %")


def _row(key: str, label: str, value: float, error: float, dimension: str = "number") -> Row:
    if math.isinf(value):
        return Row(key, label, value, 0.0, "∞ (smooth)", "")
    number, _, unit = format_si(value, dimension, _count(value, error)).replace("*", "·").partition(" ")
    scale = float(number) / value if unit and value else 1.0
    mantissa, power, exponent = number.partition("e")
    number = f"{mantissa}e{int(exponent)}" if power else number
    if math.isnan(error):
        return Row(key, label, value, error, f"{number} {unit}".rstrip(), "")
    shown = f"± {_small(error * abs(scale))} {unit}".rstrip() if error > 0 else "from the inputs"
    return Row(key, label, value, error, f"{number} {unit}".rstrip(), shown)


def _count(value: float, error: float) -> int:
    """Return how many digits of a value its error leaves, at most :data:`MAX_DIGITS`."""
    if math.isnan(error):
        return 3
    if error <= 0 or value == 0:
        return 5
    return max(1, min(MAX_DIGITS, math.floor(math.log10(abs(value) / error)) + 1))


def _small(error: float) -> str:
    """Return an error with one digit."""
    mantissa, _, exponent = f"{error:.0e}".partition("e")
    return f"{mantissa}e{int(exponent)}" if abs(int(exponent)) > 2 else f"{float(f'{error:.0e}'):g}"


def numbers_html(answer: Answer, rows: Sequence[Row]) -> str:
    """Return regime, numbers and notes as HTML; each value stands in full in ``data-value``."""
    notes = [note for note in answer.solution.notes if not answer.checks.covers(note)]
    notes += [] if answer.spread is None else answer.spread.sources
    head = '<tr><td></td><td></td><th scope="col">95 %</th></tr>' if any(row.interval for row in rows) else ""
    return "".join(
        [
            f'<div class="regime {answer.regime}" data-key="regime" data-value="{answer.regime}">{answer.regime}'
            f"<small>{_regime_text(answer)}</small></div>",
            f"<table>{head}",
            *(_line(row) for row in rows),
            "</table>",
            _notes(notes),
        ]
    )


def _regime_text(answer: Answer) -> str:
    meanings = {
        "boundary": "the fluid carries at most 5 % of the load",
        "mixed": "fluid and asperities both carry the load",
        "hydrodynamic": "asperities cause at most 10 % of the friction",
    }
    return meanings[answer.regime]


def _line(row: Row) -> str:
    solver = f"error of the solver: {row.error_text}" if row.error_text.startswith("±") else row.error_text
    tip = f' title="{escape(solver)}"' if solver else ""
    return (
        f'<tr data-key="{row.key}" data-value="{row.value!r}" data-error="{row.error!r}"><th scope="row">{row.label}</th>'
        f"<td{tip}>{escape(row.text)}</td><td>{escape(row.interval)}</td></tr>"
    )


def verdict_html(answer: Answer) -> str:
    """Return the verdict of the checks as HTML: what ``stribeck check`` says first, and the sentences behind it."""
    checks = answer.checks_with_curve
    sentences = [each.sentence for each in checks.said]
    look = f'class="verdict {checks.verdict}" data-key="verdict" data-value="{checks.verdict}"'
    if not sentences:
        return f"<p {look}>{escape(checks.headline)}</p>"
    more = "".join(f"<p>{escape(sentence)}</p>" for sentence in sentences)
    opened = " open" if checks.verdict == "outside" else ""
    return f"<details {look}{opened}><summary>{escape(checks.headline)}</summary>{more}</details>"


def curve_notes_html(answer: Answer) -> str:
    """Return the notes of the curve as HTML, but for those that the verdict holds."""
    return _notes(note for note in answer.notes if not answer.checks.covers(note))


def _notes(notes: Iterable[str]) -> str:
    found = "".join(f'<p class="note">{escape(note)}</p>' for note in notes if note)
    return found.replace("lambda ", "λ ").replace("wetted_radius", "a radius of the wetted disc")


def comparison_html(answer: Answer, states: Sequence[tuple[str, BaseSolution, Definition]]) -> str:
    """Return the numbers of the pinned contacts beside those of the present one; empty where nothing is pinned."""
    if not states:
        return ""
    columns = [("present", answer.solution, answer.inputs.definition), *states]
    lines = ["<table><tr><td></td>", *(f'<th scope="col">{escape(name)}</th>' for name, _, _ in columns), "</tr>"]
    for label, value in COMPARED.items():
        cells = "".join(f"<td>{escape(value(state, definition))}</td>" for _, state, definition in columns)
        lines.append(f'<tr><th scope="row">{label}</th>{cells}</tr>')
    return "".join([*lines, "</table>"])


def _film(state: BaseSolution, gap: float) -> str:
    assert state.contact is not None
    return format_si(gap * state.contact.hertz.indentation, "length", 3)


COMPARED: dict[str, Callable[[BaseSolution, Definition], str]] = {
    "Regime": regime_of_state,
    "Friction µ": lambda state, definition: f"{state.friction(definition=definition).total:.3g}",
    "Central film": lambda state, _: _film(state, state.central_gap),
    "Minimum film": lambda state, _: _film(state, state.minimum_gap),
    "Lambda ratio": lambda state, _: f"{state.lambda_ratio:.3g}",
    "Load on the fluid": lambda state, _: f"{100 * state.fluid_load_share:.3g} %",
    "Hersey number": lambda state, _: f"{state.hersey_number:.3g}",
}
"""What is compared, and its text."""


def margins_html(margins: RegimeMargins) -> str:
    """Return the margins to the next regimes in each input as HTML."""
    targets = margins.targets
    lines = ["<table><tr><td></td>", *(f'<th scope="col">to {target}</th>' for target in targets), "</tr>"]
    for margin in margins.margins:
        lines.append(f'<tr data-key="{margin.name}"><th scope="row">{margin.name}</th>')
        for target in targets:
            mark = margin.crossing_into(target)
            if mark is None:
                another = margin.less is not None or margin.more is not None  # at which the search that way ended
                lines.append(f"<td>{'not directly' if another else 'not reachable'}</td>")
                continue
            value = format_si(mark.value, INPUT_TABLES[margins.geometry].quantities[margin.name].dimension).replace("*", "·")
            factor = f"{_times(mark.factor)} " if 0 < mark.factor < math.inf else ""
            interval = f"<br><small>95 %: {_interval(mark)}</small>" if mark.interval_95 is not None else ""
            lines.append(f'<td data-value="{mark.factor!r}">{factor}<small>({escape(value)})</small>{interval}</td>')
        lines.append("</tr>")
    exact = (line for line in ways_to(margins) if "exact" in line)
    return "".join([*lines, "</table>", *(f'<p class="caption">{escape(line)}</p>' for line in exact), _notes(margins.notes)])
