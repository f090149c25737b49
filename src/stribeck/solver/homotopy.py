r"""Cold start of models other than the article's: from its state, one part of the model after the other.

The path of loads has the solid of the model, if it reaches the state with it.  First the film ends: where the pressure of the
full film falls to zero, or as under a rigid parabola.  Then the fluid of the model replaces the Newtonian one, and its solid
the half-plane if need be, in one step if Newton's iteration converges, else down from a larger speed, or along

.. math::

    G = (1 - t) \, G_\mathrm{Newton} + t \, G_\mathrm{film}, \qquad
    D = (1 - t) \, D_\mathrm{half-plane} + t \, D_\mathrm{solid} .

In a fluid that thins the Newtonian part falls exponentially, as films that thin much do with it; not where roughness hinders
the flow, whose films would lose it at once.  Films that re-form behind a cavity come after these, see
:mod:`stribeck.solver.cavities.cavity_length`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.contacts.groups import contact_law
from stribeck.contacts.line import Groups
from stribeck.contacts.model import BASE_MODEL, Model
from stribeck.equations.cavities.fixed_exit import distance_to_flux_gap, solve_at_fixed_exit
from stribeck.equations.guess import Guess
from stribeck.equations.line import Operators
from stribeck.equations.prediction import Extrapolation, SeenFrom, extrapolate
from stribeck.equations.state import MIN_GAP, State, is_thinning, mesh_for, solve_state
from stribeck.fluids.cavitation import Cavitation
from stribeck.fluids.fluid import Film, Slopes
from stribeck.fluids.newtonian import Newtonian
from stribeck.numerics.continuation import Path, Steps, march
from stribeck.numerics.panels import Mesh, MeshTooLargeError
from stribeck.quantities.outcome import Outcome
from stribeck.solids.half_plane import HalfPlane
from stribeck.solids.solid import Lengths, Solid, lengths_of

__all__ = ["extended", "paths_to_model", "settled"]

ORDER = 10
MESH_TOLERANCE = 1e-3
NEWTON_TOLERANCE = 1e-5
MOST_STEPS = 100

# The same where the exit is free: what takes more goes to and fro, and the exit is sought by states with given ones.
FREE_STEPS = 15

HELD_STEPS = 25  # The same with an exit that is given

# Exits that are tried, those without a state in a row, and how far apart in units of the width of contact and film.
MOST_EXITS, MOST_MISSED, FARTHEST_EXIT = 15, 2, 0.3

# Relative change of the gap from its guess above which a state is one only if a mesh made for it holds it too.
FAR_FROM_GUESS = 1.0

# Relative change of the gap from one mesh to the one made for its state up to which both are the same state: on coarse meshes
# the exit of a film that carries little may be wrong by many of the film's own lengths.
SETTLED = 0.2

ORDER_TO_SETTLE, TOLERANCE_TO_SETTLE = 12, 1e-4  # Nodes per panel and tolerance of the meshes where these differ

LOOKED_AT = 4001  # Points at which the end of the full film is searched

NEAREST_EXIT = 0.4  # No film ends within this part of the half-width from the middle

BLENDING = Steps(1.0, 1.0, 1e-3)

# Newton steps of so many unknowns after which a path is given up; one of 200 random states takes 2100, most below 100.
MOST_WORK, UNIT_SIZE = 3000.0, 300.0

FADING = 8.0  # Logarithmic decay of the Newtonian part of a blend with a fluid that thins, as films are powers of that part


@dataclass
class Work:
    """Newton steps of :data:`UNIT_SIZE` unknowns that may be taken, and those that were."""

    most: float
    spent: float = 0.0

    @property
    def is_done(self) -> bool:
        """Whether no more may be taken."""
        return self.spent >= self.most


Correct = Callable[[float, Sequence[tuple[float, State]]], State | None]
"""What :func:`march` asks for a state."""


@dataclass(frozen=True)
class BlendedFilm:
    """A film whose gradient lies between that of a Newtonian fluid and its own."""

    film: Film
    part: float
    plain: Film = Newtonian()

    @property
    def name(self) -> str:
        """That of the film."""
        return self.film.name

    @property
    def parameters(self) -> dict[str, float | str]:
        """Those of the film."""
        return self.film.parameters

    @property
    def uses_pressure(self) -> bool:
        """Whether the film's gradient depends on the pressure."""
        return self.film.uses_pressure

    def at(self, speed: Numbers) -> BlendedFilm:
        """Return the blend at a speed."""
        return replace(self, film=self.film.at(speed))

    def gradient(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Array:
        """Return the weighted mean of both gradients."""
        own = self.film.gradient(gap, pressure, flux_gap)
        return np.asarray((1 - self.part) * self.plain.gradient(gap, None, flux_gap) + self.part * own)

    def slopes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Slopes:
        """Return the weighted mean of their derivatives."""
        plain, own = self.plain.slopes(gap, None, flux_gap), self.film.slopes(gap, pressure, flux_gap)
        return Slopes(
            (1 - self.part) * plain.by_gap + self.part * own.by_gap,
            None if own.by_pressure is None else self.part * own.by_pressure,
            (1 - self.part) * plain.by_flux + self.part * own.by_flux,
        )

    def __getattr__(self, name: str) -> object:
        """Return other attributes of the film: a blend is used for its gradient only."""
        return getattr(self.film, name)


@dataclass(frozen=True)
class BlendedSolid:
    """A solid whose deflection lies between that of the half-plane and its own."""

    solid: Solid
    part: float
    plain: Solid = HalfPlane()

    @property
    def name(self) -> str:
        """That of the solid."""
        return self.solid.name

    @property
    def parameters(self) -> dict[str, float | str]:
        """Those of the solid."""
        return self.solid.parameters

    @property
    def lengths(self) -> Lengths:
        """Those of the solid."""
        return lengths_of(self.solid)

    def deflection(self, mesh: Mesh) -> Array:
        """Return the weighted mean of both."""
        return np.asarray((1 - self.part) * self.plain.deflection(mesh) + self.part * self.solid.deflection(mesh))

    def far_gap(self, x: Array) -> Array:
        """Return the weighted mean of both."""
        return (1 - self.part) * self.plain.far_gap(x) + self.part * self.solid.far_gap(x)


def _blend(film: Film, part: float) -> Film:
    plain = (1 - part) * (math.exp(-FADING * part) if is_thinning(film) else 1.0)
    return cast(Film, BlendedFilm(film, 1 - plain))


def _milder(film: Film, part: float) -> Film:
    return film.milder(part)


def paths_to_model(groups: Groups, article: Callable[[Groups], Path[State]]) -> Iterator[Path[State]]:
    """Yield paths whose last state, where they arrive, is a first, coarse one of the groups and their model."""
    model, solid = groups.model, groups.model.solid
    path, state = _newtonian(groups, article, solid)
    if state is None and not isinstance(solid, HalfPlane):
        solid = BASE_MODEL.solid
        path, state = _newtonian(groups, article, solid)
    if state is None:
        yield replace(path, outcome=path.outcome if not path.outcome.ok else Outcome.PATH_LOST)
    elif model.film == Newtonian() and model.solid == solid:
        yield extended(path, state)
    else:
        for film_at in (_blend, _milder):
            yield _blended(groups, path, state, film_at)


def is_lost_to_rounding(path: Path[State]) -> bool:
    """Return whether a path ends before its end, at a film of which rounding leaves few digits."""
    return not path.outcome.ok and bool(path.states) and float(path.states[-1].gap.min()) < MIN_GAP


def _newtonian(groups: Groups, article: Callable[[Groups], Path[State]], solid: Solid) -> tuple[Path[State], State | None]:
    """Return the path from cold with the fluid of the article on a solid, and its end; None where it was not reached.

    A film that ends may be found from states before the one at which the path of the full film was lost to its suction.
    """
    path = article(replace(groups, model=Model(solid=solid)))
    if groups.model.cavitation is not Cavitation.NONE and groups.speed > 0 and path.states:
        return path, _ended(replace(groups, model=Model(cavitation=Cavitation.EXIT, solid=solid)), path)
    return path, path.states[-1] if path.outcome.ok else None


def extended(path: Path[State], state: State) -> Path[State]:
    """Return a path that arrives, with one more state at its end."""
    states, coordinates = (*path.states, state), (*path.coordinates, path.coordinates[-1])
    return replace(path, coordinates=coordinates, states=states, outcome=Outcome.CONVERGED)


def _coarse(groups: Groups, guess: Guess, order: int = ORDER, tolerance: float = MESH_TOLERANCE) -> State | None:
    """Return a coarse state from a guess, or None."""
    ends = groups.model.cavitation is Cavitation.EXIT
    operators = _operators(groups, guess, order, tolerance)
    if operators is None:
        return None
    if not ends:
        return solve_state(groups, operators, guess, NEWTON_TOLERANCE, MOST_STEPS)
    state = solve_state(groups, operators, guess, NEWTON_TOLERANCE, FREE_STEPS)
    return state if state.outcome.ok else _with_exit_sought(groups, guess, state, order, tolerance)


def _operators(groups: Groups, guess: Guess, order: int, tolerance: float) -> Operators | None:
    """Return the operators of a mesh for a guess, or None if that needs too many panels."""
    # Predictions from panels that lie elsewhere in the contact are uneven, which may ask for more panels than there are.
    shapes: tuple[Guess, ...] = (guess, guess.states[-1]) if isinstance(guess, Extrapolation) else (guess,)
    for shape in shapes:
        try:
            mesh = mesh_for(shape, groups, contact_law(groups), order, tolerance, anew=False)
        except MeshTooLargeError:
            continue
        return Operators(mesh, groups.model)
    return None


def _with_exit_sought(groups: Groups, guess: Guess, failed: State, order: int, tolerance: float) -> State:
    """Return a coarse state from a guess, by states whose exit is given; the one that failed with a free exit if that fails.

    Its Newton steps are those of all.
    """
    last, step, spent, bounds, missed = None, 0.0, failed.root.steps, [-math.inf, math.inf], 0
    for _ in range(MOST_EXITS):
        operators = _operators(groups, guess, order, tolerance)
        if operators is None:
            break
        held, free = solve_at_fixed_exit(groups, operators, guess, NEWTON_TOLERANCE, HELD_STEPS)
        spent += held.root.steps
        if held.root.outcome.ok:
            last, missed, step = held, 0, float(free[held.equations.layout.exit.start])
            if held.equations.admissible(held.y, free) == 1.0:
                found = solve_state(groups, operators, held, NEWTON_TOLERANCE, FREE_STEPS)
                spent += found.root.steps
                if found.outcome.ok:
                    failed = found
                    break
            to_flux = distance_to_flux_gap(held)
            bounds[int(to_flux < 0)] = held.exit
            step = step if step * to_flux > 0 else to_flux
            if not bounds[0] < held.exit + step < bounds[1]:
                step = 0.5 * (bounds[0] + bounds[1]) - held.exit
            longest = FARTHEST_EXIT * math.sqrt(1.0 + float(held.gap.min()))
            step = math.copysign(min(abs(step), longest), step)
        else:
            missed, step = missed + 1, 0.5 * step
        if last is None or missed > MOST_MISSED or not math.isfinite(step):
            break
        guess = SeenFrom(last, last.exit + step)
    return replace(failed, root=replace(failed.root, steps=spent))


def settled(groups: Groups, guess: Guess) -> State | None:
    """Return a coarse state on a mesh made for it, or None; one of a finer mesh where the coarse ones disagree."""
    found = None
    for order, tolerance in ((ORDER, MESH_TOLERANCE), (ORDER_TO_SETTLE, TOLERANCE_TO_SETTLE)):
        state = _coarse(groups, guess, order, tolerance)
        again = None if state is None or not state.outcome.ok else _coarse(groups, state, order, tolerance)
        if again is None or not again.outcome.ok:
            break
        found = again
        if again.prediction_error <= SETTLED:
            break
    return found


def _ended(groups: Groups, full: Path[State]) -> State | None:
    """Return the state whose film ends, from that of the full film."""
    return settled(groups, _seen_from_exit(full.states[-1]))


def _seen_from_exit(state: State) -> SeenFrom:
    """Return the guess of a film that ends where the pressure of the full film falls to zero behind its maximum."""
    width = math.sqrt(1.0 + float(state.gap.min()))
    nodes = state.mesh.nodes
    x = np.union1d(np.linspace(-2 * width, 2 * width, LOOKED_AT), nodes[np.abs(nodes) < 2 * width])
    pressure = state.fields(x)[1]
    highest = int(np.argmax(pressure))
    behind = highest + np.flatnonzero(pressure[highest:] <= 0)
    if not len(behind):
        return SeenFrom(state, width)
    end = np.linspace(x[behind[0] - 1], x[behind[0]], LOOKED_AT)
    return SeenFrom(state, max(float(end[np.argmax(state.fields(end)[1] <= 0)]), NEAREST_EXIT * width))


def _blended(groups: Groups, path: Path[State], start: State, film_at: Callable[[Film, float], Film]) -> Path[State]:
    """Return the path on which fluid and solid change into those of the groups, at once if Newton's iteration converges."""
    own, plain = groups.model, start.groups.model

    def correct(part: float, history: Sequence[tuple[float, State]]) -> State | None:
        film: Film = own.film
        solid: Solid = own.solid
        if part < 1.0:
            film = film_at(film, part) if film != plain.film else film
            solid = cast(Solid, BlendedSolid(own.solid, part)) if own.solid != plain.solid else solid
        here = replace(groups, model=replace(plain, film=film, solid=solid))
        state = _coarse(here, extrapolate(history, part) if history else start)
        if state is None or not state.outcome.ok or state.prediction_error <= FAR_FROM_GUESS:
            return state
        return _coarse(here, state)

    found = march(_within(correct, Work(MOST_WORK)), 0.0, 1.0, BLENDING, history=[(0.0, start)])
    again = settled(found.states[-1].groups, found.states[-1]) if found.outcome.ok else None
    return found if again is None else extended(found, again)


def _within(correct: Correct, work: Work) -> Correct:
    """Return a corrector that gives up when all its solves together have taken that much work."""

    def limited(s: float, history: Sequence[tuple[float, State]]) -> State | None:
        state = None if work.is_done else correct(s, history)
        if state is not None:
            work.spent += state.root.steps * (state.mesh.size / UNIT_SIZE) ** 2
        return state

    return limited
