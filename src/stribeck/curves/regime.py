"""The places of a curve by name, its transitions and minimum, and where states come from: solved, or read off the atlas."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Annotated, Any, Literal

from stribeck._types import Array
from stribeck.contacts.friction import BOUNDARY_FLUID_SHARE, HYDRODYNAMIC_CONTACT_SHARE, Regime
from stribeck.files.results import Record
from stribeck.quantities.outputs import GROUPS
from stribeck.quantities.units import InputError, show


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


Method = Literal["solver", "atlas"]  # Where states come from: solved, or read off :mod:`stribeck.atlas`


class Transition(StrEnum):
    """The named places of a curve; the values are their names in outputs."""

    BOUNDARY_END = f"fluid carries {100 * BOUNDARY_FLUID_SHARE:.0f} % of the load"
    EQUAL_SHARES = "fluid carries 50 % of the load"
    HYDRODYNAMIC_START = f"asperities cause {100 * HYDRODYNAMIC_CONTACT_SHARE:.0f} % of the friction"
    MINIMUM = "minimum of friction"

    @classmethod
    def _missing_(cls, value: object) -> Transition | None:
        """Return the place whose short name this is, as ``"minimum"``, or whose name before percents had a space."""
        if not isinstance(value, str):
            return None
        return next((one for one in cls if value.lower() in (one.name.lower(), one.value.replace(" %", "%"))), None)


def check_transition(name: str) -> Transition:
    """Return the transition of this name, short or as in outputs."""
    try:
        return Transition(name)
    except ValueError:
        known = ", ".join(repr(one.name.lower()) for one in Transition)
        raise InputError(f"name = {show(name)}; a curve is asked for one of {known}.") from None


def ranges_of(
    values: Array, regimes: Sequence[Regime], transitions: Iterable[Landmark]
) -> tuple[tuple[Regime, float, float], ...]:
    """Return the regimes of points along a curve, ascending, with their ends: located transitions, else halfway."""
    edges = [float(values[0])]
    names = [regimes[0]]
    marks = {mark.name: mark.value for mark in transitions}
    ends = {"boundary": Transition.BOUNDARY_END, "hydrodynamic": Transition.HYDRODYNAMIC_START}
    for i in range(1, len(values)):
        if regimes[i] != names[-1]:
            low, high = float(values[i - 1]), float(values[i])
            located = {name: marks.get(ends[name], low) for name in (names[-1], regimes[i]) if name in ends}
            inside = [value for value in located.values() if low < value < high]
            if len(inside) == 2 and inside[0] < inside[1]:
                names.append("mixed")
            elif len(inside) == 2:  # where asperities hardly rub the film is hydrodynamic before it bears load
                inside = [located["hydrodynamic"]]
            edges += inside or [math.sqrt(low * high)]
            names.append(regimes[i])
    return tuple(zip(names, edges, [*edges[1:], float(values[-1])], strict=True))
