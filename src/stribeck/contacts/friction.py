"""The friction coefficient: its parts, its two definitions, the coefficients that it needs, and the regime of a state."""

from __future__ import annotations

import math
from collections.abc import Callable
from copy import deepcopy
from typing import Any, Literal, Self, cast

import numpy as np

from stribeck._types import Array, Indices
from stribeck.asperity_friction.law import AsperityFriction
from stribeck.contacts.contact import Contact
from stribeck.files.results import Record
from stribeck.quantities.schema import numbers_of
from stribeck.quantities.units import checked_word, to_si

Regime = Literal["boundary", "mixed", "hydrodynamic"]

# The regimes in the order of rising speed; their places are their numbers.
REGIMES: tuple[Regime, ...] = ("boundary", "mixed", "hydrodynamic")

# Part of the load on the fluid up to which lubrication is called boundary: friction is within 5 % of the plateau.
BOUNDARY_FLUID_SHARE = 0.05

# Part of the friction from asperities up to which lubrication is called hydrodynamic: at the friction minimum of smooth
# contacts asperities give about 2/(2 + 3 Lambda), 6 to 18 % for Lambda from 10 to 3.
HYDRODYNAMIC_CONTACT_SHARE = 0.1


MIN_FRICTION = 1e-300  # Smallest friction in a quotient


def friction_share(contact: Any, viscous: Any) -> Any:
    """Return the part of the friction that asperities cause, by size as signs may differ, zero without friction."""
    size = np.abs(contact)
    return size / np.maximum(size + np.abs(viscous), MIN_FRICTION)


def regime_of(fluid_load_share: float, contact_friction_share: float) -> Regime:
    """Return the regime from the fluid load share and the fraction of friction that asperities cause.

    Parameters
    ----------
    fluid_load_share : float
        Part of the load that the fluid carries [-].
    contact_friction_share : float
        Contact part of the friction over all of it [-].

    Returns
    -------
    str
        ``"hydrodynamic"`` where asperities cause at most 10 % of the friction, else ``"boundary"`` where the fluid carries
        at most 5 % of the load, else ``"mixed"``.

    Raises
    ------
    InputError
        If one is no number.

    Examples
    --------
    >>> regime_of(0.2, 0.99)
    'mixed'
    """
    fluid = to_si(fluid_load_share, "number", "fluid_load_share")
    contact = to_si(contact_friction_share, "number", "contact_friction_share")
    return REGIMES[int(regime_numbers(np.array(fluid), np.array(contact)))]


def regime_numbers(fluid_load_share: Array, contact_friction_share: Array) -> Indices:
    """Return the places in :data:`REGIMES` of the regimes of many states, by the rule of :func:`regime_of`."""
    slow = np.where(fluid_load_share <= BOUNDARY_FLUID_SHARE, REGIMES.index("boundary"), REGIMES.index("mixed"))
    return np.where(contact_friction_share <= HYDRODYNAMIC_CONTACT_SHARE, REGIMES.index("hydrodynamic"), slow)


Definition = Literal["balanced", "published"]

# Definitions of the viscous friction: the force on the substrate, and Eq. (friction) of [BP] (theory.md, section 6).
DEFINITIONS: tuple[Definition, ...] = ("balanced", "published")

FULL_SLIP_RATIO = 0.01  # Slide-to-roll ratio from which asperities slide fully


class Friction(Record, float):
    """Friction coefficient of one state, a number with its parts; called, the one for other coefficients.

    Parameters
    ----------
    asperities : float
        Part from asperities, boundary_friction times their share of the load [-].
    fluid : float
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
    >>> friction = Friction(asperities=0.3, fluid=0.1, total=0.4, error=1e-7)
    >>> friction + 1, friction.asperities
    (1.4, 0.3)
    >>> round(friction.contact_share, 6)
    0.75
    """

    _labels = {
        "total": ("1", "friction coefficient"),
        "asperities": ("1", "contribution of asperities to the friction coefficient"),
        "fluid": ("1", "contribution of the fluid to the friction coefficient"),
        "error": ("1", "estimated absolute error of total"),
        "lower": ("1", "tangential force on the substrate over the load"),
        "upper": ("1", "tangential force on the cylinder over the load"),
    }

    asperities: float
    fluid: float
    error: float
    lower: float
    upper: float
    _other: Callable[..., Friction]

    def __new__(
        cls,
        asperities: float,
        fluid: float,
        total: float,
        error: float,
        lower: float = math.nan,
        upper: float = math.nan,
        _other: Callable[..., Friction] | None = None,
    ) -> Self:
        """Make the number, which cannot change."""
        made = super().__new__(cls, total)
        made.asperities, made.fluid, made.error, made.lower, made.upper = asperities, fluid, error, lower, upper
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
        return float(friction_share(self.asperities, self.fluid))

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
        return f"Friction(asperities={self.asperities!r}, fluid={self.fluid!r}, total={total!r}, error={self.error!r})"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the numbers, and what they are called for."""
        numbers = self.asperities, self.fluid, float(self), self.error, self.lower, self.upper
        return type(self), (*numbers, getattr(self, "_other", None))


class FrictionArray(np.ndarray[Any, np.dtype[np.float64]]):
    """Friction coefficients of many states, an array with its parts; called, those for other coefficients."""

    asperities: Array  # Part from asperities [-]
    fluid: Array  # Part from the fluid [-]
    error: Array  # Estimated absolute error of the sum [-]
    _other: Callable[..., FrictionArray]

    def __new__(cls, asperities: Array, fluid: Array, total: Array, error: Array, other: Callable[..., FrictionArray]) -> Self:
        """Make the array of the sums."""
        made = np.asarray(total).view(cls)
        made.asperities, made.fluid, made.error, made._other = asperities, fluid, error, other
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
        """Pickle the numbers, and what they are called for; what numpy made of them is a plain array."""
        if not vars(self):
            return self.total.__reduce__()
        return type(self), (self.asperities, self.fluid, self.total, self.error, self._other)

    def __deepcopy__(self, memo: Any) -> Any:
        """Copy the parts too."""
        return type(self)(*deepcopy(self.__reduce__()[1], memo)) if vars(self) else self.total.copy()

    def __copy__(self) -> Any:
        """Copy the parts too."""
        return self.__deepcopy__({})


def friction_of(terms: Array, other: Callable[..., Any], is_number: bool = False) -> Friction | FrictionArray:
    """Return friction whose asperity part, fluid part, sum and error are the columns of an array, or of its only row."""
    if is_number:
        asperities, fluid, total, error = terms[0].tolist()
        return Friction(asperities, fluid, total, error, _other=other)
    return FrictionArray(terms[:, 0], terms[:, 1], terms[:, 2], terms[:, 3], other)


def sliding_part(slide_to_roll: Any) -> Any:
    r"""Return the part of the sliding friction of asperities that acts, with its sign.

    .. math:: f = \tfrac12 t (3 - t^2), \quad t = \mathrm{SRR}/0.01 \text{ between } -1 \text{ and } 1
    """
    t = np.clip(slide_to_roll / FULL_SLIP_RATIO, -1.0, 1.0)
    return 0.5 * t * (3 - t * t)


def coefficients(contact: Contact | None, boundary_friction: Any, beta: float | None) -> tuple[Any, float]:
    """Return boundary_friction (or another friction of asperities) and beta as given, by default of the contact, else 1."""
    own = boundary_friction
    if own is None and contact is not None:
        own = contact.asperity_friction
    of_asperities = isinstance(own, AsperityFriction)

    def coefficient(name: str, given: float | None) -> float:
        if given is not None:
            return numbers_of(Contact)[name].checked(given)
        return 1.0 if contact is None else float(getattr(contact, name))

    return own if of_asperities else coefficient("boundary_friction", boundary_friction), coefficient("beta", beta)


def check_definition(definition: str) -> Definition:
    """Return ``definition`` if it names one of :data:`DEFINITIONS`."""
    return cast(Definition, checked_word("definition", definition, DEFINITIONS))
