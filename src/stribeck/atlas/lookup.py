"""What the table of states holds at them: functions inside the box, and what the friction is made of with its derivatives."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, TypeVar

import numpy as np

from stribeck._types import Array
from stribeck.atlas.drag import DRAG
from stribeck.atlas.grid import MAX_L_OF_HEAVY, MAX_ROUGHNESS_OF_HEAVY
from stribeck.atlas.table import Values
from stribeck.atlas.tables import BOX_RTOL, TableRow, table_for
from stribeck.contacts.cut_off import far_film
from stribeck.contacts.friction import Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Groups
from stribeck.numerics.dual import Dual, slope_of
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.docstrings import complete_docstring
from stribeck.quantities.units import InputError

Value = float | Array

# Names of functions in the tables
ODDS, CENTRAL, MINIMUM, FLUX, DEFLECTION = "log_odds", "central_gap", "minimum_gap", "flux_gap", "deflection"

# What docstrings say of the arguments of all functions of states.
ARGUMENTS = {
    "groups": "Groups\n    The states [-]; arrays broadcast.",
    "boundary_friction": "float\n    Friction coefficient of the dry contact [-].",
    "beta": "float\n    Coefficient of the contact law [-].",
    "definition": """{"balanced", "published"}
    Definition of the viscous friction, theory.md, section 6.""",
    "slide_to_roll": "float\n    Slide-to-roll ratio of a ball [-].",
    "wetted_radius": """float or ndarray
    Radius of the disc of liquid around a ball, above 1 [a]; infinite where the whole ball is immersed.""",
}
RAISES = "InputError\n    If a state is outside the box of its table, or an argument is wrong."

Function = TypeVar("Function", bound=Callable[..., Any])


def documented(returns: str) -> Callable[[Function], Function]:
    """Return a decorator that completes the docstring of a function of states."""

    def complete(function: Function) -> Function:
        kind, _, meaning = returns.rpartition(": ")
        value = f"{kind or 'float or ndarray'}\n    {meaning}"
        function.__doc__ = complete_docstring(function, ARGUMENTS, value, RAISES)
        return function

    return complete


class Lookup(NamedTuple):
    """Values read off a table, as flat arrays over the states."""

    table: TableRow
    speed: Array
    load: Array
    values: Values


@one_blas_thread
def look_up(groups: Groups, names: tuple[str, ...], slopes: int = 0) -> Lookup:
    """Return functions of the table of states inside its box, and 0, 1 or 3 of their derivatives, see :class:`Values`."""
    held = table_for(groups)
    box, grid = held.box, held.grid
    if missing := [name for name in names if name not in held.functions]:
        raise InputError(f"the table {held.name} of the atlas has no {missing[0]}; use solve.")
    speed, load, kappa = (flat(groups, value) for value in (groups.speed, groups.load, groups.relative_roughness))
    for name, values in (("speed", speed), ("load", load), ("relative_roughness", kappa)):
        _check(name, values, *box[name], zero=name != "load")
    if (kappa == 0).any():
        _check("speed of a smooth contact", speed[kappa == 0], *grid.films, zero=True)
    with np.errstate(divide="ignore"):
        log_speed = np.log(speed)
    log_load = grid.log_load(load)
    inside = np.where(kappa > 0, np.clip(kappa, *box["relative_roughness"]), 0.0)
    closing = (speed == 0) & (inside > 0) & ~grid.has_rest[grid.region_at(log_load, inside)]
    if FLUX in names and closing.any():
        raise InputError(
            f"load has the value {load[closing][0]:g} at speed 0; there, at relative roughness below "
            f"{MAX_ROUGHNESS_OF_HEAVY:g}, "
            f"the atlas holds the flux gap for loads up to {math.exp(-MAX_L_OF_HEAVY):.4g}. Use solve."
        )
    unheld = [name for name in (CENTRAL, MINIMUM, DEFLECTION) if name in names]
    if unheld and (heavy := closing & (log_load < grid.resting)).any():
        raise InputError(
            f"load has the value {load[heavy][0]:g} at speed 0; there the table {held.name} holds {unheld[0]} for loads up to "
            f"{grid.load_at(grid.resting):g}. Use solve."
        )
    functions = tuple(held.functions.index(name) for name in names)
    found = held.table.read(functions, log_speed, np.where(closing, MAX_L_OF_HEAVY, log_load), inside, slopes)
    # At rest the load shifts the gap and does nothing else.
    shift = 0.5 * inside[closing] * (log_load[closing] - MAX_L_OF_HEAVY)
    dry = (speed == 0) & (kappa == 0)
    for row, name in enumerate(names):
        if name in (CENTRAL, MINIMUM):
            found.values[row, closing] = np.log(np.exp(found.values[row, closing]) + shift)
        if name == ODDS:
            found.values[row, closing] = -math.inf
        found.values[row, dry] = DRAG[held.geometry].dry_offset if name == DEFLECTION else -math.inf
    return Lookup(held, speed, load, found)


class FrictionReading(NamedTuple):
    """Contact share and viscous parts of the friction of states, flat arrays, with derivatives by the logarithms of groups."""

    speed: Array
    load: Array
    odds: Array
    contact: Array
    contact_slopes: Array
    parts: dict[str, Array]
    part_slopes: dict[str, Array]


def read_friction(groups: Groups, definition: Definition, slopes: int = 0) -> FrictionReading:
    """Return contact share and parts of the viscous friction of states, and the first 0, 1 or 3 of their derivatives."""
    drag = DRAG[groups.geometry]
    names = (ODDS, *drag.names(definition))
    held, speed, load, found = look_up(groups, names, slopes)
    by: list[Array | None] = [None] * len(names)
    if found.slopes is not None and slopes == 1:
        by = list(found.slopes[0][:, None])
    elif found.slopes is not None:
        # By ln(speed), L and ln(kappa), with L = -factor ln(load) and kappa = roughness/load^exponent.
        by_speed, by_log_load, by_kappa = found.slopes
        by_load = -held.grid.load_factor * by_log_load - groups.scaling.roughness_exponent * by_kappa
        by = list(np.stack([by_speed, by_load, by_kappa], axis=1))
    logs = {name: (found.values[row], by[row]) for row, name in enumerate(names) if row > 0}
    parts = drag.parts(logs, speed, load, far_film(groups.model))
    contact = contact_share(found.values[0])
    contact_slopes = np.empty((0, 0)) if by[0] is None else -contact * (1 - contact) * by[0]
    part_slopes = {name: slope for name, (_, slope) in parts.items() if slope is not None}
    values = {name: value for name, (value, _) in parts.items()}
    return FrictionReading(speed, load, found.values[0], contact, contact_slopes, values, part_slopes)


def slopes_of(
    groups: Groups, reading: FrictionReading, inputs: Mapping[str, Any], definition: Definition
) -> tuple[Array, Array]:
    """Return the derivatives of contact share and viscous friction that were read, zero at rest."""
    contact = reading.contact_slopes.copy()
    parts = {name: Dual(value, reading.part_slopes[name]) for name, value in reading.parts.items()}
    speed, load = (Dual(group, np.eye(len(contact), 2)[:, axis, None] * group) for axis, group in enumerate(reading[:2]))
    rule = RULES[groups.geometry]
    viscous = np.array(slope_of(rule.viscous(parts, speed, load, inputs_for(groups, inputs), definition)))
    for found in (contact, viscous):
        found[:, reading.speed == 0] = 0.0
    return contact, viscous


def inputs_for(groups: Groups, inputs: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the friction rule takes beside states as flat arrays over them, and how their film ends far away."""
    return {name: flat(groups, value) for name, value in inputs.items()} | {"far": far_film(groups.model)}


def flat(groups: Groups, value: Any) -> Any:
    """Return a number or an array that broadcasts with groups as a flat array over their states, and its derivative too."""
    if isinstance(value, Dual):
        return Dual(flat(groups, value.value), flat(groups, value.slope))
    return np.broadcast_to(np.asarray(value), groups.shape).ravel()


def _check(name: str, values: Array, low: float, high: float, zero: bool) -> None:
    """Refuse values outside a side of the box."""
    outside = (values < low * (1 - BOX_RTOL)) | (values > high * (1 + BOX_RTOL))
    if zero:
        outside &= values != 0
    if outside.any():
        also = " and 0" if zero else ""
        raise InputError(
            f"{name} has the value {values[outside][0]:g}; the atlas covers {low:g} to {high:g}{also}. Use solve outside."
        )


def contact_share(odds: Array) -> Array:
    """Return the contact share of ln(fluid over contact share); the fluid share of its negative."""
    return np.asarray(1 / (1 + np.exp(odds)))


def reshape_to_groups(groups: Groups, values: Array) -> Value:
    """Return flat values in the shape of the groups, a number of a single state."""
    return float(values[0]) if groups.shape == () else values.reshape(groups.shape)
