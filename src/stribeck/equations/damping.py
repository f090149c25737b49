"""The longest part of a Newton step that keeps gap and contact pressure in bounds, for line and ball."""

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw, local_decay_length
from stribeck.numerics.settings import HALF_DIGITS


def longest_step(law: ContactLaw, gap: Array, change: Array, part: float = 1.0) -> float:
    """Return the longest fraction of a step, at most ``part``, that keeps gap and contact pressure within bounds."""
    # The gap may lose 70 % at most; if contact matters, its pressure may change by a factor of e**3 at most.
    part = min(part, 0.7 / max(0.7, -float((change / gap).min())))
    if not np.all(law.decay_length > 0):
        return part
    log_p = law.log_pressure(gap)
    decays = change / local_decay_length(law, gap)
    allowed = 3.0 + np.maximum(0.0, -1.0 - log_p)
    closing = float((-decays / allowed).max())
    opening = float((decays * (log_p > -7.0)).max()) / 3.0
    part = float(min(part, 1.0 / max(1.0, closing, opening)))
    return part if law.constant_decay else _held_by_law(law, gap, change, part, log_p, allowed)


def _held_by_law(law: ContactLaw, gap: Array, change: Array, part: float, log_p: Array, allowed: Array) -> float:
    """Return the part, halved until the pressure of a law that stiffens grows by at most 50 %."""
    while part >= HALF_DIGITS:
        with np.errstate(all="ignore"):
            growth = law.log_pressure(gap + part * change) - log_p
        if (growth <= 1.5 * allowed).all():
            break
        part *= 0.5
    return part
