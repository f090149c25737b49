"""The regime of a contact and the way to the next ones in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from stribeck.contacts.friction import Friction
from stribeck.contacts.geometries import INPUT_TABLES
from stribeck.contacts.inputs import InputTable
from stribeck.contacts.regime import regime_of
from stribeck.quantities.formats import format_factor, format_number, format_share, format_si
from stribeck.solver.base_solution import BaseSolution

if TYPE_CHECKING:
    from stribeck.regimes.margin_scan import Crossing, Margin
    from stribeck.regimes.margins import RegimeMargins


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


def ways_to(margins: RegimeMargins) -> Iterator[str]:
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


def step_text(mark: Crossing, dimension: str, digits: int = 4) -> str:
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


def _searched(margin: Margin, table: InputTable) -> str:
    low, high = margin.searched
    if low == high:  # it cannot lead anywhere, and a note says why
        return margin.name
    ends = (format_si(value, table.quantities[margin.name].dimension) for value in (low, high))
    return f"{margin.name} (range searched {' to '.join(ends)})"
