"""States of a ball whose film forms anew behind a cavity, and of its full film where its suction stays above the cavity's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from stribeck.contact_laws.law import ContactLaw
from stribeck.contacts.model import Model
from stribeck.equations.cavities.cavitated import TornEquations
from stribeck.fluids.cavitation import Cavitation
from stribeck.quantities.outcome import Outcome
from stribeck.solver.cavities.cavitated import follow_cavitated, holds_cavitated, is_cavitated, refine_cavitated
from stribeck.solver.point.level import Level
from stribeck.solver.point.refinement import Pair, follow, holds_along_path, refine

__all__ = ["follow_reforming", "full_model", "holds_reforming", "refine_reforming"]

NEARLY = 1.1
"""Suction of a coarse full film over that of the cavity below which the full film is tried first."""


def full_model(model: Model) -> Model:
    """Return a model without cavitation."""
    return replace(model, cavitation=Cavitation.NONE, cavity_pressure=0.0)


def refine_reforming(
    speed: float, law: ContactLaw, guess: Level, rtol: float, model: Model, known: Pair | None = None
) -> Pair | Outcome:
    """Return a state whose estimated error holds a tolerance from a coarse one, or the best that was found.

    ``known`` is the state with a larger error.
    """
    full = guess.named(full_model(model))
    if known is not None and not isinstance(known.fine.equations, TornEquations):
        return _full(speed, law, full, rtol, model, known) or refine_cavitated(speed, law, guess, rtol, model)
    if known is None and guess.unknowns.fluid.min() >= NEARLY * model.cavity_pressure:
        found = _full(speed, law, full, rtol, model)
        if found is not None:
            return found
    torn = refine_cavitated(speed, law, guess, rtol, model, known)
    if not isinstance(torn, Pair):
        return torn
    if torn.outcome.ok and not is_cavitated(torn):
        return _full(speed, law, torn.fine.named(full.resolution.model), rtol, model) or torn
    reaches_rim = bool((torn.fine.unknowns.fluid[:, -1] <= model.cavity_pressure).any())
    return replace(torn, outcome=Outcome.MESH_LIMIT) if reaches_rim else torn


def follow_reforming(
    speed: float, law: ContactLaw, neighbour: Pair, rtol: float, line: Sequence[tuple[float, Pair]] = ()
) -> Pair | None:
    """Return the state of a neighbour's meshes at other groups, or None where it does not come from there.

    ``line`` holds neighbours, and the weights with which they predict the state; only those that break like the first count.
    """
    model, breaks = neighbour.fine.resolution.model, isinstance(neighbour.fine.equations, TornEquations)
    if any(isinstance(each.fine.equations, TornEquations) is not breaks for _, each in line):
        line = ()
    if breaks:
        found = follow_cavitated(speed, law, neighbour, rtol, line)
        if found is None or is_cavitated(found):
            return found
        return _full(speed, law, found.fine.named(full_model(model)), rtol, model)
    full = full_model(model)
    found = follow(speed, law, neighbour.named(full), rtol, [(weight, each.named(full)) for weight, each in line])
    if found is None or not found.outcome.ok:
        return None
    if found.fine.unknowns.fluid.min() >= model.cavity_pressure:
        return found.named(model)
    torn = refine_cavitated(speed, law, found.fine, rtol, model)
    return torn if isinstance(torn, Pair) and torn.outcome.ok else None


def holds_reforming(pair: Pair, rtol: float) -> bool:
    """Return whether the errors of a state along a path hold a tolerance."""
    breaks = isinstance(pair.fine.equations, TornEquations)
    return holds_cavitated(pair, rtol) if breaks else holds_along_path(pair, rtol)


def _full(speed: float, law: ContactLaw, guess: Level, rtol: float, model: Model, known: Pair | None = None) -> Pair | None:
    """Return the full film, named as the model; None where its suction exceeds that of the cavity, or it is not found."""
    found = refine(speed, law, guess, rtol, None if known is None else known.named(guess.resolution.model))
    if not isinstance(found, Pair) or not found.fine.unknowns.fluid.min() >= model.cavity_pressure:
        return None
    return found.named(model)
