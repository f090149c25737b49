"""States of a ball along a path with their slopes."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from stribeck._types import Array, Flags
from stribeck.contacts.cut_off import far_film
from stribeck.contacts.groups import Groups
from stribeck.equations.point.observables import OBSERVABLES, WITHIN, identity_error
from stribeck.equations.point.system import Equations, Unknowns
from stribeck.fluids.fluid import Cavitation
from stribeck.numerics.hermite import weights_through
from stribeck.numerics.settings import HALF_DIGITS, LOG_STEP, MAX_AMPLIFICATION, MIN_LOG_STEP, SHARE
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import AREA
from stribeck.quantities.results import ByValue, equal_values
from stribeck.solver.path.hermite_path import HermitePath, Knot
from stribeck.solver.point.estimate import without_tolerance
from stribeck.solver.point.level import Level, predicted
from stribeck.solver.point.sensitivity import changes_along, measured_change
from stribeck.solver.point.solve import solve_cold, solve_from
from stribeck.solver.point.state import PointState, measured

UNIT_SCALED = ("contact_load_share", "fluid_load_share", "minimum_angle", AREA)  # Observables whose errors are absolute
COLUMNS = (*OBSERVABLES, *WITHIN, AREA)
SHARES = (OBSERVABLES.index("contact_load_share"), OBSERVABLES.index("fluid_load_share"))
ONE_SIGNED = [OBSERVABLES[i] for i in SHARES] + [
    "central_gap",
    "central_pressure",
    "minimum_gap",
    "minimum_gap_on_axis",
    "J_pcx",
    AREA,
]
SUMMANDS = ((OBSERVABLES.index("J_pcx"), OBSERVABLES.index("J_published")),)
ABSOLUTE = [COLUMNS.index(name) for name in UNIT_SCALED]
OFFSET, CENTRAL_GAP = COLUMNS.index("offset"), COLUMNS.index("central_gap")
WHOLE = [COLUMNS.index(name) for name in ("J_balanced", "J_published")]
FRICTION = [i for i, name in enumerate(COLUMNS) if name.startswith("J_") or name in WITHIN]

CutOffs = Callable[[float], tuple[float, float]]
"""Logarithms of the radii up to which friction by shear and by pressure counts, at a coordinate."""


@dataclass(frozen=True, eq=False)
class BallKnot(Knot):
    """A solved state of a ball with the derivatives of its unknowns, by which neighbours are predicted."""

    change: Unknowns | None  # None at rest

    def moved(self, step: float) -> Level:
        """Return the state moved by a step of the coordinate along its derivatives, the gap by its logarithm."""
        level: Level = self.state.work.fine
        assert self.change is not None
        y, change = level.unknowns, self.change
        gap = y.gap * np.exp(step * change.gap / y.gap)
        there = Unknowns(gap, y.fluid + step * change.fluid, y.offset + step * change.offset)
        return replace(level, iterated=replace(level.iterated, unknowns=there))


class BallKnots:
    """The states of a ball along one coordinate: ``groups_at(s)`` gives the groups there."""

    path = HermitePath
    names = COLUMNS
    shares = SHARES
    one_signed = np.isin(COLUMNS, ONE_SIGNED)
    summands = SUMMANDS

    def __init__(
        self, groups_at: Callable[[float], Groups], rtol: float, cut_offs: CutOffs | None = None, has_area: bool = False
    ) -> None:
        self.groups_at, self.rtol, self.cut_offs, self.has_area = groups_at, rtol, cut_offs, has_area
        self.last: PointState | None = None  # The last state, with its factors
        self.failure: PointState | None = None

    @cached_property
    def controlled(self) -> Flags:
        """All observables that ``rtol`` limits in a state."""
        breaks = self.groups_at(0.0).model.cavitation is not Cavitation.NONE
        return ~np.isin(COLUMNS, (*WITHIN, *without_tolerance(breaks)))

    def units(self, s: Array) -> Array:
        """Return the speeds for the friction integrals, which are proportional to it in boundary lubrication, else one."""
        found = np.ones((len(s), len(COLUMNS)))
        speeds = self._speeds(s)
        found[:, FRICTION] = np.where(speeds > 0, speeds, 1.0)[:, None]
        return found

    def scales(self, values: Array, s: Array) -> Array:
        """Return the scales of the errors of observables, as for a state."""
        found = np.fmax(np.abs(values), np.finfo(float).tiny)
        found[:, ABSOLUTE] = 1.0
        found[:, OFFSET] = np.maximum(found[:, OFFSET], found[:, CENTRAL_GAP])  # it crosses zero where films become thick
        whole = np.abs(values[:, WHOLE]).max(axis=1)
        found[:, FRICTION] = np.maximum(np.fmax(whole, np.finfo(float).tiny), self._speeds(s))[:, None]
        return found

    def _speeds(self, s: Array) -> Array:
        """Return the speed groups at coordinates, shape (len(s),)."""
        return np.array([float(self.groups_at(each).speed) for each in s.tolist()])

    def _measure(self, s: float) -> Callable[[Equations, Unknowns], dict[str, float]]:
        """Return what is measured of a state: its observables, and friction up to the cut-offs where that is a part of it."""
        law = self.groups_at(s).law if self.has_area else None
        return partial(measured, law=law, cut_offs=None if self.cut_offs is None else self.cut_offs(s))

    def solve(self, s: float, near: Sequence[BallKnot] = ()) -> BallKnot | Outcome:
        """Return the state at a coordinate with its slopes."""
        groups = self.groups_at(s)
        state = self._solved(s, near)
        if not state.outcome.ok:
            self.failure = state
            return state.outcome
        self.last, change = None, None
        if groups.speed > 0:
            self.last = state
            measure = self._measure(s)
            fine = state.work.fine
            values = dict(state.values)
            if self.cut_offs is not None or self.has_area:
                besides = measure(fine.equations, fine.unknowns).items()
                values |= {name: value for name, value in besides if name in (*WITHIN, AREA)}
            along = self.groups_at(s - LOG_STEP), self.groups_at(s + LOG_STEP), 2 * LOG_STEP
            [change] = changes_along(state, {"along": along}, HALF_DIGITS).values()
            slopes = measured_change(state, along, change, measure)
            if self.cut_offs is not None:  # which move along the coordinate too
                moved = [self._measure(s + step)(fine.equations, fine.unknowns) for step in (-LOG_STEP, LOG_STEP)]
                slopes |= {name: slopes[name] + (moved[1][name] - moved[0][name]) / (2 * LOG_STEP) for name in WITHIN}
        else:
            values = dict(state.values)
            ends = [solve_cold(self.groups_at(s + step), self.rtol) for step in (LOG_STEP, -LOG_STEP)]
            slopes = {name: (ends[0].values[name] - ends[1].values[name]) / (2 * LOG_STEP) for name in values}
            if self.has_area:
                values[AREA], ahead, behind = (each.real_contact_area[0] for each in (state, *ends))
                slopes[AREA] = (ahead - behind) / (2 * LOG_STEP)
            values["J_pcx"] = slopes["J_pcx"] = 0.0  # it has nothing but rounding, which has no sign
        errors = state.errors
        if self.has_area:
            errors[AREA] = state.real_contact_area[1]
        row, slope = (np.array([each.get(name, 0.0) for name in COLUMNS]) for each in (values, slopes))
        below, here, above = self.units(np.array([s - 1, s, s + 1]))  # powers of what varies
        growth = 0.5 * np.log(above / below)
        return BallKnot(
            s,
            row / here,
            (slope - growth * row) / here,
            np.array([errors.get(name, errors["J_balanced"]) for name in COLUMNS]),
            state.without_factors(),
            change,
        )

    def _solved(self, s: float, near: Sequence[BallKnot]) -> PointState:
        """Return the state at a coordinate, from the polynomial through neighbours and their slopes."""
        groups, rtol = self.groups_at(s), SHARE * self.rtol
        if not near:
            return solve_cold(groups, rtol)
        if any(knot.change is None for knot in near):
            return solve_from(near[-1].state, groups, rtol)
        pairs = {
            knot: knot.state.work if self.last is None else knot.state.work.with_factors_of(self.last.work) for knot in near
        }

        def nearness(knot: BallKnot) -> tuple[int, bool]:
            return -round(abs(knot.coordinate - s) / MIN_LOG_STEP), pairs[knot] is not knot.state.work

        *others, neighbour = sorted(near, key=nearness)
        for knots in ([*others, neighbour], [neighbour]):
            at, along = (each[0] for each in weights_through(np.array([knot.coordinate for knot in knots]), np.array([s])))
            if np.abs(at).sum() <= MAX_AMPLIFICATION:
                break
        # Moved along its derivatives a state adds these, less itself.
        levels = [knot.moved(step) for knot, step in zip(knots, along.tolist(), strict=True)]
        prediction = predicted([*(at - 1.0), *np.ones(len(knots))], [*(knot.state.work.fine for knot in knots), *levels])
        return solve_from(replace(neighbour.state, work=pairs[neighbour]), groups, rtol, prediction)

    def states_at(self, path: HermitePath, places: Array) -> Iterator[PointState]:
        """Yield the states at coordinates, read off the path."""
        for s, row, errors in zip(places.tolist(), *path.at(places), strict=True):
            yield KnotState(self, path, s, row, errors)

    def release(self) -> None:
        """Forget the factors of the last state, which fill the memory."""
        self.last = None

    def solved_at(self, path: HermitePath, s: float, rtol: float | None = None) -> PointState:
        """Return the state at a coordinate of a path; without ``rtol`` the tolerance is that of the path."""
        return solve_from(path.nearest(s).state, self.groups_at(s), rtol or self.rtol)


class KnotState(ByValue, PointState):
    """A state read off solved states with their slopes, with fields of a state that is solved on first use."""

    def __init__(self, problem: BallKnots, path: HermitePath, s: float, row: Array, errors: Array) -> None:
        groups, scales = problem.groups_at(s), problem.scales(row[None], np.array([s]))[0]
        values, absolute_errors, scales_by_name = (
            dict(zip(OBSERVABLES, each.tolist(), strict=False)) for each in (row, errors * scales, scales)
        )
        vars(self).update(
            groups=groups,
            rtol=problem.rtol,
            outcome=Outcome.CONVERGED,
            values=values,
            absolute_errors=absolute_errors,
            scales=scales_by_name,
            identity_error=identity_error(values, float(groups.speed), far_film(groups.model)),
            load_error=values["contact_load_share"] + values["fluid_load_share"] - 1.0,
            _place=(problem, path, s),
            _within=row[len(OBSERVABLES) : len(OBSERVABLES) + len(WITHIN)].tolist(),
            _area=(float(row[-1]), float(errors[-1] * scales[-1])),
        )

    _place: tuple[BallKnots, HermitePath, float]
    _within: list[float]
    _area: tuple[float, float]

    def __eq__(self, other: object) -> bool:
        """Return whether groups, values and errors are equal."""
        if type(other) is not type(self):
            return NotImplemented
        return all(equal_values(getattr(self, name), getattr(other, name)) for name in ("groups", "values", "absolute_errors"))

    __hash__ = ByValue.__hash__

    @cached_property
    def _solved(self) -> PointState:
        problem, path, s = self._place
        return problem.solved_at(path, s)

    mesh = property(lambda self: self._solved.mesh)
    nodal_gap = property(lambda self: self._solved.nodal_gap)
    nodal_contact_pressure = property(lambda self: self._solved.nodal_contact_pressure)
    nodal_fluid_pressure = property(lambda self: self._solved.nodal_fluid_pressure)
    fields = property(lambda self: self._solved.fields)
    newton_steps = property(lambda self: self._solved.newton_steps)
    krylov_steps = property(lambda self: self._solved.krylov_steps)
    work = property(lambda self: self._solved.work)

    @property
    def within(self) -> Callable[[int, float], float] | None:
        """Friction up to a radius: that of the curve up to its own cut-offs, from there on as in the nearest solved state."""
        problem, path, s = self._place
        nearest = path.nearest(s).state.within
        if problem.cut_offs is None or nearest is None:
            return None
        cut = problem.cut_offs(s)
        return lambda which, log_radius: self._within[which] + nearest(which, log_radius) - nearest(which, cut[min(which, 1)])

    @property
    def real_contact_area(self) -> tuple[float, float]:
        """The real area of contact and its error, off the path where it has them."""
        return self._area if self._place[0].has_area else super().real_contact_area

    @property
    def lowest_pressure(self) -> float:
        """The lowest film pressure of the states around [p_Hz]."""
        _, path, s = self._place
        around = np.argsort(np.abs(path.coordinates - s))[:2]
        return min(float(path.knots[i].state.lowest_pressure) for i in around.tolist())
