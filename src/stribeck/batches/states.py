"""States to solve, how the solve of each ended, and chains of them, each state from those before it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array, Indices
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Groups, Physics
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.docstrings import Described
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import GROUPS
from stribeck.quantities.units import InputError
from stribeck.solver.base_solution import BaseSolution
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.solve_error import SolveError, describe

Objects = np.ndarray[Any, np.dtype[np.object_]]
"""A contact, an outcome or a solution for each state."""


@dataclass(frozen=True)
class Ended:
    """How the solve of one state ended."""

    outcome: Outcome  # PATH_LOST where the program failed
    solution: BaseSolution | None  # The state, or what was reached of it
    message: str  # How it failed, in a sentence that names the groups; else empty
    fault: Exception | None = None  # The error of the program that ended the solve


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class States(Described):
    """States to solve, wherever they come from."""

    groups: Annotated[Array, "speed, load and roughness group of each state, shape (n, 3)"]
    physics: Annotated[Physics, "contact law and geometry of all states, and the model of the first"]
    rtol: Annotated[float, "relative tolerance of each state"]
    definition: Annotated[Definition, "which friction notes, regimes and pictures go by"] = "balanced"
    contacts: Annotated[Objects | None, "the contacts in SI units that the states come from"] = None
    coefficients: Annotated[Array | None, "``boundary_friction`` and ``beta`` of each beside groups, shape (n, 2)"] = None

    @staticmethod
    def flat(groups: Groups, contacts: Objects | None) -> dict[str, Any]:
        """Return arrays of groups and their contacts as fields of states, one after the other."""
        columns = [np.broadcast_to(getattr(groups, name), groups.shape).ravel() for name in GROUPS]
        own = None if contacts is None else contacts.ravel()
        return {"groups": np.stack(columns, axis=1), "physics": groups.physics, "contacts": own}

    def part(self, rows: Indices) -> States:
        """Return some of the states."""
        arrays = {"groups": self.groups, "contacts": self.contacts, "coefficients": self.coefficients}
        own: dict[str, Any] = {name: None if each is None else each[rows] for name, each in arrays.items()}
        return States(physics=self.physics, rtol=self.rtol, definition=self.definition, **own)

    def problem(self, i: int) -> tuple[Groups, Contact | None]:
        """Return the groups of a state, and its contact where it has one."""
        if self.contacts is None:
            return Groups(*self.groups[i].tolist(), **self.physics), None
        contact: Contact = self.contacts[i]
        return contact.groups, contact


def contacts_at(base: Contact, columns: Mapping[str, Any]) -> tuple[Objects, Groups]:
    """Return a contact for each state, changed by columns of objects, and their groups, with the parts of the first."""
    contacts: Objects = np.empty(next(iter(columns.values())).shape if columns else (), dtype=object)
    for i, index in enumerate(np.ndindex(contacts.shape)):
        try:
            contacts[index] = base.replace(**{name: column[index] for name, column in columns.items()})
        except InputError as problem:
            raise InputError(f"state {i}: {problem}" if contacts.size > 1 else str(problem)) from None
    flat = [contact.groups for contact in contacts.ravel()]
    arrays = {name: np.reshape([float(getattr(each, name)) for each in flat], contacts.shape) for name in GROUPS}
    return contacts, replace(flat[0] if flat else base.groups, **arrays)


@dataclass(frozen=True)
class Chain:
    """States to solve one after the other; a chain travels to another process if ``row_of`` does."""

    numbers: Indices  # Numbers of the states in the design
    states: States
    row_of: Callable[[Ended, States, int], Any]  # What is kept of the i-th state

    @one_blas_thread
    def solve(self, keep: Callable[[int, Any], object]) -> None:
        """Call ``keep(number, row)`` with each state as it ends."""
        neighbours = Neighbours(self.states.rtol)
        for i, number in enumerate(self.numbers.tolist()):
            keep(number, self.row_of(_solved(neighbours, *self.states.problem(i)), self.states, i))


def _solved(neighbours: Neighbours, groups: Groups, contact: Contact | None) -> Ended:
    """Return a state, or how its solve failed."""
    try:
        solution = neighbours.solution(groups, contact)
        return Ended(solution.outcome, solution, "")
    except SolveError as failure:
        reached = failure.solution
        if reached is None:
            return Ended(failure.outcome, None, str(failure))
        return Ended(reached.outcome, reached, f"{describe(groups)}: {reached.outcome.value}")
    except MemoryError:
        raise
    except Exception as problem:  # a fault of the program must not cost the other states of a long run
        return Ended(Outcome.PATH_LOST, None, f"{describe(groups)}: {type(problem).__name__}: {problem}", problem)


MAX_CHAIN = 40  # States of a chain: a cold start costs as much as ten that follow, and a lost worker loses one chain


def chains_of(groups: Array) -> Iterator[Indices]:
    """Yield the chains in which states are solved; resting and smooth states have chains of their own."""
    speed, load, roughness = groups.T
    kinds = 2 * (speed == 0) + (roughness == 0)
    places = np.log(np.stack([np.where(speed > 0, speed, 1.0), load, np.where(roughness > 0, roughness / load, 1.0)], axis=1))
    for kind in np.unique(kinds):
        yield from _halved(places, np.flatnonzero(kinds == kind))


def _halved(places: Array, states: Indices) -> Iterator[Indices]:
    """Yield states in order of the number that spreads them most, halved there until they are few."""
    widest = np.argmax(np.ptp(places[states], axis=0))
    ordered = states[np.argsort(-places[states, widest], kind="stable")]
    if len(ordered) <= MAX_CHAIN:
        yield ordered
        return
    for half in np.array_split(ordered, 2):
        yield from _halved(places, half)
