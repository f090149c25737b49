"""States of balls for fits: read off lattices of solved states, off solved curves, or each solved from the nearest before."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from stribeck._types import Array
from stribeck.batches.kept import KeptStates
from stribeck.batches.lattice import PARTS, STEPS, Lattice
from stribeck.contacts.friction import Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Groups
from stribeck.fits.states.parts import FrictionParts, ModelChange, PartsOf
from stribeck.numerics.threads import one_blas_thread
from stribeck.solver.point.sensitivity import GROUPS

if TYPE_CHECKING:
    from stribeck.fits.model import FrictionModel

__all__ = ["OnState", "curve_parts", "kept_balls", "lattice_parts"]


LATTICE_RTOL = 3e-4  # Tolerance of the states of a lattice


LATTICE_ERROR = 3e-3  # Largest relative error of the parts read off a lattice of balls; 2e-3 was found in the middle of a cell


# Steps of solved curves of balls: of ln(speed), and none that count of ln(load) and ln(relative roughness).
FINE_STEPS = (0.3, 1.0, 1.0)


CLOSE = 0.01  # Logarithm of a load or a roughness up to which a solved curve of a ball serves, to first order


OnState = Callable[[int], object]
"""What is called with the number of states so far after each one that takes long to solve."""


def lattice_parts(starts: Array, varies: Array, definition: Definition) -> PartsOf:
    """Return the function that reads states of balls off lattices of solved states, made where they are asked for."""
    lattices: list[Lattice] = []

    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        logs = _coordinates(groups)
        is_smooth = not np.any(groups.roughness)
        if not lattices:
            for start in starts:
                anchor = tuple(start + 0.5 * np.array(STEPS) * varies)
                if not any(np.allclose(anchor[1:], each.anchor[1:], rtol=0, atol=1e-9) for each in lattices):
                    lattices.append(Lattice(anchor, groups.physics, LATTICE_RTOL, is_smooth))
        away = np.array([np.abs((logs - each.anchor) / each.steps)[:, 1:].max(axis=1) for each in lattices])
        values, slopes = np.empty((4, len(logs))), np.empty((4, 3, len(logs)))
        for k in np.unique(nearest := np.argmin(away, axis=0)):
            rows = nearest == k
            values[:, rows], slopes[:, :, rows] = lattices[k].at(logs[rows])
        return _of_values(values, slopes, LATTICE_ERROR, groups, definition)

    return parts


def curve_parts(definition: Definition, rtol: float) -> PartsOf:
    """Return the function that solves curves of balls at the loads and roughnesses asked for.

    Between solved speeds a curve is interpolated with its derivatives; loads and roughnesses within a hundredth of a curve are
    reached from there to first order.
    """
    curves: list[Lattice] = []

    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        logs = _coordinates(groups)
        values, slopes = np.empty((4, len(logs))), np.empty((4, 3, len(logs)))
        pairs, of_row = np.unique(logs[:, 1:], axis=0, return_inverse=True)
        for k, pair in enumerate(pairs):
            rows = np.nonzero(of_row.ravel() == k)[0]
            near = [each for each in curves if np.abs(pair - each.anchor[1:]).max() < CLOSE]
            if not near:
                anchor = (float(logs[rows[0], 0]), float(pair[0]), float(pair[1]))
                near = [Lattice(anchor, groups.physics, rtol, not np.any(groups.roughness), FINE_STEPS)]
                curves.append(near[0])
            on_curve = np.column_stack([logs[rows, 0], np.tile(near[0].anchor[1:], (len(rows), 1))])
            found, by = near[0].at(on_curve)
            offset = pair - near[0].anchor[1:]
            values[:, rows] = found + np.einsum("pdn,d->pn", by[:, 1:], offset)
            slopes[:, :, rows] = by
        return _of_values(values, slopes, rtol, groups, definition)

    return parts


def kept_balls(model: FrictionModel, definition: Definition, rtol: float, on_state: OnState = lambda n: None) -> PartsOf:
    """Return the function that solves balls with other fluids and bodies, each from the nearest state of those before.

    A fluid that thins far out counts up to the edge of the liquid of the contact as the fit begins.
    """
    states, count = KeptStates(rtol), itertools.count(1)
    others = model.rule.of_contact(model.contact)
    by = [name for name, moves in zip(GROUPS, np.abs(model.exponents[:, :, :3]).max(axis=(0, 1)) > 0, strict=True) if moves]

    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        rows = np.stack(np.broadcast_arrays(groups.speed, groups.load, groups.roughness), axis=1)
        n, names = len(rows), [0, *(PARTS.index(name) for name in model.rule.parts(definition))]
        values, slopes, errors = np.empty((4, n)), np.empty((4, 3 + len(changes), n)), np.empty((4, n))
        ends = {str(change.input): change[1:] for change in changes}
        for i in np.lexsort((-rows[:, 0], rows[:, 2], rows[:, 1])).tolist():
            here = Groups(*rows[i].tolist(), **groups.physics)
            slope = float(here.slope(others["beta"]))
            values[:, i], slopes[:, :, i], errors[:, i] = states.at(here, ends, slope, others["wetted_radius"], by)
            on_state(next(count))
        return FrictionParts(values[names], slopes[names], errors[names], definition)

    return one_blas_thread(parts)


def _coordinates(groups: Groups) -> Array:
    """Return ln of speed, load and relative roughness, zero for the last of smooth surfaces, shape (n, 3)."""
    kappa = np.asarray(groups.relative_roughness, dtype=float)
    kappa = np.where(kappa > 0, kappa, 1.0)
    return np.asarray(np.log(np.stack(np.broadcast_arrays(groups.speed, groups.load, kappa), axis=1)))


def _of_values(values: Array, slopes: Array, error: float, groups: Groups, definition: Definition) -> FrictionParts:
    """Return the parts by those of a lattice, whose derivatives are at fixed relative roughness."""
    rows = [0, *(PARTS.index(name) for name in RULES[groups.geometry].parts(definition))]
    by = slopes[rows].copy()
    by[:, 1] -= groups.scaling.roughness_exponent * by[:, 2]
    errors = np.full((len(rows), values.shape[1]), error)
    errors[0] *= values[0]  # interpolated are its log odds
    return FrictionParts(values[rows], by, errors, definition)
