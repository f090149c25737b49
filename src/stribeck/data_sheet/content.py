"""Content of a report: inputs with their sources, checks, regime, films, margins and levers, all solved here."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from datetime import date
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from stribeck.cases.case import Case
from stribeck.checks.check import Checks
from stribeck.checks.subject import Subject
from stribeck.checks.table import checks_of
from stribeck.contacts.contact import model_words
from stribeck.contacts.part_inputs import PART_INPUTS
from stribeck.curves.result import StribeckCurve
from stribeck.curves.sensitivities import sensitivities_if_known
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.fits.measurements import Measurements, read_measurements
from stribeck.quantities.formats import format_percent, format_si
from stribeck.regimes.margin_intervals import with_intervals
from stribeck.regimes.margin_limits import scanned_rtol
from stribeck.regimes.margins import regime_margins
from stribeck.regimes.sentences import regime_sentence, ways_to
from stribeck.solver.solution import Solution
from stribeck.solver.solve import solve
from stribeck.solver.solve_error import SolveError
from stribeck.uncertainty.propagate import propagate
from stribeck.uncertainty.result import Uncertainty

__all__ = ["Content", "InputLine", "Lever", "content_of"]

CURVE_POINTS = 41  # Points of the curve on the page

LEVER_FRICTION_RATIO = 0.8  # Friction that a lever should reach, relative to the present one

MAX_LEVER_FACTOR = 100.0  # Largest change of an input by a lever

# What a report says of its certainty if no input has an error.
NO_ERRORS_TEXT = (
    'With errors of the inputs, as in roughness = "1.0 +- 0.2 um", this page has intervals and the probability of each regime.'
)

# Inputs that a designer may change
DESIGN_INPUTS = ("speed", "viscosity", "load", "roughness", "modulus", "radius", "boundary_friction")


@dataclass(frozen=True)
class InputLine:
    """One input: label, value, error, and source as stated in the file."""

    label: str
    value: str
    error: str
    source: str


@dataclass(frozen=True)
class Lever:
    """One input that lowers friction: its new value, and the friction solved there."""

    label: str
    change: str
    friction: str


@dataclass(frozen=True)
class Content:
    """Content of a report."""

    title: str  # Headline, and whether the model applies
    headline: str  # Headline, and whether the model applies
    inputs: tuple[InputLine, ...]  # The inputs
    conversions: tuple[str, ...]  # Conversions of data-sheet inputs
    checks: Checks  # The checks
    sentences: tuple[str, ...]  # Regime, friction and load share
    films: tuple[tuple[str, str, str], ...]
    uncertainty: Uncertainty | None  # The propagated errors of the inputs
    margins: tuple[str, ...]  # Margins to the next regimes
    levers: tuple[Lever, ...]  # The two inputs that lower friction by a fifth with the smallest change
    notes: tuple[str, ...]  # Notes on the validity of the numbers
    versions: str  # Program and libraries
    curve: StribeckCurve  # Friction over the speed
    solution: Solution  # The state
    data: Measurements | None = None  # Measured friction


def content_of(
    case: Case, data: str | Path | Measurements | None = None, on_step: Callable[[int, int], object] | None = None
) -> Content:
    """Solve the content of a report."""
    step = on_step or (lambda done, total: None)
    measured = read_measurements(data, case.fit) if isinstance(data, str | Path) else data
    contact, definition = case.contact, case.definition
    solution, slopes, _ = sensitivities_if_known(contact, rtol=case.rtol, definition=definition)
    curve = stribeck_curve(contact, points=CURVE_POINTS, rtol=scanned_rtol(contact, case.rtol), definition=definition)
    step(1, 5)
    checks = checks_of(Subject(contact, case.facts, definition, solution, curve))
    step(2, 5)
    found = propagate(contact, case.errors, definition=definition) if case.errors else None
    step(3, 5)
    margins = with_intervals(
        contact, regime_margins(contact, rtol=case.rtol, definition=definition, curve=curve), case.errors, definition
    )
    step(4, 5)
    levers = _levers(case, solution, slopes)
    step(5, 5)
    return Content(
        title=case.title or case.path.name,
        headline=checks.headline,
        inputs=_inputs(case),
        conversions=case.conversions,
        checks=checks,
        sentences=_sentences(case, solution, curve, found),
        films=_films(solution, curve, found),
        uncertainty=found,
        margins=tuple(ways_to(margins)),
        levers=levers,
        notes=tuple(note for note in (*solution.notes, *margins.notes) if not _is_in_checks(note, checks)),
        versions=_versions(case),
        curve=curve,
        solution=solution,
        data=measured,
    )


def _is_in_checks(note: str, checks: Checks) -> bool:
    """Return whether a check contains a note."""
    return checks.covers(note) or any(note in each.sentence for each in checks)


def _inputs(case: Case) -> tuple[InputLine, ...]:
    sources = _sources(case.path)
    through = {"modulus": ("youngs_modulus", "shore_a", "shore_d"), "speed": ("entrainment_speed", "rotational_speed")}
    through |= {"roughness": ("ra", "rq", "h_rms"), "viscosity": ("kinematic_viscosity",), "load": ("force",)}
    lines = []
    for name, value in case.contact.inputs():
        row = case.contact.INPUTS.quantities[name]
        names = (name, *through.get(name, ()))
        error = next((case.errors[each] for each in names if each in case.errors), None)
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


def _sentences(case: Case, solution: Solution, curve: StribeckCurve, found: Uncertainty | None) -> tuple[str, ...]:
    first = regime_sentence(solution, case.definition)
    if found is None:
        return first, NO_ERRORS_TEXT
    return (first, f"Probability of each regime: {found.probabilities}.", *found.sources)


def _films(solution: Solution, curve: StribeckCurve, found: Uncertainty | None) -> tuple[tuple[str, str, str], ...]:
    if found is not None:
        return tuple((each.label, *each.texts) for each in found.spreads)
    assert solution.contact is not None
    height = solution.contact.hertz.indentation
    marks = tuple((str(mark.name), format_si(mark.value, "speed"), "") for mark in curve.transitions)
    return (
        ("central film", format_si(solution.central_gap * height, "length"), ""),
        ("minimum film", format_si(solution.minimum_gap * height, "length"), ""),
        ("Lambda (minimum film over h_rms)", f"{solution.lambda_ratio:.3g}", ""),
        *marks,
    )


def _levers(case: Case, solution: Solution, slopes: dict[str, float]) -> tuple[Lever, ...]:
    """Return the two inputs that lower friction by a fifth with the smallest change, with the friction that is then solved."""
    contact = case.contact
    before = solution.friction(definition=case.definition).total
    factors = {
        name: float(np.exp(np.log(LEVER_FRICTION_RATIO) / slopes[name]))
        for name in DESIGN_INPUTS
        if abs(slopes.get(name, 0.0)) > 0.01
    }
    nearest = sorted(factors, key=lambda name: abs(np.log(factors[name])))
    found: list[Lever] = []
    for name in nearest:
        factor = factors[name]
        # Speed and viscosity enter as a product: two names of one lever.
        twin = {"speed": "viscosity", "viscosity": "speed"}.get(name)
        if (
            len(found) == 2
            or not 1 / MAX_LEVER_FACTOR < factor < MAX_LEVER_FACTOR
            or any(twin == each.label for each in found)
        ):
            continue
        row = contact.INPUTS.quantities[name]
        value = getattr(contact, name) * factor
        changes: dict[str, Any] = {name: value}
        if name == "roughness" and contact.law is not None and contact.law.name == "persson":
            changes["beta"] = contact.beta * factor
        try:
            after = solve(contact.replace(**changes), rtol=case.rtol).friction(definition=case.definition).total
        except SolveError:
            continue
        factor_text = f"x {factor:.3g}" if factor > 1 else f"/ {1 / factor:.3g}"
        found.append(
            Lever(
                row.label,
                f"{factor_text} (to {format_si(value, row.dimension)})",
                f"{after:.3g} ({100 * (after / before - 1):+.0f} %)",
            )
        )
    return tuple(found)


def _versions(case: Case) -> str:
    libraries = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy"))
    law = "exponential" if case.contact.law is None else case.contact.law.name
    return (
        f"stribeck {version('stribeck')}, {libraries}; contact law: {law}; friction: {case.definition}; "
        f"relative tolerance {case.rtol:g}; {case.path.name}; {date.today().isoformat()}."
    )
