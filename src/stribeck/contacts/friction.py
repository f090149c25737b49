"""The friction coefficient: its parts, the two definitions of its viscous part, and the coefficients that it needs."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal, Self

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.regime import friction_share
from stribeck.quantities.inputs import quantity
from stribeck.quantities.units import InputError, show

__all__ = [
    "DEFINITIONS",
    "Definition",
    "Friction",
    "FrictionArray",
    "check_definition",
    "coefficients",
    "sliding_part",
]

Definition = Literal["balanced", "published"]

# Definitions of the viscous friction: the force on the substrate, and Eq. (friction) of [BP] (theory.md, section 6).
DEFINITIONS: tuple[Definition, ...] = ("balanced", "published")

FULL_SLIP_RATIO = 0.01  # Slide-to-roll ratio from which asperities slide fully


class Friction(float):
    """Friction coefficient of one state, a number with its parts; called, the one for other coefficients.

    Parameters
    ----------
    contact : float
        Part from asperities, boundary_friction times their share of the load [-].
    viscous : float
        Part from the fluid [-].
    total : float
        Their sum, the value of the number itself [-].
    error : float
        Estimated absolute error of the sum [-].
    lower, upper : float
        Tangential force on the substrate and on the cylinder over the load [-], positive where it brakes a substrate that is
        the faster.  They differ by the pull of the pressures on the curved surface; nan where they are not known.

    Examples
    --------
    >>> friction = Friction(contact=0.3, viscous=0.1, total=0.4, error=1e-7)
    >>> friction + 1, friction.contact
    (1.4, 0.3)
    >>> round(friction.contact_share, 6)
    0.75
    """

    contact: float
    viscous: float
    error: float
    lower: float
    upper: float
    _other: Callable[..., Friction]

    def __new__(
        cls,
        contact: float,
        viscous: float,
        total: float,
        error: float,
        lower: float = math.nan,
        upper: float = math.nan,
        _other: Callable[..., Friction] | None = None,
    ) -> Self:
        """Make the number, which cannot change."""
        made = super().__new__(cls, total)
        made.contact, made.viscous, made.error, made.lower, made.upper = contact, viscous, error, lower, upper
        if _other is not None:
            made._other = _other
        return made

    @property
    def relative_error(self) -> float:
        """Estimated relative error of the sum [-]; zero where friction is."""
        return self.error / abs(self) if self else 0.0

    @property
    def contact_share(self) -> float:
        """Part of the friction that asperities cause [-]; zero without friction."""
        return float(friction_share(self.contact, self.viscous))

    @property
    def total(self) -> float:
        """The sum of both parts [-], as a plain number."""
        return float(self)

    def __call__(self, *args: Any, **kwargs: Any) -> Friction:
        """Return the friction coefficient for another boundary_friction, beta or definition."""
        return self._other(*args, **kwargs)

    def __repr__(self) -> str:
        """Return the parts."""
        total = float(self)
        return f"Friction(contact={self.contact!r}, viscous={self.viscous!r}, total={total!r}, error={self.error!r})"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the numbers."""
        return type(self), (self.contact, self.viscous, float(self), self.error, self.lower, self.upper)


class FrictionArray(np.ndarray[Any, np.dtype[np.float64]]):
    """Friction coefficients of many states, an array with its parts; called, those for other coefficients."""

    contact: Array  # Part from asperities [-]
    viscous: Array  # Part from the fluid [-]
    error: Array  # Estimated absolute error of the sum [-]
    _other: Callable[..., FrictionArray]

    def __new__(cls, contact: Array, viscous: Array, total: Array, error: Array, other: Callable[..., FrictionArray]) -> Self:
        """Make the array of the sums."""
        made = np.asarray(total).view(cls)
        made.contact, made.viscous, made.error, made._other = contact, viscous, error, other
        return made

    @property
    def relative_error(self) -> Array:
        """Estimated relative error of each sum [-]; zero where friction is."""
        size = np.abs(self.total)
        return np.divide(self.error, size, out=np.zeros(size.shape), where=size > 0)

    @property
    def total(self) -> Array:
        """The sum of both parts [-], as a plain array."""
        return np.asarray(self)

    def __call__(self, *args: Any, **kwargs: Any) -> FrictionArray:
        """Return the friction coefficients for another boundary_friction, beta or definition."""
        return self._other(*args, **kwargs)

    def __getitem__(self, key: Any) -> Any:
        """Return plain numbers."""
        return np.asarray(self)[key]

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        """Let what is computed of it be plain numbers."""
        return np.asarray(array)[()]

    def __reduce__(self) -> Any:
        """Pickle the total, which is a plain array then."""
        return np.asarray(self).__reduce__()


def sliding_part(slide_to_roll: float) -> float:
    r"""Return the part of the sliding friction of asperities that acts, with its sign.

    .. math:: f = \tfrac12 t (3 - t^2), \quad t = \mathrm{SRR}/0.01 \text{ between } -1 \text{ and } 1
    """
    t = min(1.0, max(-1.0, slide_to_roll / FULL_SLIP_RATIO))
    return 0.5 * t * (3 - t * t)


def coefficients(contact: Contact | None, boundary_friction: float | None, beta: float | None) -> tuple[float, float]:
    """Return boundary_friction and beta as given, by default of the contact, or 1 without a contact."""
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
    raise InputError(f"definition = {show(definition)}; it must be one of {', '.join(map(repr, DEFINITIONS))}.")
