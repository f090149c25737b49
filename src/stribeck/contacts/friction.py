"""The friction coefficient: its parts, the two definitions of its viscous part, and the coefficients that it needs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from stribeck.contacts.contact import Contact
from stribeck.quantities.inputs import quantity
from stribeck.quantities.units import InputError, show

__all__ = ["DEFINITIONS", "Definition", "Friction", "check_definition", "coefficients", "sliding_part"]

Definition = Literal["balanced", "published"]

DEFINITIONS: tuple[Definition, ...] = ("balanced", "published")
"""Definitions of the viscous friction: the force on the substrate, and Eq. (friction) of [BP] (theory.md, section 6)."""


STICKING = 0.01
"""Slide-to-roll ratio from which asperities slide fully."""


@dataclass(frozen=True)
class Friction:
    """Friction coefficient and its contributions from asperities and fluid.

    Attributes
    ----------
    contact : float
        Part from asperities, boundary_friction times their share of the load [-].
    viscous : float
        Part from the fluid [-].
    total : float
        Their sum [-].
    error : float
        Estimated absolute error of the sum [-].
    lower, upper : float
        Tangential force on the substrate and on the cylinder over the load [-], positive where it brakes a substrate that is
        the faster.  They differ by the pull of the pressures on the curved surface; nan where they are not known.
    """

    contact: float
    viscous: float
    total: float
    error: float
    lower: float = math.nan
    upper: float = math.nan


def sliding_part(slide_to_roll: float) -> float:
    r"""Return the part of the sliding friction of asperities that acts, with its sign.

    .. math:: f = \tfrac12 t (3 - t^2), \quad t = \mathrm{SRR}/0.01 \text{ between } -1 \text{ and } 1

    Parameters
    ----------
    slide_to_roll : float
        Slide-to-roll ratio [-].

    Returns
    -------
    float
        One from a ratio of 1 % on, zero at pure rolling, and minus one below -1 %.

    Notes
    -----
    Asperities stick before they slide; how far depends on their stiffness, which the model does not have.  The ratio of 1 % is
    a choice that makes friction smooth through pure rolling.
    """
    t = min(1.0, max(-1.0, slide_to_roll / STICKING))
    return 0.5 * t * (3 - t * t)


def coefficients(contact: Contact | None, boundary_friction: float | None, beta: float | None) -> tuple[float, float]:
    """Return boundary_friction and beta as given, else those of the contact, else 1."""
    if contact is None and boundary_friction is None and beta is None:
        return 1.0, 1.0
    if boundary_friction is None:
        boundary_friction = 1.0 if contact is None else contact.boundary_friction
    if beta is None:
        beta = 1.0 if contact is None else contact.beta
    return quantity("boundary_friction", boundary_friction), quantity("beta", beta)


def check_definition(definition: str) -> Definition:
    """Return ``definition`` if it names one of :data:`DEFINITIONS`."""
    for known in DEFINITIONS:
        if isinstance(definition, str) and definition == known:
            return known
    hint = " The friction of the paper is called 'published'." if isinstance(definition, str) and definition == "paper" else ""
    raise InputError(f"definition = {show(definition)}; it must be one of {', '.join(map(repr, DEFINITIONS))}.{hint}")
