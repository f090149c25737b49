"""States of the line along a path: solved from a prediction, verified, and expanded."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from stribeck._types import Array, Flags
from stribeck.contact_laws.continued import misfit
from stribeck.contact_laws.law import is_exponential
from stribeck.contacts.groups import Groups, contact_law
from stribeck.contacts.model import Model
from stribeck.equations.error_estimate import GAP_ROWS, FineOperators
from stribeck.equations.line import Equations, Operators
from stribeck.equations.observables import DRAG_ROWS, ROW, drag_scales
from stribeck.equations.sensitivity import with_ending_of
from stribeck.equations.state import State, solve_state
from stribeck.fluids.cavitation import Cavitation
from stribeck.fluids.newtonian import Newtonian
from stribeck.fluids.rheology.viscosity import Barus, Constant, DowsonHigginson, Incompressible, Roelands
from stribeck.numerics.newton import Inverse, Root
from stribeck.numerics.series import beyond, interval, radius
from stribeck.numerics.settings import (
    COEFFICIENT_NOISE,
    FLOOR,
    MAX_DEGREE,
    MIN_LOG_STEP,
    NEGLIGIBLE,
    SAFETY,
    SAMPLE_RADIUS_RATIO,
    SAMPLED_ORDER,
    SHARE,
    STEP_GROWTH,
)
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import ABSOLUTE, ALL_NAMES, NAMES
from stribeck.solver.at_rest import shift_along, with_positive_gap
from stribeck.solver.path.corrector import Corrector, keeps_cavity, solve_cold_line
from stribeck.solver.path.expansion import (
    Direction,
    Expanded,
    around_state,
    expand,
    from_logs,
    observables_of_rows,
    residuals,
)
from stribeck.solver.path.interpolation import LinePoint, between, minimum_between, on
from stribeck.solver.path.path import Expansion, SolvedPath
from stribeck.solver.refinement import RefinedState, converge, mesh_tolerances_for, newton_tolerance, verify

POSITION = len(ALL_NAMES)  # Column of the minimum gap's position, after those of the observables
READ_COLUMNS = [ROW["minimum_gap"], POSITION]
SERIES_COLUMNS = [ROW[name] for name in NAMES if name != "minimum_gap"]
SHARE_COLUMNS = [ROW[name] for name in ABSOLUTE]
UNCONTROLLED_COLUMNS = [POSITION, ROW["exit_position"], ROW["reformation_position"]]


class LineProblem:
    """The states of the line at the groups ``groups_at(s)``, whose logarithms change along ``direction``."""

    path = SolvedPath

    def __init__(
        self,
        groups_at: Callable[[float], Groups],
        direction: Direction,
        rtol: float,
        uniform: bool = True,
    ) -> None:
        self.groups_at, self.direction, self.uniform = groups_at, direction, uniform
        start = groups_at(0.0)
        self.tolerance, self.rtol = rtol, SHARE * rtol
        self.moves = bool(start.speed > 0)
        self.analytic = uniform and has_formulas(start.model)
        exact = self.analytic and is_exponential(start.law)
        self.certain = exact or (self.analytic and start.law is not None and misfit(start.law) <= NEGLIGIBLE * rtol)
        self.order = MAX_DEGREE if self.analytic else SAMPLED_ORDER
        self.corrector = Corrector(self.rtol, own_inverse=True)
        self.failure: RefinedState | None = None
        self._last: tuple[State, Inverse] | None = None

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

    @property
    def negligible(self) -> float:
        """Error that the polynomial of the minimum gap may add."""
        return NEGLIGIBLE * self.tolerance

    def read_scales(self, values: Array) -> Array:
        """Return the lowest minimum gap, and the half-width for its position."""
        return np.append(values[:, :1].min(axis=0), np.ones(values.shape[1] - 1)) if values.size else np.empty(0)

    def solve(self, s: float, near: Sequence[Expansion]) -> Expansion | Outcome:
        """Return the expanded state at ``s``, from no, one or two neighbours ``near``, or the outcome of the failure."""
        found = self._solve(s, near)
        if isinstance(found, Outcome) and len(near) > 1 and found is not Outcome.ROUNDING:
            found = self._solve(s, [max(near, key=lambda end: end.radius)])  # a series may be good on one side alone
        return found

    def _solve(self, s: float, near: Sequence[Expansion]) -> Expansion | Outcome:
        """Return the expanded state at ``s`` from all neighbours, or the outcome of the failure."""
        groups = self.groups_at(s)
        refined: RefinedState | None
        if near and same_unknowns(*near):
            guess, doubt = self._guess(s, groups, near)
            if not doubt < 1:
                return Outcome.PATH_LOST
            gap = guess.y[guess.equations.layout.gap]
            if not (np.isfinite(gap).all() and gap.min() > 0 and guess.cavity_stretch > 0):
                return Outcome.NOT_FINITE
            spread = max(abs(guess.minimum_position - one.point.state.minimum_position) for one in near)
            refined = self.corrector.solve(guess, groups, spread)
        else:
            refined = self.corrector.cold(groups)
        return self._accepted(s, refined, near)

    def begin(self, s: float, refined: RefinedState) -> Expansion | Outcome:
        """Return the expansion of a state that is known already, with a full film, or the outcome of the failure."""
        self.corrector.move_to(refined)
        groups = self.groups_at(s)
        if refined.state is not None:  # series need the groups of the path to the last digit, and the state's own Jacobian
            state = replace(refined.state.without_inverse(), groups=with_positive_gap(groups)[0])
            refined = replace(refined, groups=groups, state=state)
        return self._accepted(s, refined, [])

    def _accepted(self, s: float, refined: RefinedState | None, near: Sequence[Expansion]) -> Expansion | Outcome:
        """Return the expansion of a state whose error is within the tolerance, else its outcome."""
        if refined is None:
            return Outcome.PATH_LOST
        if refined.state is None or refined.estimate is None or not refined.estimate.total <= self.tolerance:
            self.failure = refined
            return refined.outcome
        refined = replace(refined, outcome=Outcome.CONVERGED)  # rounding limits it, within the tolerance
        return self._expanded(s, refined, min((one.radius for one in near), default=1.0))

    def _expanded(self, s: float, refined: RefinedState, near: float) -> Expansion:
        state, values, estimate = refined.state, refined.values, refined.estimate
        assert state is not None and values is not None and estimate is not None and refined.fine is not None
        if state.root.inverse is None:
            state = state.corrected()
        y, inverse, state = state.y, state.root.inverse, state.without_inverse()
        assert inverse is not None
        with np.errstate(all="ignore"):  # values that are not finite are cut off below
            if self.analytic:
                direction, shifts = shift_along(self.groups_at(s), state.groups, self.direction, self.order)
                found = expand(state.equations, y, inverse, state.groups, direction, shifts, self.order)
                known = self._radius(s, state, found, 1.0)
            else:
                found, known = self._sampled(s, state, inverse, near)
        numbers = values.array()
        exists = [column for column in (SERIES_COLUMNS if self.moves else []) if np.isfinite(numbers[column])]
        finite = np.isfinite(np.hstack([found.unknowns, found.observables[:, exists]])).all(axis=1)
        order = self.order if finite.all() else max(1, int(np.argmin(finite)) - 1)
        unknowns, observables_of_rows, logs = (part[: order + 1] for part in found)
        nothing = np.full((order + 1, 1), np.nan)
        series, logs = np.hstack([observables_of_rows, nothing]), np.hstack([logs, nothing])
        series[0] = *numbers, values.minimum_position
        positive = np.isfinite(logs[0]) & (series[0] > 0)
        logs[0, positive] = np.log(series[0, positive])
        errors = np.full(POSITION + 1, np.nan)
        errors[: len(estimate.relative)] = np.maximum(estimate.relative, NEGLIGIBLE * estimate.total)
        errors[POSITION] = estimate.minimum_position
        self._last = state, inverse
        point = LinePoint(replace(refined, state=state), state, unknowns, refined.fine)
        return Expansion(s, point, series, logs, errors, known)

    def _inverse_of(self, state: State) -> Inverse:
        """Return the inverse of the Jacobian at a state, computed if it is not the last one."""
        if self._last is None or self._last[0] is not state:
            self._last = state, state.equations.inverse(state.y)
        return self._last[1]

    def _radius(self, s: float, state: State, found: Expanded, reach: float) -> float:
        """Return an estimate of the radius of convergence of gap and observables."""
        of_values = found.observables[:, SERIES_COLUMNS] / self.scales(found.observables[:1], np.array([s]))[:, SERIES_COLUMNS]
        rounding = max(COEFFICIENT_NOISE, NEGLIGIBLE * self.tolerance)
        return min(radius(each, reach, rounding) for each in (found.unknowns[:, : state.mesh.size], of_values))

    def _sampled(self, s: float, state: State, inverse: Inverse, near: float) -> tuple[Expanded, float]:
        """Return the series of a film from samples, and its radius of convergence."""
        reach = max(MIN_LOG_STEP, SAMPLE_RADIUS_RATIO * near)
        while True:
            samples = interval(reach)
            direction, shifts = shift_along(self.groups_at(s), state.groups, self.direction, len(samples.places) - 1)
            models = (
                [] if self.uniform else [with_ending_of(state, self.groups_at(s + t).model) for t in samples.places.tolist()]
            )
            around = (state.equations, state.y, inverse, state.groups, direction, shifts)
            found = expand(*around, self.order, samples, models)
            known = self._radius(s, state, found, reach)
            if not (np.isfinite(found.unknowns).all() and np.isfinite(known)):  # the law is too steep for such a neighbourhood
                known = reach
            if reach <= max(MIN_LOG_STEP, STEP_GROWTH * SAMPLE_RADIUS_RATIO * known):
                return found, known
            reach = max(MIN_LOG_STEP, SAMPLE_RADIUS_RATIO * known)

    def _guess(self, s: float, groups: Groups, near: Sequence[Expansion]) -> tuple[State, float]:
        """Return a guess of the state at ``s``, and the uncertainty of the logarithms of its unknowns."""
        base, doubt = with_positive_gap(groups)[0], 0.0
        last: LinePoint = near[-1].point
        if base.model.cavitation is not last.state.groups.model.cavitation:
            base = replace(base, model=with_ending_of(last.state, base.model))
        nearest = min(near, key=lambda each: abs(s - each.coordinate))
        mesh_of = nearest.point
        if len(near) == 1:
            w, doubt = beyond(mesh_of.unknowns, s - nearest.coordinate)
        else:
            left, right = near
            part = (s - left.coordinate) / ((right.coordinate - left.coordinate) or 1.0)
            w = between(left, right, mesh_of, np.array([part]))[0]
            # No gap follows a group by more than its first power: such a polynomial is made of series that do not converge.
            gap = mesh_of.state.equations.layout.gap
            if not np.abs((w - mesh_of.unknowns[0])[gap]).max() < 1 + abs(s - nearest.coordinate):
                w = mesh_of.unknowns[0]
        return self.state(base, mesh_of, w), doubt

    def guess_at(self, left: Expansion, right: Expansion, s: float) -> State:
        """Return a guess of the state between two expansions, on the mesh of the nearer one."""
        for end in (left, right):
            if s == end.coordinate:
                found: State = end.point.state
                return found
        if not same_unknowns(left, right):
            point = self.corrector.cold(self.groups_at(s))
            assert point is not None and point.state is not None
            return point.state
        return self._guess(s, self.groups_at(s), [left, right])[0]

    def point_at(
        self, left: Expansion, right: Expansion, s: float, rtol: float | None = None, near: RefinedState | None = None
    ) -> RefinedState:
        """Return the verified state between two expansions, on a neighbour's mesh where that holds the tolerance."""
        rtol = self.tolerance if rtol is None else rtol
        groups = self.groups_at(s)
        if near is not None and near.state is not None and near.groups.model == groups.model:
            point = self._verified(near.state, with_positive_gap(groups)[0], groups, near.fine, rtol, near.state.root.inverse)
            if point is not None:
                return point
        guess = self.guess_at(left, right, s)
        end = on(guess.mesh, (left, right))
        if end is not None and end.refined.estimate is not None and end.refined.estimate.total <= rtol:
            point = self._verified(guess, guess.groups, groups, end.fine, rtol)
            if point is not None:
                return point
        tolerances = mesh_tolerances_for(rtol)
        if guess.groups.model.cavitation is groups.model.cavitation:
            return converge(guess, groups, rtol, tolerances)
        point = converge(guess, replace(groups, model=guess.groups.model), rtol, tolerances)
        return replace(point, groups=groups) if keeps_cavity(point, groups) else solve_cold_line(groups, rtol)

    def _verified(
        self,
        guess: State,
        base: Groups,
        groups: Groups,
        fine: FineOperators | None,
        rtol: float,
        kept: Inverse | None = None,
    ) -> RefinedState | None:
        """Return the state of ``base`` on the mesh of a guess; None if its error exceeds the tolerance."""
        state = solve_state(base, guess.equations.operators, guess, newton_tolerance(rtol), kept=kept)
        point = verify(state, groups, fine, rtol) if state.outcome.ok and fine is not None else None
        return point if point is not None and point.outcome.ok else None

    def state(self, groups: Groups, of: LinePoint, w: Array) -> State:
        """Return the state with unknowns ``w``, which hold logarithms of gaps, on the mesh of a point."""
        operators = of.state.equations.operators
        y = from_logs(of.state.equations, w)
        if operators.model != groups.model:
            operators = Operators(operators.mesh, groups.model)
        scale = float(y[of.state.equations.layout.flux_gap.start]) ** 2
        equations = Equations(operators, float(groups.speed), contact_law(groups), scale)
        return State(groups, equations, y, Root(y, Outcome.CONVERGED, 0, 0, 0.0, 0.0, None, None), 0.0)

    def checked_error(self, left: Expansion, right: Expansion, parts: Array, values: Callable[[], Array]) -> Array:
        """Return the largest difference of ``values()`` from corrected states, where the law is not smooth."""
        same = left.point.state.mesh is right.point.state.mesh
        found = np.zeros(POSITION + 1) if same else NEGLIGIBLE * self.tolerance + self.mesh_disagreement(left, right)
        if self.certain or not self.moves or not same_unknowns(left, right):
            return found
        places = left.coordinate + parts * (right.coordinate - left.coordinate)
        corrected = self._corrected(left, right, parts)
        everything = values()
        known, scales = everything[:, :POSITION], self.scales(everything, places)[:, :POSITION]
        with np.errstate(all="ignore"):  # values that are not finite count as wrong
            wrong = np.abs(corrected - known) / scales
        wrong = np.where(np.isfinite(known), np.nan_to_num(wrong, nan=np.inf, posinf=np.inf), 0.0).max(axis=0)
        beyond = wrong - np.maximum(left.errors, right.errors)[:POSITION]
        found[:POSITION] += SAFETY * np.where(beyond > 0, beyond, 0.0)
        return found

    def mesh_disagreement(self, left: Expansion, right: Expansion) -> Array:
        """Return half the difference of both ends' series in the middle, less what truncation explains."""
        if not (self.moves and same_unknowns(left, right)):
            return np.zeros(POSITION + 1)
        order = min(left.order, right.order)
        steps = (0.5 * (right.coordinate - left.coordinate) * np.array([1.0, -1.0])[:, None]) ** np.arange(order + 1)
        terms = np.stack([left.series[: order + 1], right.series[: order + 1]]) * steps[:, :, None]
        values = terms.sum(axis=1)
        with np.errstate(all="ignore"):  # a series may lead to no number
            apart = np.abs(values[1] - values[0]) - SAFETY * np.abs(terms[:, -2:]).max(axis=1).sum(axis=0)
        scales = self.scales(values.mean(axis=0)[None], np.array([0.5 * (left.coordinate + right.coordinate)]))[0]
        found = 0.5 * np.maximum(np.nan_to_num(apart), 0.0) / scales
        found[READ_COLUMNS] = found[ROW["central_gap"]], 0.0  # the minimum has no series
        return np.asarray(found)

    def _corrected(self, left: Expansion, right: Expansion, parts: Array) -> Array:
        """Return observables between two expansions, corrected with the Jacobian of the nearer end."""
        # A guess from another mesh is corrected twice, as it is worse between the nodes.
        if left.point.state.mesh is right.point.state.mesh:
            return self._corrected_by(right, left, right, parts, 1)
        nearer = [(left, parts[parts < 0.5]), (right, parts[parts >= 0.5])]
        return np.concatenate([self._corrected_by(end, left, right, some, 2) for end, some in nearer])

    def _corrected_by(self, end: Expansion, left: Expansion, right: Expansion, parts: Array, times: int) -> Array:
        """Return observables between two expansions, corrected ``times`` times with the Jacobian of one end."""
        state: State = end.point.state
        t = left.coordinate + parts * (right.coordinate - left.coordinate) - end.coordinate
        direction, _ = shift_along(self.groups_at(end.coordinate), state.groups, self.direction, 1)
        models = (
            [] if self.uniform else [with_ending_of(state, self.groups_at(end.coordinate + each).model) for each in t.tolist()]
        )
        around, load = around_state(state.equations, state.equations.law, state.groups, direction, t, models)
        y, inverse = from_logs(state.equations, between(left, right, end.point, parts)), self._inverse_of(state)
        with np.errstate(all="ignore"):
            for _ in range(times):
                y = y + state.equations.units(y) * inverse(residuals(around, y))
            return observables_of_rows(around, y, load)

    def read(self, left: Expansion, right: Expansion, parts: Array) -> tuple[Array, Array, Sequence[int]]:
        """Return the minimum gap and its position, on the mesh of the two that resolves each better."""
        if not self.moves:
            return np.empty((len(parts), 0)), np.empty((len(parts), 0)), []
        ends = (left, right)
        if not same_unknowns(left, right):
            a, b = (end.series[0, READ_COLUMNS] for end in ends)
            at_ends = np.maximum(left.errors[READ_COLUMNS], right.errors[READ_COLUMNS])
            return (
                a + parts[:, None] * (b - a),
                np.abs((b - a) / [a[0], 1.0]) + at_ends + np.zeros((len(parts), 1)),
                READ_COLUMNS,
            )
        at_ends = np.maximum(left.errors[READ_COLUMNS], right.errors[READ_COLUMNS])
        finer, coarser = sorted((left.point, right.point), key=lambda point: -point.state.mesh.size)
        values, error = minimum_between(left, right, finer, parts)
        if finer.state.mesh is not coarser.state.mesh:
            others, of_others = minimum_between(left, right, coarser, parts)
            better = of_others < error
            values, error = np.where(better, others, values), np.where(better, of_others, error)
        return values.T, np.stack([np.maximum(at_ends[0], error), np.full(len(parts), at_ends[1])], axis=1), READ_COLUMNS


def has_formulas(model: Model) -> bool:
    """Return whether the gradient of a film and its drag are smooth functions that jets and complex numbers pass through."""
    film = model.film
    return (
        model.cavitation is not Cavitation.REFORM
        and (model.profile.is_parabola or model.cavitation is Cavitation.NONE)
        and isinstance(film, Newtonian)
        and film.is_smooth
        and isinstance(film.viscosity, Constant | Barus | Roelands)
        and isinstance(film.density, Incompressible | DowsonHigginson)
    )


def same_unknowns(*near: Expansion) -> bool:
    """Return whether states have the same unknowns."""
    return len({_unknowns_of(end.point.state.groups.model) for end in near}) == 1


def _unknowns_of(model: Model) -> tuple[bool, Cavitation]:
    """Return whether the fluid pressure is an unknown, and the cavitation, which adds the places of its boundaries."""
    return model.film.uses_pressure, model.cavitation
