"""Content of a report: inputs with their sources, checks, regime, films, margins and levers, all solved here."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import date
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

from stribeck.cases.case import Case
from stribeck.checks.check import Checks
from stribeck.contacts.contact import model_words
from stribeck.contacts.parts import PART_INPUTS
from stribeck.curves.result import StribeckCurve
from stribeck.fits.measurements import Measurements, read_measurements
from stribeck.quantities.formats import format_percent, format_si
from stribeck.regimes.levers import MAX_FACTOR, Lever, cheapest_levers
from stribeck.regimes.overview import Overview, overview_of
from stribeck.regimes.sentences import regime_sentence, ways_to
from stribeck.solver.numbers import main_rows
from stribeck.solver.solution import Solution
from stribeck.uncertainty.result import Uncertainty

# What a report says of its certainty if no input has an error.
NO_ERRORS_TEXT = (
    'With errors of the inputs, as in roughness = "1.0 +- 0.2 um", this page has intervals and the probability of each regime.'
)

NO_LEVERS_TEXT = f"No single input lowers friction by a fifth within a factor of {MAX_FACTOR:g}."


class InputLine(NamedTuple):
    """One input: label, value, error, and source as stated in the file."""

    label: str
    value: str
    error: str
    source: str


class Section(NamedTuple):
    """A part of the page: a heading, a table whose first row names its columns, and paragraphs below."""

    heading: str
    table: Sequence[Sequence[str]] = ()
    paragraphs: Sequence[str] = ()


@dataclass(frozen=True)
class Content:
    """Content of a report."""

    title: str
    headline: str  # Whether the model applies
    inputs: tuple[InputLine, ...]
    conversions: tuple[str, ...]  # Conversions of data-sheet inputs
    checks: Checks
    sentences: tuple[str, ...]  # Regime, friction and load share
    films: tuple[tuple[str, str, str], ...]  # Label, value and 95 % interval of friction, films and transitions
    uncertainty: Uncertainty | None  # The propagated errors of the inputs
    margins: tuple[str, ...]  # Margins to the next regimes
    levers: tuple[Lever, ...]  # The two inputs that lower friction by a fifth with the smallest change
    notes: tuple[str, ...]  # Notes on the validity of the numbers
    versions: str  # Program and libraries
    curve: StribeckCurve  # Friction over the speed
    solution: Solution  # The state
    data: Measurements | None = None  # Measured friction

    @property
    def sections(self) -> list[Section]:
        """The parts of the page below its picture."""
        interval = slice(3 if self.uncertainty else 2)
        films = [("Quantity", "Value", "95 %"), *self.films]
        levers = [("To lower friction by about a fifth", "Change", "Friction solved there")]
        levers += [(lever.label, *lever.texts) for lever in self.levers]
        checks = [("Check", "Value", "Fine", "Verdict"), *((each.name, *each.texts, each.verdict) for each in self.checks)]
        said = [f"{each.word}: {each.sentence}" for each in self.checks.said]
        read = f"{len(self.data)} rows of {self.data.path or 'measured friction'}, drawn as read." if self.data else ""
        found = [
            Section("Friction, films and transitions", [row[interval] for row in films]),
            Section("Margins to the next regimes", (), self.margins or ["There is no other regime in reach."]),
            Section("The two cheapest levers", levers if self.levers else (), () if self.levers else [NO_LEVERS_TEXT]),
            Section(
                "Inputs",
                [("Input", "Value", "Error", "Source, from the case file"), *self.inputs],
                [f"Converted: {each}" for each in self.conversions],
            ),
            Section("Does the model apply?", checks, said + [f"Not checked: {each}" for each in self.checks.unchecked]),
            Section("Data", (), [read, *self.data.notes] if self.data else ()),
            Section("Notes", (), self.notes),
        ]
        return [each for each in found if each.table or each.paragraphs]


def content_of(
    case: Case, data: str | Path | Measurements | None = None, on_step: Callable[[int, int], object] | None = None
) -> Content:
    """Solve the content of a report."""
    measured = read_measurements(data, case.fit) if isinstance(data, str | Path) else data
    found = overview_of(case, on_step, is_whole=True)
    solution, checks, errors, friction = found.solution, found.checks, found.errors, found.friction
    assert checks is not None
    certainty = [NO_ERRORS_TEXT] if errors is None else [errors.probability_sentence, *errors.sources]
    return Content(
        title=case.title or case.path.name,
        headline=checks.headline,
        inputs=_inputs(case),
        conversions=case.conversions,
        checks=checks,
        sentences=(regime_sentence(solution, friction), *certainty),
        films=_films(found),
        uncertainty=errors,
        margins=tuple(ways_to(found.margins)),
        levers=cheapest_levers(case.contact, friction.total, found.sensitivities, case.definition, case.rtol),
        notes=tuple(note for note in dict.fromkeys(found.notes) if not checks.covers(note, doubts=True)),
        versions=_versions(case),
        curve=found.curve,
        solution=solution,
        data=measured,
    )


def _inputs(case: Case) -> tuple[InputLine, ...]:
    sources = _sources(case.path)
    lines = []
    for name, value in case.contact.inputs():
        table = case.contact.INPUTS
        row, error = table.kept[name], case.errors.get(name)
        names = (name, *(each for each, of in (table.stands_for | {"h_rms": "roughness"}).items() if of == name))
        source = next((sources[each] for each in names if each in sources), "")
        shown = "" if error is None else f"± {format_percent(error)}"
        lines.append(InputLine(row.label, format_si(value, row.dimension, 4), shown, source))
    model = model_words(case.contact.groups, case.contact)
    uncertain = [
        f"{row.label} ± {format_percent(case.errors[name])}" for name, row in PART_INPUTS.items() if name in case.errors
    ]
    return (*lines, *([InputLine("model", model, ", ".join(uncertain), "")] if model else []))


def _sources(path: Path) -> dict[str, str]:
    """Return the comments of a case file, those above each key and behind it on its line."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except OSError:
        return {}
    found: dict[str, str] = {}
    above: list[str] = []
    for line in lines:
        if line.lstrip().startswith("#"):
            above.append(line.strip().lstrip("# "))
            continue
        key = re.match(r"\s*(\w+)\s*=\s*(?:\"[^\"]*\"|[^#\"]*)(?:#\s*(.*))?$", line)
        if key:
            found.setdefault(key[1], " ".join([*above, key[2] or ""]).strip())
        above = []
    return {name: text for name, text in found.items() if text}


def _films(found: Overview) -> tuple[tuple[str, str, str], ...]:
    if found.errors is not None:
        return tuple((each.label, *each.texts) for each in found.errors.spreads)
    numbers = ((each.label, each.texts[0], "") for each in main_rows(found.solution, definition=found.curve.definition))
    return (*numbers, *((str(mark.name), format_si(mark.value, "speed"), "") for mark in found.curve.transitions))


def _versions(case: Case) -> str:
    libraries = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy"))
    law = "exponential" if case.contact.law is None else case.contact.law.name
    return (
        f"stribeck {version('stribeck')}, {libraries}; contact law: {law}; friction: {case.definition}; "
        f"relative tolerance {case.rtol:g}; {case.path.name}; {date.today().isoformat()}."
    )
