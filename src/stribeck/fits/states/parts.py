"""The contributions to the friction of many states, with derivatives: what fits ask states for.

The load share and the observables of the viscous friction come without boundary_friction and beta, which may differ from
state to state: :mod:`stribeck.contacts.friction_rules` puts them together.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from stribeck._types import Array
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Groups
from stribeck.contacts.model import Model

__all__ = ["FrictionParts", "Made", "ModelChange", "PartsOf"]


@dataclass(frozen=True)
class FrictionParts:
    """The contributions to the friction of n states, and their derivatives."""

    values: Array  # Contact load share, and the observables that the rule of the geometry names [-]
    slopes: Array
    errors: Array  # Estimated absolute error of the contact load share, and errors of the others as a solution states them
    definition: Definition  # Definition of the viscous friction


class ModelChange(NamedTuple):
    """What a free input changes of the model, in Hertz units."""

    input: int  # Number of the input
    below: Model  # The model at two values of its logarithm
    above: Model  # The model at two values of its logarithm
    width: float  # Their distance


PartsOf = Callable[[Groups, Sequence[ModelChange]], FrictionParts]
"""What gives the parts of the friction of states in a row, with their derivatives along changes of the model."""


class Made:
    """What gives the parts, made anew where it is unpickled: what it keeps of solved states stays behind."""

    def __init__(self, make: Callable[..., PartsOf], *of: Any, **here: Any) -> None:
        self.recipe = (make, *of)
        self.parts_of = make(*of, **here)

    def __call__(self, groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        """Return the parts."""
        return self.parts_of(groups, changes)

    def __reduce__(self) -> tuple[type[Made], tuple[Any, ...]]:
        """Return how to make it."""
        return Made, self.recipe
