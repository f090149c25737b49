"""The friction coefficient: its parts, the two definitions of its viscous part, and the coefficients that it needs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from stribeck.contacts.contact import Contact
from stribeck.quantities.inputs import quantity
from stribeck.quantities.units import InputError, show

__all__ = ["DEFINITIONS", "Definition", "Friction", "check_definition", "coefficients"]

Definition = Literal["balanced", "published"]

DEFINITIONS: tuple[Definition, ...] = ("balanced", "published")
"""Definitions of the viscous friction: the force on the substrate, and Eq. (friction) of [BP] (theory.md, section 6)."""


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
    """

    contact: float
    viscous: float
    total: float
    error: float


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
