"""Sensitivities of the friction of a state: its logarithmic derivatives with respect to the inputs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Literal, overload

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, check_definition, sliding_part
from stribeck.contacts.friction_rules import COMPLEX_STEP, RULES
from stribeck.contacts.model import BASE_MODEL
from stribeck.contacts.part_inputs import PART_INPUTS, part_names
from stribeck.contacts.with_parts import models_at_both_sides
from stribeck.curves.regime import Method, check_method
from stribeck.equations.sensitivity import friction_slopes
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.inputs import LINE
from stribeck.quantities.units import InputError
from stribeck.solver.path.line_path import with_ending_of
from stribeck.solver.solution import Solution
from stribeck.solver.solve import check_rtol, finish, solve, solved_point


@overload
def friction_sensitivities(
    contact: Contact, *, rtol: float = ..., definition: Definition = ..., method: Literal["solver"] = ...
) -> tuple[Solution, dict[str, float]]: ...


@overload
def friction_sensitivities(
    contact: Contact, *, rtol: float = ..., definition: Definition = ..., method: Literal["atlas"]
) -> tuple[None, dict[str, float]]: ...


@one_blas_thread
def friction_sensitivities(
    contact: Contact,
    *,
    rtol: float = 1e-6,
    definition: Definition = "balanced",
    method: Method = "solver",
) -> tuple[Solution | None, dict[str, float]]:
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
    if check_method(method) == "atlas":
        return None, _from_atlas(contact, definition)
    groups = contact.groups
    if groups.geometry in SENSITIVITIES:
        return SENSITIVITIES[groups.geometry](contact, rtol, definition)
    if groups.speed == 0:
        solution, slopes = solve(contact, rtol=rtol), np.zeros(3)
        through = dict.fromkeys(part_names(contact), 0.0)
    else:
        point = solved_point(groups, rtol)
        solution = finish(point, groups, contact, rtol)
        assert point.state is not None
        names = [name for name in LINE.exponents if getattr(contact, name, None)] + list(part_names(contact))
        names = names if groups.model != BASE_MODEL else []
        changes = {name: beside for name in names if (beside := models_at_both_sides(contact, name)) is not None}
        state = point.state  # of a film that may re-form, with a cavity or without
        along = [
            (with_ending_of(state, below), with_ending_of(state, above), width) for below, above, width in changes.values()
        ]
        rubbing = contact.boundary_friction * sliding_part(2 * groups.model.film.slide)
        slopes = friction_slopes(state, rubbing, contact.beta, definition, along)
        through = dict.fromkeys((name for name in names if name in PART_INPUTS), 0.0)
        through |= zip(changes, slopes[3:].tolist(), strict=True)
    friction = solution.friction(definition=definition)
    return solution, _sensitivities(slopes[:3], friction.contact, friction.viscous, through)


def sensitivities_if_known(
    contact: Contact, *, rtol: float = 1e-6, definition: Definition = "balanced"
) -> tuple[Solution, dict[str, float], str]:
    """Return the state of a contact with its sensitivities, or with none and the reason if they cannot be computed."""
    try:
        return *friction_sensitivities(contact, rtol=rtol, definition=definition), ""
    except InputError as refusal:
        return solve(contact, rtol=rtol), {}, str(refusal)


def _of_ball(contact: Contact, rtol: float, definition: Definition) -> tuple[Any, dict[str, float]]:
    from stribeck.curves.point_sensitivities import point_sensitivities

    return point_sensitivities(contact, rtol, definition)


SENSITIVITIES = {"point": _of_ball}
"""Sensitivities to the inputs, for geometries other than the line."""


def _from_atlas(contact: Contact, definition: Definition) -> dict[str, float]:
    groups, boundary_friction, rule = contact.groups, contact.boundary_friction, RULES[contact.groups.geometry]
    inputs = rule.of_contact(contact)
    slopes = atlas.friction_derivatives(groups, boundary_friction, contact.beta, definition, **rule.motion(contact))
    share, viscous = (float(term[0]) for term in atlas.friction_terms(groups, inputs, definition))
    direct = {"boundary_friction": boundary_friction * float(rule.sliding_factor(groups, inputs)) * share}
    for name, value in inputs.items():
        if math.isfinite(value):
            moved = atlas.friction_terms(groups, {**inputs, name: value * (1 + 1j * COMPLEX_STEP)}, definition)[1]
            by = direct[name] = direct.get(name, 0.0) + float(np.imag(moved[0])) / COMPLEX_STEP
            for other, power in rule.exponents.get(name, {}).items():
                direct[other] = direct.get(other, 0.0) + power * by
    total = (direct["boundary_friction"] + viscous) or math.nan
    exponents = contact.INPUTS.exponents
    found = {name: (float(slopes @ np.array(exponents[name])) + direct.get(name, 0.0)) / total for name in exponents}
    return {name: value for name, value in found.items() if name in dict(contact.inputs())}


def _sensitivities(
    slopes: Array, contact: float, viscous: float, through: Mapping[str, float] | None = None
) -> dict[str, float]:
    """Return the sensitivities from the derivatives of the friction and its two parts, and those through the model."""
    direct = {"boundary_friction": contact, "beta": viscous}
    total = (contact + viscous) or math.nan
    model = through or {}
    exponents = {**dict.fromkeys(model, (0.0, 0.0, 0.0)), **LINE.exponents}
    return {
        name: (float(slopes @ np.array(exponents[name])) + direct.get(name, 0.0) + model.get(name, 0.0)) / total
        for name in (*LINE.exponents, *(name for name in model if name not in LINE.exponents))
    }
