"""Results as JSON, for the commands with ``--json``."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.checks.check import Checks
from stribeck.cli.reports.printing import Sensitivities, hersey_of, most_sensitive_input
from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact, part_attributes
from stribeck.quantities.inputs import unit_of
from stribeck.quantities.outputs import GROUPS, OUTPUT_TABLES
from stribeck.solver.base_solution import BaseSolution, regime_of_state, si_films

if TYPE_CHECKING:
    from stribeck.curves.landmarks import Landmark
    from stribeck.curves.result import StribeckCurve
    from stribeck.regimes.margin_scan import Crossing, Margin
    from stribeck.regimes.margins import RegimeMargins

__all__ = ["curve_json", "dump", "law_json", "regimes_json", "solution_json"]


def dump(content: dict[str, Any]) -> str:
    """Return content as JSON text; what is not finite becomes null, as JSON knows no nan."""
    return json.dumps(_plain(content), indent=2, ensure_ascii=False, allow_nan=False)


def _plain(content: Any) -> Any:
    if isinstance(content, dict):
        return {name: _plain(value) for name, value in content.items()}
    if isinstance(content, np.ndarray):
        return _plain(content.tolist())
    if isinstance(content, list | tuple):
        return [_plain(value) for value in content]
    if isinstance(content, float) and not math.isfinite(content):
        return None
    return content


def solution_json(
    solution: BaseSolution, boundary_friction: float | None = None, beta: float | None = None, checks: Checks | None = None
) -> dict[str, Any]:
    """Return :meth:`Solution.to_dict`, and under ``si`` inputs and films of the contact, if any, in SI units."""
    found: dict[str, Any] = checks_json(checks) | solution.to_dict(boundary_friction, beta)
    found["hersey_number"] = hersey_of(solution, beta)
    if solution.contact is not None:
        films = si_films(solution)
        found["si"] = {
            **_inputs(solution.contact),
            **{name: value for name, (value, _, _) in films.items()},
            "units": _units(solution.contact) | {name: unit for name, (_, unit, _) in films.items()},
        }
    return found


def curve_json(curve: StribeckCurve, title: str, files: Sequence[str], checks: Checks | None = None) -> dict[str, Any]:
    """Return a curve with its settings, landmarks and points."""
    names = tuple((curve.solutions[0].outputs if len(curve) else OUTPUT_TABLES[curve.groups.geometry]).listed)
    return {
        **checks_json(checks),
        "title": title,
        "geometry": curve.groups.geometry,
        "over": curve.over,
        "unit": "1" if curve.contact is None else unit_of(curve.over, curve.contact.INPUTS),
        "definition": curve.definition,
        **law_json(curve.law),
        "model": part_attributes(curve.groups, curve.contact),
        "rtol": curve.rtol,
        "boundary_friction": curve.boundary_friction,
        "beta": curve.beta,
        "inputs": None if curve.contact is None else _inputs(curve.contact),
        "units": None if curve.contact is None else _units(curve.contact),
        "minimum": None if curve.minimum is None else _landmark(curve.minimum),
        "transitions": [_landmark(mark) for mark in curve.transitions],
        "regimes": [{"regime": name, "from": low, "to": high} for name, low, high in curve.regime_ranges],
        "points": {
            "value": curve.values,
            **{f"{name}_group": np.asarray(getattr(curve.groups, name)) for name in GROUPS},
            "hersey_number": curve.hersey_number,
            "hydrodynamic_friction": curve.hydrodynamic_friction,
            "friction": curve.friction,
            "friction_contact": curve.friction_contact,
            "friction_viscous": curve.friction_viscous,
            "friction_error": curve.friction_error,
            "regime": curve.regimes,
            **{name: curve.observable(name) for name in names},
        },
        "requested_points": curve.requested,
        "complete": curve.outcome.ok,
        "error_estimate": curve.error_estimate,
        "outcome": curve.outcome.name,
        "message": curve.outcome.value,
        "notes": list(curve.notes),
        "files": list(files),
    }


def regimes_json(
    solution: BaseSolution,
    sensitivities: Sensitivities,
    curve: StribeckCurve,
    margins: RegimeMargins,
    title: str = "",
    checks: Checks | None = None,
) -> dict[str, Any]:
    """Return the regime of a state, the transitions around it and what moves its friction."""
    assert solution.contact is not None
    friction = solution.friction(definition=curve.definition)
    speed = solution.contact.speed
    return {
        **checks_json(checks),
        "title": title,
        "regime": regime_of_state(solution, curve.definition),
        "speed": speed,
        "unit": unit_of("speed"),
        "fluid_load_share": solution.fluid_load_share,
        "fluid_load_share_error": solution.errors["fluid_load_share"],
        "contact_friction_share": friction.contact_share,
        "contact_friction_share_error": friction.relative_error,
        "friction": friction.total,
        "friction_error": friction.error,
        "definition": curve.definition,
        "transitions": [
            {**_landmark(mark), "factor": mark.value / speed if speed > 0 else math.inf} for mark in curve.transitions
        ],
        "regimes": [{"regime": name, "from": low, "to": high} for name, low, high in curve.regime_ranges],
        "margins": {margin.name: _margin(margin, solution.contact) for margin in margins.margins},
        "sensitivities": sensitivities,
        "moves_friction_most": most_sensitive_input(sensitivities),
        **law_json(solution.groups.law),
        "model": part_attributes(solution.groups, solution.contact),
        "inputs": _inputs(solution.contact),
        "units": _units(solution.contact),
        "error_estimate": max(solution.error_estimate, curve.error_estimate),
        "outcome": curve.outcome.name,
        "message": curve.outcome.value,
        "notes": [*solution.notes, *curve.minimum_notes, *margins.notes],
    }


def checks_json(checks: Checks | None) -> dict[str, Any]:
    """Return whether the model applies and the checks that say so; nothing of groups alone."""
    return {} if checks is None else checks.to_dict()


def law_json(law: AsperityLaw | None) -> dict[str, Any]:
    """Return name and parameters of a contact law."""
    if law is None:
        return {"contact_law": "exponential", "contact_law_parameters": {}}
    return {"contact_law": law.name, "contact_law_parameters": law.parameters}


def _margin(margin: Margin, contact: Contact) -> dict[str, Any]:
    return {
        "less": None if margin.less is None else _crossing(margin.less),
        "more": None if margin.more is None else _crossing(margin.more),
        "searched": list(margin.searched),
        "unit": unit_of(margin.name, contact.INPUTS),
    }


def _crossing(mark: Crossing) -> dict[str, Any]:
    found: dict[str, Any] = {"regime": mark.regime, "value": mark.value, "factor": mark.factor}
    return found if mark.interval_95 is None else found | {"interval_95": list(mark.interval_95)}


def _landmark(mark: Landmark) -> dict[str, Any]:
    return {"name": mark.name, "value": mark.value, "friction": mark.friction}


def _inputs(contact: Contact) -> dict[str, float]:
    return dict(contact.inputs())


def _units(contact: Contact) -> dict[str, str]:
    return {name: unit_of(name, contact.INPUTS) for name, _ in contact.inputs()}
