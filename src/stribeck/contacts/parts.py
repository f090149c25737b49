"""The parts of a contact beside its numbers: fluid, cavitation, flow factors, solid and motion, as users give them.

The numbers of laws are in SI units with a contact and in Hertz units with groups; :meth:`Parts.model` makes them the model
that the equations see.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Self

from stribeck.contact_laws.law import AsperityLaw
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import PURE_SLIDING
from stribeck.contacts.model import BASE_MODEL, Model
from stribeck.fluids.cavitation import Cavitation
from stribeck.fluids.description import Fluid, as_flow_factors, as_fluid
from stribeck.fluids.laws import FilmUnits, FlowFactors
from stribeck.quantities.part_inputs import PART_INPUTS, PART_LETTERS, part_value, with_part_value
from stribeck.quantities.units import InputError, show, to_si
from stribeck.solids.half_plane import HalfPlane, as_solid
from stribeck.solids.solid import Solid

__all__ = ["BASE_PARTS", "PART_KEYWORDS", "Parts", "WithParts", "signature_with_parts"]

MAX_SLIDE_TO_ROLL = 100.0  # Largest slide-to-roll ratio: surfaces that move against each other entrain hardly any fluid

# Smallest suction of a cavity that is not at ambient pressure: its film reforms some 1e8 half-widths away [p_Hz]
MIN_SUCTION = 1e-20


@dataclass(frozen=True, init=False)
class Parts:
    r"""Fluid, cavitation, flow factors, solid and motion of a contact."""

    fluid: Fluid  # The fluid; Newtonian, of constant viscosity and density, without it
    cavitation: Cavitation  # How the film ends behind the contact
    cavity_pressure: float
    flow_factors: FlowFactors | None  # What roughness does to the flow
    solid: Solid | None  # The soft body; a half-space without it
    slide_to_roll: float

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
            "cavitation": _cavitation(cavitation),
            "cavity_pressure": 0.0
            if cavity_pressure is None
            else to_si(cavity_pressure, "pressure", "cavity_pressure", "-101 kPa"),
            "flow_factors": as_flow_factors(flow_factors),
            "solid": None if solid is None else as_solid("solid", solid),
            "slide_to_roll": PURE_SLIDING if slide_to_roll is None else to_si(slide_to_roll, "number", "slide_to_roll"),
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)
        if self.cavity_pressure > 0:
            raise InputError(
                f"cavity_pressure = {show(cavity_pressure)} must be zero or below: it is measured from the ambient pressure, "
                "so that -0.1 MPa is vacuum."
            )
        if self.cavity_pressure < 0 and self.cavitation != "reform":
            raise InputError(
                f"cavity_pressure = {show(cavity_pressure)} needs cavitation = 'reform': a film that ends at the exit does so "
                "at the ambient pressure."
            )
        if not abs(self.slide_to_roll) <= MAX_SLIDE_TO_ROLL:
            raise InputError(
                f"slide_to_roll = {show(slide_to_roll)} must lie between -{MAX_SLIDE_TO_ROLL:g} and {MAX_SLIDE_TO_ROLL:g}; "
                "2 is pure sliding, 0 pure rolling."
            )

    def items(self) -> dict[str, Any]:
        """Return the parts by name: keywords that make them again."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @property
    def slide(self) -> float:
        """Half the slide-to-roll ratio, ``s = (u1 - u2)/(u1 + u2)``."""
        return 0.5 * self.slide_to_roll

    def model(self, units: FilmUnits, length: float = 1.0, speed: float | None = None) -> Model:
        """Return the model in Hertz units."""
        if self is BASE_PARTS or self == BASE_PARTS:
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
                f"begin anew 1e8 half-widths behind the contact; give 0, or {highest:.3g} {unit} or less."
            )
        film = self.fluid.at(units, self.slide, self.flow_factors)
        of_substrate = 1.0 if speed is None else 0.5 * (1 + self.slide) * speed
        solid: Solid = HalfPlane() if self.solid is None else self.solid.scaled(length, of_substrate)
        return Model(film, self.cavitation, solid, self.cavity_pressure / units.pressure)


class WithParts(Contact):
    """A contact with parts, each by its name."""

    parts: Parts

    def __repr__(self) -> str:
        """Return the inputs, and those parts that are not the article's, as keywords that make it again."""
        shown = {each.name: getattr(self, each.name) for each in fields(self) if each.repr}
        shown |= {name: value for name, value in self.parts.items().items() if value != getattr(BASE_PARTS, name)}
        shown |= {"cavitation": self.cavitation.value} if "cavitation" in shown else {}
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in shown.items())})"

    @property
    def _part_names(self) -> frozenset[str]:
        """The parts that are no inputs of its geometry."""
        return PART_KEYWORDS - set(self.INPUTS.names)

    def _keep(self, law: str | AsperityLaw | None, inputs: Mapping[str, Any]) -> None:
        names = self._part_names
        for name in inputs.keys() & {*PART_INPUTS, *PART_LETTERS}:
            row = PART_INPUTS[PART_LETTERS.get(name, name)]
            raise InputError(
                f"{name} = {show(inputs[name])} is a number of {row.of}; give it to that law of sb.{row.table}s, and the law "
                f"to the contact as {row.table}."
            )
        parts: Parts = inputs.get("parts", BASE_PARTS)
        object.__setattr__(self, "parts", BASE_PARTS)
        super()._keep(law, {name: value for name, value in inputs.items() if name not in names and name != "parts"})
        given = {name: inputs[name] for name in names & inputs.keys()}
        object.__setattr__(self, "parts", Parts(**{**parts.items(), **given}) if given else parts)
        _ = self.groups.model

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some of the inputs changed.

        Parameters
        ----------
        **changes : str or float
            Arguments of the contact, and numbers of its fluid and solid by name, such as ``relaxation_time`` or
            ``layer_thickness``.

        Returns
        -------
        LineContact or PointContact
            The changed contact, of the same kind.

        Raises
        ------
        InputError
            Where a value is impossible, or the fluid or solid has no such number.
        """
        numbers = {name: changes.pop(name) for name in PART_INPUTS if name in changes}
        if numbers:
            parts = Parts(**{**self.parts.items(), **{name: changes.pop(name) for name in self._part_names & changes.keys()}})
            for name, value in numbers.items():
                parts = with_part_value(parts, name, value)
            changes["parts"] = parts
        return super().replace(**changes)

    def __getattr__(self, name: str) -> Any:
        """Return a number of the fluid or the solid by its name, in SI units."""
        found = part_value(self.parts, name) if name in PART_INPUTS else None
        # Of a property that fails Python asks here, and would show none of what failed.
        return object.__getattribute__(self, name) if found is None else found

    @property
    def film_units(self) -> FilmUnits:
        """Scales of the numbers of its fluid."""
        hertz = self.hertz
        return FilmUnits(
            pressure=hertz.pressure,
            time=6 * self.viscosity / hertz.pressure * (hertz.half_width / hertz.indentation),
            gap=hertz.indentation,
            viscosity=self.viscosity,
            decay_length=self.roughness / self.alpha,
            alpha=self.alpha,
        )

    @property
    def fluid(self) -> Fluid:
        """The fluid."""
        return self.parts.fluid

    @property
    def cavitation(self) -> Cavitation:
        """How the film ends behind the contact."""
        return self.parts.cavitation

    @property
    def cavity_pressure(self) -> float:
        """Rupture pressure of a film that reforms, above the ambient one [Pa]."""
        return self.parts.cavity_pressure

    @property
    def flow_factors(self) -> FlowFactors | None:
        """What roughness does to the flow."""
        return self.parts.flow_factors

    @property
    def solid(self) -> Solid | None:
        """The soft body; None is a half-space."""
        return self.parts.solid


def signature_with_parts(signature: inspect.Signature) -> inspect.Signature:
    """Return the signature of a contact with the parts that are no inputs of it as further keywords."""
    parts = [
        each
        for each in list(inspect.signature(Parts.__init__).parameters.values())[1:]
        if each.name not in signature.parameters
    ]
    keywords = [each.replace(kind=inspect.Parameter.KEYWORD_ONLY, annotation=inspect.Parameter.empty) for each in parts]
    return signature.replace(parameters=[*signature.parameters.values(), *keywords])


def _cavitation(value: str | Cavitation | None) -> Cavitation:
    try:
        return Cavitation("none" if value is None else value)
    except ValueError:
        known = ", ".join(repr(str(each)) for each in Cavitation)
        raise InputError(f"cavitation = {show(value)} must be one of {known}.") from None


PART_KEYWORDS = frozenset(field.name for field in fields(Parts))  # The keywords of contacts and solvers that are parts

BASE_PARTS = Parts()  # Parts of the article's model
