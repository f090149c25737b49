"""Sensitivities of the friction of a ball: exact derivatives with respect to the groups, all else in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import log_cut_offs
from stribeck.contacts.friction import Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Groups
from stribeck.contacts.parts import part_names
from stribeck.contacts.with_parts import admissible_steps, model_at, models_at_both_sides
from stribeck.curves.factor_slopes import rest_derivatives, through_factor
from stribeck.equations.point.observables import WITHIN, FrictionWithin, observables
from stribeck.equations.point.system import Equations, Unknowns
from stribeck.numerics.settings import LOG_STEP
from stribeck.quantities.outputs import AREA, GROUPS
from stribeck.solver.point.sensitivity import derivatives_along
from stribeck.solver.point.solution import PointSolution, finish_point
from stribeck.solver.point.solve import solve_cold
from stribeck.solver.point.state import PointObservables, with_area

__all__ = ["ball_derivatives"]

SMALL = 1e-4  # Step of the logarithms in finite differences of closed forms


def ball_derivatives(
    contact: Contact, rtol: float, definition: Definition
) -> tuple[PointSolution, Array, dict[str, float], dict[str, float]]:
    """Return the state of a ball, and the derivatives of its friction by groups, through the model, and directly."""
    groups, beta, asperities = contact.groups, contact.beta, contact.friction_of_asperities
    state = solve_cold(groups, rtol)
    solution = finish_point(state, contact)
    values: PointObservables = solution.observables
    factor, amount = asperities.factor(contact), asperities.amount(solution)[0]

    def total(found: PointObservables, beta: float = beta, more: float = 0.0) -> float:
        return factor * found.sliding * (amount + more) + found.viscous_friction(beta, definition)

    def slope(name: str) -> float:
        """Return the derivative with respect to an argument of the closed forms that is not a group."""
        here = getattr(values, name)
        more, less = (replace(values, **{name: here * math.exp(step)}) for step in (SMALL, -SMALL))
        return (total(more) - total(less)) / (2 * SMALL)

    def slopes_along(directions: Mapping[str, Callable[[float], Groups]]) -> dict[str, float]:
        """Return the derivatives along directions of the groups and their model."""
        measure = partial(_measured, values, beta, groups.law if asperities.observable == AREA else None)
        found = {}
        for name, along in directions.items():
            changes = {each: float(rate) for each, (rate,) in derivatives_along(state, {name: along}, measure).items()}
            rate = changes[asperities.observable]
            ends = [total(_moved(values, changes, along(step), step), more=rate * step) for step in (SMALL, -SMALL)]
            found[name] = (ends[0] - ends[1]) / (2 * SMALL)
        return found

    if groups.speed == 0:
        by_groups, by_model = factor * values.sliding * rest_derivatives(contact, rtol), dict[str, float]()
    else:
        alive = {name: partial(_at, groups, name) for name in GROUPS if float(getattr(groups, name)) > 0}
        own = slopes_along(alive)
        by_groups = np.array([own.get(name, 0.0) for name in GROUPS])
        by_model = slopes_along(_of_model(contact, groups))
    by_beta = (total(values, beta * math.exp(SMALL)) - total(values, beta * math.exp(-SMALL))) / (2 * SMALL)
    direct = through_factor(contact, factor * values.sliding * amount)
    direct["beta"] = direct.get("beta", 0.0) + by_beta
    direct["slide_to_roll"] = direct.get("slide_to_roll", 0.0) + slope("_slide_to_roll")
    if values._wetted_radius is not None:
        direct["wetted_radius"] = by_edge = slope("_wetted_radius")
        for name, exponent in RULES["point"].exponents["wetted_radius"].items():
            direct[name] = direct.get(name, 0.0) + exponent * by_edge
    return solution, by_groups, by_model, direct


def _of_model(contact: Contact, groups: Groups) -> dict[str, Callable[[float], Groups]]:
    """Return how inputs change the friction through numbers of fluid or solid in Hertz units, at fixed groups."""

    def along(name: str, shift: float, step: float) -> Groups:
        return replace(groups, model=model_at(contact, name, step + shift))

    # Sliding changes no field of these films: it enters through the closed forms of the friction alone.
    names = [name for name, value in contact.inputs() if value > 0 and name != "slide_to_roll"]
    found: dict[str, Callable[[float], Groups]] = {}
    for name in (*names, *part_names(contact)):
        if models_at_both_sides(contact, name) is not None:
            # Where an end of what it may be is nearer than the step, differentiated one step inside.
            found[name] = partial(along, name, sum(admissible_steps(contact, name, LOG_STEP, LOG_STEP)))
    return found


def _at(groups: Groups, name: str, step: float) -> Groups:
    return replace(groups, **{name: float(getattr(groups, name)) * math.exp(step)})  # type: ignore[arg-type]


def _moved(values: PointObservables, rates: Mapping[str, float], beside: Groups, step: float) -> PointObservables:
    """Return the observables after a small step along a direction to other groups, to first order."""
    moved: dict[str, Any] = {name: getattr(values, name, 0.0) + step * rate for name, rate in rates.items() if name != AREA}
    more, within = [moved.pop(each) for each in WITHIN if each in moved], values._within
    if within is not None:
        moved["_within"] = lambda which, log_radius: within(which, log_radius) + more[which]
    return replace(values, **moved, _groups=beside)


def _measured(of: PointObservables, beta: float, law: Any, equations: Equations, y: Unknowns) -> dict[str, float]:
    """Return the observables of a state beside another one, in a fluid that thins with those up to where the liquid ends."""
    found = observables(equations, y) if law is None else with_area(law, equations, y)
    if of._within is None:
        return found
    at = FrictionWithin.of(equations, y, found)
    by_shear, by_pressure = log_cut_offs(float(of._groups.slope(beta)), of._wetted_radius or math.inf)
    return found | {each: at(i, float((by_shear, by_pressure, by_pressure)[i])) for i, each in enumerate(WITHIN)}
