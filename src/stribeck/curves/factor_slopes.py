"""Derivatives of the friction of asperities that are not those of a sliding state: through its factor, and at rest."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.parts import part_names
from stribeck.contacts.with_parts import factor_exponents
from stribeck.numerics.settings import LOG_STEP
from stribeck.quantities.outputs import GROUPS
from stribeck.solver.solve import solve

__all__ = ["rest_derivatives", "through_factor"]


def through_factor(contact: Contact, asperities: float) -> dict[str, float]:
    """Return the derivatives of the friction of asperities by the logarithms of the inputs of its factor alone."""
    names = [name for name, value in contact.inputs() if value] + list(part_names(contact))
    return {name: power * asperities for name, power in factor_exponents(contact, names).items() if power}


def rest_derivatives(contact: Contact, rtol: float) -> Array:
    """Return the derivatives of what asperities rub by, by the logarithms of the groups, of a contact at rest."""
    asperities, found = contact.friction_of_asperities, np.zeros(len(GROUPS))
    for k, name in enumerate(GROUPS):
        here = float(getattr(contact.groups, name))
        if here > 0 and not asperities.is_constant:
            beside = [replace(contact.groups, **{name: here * math.exp(step)}) for step in (LOG_STEP, -LOG_STEP)]  # type: ignore[arg-type]
            ends = [asperities.amount(solve(each, rtol=rtol))[0] for each in beside]
            found[k] = (ends[0] - ends[1]) / (2 * LOG_STEP)
    return found
