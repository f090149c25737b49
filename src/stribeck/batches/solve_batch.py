"""Arrays of states in one call."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from stribeck._types import Flags
from stribeck.batches.executors import solve_all, solve_here
from stribeck.batches.inputs import varied
from stribeck.batches.result import BatchSolution, without_fields
from stribeck.batches.states import Ended, States
from stribeck.contacts.contact import Contact
from stribeck.contacts.groups import Groups
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import GROUPS
from stribeck.quantities.units import InputError, checked_callback, show
from stribeck.solver.solve import check_rtol

Progress = Callable[[int, int], object]


def solve_batch(
    problem: Groups | Contact,
    *,
    rtol: float = 1e-6,
    dims: Sequence[str] | None = None,
    on_progress: Progress | None = None,
    **inputs: Any,
) -> BatchSolution:
    r"""Solve many states, each from its neighbour.

    Parameters
    ----------
    problem : Groups or LineContact or PointContact
        The states, groups of arrays that broadcast, or the contact of which inputs vary. Their contact law may be any.
    rtol : float
        Relative error allowed in every observable, absolute for the load shares; from 1e-11 to 1e-2.
    dims : sequence of str, optional
        Names of the dimensions of plain arrays; by default that of the only input that varies along each.
    on_progress : callable, optional
        ``on_progress(done, total)`` is called after every state. It may raise KeyboardInterrupt.
    **inputs : number, str, pint.Quantity, array_like of these, or xarray.DataArray
        Inputs of the contact, or groups, that vary: arrays broadcast as those of NumPy do, those of xarray by the names of
        their dimensions.

    Returns
    -------
    BatchSolution
        Observables, outcomes and error estimates. A state that failed, or that an interruption left undone, has its outcome.

    Raises
    ------
    InputError
        If an argument is outside its range.

    Notes
    -----
    Each state meets ``rtol`` by the error estimate of :func:`stribeck.solve`; the two results differ by less than the two
    estimates together (``test_batch.py``). The states are put in chains of neighbours, as :func:`stribeck.sweep` does; a
    sweep also keeps them on disk and solves chains in parallel.

    Source: [BP] Appendix A; numerics.md, "Many states".
    """
    if not isinstance(problem, Groups | Contact):
        raise InputError(f"problem = {show(problem)}; it must be a contact or Groups(speed, load, roughness) of arrays.")
    rtol = check_rtol(rtol)
    checked_callback("on_progress", on_progress)
    groups, contacts, names = varied(problem, inputs, dims)
    if isinstance(problem, Contact):
        given = tuple(dict.fromkeys(problem.INPUTS.stands_for.get(name, name) for name in inputs))
    else:
        given = tuple(name for name in GROUPS if name in inputs or np.ndim(getattr(problem, name)))
    states = States(rtol=rtol, **States.flat(groups, contacts))
    kept = _InMemory(len(states.groups))

    def report_progress() -> None:
        if on_progress is not None:
            on_progress(int(kept.done().sum()), len(states.groups))

    solve_all(states, kept, solve_here, _without_fields, report_progress)
    outcome, solutions = kept.outcome.reshape(groups.shape), kept.solutions.reshape(groups.shape)
    return BatchSolution(groups, contacts, names, given, rtol, outcome, solutions)


class _InMemory:
    """States that are kept in memory."""

    def __init__(self, total: int) -> None:
        self.outcome = np.full(total, Outcome.INTERRUPTED, dtype=object)
        self.solutions = np.full(total, None, dtype=object)
        self._done = np.zeros(total, dtype=bool)

    def done(self) -> Flags:
        """Return whether each state has ended."""
        return self._done

    def keep(self, rows: Sequence[tuple[int, Ended]]) -> None:
        """Keep states that have ended; a fault of the program ends the batch."""
        for number, ended in rows:
            if ended.fault is not None:
                raise ended.fault
            self.outcome[number], self.solutions[number], self._done[number] = ended.outcome, ended.solution, True


def _without_fields(ended: Ended, states: States, i: int) -> Ended:
    return ended if ended.solution is None else replace(ended, solution=without_fields(ended.solution))
