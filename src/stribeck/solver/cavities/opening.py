r"""Cold start of a cavity of the line: from the full film, or from a film that ends, by cavities of given length.

The shorter a cavity, the nearer its pressure to the largest suction of the full film; the longer, the nearer to zero.  Lengths
are tried until that pressure is the one asked for.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from stribeck.contacts.groups import contact_law
from stribeck.contacts.line import Groups
from stribeck.equations.cavities.of_length import solve_of_length
from stribeck.equations.line import Operators
from stribeck.equations.prediction import SeenFrom
from stribeck.equations.state import State, mesh_for
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.continuation import Path
from stribeck.numerics.panels import MeshTooLargeError
from stribeck.quantities.outcome import Outcome
from stribeck.solver.models.towards import (
    MESH_TOLERANCE,
    MOST_STEPS,
    NEWTON_TOLERANCE,
    ORDER,
    extended,
    paths_to_model,
    settled,
)

__all__ = ["paths_to_cavity", "ruptured"]

LOOKED_AT = 4001
"""Points at which the largest suction of the full film is searched, and lengths of cavities behind an exit."""

CAVITY_PARTS = (0.52, 0.75, 1.0, 2.0)
"""Lengths of a cavity over that of the stretch on which the suction of the full film is too large: half of it for a short
cavity, as the missing flow lowers the pressure behind it too."""

BEFORE_LOWEST = 0.03
"""Distance of the rupture from the place of the largest suction, over the length of the cavity."""

FIRST_SUCTION = 0.3
"""Largest first suction of the cavity behind an exit, over the largest with which a film could begin anew."""

LONGEST, SHORTEST = 0.7, 1e-4
"""Longest and shortest step in the logarithm of the length."""

FIRST_SLOPE, LEAST_SLOPE = -1.0, -0.1
"""First and smallest slope of the logarithm of the suction by that of the length."""

FEW_STEPS = 8
"""Newton steps after which a state lies on a mesh that was made for another: it is solved once more."""

NEAR = 0.02
"""Difference of the logarithms of two pressures between which Newton's iteration finds the length."""

MOST_LENGTHS = 20
"""Lengths after which a cavity is given up."""


def paths_to_cavity(groups: Groups, article: Callable[[Groups], Path[State]]) -> Iterator[Path[State]]:
    """Yield paths to a film that begins anew, as :func:`paths_to_model` does: each to its film that ends, then behind that."""
    ending = replace(groups.model, cavitation=Cavitation.EXIT, cavity_pressure=0.0)
    for path in paths_to_model(replace(groups, model=ending), article):
        found = _behind_exit(groups, path.states[-1]) if path.outcome.ok else None
        if found is not None:
            yield extended(path, found)
        else:
            yield replace(path, outcome=Outcome.PATH_LOST) if path.outcome.ok else path


def ruptured(groups: Groups, full: State) -> State | None:
    """Return a coarse state of groups whose film ruptures and begins anew, from that of their full film, or None."""
    pressure = groups.model.cavity_pressure
    x = np.sort(full.mesh.nodes)
    nodal = full.fields(x)[1]
    below = np.flatnonzero(nodal <= max(pressure, nodal.min()))
    x = np.linspace(x[max(below[0] - 1, 0)], x[min(below[-1] + 1, len(x) - 1)], LOOKED_AT)
    suction = full.fields(x)[1]
    between = x[suction < pressure]
    if not len(between):
        return None
    lowest, stretch = float(x[np.argmin(suction)]), float(between[-1] - between[0])
    for part in CAVITY_PARTS:
        length = part * stretch
        found = _of_pressure(groups, SeenFrom(full, lowest - BEFORE_LOWEST * length, length, pressure))
        if found is not None:
            return found
    return None


def _behind_exit(groups: Groups, state: State) -> State | None:
    """Return a coarse state of groups from that of their film that ends at ambient pressure, or None.

    That shows where it would begin anew: where the suction of the film behind equals that of the cavity.
    """
    distance = np.geomspace(1e-4, 1e4, LOOKED_AT) * math.sqrt(1.0 + float(state.gap.min()))
    gap = np.exp(state.fields(distance)[0])
    film, flux = state.equations.film, state.flux_gap
    slopes = film.gradient(gap, np.zeros_like(gap) if film.uses_pressure else None, flux) * float(groups.speed)
    cells = 0.5 * (slopes[1:] + slopes[:-1]) * np.diff(distance)
    suction = np.append(np.cumsum(cells[::-1])[::-1], 0.0)
    first = min(-groups.model.cavity_pressure, FIRST_SUCTION * float(suction.max()))
    length = float(distance[np.flatnonzero(suction >= first)[-1]])
    return _of_pressure(groups, SeenFrom(state, state.exit, length, -first))


def _of_pressure(groups: Groups, guess: SeenFrom) -> State | None:
    """Return a coarse state whose cavity has the pressure of the groups, from a guess with a cavity of some length."""
    wanted = math.log(-groups.model.cavity_pressure)
    lengths, pressures, exits = [], [], []
    last, step = None, 0.0
    for _ in range(MOST_LENGTHS):
        state = _of_length(groups, guess)
        if state is not None and state.root.steps > FEW_STEPS:
            state = _of_length(groups, SeenFrom(state, state.exit, guess.restart, state.groups.model.cavity_pressure))
        if state is not None and state.groups.model.cavity_pressure < 0:
            last = state
            lengths.append(math.log(guess.restart))
            pressures.append(math.log(-state.groups.model.cavity_pressure))
            exits.append(state.exit)
            missing = wanted - pressures[-1]
            if abs(missing) < NEAR and (found := settled(groups, state)) is not None:
                return found
            slope, drift = FIRST_SLOPE, 0.0
            if len(lengths) > 1:
                apart = lengths[-1] - lengths[-2]
                slope, drift = (pressures[-1] - pressures[-2]) / apart, (exits[-1] - exits[-2]) / apart
            step = missing / min(slope, LEAST_SLOPE)
            step = math.copysign(min(LONGEST, abs(step)), step)
        else:
            step *= 0.5
        if last is None or abs(step) < SHORTEST:
            return None
        length = math.exp(lengths[-1] + step)
        guess = SeenFrom(last, last.exit + drift * step, length, last.groups.model.cavity_pressure)
    return None


def _of_length(groups: Groups, guess: SeenFrom) -> State | None:
    """Return a coarse state with a cavity of the length of the guess, or None."""
    here = replace(groups, model=replace(groups.model, cavity_pressure=guess.cavity_pressure))
    try:
        mesh = mesh_for(guess, here, contact_law(here), ORDER, MESH_TOLERANCE, anew=False)
    except MeshTooLargeError:
        return None
    state = solve_of_length(here, Operators(mesh, here.model), guess, NEWTON_TOLERANCE, MOST_STEPS)
    return state if state.outcome.ok else None
