"""A phase diagram read off the atlas: all points at once, transitions located on it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.atlas.tables import table_for
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition
from stribeck.contacts.friction_rules import RULES
from stribeck.contacts.groups import Groups
from stribeck.contacts.parts import PURE_SLIDING
from stribeck.contacts.regime import friction_share, regime_numbers
from stribeck.curves.atlas_curve import AtlasCurve
from stribeck.curves.regime import BOUNDARY_FLUID_SHARE, HYDRODYNAMIC_CONTACT_SHARE
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.outcome import Outcome
from stribeck.regimes.phase_grid import MARKS, Diagram

DENSITY = 20
"""Points per decade of speed on which the transitions of a row are seen."""

COARSE = 5
"""The same where many rows are located at once, each passage then narrowed."""

NARROWINGS = 6
"""Rounds of that at most."""

AROUND, THIRDS = np.array([-0.04, -0.004, 0.004, 0.04]), np.array([1 / 3, 2 / 3])
"""Where a round looks: around the place by false position, and where that is far off, at thirds, over the distance of the
ends.  A few states read off a table cost what one does."""

NARROW_ENOUGH = 0.2
"""Part of the table's error below which the ends of a passage are no longer moved together."""


@dataclass(frozen=True, eq=False)
class TransitionSpeeds:
    """Speed groups at which the regimes of many contacts pass into each other.

    Attributes
    ----------
    boundary : ndarray, shape (n,)
        Where the fluid begins to carry more than 5 % of the load; zero or infinite where it does or does not at all speeds.
    hydrodynamic : ndarray, shape (n,)
        Where asperities cause no more than 10 % of the friction; zero or infinite likewise.
    minimum : ndarray, shape (n,)
        Where friction is at its minimum, nan where its minimum is not between the speeds asked for.
    error : ndarray, shape (3, n)
        Errors of the logarithms of the three, from the stated error of the shares and of the friction's slope [-].
    """

    boundary: Array
    hydrodynamic: Array
    minimum: Array
    error: Array


@answers_typos
@one_blas_thread
def transition_speeds(
    groups: Groups,
    boundary_friction: float = 1.0,
    beta: float = 1.0,
    definition: Definition = "balanced",
    speeds: tuple[float, float] | None = None,
    narrowings: int = NARROWINGS,
    slide_to_roll: float = PURE_SLIDING,
    wetted_radius: float = math.inf,
) -> TransitionSpeeds:
    """Return where the regimes of many contacts of one load pass into each other, all located at once on the atlas."""
    row = table_for(groups)
    roughness = np.atleast_1d(np.asarray(groups.roughness, dtype=float))
    speeds = row.speeds(groups) if speeds is None else speeds
    count = 1 + max(2, math.ceil(COARSE * math.log10(speeds[1] / speeds[0])))
    grid = np.log(np.geomspace(*speeds, count))

    bound = HYDRODYNAMIC_CONTACT_SHARE / (1 - HYDRODYNAMIC_CONTACT_SHARE)
    motion = {"slide_to_roll": slide_to_roll, "wetted_radius": wetted_radius}
    rubbing = boundary_friction * float(RULES[groups.geometry].sliding_factor(groups, motion))

    def signs(s: Array, h: Array) -> Array:
        """Return what passes from below to above zero at each of the three, shape (3, ...)."""
        fluid, contact, viscous, slope = atlas.shares_and_friction(
            Groups(np.exp(s), groups.load, h, **groups.physics), boundary_friction, beta, definition, **motion
        )
        solid, total = np.abs(rubbing * contact), rubbing * contact + viscous
        return np.stack(
            [
                np.log(np.maximum(fluid, 1e-300) / BOUNDARY_FLUID_SHARE),
                np.log(np.maximum(bound * np.abs(viscous), 1e-300) / np.maximum(solid, 1e-300)),
                np.sign(total) * slope / (np.abs(slope) + np.maximum(np.abs(total), 1e-300)),  # of its size, between -1 and 1
            ]
        )

    found, error = _passages(signs, grid, roughness, narrowings, row.error)
    with np.errstate(over="ignore"):
        speed = np.exp(found)
    return TransitionSpeeds(speed[0], speed[1], np.where(np.isfinite(found[2]), speed[2], np.nan), error)


def _passages(
    signs: Callable[[Array, Array], Array], grid: Array, roughness: Array, narrowings: int, stated: float
) -> tuple[Array, Array]:
    """Return where each function passes from below to above zero in each row, and errors, shape (3, rows).

    Logarithms of the speed; -inf or inf where it is above or below at all speeds.  The printed viscous friction lets friction
    rise before it falls, so that its minimum is the last passage; the others are the first, from below at the lowest speed.
    """
    values = signs(*np.broadcast_arrays(grid, roughness[:, None]))
    rising = (values[..., :-1] < 0) & (values[..., 1:] >= 0)
    place = np.argmax(rising, axis=-1)
    place[2] = rising.shape[-1] - 1 - np.argmax(rising[2, :, ::-1], axis=-1)
    some = np.asarray(rising.any(axis=-1))
    some[:2] &= values[:2, :, 0] < 0
    found = np.where(values[..., 0] >= 0, -np.inf, np.inf)
    error = np.zeros(found.shape)
    which, rows = np.nonzero(some)
    if not len(rows):
        return found, error
    first, one = place[which, rows], np.arange(len(rows))
    low, high = grid[first], grid[first + 1]
    below, above = values[which, rows, first], values[which, rows, first + 1]
    for _ in range(narrowings):
        if np.all(above - below <= NARROW_ENOUGH * stated):
            break
        middle = low + (high - low) * below / (below - above)
        between = np.concatenate([middle + AROUND[:, None] * (high - low), low + THIRDS[:, None] * (high - low)])
        between = np.sort(np.clip(between, low, high), axis=0)
        at = signs(between, np.broadcast_to(roughness[rows], between.shape))[which, :, one].T
        places, heights = np.vstack([low, between, high]), np.vstack([below, at, above])
        last = np.argmax((heights[:-1] < 0) & (heights[1:] >= 0), axis=0)
        low, high = places[last, one], places[last + 1, one]
        below, above = heights[last, one], heights[last + 1, one]
    steep = (above - below) / np.maximum(high - low, 1e-300)
    found[which, rows] = low + (high - low) * below / (below - above)
    error[which, rows] = stated / np.maximum(steep, 1e-300) + (high - low)
    return found, error


def fill(diagram: Diagram) -> None:
    """Enter all points and lines of a diagram; raise InputError where it reaches out of the box."""
    speeds = diagram.axes["speed"]
    for i in range(len(diagram.axes["load"])):
        for j in range(len(diagram.axes["roughness"])):
            problem, groups, unit = diagram.problem(i, j)
            contact = problem if isinstance(problem, Contact) else None
            _enter(diagram, (i, j), Groups(unit * speeds, groups.load, groups.roughness, **groups.physics), contact)
            diagram.velocity_weakening[i, j] = 0
            if float(groups.roughness) > 0:
                _enter_lines(diagram, (i, j), groups, unit, contact)
            diagram.messages[i, j] = ""


def _enter(diagram: Diagram, row: tuple[int, int], groups: Groups, of: Contact | None) -> None:
    rule = RULES[groups.geometry]
    inputs = {**rule.of_contact(of), "beta": diagram.beta}
    share, viscous = atlas.friction_terms(groups, inputs, diagram.definition)
    solid = diagram.boundary_friction * float(rule.sliding_factor(groups, inputs)) * share
    friction = solid + viscous
    fluid, central = np.asarray(atlas.fluid_load_share(groups)), np.asarray(atlas.central_gap(groups))
    contact = friction_share(solid, viscous)
    kappa, error = float(groups.relative_roughness), table_for(groups).error
    alpha = 1.0 if diagram.contact is None else diagram.contact.alpha
    values = {
        "friction": friction,
        "friction_error": error * np.abs(friction),
        "fluid_load_share": fluid,
        "contact_friction_share": contact,
        "central_gap": central,
        "lambda_ratio": np.asarray(atlas.minimum_gap(groups)) / (alpha * kappa)
        if kappa > 0
        else np.full_like(central, np.inf),
        "error_estimate": np.full_like(central, error),
    }
    for name, found in values.items():
        diagram.fields[name][row] = found
    diagram.regime[row] = regime_numbers(fluid, contact)
    diagram.outcomes[row] = Outcome.CONVERGED.name


def _enter_lines(diagram: Diagram, row: tuple[int, int], groups: Groups, unit: float, contact: Contact | None) -> None:
    """Locate the transitions of a row between the smallest and largest speed of its table."""
    low, high = table_for(groups).speeds(groups)

    def groups_at(speed: Array) -> Groups:
        return Groups(speed, groups.load, groups.roughness, **groups.physics)

    speeds = np.geomspace(low, high, 1 + DENSITY * round(np.log10(high / low)))
    curve = AtlasCurve("speed", speeds, groups_at, contact, diagram.boundary_friction, diagram.beta, diagram.definition)
    marks = {mark.name: mark.value for mark in curve.transitions}
    for variable, name in MARKS.items():
        if name in marks:
            diagram.lines[variable][row] = marks[name] / unit
    minima = sorted(curve.local_minima(), key=lambda mark: mark.friction) if diagram.boundary_friction > 0 else []
    if minima:
        diagram.lines["speed_at_minimum"][row] = minima[0].value / unit
        diagram.lines["friction_at_minimum"][row] = minima[0].friction
    diagram.velocity_weakening[row] = int(bool(minima))
