"""The table ``[stroke]`` of a case: a motion by its name with its numbers, and how it is solved."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck.cases.tables import AS_GIVEN, Key, Keys, one_of, whole
from stribeck.motions.motion import Motion
from stribeck.quantities.registry import laws_of
from stribeck.quantities.schema import arguments_of, made_of
from stribeck.quantities.units import InputError

MOTIONS = laws_of("stribeck.motions", Motion)  # Those that a case may name

# Keys beside those of the motion; that both go together is seen when the stroke is solved.
SOLVING: Keys = {
    "cycles": Key(whole(1, 100_000)),
    "steps": Key(whole(1, 100_000)),
    "inlet": Key(one_of("flooded", "own-wake")),
}

KEYS: Keys = {
    "motion": AS_GIVEN,
    **{key: AS_GIVEN for motion in MOTIONS.values() for key in arguments_of(motion)},
    **SOLVING,
}


@dataclass(frozen=True)
class StrokeSettings:
    """The ``[stroke]`` table of a case."""

    motion: Motion  # Sliding speed over time
    cycles: int | None = None  # Times that it is done; None is the default of :func:`stribeck.stroke`
    steps: int | None = None  # Steps of a cycle; None is the default of :func:`stribeck.stroke`
    inlet: str | None = None  # What is before the contact; None is the default of :func:`stribeck.stroke`

    @property
    def arguments(self) -> dict[str, Any]:
        """What :func:`stribeck.stroke` is given."""
        return {name: value for name, value in vars(self).items() if value is not None}

    @property
    def facts(self) -> dict[str, float]:
        """What checks know of it, in SI units: the length from end to end."""
        return {"stroke": float(np.ptp(self.motion.position(self.motion.times(self.steps or 400))))}


def stroke_settings(table: dict[str, Any]) -> StrokeSettings:
    """Return the settings of a table that was read."""
    if "motion" not in table:
        raise InputError(f"motion is missing; add motion = {' or '.join(map(json.dumps, MOTIONS))}.")
    name = one_of(*MOTIONS)("motion", table["motion"])
    solving = {key: value for key, value in table.items() if key in SOLVING}
    given = {key: value for key, value in table.items() if key not in (*SOLVING, "motion")}
    return StrokeSettings(made_of(MOTIONS[name], f"motion = {name!r}", given), **solving)
