"""States of the line along a path: solved from a prediction, verified, and expanded."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

from stribeck._types import Array, Flags
from stribeck.contact_laws.continued import misfit
from stribeck.contact_laws.law import is_exponential
from stribeck.contacts.groups import Groups, contact_law
from stribeck.contacts.model import Model
from stribeck.equations.error_estimate import GAP_FLOOR, GAPS, FineOperators
from stribeck.equations.line import Equations, Operators
from stribeck.equations.observables import DRAG, ROW, drag_scales
from stribeck.equations.state import State, fall_of, is_thinning, solve_state
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.newton import Inverse, Root
from stribeck.numerics.panels import Mesh
from stribeck.numerics.series import ROUNDING, beyond, interval, radius
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import ABSOLUTE, ALL_NAMES, NAMES
from stribeck.solver.at_rest import shift_along, with_positive_gap
from stribeck.solver.path.corrector import FIRST_SPREAD, Corrector, from_cold, keeps_cavity
from stribeck.solver.path.expansion import (
    Direction,
    Expanded,
    around_state,
    expand_any_film,
    expand_article,
    from_logs,
    observed,
    residuals,
)
from stribeck.solver.path.interpolation import LinePoint, between, minimum_between, on
from stribeck.solver.path.path import KNOT_PART, Expansion
from stribeck.solver.refinement import RefinedState, converge, mesh_tolerances_for, newton_tolerance, verify

EXACT_ORDER, ORDER = (18, 20), (14, 16)
"""Highest orders of series for tolerances of 1e-7 and below: for films of the article if the contact law has an exact series,
and if it is a polynomial near each separation."""

ORDER_OF_ANY_FILM, ORDER_OF_CUSPS = 9, 6
"""Those for films that are sampled, and for such as have a cusp where the rate is zero: its place moves through the nodes, and
the higher the order the more it counts."""

REACH, NEAREST, FARTHEST = 0.2, 0.1, 0.27
"""Distance at which the equations are evaluated for the series, over the radius of convergence, and its limits."""

INTERVAL, INTERVAL_OF_CUSPS = 1.0, 0.7
"""Half of the interval on which films are sampled, over that distance, and of films with a cusp where the rate is zero.
Where the shear rate passes through zero at a node of a fluid that thins, that node turns sharply with the speed: on twice the
interval series were wrong from order two on."""

THINNING_PART, CUSP_PART = 0.3, 0.1
"""Part of the tolerance that states of fluids that thin must hold, as their errors differ from mesh to mesh; and of those
without a plateau at low rates: the cusp where the rate is zero moves through the nodes."""

SHORTEST_REACH = 0.02
"""Shortest such distance: the shorter it is, the more rounding counts."""

UNSEEN_PART = 1e-4
"""Change within that distance over the tolerance below which a coefficient tells nothing of the radius: where asperities
hardly touch, those of their pressure converge on a hundredth of the interval on which they begin to count."""

MOST_TRIALS = 4
"""Most expansions of a state with a new distance."""

GAP_PART = 0.2
"""Part of the usual tolerance to which a mesh resolves the gap where it is read off, for neighbouring states too."""

SPREAD = 1.0
"""Distance from the minimum gap up to which a mesh resolves the gap, over the shift of that minimum since the last state."""

BETWEEN_MESHES = 0.2
"""Part of the tolerance by which states between two meshes may be less resolved than those for which these were made."""

TRUNCATED = 2.0
"""What a series misses in the middle of an interval, over its last term there."""

UNSEEN = 2.0
"""Stated error over the largest of three corrections with the Jacobian of a neighbour, for what they do not see."""

LAW_PART = 1e-3
"""Difference of a contact law from the polynomials of its series, over the tolerance, up to which these are not checked."""

BY_CHANCE = 0.25
"""Smallest error of an observable near a state, over the largest error of that state: a single one may pass through zero."""

KEPT = 3
"""Inverses kept at a time: of both ends of an interval and of a state between."""

RESOLVED = 0.6
"""Error of the minimum gap on the finer of two meshes, over the tolerance, above which the other is read too."""

NEGLIGIBLE = 0.1
"""Error of a polynomial for the minimum gap over the tolerance, at most."""

OFFSET_FLOOR = 0.1
"""The error of the offset is relative to it where it exceeds this: it crosses zero where films become thick, as a difference
of lengths of order one."""

SIMILAR = 0.5
"""Distance from a state of a similar contact over the radius of convergence there, up to which it is a guess."""

BESIDE = 0.3
"""Distance of a similar contact in the logarithms of its groups, across the path, up to which its series converge as far."""

WORTH_VERIFYING = 5.0
"""Error of a state of a path over a smaller tolerance up to which its mesh may hold that beside: a fourth was found there."""

SAME = 1e-9
"""Relative difference of groups, and of places, that are the same."""

WILD = 12.0
"""Change of the logarithm of the least or the widest gap within a step above which polynomials predict nothing."""

DOUBTFUL = 0.8
"""Uncertainty of a prediction above which Newton's iteration does not start from it."""

POSITION = len(ALL_NAMES)
"""Column of the position of the minimum gap, after those of the observables."""

READ = [ROW["minimum_gap"], POSITION]
SMOOTH = [ROW[name] for name in NAMES if name != "minimum_gap"]
SHARES = [ROW[name] for name in ABSOLUTE]
UNLIMITED = [POSITION, ROW["exit_position"], ROW["reformation_position"]]


ANY_MESH = Mesh(np.array([-1.0, 0.0, 1.0]), 2)


class LineProblem:
    """The states of the line: ``groups_at(s)`` gives the groups at coordinate s, ``direction`` their derivatives.

    ``like`` are states along a similar contact: states of this one are sought from those, and on their meshes, which spares
    the cold start and most new meshes.  Each is verified as any other.
    """

    def __init__(
        self,
        groups_at: Callable[[float], Groups],
        direction: Direction,
        rtol: float,
        uniform: bool = True,
        like: Sequence[Expansion] = (),
    ) -> None:
        self.groups_at, self.direction, self.uniform = groups_at, direction, uniform
        start = groups_at(0.0)
        film = start.model.film
        broken = fall_of(film, 1.0).broken
        part = CUSP_PART if broken else THINNING_PART if is_thinning(film) else KNOT_PART
        self.tolerance, self.rtol = rtol, part * rtol
        self.moves = bool(start.speed > 0)
        self.analytic = uniform and Operators(ANY_MESH, start.model).is_article
        exact = self.analytic and is_exponential(start.law)
        orders = EXACT_ORDER if exact else ORDER
        self.certain = exact or (self.analytic and start.law is not None and misfit(start.law) <= LAW_PART * rtol)
        self.order_if_sampled = ORDER_OF_CUSPS if broken else ORDER_OF_ANY_FILM
        self.interval = INTERVAL_OF_CUSPS if broken else INTERVAL
        self.degree = ORDER_OF_CUSPS + 1 if broken else None
        self.order = orders[rtol < 1e-7] if self.analytic else self.order_if_sampled
        self.corrector = Corrector(groups_at, self.rtol, GAP_PART, own_inverse=True)
        self.failure: RefinedState | None = None
        self._inverses: list[tuple[State, Inverse]] = []
        kind = _unknowns_of(start.model)
        reforms = start.model.cavitation is Cavitation.REFORM
        alike = [one for one in like if _unknowns_of(one.point.state.groups.model) == kind and not reforms]
        self.like = [replace(one, coordinate=one.coordinate + self._shift(one)) for one in alike]

    def _shift(self, one: Expansion) -> float:
        """Return the way along the path to the groups that are nearest to those of a state of a similar contact."""
        d = np.array(self.direction)
        return float(d @ self._logs_from(one) / (d @ d))

    def _logs_from(self, one: Expansion) -> Array:
        """Return the logarithms of the groups of a state of a similar contact over those that have its coordinate here."""
        there, here = one.point.refined.groups, self.groups_at(one.coordinate)
        # A speed or a roughness of zero is none along the whole path.
        each = ((getattr(there, name), getattr(here, name)) for name in ("speed", "load", "roughness"))
        return np.log([float(a or 1.0) / float(b or 1.0) for a, b in each])

    @cached_property
    def held(self) -> Flags:
        """All but positions, which have errors of their own."""
        return ~np.isin(np.arange(POSITION + 1), UNLIMITED)

    @cached_property
    def signed(self) -> Flags:
        """The offset and positions; at rest the gaps too."""
        return np.isin(np.arange(POSITION + 1), [ROW["offset"], *UNLIMITED, *([] if self.moves else GAPS)])

    def scales(self, values: Array, s: Array) -> Array:
        """Return the scales of the errors of observables: the observables themselves unless they may vanish."""
        found = np.abs(values)
        found[:, SHARES] = 1.0
        found[:, ROW["exit_position"] :] = 1.0
        found[:, ROW["offset"]] = np.maximum(found[:, ROW["offset"]], OFFSET_FLOOR)
        found[:, DRAG] = drag_scales(values)
        if not self.moves:
            kappa = np.array([float(self.groups_at(c).relative_roughness) for c in s.tolist()])
            found[:, GAPS] = np.maximum(found[:, GAPS], GAP_FLOOR * kappa[:, None])
        found[found == 0] = 1.0
        return found

    @property
    def negligible(self) -> float:
        """A part of the tolerance."""
        return NEGLIGIBLE * self.tolerance

    def read_scales(self, values: Array) -> Array:
        """Return the lowest minimum gap, and the half-width for its position."""
        return np.append(values[:, :1].min(axis=0), np.ones(values.shape[1] - 1)) if values.size else np.empty(0)

    def solve(self, s: float, near: Sequence[Expansion]) -> Expansion | Outcome:
        """Return the expanded state at ``s``, see :class:`stribeck.solver.path.path.Problem`."""
        groups = self.groups_at(s)
        same = self._same(s, groups)
        if same is not None:
            return same
        refined = self._from_similar(s, groups, near)
        if refined is not None:
            pass
        elif near and _alike(*near):
            guess, doubt = self._guess(s, groups, near)
            if not doubt <= DOUBTFUL:
                return Outcome.PATH_LOST
            gap = guess.y[guess.equations.layout.gap]
            if not (np.isfinite(gap).all() and gap.min() > 0 and guess.dilation > 0):
                return Outcome.NOT_FINITE
            if any(abs(np.log(of(gap) / of(one.point.state.gap))) > WILD for of in (np.min, np.max) for one in near):
                return Outcome.PATH_LOST
            spread = max(abs(guess.minimum_position - one.point.state.minimum_position) for one in near)
            refined = self.corrector.solve(guess, groups, SPREAD * spread)
        else:
            refined = self.corrector.cold(groups)
        return self._accepted(s, refined, near)

    def _accepted(self, s: float, refined: RefinedState | None, near: Sequence[Expansion]) -> Expansion | Outcome:
        """Return the expansion of a state whose error is within the tolerance, else its outcome."""
        if refined is None:
            return Outcome.PATH_LOST
        if refined.state is None or refined.estimate is None or not refined.estimate.total <= self.tolerance:
            self.failure = refined
            return refined.outcome
        refined = replace(refined, outcome=Outcome.CONVERGED)  # rounding limits it, within the tolerance
        similar = self._similar(s)
        if similar is not None and (np.abs(self._logs_from(similar)) < BESIDE).all():
            near = [similar]
        return self._expanded(s, refined, min((one.radius for one in near), default=2.0))

    def _similar(self, s: float) -> Expansion | None:
        """Return the nearest state of a similar contact, if its series reaches here."""
        found = min(self.like, key=lambda one: abs(one.coordinate - s), default=None)
        return None if found is None or abs(found.coordinate - s) > SIMILAR * found.radius else found

    def _same(self, s: float, groups: Groups) -> Expansion | None:
        """Return the state of a similar contact that has these groups, as where only its friction or viscosity differs."""
        found = min(self.like, key=lambda one: abs(one.coordinate - s), default=None)
        if found is None or abs(found.coordinate - s) > SAME:
            return None
        point: LinePoint = found.point
        estimate = point.refined.estimate
        if not _agree(point.refined.groups, groups):
            return None
        if estimate is None or estimate.total > self.tolerance or found.order < self.order:
            return None
        self.corrector.move_to(point.state.equations.operators, point.fine)
        return replace(found, coordinate=s)

    def _from_similar(self, s: float, groups: Groups, near: Sequence[Expansion]) -> RefinedState | None:
        """Return the state from the nearest one of a similar contact, on its mesh; None if there is none, or it fails."""
        found = self._similar(s)
        if found is None:
            return None
        point: LinePoint = found.point
        w, doubt = beyond(point.unknowns, s - found.coordinate)
        if not doubt <= DOUBTFUL:
            return None
        base = with_positive_gap(groups)[0]
        guess = self.state(replace(base, model=as_in(point.state, base.model)), point, w)
        positions = [one.point.state.minimum_position for one in near]
        spread = max((abs(guess.minimum_position - each) for each in positions), default=FIRST_SPREAD)
        self.corrector.move_to(guess.equations.operators, point.fine)
        refined = self.corrector.solve(guess, groups, SPREAD * spread)
        return refined if refined.outcome.ok else None

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
                found = expand_article(state.equations, y, inverse, state.groups, direction, shifts, self.order)
                known = self._radius(s, state, found, 1.0)
            else:
                found, known = self._sampled(s, state, inverse, near)
        numbers = values.array(in_article=False)
        exists = [column for column in (SMOOTH if self.moves else []) if np.isfinite(numbers[column])]
        finite = np.isfinite(np.hstack([found.unknowns, found.observables[:, exists]])).all(axis=1)
        order = self.order if finite.all() else max(1, int(np.argmin(finite)) - 1)
        unknowns, observed, logs = (part[: order + 1] for part in found)
        nothing = np.full((order + 1, 1), np.nan)
        series, logs = np.hstack([observed, nothing]), np.hstack([logs, nothing])
        series[0] = *numbers, values.minimum_position
        positive = np.isfinite(logs[0]) & (series[0] > 0)
        logs[0, positive] = np.log(series[0, positive])
        errors = np.full(POSITION + 1, np.nan)
        errors[: len(estimate.relative)] = np.maximum(estimate.relative, BY_CHANCE * estimate.total)
        errors[POSITION] = estimate.minimum_position
        if state.equations.operators.is_article:
            errors[ROW["viscous_upper"]] = errors[ROW["viscous_balanced"]]
        self._keep(state, inverse)
        point = LinePoint(replace(refined, state=state), state, unknowns, refined.fine)
        return Expansion(s, point, series, logs, errors, known)

    def _keep(self, state: State, inverse: Inverse) -> None:
        """Keep the inverse of a state for those beside it, and of the last ones before: each is as large as an operator."""
        self._inverses = [*self._inverses[1 - KEPT :], (state, inverse)]

    def _inverse_of(self, state: State) -> Inverse:
        """Return the inverse of the Jacobian at a state, made anew if it is not kept."""
        known = next((inverse for each, inverse in self._inverses if each is state), None)
        if known is None:
            known = state.equations.inverse(state.y)
            self._keep(state, known)
        return known

    def _radius(self, s: float, state: State, found: Expanded, reach: float) -> float:
        """Return an estimate of the radius of convergence of gap and observables."""
        of_values = found.observables[:, SMOOTH] / self.scales(found.observables[:1], np.array([s]))[:, SMOOTH]
        rounding = max(ROUNDING, UNSEEN_PART * self.tolerance)
        return min(radius(each, reach, rounding) for each in (found.unknowns[:, : state.mesh.size], of_values))

    def _sampled(self, s: float, state: State, inverse: Inverse, near: float) -> tuple[Expanded, float]:
        """Return the series of a film that is sampled, and an estimate of its radius, on which the samples depend."""
        reach = max(SHORTEST_REACH, REACH * near)
        for trial in range(MOST_TRIALS):
            samples = interval(self.interval * reach, degree=self.degree)
            direction, shifts = shift_along(self.groups_at(s), state.groups, self.direction, len(samples.places) - 1)
            models = [] if self.uniform else [as_in(state, self.groups_at(s + t).model) for t in samples.places.tolist()]
            around = (state.equations, state.y, inverse, state.groups, direction, shifts)
            found = expand_any_film(*around, samples, models, self.order)
            known = self._radius(s, state, found, reach)
            if not (
                np.isfinite(found.unknowns).all() and np.isfinite(known)
            ):  # the law is too steep for so wide a neighbourhood
                known = reach
                reach = 0.25 * reach
            elif reach > FARTHEST * known or (trial == 0 and reach < NEAREST * known):
                reach = max(SHORTEST_REACH, REACH * known)
            else:
                break
        return found, known

    def _guess(self, s: float, groups: Groups, near: Sequence[Expansion]) -> tuple[State, float]:
        """Return a guess of the state at ``s``, and the uncertainty of the logarithms of its unknowns."""
        base, doubt = with_positive_gap(groups)[0], 0.0
        last: LinePoint = near[-1].point
        if base.model.cavitation is not last.state.groups.model.cavitation:
            base = replace(base, model=as_in(last.state, base.model))
        if len(near) == 1:
            w, doubt = beyond(last.unknowns, s - near[0].coordinate)
            mesh_of = last
        else:
            left, right = near
            part = (s - left.coordinate) / ((right.coordinate - left.coordinate) or 1.0)
            mesh_of = left.point if part < 0.5 else right.point
            w = between(left, right, mesh_of, np.array([part]))[0]
        return self.state(base, mesh_of, w), doubt

    def guess_at(self, left: Expansion, right: Expansion, s: float) -> State:
        """Return a guess of the state between two expansions, on the mesh of the nearer one."""
        for end in (left, right):
            if s == end.coordinate:
                found: State = end.point.state
                return found
        if not _alike(left, right):
            point = self.corrector.cold(self.groups_at(s))
            assert point is not None and point.state is not None
            return point.state
        return self._guess(s, self.groups_at(s), [left, right])[0]

    def point_at(
        self, left: Expansion, right: Expansion, s: float, rtol: float | None = None, near: RefinedState | None = None
    ) -> RefinedState:
        """Return the verified state between two expansions.

        It lies on the mesh of a state ``near`` or of the nearer expansion if that holds the tolerance, else on one of its own.
        """
        rtol = self.tolerance if rtol is None else rtol
        groups = self.groups_at(s)
        if near is not None and near.state is not None and near.groups.model == groups.model:
            point = self._verified(near.state, with_positive_gap(groups)[0], groups, near.fine, rtol, near.state.root.inverse)
            if point is not None:
                return point
        guess = self.guess_at(left, right, s)
        end = on(guess.mesh, (left, right))
        if end is not None and end.refined.estimate is not None and end.refined.estimate.total <= WORTH_VERIFYING * rtol:
            point = self._verified(guess, guess.groups, groups, end.fine, rtol)
            if point is not None:
                return point
        tail, gap_tail = mesh_tolerances_for(rtol)
        tolerances = tail, GAP_PART * gap_tail
        if guess.groups.model.cavitation is groups.model.cavitation:
            return converge(guess, groups, rtol, tolerances)
        point = converge(guess, replace(groups, model=guess.groups.model), rtol, tolerances)
        return replace(point, groups=groups) if keeps_cavity(point, groups) else from_cold(groups, rtol)

    def _verified(
        self,
        guess: State,
        base: Groups,
        groups: Groups,
        fine: FineOperators | None,
        rtol: float,
        kept: Inverse | None = None,
    ) -> RefinedState | None:
        """Return the state of ``base`` on the mesh of a guess; None if that does not hold the tolerance."""
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

    def missed(self, left: Expansion, right: Expansion, parts: Array, values: Callable[[], Array]) -> Array:
        """Return the largest difference between ``values()`` and states corrected at ``parts``, where a law is not smooth."""
        same = left.point.state.mesh is right.point.state.mesh
        found = np.zeros(POSITION + 1) if same else BETWEEN_MESHES * self.tolerance + self._apart(left, right)
        if self.certain or not self.moves or not _alike(left, right):
            return found
        places = left.coordinate + parts * (right.coordinate - left.coordinate)
        corrected = self._corrected(left, right, parts)
        everything = values()
        known, scales = everything[:, :POSITION], self.scales(everything, places)[:, :POSITION]
        with np.errstate(all="ignore"):  # values that are not finite count as wrong
            wrong = np.abs(corrected - known) / scales
        wrong = np.where(np.isfinite(known), np.nan_to_num(wrong, nan=np.inf, posinf=np.inf), 0.0).max(axis=0)
        beyond = wrong - np.maximum(left.errors, right.errors)[:POSITION]
        found[:POSITION] += UNSEEN * np.where(beyond > 0, beyond, 0.0)
        return found

    def _apart(self, left: Expansion, right: Expansion) -> Array:
        """Return half the difference of the series of both meshes in the middle, where observables are the mean of both.

        What the series miss by their order is not counted.
        """
        if not (self.moves and _alike(left, right)):
            return np.zeros(POSITION + 1)
        order = min(left.order, right.order)
        steps = (0.5 * (right.coordinate - left.coordinate) * np.array([1.0, -1.0])[:, None]) ** np.arange(order + 1)
        terms = np.stack([left.series[: order + 1], right.series[: order + 1]]) * steps[:, :, None]
        values = terms.sum(axis=1)
        with np.errstate(all="ignore"):  # a series may lead to no number
            apart = np.abs(values[1] - values[0]) - TRUNCATED * np.abs(terms[:, -2:]).max(axis=1).sum(axis=0)
        scales = self.scales(values.mean(axis=0)[None], np.array([0.5 * (left.coordinate + right.coordinate)]))[0]
        found = 0.5 * np.maximum(np.nan_to_num(apart), 0.0) / scales
        found[READ] = found[ROW["central_gap"]], 0.0  # the minimum has no series
        return np.asarray(found)

    def _corrected(self, left: Expansion, right: Expansion, parts: Array) -> Array:
        """Return the observables of states between two expansions, ascending, corrected with the Jacobian of the nearer one.

        A guess from another mesh is corrected twice: it is worse between the nodes.
        """
        if left.point.state.mesh is right.point.state.mesh:
            return self._corrected_by(right, left, right, parts, 1)
        nearer = [(left, parts[parts < 0.5]), (right, parts[parts >= 0.5])]
        return np.concatenate([self._corrected_by(end, left, right, some, 2) for end, some in nearer])

    def _corrected_by(self, end: Expansion, left: Expansion, right: Expansion, parts: Array, times: int) -> Array:
        """Return the same by one of the two, on its mesh."""
        state: State = end.point.state
        t = left.coordinate + parts * (right.coordinate - left.coordinate) - end.coordinate
        direction, _ = shift_along(self.groups_at(end.coordinate), state.groups, self.direction, 1)
        models = [] if self.uniform else [as_in(state, self.groups_at(end.coordinate + each).model) for each in t.tolist()]
        around, load = around_state(state.equations, state.groups, direction, t, models)
        y, inverse = from_logs(state.equations, between(left, right, end.point, parts)), self._inverse_of(state)
        with np.errstate(all="ignore"):
            for _ in range(times):
                y = y + state.equations.units(y) * inverse(residuals(around, y))
            return observed(around, y, load)

    def read(self, left: Expansion, right: Expansion, parts: Array) -> tuple[Array, Array, Sequence[int]]:
        """Return the minimum gap and its position on the finer mesh, or each on the mesh that resolves it better."""
        if not self.moves:
            return np.empty((len(parts), 0)), np.empty((len(parts), 0)), []
        ends = (left, right)
        if not _alike(left, right):
            a, b = (end.series[0, READ] for end in ends)
            at_ends = np.maximum(left.errors[READ], right.errors[READ])
            return a + parts[:, None] * (b - a), np.abs((b - a) / [a[0], 1.0]) + at_ends + np.zeros((len(parts), 1)), READ
        at_ends = np.maximum(left.errors[READ], right.errors[READ])
        finer, coarser = sorted((left.point, right.point), key=lambda point: -point.state.mesh.size)
        values, error = minimum_between(left, right, finer, parts)
        if finer.state.mesh is not coarser.state.mesh and (error > RESOLVED * self.tolerance).any():
            others, of_others = minimum_between(left, right, coarser, parts)
            better = of_others < error
            values, error = np.where(better, others, values), np.where(better, of_others, error)
        return values.T, np.stack([np.maximum(at_ends[0], error), np.full(len(parts), at_ends[1])], axis=1), READ


def _agree(one: Any, other: Any) -> bool:
    """Return whether groups, models or their parts are the same but for the rounding of their numbers."""
    if one is other:
        return True
    if isinstance(one, float | np.ndarray):
        return np.shape(one) == np.shape(other) and np.allclose(one, other, rtol=SAME, atol=0.0, equal_nan=True)
    if is_dataclass(one) and type(one) is type(other):
        return all(_agree(getattr(one, each.name), getattr(other, each.name)) for each in fields(one) if each.compare)
    return bool(one == other)


def _alike(*near: Expansion) -> bool:
    """Return whether states have the same unknowns."""
    return len({_unknowns_of(end.point.state.groups.model) for end in near}) == 1


def _unknowns_of(model: Model) -> tuple[bool, Cavitation]:
    """Return what decides which unknowns a state has: the fluid pressure may be one, rupture and reformation add theirs."""
    return model.film.uses_pressure, model.cavitation


def as_in(state: State, model: Model) -> Model:
    """Return a model with a cavity if a state has one, else without."""
    cavitation = state.groups.model.cavitation
    if model.cavitation is cavitation:
        return model
    return replace(model, cavitation=cavitation, cavity_pressure=0.0)
