"""Solving a chain of states: each starts from those before it, from cold where that fails, and keeps its outcome."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from stribeck._types import Array
from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Groups, Physics
from stribeck.contacts.model import BASE_MODEL
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outcome import Outcome
from stribeck.solver.base_solution import BaseSolution
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.solve_error import SolveError, describe

__all__ = ["Ended", "solve_in_order"]


@dataclass(frozen=True, eq=False)
class Ended:
    """How the solve of one state ended."""

    outcome: Outcome  # The outcome; PATH_LOST where the program failed
    solution: BaseSolution | None  # The state, or what was reached of it
    message: str = ""  # What happened, in one sentence that names the groups; empty where the state converged
    fault: Exception | None = None  # The error of the program that ended the solve


@one_blas_thread
def solve_in_order(
    states: Array,
    physics: Physics,
    rtol: float,
    on_state: Callable[[int, Ended], object],
    contact_of: Callable[[int], Contact | None] = lambda _: None,
) -> None:
    """Solve the states of a chain one after the other, each from those before it."""
    neighbours = Neighbours(rtol)
    for i, row in enumerate(states.tolist()):
        contact = contact_of(i)
        groups = Groups(*row, **_physics_of(physics, contact))
        try:
            solution = neighbours.solution(groups, contact)
            ended = Ended(solution.outcome, solution)
        except SolveError as failure:
            ended = Ended(failure.outcome, failure.solution, str(failure))
        except MemoryError:
            raise
        except Exception as problem:  # a fault of the program must not cost the other states of a long run
            ended = Ended(Outcome.PATH_LOST, None, f"{describe(groups)}: {type(problem).__name__}: {problem}", problem)
        on_state(i, ended)


def _physics_of(physics: Physics, contact: Contact | None) -> Physics:
    """Return what a state has beside its groups: in Hertz units a fluid in SI units is another at each load."""
    return physics if contact is None or physics["model"] == BASE_MODEL else contact.groups.physics
