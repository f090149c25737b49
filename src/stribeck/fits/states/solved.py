"""States of fits that are solved, each from the nearest of those before."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck._types import Array
from stribeck.contacts.cut_off import log_cut_offs
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Groups
from stribeck.equations.observables import ROW
from stribeck.equations.point.observables import FrictionWithin
from stribeck.equations.sensitivity import log_derivatives
from stribeck.fits.states.parts import FrictionParts, ModelChange, PartsOf
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outputs import GROUPS
from stribeck.solver.neighbours import Neighbours
from stribeck.solver.point.estimate import Pair
from stribeck.solver.point.sensitivity import derivatives_along, state_derivatives
from stribeck.solver.point.state import PointState
from stribeck.solver.refinement import RefinedState
from stribeck.solver.solve import stated_errors

if TYPE_CHECKING:
    from stribeck.fits.model import FrictionModel

__all__ = ["OnState", "count_states", "solved_parts"]

OnState = Callable[[], object]
"""What is called after each state that takes long to solve."""

SAFETY = 8.0  # Largest fourth derivative of a part of the friction by ln(speed), over its size (test_point_fit)

# Residual of the slopes of balls over the tolerance of the states: with the preconditioner of a neighbour their error is a
# hundred times that.  To solve them to rounding takes a sixth more of a fit of a ball in Carreau's fluid.
SLOPE_RESIDUAL = 1e-3

Columns = tuple[Array, Array, Array]
"""Values, slopes and errors of states."""

Read = Callable[[Any, Sequence[str], Sequence[str], Sequence[ModelChange]], Columns]
"""What gives some parts of a state, derivatives by some groups and along changes of the model, and errors."""


def solved_parts(model: FrictionModel, definition: Definition, rtol: float, on_state: OnState = lambda: None) -> PartsOf:
    """Return the function that solves states, each from the nearest of those before, for searches that come near again."""
    neighbours = Neighbours(rtol)
    names = ("contact_load_share", *model.rule.parts(definition))
    read = READERS[model.contact.groups.geometry](model, rtol)
    moves = np.abs(model.exponents[:, :, :3]).max(axis=(0, 1)) > 0

    def solved(groups: Groups, by: Sequence[str], changes: Sequence[ModelChange]) -> Columns:
        """Return values, slopes and errors of states, one column each."""
        found = []
        for row in zip(*(each.tolist() for each in (groups.speed, groups.load, groups.roughness)), strict=True):  # type: ignore[union-attr]
            found.append(read(neighbours.solved(Groups(*row, **groups.physics)), names, by, changes))
            on_state()
        return tuple(np.stack(column, axis=-1) for column in zip(*found, strict=True))  # type: ignore[return-value]

    def parts(groups: Groups, changes: Sequence[ModelChange]) -> FrictionParts:
        rows = np.stack(np.broadcast_arrays(groups.speed, groups.load, groups.roughness), axis=1)
        n, k = len(rows), len(names)
        values, slopes, errors = np.empty((k, n)), np.empty((k, 3 + len(changes), n)), np.empty((k, n))
        pairs, of_row = np.unique(rows[:, 1:], axis=0, return_inverse=True)
        for i, (load, roughness) in enumerate(pairs):
            here = np.nonzero(of_row.ravel() == i)[0]
            here = here[np.argsort(-rows[here, 0])]
            speed = _places(rows[here, 0], rtol)
            is_read = len(speed) < len(here)
            by = [name for name, is_moved in zip(GROUPS, moves, strict=True) if is_moved or (is_read and name == "speed")]
            states = Groups(speed, np.full(len(speed), load), np.full(len(speed), roughness), **groups.physics)
            found = solved(states, by, changes)
            found = _between_speeds(speed, found, rows[here, 0], rtol) if is_read else found
            values[:, here], slopes[:, :, here], errors[:, here] = found
        return FrictionParts(values, slopes, errors, definition)

    return one_blas_thread(parts)


def count_states(model: FrictionModel, rtol: float) -> int:
    """Return how many states are solved for all rows at one place."""
    speeds = [np.unique(model.data.values[model.data.curve == curve])[::-1] for curve in np.unique(model.data.curve)]
    return sum(map(len, speeds)) if any(model.remembers) else sum(len(_places(each, rtol)) for each in speeds)


def _places(speeds: Array, rtol: float) -> Array:
    """Return the falling speeds themselves, or fewer ones between which cubics with their slopes miss less than ``rtol``."""
    # A cubic misses by the fourth power of the step over 384 times the fourth derivative.
    step = (384 * rtol / SAFETY) ** 0.25
    count = math.ceil(math.log(speeds[0] / speeds[-1]) / step) + 1
    return speeds if len(speeds) <= count else np.geomspace(speeds[0], speeds[-1], count)


def _between_speeds(speed: Array, found: Columns, wanted: Array, rtol: float) -> Columns:
    """Return what is wanted between falling speeds: values by cubics with slopes, slopes by cubic splines."""
    from scipy.interpolate import CubicHermiteSpline, make_interp_spline

    values, slopes, errors = (each[..., ::-1] for each in found)
    at, to = np.log(speed[::-1]), np.log(wanted).clip(*np.log(speed[[-1, 0]]))
    read = CubicHermiteSpline(at, values, slopes[:, 0], axis=1)(to)
    degree = min(3, len(at) - 1)
    return (
        read,
        make_interp_spline(at, slopes, degree, axis=2)(to),
        np.stack([np.interp(to, at, row) for row in errors]) + rtol,
    )


def _cylinder_reader(model: FrictionModel, rtol: float) -> Read:
    """Return what reads the states of cylinders."""

    def read(state: RefinedState, names: Sequence[str], by: Sequence[str], changes: Sequence[ModelChange]) -> Columns:
        assert state.state is not None and state.values is not None
        rows = [ROW[name] for name in names]
        derivatives = log_derivatives(state.state, [each[1:] for each in changes])
        values = state.values.array()[rows]
        return values, np.stack([derivatives[name] for name in names]), stated_errors(state, rtol)[rows]

    return read


def _ball_reader(model: FrictionModel, rtol: float) -> Read:
    """Return what reads the states of balls: a fluid that thins far out counts up to the edge of the liquid at the start."""
    others = model.rule.of_contact(model.contact)

    def read(state: PointState, names: Sequence[str], by: Sequence[str], changes: Sequence[ModelChange]) -> Columns:
        groups = state.groups
        values, errors = (np.array([each[name] for name in names]) for each in (state.values, state.relative_errors))
        by_groups = state_derivatives(state, by, tolerance=SLOPE_RESIDUAL * rtol)
        slopes = np.array([by_groups[name] for name in names])
        if changes:
            moved = {str(change.input): partial(_moved, groups, change) for change in changes}
            along = derivatives_along(state, moved, tolerance=SLOPE_RESIDUAL * rtol)
            slopes = np.append(slopes, [along[name] for name in names], axis=1)
        if groups.model.film.uses_speed and isinstance(state.work, Pair):
            fine = state.work.fine
            within = FrictionWithin.of(fine.equations, fine.unknowns, {name: float(v) for name, v in state.values.items()})
            cut_offs = log_cut_offs(float(groups.slope(others["beta"])), others["wetted_radius"])
            for which, (name, cut) in enumerate(zip(("J_couette", "J_poiseuille"), cut_offs, strict=True)):
                row = names.index(name)
                beyond = within(which, float(cut))
                wrong = errors[row] * abs(values[row]) + abs(beyond)
                values[row] += beyond
                errors[row] = wrong / (abs(values[row]) or state.scales[name])
        return values, slopes, errors

    return read


def _moved(groups: Groups, change: ModelChange, step: float) -> Groups:
    """Return groups whose model is moved by a step of a logarithm."""
    return replace(groups, model=_between(change.below, change.above, 0.5 + step / change.width))


def _between(one: Any, other: Any, part: float) -> Any:
    """Return what lies between two frozen dataclasses of one kind, by their numbers; other parts are those of the first."""
    if isinstance(one, float) and isinstance(other, float):
        return one + (other - one) * part
    if one == other or not is_dataclass(one) or isinstance(one, type):
        return one
    values = [_between(getattr(one, each.name), getattr(other, each.name), part) for each in fields(one) if each.init]
    return type(one)(*values)


READERS: dict[str, Callable[[FrictionModel, float], Read]] = {"line": _cylinder_reader, "point": _ball_reader}
