"""States of a ball along a path: solved from a prediction and expanded, see :mod:`stribeck.solver.path.path`."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from stribeck._types import Array, Flags
from stribeck.contact_laws.law import is_exponential
from stribeck.contacts.groups import Groups
from stribeck.equations.point.expansion import SHARE_COLUMN, corrected_once, expand, from_row
from stribeck.equations.point.observables import SMOOTH, WITHIN, identity_error, minima
from stribeck.equations.point.preconditioner import BandedModes
from stribeck.equations.point.sensitivity import beside
from stribeck.equations.point.system import Linear, Unknowns
from stribeck.numerics.hermite import hermite_weights
from stribeck.numerics.series import beyond, radius
from stribeck.quantities.outcome import Outcome
from stribeck.solver.path.path import (
    BETWEEN_RTOL_FRACTION,
    MAX_EXPANSIONS,
    MIN_OFFSET_SCALE,
    SAFETY_CORRECTION,
    Expansion,
    SolvedPath,
)
from stribeck.solver.point.estimate import Pair
from stribeck.solver.point.level import Level, band_for
from stribeck.solver.point.solve import solve_cold, solve_from
from stribeck.solver.point.state import PointState, ReadState

__all__ = ["CurveState", "PointProblem", "error_scales", "speeds_at"]

STATE_RTOL_FRACTION = 0.5  # Share of rtol for solving the states: errors on two meshes differ by up to twice that
SERIES_ORDERS = ((1e-4, 6), (1e-7, 8), (0.0, 10))  # Smallest rtol, and the order of series for it
GMRES_RTOL_FRACTION = 1e-2  # Relative residual of the linear systems of a series over rtol
SAMPLE_RADIUS_RATIO = 0.45  # Distance of the samples over the radius of convergence
MIN_SAMPLE_RADIUS_RATIO = 0.2  # Samples nearer than this are taken once more
MAX_SAMPLE_RADIUS_RATIO = 0.6  # Samples farther than this are taken once more
SAMPLE_NOISE = 1e-9  # Rounding of the samples as magnified in the coefficients, which do not count for the radius below it
MIN_SAMPLE_DISTANCE = 0.05
FIRST_SAMPLE_DISTANCE = 0.6
MINIMUM_SAFETY = 2.0  # Error of a minimum of the gap between two states over the larger of their errors
THIN_LOG_GAP = 0.4  # ln of the gap over its minimum up to which a place may become the minimum
UNIT_SCALED = ("contact_load_share", "fluid_load_share", "minimum_angle")  # Observables whose errors are absolute
OFFSET_COLUMN = SMOOTH.index("offset")
FRICTION_COLUMNS = [i for i, name in enumerate(SMOOTH) if name.startswith("J_")]


def speeds_at(groups_at: Callable[[float], Groups], s: Array) -> Array:
    """Return the speed groups at coordinates, shape (len(s),)."""
    return np.array([float(groups_at(each).speed) for each in s.real.tolist()])


def error_scales(names: Sequence[str], values: Array, speeds: Array) -> Array:
    """Return the scales of the errors of observables of balls by name, of the shape of ``values``, a row for each speed."""
    found = np.fmax(np.abs(values), 1e-300)
    for column, name in enumerate(names):
        if name in UNIT_SCALED:
            found[:, column] = 1.0
        elif name == "offset":
            found[:, column] = np.maximum(found[:, column], MIN_OFFSET_SCALE)
    whole = np.abs(values[:, [names.index(name) for name in ("J_balanced", "J_published")]]).max(axis=1)
    friction = [column for column, name in enumerate(names) if name.startswith("J_") or name in WITHIN]
    found[:, friction] = np.maximum(np.fmax(whole, 1e-300), speeds)[:, None]
    return found


class PointPoint(NamedTuple):
    """A solved state, without its factors, and the coefficients of its unknowns on its finer mesh."""

    state: PointState
    unknowns: Array

    @property
    def level(self) -> Level:
        """The state on its finer mesh."""
        work: Pair = self.state.work
        return work.fine


class PointProblem:
    """The states of a ball with a full film at the groups ``groups_at(s)``."""

    def __init__(self, groups_at: Callable[[float], Groups], rtol: float) -> None:
        self.groups_at, self.allowed, self.rtol = groups_at, rtol, STATE_RTOL_FRACTION * rtol
        self.exact = is_exponential(groups_at(0.0).law)
        self.order = next(order for least, order in SERIES_ORDERS if rtol >= least)
        self.failure: PointState | None = None
        self._last: tuple[float, PointState] | None = None
        self._on_others: dict[tuple[float, float], Array] = {}

    names = SMOOTH

    @property
    def controlled(self) -> Flags:
        """All observables with a series."""
        return np.ones(len(SMOOTH), dtype=bool)

    @property
    def sign_changing(self) -> Flags:
        """The offset and the friction integrals."""
        return np.isin(np.arange(len(SMOOTH)), [OFFSET_COLUMN, *FRICTION_COLUMNS])

    def scales(self, values: Array, s: Array) -> Array:
        """Return the scales of the errors of observables, as for a state."""
        return error_scales(SMOOTH, values, speeds_at(self.groups_at, s))

    negligible = 0.0

    def read_scales(self, values: Array) -> Array:
        """Return no scales, as every observable of the path has a series."""
        return np.empty(0)

    def read(self, left: Expansion, right: Expansion, parts: Array) -> tuple[Array, Array, Sequence[int]]:
        """Return no values: minima of the gap are read on request, as rtol does not limit them."""
        return np.empty((len(parts), 0)), np.empty((len(parts), 0)), []

    def solve(self, s: float, near: Sequence[Expansion]) -> Expansion | Outcome:
        """Return the expanded state at ``s``, see :class:`stribeck.solver.path.path.Problem`."""
        groups = self.groups_at(s)
        start, predicted = None, None
        if near:
            nearest = min(near, key=lambda one: abs(one.coordinate - s))
            start, predicted = nearest.point.state, self.guess(nearest, s)
            if self._last is not None and self._last[0] == nearest.coordinate:
                start = self._last[1]
        state = solve_cold(groups, self.rtol) if start is None else solve_from(start, groups, self.rtol, (), predicted)
        if not state.outcome.ok:
            self.failure = state
            return state.outcome
        state = with_factors(state)
        self._last = s, state
        return self._expanded(s, state, near[-1].radius if near else FIRST_SAMPLE_DISTANCE / SAMPLE_RADIUS_RATIO)

    def _expanded(self, s: float, state: PointState, near: float) -> Expansion | Outcome:
        pair: Pair = state.work
        level = pair.fine
        preconditioner = level.iterated.preconditioner
        reach = max(MIN_SAMPLE_DISTANCE, SAMPLE_RADIUS_RATIO * near)
        values = np.array([state.values[name] for name in SMOOTH])
        scales = self.scales(values[None], np.array([s]))
        trial = 0
        while True:
            found = expand(
                level.equations,
                level.unknowns,
                preconditioner,
                lambda t: self.groups_at(s + t),
                self.order,
                reach,
                GMRES_RTOL_FRACTION * self.allowed,
            )
            if found is None:
                return Outcome.SINGULAR
            gaps = found.unknowns[:, : level.unknowns.gap.size]
            known = min(radius(each, reach, SAMPLE_NOISE) for each in (gaps, found.observables / scales))
            if not (np.isfinite(known) and np.isfinite(found.observables).all()):
                known, reach = reach, max(MIN_SAMPLE_DISTANCE, 0.25 * reach)
            elif reach > MAX_SAMPLE_RADIUS_RATIO * known or (trial == 0 and reach < MIN_SAMPLE_RADIUS_RATIO * known):
                reach = max(MIN_SAMPLE_DISTANCE, SAMPLE_RADIUS_RATIO * known)
            else:
                break
            trial += 1
            if trial == MAX_EXPANSIONS:
                break
        series, logs = found.observables, np.full_like(found.observables, np.nan)
        series[0] = values
        if values[SHARE_COLUMN] > 0:
            logs[:, SHARE_COLUMN] = found.log_share
            logs[0, SHARE_COLUMN] = math.log(values[SHARE_COLUMN])
        errors = np.array([state.absolute_errors[name] for name in SMOOTH]) / scales[0]
        return Expansion(s, PointPoint(state.without_factors(), found.unknowns), series, logs, errors, known)

    def guess(self, of: Expansion, s: float) -> Unknowns:
        """Return a guess of the unknowns at a coordinate, on the mesh of a state."""
        row, _ = beyond(of.point.unknowns, s - of.coordinate)
        found = from_row(row, of.point.level.unknowns.gap.shape)
        return found if np.isfinite(row).all() and np.isfinite(found.gap).all() else of.point.level.unknowns

    def between(self, left: Expansion, right: Expansion, s: float) -> tuple[Unknowns, Level, float]:
        """Return unknowns between two states on the nearer mesh, that state, and the largest error of the log gap."""
        own, other = sorted((left, right), key=lambda one: abs(one.coordinate - s))
        point: PointPoint = own.point
        shape = point.level.unknowns.gap.shape
        if own is other or own.coordinate == s:
            return point.level.unknowns, point.level, 0.0
        of_own, of_other = point.unknowns, self._carried(other, own)
        length, order = other.coordinate - own.coordinate, self.order
        scale = (length ** np.arange(order + 1.0))[:, None]
        part = np.array([(s - own.coordinate) / length])
        (row, without), thin = (
            (
                sum(
                    w[0] @ (scale * each)[: k + 1]
                    for w, each in zip(hermite_weights(k, part), (of_own, of_other), strict=True)
                )
                for k in (order, order - 1)
            ),
            point.level.unknowns.gap.size,
        )
        gap, change = row[:thin], np.abs(row - without)[:thin]
        return from_row(row, shape), point.level, float(change[gap < gap.min() + THIN_LOG_GAP].max())

    def _carried(self, one: Expansion, to: Expansion) -> Array:
        """Return the coefficients of the unknowns of a state on the mesh of another."""
        if one.point.level.mesh is to.point.level.mesh:
            return np.asarray(one.point.unknowns)
        key = one.coordinate, to.coordinate
        if key not in self._on_others:
            old, new = one.point.level.mesh, to.point.level.mesh
            rows, nodes = one.point.unknowns, one.point.level.unknowns.gap.size
            fields = np.concatenate([rows[:, :nodes], rows[:, nodes:-1]]).reshape(-1, old.modes, old.rings)
            fields[0] -= np.log1p(old.radii**2)
            found = old.transfer(new, fields)
            gaps, fluids = found[: len(rows)], found[len(rows) :]
            gaps[0] += np.log1p(new.radii**2)
            fluids = fluids / np.maximum(1.0, new.radii / old.rim) ** 3
            flat = [each.reshape(len(rows), -1) for each in (gaps, fluids)]
            self._on_others[key] = np.hstack([*flat, rows[:, -1:]])
        return self._on_others[key]

    def checked_error(self, left: Expansion, right: Expansion, parts: Array, values: Callable[[], Array]) -> Array:
        """Return the largest difference of ``values()`` from corrected states, where the law is not smooth."""
        found = np.full(len(SMOOTH), BETWEEN_RTOL_FRACTION * self.allowed)
        if self.exact or self._last is None:
            return found
        at, state = self._last
        end = min((left, right), key=lambda one: abs(one.coordinate - at))
        if end.coordinate != at:
            state = with_factors(end.point.state)
        level: Level = state.work.fine
        preconditioner = level.iterated.preconditioner
        places = left.coordinate + parts * (right.coordinate - left.coordinate)
        there = values()
        scales = self.scales(there, places)
        with np.errstate(all="ignore"):
            for place, known, scale in zip(places.tolist(), there, scales, strict=True):
                if abs(place - end.coordinate) > 0.5 * (right.coordinate - left.coordinate):
                    continue  # a prediction from so far away measures itself
                equations = beside(level.equations, self.groups_at(place))
                corrected = corrected_once(equations, self.guess(end, place), preconditioner)
                wrong = np.inf if corrected is None else np.abs(corrected - known) / scale
                beyond_ends = np.nan_to_num(wrong, nan=np.inf) - np.maximum(left.errors, right.errors)
                found = np.maximum(found, np.where(beyond_ends > 0, SAFETY_CORRECTION * beyond_ends, 0.0))
        return found

    def release(self) -> None:
        """Drop the factors of the last state, which fill the memory."""
        self._last = None

    def states_at(self, path: SolvedPath, places: Array) -> Iterator[PointState]:
        """Yield the states at coordinates: read off the path, or solved where its error exceeds the tolerance."""
        for s, row, errors in zip(places.tolist(), *path.at(places), strict=True):
            yield CurveState(self, path, s, row, errors) if (errors <= self.allowed).all() else self.solved_at(path, s)

    def solved_at(self, path: SolvedPath, s: float, rtol: float | None = None) -> PointState:
        """Return the state at a coordinate of a path; without ``rtol`` the tolerance is that of the path."""
        left, right = ends_of(path, s)
        nearest = min((left, right), key=lambda one: abs(one.coordinate - s))
        predicted = self.between(left, right, s)[0]
        return solve_from(nearest.point.state, self.groups_at(s), rtol or self.allowed, predicted=predicted)


def with_factors(state: PointState) -> PointState:
    """Return a state with the preconditioner of its own Jacobian, as many systems are solved with it."""
    pair: Pair = state.work
    if pair.fine.iterated.factorisations and pair.fine.iterated.preconditioner is not None:
        return state
    level = pair.fine.with_operators()
    band = band_for(level.equations.speed, level.equations.law, level.resolution.model)
    own = BandedModes(Linear(level.equations, level.unknowns), band)
    return replace(state, work=replace(pair, fine=replace(level, iterated=replace(level.iterated, preconditioner=own))))


def ends_of(path: SolvedPath, s: float) -> tuple[Expansion, Expansion]:
    """Return the two states that a coordinate lies between."""
    interval = path.intervals[int(path.interval_of(np.array([s]))[0])]
    return interval.left, interval.right


class CurveState(ReadState):
    """A state read off Taylor series on both sides."""

    def __init__(self, problem: PointProblem, path: SolvedPath, s: float, row: Array, errors: Array) -> None:
        left, right = ends_of(path, s)
        guess, level, unsure = problem.between(left, right, s)
        lowest = minima(level.mesh, guess.gap)
        groups = problem.groups_at(s)
        values = dict(zip(SMOOTH, row.tolist(), strict=True)) | lowest
        scales = dict(zip(SMOOTH, problem.scales(row[None], np.array([s]))[0].tolist(), strict=True))
        absolute = {name: error * scales[name] for name, error in zip(SMOOTH, errors.tolist(), strict=True)}
        known: tuple[PointState, ...] = (left.point.state, right.point.state)
        for name in lowest:
            scales[name] = values[name] if name.startswith("minimum_gap") else 1.0
            own = MINIMUM_SAFETY * (max(state.errors[name] for state in known) + unsure) + float(errors.max())
            absolute[name] = own * scales[name]
        identity = identity_error(values, float(groups.speed))
        self.read(groups, problem.allowed, values, absolute, scales, identity, (problem, path, s))
        vars(self)["_lowest"] = float(guess.fluid.min())

    lowest_pressure = property(lambda self: self._lowest)
