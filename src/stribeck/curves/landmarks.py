"""A landmark of a curve: its minimum, or a transition between regimes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from stribeck.files.results import Record
from stribeck.quantities.outputs import GROUPS

__all__ = ["Landmark"]


@dataclass(frozen=True)
class Landmark(Record):
    """A characteristic point of a curve: its position and the solution there.

    Attributes
    ----------
    name : str
        Its name.
    value : float
        Where along the curve: group [-], or SI where the curve has a contact.
    friction : float
        Total friction coefficient there [-].
    solution : Solution
        The state; None off the atlas.
    error : float
        Estimated relative error of ``value``, by the errors of the observables [-].
    over : {"speed", "load", "roughness"}
        What the curve runs over: ``value`` is also the attribute of that name, as ``curve.minimum.speed``.
    unit : str
        Unit of ``value``; ``"1"`` of groups.
    """

    _labels = {
        "name": ("1", "minimum or transition"),
        "value": ("", "where it is along the curve"),
        "error": ("1", "estimated relative error of value"),
        "unit": ("1", "unit of value"),
        "friction": ("1", "friction coefficient there"),
    }

    name: str
    value: float
    friction: float
    solution: Any = field(default=None, repr=False)
    error: float = math.nan
    over: str = field(default="speed", repr=False)
    unit: str = field(default="1", repr=False)

    def __getattr__(self, name: str) -> float:
        """Return the value by the name of what the curve runs over."""
        if name in GROUPS and name == vars(self).get("over"):
            return self.value
        raise AttributeError(f"a landmark over {vars(self).get('over')} has no attribute {name!r}")
