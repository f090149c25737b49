"""A liquid under given conditions, and how temperatures are given."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated, Any

from stribeck.fluids.description import Fluid
from stribeck.quantities.docstrings import Described
from stribeck.quantities.formats import format_si
from stribeck.quantities.units import InputError, show, to_si

_TEMPERATURE = re.compile(r"\s*([+-]?[0-9]+(?:\.[0-9]*)?)\s*(degC|°C|deg C|C|K)\s*")


@dataclass(frozen=True)
class Liquid(Described):
    """A liquid under given conditions.

    Examples
    --------
    >>> import stribeck as sb
    >>> liquid = sb.fluids.glycerol_water(0.5, temperature="20 degC")
    >>> round(1e3 * liquid.viscosity, 1)  # mPa s
    6.0
    """

    name: Annotated[str, "what it is, with its conditions"]
    viscosity: Annotated[float, "viscosity at ambient pressure and low rate", "Pa s"]
    fluid: Annotated[Fluid, "how it depends on pressure and shear rate"]
    source: Annotated[str, "where the numbers are from"]
    thinning_rate: Annotated[
        float | None,
        "shear rate at which it begins to thin, where known of one without a law of thinning",
        "1/s",
    ] = None

    @property
    def inputs(self) -> dict[str, Any]:
        """The arguments ``viscosity`` and ``fluid`` of a contact."""
        return {"viscosity": self.viscosity, "fluid": self.fluid}

    def __str__(self) -> str:
        """Return name, viscosity, laws and source in one line."""
        return f"{self.name}: {format_si(self.viscosity, 'viscosity')}, {self.fluid.name} ({self.source})"


def celsius(temperature: str | float) -> float:
    """Return a temperature in degrees Celsius, given so as a number or as text in degC or K."""
    if isinstance(temperature, str):
        found = _TEMPERATURE.fullmatch(temperature.replace("\N{MINUS SIGN}", "-"))
        if found is None:
            raise InputError(f"temperature = {show(temperature)}; write it as '25 degC' or '298 K'.")
        return float(found[1]) - (273.15 if found[2] == "K" else 0.0)
    return to_si(temperature, "number", "temperature", "25")


def check_temperature(T: float, low: float, high: float) -> float:
    """Return a temperature, refused where a formula does not hold [degC]."""
    if not low <= T <= high:
        raise InputError(f"temperature = {T:g} degC must lie between {low:g} and {high:g} degC, where the formula holds.")
    return T
