"""What paths of states of the line have in common: their columns, the scales of errors, and which states they take."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from stribeck._types import Array, Flags
from stribeck.contacts.groups import Groups
from stribeck.equations.error_estimate import GAP_ROWS
from stribeck.equations.observables import DRAG_ROWS, ROW, drag_scales
from stribeck.numerics.settings import FLOOR, NEGLIGIBLE, SHARE
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import ABSOLUTE, ALL_NAMES
from stribeck.solver.refinement import RefinedState

COLUMNS = (*ALL_NAMES, "minimum_position")  # Columns of a path by name
POSITION = len(ALL_NAMES)  # Column of the minimum gap's position, after those of the observables
UNCONTROLLED_COLUMNS = [POSITION, ROW["exit_position"], ROW["reformation_position"]]
SHARE_COLUMNS = [ROW[name] for name in ABSOLUTE]


class LineStates:
    """The states of the line at the groups ``groups_at(s)``."""

    def __init__(self, groups_at: Callable[[float], Groups], rtol: float) -> None:
        self.groups_at = groups_at
        self.tolerance, self.rtol = rtol, SHARE * rtol
        self.moves = bool(groups_at(0.0).speed > 0)
        self.failure: RefinedState | None = None

    @cached_property
    def controlled(self) -> Flags:
        """All observables but positions, whose errors rtol does not limit."""
        return ~np.isin(np.arange(POSITION + 1), UNCONTROLLED_COLUMNS)

    @cached_property
    def sign_changing(self) -> Flags:
        """The offset and positions, at rest the gaps too."""
        return np.isin(np.arange(POSITION + 1), [ROW["offset"], *UNCONTROLLED_COLUMNS, *([] if self.moves else GAP_ROWS)])

    def scales(self, values: Array, s: Array) -> Array:
        """Return the scales of errors: the observables, bounded from below if they may vanish."""
        found = np.abs(values)
        found[:, SHARE_COLUMNS] = 1.0
        found[:, ROW["exit_position"] :] = 1.0
        found[:, ROW["offset"]] = np.maximum(found[:, ROW["offset"]], NEGLIGIBLE)
        found[:, DRAG_ROWS] = drag_scales(values)
        if not self.moves:
            kappa = np.array([float(self.groups_at(c).relative_roughness) for c in s.tolist()])
            found[:, GAP_ROWS] = np.maximum(found[:, GAP_ROWS], FLOOR * kappa[:, None])
        found[found == 0] = 1.0
        return found

    def accepted(self, refined: RefinedState) -> RefinedState | Outcome:
        """Return a state whose error is within the tolerance, else its outcome."""
        if refined.state is None or refined.estimate is None or not refined.estimate.total <= self.tolerance:
            self.failure = refined
            return refined.outcome
        return replace(refined, outcome=Outcome.CONVERGED)  # rounding limits it, within the tolerance


def numbers_of(refined: RefinedState) -> tuple[Array, Array]:
    """Return the observables of a state and its minimum's position, and their errors in units of the scales."""
    values, estimate = refined.values, refined.estimate
    assert values is not None and estimate is not None
    errors = np.full(POSITION + 1, np.nan)
    errors[: len(estimate.relative)] = np.maximum(estimate.relative, NEGLIGIBLE * estimate.total)
    errors[POSITION] = estimate.minimum_position
    return np.append(values.array(), values.minimum_position), errors
