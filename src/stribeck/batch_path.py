"""Ways of many states at once: down from where the contact is rigid, or from one solved state to its neighbours.

The states of a batch take their steps together, on a mesh that resolves them all.  Meshes, predictions, observables and error
estimates are made by NumPy; Newton's iteration, which is most of the work, runs on the device.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._types import Array, Flags, Indices
from .batch_equations import Device, DeviceEquations, DeviceOperators, newton
from .contact_laws import contact_law
from .continuation import extrapolation_weights
from .equations import LOAD, Equations, Operators
from .estimate import ErrorEstimate, FineOperators, error_estimates
from .mesh import Mesh, MeshTooLargeError
from .observables import Observables, observables_of_rows
from .parameters import Groups
from .refine import mesh_tolerances_for, newton_tolerance, order_for
from .start import MESH_TOLERANCE, ORDER, RIGID_ROUGHNESS, RIGID_SPEED
from .states import LARGEST_AMPLIFICATION, PREDICTION_GOAL, Rows, RowsGuess, State, correction, mesh_for

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


def column_groups(groups: Groups, rows: Indices | Flags | slice = slice(None)) -> Groups:
    """Return some of the states of groups that are columns."""
    return Groups(*(np.asarray(getattr(groups, name))[rows] for name in ("speed", "load", "roughness")))


@dataclass(frozen=True, eq=False)
class Batch:
    """States in rows on one mesh: a guess for others.  The groups are columns."""

    groups: Groups
    mesh: Mesh
    y: Array

    @property
    def flux_gap(self) -> Array:
        """Flux gaps, a column."""
        return self.y[:, -1:]

    @property
    def offset(self) -> Array:
        """Offsets, a column."""
        return self.y[:, -2:-1]

    @property
    def least_position(self) -> Array:
        """The nodes where the gaps are least, a column."""
        return self.mesh.nodes[np.argmin(self.y[:, :-2], axis=1)][:, None]

    @cached_property
    def _nodal(self) -> Array:
        equations = Equations(Operators(self.mesh), self.groups.speed, contact_law(self.groups))
        return np.stack([np.log(self.y[:, :-2] / self.mesh.far), equations.pressures(self.y)[1]])

    def fields(self, x: Array) -> Array:
        """Return the logarithms of the gaps and the fluid pressures at ``x``."""
        found = self.mesh.interpolate(self._nodal, x)
        found[0] += np.log(self.mesh.scale**2 + x * x)
        return found

    def log_gap(self, mesh: Mesh) -> Array:
        """Return the logarithms of the gaps at the nodes of ``mesh``."""
        if mesh is self.mesh:
            return np.asarray(np.log(self.y[:, :-2]))
        return np.asarray(self.mesh.interpolate(self._nodal[0], mesh.nodes) + np.log(self.mesh.scale**2 + mesh.nodes**2))

    def rows(self, rows: Indices | Flags) -> Batch:
        """Return some of the states."""
        return Batch(column_groups(self.groups, rows), self.mesh, self.y[rows])


@dataclass(frozen=True, eq=False)
class Combined:
    """A guess from batches of the same states: the logarithms of gaps and flux gaps, and the pressures, summed."""

    weights: Array
    batches: Sequence[Batch]

    def _sum(self, value: Callable[[Batch], Array]) -> Array:
        return np.asarray(sum(w * value(b) for w, b in zip(self.weights, self.batches, strict=True)))

    @property
    def flux_gap(self) -> Array:
        """Flux gaps, a column."""
        return np.exp(self._sum(lambda b: np.log(b.flux_gap)))

    @property
    def offset(self) -> Array:
        """Those of the last batch; Newton's first step corrects them exactly."""
        return self.batches[-1].offset

    @property
    def least_position(self) -> Array:
        """Those of the last batch."""
        return self.batches[-1].least_position

    def fields(self, x: Array) -> Array:
        """Return the logarithms of the gaps and the fluid pressures at ``x``."""
        return self._sum(lambda b: b.fields(x))

    def log_gap(self, mesh: Mesh) -> Array:
        """Return the logarithms of the gaps at the nodes of ``mesh``."""
        return self._sum(lambda b: b.log_gap(mesh))


@dataclass(frozen=True, eq=False)
class RigidRows:
    """Rigid cylinders at columns of speed and height, see :class:`stribeck.start.RigidGuess`."""

    speed: Array
    height: Array

    @property
    def flux_gap(self) -> Array:
        """Flux gaps of the rigid parabola."""
        return 4 * self.height / 3

    @property
    def offset(self) -> Array:
        """The heights."""
        return self.height

    @property
    def least_position(self) -> Array:
        """The middle."""
        return np.zeros_like(self.height)

    def log_gap(self, mesh: Mesh) -> Array:
        """Return the logarithms of the gaps at the nodes of ``mesh``."""
        return np.asarray(self.fields(mesh.nodes)[0])

    def fields(self, x: Array) -> Array:
        """Return the logarithms of the gaps at ``x``."""
        b = np.sqrt(2 * self.height)
        deflection = -2 * self.speed / 3 * x / b / (x * x + b * b)
        return np.log(self.height + x * x / 2 + deflection)[None]


Guesses = Batch | Combined | RigidRows


def rigid_rows(groups: Groups) -> RigidRows:
    """Return the rigid parabolas whose film and contact carry the load, as ``start.rigid_guess`` does, by bisection."""
    speed, law = np.asarray(groups.speed), contact_law(groups)
    x, dx = np.linspace(-6, 6, 121, retstep=True)
    width = np.sqrt(law.decay)
    low, high = np.full_like(speed, -80.0), np.full_like(speed, 80.0)
    for _ in range(30):
        middle = 0.5 * (low + high)
        height = np.exp(middle)
        contact = law.pressure(height + (x * width) ** 2 / 2).sum(axis=1, keepdims=True) * dx * width
        carries = math.pi / 48 * speed**2 / height**3 + contact > LOAD
        low, high = np.where(carries, middle, low), np.where(carries, high, middle)
    return RigidRows(speed, np.exp(0.5 * (low + high)))


def unloading(groups: Groups) -> Array:
    """Return how far above their end the loading paths of states in rows begin, see :mod:`stribeck.start`; a column."""
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
    equations = DeviceEquations.of(DeviceOperators.of(Operators(mesh), device), groups, y[:, -1:])
    found, done, _ = newton(equations, y, tolerance)
    return Batch(groups, mesh, found), done, np.abs(y[:, :-2] / found[:, :-2] - 1).max(axis=1)


def predicted(history: Sequence[tuple[float, Batch]], s: float) -> Guesses:
    """Return the guess at ``s`` by the highest polynomial through ``history`` that does not amplify errors."""
    for first in range(len(history) - 1):
        points = history[first:]
        weights = extrapolation_weights([c for c, _ in points], s)
        if np.abs(weights).sum() <= LARGEST_AMPLIFICATION:
            return Combined(weights, [batch for _, batch in points])
    return history[-1][1]


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


def spread(pilot: State, groups: Groups) -> Batch:
    """Return guesses of the neighbours of a solved state, along its derivatives with respect to the logarithms of the groups."""
    factors = pilot.root.factors
    assert factors is not None
    y, equations = pilot.y, pilot.equations
    change = np.zeros((len(np.asarray(groups.speed)), len(y)))
    for name in ("speed", "load", "roughness"):
        here = float(getattr(pilot.groups, name))
        if here > 0:
            slope = correction(factors, equations.parameter_derivative(y, name))
            change += np.log(np.asarray(getattr(groups, name)) / here) * slope
    units = equations.units(y)
    guessed = units * np.exp(change)
    guessed[:, -2] = y[-2] + change[:, -2]
    return Batch(groups, pilot.mesh, guessed)


@dataclass(frozen=True, eq=False)
class Answer:
    """What a state of a batch came to: its observables and their error."""

    values: Observables
    estimate: ErrorEstimate


def judged(batch: Batch, device: Device) -> list[Answer]:
    """Return the observables of states and their errors, by the same estimate as any other state."""
    operators = Operators(batch.mesh)
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
    return [Answer(v, e) for v, e in zip(values, estimates, strict=True)]


def refined(guess: Batch, rtol: float, device: Device) -> dict[int, Answer]:
    """Return, by row of the guess, the states that hold the tolerance on a mesh that they share."""
    tail, gap_tail = mesh_tolerances_for(rtol)
    rows, found = np.arange(len(guess.y)), {}
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
        answers = judged(batch, device)
        missed = np.array([a.estimate.total > rtol for a in answers])
        found |= {int(r): a for r, a in zip(rows, answers, strict=True) if a.estimate.total <= rtol}
        if missed.sum() < LEAST_ROWS:
            break
        guess, rows = batch.rows(missed), rows[missed]
        tail, gap_tail = TIGHTER * tail, TIGHTER * gap_tail
    return found
