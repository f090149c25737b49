r"""Where the velocity-weakening branch disappears: the roughness from which friction only grows with speed.

With roughness the minimum of a Stribeck curve rises and meets the maximum before it; beyond, boundary lubrication passes to
hydrodynamic without weakening, and the two lines of transition have merged.  All of it on solved curves.

Source: [BP] Conclusion, which names a minimum that exceeds boundary_friction and a branch that disappears as one; they are two
(:data:`CRITERIA`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Literal, get_args

import numpy as np

from stribeck._types import Array
from stribeck.contacts.friction import Definition, coefficients
from stribeck.contacts.groups import Groups, Physics
from stribeck.curves.friction_path import FrictionPath
from stribeck.curves.result import path_of
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.numerics.events import first_zero, least_by_slope, zero_of_growing
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.units import InputError, show
from stribeck.solver.solve import as_groups, check_rtol
from stribeck.solver.solve_error import SolveError, describe

Criterion = Literal["slope", "plateau"]

CRITERIA: tuple[Criterion, ...] = get_args(Criterion)
"""What merging means: the slope of the curve is nowhere negative, or its minimum is as high as the boundary plateau mu0."""

SPEED_TOLERANCE = 1e-3
"""Tolerance of ln(speed) at the minimum slope, on which the slope itself depends in second order; also its step there."""

MINIMUM_TOLERANCE = 1e-9
"""Tolerance of ln(speed) at the minimum."""

KAPPA_RANGE = (1e-5, 1e3)
"""Relative roughness between which the merging is looked for."""

KAPPA_START = 0.3
KAPPA_STEP = 3.0


@dataclass(frozen=True)
class Weakening:
    """Whether the friction of a curve over the speed falls somewhere, and how far.

    Attributes
    ----------
    speed : float
        Speed group at which friction falls most steeply, or grows most slowly.
    slope : float
        d mu/d ln(speed) over the published viscous friction there [-]: negative where friction weakens with speed,
        1 far down on the plateau, 0.4 to 0.7 on the hydrodynamic branch.
    minimum_speed : float
        Speed group of the minimum behind it; nan where there is no weakening.
    minimum_friction : float
        Friction coefficient there [-].
    """

    speed: float
    slope: float
    minimum_speed: float = math.nan
    minimum_friction: float = math.nan

    @property
    def present(self) -> bool:
        """Whether there is a range of speeds in which friction falls."""
        return self.slope < 0


@answers_typos
@one_blas_thread
def weakening(
    groups: Groups,
    boundary_friction: float | None = None,
    beta: float | None = None,
    definition: Definition = "balanced",
    *,
    rtol: float = 1e-6,
) -> Weakening:
    r"""Return whether friction falls with speed anywhere on a Stribeck curve, by the minimum slope of the curve.

    .. math:: \min_\lambda \frac{1}{\mu_f} \frac{d\mu}{d\ln\lambda} < 0
    """
    as_groups(groups)
    boundary_friction, beta = coefficients(None, boundary_friction, beta)
    settings: Any = {"boundary_friction": boundary_friction, "beta": beta, "definition": definition}
    curve = stribeck_curve(groups, points=2, rtol=rtol, **settings)
    if curve.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    if not curve.outcome.ok:
        raise SolveError(curve.outcome, None, f"{describe(groups)}: {curve.outcome.value}")

    return weakening_along(path_of(curve))


def weakening_along(path: FrictionPath) -> Weakening:
    """Return whether friction falls anywhere along a path over the speed, whose unit is that of the path."""
    published = replace(path, definition="published")

    def slopes(places: Array) -> Array:
        # Friction of the substrate that is the slower one is negative; its size counts.
        _, contact, viscous = path.parts(places)
        return np.asarray(np.sign(contact + viscous) * path.slopes(places) / np.abs(published.parts(places)[2]))

    def slope(s: float) -> float:
        return float(slopes(np.array([s]))[0])

    def bend(s: float) -> float:
        return slope(s + SPEED_TOLERANCE) - slope(s - SPEED_TOLERANCE)

    places = path.source.places
    values = slopes(places)
    event = least_by_slope(bend, places, values, SPEED_TOLERANCE)
    lowest = float(places[np.argmin(values)]) if event is None else event.place
    least, behind = slope(lowest), places > lowest
    minimum = first_zero(slope, np.append(lowest, places[behind]), np.append(least, values[behind]), MINIMUM_TOLERANCE)
    if least >= 0 or minimum is None:
        return Weakening(math.exp(lowest), least)
    _, contact, viscous = path.parts(np.array([minimum.place]))
    return Weakening(math.exp(lowest), least, math.exp(minimum.place), float((contact + viscous)[0]))


@answers_typos
def roughness_without_minimum(
    load: float,
    boundary_friction: float | None = None,
    beta: float | None = None,
    definition: Definition = "balanced",
    *,
    criterion: Criterion = "slope",
    rtol: float = 1e-6,
    physics: Physics | None = None,
) -> float:
    r"""Return the roughness at which the solved Stribeck curve loses its minimum, and the lines of transition merge."""
    if criterion not in CRITERIA:
        raise InputError(f"criterion = {show(criterion)}; it must be 'slope' or 'plateau'.")
    rtol = check_rtol(rtol)
    boundary_friction, beta = coefficients(None, boundary_friction, beta)
    unit, _ = as_groups(Groups(1.0, load, 1.0) if physics is None else Groups(1.0, load, 1.0, **physics))
    if boundary_friction == 0:
        return 0.0

    def excess(log_kappa: float) -> float:
        groups = replace(unit, roughness=math.exp(log_kappa) / float(unit.relative_roughness))
        found = weakening(groups, boundary_friction, beta, definition, rtol=rtol)
        if criterion == "slope" or not found.present:
            return found.slope
        return abs(found.minimum_friction) / boundary_friction - 1

    ends = math.log(KAPPA_RANGE[0]), math.log(KAPPA_RANGE[1])
    tolerance = max(rtol, MINIMUM_TOLERANCE)
    event = zero_of_growing(cache(excess), math.log(KAPPA_START), math.log(KAPPA_STEP), ends, tolerance)
    return math.nan if event is None else math.exp(event.place) / float(unit.relative_roughness)
