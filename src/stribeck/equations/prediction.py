"""The prediction of a state from others along a path."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.equations.guess import Guess
from stribeck.equations.state import State
from stribeck.numerics.continuation import steady_weights
from stribeck.numerics.panels import Mesh
from stribeck.numerics.settings import MAX_AMPLIFICATION
from stribeck.quantities.lazy import cached_property


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
