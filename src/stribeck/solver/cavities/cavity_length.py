r"""Cold start of a cavity of the line: from the full film, or from a film that ends, by cavities of given length.

The shorter a cavity, the nearer its pressure to the largest suction of the full film; the longer, the nearer to zero.  Lengths
are tried until that pressure is the one asked for.  The first is that of Reynolds' equation in the gap of the full film, which
hardly changes where asperities or the elastic body hold it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups, contact_law
from stribeck.equations.cavities.fixed_cavity_length import solve_of_length
from stribeck.equations.line import Operators
from stribeck.equations.prediction import SeenFrom
from stribeck.equations.state import State, mesh_for
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.continuation import Path
from stribeck.numerics.panels import MeshTooLargeError
from stribeck.numerics.settings import COARSE_ORDER, COARSE_RTOL, COARSE_STEP, MAX_STEPS
from stribeck.quantities.outcome import Outcome
from stribeck.solver.homotopy import coarse_state, paths_to_model, with_final_state

__all__ = ["paths_to_cavity", "cavitated_start"]

SCAN_POINTS = 4001  # Lengths of cavities behind an exit that are compared
POINTS_PER_NODE = 8  # Resolution at which a cavity is sought in the gap of the full film
MAX_BISECTIONS = 50  # Bisections of the flux with which a cavity is sought in the gap of the full film
FIRST_SUCTION_RATIO = 0.3  # First suction of the cavity behind an exit over the largest with which the film could reform
MAX_LOG_LENGTH_STEP = 0.7  # Longest step in the logarithm of a cavity's length
MIN_LOG_LENGTH_STEP = 1e-4  # Step in the logarithm of a cavity's length below which it is given up
FIRST_LOG_SLOPE = -1.0  # First slope of ln suction by ln length behind an exit
MAX_LOG_SLOPE = -0.01  # Slope of ln suction by ln length that is at least assumed: suction falls with the length
REMESH_AFTER_STEPS = 8  # Newton steps after which a state is solved once more on a mesh adapted to it
FREE_LENGTH_LOG_PRESSURE = 0.02  # Log pressure difference below which the length becomes an unknown of Newton's iteration
MAX_LENGTHS = 20  # Lengths tried before a cavity is given up


def paths_to_cavity(groups: Groups, article: Callable[[Groups], Path[State]]) -> Iterator[Path[State]]:
    """Yield paths to a film that reforms, each through its film with an exit."""
    ending = replace(groups.model, cavitation=Cavitation.EXIT, cavity_pressure=0.0)
    for path in paths_to_model(replace(groups, model=ending), article):
        found = _start_behind_exit(groups, path.states[-1]) if path.outcome.ok else None
        if found is not None:
            yield with_final_state(path, found)
        else:
            yield replace(path, outcome=Outcome.PATH_LOST) if path.outcome.ok else path


def cavitated_start(groups: Groups, full: State) -> State | None:
    """Return a coarse state with a cavity from the full film of the same groups, or None."""
    found = _cavity_in_gap(groups, full)
    return None if found is None else _find_length(groups, *found, full.lowest_pressure)


def _cavity_in_gap(groups: Groups, full: State) -> tuple[SeenFrom, float] | None:
    """Return the cavity in the gap of the full film and its slope of ln suction by ln length, or None."""
    # The film ruptures where the pressure no longer falls, at the flux that gives it the cavity pressure there; it reforms
    # where the pressure, integrated from behind at that flux, has fallen as far.
    nodes, film, wanted = full.mesh.nodes[: -full.mesh.order], full.equations.film, groups.model.cavity_pressure
    x = np.interp(np.arange(0, nodes.size - 1, 1 / POINTS_PER_NODE), np.arange(nodes.size), nodes)
    log_gap, pressure = full.fields(x)
    gap, inlet = np.exp(log_gap), int(np.argmax(pressure))

    def changes(flux_gap: float) -> Array:
        slopes = film.gradient(gap, pressure if film.uses_pressure else None, flux_gap) * float(groups.speed)
        return np.asarray(0.5 * (slopes[1:] + slopes[:-1]) * np.diff(x))

    def rupture(flux_gap: float) -> tuple[int, float]:
        change = changes(flux_gap)
        falling = inlet + int(np.argmax(change[inlet:] < 0))
        at = falling + int(np.argmax(change[falling:] > 0))
        return at, float(pressure[0] + change[:at].sum())

    low, high = float(gap.min()), full.flux_gap
    for _ in range(MAX_BISECTIONS):
        flux_gap = 0.5 * (low + high)
        low, high = (flux_gap, high) if rupture(flux_gap)[1] > wanted else (low, flux_gap)
    at = rupture(flux_gap)[0]
    from_behind = pressure[-1] - np.cumsum(changes(flux_gap)[::-1])[::-1]
    fallen = at + np.flatnonzero(from_behind[at:] <= wanted)
    if not len(fallen):
        return None
    end = int(fallen[-1])
    length, change = float(x[end + 1] - x[at]), float(changes(flux_gap)[end])
    return SeenFrom(full, float(x[at]), length, wanted, flux=flux_gap), change / float(x[end + 1] - x[end]) * length / wanted


def _start_behind_exit(groups: Groups, state: State) -> State | None:
    """Return a coarse state with a cavity from the film with an exit at ambient pressure, or None."""
    # The film reforms about where the suction of the film behind the exit equals that of the cavity.
    distance = np.geomspace(1e-4, 1e4, SCAN_POINTS) * math.sqrt(1.0 + float(state.gap.min()))
    gap = np.exp(state.fields(distance)[0])
    film, flux = state.equations.film, state.flux_gap
    slopes = film.gradient(gap, np.zeros_like(gap) if film.uses_pressure else None, flux) * float(groups.speed)
    cells = 0.5 * (slopes[1:] + slopes[:-1]) * np.diff(distance)
    suction = np.append(np.cumsum(cells[::-1])[::-1], 0.0)
    first = min(-groups.model.cavity_pressure, FIRST_SUCTION_RATIO * float(suction.max()))
    length = float(distance[np.flatnonzero(suction >= first)[-1]])
    return _find_length(groups, SeenFrom(state, state.exit, length, -first), FIRST_LOG_SLOPE)


def _find_length(groups: Groups, guess: SeenFrom, slope: float, deepest: float = -math.inf) -> State | None:
    """Return a coarse state whose cavity has the required pressure, from a guess with some length, or None."""
    # ``slope`` is about that of ln suction by ln length; ``deepest`` is the lowest pressure of the full film, from which that
    # of a short cavity differs as the square of its length.

    def place(pressure: float) -> float:
        return math.log(-pressure) - math.log1p(-pressure / deepest)

    wanted = place(groups.model.cavity_pressure)
    slope /= 1.0 - groups.model.cavity_pressure / deepest
    lengths, pressures, exits = [], [], []
    last, step, drift = None, 0.0, 0.0
    for _ in range(MAX_LENGTHS):
        state = _solve_at_length(groups, guess)
        if state is not None and state.root.steps > REMESH_AFTER_STEPS:
            pressure = state.groups.model.cavity_pressure
            state = _solve_at_length(groups, SeenFrom(state, state.exit, guess.reformation, pressure))
        if state is not None and deepest < state.groups.model.cavity_pressure < 0:
            last = state
            lengths.append(math.log(guess.reformation))
            pressures.append(place(state.groups.model.cavity_pressure))
            exits.append(state.exit)
            missing = wanted - pressures[-1]
            found = coarse_state(groups, state) if abs(missing) < FREE_LENGTH_LOG_PRESSURE else None
            if found is not None and found.outcome.ok:
                return found
            if len(lengths) > 1:
                apart = lengths[-1] - lengths[-2]
                slope, drift = (pressures[-1] - pressures[-2]) / apart, (exits[-1] - exits[-2]) / apart
            step = missing / min(slope, MAX_LOG_SLOPE)
            step = math.copysign(min(MAX_LOG_LENGTH_STEP, abs(step)), step)
            short = max((a for a, p in zip(lengths, pressures, strict=True) if p > wanted), default=-math.inf)
            long = min((a for a, p in zip(lengths, pressures, strict=True) if p <= wanted), default=math.inf)
            if not short < lengths[-1] + step < long:
                step = 0.5 * (short + long) - lengths[-1]
        else:
            step *= 0.5
        if last is None or abs(step) < MIN_LOG_LENGTH_STEP:
            return None
        length = math.exp(lengths[-1] + step)
        guess = SeenFrom(last, last.exit + drift * step, length, last.groups.model.cavity_pressure)
    return None


def _solve_at_length(groups: Groups, guess: SeenFrom) -> State | None:
    """Return a coarse state whose cavity has the length of the guess, or None."""
    here = replace(groups, model=replace(groups.model, cavity_pressure=guess.cavity_pressure))
    try:
        mesh = mesh_for(guess, here, contact_law(here), COARSE_ORDER, COARSE_RTOL, anew=False)
    except MeshTooLargeError:
        return None
    state = solve_of_length(here, Operators(mesh, here.model), guess, COARSE_STEP, MAX_STEPS)
    return state if state.outcome.ok else None
