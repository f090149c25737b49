"""What errors of the inputs leave open along a Stribeck curve: the interval of the friction at each speed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.quantities.units import InputError
from stribeck.solver.solve import SolveError
from stribeck.uncertainty.propagate import propagate

__all__ = ["Band", "friction_band"]

SPEEDS = {"line": 13, "point": 7}
"""At how many speeds errors are propagated, by geometry: between them the ends of intervals are smooth in the logarithm."""


@dataclass(frozen=True, eq=False)
class Band:
    """The 95 % interval of the friction along the speed.

    Attributes
    ----------
    speed : ndarray, shape (n,)
        Speeds at which errors were propagated [m/s].
    low, high : ndarray, shape (n,)
        Ends of the interval over the friction for the inputs as given [-].
    """

    speed: Array
    low: Array
    high: Array

    def along(self, speed: Array, friction: Array) -> tuple[Array, Array]:
        """Return the ends of the interval of friction along other speeds.

        Parameters
        ----------
        speed : ndarray, shape (m,)
            Speeds [m/s].
        friction : ndarray, shape (m,)
            Size of the friction there [-].

        Returns
        -------
        ndarray, ndarray
            Low and high ends; nan beyond the speeds of the band.
        """
        at, known = np.log(speed), np.log(self.speed)
        low, high = (friction * np.interp(at, known, part, left=np.nan, right=np.nan) for part in (self.low, self.high))
        return low, high


def friction_band(
    contact: Contact,
    errors: Mapping[str, Any],
    ends: Sequence[float] | Array,
    definition: Definition = "balanced",
    *,
    on_point: Callable[[int, int], object] | None = None,
) -> Band | None:
    """Return the 95 % interval of the friction between two speeds, as :func:`stribeck.propagate` finds it.

    Parameters
    ----------
    contact : Contact
        The contact.
    errors : mapping
        Standard errors of inputs, as for :func:`stribeck.propagate`.
    ends : sequence of float
        Lowest and highest speed [m/s].
    definition : {"balanced", "published"}
        Definition of the viscous friction.
    on_point : callable, optional
        Is called after each speed with their number and that of all; an exception that it raises ends the work.

    Returns
    -------
    Band or None
        The band over the speeds whose states can be solved; None if there are fewer than two.
    """
    count = SPEEDS[contact.groups.geometry]
    found = []
    for i, speed in enumerate(np.geomspace(ends[0], ends[1], count).tolist()):
        try:
            spread = propagate(contact.replace(speed=speed), errors, definition=definition, transitions=False)["friction"]
        except (InputError, SolveError):
            continue
        finally:
            if on_point is not None:
                on_point(i + 1, count)
        if spread.value != 0:
            low, high = sorted(end / spread.value for end in spread.interval_95)
            found.append((speed, max(low, 0.0), high))
    return Band(*np.array(found).T) if len(found) > 1 else None
