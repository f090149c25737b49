r"""Cold start of models other than the article's: from its state, one part of the model after the other.

The path of loads has the solid of the model.  First the film ends, where the pressure of the full film falls to zero.  Then
the fluid of the model replaces the Newtonian one, at once if Newton's iteration converges, else along

.. math::

    G = (1 - t) \, G_\mathrm{Newton} + t \, G_\mathrm{film} .

Films that re-form behind a cavity come after these, see
:mod:`stribeck.solver.cavities.cavity_length`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from stribeck.contacts.groups import Groups, contact_law
from stribeck.contacts.model import Model
from stribeck.equations.cavities.fixed_exit import distance_to_flux_gap, solve_at_fixed_exit
from stribeck.equations.guess import Guess
from stribeck.equations.line import Operators
from stribeck.equations.prediction import Extrapolation, SeenFrom, extrapolate
from stribeck.equations.state import MIN_GAP, State, mesh_for, solve_state
from stribeck.fluids.blend import blend
from stribeck.fluids.cavitation import Cavitation
from stribeck.fluids.newtonian import Newtonian
from stribeck.numerics.continuation import Path, Steps, march
from stribeck.numerics.panels import MeshTooLargeError
from stribeck.numerics.settings import COARSE_ORDER, COARSE_RTOL, COARSE_STEP, MAX_STEPS
from stribeck.quantities.outcome import Outcome

__all__ = ["coarse_state", "with_final_state", "paths_to_model"]

# Newton steps with a free exit after which films with a fixed exit are solved instead: more steps oscillate.
MAX_STEPS_FREE_BOUNDARY = 15
MAX_STEPS_FIXED_BOUNDARY = 25  # Newton steps after which a film with a fixed exit is given up
MAX_EXITS = 15  # Fixed exits that are tried before the exit is given up
MAX_FAILED_EXITS = 2  # Fixed exits without a state in a row before the exit is given up
MAX_EXIT_STEP_WIDTHS = 0.3  # Longest step of a fixed exit over the width of contact and film
SCAN_POINTS = 4001  # Points at which the zero of the full film's pressure is searched
MIN_EXIT_WIDTHS = 0.4  # Smallest distance of a first exit from the middle over the width of contact and film
# First, longest and shortest step in the part of the fluid's own gradient; if the state at once is a false one, step by step.
BLEND_STEPS = (Steps(1.0, 1.0, 1e-3), Steps(0.25, 1.0, 1e-3))
MAX_PATH_WORK = 3000.0  # Newton steps of 300 unknowns after which a path is given up; the longest of 200 random ones took 2100
WORK_UNIT_UNKNOWNS = 300.0  # Unknowns of a Newton step that counts as one unit of work


Correct = Callable[[float, Sequence[tuple[float, State]]], State | None]
"""A corrector of :func:`march`: a state at a coordinate from those before, or None."""


def paths_to_model(groups: Groups, article: Callable[[Groups], Path[State]]) -> Iterator[Path[State]]:
    """Yield paths whose last state, where they arrive, is a first, coarse one of the groups and their model."""
    path, state = _newtonian_start(groups, article)
    if state is None:
        yield replace(path, outcome=path.outcome if not path.outcome.ok else Outcome.PATH_LOST)
    elif groups.model.film == Newtonian():
        yield _resolve_on_adapted_mesh(with_final_state(path, state))
    else:
        for steps in BLEND_STEPS:
            yield _resolve_on_adapted_mesh(_follow_homotopy(groups, state, steps))


def is_lost_to_rounding(path: Path[State]) -> bool:
    """Return whether a path ends before its end, at a film of which rounding leaves few digits."""
    return not path.outcome.ok and bool(path.states) and float(path.states[-1].gap.min()) < MIN_GAP


def _newtonian_start(groups: Groups, article: Callable[[Groups], Path[State]]) -> tuple[Path[State], State | None]:
    """Return the path from cold with the fluid of the article on the solid of the groups, and its end or None."""
    # Films that end are found also from the last state of a path that was lost to the suction of the full film.
    solid = groups.model.solid
    path = article(replace(groups, model=Model(solid=solid)))
    if groups.model.cavitation is not Cavitation.NONE and groups.speed > 0 and path.states:
        return path, _start_with_exit(replace(groups, model=Model(cavitation=Cavitation.EXIT, solid=solid)), path)
    return path, path.states[-1] if path.outcome.ok else None


def with_final_state(path: Path[State], state: State) -> Path[State]:
    """Return a path that arrives, with one more state at its end."""
    states, coordinates = (*path.states, state), (*path.coordinates, path.coordinates[-1])
    return replace(path, coordinates=coordinates, states=states, outcome=Outcome.CONVERGED)


def coarse_state(groups: Groups, guess: Guess) -> State | None:
    """Return a coarse state from a guess, or None."""
    ends = groups.model.cavitation is Cavitation.EXIT
    operators = _operators(groups, guess)
    if operators is None:
        return None
    if not ends:
        return solve_state(groups, operators, guess, COARSE_STEP, MAX_STEPS)
    state = solve_state(groups, operators, guess, COARSE_STEP, MAX_STEPS_FREE_BOUNDARY)
    return state if state.outcome.ok else _search_exit(groups, guess, state)


def _resolve_on_adapted_mesh(path: Path[State]) -> Path[State]:
    """Return a path whose last state, where it arrives, is solved once more on a mesh made for it."""
    # On the mesh of its guess a film that ends may be another than that of finer meshes.
    again = coarse_state(path.states[-1].groups, path.states[-1]) if path.outcome.ok else None
    return path if again is None or not again.outcome.ok else with_final_state(path, again)


def _operators(groups: Groups, guess: Guess) -> Operators | None:
    """Return the operators of a mesh for a guess, or None if that needs too many panels."""
    # Predictions from panels that lie elsewhere in the contact are uneven, which may ask for more panels than there are.
    shapes: tuple[Guess, ...] = (guess, guess.states[-1]) if isinstance(guess, Extrapolation) else (guess,)
    for shape in shapes:
        try:
            mesh = mesh_for(shape, groups, contact_law(groups), COARSE_ORDER, COARSE_RTOL, anew=False)
        except MeshTooLargeError:
            continue
        return Operators(mesh, groups.model)
    return None


def _search_exit(groups: Groups, guess: Guess, failed: State) -> State:
    """Return a coarse state from films with fixed exits, or the failed one with a free exit, with the Newton steps of all."""
    last, step, spent, bounds, missed = None, 0.0, failed.root.steps, [-math.inf, math.inf], 0
    for _ in range(MAX_EXITS):
        operators = _operators(groups, guess)
        if operators is None:
            break
        held, free = solve_at_fixed_exit(groups, operators, guess, COARSE_STEP, MAX_STEPS_FIXED_BOUNDARY)
        spent += held.root.steps
        if held.root.outcome.ok:
            last, missed, step = held, 0, float(free[held.equations.layout.exit.start])
            if held.equations.admissible(held.y, free) == 1.0:
                found = solve_state(groups, operators, held, COARSE_STEP, MAX_STEPS_FREE_BOUNDARY)
                spent += found.root.steps
                if found.outcome.ok:
                    failed = found
                    break
            to_flux = distance_to_flux_gap(held)
            bounds[int(to_flux < 0)] = held.exit
            step = step if step * to_flux > 0 else to_flux
            if not bounds[0] < held.exit + step < bounds[1]:
                step = 0.5 * (bounds[0] + bounds[1]) - held.exit
            longest = MAX_EXIT_STEP_WIDTHS * math.sqrt(1.0 + float(held.gap.min()))
            step = math.copysign(min(abs(step), longest), step)
        else:
            missed, step = missed + 1, 0.5 * step
        if last is None or missed > MAX_FAILED_EXITS or not math.isfinite(step):
            break
        guess = SeenFrom(last, last.exit + step)
    return replace(failed, root=replace(failed.root, steps=spent))


def _start_with_exit(groups: Groups, full: Path[State]) -> State | None:
    """Return the state whose film ends, from that of the full film."""
    found = coarse_state(groups, _guess_at_zero_crossing(full.states[-1]))
    return found if found is not None and found.outcome.ok else None


def _guess_at_zero_crossing(state: State) -> SeenFrom:
    """Return the guess of a film that ends where the pressure of the full film falls to zero behind its maximum."""
    width = math.sqrt(1.0 + float(state.gap.min()))
    nodes = state.mesh.nodes
    x = np.union1d(np.linspace(-2 * width, 2 * width, SCAN_POINTS), nodes[np.abs(nodes) < 2 * width])
    pressure = state.fields(x)[1]
    highest = int(np.argmax(pressure))
    behind = highest + np.flatnonzero(pressure[highest:] <= 0)
    if not len(behind):
        return SeenFrom(state, width)
    end = np.linspace(x[behind[0] - 1], x[behind[0]], SCAN_POINTS)
    return SeenFrom(state, max(float(end[np.argmax(state.fields(end)[1] <= 0)]), MIN_EXIT_WIDTHS * width))


def _follow_homotopy(groups: Groups, start: State, steps: Steps) -> Path[State]:
    """Return the path on which the fluid changes into that of the groups."""

    def correct(part: float, history: Sequence[tuple[float, State]]) -> State | None:
        here = replace(groups, model=replace(start.groups.model, film=blend(groups.model.film, part)))
        return coarse_state(here, extrapolate(history, part) if history else start)

    return march(_limit_work(correct), 0.0, 1.0, steps, history=[(0.0, start)])


def _limit_work(correct: Correct) -> Correct:
    """Return a corrector that gives up when all its solves together have taken as much work as a path may."""
    spent = 0.0

    def limited(s: float, history: Sequence[tuple[float, State]]) -> State | None:
        nonlocal spent
        state = None if spent >= MAX_PATH_WORK else correct(s, history)
        if state is not None:
            spent += state.root.steps * (state.mesh.size / WORK_UNIT_UNKNOWNS) ** 2
        return state

    return limited
