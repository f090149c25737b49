"""Formulas judged by the solver: what each of them predicts, solved, and the relative error of the formula.

Source: none; this is the evidence for :data:`stribeck.asymptotics.FORMULAS`, shown in validity.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from ._types import Array
from .asymptotics.formula import Formula
from .curve import Landmark, StribeckCurve, stribeck_curve
from .parameters import Groups
from .solution import Solution
from .solve import solve

__all__ = ["FIELDS", "MEASURED", "judged_groups", "relative_error"]

FIELDS = ("gap", "pressure", "contact_pressure", "fluid_pressure")
"""Fields along the contact: predicted by formulas of the groups and of positions x."""

POSITIONS = 201
"""Positions in its interval at which a field is judged."""

RTOL = 1e-7
"""Relative tolerance of the states that judge."""

CURVE_POINTS = 41
"""Points of the curve on which a minimum or a load share is looked for, which is then located exactly."""


@lru_cache(maxsize=4096)
def _state(groups: Groups) -> Solution:
    return solve(groups, rtol=RTOL)


@lru_cache(maxsize=512)
def _curve(groups: Groups) -> StribeckCurve:
    return stribeck_curve(load=groups.load, roughness=groups.roughness, points=CURVE_POINTS, rtol=RTOL)


def _minimum(groups: Groups) -> Landmark | None:
    return _curve(replace(groups, speed=1.0)).minimum


def _fluid_share(groups: Groups, share: str) -> Landmark | None:
    marks = _curve(replace(groups, speed=1.0)).transitions
    return next((mark for mark in marks if mark.name == f"fluid carries {share} of the load"), None)


def _of_landmark(mark: Landmark | None, value: Callable[[Landmark], float]) -> float:
    return math.nan if mark is None else value(mark)


MEASURED: dict[str, Callable[[Groups], float]] = {
    "central_gap": lambda g: _state(g).central_gap,
    "flux_gap": lambda g: _state(g).flux_gap,
    "minimum_gap": lambda g: _state(g).minimum_gap,
    "offset": lambda g: _state(g).offset,
    "contact_load_share": lambda g: _state(g).contact_load_share,
    "fluid_load_share": lambda g: _state(g).fluid_load_share,
    "viscous_friction": lambda g: _state(g).friction(mu0=1.0, beta=1.0).viscous,
    "friction": lambda g: _state(g).friction(mu0=1.0, beta=1.0).total,
    "speed_at_minimum": lambda g: _of_landmark(_minimum(g), lambda mark: mark.value),
    "friction_at_minimum": lambda g: _of_landmark(_minimum(g), lambda mark: mark.friction),
    "lambda_ratio_at_minimum": lambda g: _of_landmark(_minimum(g), lambda mark: mark.solution.lambda_ratio),
    "speed_at_5_percent_fluid": lambda g: _of_landmark(_fluid_share(g, "5%"), lambda mark: mark.value),
    "speed_at_half_fluid": lambda g: _of_landmark(_fluid_share(g, "50%"), lambda mark: mark.value),
}
"""What the solver gives for each quantity that a formula predicts; friction as the paper defines it with mu0 = beta = 1."""


def judged_groups(formula: Formula[Any], groups: Groups) -> Groups:
    """Return the groups at which a formula is judged: with roughness or speed zero if it is about the limit.

    Parameters
    ----------
    formula : Formula
        The formula.
    groups : Groups
        Any state.

    Returns
    -------
    Groups
        The state to solve.
    """
    if formula.plane == "smooth":
        return replace(groups, roughness=0.0)
    return replace(groups, speed=0.0) if formula.plane == "rest" else groups


def relative_error(formula: Formula[Any], groups: Groups, **options: Any) -> float:
    r"""Return the error of a formula relative to the solver at one state.

    .. math:: \epsilon = \frac{f - s}{s}, \qquad \epsilon = \frac{\max_x |f - s|}{\max_x |s|} \text{ for a field}

    Parameters
    ----------
    formula : Formula
        The formula.
    groups : Groups
        One state.
    **options
        Arguments of the formula beside the groups.

    Returns
    -------
    float
        The error, signed but for a field; nan where the solver has no such quantity.
    """
    state = judged_groups(formula, groups)
    if formula.predicts in FIELDS:
        return _field_error(formula, groups, state, options)
    found = float(formula.function(groups, **options))
    right = MEASURED[formula.predicts](state)
    return (found - right) / right


def _field_error(formula: Formula[Any], groups: Groups, state: Groups, options: dict[str, Any]) -> float:
    assert formula.interval is not None, f"{formula.name} is a field and has no interval"
    x: Array = np.linspace(*formula.interval(groups), POSITIONS)
    right = getattr(_state(state).profile(x), formula.predicts)
    found = formula.function(groups, x, **options)
    return float(np.abs(found - right).max() / np.abs(right).max())
