"""What a sweep keeps of each state, and the units and meanings of its inputs."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from stribeck.batches.states import Ended, States
from stribeck.contacts.geometries import INPUT_TABLES
from stribeck.contacts.groups import Physics
from stribeck.quantities.outputs import COLUMNS, GROUPS
from stribeck.solver.numbers import numbers_of

ERROR = "ERROR"  # Outcome of a state whose solve ended in an error of the program instead of an :class:`Outcome`


class Row(NamedTuple):
    """What a sweep keeps of a state."""

    numbers: dict[str, tuple[float, str, str]]  # Value, unit and meaning of each by its name; empty if there is no state
    outcome: str  # Name of the outcome
    message: str


def row_of(ended: Ended, states: States, i: int) -> Row:
    """Return what a sweep keeps of the i-th state."""
    solution = ended.solution
    if solution is None:
        return Row({}, ERROR if ended.fault else ended.outcome.name, ended.message)
    boundary_friction, beta = (None, None) if states.coefficients is None else states.coefficients[i].tolist()
    stated = (each.stated for each in numbers_of(solution, boundary_friction, beta, with_fields=False))
    numbers = {name: number for each in stated for name, number in each.items()}
    numbers |= {name: (float(getattr(solution, name)), *COLUMNS[name]) for name in ("nodes", "newton_steps")}
    return Row(numbers, ended.outcome.name, ended.message)


def input_columns(names: Iterable[str], physics: Physics) -> dict[str, tuple[str, str]]:
    """Return unit and meaning of the inputs and groups of a state."""
    rows = INPUT_TABLES[physics["geometry"]].rows
    inputs = {name: (rows[name].unit, rows[name].label) for name in names}
    return inputs | {f"{name}_group": ("1", f"{name} group") for name in GROUPS}
