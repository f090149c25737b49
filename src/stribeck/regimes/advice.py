"""What a designer is told: the regime of a contact, the way to the next ones, and the inputs that lower its friction."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, Friction, regime_of
from stribeck.contacts.geometries import INPUT_TABLES, LINE
from stribeck.contacts.inputs import InputTable, follows_surface
from stribeck.files.results import Record
from stribeck.quantities.formats import format_factor, format_number, format_share, format_si
from stribeck.quantities.units import InputError
from stribeck.solver.base_solution import BaseSolution
from stribeck.solver.solve import solve
from stribeck.solver.solve_error import SolveError


def regime_sentence(solution: BaseSolution, friction: Friction) -> str:
    """Return the sentence on the regime of a state, its friction and what carries the load."""
    regime = regime_of(solution.fluid_load_share, friction.contact_share)
    at = "" if solution.contact is None else f" at {format_si(solution.contact.speed, 'speed')}"
    return (
        f"{regime.capitalize()} lubrication{at}: "
        f"friction {friction.total:.4g} ({format_share(friction.contact_share, friction.relative_error)} from asperities); "
        f"the fluid carries {format_share(solution.fluid_load_share, solution.errors['fluid_load_share'])} of the load."
    )


def answer_sentence(solution: BaseSolution, friction: Friction) -> str:
    """Return that sentence with the film over the roughness, the first of an answer."""
    film = solution.lambda_ratio
    roughness = "the rms roughness" if solution.contact is not None else "h_rms/alpha"
    said = f" The minimum film is {format_number(film, 1e-3)} times {roughness}." if math.isfinite(film) else ""
    return f"{regime_sentence(solution, friction)}{said}"


def ways_to(margins: Any) -> Iterator[str]:
    """Yield a sentence for each regime that is near: what it takes of each input, and what leads nowhere."""
    table = INPUT_TABLES[margins.geometry]
    for regime in margins.targets:
        found = [(margin, margin.crossing_into(regime)) for margin in margins.margins]
        marks = [(margin.name, mark) for margin, mark in found if mark is not None]
        ways = [f"{name} {step_text(mark, table.quantities[name].dimension)}" for name, mark in marks]
        barren = [_searched(margin, table) for margin, mark in found if mark is None and not margins.is_beyond(regime, margin)]
        if not ways:
            yield f"To reach {regime} lubrication: not reachable by changing {', '.join(barren)}."
            continue
        rest = f"; not reachable by changing {', '.join(barren)}" if barren else ""
        yield f"To reach {regime} lubrication: {', or '.join(ways)}{rest}.{f' {margins.counted}' if margins.counted else ''}"
    if any(margin.name == "viscosity" and (margin.less or margin.more) for margin in margins.margins):
        yield "Only the product of speed and viscosity matters, so their factors are equal."


def step_text(mark: Any, dimension: str, digits: int = 4) -> str:
    """Return how far an input is to be changed, as ``x 3.1 (to 0.31 m/s)``."""
    if mark.value == 0:
        return "to any value above zero"
    value = format_si(mark.value, dimension, digits)
    if math.isinf(mark.factor):
        return f"from zero to {value}"
    larger = mark.factor >= 1
    ends = () if mark.interval_95 is None else mark.interval_95
    low, high = (0.0, 0.0) if not ends else sorted(ends if larger else (1 / end for end in ends))
    interval = f"; 95 %: {format_factor(low)} to {format_factor(high)}" if ends else ""
    return f"{'x' if larger else '/'} {format_factor(mark.factor if larger else 1 / mark.factor)} (to {value}{interval})"


def _searched(margin: Any, table: InputTable) -> str:
    low, high = margin.searched
    if low == high:  # it cannot lead anywhere, and a note says why
        return str(margin.name)
    ends = (format_si(value, table.quantities[margin.name].dimension) for value in (low, high))
    return f"{margin.name} (range searched {' to '.join(ends)})"


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
    slopes |= {name: slopes[name] + sensitivities.get("beta", 0.0) for name in slopes if follows_surface(contact, {name})}
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
