"""Discrete states: the unknowns on a mesh, guesses of them, and Newton's iteration that finds them.

A state knows its groups, its equations and the Newton iteration that made it.  Between meshes the logarithm of the
gap over ``scale**2 + x**2``, which is smooth and bounded on the whole line, and the fluid pressure are interpolated.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.polynomial import legendre

from stribeck._types import Array
from stribeck.contacts.groups import Groups, contact_law
from stribeck.equations.film import is_thinning
from stribeck.equations.gap import minimum_gap
from stribeck.equations.line import Equations
from stribeck.equations.operators import Operators
from stribeck.numerics.continuation import steady_weights
from stribeck.numerics.newton import Inverse, Root, StepControl, root_find
from stribeck.numerics.panels import Mesh, reference
from stribeck.numerics.settings import (
    COARSE_STEP,
    HALF_DIGITS,
    MAX_AMPLIFICATION,
    MAX_STEPS,
    NEGLIGIBLE,
    ROUNDING,
    SAFETY,
)
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome


class Guess(Protocol):
    """A guessed state, on the whole line."""

    @property
    def flux_gap(self) -> float:
        """Guess of the flux gap."""

    @property
    def offset(self) -> float:
        """Guess of the offset."""

    @property
    def exit(self) -> float:
        """Guess of the exit, from which x is measured if the film has a free one."""

    @property
    def cavity_stretch(self) -> float:
        """Guess of stretch of the cavity, one if the film does not re-form."""

    @property
    def reformation(self) -> float:
        """Coordinate at which the film re-forms; infinite if it does not."""

    @property
    def minimum_position(self) -> float:
        """Approximate position of the minimum gap."""

    def log_gap(self, mesh: Mesh) -> Array:
        """Return the logarithm of the gap at the nodes of ``mesh``."""

    def fields(self, x: Array) -> Array:
        """Return the logarithm of the gap and, if known, the fluid pressure at ``x``, shape (1 or 2, len(x))."""


# Gap from which rounding is more than the steps by which coarse states are found [u_Hz].
MIN_GAP = ROUNDING / COARSE_STEP


@dataclass(frozen=True, eq=False)
class State:
    """A solution of the discrete equations, or the last iterate towards one."""

    groups: Groups  # Scalar groups
    equations: Equations  # The discrete problem
    y: Array  # Gap at the nodes, offset, flux gap
    root: Root  # The Newton iteration that ended here
    prediction_error: float  # Largest relative change of the gap from its guess

    @property
    def mesh(self) -> Mesh:
        """The mesh of the state."""
        return self.equations.operators.mesh

    @property
    def gap(self) -> Array:
        """Gap at the nodes [u_Hz]."""
        return self.y[self.equations.layout.gap]

    @property
    def offset(self) -> float:
        """Offset z0 [u_Hz]."""
        return float(self.y[self.equations.layout.offset.start])

    @property
    def flux_gap(self) -> float:
        """Flux gap h* [u_Hz]."""
        return float(self.y[self.equations.layout.flux_gap.start])

    @property
    def exit(self) -> float:
        """Exit of the film, from which x is measured; zero without one [a]."""
        layout = self.equations.layout
        return float(self.y[layout.exit.start]) if self.equations.operators.has_exit else 0.0

    @property
    def cavity_stretch(self) -> float:
        """Stretch of the cavity; one if the film does not re-form."""
        layout = self.equations.layout
        return float(self.y[layout.cavity_stretch.start]) if self.equations.operators.has_reformation else 1.0

    @property
    def reformation(self) -> float:
        """Coordinate of the mesh at which the film re-forms; infinite if it does not."""
        return self.mesh.reformation

    @cached_property
    def minimum_position(self) -> float:
        """Where the gap is at its minimum, between the nodes: the lowest node may be on the panel beside."""
        return minimum_gap(self.mesh, self.gap)[0]

    @property
    def outcome(self) -> Outcome:
        """Outcome of the Newton iteration, where one stopped by rounding counts as converged."""
        # A film that ends at ambient pressure and has suction before its exit has been taken past its end: it is none.
        found = Outcome.CONVERGED if self.root.outcome is Outcome.ROUNDING else self.root.outcome
        return Outcome.STALLED if found.ok and self._sucks else found

    @cached_property
    def _sucks(self) -> bool:
        """Whether a film that ends at ambient pressure sucks before, and no pressure rises again between suction and end."""
        operators = self.equations.operators
        if not operators.has_exit or operators.has_reformation:
            return False
        # Of a full film both are alike.  A film between two constrictions may suck: no air gets there.
        pressure = self.fluid_pressure[: -self.mesh.order]
        suction, behind = -SAFETY * pressure.min(), pressure[np.argmin(pressure) :].max()
        return bool(suction > pressure.max() and behind < NEGLIGIBLE * suction)

    def corrected(self) -> State:
        """Return the state after one more Newton step, with the inverse of the Jacobian where that began."""
        inverse, r = self.equations.inverse(self.y), self.root.residual
        y = self.y + self.equations.units(self.y) * inverse(self.equations.residual(self.y) if r is None else r)
        return replace(self, y=y, root=replace(self.root, x=y, residual=None, inverse=inverse))

    def without_inverse(self) -> State:
        """Return the state without Newton's last inverse, which is as large as an operator and serves only its neighbour."""
        return replace(self, root=replace(self.root, inverse=None))

    def correction(self, residuals: Array) -> Array:
        """Return the changes of the unknowns that remove small residuals, by Newton's last inverse."""
        assert self.root.inverse is not None
        return np.asarray(self.equations.units(self.y) * self.root.inverse(residuals))

    @property
    def effort(self) -> float:
        """Measure of the work by which :class:`continuation.StepPath` steers; 4 for a cubic prediction as good as wanted."""
        return 4.0 + 0.5 * math.log2(max(SAFETY * self.prediction_error, HALF_DIGITS))

    @cached_property
    def _log_gap(self) -> Array:
        return np.log(self.gap)

    @cached_property
    def shape(self) -> Array:
        """Logarithm of the gap over ``scale**2 + x**2`` at the nodes: what the panels interpolate."""
        return np.log(self.gap / self.mesh.far)

    @cached_property
    def fluid_pressure(self) -> Array:
        """Fluid pressure at the nodes [p_Hz]."""
        return self.equations.fluid_pressure(self.y)

    @property
    def lowest_pressure(self) -> float:
        """Lowest fluid pressure, also between the nodes [p_Hz]."""
        pressure, order = self.fluid_pressure, self.mesh.order
        first = int(np.argmin(pressure)) // order * order
        series = reference(order).to_legendre @ pressure[first : first + order]
        turns = legendre.legroots(legendre.legder(series))
        inside = turns.real[np.isreal(turns) & (np.abs(turns) <= 1)]
        return float(min(pressure.min(), legendre.legval(inside, series).min(initial=np.inf)))

    @cached_property
    def _nodal(self) -> Array:
        """Nodal fields of this state as a guess for others: :attr:`shape` and fluid pressure."""
        return np.stack([self.shape, self.fluid_pressure])

    @cached_property
    def _on_other_mesh(self) -> dict[Mesh, Array]:
        return {}

    def log_gap(self, mesh: Mesh) -> Array:
        """Return the logarithm of the gap at the nodes of ``mesh``; that on the mesh last asked for is kept."""
        if mesh is self.mesh:
            return self._log_gap
        if mesh not in self._on_other_mesh:
            shape = self.mesh.interpolate(self.shape, self._on_panels(mesh.nodes))
            self._on_other_mesh.clear()
            self._on_other_mesh[mesh] = shape + np.log(self.mesh.scale**2 + mesh.nodes**2)
        return self._on_other_mesh[mesh]

    def fields(self, x: Array) -> Array:
        """Return the logarithm of the gap and the fluid pressure at ``x``."""
        found = self.mesh.interpolate(self._nodal, self._on_panels(x))
        found[0] += np.log(self.mesh.scale**2 + x * x)
        return found

    def _on_panels(self, x: Array) -> Array:
        """Return the coordinates at which the panels have what is at ``x``: they have kinks of the shape where they end."""
        places, origin = self.equations.operators.model.profile.places, self.mesh.origin
        if not places.size:
            return x
        passed = (places - origin) * (places - self.exit) <= 0  # by the exit
        known = np.append(places[~passed], self.exit)
        at = np.argsort(known)
        moved = np.append(np.full(len(known) - 1, self.exit - origin), 0.0)
        return np.asarray(x + np.interp(x, known[at] - self.exit, moved[at]))


def unknowns_of(equations: Equations, guess: Guess) -> Array:
    """Return the unknowns of a guess on the mesh of ``equations``."""
    if isinstance(guess, State) and guess.equations.operators is equations.operators:
        return guess.y.copy()
    mesh, at = equations.operators.mesh, equations.layout
    same = guess.reformation == mesh.reformation
    nodes = mesh.nodes if same else mesh.nodes * (guess.reformation / mesh.reformation)
    y = np.empty(at.size)
    y[at.gap] = np.exp(guess.log_gap(mesh) if same else guess.fields(nodes)[0])
    y[at.offset], y[at.flux_gap], y[at.exit] = guess.offset, guess.flux_gap, guess.exit
    y[at.cavity_stretch] = guess.cavity_stretch if same else guess.cavity_stretch * guess.reformation / mesh.reformation
    if at.pressure.start < at.pressure.stop:
        fields = guess.fields(nodes)
        y[at.pressure] = fields[1] if len(fields) == 2 else 0.0
    return y


def solve_state(
    groups: Groups,
    operators: Operators,
    guess: Guess,
    tolerance: float,
    kept: Inverse | None = None,
    max_steps: int = MAX_STEPS,
) -> State:
    """Return the state of the discrete equations on the mesh of ``operators`` nearest to ``guess``."""
    # ``kept`` is a neighbour's inverse on the same mesh, used while the steps contract with it.
    equations = Equations(operators, float(groups.speed), contact_law(groups), guess.flux_gap**2)
    start = unknowns_of(equations, guess)
    thinnest = float(start[equations.layout.gap].min())
    if thinnest < MIN_GAP:  # steps of that size are rounding
        tolerance = max(tolerance, min(ROUNDING / thinnest, NEGLIGIBLE))
    # Where a wall is not sheared the viscosity of a thinning fluid turns sharply: full steps may go to and fro.
    control = StepControl(tolerance, max_steps, NEGLIGIBLE, monotone=is_thinning(equations.film))
    root = root_find(equations, start, control, kept)
    gap = equations.layout.gap
    with np.errstate(all="ignore"):  # a root that was not found need not be finite
        error = float(np.abs(start[gap] / root.x[gap] - 1).max())
    return State(groups, equations, root.x, root, error)


@dataclass(frozen=True, eq=False)
class Extrapolation:
    """A guess from the states before it along a path."""

    weights: Array
    states: Sequence[State]

    @property
    def flux_gap(self) -> float:
        """Extrapolated in its logarithm, or as it is if it is not positive everywhere."""
        if min(s.flux_gap for s in self.states) <= 0:
            return float(sum(w * s.flux_gap for w, s in zip(self.weights, self.states, strict=True)))
        return math.exp(sum(w * math.log(s.flux_gap) for w, s in zip(self.weights, self.states, strict=True)))

    @property
    def offset(self) -> float:
        """Offset of the last state: Newton's first step corrects it exactly."""
        return self.states[-1].offset

    @cached_property
    def exit(self) -> float:
        """Extrapolated as it is."""
        return float(sum(w * s.exit for w, s in zip(self.weights, self.states, strict=True)))

    @cached_property
    def _in_place(self) -> bool:
        """Whether gaps are extrapolated at fixed places of the contact."""
        # The edge of a contact of asperities, and a kink of the shape, stay where they are while the exit moves through them.
        before, last = self.states[-2:]
        if not last.equations.operators.has_exit:
            return False
        if last.equations.operators.model.profile.places.size:
            return True
        x = last.mesh.nodes
        in_frame, in_place = (
            np.abs(before.fields(at)[0] - last.log_gap(last.mesh)).max()
            for at in (self._in_frame(before, x), _at_place(last, before, x))
        )
        return bool(in_place < in_frame)

    @property
    def reformation(self) -> float:
        """Edge of the last state's mesh at which the film re-forms."""
        return self.states[-1].reformation

    @property
    def cavity_stretch(self) -> float:
        """Stretch of the cavity, extrapolated in its logarithm."""
        if self.reformation == math.inf:
            return 1.0
        lengths = [math.log(s.cavity_stretch * s.reformation) for s in self.states]
        return math.exp(sum(w * length for w, length in zip(self.weights, lengths, strict=True))) / self.reformation

    @property
    def minimum_position(self) -> float:
        """Position of the minimum gap of the last state."""
        return self.states[-1].minimum_position

    def log_gap(self, mesh: Mesh) -> Array:
        """Return the logarithm of the gap at the nodes of ``mesh``."""
        if self._in_place or any(s.reformation != self.reformation for s in self.states):
            return np.asarray(self.fields(mesh.nodes)[0])
        log_gap = np.zeros(mesh.size)
        for w, s in zip(self.weights, self.states, strict=True):
            log_gap += w * s.log_gap(mesh)
        return log_gap

    def fields(self, x: Array) -> Array:
        """Return the logarithm of the gap and the fluid pressure at ``x``."""
        fields = np.zeros((2, x.size))
        for w, s in zip(self.weights, self.states, strict=True):
            fields += w * s.fields(self._in_frame(s, x))
        if self._in_place:  # the pressure has kinks where the film ends and begins
            fields[0] = sum(w * s.fields(_at_place(self, s, x))[0] for w, s in zip(self.weights, self.states, strict=True))
        return fields

    def _in_frame(self, state: State, x: Array) -> Array:
        """Return coordinates in the frame of a state whose cavity may have another length on its mesh."""
        return x if state.reformation == self.reformation else x * (state.reformation / self.reformation)


def _at_place(one: Guess, other: Guess, x: Array) -> Array:
    """Return the coordinates in the frame of another film of the places in the contact that ``x`` are in the frame of one."""
    return (one.exit + one.cavity_stretch * x - other.exit) / other.cavity_stretch


def extrapolate(history: Sequence[tuple[float, State]], s: float) -> Guess:
    """Return the guess at coordinate ``s`` by the highest polynomial through ``history`` that does not amplify errors."""
    weights = steady_weights([c for c, _ in history], s, MAX_AMPLIFICATION)
    states = [state for _, state in history[len(history) - len(weights) :]]
    return Extrapolation(weights, states) if len(states) > 1 else states[0]
