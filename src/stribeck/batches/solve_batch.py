"""Arrays of states in one call."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import fields
from typing import Any

import numpy as np

from stribeck._types import Array, Indices
from stribeck.batches.chain import Chain, Ended
from stribeck.batches.executors import solve_here
from stribeck.batches.inputs import varied
from stribeck.batches.order import chains_of
from stribeck.batches.result import BatchSolution
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import DEFINITIONS, Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Groups
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import GROUPS, OUTPUT_TABLES
from stribeck.quantities.units import InputError, checked_callback, show
from stribeck.solver.base_solution import BaseSolution
from stribeck.solver.solve import check_rtol

__all__ = ["solve_batch"]

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
    shape = groups.shape
    parts = (groups.speed, groups.load, groups.roughness)
    states = np.stack([np.broadcast_to(part, shape).ravel() for part in parts], axis=1)
    total = len(states)
    table = OUTPUT_TABLES[groups.geometry].names
    values = {name: np.full(total, np.nan) for name in table}
    errors = {name: np.full(total, np.nan) for name in table}
    estimate = np.full(total, np.nan)
    rule = RULES[groups.geometry]
    is_enough = rule.is_enough(
        groups.model, [] if contacts is None else [rule.of_contact(each) for each in contacts.ravel().tolist()]
    )
    own: dict[Definition, Array] = {} if is_enough else {each: np.full((2, total), np.nan) for each in DEFINITIONS}
    outcome = np.full(total, Outcome.INTERRUPTED, dtype=object)
    done = 0

    def keep(rows: Sequence[tuple[int, Ended]]) -> None:
        nonlocal done
        for row, ended in rows:
            if ended.fault is not None:
                raise ended.fault
            ends = ended.solution if ended.outcome.ok and ended.solution is not None else ended
            outcome[row], done = ends.outcome, done + 1
            if ended.solution is None:
                continue
            estimate[row] = ended.solution.error_estimate
            for definition, pair in own.items():
                friction = ended.solution.friction(boundary_friction=0.0, definition=definition)
                pair[:, row] = friction.fluid, friction.error
            for kept, found in ((values, _observed(ended.solution)), (errors, ended.solution.errors)):
                for name, value in found.items():
                    kept.setdefault(name, np.full(total, np.nan))[row] = value

    def report_progress() -> None:
        if on_progress is not None:
            on_progress(done, total)

    def chain(rows: Indices) -> Chain:
        each = [None] * len(rows) if contacts is None else contacts.ravel()[rows].tolist()
        return Chain(rows, states[rows], groups.physics, rtol, each.__getitem__, lambda _, ended: ended)

    with suppress(KeyboardInterrupt):
        solve_here([chain(rows) for rows in chains_of(states)], keep, report_progress)

    def shaped(kept: dict[str, Array]) -> dict[str, Array]:
        return {name: value.reshape(shape) for name, value in kept.items()}

    outcomes, estimates = outcome.reshape(shape), estimate.reshape(shape)
    viscous = {each: pair.reshape(2, *shape) for each, pair in own.items()}
    return BatchSolution(groups, contacts, names, given, rtol, outcomes, shaped(values), shaped(errors), estimates, viscous)


def _observed(solution: BaseSolution) -> dict[str, float]:
    """Return the observables of a state by name."""
    found = solution.observables
    return {each.name: float(getattr(found, each.name)) for each in fields(found) if not each.name.startswith("_")}
