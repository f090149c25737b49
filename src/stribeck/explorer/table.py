"""The numbers of an answer, each with its error, as rows for the page."""

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any

from stribeck.contacts.friction import Definition
from stribeck.contacts.geometries import INPUT_TABLES
from stribeck.explorer.answer import Answer
from stribeck.quantities.formats import Number, format_factor, format_percent, format_si
from stribeck.regimes.margins import Crossing, RegimeMargins
from stribeck.solver.base_solution import BaseSolution, regime_of_state
from stribeck.solver.numbers import report_rows

# Numbers of a state that the page leaves to files: the parts of friction, and where the film is least.
LEFT_OUT = (
    *("friction_asperities", "friction_balanced_fluid", "friction_published_fluid"),
    *("minimum_film_position", "minimum_film_radius", "minimum_angle", "undeformed_height"),
)

SHARE = "share of asperities in friction"

# Rows that stand side by side for pinned contacts.
COMPARED = ("central_film_thickness", "minimum_film_thickness", "lambda_ratio", "fluid_load_share", "hersey_number")

TRANSITION_LABELS = {
    "boundary": "Speed at end of boundary regime",
    "hydrodynamic": "Speed at start of hydrodynamic regime",
    "minimum": "Speed of minimum friction",
}

TRANSITION_HELP = "where the curve passes from one regime to the next, and how far that is from the present speed"

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
    help: str = ""  # What it is
    tip: str = ""  # The error of the solver, in a sentence
    interval: str = ""  # The 95 % interval by the errors of the inputs; empty where none are given


def numbers(answer: Answer) -> list[Row]:
    """Return the numbers of the state with their intervals, and the nearest transitions."""
    spread = answer.spread
    names = {} if spread is None else {each.name: _plain(each.texts[1]) for each in spread.spreads}
    names[f"friction_{answer.inputs.case.definition}"] = names.get("friction", "")
    rows = state_rows(answer.solution, answer.inputs.case.definition)
    return [*(replace(row, interval=names.get(row.key, "")) for row in rows), *_transition_rows(answer)]


def state_rows(solution: BaseSolution, definition: Definition) -> Iterator[Row]:
    """Yield the numbers of a state that the page shows, with the share of asperities in its friction."""
    friction = solution.friction(definition=definition)
    share = friction.contact_share, friction.relative_error
    numbers = [each for each in report_rows(solution) if each.name not in LEFT_OUT]
    of_asperities = Number(
        "contact_friction_share", SHARE, f"{SHARE}: the rest is shear of the fluid", *share, is_bounded=True
    )
    for each in (*numbers, of_asperities):
        value, error = map(_plain, each.texts)
        tip = f"Error of the solver: {error}." if error else "It has no stated error."
        tip = "It follows from the inputs." if each.error == 0 else tip
        yield Row(each.name, each.label[0].upper() + each.label[1:], each.value, each.error, value, each.meaning, tip)


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
        is_solved = math.isnan(mark.error)
        tip = "Located on solved states." if is_solved else f"Error of the solver: ± {format_percent(mark.error, 1)}."
        entered = ENTERED.get((answer.regime, name), "")
        crossing = over["speed"].crossing_into(entered) if "speed" in over else None
        interval = "" if crossing is None else _interval(crossing)
        yield Row(key, label, factor, factor * mark.error, text, TRANSITION_HELP, tip, interval)


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


def main_of(answer: Answer, rows: Iterable[Row]) -> dict[str, Any]:
    """Return what comes first: regime, friction, film over roughness, the verdict of the checks, and what to change."""
    found, checks = {row.key: row for row in rows}, answer.checks
    wanted = {f"friction_{answer.inputs.case.definition}": "Friction", "lambda_ratio": "Film over roughness"}
    return {
        "regime": answer.regime,
        "meaning": MEANINGS[answer.regime],
        "main": [[label, found[key].text, found[key].interval] for key, label in wanted.items() if key in found],
        "verdict": checks.verdict,
        "headline": checks.headline,
        "reasons": [each.sentence for each in checks.said],
        "ways": change_rows(answer),
    }


def without_rtol(sentence: str) -> str:
    """Return a sentence about a failure without advice on the tolerance, which the page does not offer."""
    left = re.sub(r"[;,]? *\b(?:ask for|or)\b[^.;]*\brtol\b[^.;]*", "", sentence)
    return re.sub(r"\brtol\b", "tolerance", left)


def notes_of(notes: Iterable[str]) -> list[str]:
    """Return notes with the words of the page."""
    return [each.replace("lambda ", "λ ").replace("wetted_radius", "a radius of the wetted disc") for each in notes if each]


def notes_of_state(answer: Answer) -> list[str]:
    """Return the notes on a state and on what to change, and which errors the intervals count."""
    of_state = answer.solution.notes_for(definition=answer.inputs.case.definition)
    notes = [note for note in of_state if not answer.checks.covers(note)]
    margins = answer.margins
    about = [margins.counted, *margins.notes] if isinstance(margins, RegimeMargins) else [without_rtol(margins or "")]
    return notes_of(dict.fromkeys([*notes, *([] if answer.spread is None else answer.spread.sources), *about]))


def comparison(answer: Answer) -> list[list[str]]:
    """Return numbers of the pinned contacts beside those of the present one, names first; empty where nothing is pinned."""
    if not answer.pins:
        return []
    states: list[tuple[str, BaseSolution, Definition]] = [("present", answer.solution, answer.inputs.case.definition)]
    states += [(pin.name, pin.state, pin.definition) for pin in answer.pins]
    columns = []
    for name, state, definition in states:
        rows = {row.key: row for row in state_rows(state, definition)}
        said = {"": name, "Regime": regime_of_state(state, definition), "Friction µ": rows[f"friction_{definition}"].text}
        columns.append(said | {rows[key].label: rows[key].text for key in COMPARED})
    # The Hersey number of a ball is another one than that of a cylinder.
    return [[label, *(each.get(label, "") for each in columns)] for label in dict.fromkeys(chain(*columns))]


def change_rows(answer: Answer) -> list[list[list[str]]]:
    """Return what each input alone would have to be for the next regimes: a head, then cells.

    A cell is a text, a smaller one beside it, the factor, and a mark where it is the smallest change that does it.
    """
    margins = answer.margins
    if not isinstance(margins, RegimeMargins) or "margins" in answer.stale:
        return _changes_of_speed(answer)
    quantities, columns = INPUT_TABLES[margins.geometry].quantities, []
    for target in margins.targets:
        found = [(margin, margin.crossing_into(target)) for margin in margins.margins]
        least = min((abs(math.log(mark.factor)) for _, mark in found if mark and 0 < mark.factor < math.inf), default=math.nan)
        column = (
            [f"to {target}", "", "", ""],
            *(
                _change(mark.factor, mark.value, quantities[margin.name].dimension, _interval(mark), least)
                if mark
                else ["not directly" if margins.is_beyond(target, margin) else "not reachable", "", "", ""]
                for margin, mark in found
            ),
        )
        columns.append(column)
    names = ["", *(margin.name for margin in margins.margins)]
    return [[[name, "", "", ""], *cells] for name, *cells in zip(names, *columns, strict=True)]


def _changes_of_speed(answer: Answer) -> list[list[list[str]]]:
    """Return the same rows by the curve, which knows the speeds alone."""
    speed = answer.inputs.contact.speed
    marks = {} if answer.curve is None or "curve" in answer.stale or speed == 0 else answer.curve.marks
    passed = {into: mark.value for name, mark in marks.items() if (into := ENTERED.get((answer.regime, name)))}
    rows = {"": [[f"to {each}", "", "", ""] for each in passed]}
    rows["speed"] = [_change(value / speed, value, "speed") for value in passed.values()]
    if "margins" in answer.stale:
        rows |= dict.fromkeys(("load", "roughness", "viscosity"), [["...", "", "", ""]] * len(passed))
    return [[[name, "", "", ""], *cells] for name, cells in rows.items()] if passed else []


def _change(factor: float, value: float, dimension: str, interval: str = "", least: float = math.nan) -> list[str]:
    small = f"({_plain(format_si(value, dimension))}){f' 95 %: {interval}' if interval else ''}"
    if not 0 < factor < math.inf:
        return ["", small, "", ""]
    return [_times(factor), small, repr(factor), "least" if abs(math.log(factor)) == least else ""]
