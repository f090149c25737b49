"""The columns of a sweep: the names, units and meanings of its numbers, and how a solution becomes a row of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from stribeck.batches.chain import Ended
from stribeck.contact_laws.law import WithArea
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import DEFINITIONS
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.geometries import CONTACTS, INPUT_TABLES
from stribeck.contacts.groups import Physics
from stribeck.contacts.parts import BASE_PARTS, Parts
from stribeck.quantities.outputs import (
    AREA_ROWS,
    COLUMNS,
    GROUPS,
    LINE_BY_CAVITATION,
    OUTPUT_TABLES,
    friction_rows,
)
from stribeck.solver.base_solution import BaseSolution
from stribeck.solver.numbers import numbers_of
from stribeck.solver.solve_error import describe

__all__ = ["ERROR", "StateInputs", "input_columns", "value_columns"]

ERROR = "ERROR"  # Outcome of a state whose solve ended in an error of the program instead of an :class:`Outcome`

Row = tuple[list[float], str, str]
"""Numbers of a state, the name of its outcome, and its message."""


def value_columns(si: bool, physics: Physics) -> dict[str, tuple[str, str]]:
    """Return unit and meaning of each number of a row, in their order."""
    line = physics["geometry"] == "line"
    table = LINE_BY_CAVITATION[physics["model"].cavitation] if line else OUTPUT_TABLES[physics["geometry"]]
    found = dict(table.listed)
    found |= _errors({name: table.listed[name] for name in table.names if name in table.listed})
    found["friction_asperities"] = COLUMNS["friction_asperities"]
    for definition in DEFINITIONS:
        found |= friction_rows(definition)
    found["hersey_number"] = ("1", RULES[physics["geometry"]].hersey_name)
    if si:
        found |= table.films | _errors({row.film: table.films[row.film] for row in table.rows if row.film and row.error})
    if isinstance(physics["law"], WithArea):
        found |= AREA_ROWS
    return found | {name: COLUMNS[name] for name in ("nodes", "newton_steps")}


def _errors(columns: Mapping[str, tuple[str, str]]) -> dict[str, tuple[str, str]]:
    return {f"{name}_error": (unit, f"estimated absolute error of {name}") for name, (unit, _) in columns.items()}


def input_columns(names: Iterable[str], physics: Physics) -> dict[str, tuple[str, str]]:
    """Return unit and meaning of the inputs and groups of a state."""
    table = INPUT_TABLES[physics["geometry"]]
    inputs = {name: (table.unit(name), table.quantities[name].label) for name in names}
    return inputs | {f"{name}_group": ("1", f"{name} group") for name in GROUPS}


@dataclass(frozen=True, eq=False)
class StateInputs:
    """Inputs of the states of a chain of a sweep: they make its contacts and its rows, also in another process."""

    columns: dict[str, list[float]]
    si: bool  # Whether the inputs are in SI units
    physics: Physics
    parts: Parts = BASE_PARTS  # Fluid, cavitation, flow factors, solid and motion of all contacts

    def contact(self, i: int) -> Contact | None:
        """Return the contact of the i-th state, where it has one."""
        if not self.si:
            return None
        kind = CONTACTS[self.physics["geometry"]]
        kept = {name: self.columns[name][i] for name in kind.INPUTS.names if name in self.columns}
        return kind.of_kept({**self.parts.part_values(), **kept}, self.physics["law"])

    def row(self, i: int, ended: Ended) -> Row:
        """Return what a sweep keeps of the i-th state."""
        solution, names = ended.solution, value_columns(self.si, self.physics)
        if solution is None:
            return [math.nan] * len(names), ERROR if ended.fault else ended.outcome.name, ended.message
        values = _values(names, solution, self.columns["boundary_friction"][i], self.columns["beta"][i])
        if ended.outcome.ok:
            return values, solution.outcome.name, "\n".join(solution.notes)
        message = "\n".join((solution.outcome.value, *solution.notes))
        return values, solution.outcome.name, f"{describe(ended.groups)}: {message}"


def _values(names: Iterable[str], solution: BaseSolution, boundary_friction: float, beta: float) -> list[float]:
    """Return the numbers of a state in the order of :func:`value_columns`."""
    numbers = {each.name: each for each in numbers_of(solution, boundary_friction, beta)}
    values = {"nodes": solution.nodes, "newton_steps": solution.newton_steps}
    values |= {f"{name}_error": each.error for name, each in numbers.items()}
    values |= {name: each.value for name, each in numbers.items()}
    return [float(values[name]) for name in names]
