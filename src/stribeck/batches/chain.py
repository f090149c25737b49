"""Solving a chain of states: each starts from the one before it, from cold where that fails, and keeps its outcome."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.batches.order import coordinates
from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Groups, Physics
from stribeck.contacts.model import BASE_MODEL
from stribeck.numerics.continuation import Steps, march
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outcome import Outcome
from stribeck.solver.path.corrector import Corrector
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solution import Solution
from stribeck.solver.solve import hertz_solution, solution_of
from stribeck.solver.solve_error import describe

__all__ = ["Ended", "solve_in_order"]

# Of the way from state to state: its steps, and the degree of the polynomial that predicts them.
CHAIN_STEPS = Steps(0.5, math.log(10.0), 1e-3, 4)

LONGEST_JUMP = 5.0  # Distance between two states above which a cold start is cheaper than the states between

STRAIGHT = 1e-6  # Change of direction below which states lie on a line, so that their polynomial predicts the next one


@dataclass(frozen=True, eq=False)
class Ended:
    """How the solve of one state ended."""

    outcome: Outcome  # The outcome; PATH_LOST where the program failed
    solution: Solution | None  # The state, or what was reached of it
    message: str = ""  # What happened, in one sentence that names the groups; empty where the state converged
    fault: Exception | None = None  # The error of the program that ended the solve


def solve_in_order(
    states: Array,
    physics: Physics,
    rtol: float,
    on_state: Callable[[int, Ended], object],
    contact_of: Callable[[int], Contact | None] = lambda _: None,
) -> None:
    """Solve the states of a chain one after the other."""
    CHAINS[physics["geometry"]](states, physics, rtol, on_state, contact_of)


def _cylinders(
    states: Array,
    physics: Physics,
    rtol: float,
    on_state: Callable[[int, Ended], object],
    contact_of: Callable[[int], Contact | None],
) -> None:
    _Chain(states, physics, rtol, on_state, contact_of).run()


@one_blas_thread
def _balls(
    states: Array,
    physics: Physics,
    rtol: float,
    on_state: Callable[[int, Ended], object],
    contact_of: Callable[[int], Contact | None],
) -> None:
    """Solve balls, each from the one before it."""
    from stribeck.solver.point.path import next_state
    from stribeck.solver.point.solution import solution_of as ball_of

    last = None
    for i, row in enumerate(states.tolist()):
        groups = Groups(*row, **_physics_of(physics, contact_of(i)))
        try:
            state = next_state(last, groups, rtol)
        except MemoryError:
            raise
        except Exception as problem:  # a fault of the program must not cost the other states of a long run
            message = f"{describe(groups)}: {type(problem).__name__}: {problem}"
            on_state(i, Ended(Outcome.PATH_LOST, None, message, problem))
            continue
        if state.outcome.ok:
            last = state
            on_state(i, Ended(state.outcome, ball_of(state, contact_of(i))))  # type: ignore[arg-type]
        else:
            on_state(i, Ended(state.outcome, None, f"{describe(groups)}: {state.outcome.value}"))


def _physics_of(physics: Physics, contact: Contact | None) -> Physics:
    """Return what a state has beside its groups: in Hertz units a fluid in SI units is another at each load."""
    return physics if contact is None or physics["model"] == BASE_MODEL else contact.groups.physics


CHAINS = {"line": _cylinders, "point": _balls}  # How the states of a chain are solved, by geometry


class _Chain:
    """The states of a chain, and whom to tell about them."""

    def __init__(
        self,
        states: Array,
        physics: Physics,
        rtol: float,
        on_state: Callable[[int, Ended], object],
        contact_of: Callable[[int], Contact | None],
    ) -> None:
        self.states, self.physics, self.rtol, self.on_state, self.contact_of = states, physics, rtol, on_state, contact_of

    def groups(self, i: int) -> Groups:
        """Return the groups of the i-th state."""
        return Groups(*self.states[i].tolist(), **self.physics_of(i))

    def physics_of(self, i: int) -> Physics:
        """Return what the i-th state has beside its groups."""
        return _physics_of(self.physics, self.contact_of(i))

    @one_blas_thread
    def run(self) -> None:
        """Solve all states."""
        first = 0
        while first < len(self.states):
            groups = self.groups(first)
            if groups.is_hertzian:
                solution = hertz_solution(groups, self.contact_of(first), self.rtol)
                self.on_state(first, Ended(solution.outcome, solution))
                first += 1
                continue
            here = range(first, _end(self.states, first))
            finished, failed = self._follow(first, _Polyline(self.states[here], [self.physics_of(i) for i in here]))
            first += finished
            if finished == 0:
                self.on_state(first, failed)
                first += 1

    def _follow(self, first: int, path: _Polyline) -> tuple[int, Ended]:
        """Solve along a path; return how many of its states are finished, and how the solve of the next one ended."""
        corrector = Corrector(path.groups_at, self.rtol)
        finished = 0
        fault: Exception | None = None

        def correct(s: float, history: Sequence[tuple[float, RefinedState]]) -> RefinedState | None:
            nonlocal fault
            begin = path.straight_from(s)
            straight = [pair for pair in history if pair[0] >= begin]
            fault = None
            try:
                return corrector(s, straight if len(straight) > 1 else history[-1:])
            except MemoryError:
                raise
            except Exception as problem:  # a fault of the program must not cost the other states of a long run
                fault = problem
                return None

        def report(s: float, point: RefinedState) -> None:
            nonlocal finished
            while finished < len(path) and path.knots[finished] == s:
                i = first + finished
                self.on_state(i, Ended(point.outcome, solution_of(point, self.contact_of(i), self.rtol)))
                finished += 1

        found = march(
            correct,
            path.knots[0],
            path.knots[-1],
            CHAIN_STEPS,
            targets=path.knots,
            on_point=report,
        )
        if found.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if finished:
            return finished, Ended(found.outcome, None)
        return 0, self._failure(first, found.outcome, found.failure, fault)

    def _failure(self, i: int, outcome: Outcome, failure: RefinedState | None, fault: Exception | None) -> Ended:
        """Return how a state failed from cold, with what was reached."""
        where = describe(self.groups(i))
        if fault is not None:
            return Ended(outcome, None, f"{where}: {type(fault).__name__}: {fault}", fault)
        solution = None
        if failure is not None:
            outcome, solution = failure.outcome, solution_of(failure, self.contact_of(i), self.rtol)
        return Ended(outcome, solution, f"{where}: {outcome.value}")


def _end(groups: Array, first: int) -> int:
    """Return how far states can be followed: as long as the same groups are zero, and without a long jump."""
    z = coordinates(groups)
    for i in range(first + 1, len(groups)):
        if ((groups[i] == 0) != (groups[first] == 0)).any() or np.abs(z[i] - z[i - 1]).max() > LONGEST_JUMP:
            return i
    return len(groups)


class _Polyline:
    """The way from state to state, straight in the logarithms of the groups that are not zero."""

    def __init__(self, groups: Array, physics: Sequence[Physics]) -> None:
        self.groups, self.physics = groups, physics
        self.z = np.log(np.where(groups > 0, groups, 1.0))
        steps = np.diff(self.z, axis=0)
        lengths = np.abs(steps).max(axis=1) if len(steps) else np.zeros(0)
        self.knots = np.concatenate([[0.0], np.cumsum(lengths)]).tolist()
        self.begins = self._straight(steps, lengths)

    def __len__(self) -> int:
        """Return the number of states."""
        return len(self.groups)

    def _straight(self, steps: Array, lengths: Array) -> list[float]:
        """Return, for each step, where the straight line begins on which it lies."""
        begins: list[float] = []
        last: Array | None = None
        for i, (step, length) in enumerate(zip(steps, lengths, strict=True)):
            direction = step / length if length > 0 else None
            if direction is None or last is None or np.abs(direction - last).max() > STRAIGHT:
                begins.append(self.knots[i])
            else:
                begins.append(begins[-1])
            last = direction
        return begins

    def _step(self, s: float) -> int:
        """Return the number of the step that ends at ``s`` or holds it."""
        return min(max(int(np.searchsorted(self.knots, s)) - 1, 0), len(self) - 2)

    def straight_from(self, s: float) -> float:
        """Return where the straight line begins on which ``s`` lies."""
        return self.begins[self._step(s)] if self.begins else -math.inf

    def groups_at(self, s: float) -> Groups:
        """Return the groups at ``s``, exactly those of a state where it is one."""
        i = int(np.searchsorted(self.knots, s))
        if i < len(self) and self.knots[i] == s:
            return Groups(*self.groups[i].tolist(), **self.physics[i])
        k = self._step(s)
        part = (s - self.knots[k]) / (self.knots[k + 1] - self.knots[k])
        here = np.exp((1 - part) * self.z[k] + part * self.z[k + 1])
        return Groups(*np.where(self.groups[k] > 0, here, 0.0).tolist(), **self.physics[k + 1])
