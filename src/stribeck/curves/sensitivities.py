"""Sensitivities of the friction of a state: its logarithmic derivatives with respect to the inputs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, check_definition, sliding_part
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.model import BASE_MODEL
from stribeck.contacts.parts import part_names
from stribeck.contacts.with_parts import exponents_of, models_at_both_sides
from stribeck.curves.factor_slopes import rest_derivatives, through_factor
from stribeck.curves.point_sensitivities import ball_derivatives
from stribeck.equations.sensitivity import friction_slopes
from stribeck.numerics.dual import Dual, slope_of
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.units import InputError
from stribeck.solver.solution import Solution
from stribeck.solver.solve import check_rtol, finish, solve, solved_point

Derivatives = tuple[Any, Array, Mapping[str, float], Mapping[str, float]]
"""A solved state, and the derivatives of its friction by the logarithms of the groups, of inputs through numbers of fluid and
solid, and of inputs at fixed groups and numbers."""


@one_blas_thread
def friction_sensitivities(
    contact: Contact,
    *,
    rtol: float = 1e-6,
    definition: Definition = "balanced",
) -> tuple[Solution, dict[str, float]]:
    r"""Solve a contact and return the sensitivity of its friction to each input.

    .. math::

        \epsilon_X = \frac{d \ln \mu}{d \ln X}
        = \frac{1}{\mu} \left[ \sum_G n_{GX} \frac{\partial \mu}{\partial \ln G}
        + \left.\frac{\partial \mu}{\partial \ln X}\right|_G \right]

    with G the three groups and n their exponents, ``INPUTS.exponents`` of the contact. The last term is the
    contact part of the friction for the friction coefficient and the viscous part for beta, and what changes through the
    fluid and the solid, whose numbers in Hertz units depend on inputs of the contact.
    """
    rtol = check_rtol(rtol)
    definition = check_definition(definition)
    solution, by_groups, through, direct = SENSITIVITIES[contact.groups.geometry](contact, rtol, definition)
    total = float(solution.friction(definition=definition)) or math.nan
    known = exponents_of(contact)
    exponents = {name: known.get(name, (0.0, 0.0, 0.0)) for name in (*dict(contact.inputs()), *part_names(contact))}
    return solution, {
        name: (float(by_groups @ np.array(powers)) + through.get(name, 0.0) + direct.get(name, 0.0)) / total
        for name, powers in exponents.items()
    }


def sensitivities_if_known(
    contact: Contact, *, rtol: float = 1e-6, definition: Definition = "balanced"
) -> tuple[Solution, dict[str, float], str]:
    """Return the state of a contact with its sensitivities, or with none and the reason if they cannot be computed."""
    try:
        return *friction_sensitivities(contact, rtol=rtol, definition=definition), ""
    except InputError as refusal:
        return solve(contact, rtol=rtol), {}, str(refusal)


def _of_cylinder(contact: Contact, rtol: float, definition: Definition) -> Derivatives:
    """Return the derivatives of the friction of a cylinder by those of its equations."""
    groups = contact.groups
    by_groups, through = np.zeros(3), dict[str, float]()
    asperities = contact.friction_of_asperities
    rubbing = asperities.factor(contact) * sliding_part(contact.slide_to_roll)
    if groups.speed == 0:
        solution, by_groups = solve(contact, rtol=rtol), rubbing * rest_derivatives(contact, rtol)
    else:
        point = solved_point(groups, rtol)
        solution, state = finish(point, groups, contact, rtol), point.state
        assert state is not None
        named = [name for name, value in contact.inputs() if value and groups.model != BASE_MODEL]
        beside = {name: models_at_both_sides(contact, name) for name in (*named, *part_names(contact))}
        changes = {name: each for name, each in beside.items() if each is not None}
        slopes = friction_slopes(state, rubbing, contact.beta, definition, list(changes.values()), asperities.observable)
        by_groups, through = slopes[:3], dict(zip(changes, slopes[3:].tolist(), strict=True))
    friction = solution.friction(definition=definition)
    return solution, by_groups, through, through_factor(contact, friction.asperities) | {"beta": friction.fluid}


SENSITIVITIES: dict[str, Callable[[Contact, float, Definition], Derivatives]] = {
    "line": _of_cylinder,
    "point": ball_derivatives,
}
"""The derivatives of the friction of a solved state, by geometry."""


def atlas_sensitivities(contact: Contact, definition: Definition = "balanced") -> dict[str, float]:
    """Return the sensitivities of the friction that the atlas holds; raise InputError outside."""
    groups, boundary_friction, rule = contact.groups, contact.boundary_friction, RULES[contact.groups.geometry]
    inputs = rule.of_contact(contact)
    slopes = atlas.friction_derivatives(groups, boundary_friction, contact.beta, definition, **rule.motion(contact))
    share, viscous = (float(term[0]) for term in atlas.friction_terms(groups, inputs, definition))
    direct = {"boundary_friction": boundary_friction * float(rule.sliding_factor(groups, inputs)) * share}
    for name, value in inputs.items():
        if math.isfinite(value):
            _, moved = atlas.friction_terms(groups, {**inputs, name: Dual(value, value)}, definition)
            by = direct[name] = direct.get(name, 0.0) + float(slope_of(moved)[0])
            for other, power in rule.exponents.get(name, {}).items():
                direct[other] = direct.get(other, 0.0) + power * by
    total = (direct["boundary_friction"] + viscous) or math.nan
    exponents = contact.INPUTS.exponents
    found = {name: (float(slopes @ np.array(exponents[name])) + direct.get(name, 0.0)) / total for name in exponents}
    return {name: value for name, value in found.items() if name in dict(contact.inputs())}
