"""States of a ball whose film re-forms behind a cavity, and of its full film where its suction stays above the cavity's."""

from __future__ import annotations

from dataclasses import replace

from stribeck.contact_laws.law import ContactLaw
from stribeck.contacts.model import Model
from stribeck.equations.cavities.system import CavitatedSystem
from stribeck.equations.point.system import Unknowns
from stribeck.fluids.fluid import Cavitation
from stribeck.quantities.outcome import Outcome
from stribeck.solver.point.estimate import Pair
from stribeck.solver.point.level import Level
from stribeck.solver.point.refinement import follow, is_cavitated, refine

__all__ = ["follow_reforming", "full_model", "refine_reforming"]


def full_model(model: Model) -> Model:
    """Return a model without cavitation."""
    return replace(model, cavitation=Cavitation.NONE, cavity_pressure=0.0)


def refine_reforming(
    speed: float, law: ContactLaw, guess: Level, rtol: float, model: Model, known: Pair | None = None
) -> Pair | Outcome:
    """Return a state that holds a tolerance, from a coarse one or a ``known`` one with a larger error, or the best found."""
    full = guess.relabelled(full_model(model))
    if known is not None and not isinstance(known.fine.equations, CavitatedSystem):
        return _refine_full_film(speed, law, full, rtol, model, known) or refine(speed, law, guess, rtol, model)
    if known is None and guess.unknowns.fluid.min() >= model.cavity_pressure:
        found = _refine_full_film(speed, law, full, rtol, model)
        if found is not None:
            return found
    cavitated = refine(speed, law, guess, rtol, model, known)
    if not isinstance(cavitated, Pair):
        return cavitated
    if cavitated.outcome.ok and not is_cavitated(cavitated):
        return _refine_full_film(speed, law, cavitated.fine.relabelled(full.resolution.model), rtol, model) or cavitated
    reaches_rim = bool((cavitated.fine.unknowns.fluid[:, -1] <= model.cavity_pressure).any())
    return replace(cavitated, outcome=Outcome.MESH_LIMIT) if reaches_rim else cavitated


def follow_reforming(
    speed: float, law: ContactLaw, neighbour: Pair, rtol: float, prediction: Unknowns | None = None
) -> Pair | None:
    """Return the state of other groups from a neighbour, on its meshes if they serve; None if the iteration fails."""
    model = neighbour.fine.resolution.model
    if isinstance(neighbour.fine.equations, CavitatedSystem):
        found = follow(speed, law, neighbour, rtol, prediction)
        if found is None or is_cavitated(found):
            return found
        return _refine_full_film(speed, law, found.fine.relabelled(full_model(model)), rtol, model)
    full = full_model(model)
    found = follow(speed, law, neighbour.relabelled(full), rtol, prediction)
    if found is None or not found.outcome.ok:
        return None
    if found.fine.unknowns.fluid.min() >= model.cavity_pressure:
        return found.relabelled(model)
    cavitated = refine(speed, law, found.fine, rtol, model)
    return cavitated if isinstance(cavitated, Pair) and cavitated.outcome.ok else None


def _refine_full_film(
    speed: float, law: ContactLaw, guess: Level, rtol: float, model: Model, known: Pair | None = None
) -> Pair | None:
    """Return the full film relabelled with the model, or None if its suction exceeds the cavity's or none is found."""
    full = guess.resolution.model
    found = refine(speed, law, guess, rtol, full, None if known is None else known.relabelled(full))
    if not isinstance(found, Pair) or not found.fine.unknowns.fluid.min() >= model.cavity_pressure:
        return None
    return found.relabelled(model)
