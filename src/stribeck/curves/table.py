"""A Stribeck curve as a table: columns with units and long names, and what belongs to the whole curve."""

import math
from typing import Any

import numpy as np

from stribeck.asperity_friction.coulomb import as_asperity_friction
from stribeck.contacts.friction import DEFINITIONS
from stribeck.contacts.friction_rules import RULES
from stribeck.files.results import Labelled
from stribeck.quantities.outputs import COLUMNS, GROUPS, OUTPUT_TABLES, friction_rows
from stribeck.solver.numbers import about_problem, columns_of_states, problem_attributes

Columns = dict[str, tuple[Any, str, str]]

WORDS = ("regime", "outcome")  # Columns that hold text


def curve_table(curve: Any) -> Labelled:
    """Return columns, coordinate and attributes of a Stribeck curve."""
    over, what = curve.over, f"{curve.over} group" if curve.contact is None else curve.over
    columns = {name: (over, *column) for name, column in _columns(curve).items()}
    return columns, {over: (over, curve.values, curve.unit, f"{what}, what varies")}, _attributes(curve)


def curve_dict(curve: Any) -> dict[str, Any]:
    """Return a curve with its settings, landmarks and points, ready for JSON."""
    about, columns = about_problem(curve.groups, curve.contact), _columns(curve)
    units = {name: unit for name, (_, unit, _) in columns.items() if not name.endswith("_error") and name not in WORDS}
    return {
        "unit": curve.unit,
        **about,
        **_settings(curve),
        "units": (about["units"] or {}) | units,
        "minimum": curve.minimum,
        **marks_of(curve),
        "points": {"value": curve.values, **{name: each for name, (each, _, _) in columns.items()}},
        "complete": curve.outcome.ok,
        "outcome": curve.outcome.name,
        "message": curve.outcome.value,
        "notes": curve.notes,
    }


def _settings(curve: Any) -> dict[str, Any]:
    """Return what was asked of a curve, and its error; the friction coefficient is nan where asperities have another one."""
    named = {name: getattr(curve, name) for name in ("over", "definition", "rtol", "beta", "error_estimate")}
    coefficient = float(getattr(as_asperity_friction(curve.boundary_friction), "boundary_friction", math.nan))
    return named | {"boundary_friction": coefficient, "requested_points": curve.requested}


def marks_of(curve: Any) -> dict[str, Any]:
    """Return transitions and regimes along a curve, the former over the value of its contact where that is known."""
    own = 0.0 if curve.contact is None else float(getattr(curve.contact, curve.over))
    factors = [{"factor": mark.value / own if own > 0 else math.inf} for mark in curve.transitions]
    return {
        "transitions": [mark.to_dict() | each for mark, each in zip(curve.transitions, factors, strict=True)],
        "regimes": [{"regime": name, "from": low, "to": high} for name, low, high in curve.regime_ranges],
    }


def _columns(curve: Any) -> Columns:
    """Return values, unit and long name of each variable."""
    found: Columns = {
        "friction": (curve.friction, *COLUMNS["friction"]),
        "friction_asperities": (curve.friction.asperities, *COLUMNS["friction_asperities"]),
        "friction_fluid": (curve.friction.fluid, *COLUMNS["friction_fluid"]),
        "friction_error": (curve.friction.error, *COLUMNS["friction_error"]),
        "regime": (np.array(curve.regimes, dtype=object), *COLUMNS["regime"]),
        "hersey_number": (curve.hersey_number, "1", RULES[curve.groups.geometry].hersey_name),
        "hydrodynamic_friction": (curve.hydrodynamic_friction, *COLUMNS["hydrodynamic_friction"]),
    }
    for name in GROUPS:
        found[f"{name}_group"] = (np.asarray(getattr(curve.groups, name)), "1", f"{name} group")
    solutions = curve.solutions
    found |= columns_of_states(solutions, curve.boundary_friction, curve.beta) if solutions else _off_the_atlas(curve)
    outcomes = [s.outcome.name for s in solutions] or [curve.outcome.name] * len(curve)
    return found | {"outcome": (np.array(outcomes, dtype=object), *COLUMNS["outcome"])}


def _off_the_atlas(curve: Any) -> Columns:
    """Return observables and frictions of a curve that has no states."""
    listed = OUTPUT_TABLES[curve.groups.geometry].listed
    found: Columns = {name: (curve.observable(name), *about) for name, about in listed.items() if name in curve.observables}
    for definition in DEFINITIONS:
        friction = curve.friction(definition=definition)
        rows = zip(friction_rows(definition).items(), (friction.total, friction.fluid, friction.error), strict=True)
        found |= {name: (values, *about) for (name, about), values in rows}
    return found


def _attributes(curve: Any) -> dict[str, Any]:
    """Return what belongs to the whole curve: provenance, inputs, settings, landmarks, outcome."""
    is_smooth = bool(curve.solutions) and curve.solutions[0].law == "smooth"
    finished = curve.outcome.ok and len(curve) == curve.requested
    minimum, marks = curve.minimum, curve.transitions
    return {
        "title": f"Stribeck curve of a lubricated rough {curve.groups.geometry} contact",
        "outcome": curve.outcome.value,
        "complete": int(finished),
        "points": len(curve),
        **problem_attributes(curve.groups, curve.contact, is_smooth, curve.over),
        **_settings(curve),
        f"minimum_{curve.over}": minimum.value if minimum else math.nan,
        "minimum_friction": minimum.friction if minimum else math.nan,
        "transition_names": "; ".join(mark.name for mark in marks),
        f"transition_{curve.over}": np.array([mark.value for mark in marks]),
        "transition_friction": np.array([mark.friction for mark in marks]),
        "notes": "\n".join(curve.notes),
    }
