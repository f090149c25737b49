r"""Cold start: a first state for any groups, by loading the contact from where the elastic body hardly deforms.

Lifting the load of a sliding cylinder by a factor s multiplies the speed group by :math:`s^2`, divides the load group by s
and keeps the roughness group.  Far enough up this path the gap is the parabola :math:`h_0 + x^2/2`, with the small
deflection under the pressure of a rigid film; :math:`h_0` follows from one scalar equation.  From there the path comes down.
The formulas here only start Newton's iteration: no result depends on them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stribeck._types import Array
from stribeck.contacts.groups import Groups, contact_law
from stribeck.contacts.model import BASE_MODEL
from stribeck.equations.guess import Guess
from stribeck.equations.line import LOAD, Operators
from stribeck.equations.prediction import extrapolate
from stribeck.equations.state import State, mesh_for, solve_state
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.continuation import Path, Steps, march
from stribeck.numerics.panels import Mesh, MeshTooLargeError
from stribeck.numerics.settings import COARSE_ORDER, COARSE_RTOL, COARSE_STEP
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.units import InputError
from stribeck.solver.cavities.cavity_length import paths_to_cavity
from stribeck.solver.homotopy import paths_to_model

MIN_RIGID = 30.0  # Speed group or relative roughness above which the rigid cylinder starts Newton's iteration safely
MAX_RIGID_LOG_FACTOR = 0.7  # Logarithm of the factor of the load within which the rigid film or contact is tried too
# Load group above which the contact pressure nears its largest value: the path then comes down in speed, as loading at low
# speed would cross the sudden hand-over from asperities to film.
MIN_SATURATED_LOAD = 0.5
MAX_LOG_HEIGHT = 400.0  # Logarithm of the largest height of a rigid film, and of 1 over the smallest, in double precision
MAX_NEWTON_STEPS = 600  # Newton steps after which a path is given up; none of 200 random states takes more than 300


@dataclass(frozen=True)
class RigidGuess:
    """The gap of a rigid cylinder with the deflection under its rigid-film pressure."""

    speed: float  # Speed group [-]
    offset: float  # Height of the cylinder [u_Hz]
    flux_gap: float  # Flux gap of the rigid parabola, 4/3 of its height [u_Hz]
    minimum_position: float = 0.0  # Those of a full film: a rigid film is the guess of no other [a]
    exit: float = 0.0  # Those of a full film: a rigid film is the guess of no other [a]
    cavity_stretch: float = 1.0  # Those of a full film: a rigid film is the guess of no other [a]
    reformation: float = math.inf  # Those of a full film: a rigid film is the guess of no other [a]

    def log_gap(self, mesh: Mesh) -> Array:
        """Return the logarithm of the gap at the nodes of ``mesh``."""
        return np.asarray(self.fields(mesh.nodes)[0])

    def fields(self, x: Array) -> Array:
        """Return the logarithm of the gap at ``x``: the fluid pressure is left to its gradient."""
        b = math.sqrt(2 * self.offset)
        deflection = -2 * self.speed / 3 * x / b / (x * x + b * b)
        parabola = self.offset + x * x / 2
        # Where asperities carry nearly all of a heavy load, the film's deflection may exceed the height.
        return np.asarray(np.log(np.maximum(parabola + deflection, 0.1 * parabola))[None, :])


def unloaded(groups: Groups, log_factor: float) -> Groups:
    """Return the groups with the load divided by ``exp(log_factor)``, all else fixed."""
    factor = math.exp(log_factor)
    return replace(groups, speed=groups.speed * factor * factor, load=groups.load / factor)


def faster(groups: Groups, log_factor: float) -> Groups:
    """Return the groups with the speed times ``exp(2 log_factor)``, all else fixed."""
    return replace(groups, speed=groups.speed * math.exp(2 * log_factor))


def rigid_guess(groups: Groups) -> RigidGuess | None:
    r"""Return the rigid parabola whose film and contact carry the load; None if it is outside double precision.

    .. math:: \frac{\pi}{48} \frac{\lambda^2}{h_0^3}
              + \int p_c(h_0 + x^2/2) \, dx = \frac{\pi}{2}
    """
    speed, law = float(groups.speed), contact_law(groups)
    x, dx = np.linspace(-6, 6, 241, retstep=True)
    x, dx = x * math.sqrt(law.decay_length), dx * math.sqrt(law.decay_length)

    low, high = -MAX_LOG_HEIGHT, MAX_LOG_HEIGHT
    while high - low > 1e-6:  # the load falls with the height, and scipy.optimize takes longer to import than a solve
        middle = 0.5 * (low + high)
        height = math.exp(middle)
        with np.errstate(over="ignore"):
            contact = float(law.pressure(height + x * x / 2).sum() * dx)
        film = min(speed / (height * math.sqrt(height)), 1e6)
        low, high = (middle, high) if math.pi / 48 * film * film + contact > LOAD else (low, middle)
    if low == -MAX_LOG_HEIGHT or high == MAX_LOG_HEIGHT:
        return None
    height = math.exp(0.5 * (low + high))
    return RigidGuess(speed, height, 4 * height / 3)


def cold_start(groups: Groups) -> Path[State]:
    """Return the path from the rigid contact to ``groups``; its last state is a first, coarse solution."""
    kappa = float(groups.relative_roughness)
    by_speed = groups.speed > 0 and groups.load > MIN_SATURATED_LOAD and kappa < MIN_RIGID
    along = faster if by_speed else unloaded
    factors = []
    if groups.speed > 0:
        factors.append(0.5 * math.log(MIN_RIGID / groups.speed))
    if kappa > 0 and not by_speed:
        factors.append(math.log(MIN_RIGID / kappa))
    top = max(0.0, min(factors))
    steps = 0

    def correct(log_factor: float, history: Sequence[tuple[float, State]]) -> State | None:
        nonlocal steps
        if steps > MAX_NEWTON_STEPS:
            return None
        try:
            here = along(groups, log_factor)
        except InputError:  # lifted out of the range of groups
            return None
        rigid = top - log_factor < MAX_RIGID_LOG_FACTOR and len(history) < 3
        guess: Guess | None = rigid_guess(here) if rigid else extrapolate(history, log_factor)
        if guess is None:
            return None
        try:
            mesh = mesh_for(guess, here, contact_law(here), COARSE_ORDER, COARSE_RTOL)
        except MeshTooLargeError:
            return None
        state = solve_state(here, Operators(mesh, here.model), guess, COARSE_STEP)
        steps += state.root.steps
        return state

    if 0.0 < top < MAX_RIGID_LOG_FACTOR:
        direct = correct(0.0, ())
        if direct is not None and direct.outcome.ok:
            return Path((0.0,), (direct,), Outcome.CONVERGED, None)
    first = correct(top, ())
    known = [] if first is None or not first.outcome.ok else [(top, first)]
    return march(correct, top, 0.0, Steps(0.6, 2.5, 1e-3), history=known)


def first_path(groups: Groups) -> Path[State]:
    """Return the first path from cold that arrives at ``groups``, or the last that does not."""
    for path in first_paths(groups):
        if path.outcome.ok:
            break
    return path


def first_paths(groups: Groups) -> Iterator[Path[State]]:
    """Yield paths from cold to ``groups``: with the model of the article one, with others by several ways."""
    if groups.model != BASE_MODEL:
        ways = paths_to_cavity if groups.model.cavitation is Cavitation.REFORM else paths_to_model
        yield from ways(groups, cold_start)
    else:
        yield cold_start(groups)
