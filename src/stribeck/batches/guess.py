"""Guesses of many states in rows: from states on another mesh, from rigid cylinders, from one solved neighbour."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.contacts.groups import contact_law
from stribeck.contacts.line import Groups
from stribeck.equations.line import LOAD, Equations, Operators
from stribeck.equations.state import LARGEST_AMPLIFICATION, State, correction, factors_on
from stribeck.numerics.continuation import extrapolation_weights
from stribeck.numerics.panels import Mesh


def column_groups(groups: Groups, rows: Indices | Flags | slice = slice(None)) -> Groups:
    """Return some of the states of groups that are columns."""
    return Groups(*(np.asarray(getattr(groups, name))[rows] for name in ("speed", "load", "roughness")))


@dataclass(frozen=True, eq=False)
class Batch:
    """States in rows on one mesh: a guess for others.  The groups are columns."""

    groups: Groups
    operators: Operators
    y: Array

    @property
    def mesh(self) -> Mesh:
        """The mesh."""
        return self.operators.mesh

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
        return np.asarray(self.mesh.nodes[np.argmin(self.y[:, :-2], axis=1)][:, None])

    @cached_property
    def _nodal(self) -> Array:
        equations = Equations(self.operators, self.groups.speed, contact_law(self.groups))
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
        return Batch(column_groups(self.groups, rows), self.operators, self.y[rows])


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
    """Rigid cylinders at columns of speed and height, see :class:`stribeck.solver.cold_start.RigidGuess`."""

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
        return np.asarray(np.log(self.height + x * x / 2 + deflection)[None])


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


def predicted(history: Sequence[tuple[float, Batch]], s: float) -> Guesses:
    """Return the guess at ``s`` by the highest polynomial through ``history`` that does not amplify errors."""
    for first in range(len(history) - 1):
        points = history[first:]
        weights = extrapolation_weights([c for c, _ in points], s)
        if np.abs(weights).sum() <= LARGEST_AMPLIFICATION:
            return Combined(weights, [batch for _, batch in points])
    return history[-1][1]


def spread(pilot: State, groups: Groups) -> Batch:
    """Return guesses of the neighbours of a solved state, along its derivatives by the logarithms of the groups."""
    y, equations = pilot.y, pilot.equations
    factors = factors_on(equations.operators, pilot)  # as those of Newton's last steps are of an earlier iterate
    change = np.zeros((len(np.asarray(groups.speed)), len(y)))
    for name in ("speed", "load", "roughness"):
        here = float(getattr(pilot.groups, name))
        if here > 0:
            slope = correction(factors, equations.parameter_derivative(y, name))
            change += np.log(np.asarray(getattr(groups, name)) / here) * slope
    units = equations.units(y)
    guessed = units * np.exp(change)
    guessed[:, -2] = y[-2] + change[:, -2]
    return Batch(groups, equations.operators, guessed)
