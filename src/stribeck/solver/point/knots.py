"""States of a ball along a path with their slopes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from stribeck._types import Array, Flags
from stribeck.contacts.cut_off import far_film
from stribeck.contacts.groups import Groups
from stribeck.equations.point.observables import MINIMA, OBSERVABLES, WITHIN, FrictionWithin, identity_error, observables
from stribeck.equations.point.system import Equations, Unknowns
from stribeck.fluids.cavitation import Cavitation
from stribeck.numerics.settings import HALF_DIGITS, NEGLIGIBLE, SHARE
from stribeck.quantities.lazy import cached_property
from stribeck.quantities.outcome import Outcome
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.path.hermite_path import HermitePath, Knot
from stribeck.solver.point.estimate import LOOSE_OBSERVABLES
from stribeck.solver.point.sensitivity import derivatives_along
from stribeck.solver.point.solve import solve_cold, solve_from
from stribeck.solver.point.state import PointState, ReadState

__all__ = ["BallKnots", "KnotState"]

UNIT_SCALED = ("contact_load_share", "fluid_load_share", "minimum_angle")  # Observables whose errors are absolute
COLUMNS = (*OBSERVABLES, *WITHIN)
SHARES = (OBSERVABLES.index("contact_load_share"), OBSERVABLES.index("fluid_load_share"))
POSITIVE = [OBSERVABLES[i] for i in SHARES] + ["central_gap", "central_pressure", "minimum_gap", "minimum_gap_on_axis"]
ABSOLUTE = [COLUMNS.index(name) for name in UNIT_SCALED]
OFFSET = COLUMNS.index("offset")
WHOLE = [COLUMNS.index(name) for name in ("J_balanced", "J_published")]
FRICTION = [i for i, name in enumerate(COLUMNS) if name.startswith("J_") or name in WITHIN]

CutOffs = Callable[[float], tuple[float, float]]
"""Logarithms of the radii up to which friction by shear and by pressure counts, at a coordinate."""


class BallKnots:
    """The states of a ball along one coordinate: ``groups_at(s)`` gives the groups there."""

    path = HermitePath
    names = COLUMNS
    shares = SHARES
    positive = np.isin(COLUMNS, POSITIVE)

    def __init__(self, groups_at: Callable[[float], Groups], rtol: float, cut_offs: CutOffs | None = None) -> None:
        self.groups_at, self.rtol, self.cut_offs = groups_at, rtol, cut_offs
        self.neighbours = Neighbours(SHARE * rtol)
        self.failure: PointState | None = None

    @cached_property
    def controlled(self) -> Flags:
        """All observables that ``rtol`` limits in a state."""
        is_full = self.groups_at(0.0).model.cavitation is Cavitation.NONE
        loose = (*MINIMA, *WITHIN) if is_full else (*MINIMA, *WITHIN, *LOOSE_OBSERVABLES)
        return np.array([name not in loose for name in COLUMNS])

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
        found[:, OFFSET] = np.maximum(found[:, OFFSET], NEGLIGIBLE)  # it crosses zero where films become thick
        whole = np.abs(values[:, WHOLE]).max(axis=1)
        found[:, FRICTION] = np.maximum(np.fmax(whole, np.finfo(float).tiny), self._speeds(s))[:, None]
        return found

    def _speeds(self, s: Array) -> Array:
        """Return the speed groups at coordinates, shape (len(s),)."""
        return np.array([float(self.groups_at(each).speed) for each in s.tolist()])

    def _measure(self, s: float) -> Callable[[Equations, Unknowns], dict[str, float]]:
        """Return what is measured of a state: its observables, and friction up to the cut-offs where that is a part of it."""
        cut = None if self.cut_offs is None else self.cut_offs(s)

        def measured(equations: Equations, y: Unknowns) -> dict[str, float]:
            found = dict(observables(equations, y))
            if cut is None:
                return found
            at = FrictionWithin.of(equations, y, found)
            return found | {name: at(i, cut[min(i, 1)]) for i, name in enumerate(WITHIN)}

        return measured

    def solve(self, s: float, near: Sequence[Knot] = ()) -> Knot | Outcome:
        """Return the state at a coordinate with its slopes."""
        state: PointState = self.neighbours.at(self.groups_at(s))
        if not state.outcome.ok:
            self.failure = state
            return state.outcome
        groups = self.groups_at(s)
        if groups.speed > 0:
            measure = self._measure(s)
            fine = state.work.fine
            values = dict(state.values) | {
                name: value for name, value in measure(fine.equations, fine.unknowns).items() if name in WITHIN
            }
            slopes = {
                name: float(column[0])
                for name, column in derivatives_along(
                    state, {"along": lambda step: self.groups_at(s + step)}, measure, HALF_DIGITS
                ).items()
            }
        else:
            values = dict(state.values)
            step = HALF_DIGITS**0.5  # of central differences, which leave half of the digits
            ends = [solve_cold(self.groups_at(s + each), self.rtol) for each in (step, -step)]
            slopes = {name: (ends[0].values[name] - ends[1].values[name]) / (2 * step) for name in values}
        errors = state.errors
        row, slope = (np.array([each.get(name, 0.0) for name in COLUMNS]) for each in (values, slopes))
        behind, here, ahead = self.units(np.array([s - 1, s, s + 1]))  # powers of what varies
        growth = 0.5 * np.log(ahead / behind)
        return Knot(
            s,
            row / here,
            (slope - growth * row) / here,
            np.array([errors.get(name, errors["J_balanced"]) for name in COLUMNS]),
            state.without_factors(),
        )

    def states_at(self, path: HermitePath, places: Array) -> Iterator[PointState]:
        """Yield the states at coordinates, read off the path."""
        for s, row, errors in zip(places.tolist(), *path.at(places), strict=True):
            yield KnotState(self, path, s, row, errors)

    def release(self) -> None:
        """Forget the factors of the last state, which fill the memory."""
        self.neighbours.release()

    def solved_at(self, path: HermitePath, s: float, rtol: float | None = None) -> PointState:
        """Return the state at a coordinate of a path; without ``rtol`` the tolerance is that of the path."""
        return solve_from(path.nearest(s).state, self.groups_at(s), rtol or self.rtol)


class KnotState(ReadState):
    """A state read off solved states with their slopes."""

    _within: list[float]

    def __init__(self, problem: BallKnots, path: HermitePath, s: float, row: Array, errors: Array) -> None:
        scales = problem.scales(row[None], np.array([s]))[0]
        values = dict(zip(OBSERVABLES, row.tolist(), strict=False))
        groups = problem.groups_at(s)
        self.read(
            groups,
            problem.rtol,
            values,
            dict(zip(OBSERVABLES, (errors * scales).tolist(), strict=False)),
            dict(zip(OBSERVABLES, scales.tolist(), strict=False)),
            identity_error(values, float(groups.speed), far_film(groups.model)),
            (problem, path, s),
        )
        vars(self)["_within"] = row[len(OBSERVABLES) :].tolist()

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
    def lowest_pressure(self) -> float:
        """The lowest film pressure at the nodes of the states around [p_Hz]."""
        _, path, s = self._place
        around = np.argsort(np.abs(path.coordinates - s))[:2]
        return min(float(path.knots[i].state.lowest_pressure) for i in around.tolist())
