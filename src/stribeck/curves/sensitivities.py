"""Sensitivities of the friction of a state: its logarithmic derivatives with respect to the inputs."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import far_film
from stribeck.contacts.friction import Definition, check_definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import BASE_MODEL
from stribeck.contacts.parts import part_names
from stribeck.contacts.with_parts import exponents_of, factor_exponents, models_at_both_sides
from stribeck.equations.point.observables import WITHIN
from stribeck.numerics.dual import Dual, by_logarithms
from stribeck.numerics.settings import LOG_STEP
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outputs import GROUPS
from stribeck.quantities.units import InputError
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.solution import Solution
from stribeck.solver.solve import check_rtol, solve

Within = Callable[[int, Any], Any]
"""Friction up to the logarithm of a radius more than that of a film that is far away, see :data:`WITHIN`."""


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

    with G the three groups, n their exponents, and the last term through coefficients of friction, fluid and solid.
    """
    rtol, definition = check_rtol(rtol), check_definition(definition)
    groups, asperities = contact.groups, contact.friction_of_asperities
    names = (asperities.observable, *RULES[groups.geometry].parts(definition))
    changes, within = {}, None
    if groups.speed == 0:
        solution, slopes = solve(contact, rtol=rtol), np.zeros((len(names), len(GROUPS)))
        slopes[0] = _rest_derivatives(contact, rtol)
    else:
        neighbours = Neighbours(rtol)
        solution = neighbours.solution_from_cold(groups, contact)
        named = [name for name, value in contact.inputs() if value and groups.model != BASE_MODEL]
        beside = {name: models_at_both_sides(contact, name) for name in (*named, *part_names(contact))}
        changes = {name: each for name, each in beside.items() if each is not None}
        own = getattr(solution.observables, "_within", None)
        inputs = RULES[groups.geometry].of_contact(contact)
        asked = names if own is None else (*names, *WITHIN)
        slopes = neighbours.observed(groups, asked, list(changes.values()), inputs=inputs).slopes
        if own is not None:
            within = with_slopes(own, slopes[len(names) :])
    parts = [getattr(solution.observables, name) for name in names[1:]]
    values = np.array([asperities.amount(solution)[0], *parts])
    return solution, _sensitivities(contact, definition, values, slopes[: len(names)], [*changes], within)


def sensitivities_if_known(
    contact: Contact, *, rtol: float = 1e-6, definition: Definition = "balanced"
) -> tuple[Solution, dict[str, float], str]:
    """Return the state of a contact with its sensitivities, or with none and the reason if they cannot be computed."""
    try:
        return *friction_sensitivities(contact, rtol=rtol, definition=definition), ""
    except InputError as refusal:
        return solve(contact, rtol=rtol), {}, str(refusal)


def atlas_sensitivities(contact: Contact, definition: Definition = "balanced") -> dict[str, float]:
    """Return the sensitivities of the friction that the atlas holds; raise InputError outside."""
    return _sensitivities(contact, definition, *atlas.friction_parts(contact.groups, definition))


def _sensitivities(
    contact: Contact,
    definition: Definition,
    values: Array,
    slopes: Array,
    changes: Sequence[str] = (),
    within: Within | None = None,
) -> dict[str, float]:
    """Return the sensitivities, given what asperities rub by, viscous parts, and slopes by groups and by changes."""
    groups, asperities, rule = contact.groups, contact.friction_of_asperities, RULES[contact.groups.geometry]
    inputs, count = rule.of_contact(contact), slopes.shape[1]
    none = np.zeros(len(inputs))
    amount, *parts = (Dual(value, np.append(by, none)) for value, by in zip(values.tolist(), slopes, strict=True))
    speed, load = by_logarithms(map(float, (groups.speed, groups.load)), count + len(inputs))
    taken = dict(zip(inputs, by_logarithms(inputs.values(), count + len(inputs), count), strict=True))
    given = {**taken, "far": far_film(groups.model), "within": within}
    rubbing = asperities.factor(contact) * rule.sliding_factor(groups, taken) * amount
    friction = rubbing + rule.viscous(dict(zip(rule.parts(definition), parts, strict=True)), speed, load, given, definition)
    named = [*dict(contact.inputs()), *part_names(contact)]
    known = exponents_of(contact)
    found = {name: float(friction.slope[:3] @ known.get(name, np.zeros(3))) for name in named}
    for name, power in factor_exponents(contact, [name for name in named if getattr(contact, name)]).items():
        found[name] += power * float(rubbing.value)
    for name, by in zip((*changes, *inputs), friction.slope[3:].tolist(), strict=True):
        for other, power in {name: 1.0, **rule.exponents.get(name, {})}.items():
            if other in found:
                found[other] += power * by
    total = float(friction.value) or math.nan
    return {name: value / total for name, value in found.items()}


def with_slopes(within: Within, slopes: Array) -> Within:
    """Return friction up to a logarithm of the radius that brings its derivatives, given those at a fixed radius."""

    def at(which: int, log_radius: Any) -> Any:
        here = float(log_radius.value)
        ahead, behind = (within(which, here + step) for step in (LOG_STEP, -LOG_STEP))
        moving: Any = log_radius.scaled((ahead - behind) / (2 * LOG_STEP), within(which, here))
        moving.slope[: slopes.shape[1]] += slopes[which]
        return moving

    return at


def _rest_derivatives(contact: Contact, rtol: float) -> Array:
    """Return the derivatives of what asperities rub by, by the logarithms of the groups, of a contact at rest."""
    asperities, found = contact.friction_of_asperities, np.zeros(len(GROUPS))
    for k, name in enumerate(GROUPS):
        here = float(getattr(contact.groups, name))
        if here > 0 and not asperities.is_constant:
            beside = [replace(contact.groups, **{name: here * math.exp(step)}) for step in (LOG_STEP, -LOG_STEP)]  # type: ignore[arg-type]
            ends = [asperities.amount(solve(each, rtol=rtol))[0] for each in beside]
            found[k] = (ends[0] - ends[1]) / (2 * LOG_STEP)
    return found
