"""Friction of asperities as a coefficient times their load."""

from dataclasses import dataclass
from typing import Any, ClassVar

from stribeck.asperity_friction.law import AsperityFriction
from stribeck.quantities.docstrings import told
from stribeck.quantities.outputs import AREA

# What the methods say that return the coefficient.
OF_CONTACT = (
    {"contact": "LineContact, PointContact or None\n    The contact, of which nothing is needed."},
    "float\n    The coefficient [-].",
)


@dataclass(frozen=True)
class Coulomb(AsperityFriction):
    r"""The law of Amontons and Coulomb: a coefficient times the load that asperities carry.

    .. math:: \mu_c = \mu_0 \frac{F_c}{F_N}

    Attributes
    ----------
    boundary_friction : float
        Friction coefficient of the dry contact [-].

    Notes
    -----
    It is what ``boundary_friction`` of a contact stands for.

    Examples
    --------
    >>> Coulomb(0.7).factor(None)
    0.7
    """

    observable: ClassVar[str] = "contact_load_share"
    size: ClassVar[str] = "boundary_friction"
    is_constant: ClassVar[bool] = True

    boundary_friction: float

    @property
    def text(self) -> str:
        """The coefficient."""
        return f"{self.boundary_friction:g}"

    @told(*OF_CONTACT)
    def factor(self, contact: Any) -> float:
        """Return the coefficient."""
        return self.boundary_friction

    @told(*OF_CONTACT)
    def coefficient_at_small_area(self, contact: Any) -> float:
        """Return the coefficient, which holds at any area."""
        return self.boundary_friction


def as_asperity_friction(friction: Any) -> AsperityFriction:
    """Return the friction of asperities that a coefficient stands for, or one that is given as such."""
    return friction if isinstance(friction, AsperityFriction) else Coulomb(friction)


def needs_area(friction: Any) -> bool:
    """Return whether the friction of asperities, or a coefficient, needs their real area of contact."""
    return as_asperity_friction(friction).observable == AREA
