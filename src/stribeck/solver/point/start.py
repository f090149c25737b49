"""Cold start of the point contact: a first, coarse state anywhere.

A dry contact in which a cushion, as thick as the film, helps the asperities has about the shape of the lubricated one, and
the pressure of the cushion is the first guess of the film pressure.  So elastic shape and load hold from the beginning.
If Newton's iteration does not converge from there, the speed comes up from the dry contact, or down from a rigid ball.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stribeck._types import Array
from stribeck.contact_laws.law import ContactLaw
from stribeck.contacts.model import BASE_MODEL, Model
from stribeck.equations.point.dry import dry_contact
from stribeck.equations.point.mesh_choice import (
    MeshTooLargeError,
    Resolution,
    film_scale,
    film_speed,
    gaps_at,
    is_too_thin,
    layout,
    operators_of,
    resolution,
    split_where_poor,
)
from stribeck.equations.point.system import Unknowns
from stribeck.numerics.continuation import Steps, extrapolation_weights, march
from stribeck.quantities.outcome import Outcome
from stribeck.solver.point.level import Level, extrapolate_levels, solve_level

DEGREE = 8  # Degree of the panels of a first state

TOLERANCE = 1e-4  # Relative error of the gap that its iteration may leave

# Angular modes of the first trial: the steps cost as their square, and a state on few shows how many more it needs.
FEW_MODES = 16

MAX_STEPS = 25  # Newton steps after which a first guess is given up

CUSHION_STEEPNESS = 4.0  # Film thickness over the decay of the cushion that stands for the film in a first guess

MIN_RIGID_SPEED = 30.0  # Least speed at which the path from the rigid ball begins

MIN_DRY_SPEED_RATIO = 1e-3  # Least speed at which the path from the dry contact begins, over the speed of the state

MAX_PANEL_SPLITS = 8  # Most times that the panels of a first guess are split

HOMOTOPY_STEPS = Steps(0.5, 0.5, 1e-3, order=2, aim=3.0)  # Steps in the part of the fluid's own law

MAX_STATES = 60  # States of a path after which it is given up


def first_modes(speed: float, law: ContactLaw, model: Model) -> int:
    """Return the number of angular modes of a first state."""
    width, _ = layout(speed, law, model)
    film = film_scale(film_speed(speed, model))
    return int(min(40, max(8, round(1.2 * (width / 0.6) ** -0.6)))) if film > _dry_gap(law) else 8


def _dry_gap(law: ContactLaw) -> float:
    """Return an estimate of the central gap of the dry contact."""
    return float(gaps_at(law, np.zeros(1))[0]) if float(np.max(law.decay_length)) > 0 else 0.0


@dataclass(frozen=True)
class WithCushion:
    """A contact law, and a cushion that gives way at a film thickness, as a film does."""

    law: ContactLaw
    film: float
    name: str = "with cushion"
    constant_decay: bool = False

    @property
    def decay_length(self) -> float:
        """The longer of the two decays."""
        return max(float(np.max(self.law.decay_length)), self.film / CUSHION_STEEPNESS)

    def cushion(self, gap: Array) -> Array:
        """Return the pressure of the cushion, one at the film thickness."""
        return np.asarray(np.exp(CUSHION_STEEPNESS * (1.0 - gap / self.film)))

    def pressure(self, gap: Array) -> Array:
        """Return the sum of both pressures."""
        return self.law.pressure(gap) + self.cushion(gap)

    def log_pressure(self, gap: Array) -> Array:
        """Return its logarithm."""
        return np.asarray(np.logaddexp(self.law.log_pressure(gap), CUSHION_STEEPNESS * (1.0 - gap / self.film)))

    def slope(self, gap: Array, pressure: Array) -> Array:
        """Return its derivative."""
        del pressure
        return self.law.slope(gap, self.law.pressure(gap)) - CUSHION_STEEPNESS / self.film * self.cushion(gap)

    def local_decay_length(self, gap: Array) -> Array:
        """Return the length over which it falls by a factor e."""
        with np.errstate(all="ignore"):
            decay = np.asarray(self.pressure(gap) / -self.slope(gap, gap))
        return np.where(np.isfinite(decay), decay, self.decay_length)

    def load_derivative(self, gap: Array, pressure: Array) -> Array:
        """Refuse: no group moves a first guess."""
        raise NotImplementedError

    roughness_derivative = load_derivative


def first_guess(
    found: Resolution, speed: float, law: ContactLaw, thickness_ratio: float = 1.0
) -> tuple[Resolution, Unknowns] | None:
    """Return the first guess and a mesh for it; None if the dry contact fails."""
    cushioned = WithCushion(law, thickness_ratio * film_scale(film_speed(speed, found.model)))
    for _ in range(MAX_PANEL_SPLITS):
        solved, operators = found, operators_of(found)
        dry = dry_contact(operators, cushioned, 1e-6)
        if not dry.outcome.ok or not dry.gap.min() > 0:
            return None
        fluid = cushioned.cushion(dry.gap)
        better = split_where_poor(found, operators.mesh, fluid, law.pressure(dry.gap))
        if better == found:
            break
        found = better
    modes = found.modes
    return solved, Unknowns(np.tile(dry.gap, (modes, 1)), np.tile(fluid, (modes, 1)), dry.offset)


def first_state(speed: float, law: ContactLaw, model: Model = BASE_MODEL) -> Level | Outcome:
    """Return a coarse state at a speed, or the outcome of the failure."""
    if is_too_thin(speed, law):
        return Outcome.MESH_LIMIT
    last: Outcome = Outcome.STALLED
    for path in (_direct, _upward, _downward, _milder):
        try:
            for level in path(speed, law, model):
                if level.outcome.ok:
                    return level
                last = level.outcome
        except MeshTooLargeError as problem:
            return problem.outcome
    return last


def _direct(speed: float, law: ContactLaw, model: Model) -> Iterator[Level]:
    modes = first_modes(speed, law, model)
    few = [(FEW_MODES, 1.0)] if modes > FEW_MODES else []
    for count, thickness_ratio in (*few, (modes, 1.0), (modes, 1.5), (modes, 0.7)):
        guess = first_guess(resolution(speed, law, DEGREE, count, model), speed, law, thickness_ratio)
        if guess is not None:
            found, y = guess
            yield solve_level(found, speed, law, y, operators_of(found).mesh, TOLERANCE, max_steps=MAX_STEPS)


def _upward(speed: float, law: ContactLaw, model: Model) -> Iterator[Level]:
    """Yield the state at the end of the path from slow to the speed, if it gets there."""
    slow = speed
    while film_scale(film_speed(slow, model)) > 0.1 * _dry_gap(law) and slow > MIN_DRY_SPEED_RATIO * speed:
        slow /= 4.0
    yield from _path(slow, speed, law, model)


def _downward(speed: float, law: ContactLaw, model: Model) -> Iterator[Level]:
    """Yield the same from fast."""
    yield from _path(max(MIN_RIGID_SPEED, 2.0 * speed), speed, law, model)


def _milder(speed: float, law: ContactLaw, model: Model) -> Iterator[Level]:
    """Yield the state at the end of the path from a Newtonian fluid between smooth walls to the film of the model."""
    if model.film == BASE_MODEL.film:
        return
    here = resolution(speed, law, DEGREE, first_modes(speed, law, model), model)

    def correct(part: float, history: Sequence[tuple[float, Level]]) -> Level | None:
        if not history:
            plain = first_state(speed, law, replace(model, film=BASE_MODEL.film))
            return plain if isinstance(plain, Level) else None
        weights = extrapolation_weights([at for at, _ in history], part)
        on = replace(here, splits=history[-1][1].resolution.splits, model=replace(model, film=model.film.milder(part)))
        mesh = operators_of(on).mesh
        guess = extrapolate_levels(weights, [level for _, level in history], mesh)
        return solve_level(on, speed, law, guess, mesh, TOLERANCE, max_steps=12)

    found = march(correct, 0.0, 1.0, HOMOTOPY_STEPS)
    if found.outcome.ok:
        last = found.states[-1]
        yield replace(last, resolution=replace(last.resolution, model=model))


def _path(begin: float, end: float, law: ContactLaw, model: Model) -> Iterator[Level]:
    count = 0

    def correct(s: float, history: Sequence[tuple[float, Level]]) -> Level | None:
        nonlocal count
        count += 1
        if count > MAX_STATES:
            return None
        speed = math.exp(s)
        here = resolution(speed, law, DEGREE, first_modes(speed, law, model), model)
        if history:
            here = replace(here, splits=history[-1][1].resolution.splits)
            weights = extrapolation_weights([at for at, _ in history], s)
            guess = here, extrapolate_levels(weights, [level for _, level in history], operators_of(here).mesh)
        else:
            first = first_guess(here, speed, law)
            if first is None:
                return None
            guess = first
        return solve_level(guess[0], speed, law, guess[1], operators_of(guess[0]).mesh, TOLERANCE, max_steps=12)

    found = march(correct, math.log(begin), math.log(end), Steps(0.5, 3.0, 0.02, order=2, aim=3.0))
    if found.outcome.ok:
        yield found.states[-1]
