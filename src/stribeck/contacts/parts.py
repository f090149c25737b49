"""What a contact has beside its inputs: fluid, cavitation, flow factors, solid, friction of asperities and motion.

The numbers of laws are in SI units with a contact and in Hertz units with groups.
"""

import inspect
import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, NamedTuple

from stribeck.asperity_friction.law import AsperityFriction
from stribeck.contacts.groups import BASE_MODEL, Model
from stribeck.fluids.description import Fluid, as_flow_factors, as_fluid
from stribeck.fluids.fluid import Cavitation
from stribeck.fluids.laws import DensityLaw, FilmUnits, FlowFactors, RateLaw, ViscosityLaw
from stribeck.profiles.profile import Profile, Undeformed, as_profile, undeformed
from stribeck.profiles.shapes import Shape
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.registry import laws_of
from stribeck.quantities.schema import Input, numbers_of
from stribeck.quantities.units import InputError, checked_word, listed, show
from stribeck.solids.half_plane import HalfPlane, as_solid
from stribeck.solids.solid import Solid

PURE_SLIDING = 2.0  # Slide-to-roll ratio with one surface at rest
MAX_SLIDE_TO_ROLL = 100.0  # Largest slide-to-roll ratio: surfaces that move against each other entrain hardly any fluid

# Smallest suction of a cavity that is not at ambient pressure: its film reforms some 1e8 half-widths away [p_Hz]
MIN_SUCTION = 1e-20


@dataclass(frozen=True, init=False, kw_only=True)
class Parts:
    r"""Fluid, cavitation, flow factors, solid, profile, friction of asperities and motion of a contact."""

    fluid: Fluid  # The fluid; Newtonian, of constant viscosity and density, without it
    cavitation: Cavitation  # How the film ends behind the contact
    cavity_pressure: Input = Input(
        label="cavity pressure, gauge",
        dimension="pressure",
        typical="-101 kPa",
        letters=("pressure",),
        lowest=-math.inf,
        highest=0.0,
        reason="it is measured from the ambient pressure, so that -0.1 MPa is vacuum",
        optional=True,
        default=0.0,
    )
    flow_factors: FlowFactors | None  # What roughness does to the flow
    solid: Solid | None  # The soft body; a half-space without it
    profile: Profile | None  # The shape of the rigid body; a cylinder without it
    asperity_friction: AsperityFriction | None  # Friction of asperities; the coefficient boundary_friction without it
    slide_to_roll: Input = Input(
        label="slide-to-roll ratio",
        symbol="$S$",
        dimension="number",
        typical="0.5",
        source="2 (u1 - u2)/(u1 + u2); 2 where one surface is at rest",
        usual=(0.01, 2.0),
        letters=("srr", "SRR", "slide_roll_ratio"),
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
        cavitation: str | Cavitation | None = None,
        cavity_pressure: str | float | None = 0.0,
        flow_factors: Any = None,
        solid: Solid | None = None,
        profile: Profile | None = None,
        asperity_friction: AsperityFriction | None = None,
        slide_to_roll: float | None = PURE_SLIDING,
    ) -> None:
        values = {
            "fluid": as_fluid(fluid),
            "cavitation": _cavitation(cavitation, profile),
            "cavity_pressure": cavity_pressure,
            "flow_factors": as_flow_factors(flow_factors),
            "solid": None if solid is None else as_solid("solid", solid),
            "profile": None if profile is None else as_profile(profile),
            "asperity_friction": _asperity_friction(asperity_friction),
            "slide_to_roll": slide_to_roll,
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)
        if self.cavity_pressure < 0 and self.cavitation != "reform":
            raise InputError(
                f"cavity_pressure = {show(cavity_pressure)} needs cavitation = 'reform': a full film has no cavity, and one "
                "that ends at the exit does so at the ambient pressure. Give cavitation = 'reform', or cavity_pressure = 0."
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

    def model_in(self, units: FilmUnits, length: float = 1.0, speed: float | None = None, origin: float = 0.0) -> Model:
        """Return the model in Hertz units."""
        if not self.own_parts.keys() - WITHOUT_MODEL:
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
        profile: Undeformed = Undeformed() if self.profile is None else undeformed(self.profile, origin, length, units.gap)
        return Model(film, self.cavitation, solid, self.cavity_pressure / units.pressure, profile)


def _asperity_friction(given: Any) -> AsperityFriction | None:
    """Return the friction of asperities that is given, or refuse what is none; None stands for a coefficient."""
    if given is None or isinstance(given, AsperityFriction):
        return given
    raise InputError(
        f"asperity_friction = {show(given)}; give one of stribeck.asperity_friction such as ShearStress('0.2 MPa'), or "
        "boundary_friction, a coefficient, in its place."
    )


def _cavitation(given: Any, profile: Any) -> Cavitation:
    """Return how the film ends: where that is not given, at the exit of a shape that is no cylinder."""
    if given is None and profile is not None:
        return Cavitation(getattr(profile, "cavitation", Cavitation.EXIT))
    return Cavitation(checked_word("cavitation", Cavitation.NONE if given is None else given, Cavitation))


def part_parameters(without: Collection[str]) -> list[inspect.Parameter]:
    """Return the parts as arguments of a contact, but for those that are among its inputs."""
    parts = list(inspect.signature(Parts.__init__).parameters.values())[1:]
    keyword, empty = inspect.Parameter.KEYWORD_ONLY, inspect.Parameter.empty
    return [each.replace(kind=keyword, annotation=empty) for each in parts if each.name not in without]


PART_KEYWORDS = tuple(field.name for field in fields(Parts))  # The keywords of contacts and solvers that are parts

WITHOUT_MODEL = frozenset({"asperity_friction"})  # Parts that change no field: the model does not know them

BASE_PARTS = Parts()  # Parts of the article's model


class Kind(NamedTuple):
    """A kind of law that is a part of a contact, or of its fluid."""

    table: str  # Table of a case file
    key: str  # Key in this table that names the law
    label: str  # What is chosen
    nothing: str  # Name of what does nothing
    package: str  # Where the laws are
    base: type  # Class of which the laws are

    @property
    def laws(self) -> dict[str, Any]:
        """The laws by name; None for the one that does nothing."""
        return {self.nothing: None, **laws_of(self.package, self.base)}


# Name of the argument of the fluid, or of the contact -> its kind.
KINDS = {
    "rheology": Kind("fluid", "model", "Fluid", "newtonian", "stribeck.fluids.rheology", RateLaw),
    "viscosity": Kind(
        "fluid", "viscosity_law", "Viscosity under pressure", "constant", "stribeck.fluids.rheology", ViscosityLaw
    ),
    "density": Kind("fluid", "density", "Density", "incompressible", "stribeck.fluids.rheology", DensityLaw),
    "flow_factors": Kind("flow_factors", "model", "Flow factors", "none", "stribeck.fluids", FlowFactors),
    "solid": Kind("solid", "model", "Soft body", "half-space", "stribeck.solids", Solid),
    "profile": Kind("profile", "shape", "Shape of the body", "cylinder", "stribeck.profiles", Shape),
    "asperity_friction": Kind(
        "asperity_friction", "model", "Friction of asperities", "coulomb", "stribeck.asperity_friction", AsperityFriction
    ),
}


def _numbers() -> Iterator[Input]:
    """Yield the numbers of laws, each with the table and the laws that have it, and those of motion."""
    for kind in KINDS.values():
        found: dict[str, tuple[Input, list[str]]] = {}
        for name, law in kind.laws.items():
            for row in numbers_of(law).values():
                found.setdefault(row.name, (row, []))[1].append(name)
        for row, names in found.values():
            of = f"[{kind.table}] with {kind.key} = {listed(map(repr, names), 'or')}"
            yield replace(row, table=kind.table, of=of)
    yield from numbers_of(Parts).values()


LAW_NUMBERS = {row.name: row for row in _numbers()}  # All numbers of laws and of motion by name

PART_INPUTS = {name: row for name, row in LAW_NUMBERS.items() if row.table and row.is_free}  # Those that a fit may free


def part_names(contact: Any) -> tuple[str, ...]:
    """Return the names of the numbers of laws that a contact has and that are not zero."""
    return tuple(name for name in PART_INPUTS if getattr(contact, name, None))


def part_value(parts: Any, name: str) -> float | None:
    """Return a number of the parts of a contact in SI units; None where they have none of this name."""
    if not is_dataclass(parts):
        return None
    if name in numbers_of(type(parts)):
        return float(getattr(parts, name))
    inner = (getattr(parts, each.name) for each in fields(parts) if each.name not in numbers_of(type(parts)))
    return next((value for each in inner if (value := part_value(each, name)) is not None), None)


def with_part_value(parts: Any, name: str, value: str | float) -> Any:
    """Return the parts with another number of one of their laws."""
    if part_value(parts, name) is None:
        of = PART_INPUTS[name].of
        raise InputError(f"{name} = {show(value)}, but this contact has none: it belongs to {of}; give it to the contact.")
    return _replace_number(parts, name, value)


def _replace_number(part: Any, name: str, value: str | float) -> Any:
    """Return a frozen dataclass with another number of its own, or of one of its fields."""
    if name in numbers_of(type(part)):
        return replace(part, **{name: value})
    inner = next(each.name for each in fields(part) if part_value(getattr(part, each.name), name) is not None)
    return replace(part, **{inner: _replace_number(getattr(part, inner), name, value)})
