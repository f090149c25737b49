"""The columns of a sweep: the names, units and meanings of its numbers, and how a solution becomes a row of them."""

from __future__ import annotations

import math

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import WithArea
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import DEFINITIONS
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Physics
from stribeck.quantities.inputs import InputTable, unit_of
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import AREA_ROWS, LINE_BY_CAVITATION, OUTPUT_TABLES
from stribeck.solver.base_solution import BaseSolution, si_films

__all__ = ["OUTCOMES", "columns_of", "failed_row", "input_columns", "row_of"]

ERROR = "ERROR"  # Outcome of a state whose solve ended in an error of the program instead of an :class:`Outcome`

OUTCOMES = (*(outcome.name for outcome in Outcome), ERROR)  # A row holds the place of its outcome in here


def columns_of(si: bool, physics: Physics) -> dict[str, tuple[str, str]]:
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
    found["outcome"] = ("1", "how the solve of the state ended")
    return found


def input_columns(names: tuple[str, ...], table: InputTable) -> dict[str, tuple[str, str]]:
    """Return unit and meaning of the inputs and groups of a state."""
    found = {}
    for name in names:
        if name in ("speed_group", "load_group", "roughness_group"):
            found[name] = ("1", name.replace("_", " "))
        else:
            found[name] = (unit_of(name, table), table.quantities[name].label)
    return found


def row_of(solution: BaseSolution, boundary_friction: float, beta: float) -> tuple[Array, str]:
    """Return the numbers of a state, in the order of :func:`columns_of`, and the notes on it."""
    table = solution.outputs
    values = [float(getattr(solution, name)) for name in table.listed]
    values += [solution.errors[name] for name in table.names if name in table.listed]
    frictions = [solution.friction(boundary_friction, beta, definition) for definition in DEFINITIONS]
    values.append(frictions[0].contact)
    for friction in frictions:
        values += [friction.total, friction.viscous, friction.error]
    values.append(float(solution.groups.hersey_number(beta)))
    values += [value for value, _, _ in si_films(solution).values()]
    if isinstance(solution.groups.law, WithArea):
        values += [getattr(solution, name) for name in AREA_ROWS]
    values += [solution.nodes, solution.newton_steps, OUTCOMES.index(solution.outcome.name)]
    messages = solution.notes if solution.outcome.ok else (solution.outcome.value, *solution.notes)
    return np.array(values), "\n".join(messages)


def failed_row(contact: Contact | None, physics: Physics, outcome: str, message: str) -> tuple[Array, str]:
    """Return the row of a state of which nothing is known but how its solve ended."""
    values = np.full(len(columns_of(contact is not None, physics)), math.nan)
    values[-1] = OUTCOMES.index(outcome)
    return values, message
