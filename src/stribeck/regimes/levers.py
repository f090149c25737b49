"""The inputs by which a designer lowers the friction of a contact: the strongest, and the cheapest to a wanted friction."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.geometries import LINE
from stribeck.contacts.typical_errors import follows_surface
from stribeck.files.results import Record
from stribeck.quantities.formats import format_si
from stribeck.quantities.units import InputError
from stribeck.solver.solve import solve
from stribeck.solver.solve_error import SolveError

DESIGN_INPUTS = tuple(name for name, row in LINE.kept.items() if not row.follows_surface)  # What a designer can change

WANTED_RATIO = 0.8  # Friction that a lever should reach, over the present one
MAX_FACTOR = 100.0  # Largest change of an input by a lever
LEVERS = 2

TWINS = {"speed": "viscosity", "viscosity": "speed"}  # They enter as a product: two names of one lever


@dataclass(frozen=True)
class Lever(Record):
    """One input that lowers friction: its new value, and the friction solved there."""

    name: Annotated[str, "input that lowers friction", "1"]
    label: str
    value: Annotated[float, "its new value", ""]
    factor: Annotated[float, "the new value over the present one", "1"]
    friction: Annotated[float, "friction coefficient solved there", "1"]
    change: Annotated[float, "relative change of the friction", "1"]
    unit: Annotated[str, "SI unit of the value", "1"]
    dimension: str

    @property
    def texts(self) -> tuple[str, str]:
        """What is to be changed, and to what friction."""
        step = f"x {self.factor:.3g}" if self.factor > 1 else f"/ {1 / self.factor:.3g}"
        to = format_si(self.value, self.dimension)
        force = f"; the force {100 * (self.factor * (1 + self.change) - 1):+.0f} %" if self.name == "load" else ""
        return f"{step} (to {to})", f"{self.friction:.3g} ({100 * self.change:+.0f} %{force})"


def strongest_lever(sensitivities: Mapping[str, float]) -> str | None:
    """Return the input to which friction is most sensitive; None if there is none."""
    slopes = {name: abs(slope) for name in DESIGN_INPUTS if (slope := sensitivities.get(name, 0.0)) and not math.isnan(slope)}
    return max(slopes, key=lambda name: slopes[name], default=None)


def cheapest_levers(
    contact: Contact, friction: float, sensitivities: Mapping[str, float], definition: Definition, rtol: float
) -> tuple[Lever, ...]:
    """Return the two inputs that lower friction by a fifth with the smallest change, with the friction that is then solved."""
    slopes = {name: sensitivities[name] for name in DESIGN_INPUTS if sensitivities.get(name)}
    steps = {name: math.log(WANTED_RATIO) / slope for name, slope in slopes.items()}
    near = [name for name, step in steps.items() if abs(step) < math.log(MAX_FACTOR)]
    found: dict[str, Lever] = {}
    for name in sorted(near, key=lambda name: (abs(steps[name]), name)):
        if len(found) == LEVERS or TWINS.get(name) in found:
            continue
        factor, row = math.exp(steps[name]), contact.INPUTS.quantities[name]
        changes = {name: factor * getattr(contact, name)}
        if follows_surface(contact, {name}):
            changes["beta"] = factor * contact.beta
        try:
            after = solve(contact.replace(**changes), rtol=rtol).friction(definition=definition).total
        except (InputError, SolveError):
            continue
        unit = contact.INPUTS.quantities[name].unit
        found[name] = Lever(name, row.label, changes[name], factor, after, after / friction - 1, unit, row.dimension)
    return tuple(found.values())
