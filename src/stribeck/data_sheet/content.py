"""Content of a report: inputs with their sources, checks, regime, films, margins and levers, all solved here."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
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
from stribeck.fits.measurements import Measurements
from stribeck.fits.reading import read_measurements
from stribeck.quantities.formats import format_percent, format_si
from stribeck.regimes.levers import MAX_FACTOR, cheapest_levers
from stribeck.regimes.overview import Overview, overview_of
from stribeck.regimes.sentences import regime_sentence, ways_to
from stribeck.solver.numbers import main_rows
from stribeck.uncertainty.result import Uncertainty

# What a report says of its certainty if no input has an error.
NO_ERRORS_TEXT = (
    'With errors of the inputs, as in roughness = "1.0 +- 0.2 um", this page has intervals and the probability of each regime.'
)

NO_LEVERS_TEXT = f"No single input lowers friction by a fifth within a factor of {MAX_FACTOR:g}."


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
    checks: Checks
    sentences: tuple[str, ...]  # Regime, friction and load share
    sections: tuple[Section, ...]  # The parts of the page below its picture
    versions: str  # Program and libraries
    curve: StribeckCurve  # Friction over the speed
    uncertainty: Uncertainty | None  # The propagated errors of the inputs
    data: Measurements | None = None  # Measured friction


def content_of(
    case: Case, data: str | Path | Measurements | None = None, on_step: Callable[[int, int], object] | None = None
) -> Content:
    """Solve the content of a report."""
    measured = read_measurements(data, case.fit) if isinstance(data, str | Path) else data
    found = overview_of(case, on_step, is_whole=True)
    checks, errors, friction = found.checks, found.errors, found.friction
    assert checks is not None
    certainty = [NO_ERRORS_TEXT] if errors is None else [errors.probability_sentence, *errors.sources]
    return Content(
        title=case.title or case.path.name,
        headline=checks.headline,
        checks=checks,
        sentences=(regime_sentence(found.solution, friction), *certainty),
        sections=tuple(each for each in _sections(case, found, checks, measured) if each.table or each.paragraphs),
        versions=_versions(case),
        curve=found.curve,
        uncertainty=errors,
        data=measured,
    )


def _sections(case: Case, found: Overview, checks: Checks, data: Measurements | None) -> Iterator[Section]:
    """Yield the parts of the page, those too that have nothing to say."""
    yield Section("Friction, films and transitions", list(_films(found)))
    yield Section("Margins to the next regimes", (), [*ways_to(found.margins)] or ["There is no other regime in reach."])
    levers = cheapest_levers(case.contact, found.friction.total, found.sensitivities, case.definition, case.rtol)
    head = "To lower friction by about a fifth", "Change", "Friction solved there"
    rows = [(lever.label, *lever.texts) for lever in levers]
    yield Section("The two cheapest levers", [head, *rows] if rows else (), () if rows else [NO_LEVERS_TEXT])
    yield Section("Inputs", list(_inputs(case)), [f"Converted: {each}" for each in case.conversions])
    verdicts = [("Check", "Value", "Fine", "Verdict"), *((each.name, *each.texts, each.verdict) for each in checks)]
    said = [f"{each.word}: {each.sentence}" for each in checks.said]
    yield Section("Does the model apply?", verdicts, said + [f"Not checked: {each}" for each in checks.unchecked])
    if data:
        yield Section("Data", (), [f"{len(data)} rows of {data.path or 'measured friction'}, drawn as read.", *data.notes])
    yield Section("Notes", (), [note for note in dict.fromkeys(found.notes) if not checks.covers(note, doubts=True)])


def _inputs(case: Case) -> Iterator[tuple[str, str, str, str]]:
    """Yield label, value, error and source of each input, as stated in the file."""
    yield "Input", "Value", "Error", "Source, from the case file"
    sources, table = _sources(case.path), case.contact.INPUTS
    for name, value in case.contact.inputs():
        row, error = table.kept[name], case.errors.get(name)
        names = (name, *(each for each, of in (table.stands_for | {"h_rms": "roughness"}).items() if of == name))
        source = next((sources[each] for each in names if each in sources), "")
        shown = "" if error is None else f"± {format_percent(error)}"
        yield row.label, format_si(value, row.dimension, 4), shown, source
    model = model_words(case.contact.groups, case.contact)
    uncertain = (
        f"{row.label} ± {format_percent(case.errors[name])}" for name, row in PART_INPUTS.items() if name in case.errors
    )
    if model:
        yield "model", model, ", ".join(uncertain), ""


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


def _films(found: Overview) -> Iterator[tuple[str, ...]]:
    """Yield friction, films and transitions, with 95 % intervals where inputs have errors."""
    if found.errors is not None:
        yield "Quantity", "Value", "95 %"
        yield from ((each.label, *each.texts) for each in found.errors.spreads)
        return
    yield "Quantity", "Value"
    yield from ((each.label, each.texts[0]) for each in main_rows(found.solution, definition=found.curve.definition))
    yield from ((str(mark.name), format_si(mark.value, "speed")) for mark in found.curve.transitions)


def _versions(case: Case) -> str:
    libraries = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy"))
    law = "exponential" if case.contact.law is None else case.contact.law.name
    return (
        f"stribeck {version('stribeck')}, {libraries}; contact law: {law}; friction: {case.definition}; "
        f"relative tolerance {case.rtol:g}; {case.path.name}; {date.today().isoformat()}."
    )
