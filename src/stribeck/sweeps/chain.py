"""Solving one chain of states: each starts from the one before it, from cold where that fails, and keeps its outcome."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import LawShape
from stribeck.contacts.line import Groups, LineContact
from stribeck.numerics.continuation import march
from stribeck.numerics.newton import Outcome
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.inputs import INPUTS
from stribeck.solver.corrector import Follower
from stribeck.solver.path import LONGEST_STEP, PREDICTOR_ORDER, SHORTEST_STEP
from stribeck.solver.refinement import Point
from stribeck.solver.solve import describe, hertz_solution, solution_of
from stribeck.sweeps.columns import ERROR, failed_row, row_of
from stribeck.sweeps.order import coordinates

__all__ = ["Chain", "solve_chain"]

LONGEST_JUMP = 5.0
"""Distance between two states above which a cold start is cheaper than the states between."""

STRAIGHT = 1e-6
"""Change of direction below which states lie on a line, so that their polynomial predicts the next one."""

OnRow = Callable[[int, Array, str], object]


@dataclass(frozen=True)
class Chain:
    """States to solve one after the other, in a form that travels to other processes.

    Attributes
    ----------
    rows : tuple of int
        Their numbers in the sweep.
    groups : tuple of tuple
        Speed, load and roughness group of each.
    inputs : dict of str to tuple
        By the name of the input, its values: those of a contact in SI units, or ``mu0`` and ``beta``.
    si : bool
        Which of the two.
    rtol : float
        Relative tolerance of each state.
    law : LawShape or None
        Contact law of all; None is the exponential one.
    """

    rows: tuple[int, ...]
    groups: tuple[tuple[float, float, float], ...]
    inputs: dict[str, tuple[float, ...]]
    si: bool
    rtol: float
    law: LawShape | None = None

    def contact(self, i: int) -> LineContact | None:
        """Return the contact of the i-th state, where it has one."""
        if not self.si:
            return None
        return LineContact(**{name: self.inputs[name][i] for name in INPUTS}, law=self.law)

    def coefficients(self, i: int) -> tuple[float, float]:
        """Return mu0 and beta of the i-th state."""
        return self.inputs["friction_coefficient" if self.si else "mu0"][i], self.inputs["beta"][i]


@one_blas_thread
def solve_chain(chain: Chain, on_row: OnRow) -> None:
    """Solve the states of a chain in their order.

    Parameters
    ----------
    chain : Chain
        What to solve.
    on_row : callable
        ``on_row(row, values, text)`` is called as soon as a state is finished, with what :func:`sweep_columns.row_of` makes
        of it, also where it failed.  What it raises ends the chain.

    Raises
    ------
    KeyboardInterrupt
        If the user interrupted it.
    """
    groups = np.array(chain.groups)
    first = 0
    while first < len(groups):
        if groups[first, 0] == groups[first, 2] == 0:  # the dry smooth contact
            here = Groups(*chain.groups[first], law=chain.law)
            contact = chain.contact(first)
            on_row(chain.rows[first], *row_of(hertz_solution(here, contact, chain.rtol), *chain.coefficients(first)))
            first += 1
            continue
        path = _Polyline(groups[first : _end(groups, first)], chain.law)
        finished, outcome, failure, error = _follow(chain, first, path, on_row)
        if outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        first += finished
        if finished == 0:
            on_row(chain.rows[first], *_failure(chain, first, outcome, failure, error))
            first += 1


def _end(groups: Array, first: int) -> int:
    """Return how far states can be followed: as long as the same groups are zero, and without a long jump."""
    z = coordinates(groups)
    for i in range(first + 1, len(groups)):
        if ((groups[i] == 0) != (groups[first] == 0)).any() or np.abs(z[i] - z[i - 1]).max() > LONGEST_JUMP:
            return i
    return len(groups)


def _follow(chain: Chain, first: int, path: _Polyline, on_row: OnRow) -> tuple[int, Outcome, Point | None, str]:
    """Solve along a path; return how many of its states are finished, how it ended, what failed last, and an error there."""
    follower = Follower(path.groups_at, chain.rtol)
    finished, error = 0, ""

    def correct(s: float, history: Sequence[tuple[float, Point]]) -> Point | None:
        nonlocal error
        begin = path.straight_from(s)
        straight = [pair for pair in history if pair[0] >= begin]
        error = ""
        try:
            return follower(s, straight if len(straight) > 1 else history[-1:])
        except MemoryError:
            raise
        except Exception as problem:  # a fault of the program must not cost the other states of a long sweep
            error = f"{type(problem).__name__}: {problem}"
            return None

    def report(s: float, point: Point) -> None:
        nonlocal finished
        while finished < len(path) and path.knots[finished] == s:
            i = first + finished
            solution = solution_of(point, chain.contact(i), chain.rtol)
            assert solution is not None
            on_row(chain.rows[i], *row_of(solution, *chain.coefficients(i)))
            finished += 1

    found = march(
        correct,
        path.knots[0],
        path.knots[-1],
        first_step=0.5,
        max_step=LONGEST_STEP,
        min_step=SHORTEST_STEP,
        order=PREDICTOR_ORDER,
        targets=path.knots,
        on_point=report,
    )
    return finished, found.outcome, found.failure, error


def _failure(chain: Chain, i: int, outcome: Outcome, failure: Point | None, error: str) -> tuple[Array, str]:
    """Return the row of a state that failed from cold: what was reached where there is a state, else its outcome alone."""
    contact, where = chain.contact(i), describe(Groups(*chain.groups[i], law=chain.law))
    if error:
        return failed_row(contact, chain.law, ERROR, f"{where}: {error}")
    if failure is not None:
        outcome = failure.outcome
        solution = solution_of(failure, contact, chain.rtol)
        if solution is not None:
            values, text = row_of(solution, *chain.coefficients(i))
            return values, f"{where}: {text}"
    return failed_row(contact, chain.law, outcome.name, f"{where}: {outcome.value}")


class _Polyline:
    """The way from state to state, straight in the logarithms of the groups that are not zero."""

    def __init__(self, groups: Array, law: LawShape | None) -> None:
        self.groups, self.law = groups, law
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
            return Groups(*self.groups[i].tolist(), law=self.law)
        k = self._step(s)
        part = (s - self.knots[k]) / (self.knots[k + 1] - self.knots[k])
        here = np.exp((1 - part) * self.z[k] + part * self.z[k + 1])
        return Groups(*np.where(self.groups[k] > 0, here, 0.0).tolist(), law=self.law)
