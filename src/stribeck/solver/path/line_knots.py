"""States of the line along a path with the slopes of their observables: of any fluid, any end of the film and any law.

Where a cavity opens or closes the observables have a kink: states on both sides are of two kinds.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from stribeck._types import Array, Flags
from stribeck.contacts.groups import Groups
from stribeck.equations.observables import DRAG_ROWS, GAP_ROWS, ROW, error_scales, minimum_of
from stribeck.equations.sensitivity import derivatives_along
from stribeck.equations.state import State
from stribeck.numerics.settings import EPSILON, LOG_STEP, NEGLIGIBLE, SHARE
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import ALL_NAMES
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.path.hermite_path import HermitePath, Knot
from stribeck.solver.refinement import RefinedState

COLUMNS = (*ALL_NAMES, "minimum_position")  # Columns of a path by name
POSITION = len(ALL_NAMES)  # Column of the minimum gap's position, after those of the observables
UNCONTROLLED_COLUMNS = [POSITION, ROW["exit_position"], ROW["reformation_position"]]


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
        kappa = None if self.moves else np.array([[float(self.groups_at(c).relative_roughness)] for c in s.tolist()])
        found = error_scales(values, kappa)
        found[:, POSITION:] = 1.0
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


class LineKnots(LineStates):
    """The states of the line at the groups ``groups_at(s)``, each from its neighbours."""

    path = HermitePath
    names = COLUMNS
    shares = (ROW["contact_load_share"], ROW["fluid_load_share"])
    summands = ()  # the sum of no two is smoother than both

    def __init__(self, groups_at: Callable[[float], Groups], rtol: float) -> None:
        super().__init__(groups_at, rtol)
        self.neighbours = Neighbours(self.rtol)
        self._sharper: dict[float, Neighbours] = {}

    @cached_property
    def one_signed(self) -> Flags:
        """All that crosses zero nowhere: where the surfaces roll, their friction may."""
        rolls = self.moves and abs(self.groups_at(0.0).model.film.slide) != 1.0
        return ~self.sign_changing & ~np.isin(np.arange(POSITION + 1), DRAG_ROWS if rolls else [])

    def units(self, s: Array) -> Array:
        """Return ones: observables are interpolated as they are."""
        return np.ones((len(s), POSITION + 1))

    def solve(self, s: float, near: Sequence[Knot] = ()) -> Knot | Outcome:
        """Return the state at ``s`` with its slopes, or the outcome of the failure."""
        refined = self.accepted(self.neighbours.at(self.groups_at(s)))
        if isinstance(refined, Outcome):
            return refined
        assert refined.state is not None
        values, errors = numbers_of(refined)
        slopes = self._slopes(s, refined.state) if self.moves else self._slopes_at_rest(s)
        model = refined.state.groups.model
        return Knot(s, values, slopes, errors, refined, kind=(model.film.uses_pressure, model.cavitation))

    def begin(self, s: float, refined: RefinedState) -> Knot | Outcome:
        """Return the state at ``s`` from one that is known, or the outcome of the failure."""
        self.neighbours.learn(refined)
        return self.solve(s)

    def _slopes(self, s: float, state: State) -> Array:
        """Return the slopes of the observables of a state by its equations."""
        step = EPSILON ** (1 / 3)  # where truncation and rounding of a central difference are alike
        slopes, move = derivatives_along(state, self.groups_at, s)
        before, after = (minimum_of(state.equations, state.y + each * move)[0] for each in (-step, step))
        return np.append(slopes, (after - before) / (2 * step))

    def _slopes_at_rest(self, s: float) -> Array:
        """Return the slopes of the observables by two states beside, as a contact at rest is solved at another load."""
        rows = [numbers_of(self.neighbours.solved(self.groups_at(s + step)))[0] for step in (-LOG_STEP, LOG_STEP)]
        return np.asarray((rows[1] - rows[0]) / (2 * LOG_STEP))

    def guess_at(self, path: HermitePath, s: float) -> State:
        """Return the state at a coordinate of a path, whose fields hold."""
        state = self.point_at(path, s).state
        assert state is not None
        return state

    @one_blas_thread
    def point_at(self, path: HermitePath, s: float, rtol: float | None = None) -> RefinedState:
        """Return the verified state at a coordinate of a path; without ``rtol`` the tolerance is that of the path."""
        groups, tolerance = self.groups_at(s), self.tolerance if rtol is None else rtol
        if tolerance >= self.tolerance:
            point: RefinedState = self.neighbours.at(groups)
            if point.estimate is not None and point.estimate.total <= tolerance:
                return replace(point, outcome=Outcome.CONVERGED)
        if tolerance not in self._sharper:
            self._sharper[tolerance] = Neighbours(tolerance)
            for knot in path.around(s):
                self._sharper[tolerance].learn(knot.state)
        found: RefinedState = self._sharper[tolerance].at(groups)
        return found
