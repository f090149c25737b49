"""A landmark of a curve: its minimum, or a transition between regimes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated, Any

from stribeck.files.results import Record
from stribeck.quantities.outputs import GROUPS

__all__ = ["Landmark"]


@dataclass(frozen=True)
class Landmark(Record):
    """A characteristic point of a curve: its position and the solution there.

    ``value``, a group [-] or SI of a contact, has also the name of what the curve runs over, as ``curve.minimum.speed``.
    """

    name: Annotated[str, "minimum or transition", "1"]
    value: Annotated[float, "where it is along the curve", ""]
    friction: Annotated[float, "friction coefficient there", "1"]
    solution: Annotated[Any, "the state; None off the atlas"] = field(default=None, repr=False)
    error: Annotated[float, "estimated relative error of value", "1"] = math.nan
    over: Annotated[str, "what the curve runs over"] = field(default="speed", repr=False)
    unit: Annotated[str, "unit of value", "1"] = field(default="1", repr=False)

    def __getattr__(self, name: str) -> float:
        """Return the value by the name of what the curve runs over."""
        if name in GROUPS and name == vars(self).get("over"):
            return self.value
        raise AttributeError(f"a landmark over {vars(self).get('over')} has no attribute {name!r}")
