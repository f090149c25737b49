"""Solving a chain of states: each starts from those before it, from cold where that fails, and keeps its outcome."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from stribeck._types import Array, Indices
from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Groups, Physics
from stribeck.contacts.model import BASE_MODEL
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outcome import Outcome
from stribeck.solver.base_solution import BaseSolution
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.solve_error import SolveError, describe

__all__ = ["Chain", "Ended"]


@dataclass(frozen=True, eq=False)
class Ended:
    """How the solve of one state ended."""

    groups: Groups
    outcome: Outcome  # The outcome; PATH_LOST where the program failed
    solution: BaseSolution | None  # The state, or what was reached of it
    message: str = ""  # What happened, in one sentence that names the groups; empty where the state converged
    fault: Exception | None = None  # The error of the program that ended the solve


@dataclass(frozen=True, eq=False)
class Chain:
    """States to solve one after the other; a chain travels to another process if its two functions do."""

    states: Indices  # Numbers of the states in the design
    groups: Array  # Speed, load and roughness group of each, shape (n, 3)
    physics: Physics  # Contact law and geometry of all, and the model of the first
    rtol: float  # Relative tolerance of each state
    contact_of: Callable[[int], Contact | None]  # Contact of the i-th state of the chain, where it has one
    row_of: Callable[[int, Ended], Any]  # What is kept of the i-th state

    @one_blas_thread
    def solve(self, keep: Callable[[int, Any], object]) -> None:
        """Call ``keep(number, row)`` with each state as it ends."""
        neighbours = Neighbours(self.rtol)
        for i, (number, row) in enumerate(zip(self.states.tolist(), self.groups.tolist(), strict=True)):
            contact = self.contact_of(i)
            # In Hertz units a fluid in SI units is another at each load.
            same = contact is None or self.physics["model"] == BASE_MODEL
            groups = Groups(*row, **(self.physics if same or contact is None else contact.groups.physics))
            try:
                solution = neighbours.solution(groups, contact)
                ended = Ended(groups, solution.outcome, solution)
            except SolveError as failure:
                ended = Ended(groups, failure.outcome, failure.solution, str(failure))
            except MemoryError:
                raise
            except Exception as problem:  # a fault of the program must not cost the other states of a long run
                message = f"{describe(groups)}: {type(problem).__name__}: {problem}"
                ended = Ended(groups, Outcome.PATH_LOST, None, message, problem)
            keep(number, self.row_of(i, ended))
