"""What the tables hold at states inside their boxes: their functions, and what friction is made of, with derivatives."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.atlas.grid import MAX_L_OF_HEAVY, MAX_ROUGHNESS_OF_HEAVY
from stribeck.atlas.table import FRICTION_RADIUS
from stribeck.atlas.tables import covers, table_for, within
from stribeck.contacts.contact import Contact
from stribeck.contacts.cut_off import FAR_FILM_MIN_RADIUS, far_film
from stribeck.contacts.friction import Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Geometry, Groups
from stribeck.numerics.dual import Dual, chained, value_of
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.units import InputError, checked_kind, show
from stribeck.solids import hertz

# Names of functions in the tables
ODDS, CENTRAL, MINIMUM, FLUX, DEFLECTION = "log_odds", "central_gap", "minimum_gap", "flux_gap", "deflection"

DRY_OFFSET: dict[Geometry, float] = {"line": hertz.HERTZ_OFFSET, "point": -1.0}  # Of the dry smooth contact [u_Hz]


class Lookup(NamedTuple):
    """What a table has of states: flat arrays over them, or duals where derivatives are wanted."""

    speed: Any
    load: Any
    values: list[Any]


@one_blas_thread
def look_up(groups: Groups, names: tuple[str, ...], slopes: int = 0) -> Lookup:
    """Return functions of the table of states inside its box, with 0, 1 or 3 derivatives by the logarithms of the groups."""
    held = table_for(groups)
    box, grid = held.box, held.grid
    if missing := [name for name in names if name not in held.functions]:
        raise InputError(f"the table {held.name} of the atlas has no {missing[0]}; use solve.")
    speed, load, kappa = (flat(groups, value) for value in (groups.speed, groups.load, groups.relative_roughness))
    for name, values in (("speed", speed), ("load", load), ("relative_roughness", kappa)):
        _check(name, values, box[name], has_zero=name != "load")
    if (kappa == 0).any():
        _check("speed of a smooth contact", speed[kappa == 0], grid.films, has_zero=True)
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
    found, *by = held.table.read(functions, log_speed, np.where(closing, MAX_L_OF_HEAVY, log_load), inside, slopes)
    # At rest the load shifts the gap and does nothing else.
    shift = 0.5 * inside[closing] * (log_load[closing] - MAX_L_OF_HEAVY)
    dry = (speed == 0) & (kappa == 0)
    for row, name in enumerate(names):
        if name in (CENTRAL, MINIMUM):
            found[row, closing] = np.log(np.exp(found[row, closing]) + shift)
        if name == ODDS:
            found[row, closing] = -math.inf
        found[row, dry] = DRY_OFFSET[held.geometry] if name == DEFLECTION else -math.inf
    if not slopes:
        return Lookup(speed, load, list(found))
    if slopes == 3:  # by ln(speed), L and ln(kappa), with L = -factor ln(load) and kappa = roughness/load^exponent
        by[1] = -grid.load_factor * by[1] - groups.scaling.roughness_exponent * by[2]
    axes = np.eye(slopes, 2)[..., None]
    return Lookup(Dual(speed, axes[:, 0] * speed), Dual(load, axes[:, 1] * load), [*map(Dual, found, np.stack(by, axis=1))])


class FrictionReading(NamedTuple):
    """What a table has of the friction of states: flat arrays over them, or duals where derivatives are wanted."""

    speed: Any
    load: Any
    odds: Any
    parts: dict[str, Any]  # Observables that the viscous friction takes, by name

    @property
    def contact(self) -> Any:
        """Load share of the asperities."""
        return contact_share(self.odds)


def read_friction(groups: Groups, definition: Definition, slopes: int = 0) -> FrictionReading:
    """Return what the friction of states is made of, with 0, 1 or 3 derivatives by the logarithms of the groups."""
    if groups.geometry == "line":
        name = f"viscous_{definition}"
        speed, load, (odds, log) = look_up(groups, (ODDS, name), slopes)
        return FrictionReading(speed, load, odds, {name: np.sqrt(load) * speed * np.exp(log)})
    speed, load, (odds, *logs) = look_up(groups, (ODDS, "couette", "poiseuille", "published"), slopes)
    couette, poiseuille, published = (speed * np.exp(log) for log in logs)
    film, beyond = far_film(groups.model), speed * math.log(FRICTION_RADIUS)
    parts = {"J_couette": couette - film.couette * beyond, "J_poiseuille": poiseuille - film.poiseuille * beyond}
    return FrictionReading(speed, load, odds, parts | {"J_pcx": couette + poiseuille - published})


def friction_terms(groups: Groups, inputs: Mapping[str, Any], definition: Definition, slopes: int = 0) -> tuple[Any, Any]:
    """Return contact load share and viscous friction of the flattened states, by inputs that may be arrays with derivatives.

    The ``inputs`` are what the friction rule of the geometry takes, by name; they are not checked.  With ``slopes`` = 3 both
    have their derivatives by ln(speed), ln(load) and ln(roughness).
    """
    checked_kind("groups", groups, Groups, "Groups(speed, load, roughness)")
    reading = read_friction(groups, definition, slopes)
    return reading.contact, viscous_of(groups, reading, inputs, definition)


def has_friction(contact: Contact, groups: Groups) -> bool:
    """Return whether the atlas has the friction of a contact at groups of its own or at another speed."""
    liquid = RULES[groups.geometry].motion(contact).get("wetted_radius", math.inf)
    return bool(contact.friction_of_asperities.is_constant and liquid >= FAR_FILM_MIN_RADIUS and covers(groups))


def viscous_of(groups: Groups, reading: FrictionReading, inputs: Mapping[str, Any], definition: Definition) -> Any:
    """Return the viscous friction of what was read, by what the friction rule takes beside states."""
    liquid = value_of(inputs.get("wetted_radius", math.inf))
    if np.any(np.less(liquid, FAR_FILM_MIN_RADIUS)):
        raise InputError(
            f"wetted_radius = {show(liquid)} Hertz radii; the atlas holds no fields to integrate up to there, but the "
            f"friction of films that end far from the contact: from {FAR_FILM_MIN_RADIUS:g} on. Use solve."
        )
    arrays = {name: flat(groups, value) for name, value in inputs.items()} | {"far": far_film(groups.model)}
    return RULES[groups.geometry].viscous(reading.parts, reading.speed, reading.load, arrays, definition)


def flat(groups: Groups, value: Any) -> Any:
    """Return a number or an array that broadcasts with groups as a flat array over their states, its derivatives too."""
    if isinstance(value, Dual):
        return Dual(flat(groups, value.value), np.stack([flat(groups, slope) for slope in value.slope]))
    return np.broadcast_to(np.asarray(value), groups.shape).ravel()


def _check(name: str, values: Array, ends: tuple[float, float], has_zero: bool) -> None:
    """Refuse values outside a side of the box."""
    outside = ~within(values, ends, has_zero)
    if outside.any():
        covered = f"{ends[0]:g} to {ends[1]:g}{' and 0' if has_zero else ''}"
        raise InputError(f"{name} has the value {values[outside][0]:g}; the atlas covers {covered}. Use solve outside.")


def contact_share(odds: Any) -> Any:
    """Return the contact share of ln(fluid over contact share), with its derivatives; the fluid share of its negative."""
    share = np.asarray(1 / (1 + np.exp(value_of(odds))))
    return chained(share, [odds], [-share * (1 - share)])
