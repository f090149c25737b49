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
from stribeck.asymptotics.perturbation import phi
from stribeck.asymptotics.point import rigid
from stribeck.contacts.friction import DEFINITIONS, Definition
from stribeck.contacts.groups import Groups
from stribeck.curves.regime import Landmark, Transition
from stribeck.curves.result import StribeckCurve
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.solver.point.state import PointState
from stribeck.solver.solution import Solution
from stribeck.solver.solve import solve

__all__ = ["FIELDS", "FOLLOWED", "MEASURED", "REFERENCE_RTOL", "followed", "interval", "judged_groups", "relative_error"]

# Fields along the contact: predicted by formulas of the groups and of positions x.
FIELDS = ("gap", "pressure", "contact_pressure", "fluid_pressure")

POSITION_COUNT = 201  # Positions in its interval at which a field is judged.

LAYER_WIDTHS = 5.0  # Distance from the edge [layer widths] to which the fields of a layer are judged.

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


def _at_rest(kappa: float, load: float = 0.1) -> Groups:
    return Groups(0.0, load, load * kappa)


def _ball(speed: float, load: float, kappa: float) -> Groups:
    return Groups(speed, load, kappa * load ** (2 / 3), geometry="point")


def _slow(root: float) -> Callable[[float], Groups]:
    """Return groups by their roughness, so slow that the fluid carries the square of ``root``: higher orders count nothing."""
    load = 1e-3
    return lambda kappa: Groups(root * float(phi(load)) ** -0.5 * kappa**2, load, kappa * load)


# Groups by the parameter with which the errors of a module vanish, and its values at which they are followed.
FOLLOWED: dict[tuple[str, str], tuple[Callable[[float], Groups], tuple[float, ...]]] = {
    ("hertz", "relative_roughness"): (_at_rest, (1e-3, 1e-4, 1e-5)),
    ("hydrodynamic", "speed"): (lambda speed: Groups(speed, 0.1, 0.0), (1e-9, 1e-8, 1e-7)),
    ("hydrodynamic", "1/speed"): (lambda inverse: Groups(1 / inverse, 0.1, 0.0), (1e-5, 1e-4, 1e-3)),
    ("film_layers", "speed"): (lambda speed: Groups(speed, 0.1, 0.0), (1e-5, 1e-6, 1e-7, 1e-8)),
    ("rest", "relative_roughness"): (_at_rest, (1e-2, 1e-3, 1e-4)),
    # At a fixed load per roughness the logarithm in the gap stays what it is.
    ("rest", "1/relative_roughness"): (lambda inverse: Groups(0.0, 1e-6 / inverse, 1e-6 / inverse**2), (1e-1, 1e-2, 1e-3)),
    ("edge_layer", "relative_roughness"): (_at_rest, (1e-3, 1e-4, 1e-5)),
    ("perturbation", "relative_roughness"): (_slow(1e-4), (1e-3, 1e-4, 1e-5)),
    ("boundary", "relative_roughness"): (_slow(1e-3), (1e-3, 1e-4, 1e-5)),
    ("boundary", "fluid_number"): (lambda number: Groups(number * 1e-12, 0.1, 1e-7), (2.0, 1.0, 0.5)),
    ("wedge", "relative_roughness"): (lambda kappa: Groups(10.0 * kappa**2, 0.1, 0.1 * kappa), (1e-3, 3e-4, 1e-4, 3e-5)),
    ("point.hertz", "relative_roughness"): (lambda kappa: _ball(0.0, 1e-3, kappa), (1e-2, 1e-3, 1e-4)),
    ("point.rest", "relative_roughness"): (lambda kappa: _ball(0.0, 1e-3, kappa), (1e-2, 1e-3, 1e-4)),
    ("point.rest", "1/relative_roughness"): (lambda inverse: _ball(0.0, (1e-3 / inverse) ** 3, 1 / inverse), (0.2, 0.1, 0.05)),
    ("point.rigid", "1/speed"): (lambda inverse: _ball(1 / inverse, 1e-3, 0.0), (1e-2, 3e-3, 1e-3)),
}

# Other values for fields, whose errors reach their order later.
LATER = {
    "rest.gap": (1e-3, 1e-4, 1e-5),
    "hydrodynamic.gap_small": (1e-7, 1e-6, 1e-5),
    "hydrodynamic.pressure_small": (1e-7, 1e-6, 1e-5),
}


def followed(formula: Formula[Any]) -> dict[float, Groups]:
    """Return the states at which the error of a formula is followed, by the parameter with which it vanishes."""
    groups, values = FOLLOWED[formula.module, formula.small]
    return {value: groups(value) for value in LATER.get(formula.name, values)}


# Middle and half-width of what a field is judged over, by a part of its name; the last that fits.
INTERVALS: dict[str, Callable[[Groups], tuple[float, float]]] = {
    "hertz": lambda g: (0.0, 2.0),
    "rest.gap": lambda g: (0.0, 0.9),
    "small_indentation": lambda g: (0.0, 3 * float(g.relative_roughness) ** 0.5),  # standard deviations of the pressure
    "perturbation": lambda g: (0.0, 0.9),
    "edge_layer": lambda g: (1.0, LAYER_WIDTHS * float(g.relative_roughness) ** (2 / 3)),
    "inlet": lambda g: (-1.0, LAYER_WIDTHS * float(g.speed) ** 0.4),
    "outlet": lambda g: (1.0, LAYER_WIDTHS * float(g.speed) ** 0.4),
    "hydrodynamic": lambda g: (0.0, 4 * float(g.speed) ** (1 / 3) / 24 ** (1 / 6)),
    "point.rest.edge": lambda g: (1.0, LAYER_WIDTHS * (math.pi / 4 * float(g.relative_roughness)) ** (2 / 3)),
    "point.film": lambda g: (0.0, 0.8),
    "point.rigid": lambda g: (0.0, 3 * float(rigid.minimum_gap.function(g)) ** 0.5),
}


def interval(formula: Formula[Any], groups: Groups) -> tuple[float, float]:
    """Return the positions between which a field is judged."""
    where = [each for part, each in INTERVALS.items() if part in formula.name][-1]
    middle, half = where(groups)
    return middle - half, middle + half


def field_error(formula: Formula[Any], groups: Groups, state: Solution | PointState, options: dict[str, Any]) -> float:
    ends = interval(formula, groups)
    if not np.isfinite(ends).all():
        return math.nan
    x: Array = np.linspace(*ends, POSITION_COUNT)
    if isinstance(state, PointState):
        right = ball.along_the_middle(state, formula.predicts, x)
    else:
        right = getattr(state.profile(x), formula.predicts)
    found = formula.function(groups, x, **options)
    return float(np.abs(found - right).max() / np.abs(right).max())
