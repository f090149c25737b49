r"""Cold start of a cavity of the line: from a film with an exit, whose cavity reaches to infinity, by a path in its pressure.

The deeper the pressure of a cavity, the shorter it is.  A long one hardly disturbs the film with the exit, behind which the
suction that is needed to fill the gap again says where the film reforms.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups
from stribeck.equations.state import State
from stribeck.fluids.fluid import Cavitation
from stribeck.numerics.continuation import StepPath
from stribeck.numerics.settings import COARSE_ORDER, MAX_REFINEMENTS, NEGLIGIBLE
from stribeck.solver.cold_start import coarse_path, coarse_state, first_path

__all__ = ["path_to_cavity"]


@dataclass(frozen=True)
class LongCavity:
    """The guess of a film with a cavity: that of a film with an exit, whose cavity is as long as given."""

    state: State
    reformation: float  # Length of the cavity [a]
    cavity_pressure: float  # [p_Hz]
    cavity_stretch: float = 1.0

    def __getattr__(self, name: str) -> Any:
        """Return any other number of the film with an exit."""
        return getattr(self.state, name)

    def fields(self, x: Array) -> Array:
        """Return the logarithm of the gap and the fluid pressure at ``x``."""
        found = self.state.fields(x)
        found[1] = np.where((x > 0) & (x < self.reformation), self.cavity_pressure, found[1])
        return found


def path_to_cavity(groups: Groups, deepest: float = -math.inf) -> StepPath[State]:
    """Return the path to a film that reforms; ``deepest`` is the lowest pressure of the full film, which closes the cavity."""
    path = first_path(replace(groups, model=replace(groups.model, cavitation=Cavitation.EXIT, cavity_pressure=0.0)))
    if not path.outcome.ok:
        return path
    ending, suction = path.states[-1], -groups.model.cavity_pressure

    # The length of a cavity is about a power of its suction, and where it closes of what the suction falls short of the
    # largest: both are linear in the logarithm of their quotient.
    def place(pressure: float) -> float:
        return math.log(-pressure) - math.log1p(-pressure / deepest)

    def groups_at(s: float) -> Groups:
        return replace(groups, model=replace(groups.model, cavity_pressure=-1 / (math.exp(-s) - 1 / deepest)))

    def seed(here: Groups) -> State | None:
        return coarse_state(here, _behind_exit(ending, -here.model.cavity_pressure))

    for _ in range(MAX_REFINEMENTS):  # a longer cavity disturbs the film less
        # Two seeds, as the frame moves with the cavity: one state alone does not start another.
        found = coarse_path(groups_at, place(-suction), place(groups.model.cavity_pressure), seed, seeds=2)
        if found.states:
            break
        suction *= NEGLIGIBLE
    return found


def _behind_exit(state: State, suction: float) -> LongCavity:
    """Return the guess of a cavity so long that the film with an exit, at its flux, reforms there with a suction."""
    nodes, film = state.mesh.nodes, state.equations.film
    x = np.geomspace(nodes[nodes > 0].min(), nodes.max(), COARSE_ORDER * state.mesh.size)
    gap = np.exp(state.fields(x)[0])
    slopes = film.gradient(gap, np.zeros_like(gap) if film.uses_pressure else None, state.flux_gap)
    cells = 0.5 * float(state.groups.speed) * (slopes[1:] + slopes[:-1]) * np.diff(x)
    # Far out the gradient falls with a power of the distance, and so does the suction that is needed from there on.
    power = math.log(slopes[-2] / slopes[-1]) / math.log(x[-1] / x[-2]) - 1
    beyond = float(state.groups.speed) * slopes[-1] * x[-1] / power
    needed = beyond + np.append(np.cumsum(cells[::-1])[::-1], 0.0)
    if suction < beyond:
        length = x[-1] * (beyond / suction) ** (1 / power)
    else:
        falls = np.argmax(needed)
        length = float(np.interp(-suction, -needed[falls:], x[falls:]))
    return LongCavity(state, length, -suction)
