"""States of balls that are kept: each new one is solved from the nearest, whatever the numbers of its fluid and its body."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.batches.lattice import PARTS
from stribeck.contacts.cut_off import log_cut_offs
from stribeck.contacts.groups import Groups
from stribeck.contacts.model import Model
from stribeck.equations.point.observables import FrictionWithin
from stribeck.solver.point.path import next_state, without_factors
from stribeck.solver.point.refinement import Pair
from stribeck.solver.point.sensitivity import GROUPS, derivatives_along, state_derivatives
from stribeck.solver.point.solution import finish_point
from stribeck.solver.point.state import PointState

__all__ = ["KeptStates", "between"]

MOST = 120  # States that are kept

NEAR = 2.0  # Largest change of the logarithm of a group within which a state is a start worth having


def between(one: Any, other: Any, part: float) -> Any:
    """Return what lies between two frozen dataclasses of one kind, by their numbers; other parts are those of the first."""
    if isinstance(one, float) and isinstance(other, float):
        return one + (other - one) * part
    if one == other or not is_dataclass(one) or isinstance(one, type):
        return one
    values = [between(getattr(one, each.name), getattr(other, each.name), part) for each in fields(one) if each.init]
    return type(one)(*values)


@dataclass(eq=False)
class KeptStates:
    """States of balls with other fluids and bodies than those of the article."""

    rtol: float  # Relative tolerance of each
    kept: list[tuple[Array, PointState]] = field(default_factory=list)
    _last: tuple[Array, PointState] | None = None

    def at(
        self,
        groups: Groups,
        changes: Mapping[str, tuple[Model, Model, float]],
        slope: float,
        wetted: float,
        by: Sequence[str] = GROUPS,
    ) -> tuple[Array, Array, Array]:
        """Return :data:`stribeck.batches.lattice.PARTS` of one state, their derivatives and their errors."""
        state = self._solved(groups)
        values = np.array([state.values[name] for name in PARTS])
        errors = np.array([state.relative_errors[name] for name in PARTS])
        by_groups = state_derivatives(state, by)
        slopes = np.array([by_groups[name] for name in PARTS])
        if changes:
            along = derivatives_along(state, {name: partial(_moved, groups, *ends) for name, ends in changes.items()})
            slopes = np.append(slopes, [along[name] for name in PARTS], axis=1)
        if groups.model.film.uses_speed and isinstance(state.work, Pair):
            fine = state.work.fine
            within = FrictionWithin.of(fine.equations, fine.unknowns, {name: float(v) for name, v in state.values.items()})
            for row, cut in zip((1, 2), log_cut_offs(slope, wetted), strict=True):
                beyond = within(row - 1, float(cut))
                wrong = errors[row] * abs(values[row]) + abs(beyond)
                values[row] += beyond
                errors[row] = wrong / (abs(values[row]) or state.scales[PARTS[row]])
        return values, slopes, errors

    def _solved(self, groups: Groups) -> PointState:
        place = np.log(np.maximum([float(getattr(groups, name)) for name in GROUPS], 1e-300))

        def distance(each: tuple[Array, PointState]) -> float:
            return float(np.abs(each[0] - place).max())

        near = min(self.kept, key=distance, default=None)
        if near is not None and near[1].groups == groups:
            return near[1]
        if self._last is not None and near is not None and distance(self._last) <= 1.01 * distance(near):
            near = self._last
        start = near[1] if near is not None and distance(near) <= NEAR else None
        state = next_state(start, groups, self.rtol)
        finish_point(state, None)
        self._last = place, state
        self.kept = [*self.kept[-MOST:], (place, without_factors(state))]
        return state


def _moved(groups: Groups, below: Model, above: Model, width: float, step: float) -> Groups:
    """Return groups whose model is moved by a step of a logarithm."""
    return replace(groups, model=between(below, above, 0.5 + step / width))
