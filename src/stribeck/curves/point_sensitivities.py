"""What would move the friction of a ball: derivatives by the groups from neighbouring states, all else in closed form."""

from __future__ import annotations

import math
from dataclasses import replace

from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.solver.point.finish import finish_point
from stribeck.solver.point.path import next_state
from stribeck.solver.point.solution import PointObservables, PointSolution

__all__ = ["point_sensitivities"]

STEP = 0.02
"""Change of the logarithm of a group on both sides; the error of a derivative goes as its square, about 1e-4."""

TIGHT = 1e-6
"""Largest tolerance of the states whose differences are taken."""

WIDTH_EXPONENTS = {"radius": 1 / 3, "modulus": -1 / 3, "load": 1 / 3}
"""Exponents with which inputs enter the Hertz radius, in which a wetted radius is measured."""


def point_sensitivities(contact: Contact, rtol: float, definition: Definition) -> tuple[PointSolution, dict[str, float]]:
    """Return the state of a ball and the logarithmic derivatives of its friction by each input.

    Parameters
    ----------
    contact : PointContact
        The contact.
    rtol : float
        Relative tolerance of the state; its neighbours are solved to 1e-6 at least.
    definition : {"balanced", "published"}
        Definition of the viscous friction.

    Returns
    -------
    PointSolution
        The state.
    dict of str to float
        By name of the input; nan where there is no friction.
    """
    groups, beta, mu0 = contact.groups, contact.beta, contact.boundary_friction
    state = next_state(None, groups, min(rtol, TIGHT))
    solution = finish_point(state, contact)
    values: PointObservables = solution.observables
    rubbing = mu0 * solution.is_sliding

    def total(found: PointObservables, beta: float = beta) -> float:
        return rubbing * found.contact_load_share + found.viscous_friction(beta, definition)

    slopes = {"speed": 0.0, "load": 0.0, "roughness": 0.0}
    for name in slopes if groups.speed > 0 else ():
        here = float(getattr(groups, name))
        if here > 0:
            ends = []
            for step in (STEP, -STEP):
                varied = {name: here * math.exp(step)}
                beside = finish_point(next_state(state, replace(groups, **varied), min(rtol, TIGHT)), contact)  # type: ignore[arg-type]
                ends.append(total(beside.observables))
            slopes[name] = (ends[0] - ends[1]) / (2 * STEP)
    small = 1e-4
    by_beta = (total(values, beta * math.exp(small)) - total(values, beta * math.exp(-small))) / (2 * small)
    direct = {"boundary_friction": rubbing * values.contact_load_share, "beta": by_beta}
    ratio = values._slide_to_roll
    more, less = (replace(values, _slide_to_roll=ratio * math.exp(step)) for step in (small, -small))
    direct["slide_to_roll"] = (total(more) - total(less)) / (2 * small)
    wetted = values._wetted_radius
    if wetted is not None:
        more, less = (replace(values, _wetted_radius=wetted * math.exp(step)) for step in (small, -small))
        by_edge = (total(more) - total(less)) / (2 * small)
        direct["wetted_radius"] = by_edge
        direct |= {name: -exponent * by_edge for name, exponent in WIDTH_EXPONENTS.items()}
    friction = total(values) or math.nan
    found = {}
    for name, _ in contact.inputs():
        by_groups = sum(n * slope for n, slope in zip(contact.INPUTS.exponents[name], slopes.values(), strict=True))
        found[name] = (by_groups + direct.get(name, 0.0)) / friction
    return solution, found
