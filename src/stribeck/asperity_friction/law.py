r"""What the package asks of the friction of asperities: an observable of a state, and a factor on it.

.. math:: \mu_c = f(S) \, k \, A

with the part f of the slip that acts, the factor k of a contact, and the observable A, which the fields of a state give.  A
new friction is a new file with one frozen class that has the members of :class:`AsperityFriction`.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import replace
from typing import Any, ClassVar, Self, cast

import numpy as np

from stribeck._types import Array
from stribeck.quantities.docstrings import told
from stribeck.quantities.formats import format_si
from stribeck.quantities.schema import Input, Series, numbers_of
from stribeck.quantities.units import InputError


class AsperityFriction(ABC):
    """How the asperities of a contact resist sliding."""

    name: ClassVar[str]  # Name that outputs print, and case files
    observable: ClassVar[str]  # Observable of a state to which the friction is proportional
    size: ClassVar[str] = ""  # The input that is its size, if one is
    is_constant: ClassVar[bool] = False  # Whether the factor is the same for all contacts

    @property
    def uses_speed(self) -> bool:
        """Whether the factor changes with the sliding speed."""
        return False

    @property
    def known_speeds(self) -> tuple[float, float]:
        """Sliding speeds between which the factor is known [m/s]."""
        return 0.0, math.inf

    @property
    def is_frictionless(self) -> bool:
        """Whether the friction is zero whatever the state."""
        return bool(getattr(self, self.size) == 0)

    @told({"by": "float\n    Factor on the size [-]."}, "AsperityFriction\n    The law, of the same kind.")
    def scaled(self, by: float) -> Self:
        """Return the law with a larger size: coefficient, or shear stress."""
        found: Self = replace(cast(Any, self), **{self.size: by * getattr(self, self.size)})
        return found

    @abstractmethod
    def factor(self, contact: Any) -> float:
        """Return the friction coefficient for an observable of one, of a contact or of groups alone, which are None."""

    def factors(self, contact: Any, speeds: Array) -> Array:
        """Return the factor at other speeds of a contact."""
        return np.full(np.shape(speeds), self.factor(contact))

    @abstractmethod
    def coefficient_at_small_area(self, contact: Any) -> float:
        """Return the friction coefficient where the real area of contact is proportional to the load of the asperities."""

    def amount(self, state: Any) -> tuple[float, float]:
        """Return the observable of a state and its absolute error."""
        return getattr(state, self.observable), state.errors[self.observable]

    def part(self, state: Any, sliding: float) -> tuple[float, float]:
        """Return the friction coefficient of the asperities of a state and its absolute error."""
        value, error = self.amount(state)
        factor = self.factor(state.contact)
        return sliding * factor * value, abs(sliding) * factor * error

    def check(self, contact: Any) -> None:
        """Refuse a contact that cannot have this friction."""
        return None

    @property
    def text(self) -> str:
        """Name and numbers in words, but for those by default."""
        given = {row.label: format_si(value, row.dimension) for row, value in self._given}
        return ", ".join([self.name, *(f"{label} {value}" for label, value in given.items())])

    @property
    def _given(self) -> list[tuple[Input, float]]:
        values = [(row, getattr(self, name)) for name, row in _plain(self).items()]
        return [(row, value) for row, value in values if value != row.default]

    @property
    def parameters(self) -> dict[str, float | str]:
        """Its numbers, for outputs."""
        found: dict[str, float | str] = {name: getattr(self, name) for name in _plain(self)}
        others = {name: getattr(self, name) for name in numbers_of(type(self)) if name not in found}
        return found | {name: " ".join(f"{each:g}" for each in values) for name, values in others.items()}


def _plain(friction: AsperityFriction) -> dict[str, Input]:
    """Return those of its numbers that are no lists."""
    return {name: row for name, row in numbers_of(type(friction)).items() if not isinstance(row, Series)}


class NoCoefficientError(InputError, AttributeError):
    """A coefficient is needed, and asperities have another friction: the contact has no such attribute."""


def refuse_coefficient(friction: Any) -> NoCoefficientError:
    """Return the error where a coefficient is needed and asperities have another friction."""
    return NoCoefficientError(
        f"boundary_friction is no number of this contact, whose asperities have {friction.text} in its place: states and "
        "curves take that, but what was asked needs a coefficient. Give boundary_friction = ... to the contact; where "
        "asperities touch on a small part of the surface, asperity_friction.coefficient_at_small_area(contact) is that number."
    )
