"""Contacts at rest: a law that lets the gap become negative is shifted, so that all gaps are positive while it is solved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stribeck.contact_laws.law import LawShape, has_constant_decay
from stribeck.contact_laws.scaled import ShiftedShape
from stribeck.contacts.groups import Groups

SAFE_SEPARATION = 2.3
"""Separation at the largest pressure from which all gaps are positive at rest; that of the exponential law at load 0.01."""


def separation_at(shape: LawShape, log_pressure: float) -> float:
    """Return the separation at which ln(Phi) has a value, by bisection; minus or plus 1e6 where it has none between them."""
    low, high = max(-1e6, shape.lowest), 1e6
    for _ in range(100):
        middle = 0.5 * (low + high)
        with np.errstate(all="ignore"):
            above = float(shape.log_pressure(np.array([middle]))[0]) > log_pressure
        low, high = (middle, high) if above else (low, middle)
    return 0.5 * (low + high)


def lifted(groups: Groups) -> tuple[Groups, float]:
    r"""Return groups at rest with a shifted law, all gaps of which are positive, and by how much they are larger.

    .. math:: \Delta s = \max(0, s_0 - \Phi^{-1}(\bar F_N^{1/2}))

    Nowhere is the pressure much above that of the smooth contact, one: there the separation is s_0, :data:`SAFE_SEPARATION`.
    Laws that diverge at zero need no shift.
    """
    shape = groups.law
    if shape is None or has_constant_decay(shape) or shape.lowest > -np.inf or isinstance(shape, ShiftedShape):
        return groups, 0.0
    shift = max(0.0, SAFE_SEPARATION - separation_at(shape, 0.5 * float(np.log(groups.load))))
    if shift == 0.0:
        return groups, 0.0
    return replace(groups, law=ShiftedShape(shape, shift)), shift * float(groups.relative_roughness)
