"""The regime of a contact and the way to the next ones in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator

from stribeck.contacts.friction import Definition
from stribeck.quantities.formats import format_factor, format_share, format_si
from stribeck.quantities.inputs import INPUT_TABLES, InputTable
from stribeck.regimes.margin_scan import Crossing, Margin
from stribeck.regimes.margins import RegimeMargins
from stribeck.solver.base_solution import BaseSolution, regime_of_state

__all__ = ["regime_sentence", "ways_to"]


def regime_sentence(solution: BaseSolution, definition: Definition) -> str:
    """Return the sentence on the regime of a contact, its friction and what carries the load."""
    assert solution.contact is not None
    friction = solution.friction(definition=definition)
    return (
        f"{regime_of_state(solution, definition).capitalize()} lubrication at {format_si(solution.contact.speed, 'speed')}: "
        f"friction {friction.total:.4g} ({format_share(friction.contact_share, friction.relative_error)} from asperities); "
        f"the fluid carries {format_share(solution.fluid_load_share, solution.errors['fluid_load_share'])} of the load."
    )


def ways_to(margins: RegimeMargins) -> Iterator[str]:
    """Yield a sentence for each regime that is near: what it takes of each input, and what leads nowhere."""
    table = INPUT_TABLES[margins.geometry]
    for regime in margins.targets:
        found = [(margin, margin.crossing_into(regime)) for margin in margins.margins]
        ways = [f"{margin.name} {_step(margin.name, mark, table)}" for margin, mark in found if mark is not None]
        barren = [_searched(margin, table) for margin, mark in found if mark is None and not margins.is_beyond(regime, margin)]
        if not ways:
            yield f"To reach {regime} lubrication: not reachable by changing {', '.join(barren)}."
            continue
        rest = f"; not reachable by changing {', '.join(barren)}" if barren else ""
        yield f"To reach {regime} lubrication: {', or '.join(ways)}{rest}.{f' {margins.counted}' if margins.counted else ''}"
    if any(margin.name == "viscosity" and (margin.less or margin.more) for margin in margins.margins):
        yield "Only the product of speed and viscosity matters, so their factors are equal."


def _step(name: str, mark: Crossing, table: InputTable) -> str:
    """Return how far an input is to be changed, as ``x 3.1 (0.31 m/s)``."""
    if mark.value == 0:
        return "to any value above zero"
    value = format_si(mark.value, table.quantities[name].dimension, 4)
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
