"""Cold start of the point contact: a first, coarse state anywhere.

A dry contact in which a cushion, as thick as the film, helps the asperities has about the shape of the lubricated one, and
the pressure of the cushion is the first guess of the film pressure.  So elastic shape and load hold from the beginning.
If Newton's iteration does not converge from there, the film comes from that of a Newtonian fluid.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

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
    is_too_thin,
    operators_of,
    resolution,
)
from stribeck.equations.point.system import Unknowns
from stribeck.fluids.newtonian import blend
from stribeck.numerics.continuation import Steps, extrapolation_weights
from stribeck.numerics.settings import COARSE_RTOL, LEAST_DEGREE, LEAST_MODES, NEGLIGIBLE
from stribeck.quantities.outcome import Outcome
from stribeck.solver.point.level import Level, extrapolate_levels, solve_level

TOLERANCE = NEGLIGIBLE * COARSE_RTOL  # Relative error of the gap that the iteration of a first state may leave


@dataclass(frozen=True)
class WithCushion:
    """A contact law, and a cushion that gives way at a film thickness, as a film does."""

    law: ContactLaw
    film: float
    name: str = "with cushion"
    constant_decay: bool = False

    @property
    def own_decay(self) -> float:
        """The decay of the cushion: what flows in a film goes as the third power of its thickness."""
        return self.film / 3.0

    @property
    def decay_length(self) -> float:
        """The longer of the two decays."""
        return max(float(np.max(self.law.decay_length)), self.own_decay)

    def cushion(self, gap: Array) -> Array:
        """Return the pressure of the cushion, one at the film thickness."""
        return np.asarray(np.exp((self.film - gap) / self.own_decay))

    def pressure(self, gap: Any) -> Any:
        """Return the sum of both pressures."""
        return np.exp(self.log_pressure(gap))

    def log_pressure(self, gap: Any) -> Any:
        """Return its logarithm."""
        return np.logaddexp(self.law.log_pressure(gap), (self.film - gap) / self.own_decay)


def first_guess(found: Resolution, speed: float, law: ContactLaw) -> Unknowns | None:
    """Return the first guess on a mesh; None if the dry contact fails."""
    cushioned = WithCushion(law, film_scale(film_speed(speed, found.model)))
    dry = dry_contact(operators_of(found), cushioned, TOLERANCE)
    if not dry.outcome.ok or not dry.gap.min() > 0:
        return None
    gap, fluid = (np.tile(each, (found.modes, 1)) for each in (dry.gap, cushioned.cushion(dry.gap)))
    return Unknowns(gap, fluid, dry.offset)


def first_state(speed: float, law: ContactLaw, model: Model = BASE_MODEL) -> Level | Outcome:
    """Return a coarse state at a speed, or the outcome of the failure."""
    if is_too_thin(speed, law):
        return Outcome.MESH_LIMIT
    try:
        found = resolution(speed, law, LEAST_DEGREE, LEAST_MODES, model)
        guess = first_guess(found, speed, law)
        level = None if guess is None else solve_level(found, speed, law, guess, operators_of(found).mesh, TOLERANCE)
        if level is None or not level.outcome.ok:
            level = _from_newtonian(speed, law, model) or level
    except MeshTooLargeError as problem:
        return problem.outcome
    if level is None:
        return Outcome.STALLED
    return level if level.outcome.ok else level.outcome


def _from_newtonian(speed: float, law: ContactLaw, model: Model) -> Level | None:
    """Return the state at the end of the path from a Newtonian fluid between smooth walls to the film of the model."""
    if model.film == BASE_MODEL.film:
        return None
    here = resolution(speed, law, LEAST_DEGREE, LEAST_MODES, model)

    def correct(part: float, history: Sequence[tuple[float, Level]]) -> Level | None:
        if not history:
            plain = first_state(speed, law, replace(model, film=BASE_MODEL.film))
            return plain if isinstance(plain, Level) else None
        weights = extrapolation_weights([at for at, _ in history], part)
        on = replace(here, splits=history[-1][1].resolution.splits, model=replace(model, film=blend(model.film, part)))
        mesh = operators_of(on).mesh
        guess = extrapolate_levels(weights, [level for _, level in history], mesh)
        return solve_level(on, speed, law, guess, mesh, TOLERANCE)

    found = Steps(correct).to(1.0, 0.0)
    if not found.outcome.ok:
        return None
    last = found.states[-1]
    return replace(last, resolution=replace(last.resolution, model=model))
