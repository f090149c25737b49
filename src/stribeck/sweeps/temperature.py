"""Temperature as an axis of a sweep: the viscosity of the liquid of ``[fluid]`` follows it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.fluids.description import celsius
from stribeck.fluids.presets import PRESETS
from stribeck.quantities.schema import Input
from stribeck.quantities.units import InputError

NAME = "temperature"


@dataclass(frozen=True, kw_only=True)
class Temperature(Input):
    """A temperature, which has no SI unit to multiply with and no logarithm."""

    @property
    def unit(self) -> str:
        """Its unit in files."""
        return "degC"

    def checked(self, value: Any) -> float:
        """Return a temperature in degrees Celsius."""
        return celsius(value)


TEMPERATURE = Temperature(name=NAME, label="temperature of the liquid", dimension="number", typical="25")


def check_temperature_axis(tables: Mapping[str, Any], vary: Mapping[str, Any]) -> None:
    """Refuse temperature as an axis without a liquid that knows it, or beside what follows from it."""
    fluid = tables.get("fluid")
    named = fluid.get("preset") if isinstance(fluid, dict) else None
    known = [name for name, preset in PRESETS.items() if NAME in preset.conditions]
    if named not in known:
        raise InputError(
            f"{NAME} varies with a liquid that knows it alone; add [fluid] preset = {' or '.join(map(repr, known))}."
        )
    if "viscosity" in vary:
        raise InputError(f"viscosity follows from {NAME}; leave one of them out.")
    if isinstance(fluid, dict) and NAME in fluid:
        raise InputError(f"{NAME} also stands in [fluid]; keep one of them.")


def viscosity_at(fluid: Mapping[str, Any], temperatures: Array) -> Array:
    """Return the viscosity of the liquid of a table at each temperature; the laws of no liquid move with it."""
    conditions = {key: value for key, value in fluid.items() if key != "preset"}
    different, place = np.unique(temperatures, return_inverse=True)
    liquids = [PRESETS[fluid["preset"]](**conditions, temperature=float(value)) for value in different]
    return np.array([each.viscosity for each in liquids])[place]
