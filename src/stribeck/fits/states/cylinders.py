"""States of cylinders for fits: solved as curves, or each from the nearest one of those before."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.batches.chain import CHAIN_STEPS
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Groups, Physics
from stribeck.equations.observables import ROW
from stribeck.equations.sensitivity import log_derivatives
from stribeck.fits.states.parts import FrictionParts, ModelChange, PartsOf
from stribeck.numerics.continuation import march
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import NAMES
from stribeck.solver.nearby import WarmStartSolver
from stribeck.solver.path.corrector import Corrector
from stribeck.solver.solve import stated_errors
from stribeck.solver.solve_error import SolveError

__all__ = ["kept_parts", "solved_parts"]


# Rows up to which each state is solved from one before, with a mesh of its own in memory; more are solved as a curve.
MOST_KEPT = 60


NEAR = 0.3  # Largest change of a logarithm over which a single state is solved from another, if one more can be kept


def solved_parts(definition: Definition, rtol: float) -> PartsOf:
    """Return the function that solves states, those that differ in speed alone as one curve."""

    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        speed, load, roughness = (np.broadcast_to(g, groups.shape) for g in (groups.speed, groups.load, groups.roughness))
        n = groups.shape[0]
        values, slopes, errors = np.empty((2, n)), np.empty((2, 3 + len(changes), n)), np.empty((2, n))
        pairs, pair_of = np.unique(np.stack([load, roughness], axis=1), axis=0, return_inverse=True)
        for k, (F, h_rms) in enumerate(pairs):
            rows = np.nonzero(pair_of.ravel() == k)[0]
            speeds, at = np.unique(speed[rows], return_inverse=True)
            found = _along(speeds, float(F), float(h_rms), definition, rtol, groups.physics, changes)
            values[:, rows], slopes[:, :, rows], errors[:, rows] = (array[..., at.ravel()] for array in found)
        return FrictionParts(values, slopes, errors, definition)

    return parts


def _along(
    speeds: Array,
    load: float,
    roughness: float,
    definition: Definition,
    rtol: float,
    physics: Physics,
    changes: Sequence[ModelChange],
) -> tuple[Array, Array, Array]:
    """Return values, slopes and errors of states at ascending speeds, each solved from those before it."""

    def groups_at(s: float) -> Groups:
        return Groups(math.exp(s), load, roughness, **physics)

    places, n = np.log(speeds).tolist(), len(speeds)
    chain = march(Corrector(groups_at, rtol), places[-1], places[0], CHAIN_STEPS, targets=places)
    if chain.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    if not chain.outcome.ok:
        raise SolveError(chain.outcome, None, f"load {load:.6g}, roughness {roughness:.6g}: {chain.outcome.value}")
    columns = [ROW["contact_load_share"], ROW[f"viscous_{definition}"]]
    values, slopes, errors = np.empty((2, n)), np.empty((2, 3 + len(changes), n)), np.empty((2, n))
    for i, s in enumerate(places):
        point = chain.at(s)
        assert point.state is not None and point.values is not None and point.estimate is not None
        derivatives = log_derivatives(point.state, [each[1:] for each in changes])
        values[:, i] = point.values.array(in_article=False)[columns]
        slopes[:, :, i] = derivatives["contact_load_share"], derivatives[f"viscous_{definition}"]
        errors[:, i] = stated_errors(point, rtol)[columns]
    return values, slopes, errors


def kept_parts(definition: Definition, rtol: float) -> PartsOf:
    """Return the function that solves states each from the nearest one of those before, for searches that come near again.

    Its arguments and what it returns are those of :func:`solved_parts`.
    """
    pools: dict[Any, list[_Kept]] = {}
    along, row = solved_parts(definition, rtol), NAMES.index(f"viscous_{definition}")

    @one_blas_thread
    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        if groups.shape[0] > MOST_KEPT:
            return along(groups, changes)
        states = np.stack(np.broadcast_arrays(groups.speed, groups.load, groups.roughness), axis=1)
        n, model, places = len(states), groups.model, np.log(np.maximum(states, 1e-300))
        values, slopes, errors = np.empty((2, n)), np.empty((2, 3 + len(changes), n)), np.empty((2, n))
        pool = pools.setdefault((model.film.name, model.cavitation, model.solid.name), [])
        unused = list(pool)
        for i in np.argsort(-places[:, 0]).tolist():
            kept = min(unused, key=lambda each: each.distance(places[i]), default=None)
            if kept is not None and (n > 1 or len(pool) > MOST_KEPT or kept.distance(places[i]) < NEAR):
                unused.remove(kept)
            else:
                near = min(pool, key=lambda each: each.distance(places[i]), default=None)
                kept = _Kept(places[i], near.solver.beside() if near else WarmStartSolver(rtol))
                pool.append(kept)
            kept.place = places[i]
            solution = kept.solver(Groups(*states[i].tolist(), **groups.physics))
            found = solution.observables.array()
            values[:, i], errors[:, i] = found[[0, row]], solution.relative_errors[[0, row]]
            derivatives = log_derivatives(kept.solver.state, [each[1:] for each in changes])
            slopes[:, :, i] = derivatives["contact_load_share"], derivatives[f"viscous_{definition}"]
        return FrictionParts(values, slopes, errors, definition)

    return parts


@dataclass(eq=False)
class _Kept:
    """A solver, and the logarithms of the groups that it last solved."""

    place: Array
    solver: WarmStartSolver

    def distance(self, place: Array) -> float:
        """Return the largest change of a logarithm from there to another place."""
        return float(np.abs(self.place - place).max())
