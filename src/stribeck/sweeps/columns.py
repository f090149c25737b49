"""The columns of a sweep: the names, units and meanings of its numbers, and how a solution becomes a row of them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from stribeck.batches.chain import Ended
from stribeck.contact_laws.law import WithArea
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import DEFINITIONS
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.geometries import CONTACTS
from stribeck.contacts.groups import Physics
from stribeck.contacts.parts import BASE_PARTS, Parts
from stribeck.quantities.inputs import INPUT_TABLES, unit_of
from stribeck.quantities.outputs import AREA_ROWS, GROUPS, LINE_BY_CAVITATION, OUTPUT_TABLES
from stribeck.solver.base_solution import BaseSolution, si_films
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
    for name in table.names:
        if name in table.listed:
            kind = "absolute" if name in table.absolute else "relative"
            found[f"{name}_error"] = ("1", f"estimated {kind} error of {name}")
    found["friction_contact"] = ("1", "contribution of asperities to the friction coefficient")
    for definition in DEFINITIONS:
        label = f"friction coefficient, definition {definition}"
        found[f"friction_{definition}"] = ("1", label)
        found[f"friction_{definition}_viscous"] = ("1", f"{label}: contribution of the fluid")
        found[f"friction_{definition}_error"] = ("1", f"{label}: estimated absolute error")
    found["hersey_number"] = ("1", RULES[physics["geometry"]].hersey_name)
    if si:
        found |= table.films
    if isinstance(physics["law"], WithArea):
        found |= AREA_ROWS
    found["nodes"] = ("1", "unknown gaps in the discretisation")
    found["newton_steps"] = ("1", "steps of the Newton iteration")
    return found


def input_columns(names: Iterable[str], physics: Physics) -> dict[str, tuple[str, str]]:
    """Return unit and meaning of the inputs and groups of a state."""
    table = INPUT_TABLES[physics["geometry"]]
    inputs = {name: (unit_of(name, table), table.quantities[name].label) for name in names}
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
        return kind.of_kept(kept if self.parts is BASE_PARTS else {**kept, "parts": self.parts}, self.physics["law"])

    def row(self, i: int, ended: Ended) -> Row:
        """Return what a sweep keeps of the i-th state."""
        solution = ended.solution
        if solution is None:
            missing = [math.nan] * len(value_columns(self.si, self.physics))
            return missing, ERROR if ended.fault else ended.outcome.name, ended.message
        values = _values(solution, self.columns["boundary_friction"][i], self.columns["beta"][i])
        if ended.outcome.ok:
            return values, solution.outcome.name, "\n".join(solution.notes)
        message = "\n".join((solution.outcome.value, *solution.notes))
        return values, solution.outcome.name, f"{describe(ended.groups)}: {message}"


def _values(solution: BaseSolution, boundary_friction: float, beta: float) -> list[float]:
    """Return the numbers of a state in the order of :func:`value_columns`."""
    table = solution.outputs
    values: list[Any] = [getattr(solution, name) for name in table.listed]
    values += [solution.errors[name] for name in table.names if name in table.listed]
    frictions = [solution.friction(boundary_friction, beta, definition) for definition in DEFINITIONS]
    values.append(frictions[0].contact)
    for friction in frictions:
        values += [friction.total, friction.viscous, friction.error]
    values.append(solution.groups.hersey_number(beta))
    values += [value for value, _, _ in si_films(solution).values()]
    if isinstance(solution.groups.law, WithArea):
        values += [getattr(solution, name) for name in AREA_ROWS]
    return [float(value) for value in (*values, solution.nodes, solution.newton_steps)]
