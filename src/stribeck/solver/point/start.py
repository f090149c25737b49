"""Cold start of the point contact: a first, coarse state anywhere.

The dry contact under a law as soft as the film is thick has the shape of the lubricated one: its pressure, less what the
asperities of the state carry at that gap, is the first guess of the film pressure.  So the elastic shape and the load hold
from the beginning.  Where Newton's iteration does not end from there, the speed comes up from the dry contact, or down from a
rigid ball.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from stribeck.contact_laws.exponential import ExponentialLaw
from stribeck.contact_laws.law import ContactLaw
from stribeck.equations.point.dry import dry_contact
from stribeck.equations.point.mesh_choice import MeshTooLargeError, film_scale, gaps_at, layout, operators_of, resolution
from stribeck.equations.point.system import Operators, Unknowns
from stribeck.numerics.continuation import Steps, extrapolation_weights, march
from stribeck.quantities.outcome import Outcome
from stribeck.solver.point.level import Level, extrapolated, solve_level

DEGREE = 8
"""Degree of the panels of a first state."""

TOLERANCE = 1e-4
"""Relative error of the gap that its iteration may leave."""

MAX_STEPS = 25
"""Newton steps after which a first guess is given up."""

DRY = 0.3
"""Film of the smooth contact over the gap of the dry one below which the dry contact is the first guess."""

FAST, SLOW = 30.0, 1e-3
"""The speed at which the path from the rigid ball begins, and that of the path from the dry contact over the state's."""

LONGEST_PATH = 60
"""States on a path after which it is given up."""


def first_modes(speed: float, law: ContactLaw) -> int:
    """Return the number of angular modes of a first state."""
    width, _ = layout(speed, law)
    return int(min(40, max(8, round(1.2 * (width / 0.6) ** -0.6)))) if film_scale(speed) > _dry_gap(law) else 8


def _dry_gap(law: ContactLaw) -> float:
    """Return about the gap of the dry contact in its middle."""
    return float(gaps_at(law, np.zeros(1))[0]) if float(np.max(law.decay_length)) > 0 else 0.0


def first_guess(operators: Operators, speed: float, law: ContactLaw, lift: float = 1.0) -> Unknowns | None:
    """Return the first guess, with a film ``lift`` times as thick as expected; None where the dry contact fails."""
    mesh = operators.mesh
    film, at_rest = lift * film_scale(speed), _dry_gap(law)
    if film < DRY * at_rest:
        dry = dry_contact(operators, law)
        fluid = np.zeros_like(dry.gap)
    else:
        height = (at_rest**3 + film**3) ** (1.0 / 3.0)
        decay = 0.25 * film
        if at_rest > 0.0:
            decay = max(decay, float(np.max(law.local_decay_length(np.array([at_rest])))))
        dry = dry_contact(operators, ExponentialLaw(math.exp(-2.0 * height / decay), decay))
        fluid = dry.pressure - law.pressure(dry.gap)
    if not dry.outcome.ok or not dry.gap.min() > 0:
        return None
    return Unknowns(np.tile(dry.gap, (mesh.modes, 1)), np.tile(fluid, (mesh.modes, 1)), dry.offset)


def first_state(speed: float, law: ContactLaw) -> Level | Outcome:
    """Return a coarse state at a speed, or why there is none."""
    last: Outcome = Outcome.STALLED
    for path in (_direct, _upward, _downward):
        try:
            for level in path(speed, law):
                if level.outcome.ok:
                    return level
                last = level.outcome
        except MeshTooLargeError:
            return Outcome.REFINEMENT_LIMIT
    return last


def _attempt(speed: float, law: ContactLaw, guess: Unknowns, operators: Operators, max_steps: int = MAX_STEPS) -> Level:
    found = resolution(speed, law, DEGREE, first_modes(speed, law))
    return solve_level(found, speed, law, guess, operators.mesh, TOLERANCE, max_steps=max_steps)


def _direct(speed: float, law: ContactLaw) -> Iterator[Level]:
    operators = operators_of(resolution(speed, law, DEGREE, first_modes(speed, law)))
    for lift in (1.0, 1.5, 0.7):
        guess = first_guess(operators, speed, law, lift)
        if guess is not None:
            yield _attempt(speed, law, guess, operators)


def _upward(speed: float, law: ContactLaw) -> Iterator[Level]:
    """Yield the state at the end of the path from slow to the speed, if it gets there."""
    slow = speed
    while film_scale(slow) > 0.1 * _dry_gap(law) and slow > SLOW * speed:
        slow /= 4.0
    yield from _path(slow, speed, law)


def _downward(speed: float, law: ContactLaw) -> Iterator[Level]:
    """Yield the same from fast."""
    yield from _path(max(FAST, 2.0 * speed), speed, law)


def _path(begin: float, end: float, law: ContactLaw) -> Iterator[Level]:
    count = 0

    def correct(s: float, history: Sequence[tuple[float, Level]]) -> Level | None:
        nonlocal count
        count += 1
        if count > LONGEST_PATH:
            return None
        speed = math.exp(s)
        operators = operators_of(resolution(speed, law, DEGREE, first_modes(speed, law)))
        if history:
            weights = extrapolation_weights([at for at, _ in history], s)
            guess: Unknowns | None = extrapolated(weights, [level for _, level in history], operators.mesh)
        else:
            guess = first_guess(operators, speed, law)
        return None if guess is None else _attempt(speed, law, guess, operators, 12)

    found = march(correct, math.log(begin), math.log(end), Steps(0.5, 3.0, 0.02, order=2, aim=3.0))
    if found.outcome.ok:
        yield found.states[-1]
