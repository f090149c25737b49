"""What a contact has beside its inputs: fluid, cavitation, flow factors, solid and motion, as users give them.

The numbers of laws are in SI units with a contact and in Hertz units with groups; :meth:`Parts.model_in` makes them the model
that the equations see.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Collection
from dataclasses import dataclass, fields
from typing import Any

from stribeck.contacts.model import BASE_MODEL, Model
from stribeck.fluids.cavitation import Cavitation
from stribeck.fluids.description import Fluid, as_flow_factors, as_fluid
from stribeck.fluids.laws import FilmUnits, FlowFactors
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.schema import Input
from stribeck.quantities.units import InputError, checked_word, show
from stribeck.solids.half_plane import HalfPlane, as_solid
from stribeck.solids.solid import Solid

__all__ = ["BASE_PARTS", "PART_KEYWORDS", "PURE_SLIDING", "Parts", "part_parameters"]

PURE_SLIDING = 2.0  # Slide-to-roll ratio with one surface at rest
MAX_SLIDE_TO_ROLL = 100.0  # Largest slide-to-roll ratio: surfaces that move against each other entrain hardly any fluid

# Smallest suction of a cavity that is not at ambient pressure: its film reforms some 1e8 half-widths away [p_Hz]
MIN_SUCTION = 1e-20


@dataclass(frozen=True, init=False, kw_only=True)
class Parts:
    r"""Fluid, cavitation, flow factors, solid and motion of a contact."""

    fluid: Fluid  # The fluid; Newtonian, of constant viscosity and density, without it
    cavitation: Cavitation  # How the film ends behind the contact
    cavity_pressure: Input = Input(
        label="cavity pressure, gauge",
        dimension="pressure",
        typical="-101 kPa",
        lowest=-math.inf,
        highest=0.0,
        reason="it is measured from the ambient pressure, so that -0.1 MPa is vacuum",
        optional=True,
        default=0.0,
    )
    flow_factors: FlowFactors | None  # What roughness does to the flow
    solid: Solid | None  # The soft body; a half-space without it
    slide_to_roll: Input = Input(
        label="slide-to-roll ratio",
        dimension="number",
        typical="0.5",
        lowest=-MAX_SLIDE_TO_ROLL,
        zero=True,
        highest=MAX_SLIDE_TO_ROLL,
        reason="2 is pure sliding, 0 pure rolling",
        optional=True,
        default=PURE_SLIDING,
    )

    def __init__(
        self,
        fluid: Any = None,
        cavitation: str | Cavitation | None = Cavitation.NONE,
        cavity_pressure: str | float | None = 0.0,
        flow_factors: Any = None,
        solid: Solid | None = None,
        slide_to_roll: float | None = PURE_SLIDING,
    ) -> None:
        values = {
            "fluid": as_fluid(fluid),
            "cavitation": Cavitation(checked_word("cavitation", "none" if cavitation is None else cavitation, Cavitation)),
            "cavity_pressure": cavity_pressure,
            "flow_factors": as_flow_factors(flow_factors),
            "solid": None if solid is None else as_solid("solid", solid),
            "slide_to_roll": slide_to_roll,
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)
        if self.cavity_pressure < 0 and self.cavitation != "reform":
            raise InputError(
                f"cavity_pressure = {show(cavity_pressure)} needs cavitation = 'reform': a film that ends at the exit does so "
                "at the ambient pressure."
            )

    def part_values(self) -> dict[str, Any]:
        """Return the parts by name: keywords that make them again."""
        return {name: getattr(self, name) for name in PART_KEYWORDS}

    @cached_property
    def own_parts(self) -> dict[str, Any]:
        """Those that are not the article's."""
        usual = BASE_PARTS.part_values()
        return {name: value for name, value in self.part_values().items() if value is not usual[name] and value != usual[name]}

    @property
    def slide(self) -> float:
        """Half the slide-to-roll ratio, ``s = (u1 - u2)/(u1 + u2)``."""
        return 0.5 * self.slide_to_roll

    def model_in(self, units: FilmUnits, length: float = 1.0, speed: float | None = None) -> Model:
        """Return the model in Hertz units."""
        if not self.own_parts:
            return BASE_MODEL
        if self.solid is not None and self.slide < -1 and getattr(self.solid, "uses_speed", False):
            raise InputError(
                f"slide_to_roll = {self.slide_to_roll:g} on a {self.solid.name}: below -2 the substrate moves against the "
                "flow, and its memory with it; give -2 or more, or an elastic solid."
            )
        if 0 < -self.cavity_pressure < MIN_SUCTION * units.pressure:
            unit, highest = "p_Hz" if units.pressure == 1.0 else "Pa", -MIN_SUCTION * units.pressure
            raise InputError(
                f"cavity_pressure = {self.cavity_pressure:g} {unit} is the ambient pressure but for rounding: the film would "
                f"re-form 1e8 half-widths behind the contact; give 0, or {highest:.3g} {unit} or less."
            )
        film = self.fluid.at(units, self.slide, self.flow_factors)
        of_substrate = 1.0 if speed is None else 0.5 * (1 + self.slide) * speed
        solid: Solid = HalfPlane() if self.solid is None else self.solid.scaled(length, of_substrate)
        return Model(film, self.cavitation, solid, self.cavity_pressure / units.pressure)


def part_parameters(without: Collection[str]) -> list[inspect.Parameter]:
    """Return the parts as arguments of a contact, but for those that are among its inputs."""
    parts = list(inspect.signature(Parts.__init__).parameters.values())[1:]
    keyword, empty = inspect.Parameter.KEYWORD_ONLY, inspect.Parameter.empty
    return [each.replace(kind=keyword, annotation=empty) for each in parts if each.name not in without]


PART_KEYWORDS = tuple(field.name for field in fields(Parts))  # The keywords of contacts and solvers that are parts

BASE_PARTS = Parts()  # Parts of the article's model
