"""What errors of the inputs leave open along a Stribeck curve: the interval of the friction at each of its points."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.curves.coordinate import Over
from stribeck.quantities.units import InputError
from stribeck.solver.solve_error import SolveError
from stribeck.uncertainty.propagate import propagate

__all__ = ["Band", "friction_band"]

# Points at which errors are propagated, by geometry: between them the ends of intervals are smooth in the logarithm
BAND_POINTS = {"line": 13, "point": 7}


@dataclass(frozen=True, eq=False)
class Band:
    """The 95 % interval of the friction along a curve."""

    values: Array  # Speeds, loads or roughnesses at which errors were propagated, in SI units
    low: Array  # Lower end of the interval over the friction for the inputs as given [-]
    high: Array  # Upper end of the same

    def along(self, values: Array, friction: Array) -> tuple[Array, Array]:
        """Return the ends of the interval of friction at other places."""
        at, known = np.log(values), np.log(self.values)
        low, high = (friction * np.interp(at, known, part, left=np.nan, right=np.nan) for part in (self.low, self.high))
        return low, high


def friction_band(
    contact: Contact,
    errors: Mapping[str, Any],
    ends: Sequence[float] | Array,
    definition: Definition = "balanced",
    over: Over = "speed",
    *,
    on_point: Callable[[int, int], object] | None = None,
) -> Band | None:
    """Return the 95 % interval of friction between two speeds, loads or roughnesses, as ``propagate`` has it."""
    count = BAND_POINTS[contact.groups.geometry]
    found = []
    for i, value in enumerate(np.geomspace(ends[0], ends[1], count).tolist()):
        try:
            spread = propagate(contact.replace(**{over: value}), errors, definition=definition, transitions=False)["friction"]
        except (InputError, SolveError):
            continue
        finally:
            if on_point is not None:
                on_point(i + 1, count)
        if spread.value != 0:
            low, high = sorted(end / spread.value for end in spread.interval_95)
            found.append((value, max(low, 0.0), high))
    return Band(*np.array(found).T) if len(found) > 1 else None
