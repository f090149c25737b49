r"""Cold start: a first state for any groups, from a rigid cylinder by one path.

A fast enough film, or high enough asperities, hold the cylinder so far off that it hardly deforms: its gap is the parabola
:math:`h_0 + x^2/2`, and :math:`h_0` follows from one scalar equation.  From there the speed comes down, of a contact at rest
the roughness, with the solid and the exit of the model; of a rough contact under a light load, load and speed together, so
that asperities and film keep their balance.  Where the path begins, or else where it ends, the shape of the model
replaces the cylinder, and where it ends the fluid of the model the Newtonian one, along

.. math::

    G = (1 - t) \, G_\mathrm{Newton} + t \, G_\mathrm{film} , \qquad h_0 = (1 - t) \, x^2/2 + t \, g .

The formulas here only start Newton's iteration: no result depends on them.  Films that re-form come after these:
from a film with an exit, whose cavity reaches to infinity, by a path in its pressure.  The deeper the pressure of a cavity,
the shorter it is.  A long one hardly disturbs the film with the exit, behind which the suction that is needed to fill the gap
again says where the film reforms.
"""

import math
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import BASE_MODEL, Groups, Model, contact_law
from stribeck.equations.film import is_rough
from stribeck.equations.mesh_choice import mesh_for
from stribeck.equations.operators import LOAD, Operators
from stribeck.equations.state import MIN_GAP, Guess, State, extrapolate, solve_state
from stribeck.fluids.fluid import Cavitation
from stribeck.fluids.newtonian import Newtonian, blend
from stribeck.numerics.continuation import StepPath, Steps
from stribeck.numerics.newton import root_between
from stribeck.numerics.panels import Mesh, MeshTooLargeError
from stribeck.numerics.settings import (
    COARSE_ORDER,
    COARSE_RTOL,
    COARSE_STEP,
    HALF_DIGITS,
    MAX_REFINEMENTS,
    MAX_STEPS_ON_PATH,
    NEGLIGIBLE,
)
from stribeck.quantities.units import InputError

MAX_LOG_HEIGHT = 0.5 * math.log(sys.float_info.max)  # Of rigid films whose powers double precision holds


@dataclass(frozen=True)
class RigidGuess:
    """The gap of a rigid cylinder, with the deflection under the pressure of a film that does not end."""

    speed: float  # Speed group [-]
    offset: float  # Height of the cylinder [u_Hz]
    width: float  # Distance over which the gap doubles
    exit: float  # Where the pressure and its gradient vanish; zero of a film without an end
    flux_gap: float  # The gap where the pressure gradient vanishes [u_Hz]
    minimum_position: float  # Middle of the cylinder, seen from the exit
    cavity_stretch: float = 1.0  # That of a film which does not re-form
    reformation: float = math.inf  # That of a film which does not re-form

    def log_gap(self, mesh: Mesh) -> Array:
        """Return the logarithm of the gap at the nodes of ``mesh``."""
        return np.asarray(self.fields(mesh.nodes)[0])

    def fields(self, x: Array) -> Array:
        """Return the logarithm of the gap at ``x``: the fluid pressure is left to its gradient."""
        x, b = x + self.exit, self.width
        parabola = self.offset + x * x / 2
        deflection = 0.0 if self.exit else -2 * self.speed / 3 * x / b / (x * x + b * b)
        # Where asperities carry nearly all of a heavy load, the film's deflection may exceed the height.
        return np.asarray(np.log(np.maximum(parabola + deflection, NEGLIGIBLE * parabola))[None, :])


def _with_model(groups: Groups, **changes: Any) -> Groups:
    return replace(groups, model=replace(groups.model, **changes))


@cache
def rigid_exit() -> float:
    """Return the exit behind a rigid cylinder over the distance at which its gap doubles."""
    # With x = tan(angle) the pressure at the exit is the difference of two integrals of powers of the cosine.

    def pressure(angle: float) -> float:
        square = 0.5 * (angle + 0.5 * math.pi) + 0.25 * math.sin(2 * angle)
        fourth = 0.75 * square + 0.25 * math.sin(angle) * math.cos(angle) ** 3
        return square - fourth / math.cos(angle) ** 2

    angle = root_between(pressure, 0.0, 0.25 * math.pi, HALF_DIGITS)
    assert angle is not None
    return math.tan(angle)


def rigid_guess(groups: Groups) -> RigidGuess | None:
    r"""Return the rigid parabola whose film and contact carry the load; None if it is outside double precision.

    .. math:: \frac{\pi}{48} \frac{\lambda^2}{h_0^3} \quad \text{or, of a film that ends,} \quad
              \frac{\lambda}{2 h^*} , \qquad \text{and} \quad \int p_c(h_0 + x^2/2) \, dx \quad \text{add up to}
              \quad \frac{\pi}{2}
    """
    speed, law, ends = float(groups.speed), contact_law(groups), groups.model.cavitation is not Cavitation.NONE
    x, dx = np.linspace(-6, 6, 241, retstep=True)
    x, dx = x * math.sqrt(law.decay_length), dx * math.sqrt(law.decay_length)
    flux_ratio = 1 + rigid_exit() ** 2

    def log_excess(log_height: float) -> float:
        height = math.exp(log_height)
        film = speed / (height * math.sqrt(height))
        with np.errstate(all="ignore"):
            contact = float(law.pressure(height + x * x / 2).sum() * dx)
            carried = speed / (2 * flux_ratio * height) if ends else math.pi / 48 * film * film
            return float(np.log((carried + contact) / LOAD))

    log_height = root_between(log_excess, -MAX_LOG_HEIGHT, MAX_LOG_HEIGHT, NEGLIGIBLE * COARSE_RTOL)
    if log_height is None:
        return None
    height = math.exp(log_height)
    width = math.sqrt(2 * height)
    exit = rigid_exit() * width if ends else 0.0
    return RigidGuess(speed, height, width, exit, height * (flux_ratio if ends else 4 / 3), -exit)


def coarse_state(groups: Groups, guess: Guess) -> State | None:
    """Return the state on a coarse mesh that resolves it, from a guess; None where there is no such mesh."""
    state = _on_mesh_of_guess(groups, guess)
    if state is None or not state.outcome.ok or state.prediction_error <= 1.0:
        return state
    # The gap has more than doubled somewhere: the mesh, which is that of the guess, may have led to a false state.
    found = _on_mesh_of_guess(groups, state)
    if found is None or not found.prediction_error <= 1.0:
        return None
    return replace(found, prediction_error=state.prediction_error)


def coarse_path(
    groups_at: Callable[[float], Groups | None],
    start: float | tuple[float, State],
    end: float,
    seed: Callable[[Groups], State | None],
    seeds: int = 1,
    **options: float,
) -> StepPath[State]:
    """Return the path of coarse states to ``end``, whose first ``seeds`` states come from a seed."""

    def correct(s: float, history: Sequence[tuple[float, State]]) -> State | None:
        groups = groups_at(s)
        if groups is None:
            return None
        if len(history) < seeds:
            return seed(groups)
        found = coarse_state(groups, extrapolate(history, s))
        if len(history) > 2 and (found is None or not found.outcome.ok):  # a polynomial through many amplifies their errors
            found = coarse_state(groups, extrapolate(history[-2:], s))
        return found

    return Steps(correct, **options).to(end, start)


def _on_mesh_of_guess(groups: Groups, guess: Guess) -> State | None:
    """Return the state on a mesh that resolves its guess; None where that needs too many panels."""
    try:
        mesh = mesh_for(guess, groups, contact_law(groups), COARSE_ORDER, COARSE_RTOL, anew=False)
    except MeshTooLargeError:
        return None
    return solve_state(groups, Operators(mesh, groups.model), guess, COARSE_STEP, max_steps=MAX_STEPS_ON_PATH)


def cold_start(groups: Groups) -> StepPath[State]:
    """Return the path from the rigid cylinder to the coarse state of a Newtonian fluid."""
    if groups.model != BASE_MODEL:
        ends = groups.model.cavitation is not Cavitation.NONE and groups.speed > 0
        model = Model(
            cavitation=Cavitation.EXIT if ends else Cavitation.NONE, solid=groups.model.solid, profile=groups.model.profile
        )
        groups = replace(groups, model=replace(model, film=groups.model.film) if is_rough(groups.model.film) else model)
    kappa = float(groups.relative_roughness)
    name = "speed" if groups.speed > 0 else "roughness"
    # Of a heavier load, whose pressure is that of full contact, loading would cross the hand-over to the film.
    unloads = groups.speed > 0 and groups.load <= 1.0 and kappa > 0

    def place(part: float) -> float:
        """Return where the speed group or the relative roughness is at least one over a part."""
        up = max(0.0, -math.log(part * (float(groups.speed) or kappa)))
        return max(0.0, min(0.5 * up, -math.log(part * kappa))) if unloads else up

    def groups_at(log_factor: float) -> Groups | None:
        factor = math.exp(log_factor)
        with suppress(InputError):  # lifted out of the range of groups
            if unloads:
                return replace(groups, speed=groups.speed * factor**2, load=groups.load / factor)
            return replace(groups, **{name: factor * getattr(groups, name)})
        return None

    def seed(here: Groups) -> State | None:
        guess = rigid_guess(here)
        start = None if guess is None else coarse_state(_without_profile(here), guess)
        if start is None or not start.outcome.ok or here.model.profile.is_parabola:
            return start
        path = _to_profile(here, start)
        return path.states[-1] if path.outcome.ok else None

    # A cylinder farther off deforms less.
    return _with_seed(lambda part: coarse_path(groups_at, place(part), 0.0, seed))


def _with_seed(path: Callable[[float], StepPath[State]]) -> StepPath[State]:
    """Return the first path whose seed is found, as a function of the part of the disturbance that is left; else the last."""
    for k in range(MAX_REFINEMENTS):
        found = path(NEGLIGIBLE**k)
        if found.states:
            break
    return found


def first_path(groups: Groups) -> StepPath[State]:
    """Return the path from cold to a coarse state of ``groups``, whose film does not re-form."""
    path, film = _under_profile(groups), groups.model.film
    if not path.outcome.ok or film == Newtonian() or is_rough(film):
        return path
    start = path.states[-1]
    return _homotopy(start, lambda part: _with_model(start.groups, film=blend(film, part)))


def _under_profile(groups: Groups) -> StepPath[State]:
    """Return the path to a Newtonian film under the profile, which comes before the speed goes down, or else after it."""
    # A film that is thick beside a lip may end in several places, and the path from there may lead nowhere.
    path = cold_start(groups)
    if path.outcome.ok or groups.model.profile.is_parabola:
        return path
    plain = cold_start(_without_profile(groups))
    later = _to_profile(groups, plain.states[-1]) if plain.outcome.ok else plain
    return later if later.outcome.ok else path


def _without_profile(groups: Groups) -> Groups:
    """Return groups with the parabola in place of the profile."""
    profile = groups.model.profile
    return groups if profile.is_parabola else _with_model(groups, profile=profile.part(0.0))


def _to_profile(groups: Groups, start: State) -> StepPath[State]:
    """Return the path to the profile of groups from a state under the parabola."""
    base = start.groups
    return _homotopy(start, lambda part: _with_model(base, profile=groups.model.profile.part(part)))


def _homotopy(start: State, groups_at: Callable[[float], Groups]) -> StepPath[State]:
    """Return the path from a state of groups at zero to that at one."""
    return coarse_path(groups_at, (0.0, start), 1.0, lambda groups: None, 0, first=1.0)


def is_lost_to_rounding(path: StepPath[State]) -> bool:
    """Return whether a path ends before its end, at a film of which rounding leaves few digits."""
    return not path.outcome.ok and bool(path.states) and float(path.states[-1].gap.min()) < MIN_GAP


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

    # A longer cavity disturbs the film less.  Two seeds, as the frame moves with it: one state alone does not start another.
    end = place(groups.model.cavity_pressure)
    return _with_seed(lambda part: coarse_path(groups_at, place(-part * suction), end, seed, seeds=2))


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
