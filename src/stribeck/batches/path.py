"""Ways of many states at once: down from where the contact is rigid, or from one solved state to its neighbours.

The states of a batch take their steps together, on a mesh that resolves them all.  Meshes, predictions, observables and error
estimates are made by NumPy; Newton's iteration, which is most of the work, runs on the device.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.batches.device import Device
from stribeck.batches.equations import DeviceEquations, DeviceOperators, newton
from stribeck.batches.guess import Batch, Guesses, column_groups, predicted, rigid_rows
from stribeck.contacts.groups import contact_law
from stribeck.contacts.line import Groups
from stribeck.equations.error_estimate import ErrorEstimate, FineOperators, error_estimates
from stribeck.equations.line import Equations, Operators
from stribeck.equations.observables import Observables, observables_of_rows
from stribeck.equations.state import PREDICTION_GOAL, Rows, mesh_for
from stribeck.numerics.newton import Outcome
from stribeck.numerics.panels import Mesh, MeshTooLargeError
from stribeck.solver.cold_start import MESH_TOLERANCE, ORDER, RIGID_ROUGHNESS, RIGID_SPEED
from stribeck.solver.refinement import mesh_tolerances_for, newton_tolerance, order_for, reached

FIRST_STEP = 0.3
LONGEST_STEP = 2.5
SHORTEST_STEP = 0.02
HISTORY = 4

PATH_TOLERANCE = 1e-3
"""Of Newton's iteration on the way, where a state is only a prediction."""

LOST_PART = 0.1
"""Part of the states that may fail in a step; with more the step is tried again at half its length."""

ROUNDS = 4
"""Meshes that a batch gets to hold its tolerance."""

TIGHTER = 0.2
"""Factor between the mesh tolerances of two rounds."""

LEAST_ROWS = 3
"""States for which another shared mesh is worth while."""


def unloading(groups: Groups) -> Array:
    """Return how far above their end the loading paths of states begin, as in :mod:`stribeck.solver.cold_start`; a column."""
    by_film = 0.5 * np.log(RIGID_SPEED / np.asarray(groups.speed))
    kappa = np.asarray(groups.relative_roughness)
    by_asperities = np.log(RIGID_ROUGHNESS / np.where(kappa > 0, kappa, 1e-300))
    return np.maximum(0.0, np.minimum(by_film, by_asperities))


def unloaded_rows(groups: Groups, log_factor: Array) -> Groups:
    """Return the groups at loads divided by ``exp(log_factor)``, all else being held."""
    factor = np.exp(log_factor)
    return Groups(groups.speed * factor**2, groups.load / factor, groups.roughness)


def on_mesh(guess: Guesses, groups: Groups, mesh: Mesh, device: Device, tolerance: float) -> tuple[Batch, Flags, Array]:
    """Return the states on a mesh nearest to a guess, which of them converged, and by how much their gaps moved."""
    y = np.concatenate([np.exp(guess.log_gap(mesh)), guess.offset, guess.flux_gap], axis=1)
    operators = Operators(mesh)
    equations = DeviceEquations.of(DeviceOperators.of(operators, device), groups, y[:, -1:])
    found, done, _ = newton(equations, y, tolerance)
    return Batch(groups, operators, found), done, np.abs(y[:, :-2] / found[:, :-2] - 1).max(axis=1)


def descend(groups: Groups, device: Device) -> tuple[Batch | None, Indices]:
    """Return coarse states at the end of the loading paths from the rigid contact, and the rows of ``groups`` that they are.

    A state is at the same part of its own path as the others are of theirs.
    """
    top = unloading(groups)
    rows, longest = np.arange(len(top)), max(float(top.max()), 1e-12)
    history: list[tuple[float, Batch]] = []
    s, step = 1.0, 0.0
    while len(rows):
        goal = max(0.0, s - step / longest)
        here = unloaded_rows(groups, goal * top)
        near_top = (1.0 - goal) * longest < 0.7 and len(history) < 3
        guess = rigid_rows(here) if near_top else predicted(history, goal)
        try:
            mesh = mesh_for(guess, here, contact_law(here), ORDER, MESH_TOLERANCE)
            batch, done, moved = on_mesh(guess, here, mesh, device, PATH_TOLERANCE)
        except MeshTooLargeError:
            done = np.zeros(len(rows), dtype=bool)
        if done.mean() < 1 - LOST_PART and step > SHORTEST_STEP:
            step *= 0.5
            continue
        if not done.all():
            rows, top, groups = rows[done], top[done], column_groups(groups, done)
            history = [(c, b.rows(done)) for c, b in history]
            if not len(rows):
                break
            batch, moved = batch.rows(done), moved[done]
        history = [*history[1 - HISTORY :], (goal, batch)]
        if goal == 0.0:
            return batch, rows
        s = goal
        error = max(float(np.quantile(moved, 0.9)), 1e-6)
        growth = min(2.0, max(0.5, (PREDICTION_GOAL / error) ** (1 / len(history))))
        step = min(LONGEST_STEP, step * growth) if step else FIRST_STEP
    return None, rows


@dataclass(frozen=True, eq=False)
class Answer:
    """What a state of a batch came to: its observables, their error, and whether that holds the tolerance."""

    values: Observables
    estimate: ErrorEstimate
    outcome: Outcome


def judged(batch: Batch, rtol: float, device: Device) -> list[Answer]:
    """Return the observables of states and their errors, by the same estimate as any other state."""
    operators = batch.operators
    scale = batch.flux_gap**2
    equations = Equations(operators, batch.groups.speed, contact_law(batch.groups), scale)
    on_device = DeviceEquations.of(DeviceOperators.of(operators, device), batch.groups, batch.flux_gap)
    xp = device.xp

    def of_residuals(residuals: Array) -> Array:
        found = np.empty_like(residuals)
        for chunk in device.chunks(*batch.y.shape):
            own = on_device.rows(xp.asarray(np.arange(len(batch.y))[chunk], device=device.device))
            columns = device.put(np.moveaxis(residuals[:, chunk], 0, 2))
            found[:, chunk] = np.moveaxis(device.get(own.correction(device.put(batch.y[chunk]), columns)), 2, 0)
        return found * equations.units(batch.y)

    values = observables_of_rows(equations, batch.y, batch.groups.load)
    estimates = error_estimates(Rows(equations, batch.y, batch.groups.load, of_residuals), values, FineOperators(batch.mesh))
    return [Answer(v, e, ended(e, rtol)) for v, e in zip(values, estimates, strict=True)]


def ended(estimate: ErrorEstimate, rtol: float) -> Outcome:
    """Return whether an estimate holds the tolerance, and where not, whether rounding or the mesh is in the way."""
    outcome = reached(estimate, rtol)
    return outcome if outcome.ok or estimate.total > 3 * estimate.floor else Outcome.ROUNDING


def refined(guess: Batch, rtol: float, device: Device) -> dict[int, Answer]:
    """Return, by row of the guess, the states that hold the tolerance on a mesh that they share, or that rounding bounds."""
    tail, gap_tail = mesh_tolerances_for(rtol)
    rows = np.arange(len(guess.y))
    found: dict[int, Answer] = {}
    for _ in range(ROUNDS):
        groups = guess.groups
        try:
            mesh = mesh_for(guess, groups, contact_law(groups), order_for(rtol), tail, gap_tail)
        except MeshTooLargeError:
            break
        batch, done, _ = on_mesh(guess, groups, mesh, device, newton_tolerance(rtol))
        batch, rows = batch.rows(done), rows[done]
        if not len(rows):
            break
        answers = judged(batch, rtol, device)
        missed = np.array([a.outcome is Outcome.REFINEMENT_LIMIT for a in answers])
        found |= {int(r): a for r, a, miss in zip(rows, answers, missed, strict=True) if not miss}
        if missed.sum() < LEAST_ROWS:
            break
        guess, rows = batch.rows(missed), rows[missed]
        tail, gap_tail = TIGHTER * tail, TIGHTER * gap_tail
    return found
