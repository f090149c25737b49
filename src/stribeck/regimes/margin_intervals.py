r"""Intervals of margins where inputs have errors.

The next regime begins at the value :math:`X^*` of an input X where a share g passes its bound.  Other inputs Y move it,

.. math::
    \frac{\partial \ln X^*}{\partial \ln Y} = -\frac{\partial g/\partial \ln Y}{\partial g/\partial \ln X}, \qquad
    \sigma^2 = \sum_Y \left(\frac{\partial \ln (X^*/X)}{\partial \ln Y} \, \sigma_Y\right)^2,

with the exact derivatives of the state there, to first order in the errors.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal

from stribeck.asperity_friction.coulomb import Coulomb
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.parts import part_names
from stribeck.curves.sensitivities import friction_sensitivities
from stribeck.quantities.standard_errors import INTERVAL_95, StandardErrors
from stribeck.quantities.units import InputError
from stribeck.regimes.margins import Crossing, RegimeMargins
from stribeck.solver.solve_error import SolveError
from stribeck.uncertainty.propagate import STATE_RTOL, errors_of_kept_inputs, moves_of
from stribeck.uncertainty.result import exact_inputs


def with_intervals(
    contact: Contact,
    margins: RegimeMargins,
    errors: Mapping[str, Any] | Literal["typical"],
    definition: Definition = "balanced",
) -> RegimeMargins:
    """Return margins with the 95 % interval of each factor, to first order in the errors of the inputs.

    Parameters
    ----------
    contact : LineContact or PointContact
        The contact.
    margins : RegimeMargins
        Its margins, by :func:`~stribeck.regimes.margins.regime_margins` with the same definition.
    errors : mapping or "typical"
        Standard error of each uncertain input, as for :func:`stribeck.propagate`.
    definition : {"balanced", "published"}
        Definition of the viscous friction.

    Returns
    -------
    RegimeMargins
        The same margins, each with ``interval_95`` of its factor; a note says why a factor has none.

    Raises
    ------
    InputError
        If an input is unknown, or its error no positive number.

    Examples
    --------
    >>> import stribeck as sb
    >>> from stribeck.regimes.margins import regime_margins
    >>> contact = sb.LineContact(radius=0.01, modulus=2.7e6, load=30, viscosity=0.05, speed=0.02, roughness=1e-6, alpha=2,
    ...                          beta=0.06, boundary_friction=0.7)
    >>> speed = with_intervals(contact, regime_margins(contact), {"roughness": "20 %", "beta": 0.3}).margins[0]
    >>> print(f"{speed.more.factor:.2f}, {speed.more.interval_95[0]:.2f} to {speed.more.interval_95[1]:.2f}")
    1.52, 0.86 to 2.69
    """
    sigmas = errors_of_kept_inputs(contact, errors)
    if not sigmas:
        return margins

    unknown: list[str] = []

    def known(name: str, mark: Crossing | None) -> Crossing | None:
        if mark is None or mark.value <= 0 or not math.isfinite(mark.factor):
            return mark
        try:
            sigma = _sigma(contact, name, mark, sigmas, "hydrodynamic" in (mark.regime, margins.regime), definition)
        except (InputError, SolveError) as error:
            unknown.append(f"The change to {mark.regime} lubrication along {name} has no interval: {error}")
            return mark
        reach = math.exp(INTERVAL_95 * sigma)
        return replace(mark, interval_95=(mark.factor / reach, mark.factor * reach))

    found = tuple(
        replace(each, less=known(each.name, each.less), more=known(each.name, each.more)) for each in margins.margins
    )
    return replace(margins, margins=found, notes=(*margins.notes, *unknown), counted=exact_inputs(contact, sigmas))


def _sigma(
    contact: Contact, name: str, mark: Crossing, sigmas: StandardErrors, by_friction: bool, definition: Definition
) -> float:
    """Return the standard deviation of the logarithm of a factor."""
    slopes = _slopes(contact.replace(**{name: mark.value}), by_friction, definition)
    total = 0.0
    for move in moves_of(contact, sigmas).values():
        change = -sum(step * slopes[other] for other, step in move.items() if other != name) / slopes[name]
        total += (change - move.get(name, 0.0)) ** 2
    return math.sqrt(total)


def _slopes(there: Contact, by_friction: bool, definition: Definition) -> dict[str, float]:
    r"""Return the derivatives of the share that decides on the regime, over a factor that all have in common.

    Friction is :math:`\mu = k S + V`: its derivatives at k and k/2 hold those of S and V.
    """
    asperities = there.friction_of_asperities if by_friction else Coulomb(1.0)
    whole, half = (
        friction_sensitivities(
            there.replace(asperity_friction=asperities.scaled(factor)),
            rtol=STATE_RTOL[there.groups.geometry],
            definition=definition,
        )
        for factor in (1.0, 0.5)
    )
    friction, halved = (solution.friction(definition=definition) for solution, _ in (whole, half))
    found = dict.fromkeys(part_names(there), 0.0)
    for name in whole[1]:
        first, second = friction.total * whole[1][name], halved.total * half[1][name]
        share = 2 * (first - second) / friction.asperities  # d ln S
        viscous = (2 * second - first) / friction.fluid  # d ln V
        found[name] = share - viscous if by_friction else share
    found["boundary_friction"] = 1.0 if by_friction else 0.0
    return found
