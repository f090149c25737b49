"""Formulas compared with the solver: the quantity that each predicts, and its relative error at a state.

Source: none; this is the evidence for :data:`stribeck.asymptotics.FORMULAS`, shown in validity.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any

import numpy as np

from evidence import ball
from stribeck._types import Array
from stribeck.asymptotics.formula import Formula
from stribeck.contacts.friction import DEFINITIONS, Definition
from stribeck.contacts.groups import Groups
from stribeck.curves.landmarks import Landmark
from stribeck.curves.regime import Transition
from stribeck.curves.result import StribeckCurve
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.solver.point.state import PointState
from stribeck.solver.solution import Solution
from stribeck.solver.solve import solve

__all__ = ["FIELDS", "MEASURED", "REFERENCE_RTOL", "judged_groups", "relative_error"]

# Fields along the contact: predicted by formulas of the groups and of positions x.
FIELDS = ("gap", "pressure", "contact_pressure", "fluid_pressure")

POSITION_COUNT = 201  # Positions in its interval at which a field is judged.

REFERENCE_RTOL = 1e-7  # Relative tolerance of the reference states.


CURVE_POINTS = 41  # Points of the curve on which a minimum or a load share is searched, which is then located exactly.


@lru_cache(maxsize=4096)
def state_of(groups: Groups) -> Solution:
    found: Solution = solve(groups, rtol=REFERENCE_RTOL)
    return found


@lru_cache(maxsize=512)
def _curve(groups: Groups, boundary_friction: float, beta: float, definition: Definition) -> StribeckCurve:
    coefficients: dict[str, Any] = {"boundary_friction": boundary_friction, "beta": beta, "definition": definition}
    curve: StribeckCurve = stribeck_curve(
        load=groups.load, roughness=groups.roughness, points=CURVE_POINTS, rtol=REFERENCE_RTOL, **coefficients
    )
    return curve


def _coefficients(options: dict[str, Any]) -> dict[str, Any]:
    """Return the options of a formula for the solver; by default 1 and the definition of the article."""
    definition = options.get("definition", options.get("viscous"))
    known = definition if definition in DEFINITIONS else "published"
    return {"boundary_friction": options.get("boundary_friction", 1.0), "beta": options.get("beta", 1.0), "definition": known}


def _minimum(groups: Groups, options: dict[str, Any]) -> Landmark | None:
    return _curve(replace(groups, speed=1.0), **_coefficients(options)).minimum


def _fluid_share(groups: Groups, name: Transition) -> Landmark | None:
    marks = _curve(replace(groups, speed=1.0), **_coefficients({})).transitions
    return next((mark for mark in marks if mark.name == name), None)


def _of_landmark(mark: Landmark | None, value: Callable[[Landmark], float]) -> float:
    return math.nan if mark is None else value(mark)


# Quantities of one state, with the options of the formula.
STATE_QUANTITIES: dict[str, Callable[[Solution, dict[str, Any]], float]] = {
    "central_gap": lambda s, _: s.central_gap,
    "flux_gap": lambda s, _: s.flux_gap,
    "minimum_gap": lambda s, _: s.minimum_gap,
    "offset": lambda s, _: s.offset,
    "contact_load_share": lambda s, _: s.contact_load_share,
    "fluid_load_share": lambda s, _: s.fluid_load_share,
    "viscous_friction": lambda s, options: s.friction(**_coefficients(options)).fluid,
    "friction": lambda s, options: s.friction(**_coefficients(options)).total,
}

# Quantities located on a curve over the speed; the speed of the groups has no effect.
CURVE_QUANTITIES: dict[str, Callable[[Groups, dict[str, Any]], float]] = {
    "speed_at_minimum": lambda g, options: _of_landmark(_minimum(g, options), lambda mark: mark.value),
    "friction_at_minimum": lambda g, options: _of_landmark(_minimum(g, options), lambda mark: mark.friction),
    "separation_at_minimum": lambda g, options: _of_landmark(
        _minimum(g, options), lambda mark: mark.solution.central_separation
    ),
    "speed_at_5_percent_fluid": lambda g, _: _of_landmark(_fluid_share(g, Transition.BOUNDARY_END), lambda mark: mark.value),
    "speed_at_half_fluid": lambda g, _: _of_landmark(_fluid_share(g, Transition.EQUAL_SHARES), lambda mark: mark.value),
}


def _measured(name: str, groups: Groups, **options: Any) -> float:
    if groups.geometry == "point":
        return ball.OBSERVED[name](ball.state(groups), options)
    return (
        CURVE_QUANTITIES[name](groups, options)
        if name in CURVE_QUANTITIES
        else STATE_QUANTITIES[name](state_of(groups), options)
    )


MEASURED: dict[str, Callable[..., float]] = {
    name: partial(_measured, name) for name in dict.fromkeys((*STATE_QUANTITIES, *CURVE_QUANTITIES, *ball.OBSERVED))
}
"""The solver's value of each quantity that a formula predicts, as a function of the groups, for friction also of mu0, beta
(1 by default) and definition (that of the article)."""


def judged_groups(formula: Formula[Any], groups: Groups) -> Groups:
    """Return the groups at which a formula is judged: with roughness or speed zero if it is about the limit."""
    if formula.plane == "smooth":
        return replace(groups, roughness=0.0)
    return replace(groups, speed=0.0) if formula.plane == "rest" else groups


def relative_error(formula: Formula[Any], groups: Groups, **options: Any) -> float:
    r"""Return the error of a formula relative to the solver at one state.

    .. math:: \epsilon = \frac{f - s}{s}, \qquad \epsilon = \frac{\max_x |f - s|}{\max_x |s|} \text{ for a field}
    """
    state = judged_groups(formula, groups)
    if formula.predicts in FIELDS:
        return field_error(formula, groups, ball.state(state) if state.geometry == "point" else state_of(state), options)
    found = float(formula.function(groups, **options))
    right = MEASURED[formula.predicts](state, **options)
    return (found - right) / right


def field_error(formula: Formula[Any], groups: Groups, state: Solution | PointState, options: dict[str, Any]) -> float:
    assert formula.interval is not None, f"{formula.name} is a field and has no interval"
    ends = formula.interval(groups)
    if not np.isfinite(ends).all():
        return math.nan
    x: Array = np.linspace(*ends, POSITION_COUNT)
    if isinstance(state, PointState):
        right = ball.along_the_middle(state, formula.predicts, x)
    else:
        right = getattr(state.profile(x), formula.predicts)
    found = formula.function(groups, x, **options)
    return float(np.abs(found - right).max() / np.abs(right).max())
