r"""Errors of the friction laws over the ratio of their coefficients, beta/mu0.

Friction is :math:`\mu_0 S + \beta m`, with S and m of the groups alone, so that its relative error depends on beta/mu0.  Where
that is small, the share of asperities S counts even where little is left of it; where it is large, the viscous part
counts even in boundary lubrication.  S and m are read off the atlas, whose own errors of 1e-5 do not matter here.

Source: none; this is the evidence for the limits in beta/mu0 of :data:`stribeck.asymptotics.FORMULAS`, shown in validity.md.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stribeck import atlas
from stribeck._types import Array
from stribeck.asymptotics import boundary, mixed, transitions, uniform
from stribeck.asymptotics.constants import FILM_CONSTANT
from stribeck.asymptotics.formula import COEFFICIENT_RATIO, Formula
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Groups

__all__ = ["JUDGED_FORMULAS", "COEFFICIENT_RATIOS", "largest_errors"]

COEFFICIENT_RATIOS = (1e-4, 1e-3, 1e-2, 0.1, 1.0, 3.0, 10.0)  # beta/mu0 for which the errors are tabulated.

# Film ratios c lambda**(3/5)/kappa over which the minimum is sought: it lies between 1.9 and 31 for all ratios.
FILM_RATIOS = np.geomspace(0.5, 80.0, 300)

ZOOMS = 3  # Refinements around a minimum.
ZOOM_POINTS = 21  # Points of each refinement.


def _axes(formula: Formula[Any], points: tuple[int, int]) -> tuple[Array, Array]:
    """Return loads and relative roughnesses over the range of a formula, its ends among them; the atlas ends at 1e-6."""
    ends = {limit.parameter: (limit.low, limit.high) for limit in formula.limits}
    found = []
    for name, count in zip(("load", "relative_roughness"), points, strict=True):
        low, high = ends[name]
        found.append(np.geomspace(max(low, 1e-6), high, count))
    return found[0], found[1]


def _of_states(formula: Formula[Any], points: tuple[int, int], **options: Any) -> Callable[[float], Array]:
    """Return the errors of a friction law at all states in its range in the groups, as a function of beta/mu0."""
    load, kappa = _axes(formula, points)
    speed = np.geomspace(1e-12, 1e4, 10 * points[0])
    load, kappa, speed = (axis.ravel() for axis in np.meshgrid(load, kappa, speed, indexing="ij"))
    groups = Groups(speed, load, kappa * load)
    inside = np.logical_and.reduce(
        [limit.holds(groups, 1.0) for limit in formula.limits if limit.parameter != COEFFICIENT_RATIO]
    )
    groups = Groups(speed[inside], load[inside], (kappa * load)[inside])
    definition: Definition = next(iter(options.values()), "published")
    share, viscous = atlas.contact_load_share(groups), atlas.viscous_friction(groups, 1.0, definition)

    def errors(ratio: float) -> Array:
        return np.abs(formula.function(groups, 1.0, ratio, **options) / (share + ratio * viscous) - 1)

    return errors


def _of_minimum(formula: Formula[Any], points: tuple[int, int]) -> Callable[[float], Array]:
    """Return the errors of a prediction of the minimum over its range in the groups, as a function of beta/mu0."""
    load, kappa = (axis[..., None] for axis in np.meshgrid(*_axes(formula, points), indexing="ij"))

    def parts(log_speed: Array) -> tuple[Array, Array]:
        groups = Groups(np.exp(log_speed), load, kappa * load)
        return np.asarray(atlas.contact_load_share(groups)), np.asarray(atlas.viscous_friction(groups, 1.0, "published"))

    coarse = np.log(FILM_RATIOS * kappa / FILM_CONSTANT) * 5 / 3
    share, viscous = parts(coarse)

    def errors(ratio: float) -> Array:
        log_speed, friction = coarse, share + ratio * viscous
        falls = (friction[..., 1:-1] < friction[..., :-2]) & (friction[..., 1:-1] <= friction[..., 2:])
        lowest = np.where(falls, friction[..., 1:-1], np.inf).argmin(axis=-1)[..., None] + 1
        for _ in range(ZOOMS):
            low, high = (np.take_along_axis(log_speed, lowest + side, axis=-1) for side in (-1, 1))
            log_speed = low + (high - low) * np.linspace(0, 1, ZOOM_POINTS)
            here, there = parts(log_speed)
            friction = here + ratio * there
            lowest = np.clip(friction.argmin(axis=-1), 1, ZOOM_POINTS - 2)[..., None]
        speed = np.exp(np.take_along_axis(log_speed, lowest, axis=-1))
        at = Groups(speed[..., 0], load[..., 0], (kappa * load)[..., 0])
        right = {
            "speed_at_minimum": at.speed,
            "friction_at_minimum": np.take_along_axis(friction, lowest, axis=-1)[..., 0],
            "separation_at_minimum": atlas.central_gap(at) / at.relative_roughness,
        }[formula.predicts]
        found = np.abs(formula.function(at, 1.0, ratio) / right - 1)
        return np.asarray(np.where(falls.any(axis=-1), found, np.nan))

    return errors


# Formulas with both coefficients, with their options, by their names in the table.
JUDGED_FORMULAS: dict[str, tuple[Formula[Any], dict[str, Any]]] = {
    "uniform.friction, published": (uniform.friction, {"definition": "published"}),
    "uniform.friction, balanced": (uniform.friction, {"definition": "balanced"}),
    "mixed.friction": (mixed.friction, {}),
    "boundary.friction": (boundary.friction, {"viscous": "published"}),
    "speed_at_minimum": (transitions.speed_at_minimum, {}),
    "friction_at_minimum": (transitions.friction_at_minimum, {}),
    "separation_at_minimum": (transitions.separation_at_minimum, {}),
}


def largest_errors(
    name: str, ratios: tuple[float, ...] = COEFFICIENT_RATIOS, points: tuple[int, int] = (16, 13)
) -> tuple[list[float], list[float]]:
    """Return the largest and the median error of a formula at each beta/mu0, over its range in the groups."""
    formula, options = JUDGED_FORMULAS[name]
    located = formula.predicts.endswith("_at_minimum")
    errors = _of_minimum(formula, points) if located else _of_states(formula, points, **options)
    with np.errstate(all="ignore"):
        found = [errors(ratio) for ratio in ratios]
    return [float(np.nanmax(each)) for each in found], [float(np.nanmedian(each)) for each in found]
