"""The errors of formulas over grids of states, each state being solved once for all of them.

Source: none; these are the maps of validity.md.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from evidence import ball
from evidence.formulas import CURVE_QUANTITIES, FIELDS, MEASURED, REFERENCE_RTOL, STATE_QUANTITIES, field_error, state_of
from stribeck._types import Array, Flags
from stribeck.asymptotics.formula import Formula
from stribeck.contacts.groups import SCALINGS, Groups
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.files.datasets import import_xarray
from stribeck.quantities.units import InputError, show
from stribeck.solver.point.state import PointState
from stribeck.solver.solution import Solution
from stribeck.solver.solve_error import SolveError

if TYPE_CHECKING:
    import xarray

__all__ = ["AXES", "error_map", "error_maps", "kind_of"]

# Load share of the fluid below which a state is not taken from a row: the errors of shares are absolute, and on a mesh made
# for faster states so small a share can be off by 1e-3 of itself.
MIN_FLUID_SHARE = 1e-3

# Groups on which the error depends for each kind of formula, and their grid: loads, or decades and points per decade.
AXES: dict[str, dict[str, tuple[float, ...]]] = {
    "smooth": {"speed": (-11, 8, 4)},
    "rest": {"load": (1e-3, 0.1, 0.5), "relative_roughness": (-6, 3, 3)},
    "mixed": {"load": (1e-3, 0.1, 0.5), "relative_roughness": (-5, 0, 3), "speed": (-12, 2, 3)},
    "located": {"load": (1e-3, 0.1, 0.5), "relative_roughness": (-5, 0, 2)},
    "smooth ball": {"speed": (-5, 4, 3)},
    "ball at rest": {"load": (1e-3, 0.1, 0.5), "relative_roughness": (-5, 2, 2)},
    "any ball": {"load": (1e-3, 0.1, 0.5), "relative_roughness": (-3, -1, 1), "speed": (-8, 1, 1)},
}

LABELS = {"load": "load group", "relative_roughness": "relative roughness h_rms/F_N", "speed": "speed group"}

MIN_ERROR = 1e-12  # Relative error below which an error is rounding.

SMOOTH_LOAD = 0.1  # Load at which smooth contacts are solved; their relative errors do not depend on it.


def kind_of(formula: Formula[Any]) -> str:
    """Return the kind of a formula, by the groups on which its error depends, as a key of :data:`AXES`."""
    if formula.geometry == "point":
        return {"smooth": "smooth ball", "rest": "ball at rest", "mixed": "any ball"}[formula.plane]
    return "located" if formula.predicts in CURVE_QUANTITIES else formula.plane


def error_map(
    formula: Formula[Any],
    *,
    load: ArrayLike | None = None,
    relative_roughness: ArrayLike | None = None,
    speed: ArrayLike | None = None,
    predicts: str | None = None,
    **options: Any,
) -> xarray.Dataset:
    r"""Return the error of a formula relative to the solver over a grid of states.

    .. math:: \epsilon = \frac{f - s}{s}, \qquad \epsilon = \frac{\max_x |f - s|}{\max_x |s|} \text{ for a field}
    """
    if predicts is not None and predicts not in MEASURED:
        raise InputError(f"predicts = {show(predicts)}; it must be one of {', '.join(MEASURED)}.")
    judged = formula if predicts is None else replace(formula, predicts=predicts)
    grid = {"load": load, "relative_roughness": relative_roughness, "speed": speed}
    return _maps(kind_of(judged), [judged], _axes(kind_of(judged), grid), options)[formula.name]


def error_maps(
    formulas: Sequence[Formula[Any]],
    *,
    load: ArrayLike | None = None,
    relative_roughness: ArrayLike | None = None,
    speed: ArrayLike | None = None,
) -> dict[str, xarray.Dataset]:
    """Return the maps of several formulas, each state being solved once for all of them."""
    grid = {"load": load, "relative_roughness": relative_roughness, "speed": speed}
    found: dict[str, xarray.Dataset] = {}
    for kind in AXES:
        members = [formula for formula in formulas if kind_of(formula) == kind]
        if members:
            found |= _maps(kind, members, _axes(kind, grid), {})
    return {formula.name: found[formula.name] for formula in formulas}


def _axes(kind: str, given: dict[str, ArrayLike | None]) -> dict[str, Array]:
    """Return the grid for a kind of formulas, as given or else as in :data:`AXES`."""
    found = {}
    for name, default in AXES[kind].items():
        value = given[name]
        if value is None and name != "load":
            low, high, each = default
            value = np.logspace(low, high, round((high - low) * each) + 1)
        axis = np.atleast_1d(np.asarray(default if value is None else value, dtype=float))
        lowest = 0.0 if name == "speed" else math.ulp(0.0)
        if axis.ndim != 1 or not np.isfinite(axis).all() or not (np.diff(axis) > 0).all() or not (axis >= lowest).all():
            raise InputError(f"{name} = {show(value)}; a map needs positive increasing numbers (a speed may be zero).")
        found[name] = axis
    return found


def _maps(
    kind: str, formulas: Sequence[Formula[Any]], axes: dict[str, Array], options: dict[str, Any]
) -> dict[str, xarray.Dataset]:
    """Return the maps of formulas of one kind."""
    loads = axes.get("load", np.array([SMOOTH_LOAD]))
    kappas = axes.get("relative_roughness", np.zeros(1))
    speeds = axes.get("speed", np.array([1.0 if kind == "located" else 0.0]))
    shape = len(loads), len(kappas), len(speeds)
    geometry = formulas[0].geometry
    exponent = SCALINGS[geometry].roughness_exponent
    fields = [formula for formula in formulas if formula.predicts in FIELDS]
    wanted = {formula.predicts for formula in formulas} - set(FIELDS)
    right = {name: np.full(shape, math.nan) for name in wanted}
    errors = {formula.name: np.full(shape, math.nan) for formula in fields}
    estimate = 0.0
    for i, load in enumerate(loads.tolist()):
        for j, kappa in enumerate(kappas.tolist()):
            base = Groups(1.0, load, kappa * load**exponent, geometry=geometry)
            for name in wanted & set(CURVE_QUANTITIES):
                right[name][i, j, 0] = CURVE_QUANTITIES[name](base, options)
            for k, on_ball in _ball_row(base, speeds) if geometry == "point" else ():
                estimate = max(estimate, on_ball.error_estimate)
                for name in wanted:
                    right[name][i, j, k] = ball.OBSERVED[name](on_ball, options)
                for formula in fields:
                    groups = replace(base, speed=float(speeds[k]))
                    errors[formula.name][i, j, k] = field_error(formula, groups, on_ball, options)
            for k, found_in_row in _row(base, speeds) if kind != "located" and geometry == "line" else ():
                small = "fluid_load_share" in wanted and 0 < found_in_row.fluid_load_share < MIN_FLUID_SHARE
                state = state_of(found_in_row.groups) if small else found_in_row
                estimate = max(estimate, state.error_estimate)
                for name in wanted:
                    right[name][i, j, k] = STATE_QUANTITIES[name](state, options)
                for formula in fields:
                    groups = replace(base, speed=float(speeds[k]))
                    errors[formula.name][i, j, k] = field_error(formula, groups, state, options)
    groups = Groups(speeds, loads[:, None, None], kappas[:, None] * loads[:, None, None] ** exponent, geometry=geometry)
    found = {}
    for formula in formulas:
        if formula not in fields:
            with np.errstate(all="ignore"):
                values = np.broadcast_to(formula.function(groups, **options), shape)
                errors[formula.name] = (values - right[formula.predicts]) / right[formula.predicts]
        valid = np.broadcast_to(_valid(formula, groups, options), shape)
        found[formula.name] = _dataset(formula, options, axes, errors[formula.name], valid, estimate)
    return found


def _valid(formula: Formula[Any], groups: Groups, options: dict[str, Any]) -> Flags:
    """Return where a formula is in its range, to which its ends belong although the grid is rounded."""
    steps = 1 - MIN_ERROR, 1 + MIN_ERROR
    near = [replace(groups, speed=groups.speed * i, roughness=groups.roughness * j) for i in steps for j in steps]
    given = {name: options[name] for name in ("boundary_friction", "beta") if name in options}
    return np.asarray(np.logical_or.reduce([formula.valid(state, **given) for state in near]))


def _row(base: Groups, speeds: Array) -> list[tuple[int, Solution]]:
    """Return the states of one load and roughness over the speed that could be solved, with their places in ``speeds``."""
    moving = [k for k, speed in enumerate(speeds.tolist()) if speed > 0]
    # Two speeds would be taken as the ends of a curve.
    alone = list(range(len(speeds))) if len(moving) < 3 else [k for k in range(len(speeds)) if k not in moving]
    found = [(k, state_of(replace(base, speed=float(speeds[k])))) for k in alone]
    if len(moving) > 2:
        try:
            curve = stribeck_curve(load=base.load, roughness=base.roughness, speed=speeds[moving], rtol=REFERENCE_RTOL)
        except SolveError:
            return found
        places = dict(zip(speeds.tolist(), range(len(speeds)), strict=True))
        found += [(places[value], state) for value, state in zip(curve.values.tolist(), curve.solutions, strict=True)]
    return found


def _ball_row(base: Groups, speeds: Array) -> list[tuple[int, PointState]]:
    """Return the states of a ball of one load and roughness over the speed, with their places in ``speeds``."""
    found = ball.row([replace(base, speed=float(speed)) for speed in speeds])
    return [(k, state) for k, state in enumerate(found) if state is not None]


def _dataset(
    formula: Formula[Any], options: dict[str, Any], axes: dict[str, Array], error: Array, valid: Flags, estimate: float
) -> xarray.Dataset:
    shape = tuple(map(len, axes.values()))
    given = ", ".join(f"{name}={value!r}" for name, value in options.items())
    field = formula.predicts in FIELDS
    label = f"error of {formula.name} relative to the solver" + (
        ", largest over x relative to the largest value" if field else ""
    )
    made: xarray.Dataset = import_xarray("a map of errors").Dataset(
        {
            "error": (tuple(axes), error.reshape(shape), {"units": "1", "long_name": label}),
            "valid": (
                tuple(axes),
                valid.reshape(shape),
                {"units": "1", "long_name": f"whether in its range: {formula.range}"},
            ),
        },
        coords={name: (name, values, {"units": "1", "long_name": LABELS[name]}) for name, values in axes.items()},
        attrs={
            "title": f"{formula.name}({given})" if given else formula.name,
            "formula": formula.name,
            "predicts": formula.predicts,
            "reference": formula.source,
            "range": formula.range,
            "worst_stated": formula.worst,
            "rtol": REFERENCE_RTOL,
            "error_estimate": estimate,
            "source": f"stribeck {version('stribeck')}",
        },
    )
    return made
