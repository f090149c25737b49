"""The roughness from which friction only grows with speed: minimum and maximum of the curve have met.

Source: [BP] Conclusion, which names a minimum that exceeds boundary_friction and a branch that disappears as one: they
are two, this the second.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.asperity_friction.coulomb import as_asperity_friction
from stribeck.contacts.contact import Contact
from stribeck.contacts.friction import Definition, coefficients
from stribeck.contacts.groups import Groups
from stribeck.curves.friction_path import FrictionPath
from stribeck.curves.result import path_of
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.numerics.events import first_zero, least_by_slope, zero_of_growing
from stribeck.numerics.threads import one_blas_thread
from stribeck.quantities.outcome import Outcome
from stribeck.solver.solve import as_groups
from stribeck.solver.solve_error import SolveError, describe

# Tolerance of ln(speed) at the minimum slope, on which the slope itself depends in second order; also its step there.
SPEED_TOLERANCE = 1e-3

MINIMUM_TOLERANCE = 1e-9  # Tolerance of ln(speed) at the minimum, and of ln(roughness) where it disappears

# Relative roughness between which the merging is looked for, and where that begins, in steps of a factor.
KAPPA_RANGE = (1e-5, 1e3)
KAPPA_START = 0.3
KAPPA_STEP = 3.0


def minimum_behind(path: FrictionPath) -> tuple[float, tuple[float, float] | None]:
    """Return the least slope along a path over the speed, and where friction falls, speed and friction of its minimum there.

    The slope over the published viscous friction is 1 far down on the plateau, and 0.4 to 0.7 on the hydrodynamic branch.
    """
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
        return least, None
    _, contact, viscous = path.parts(np.array([minimum.place]))
    return least, (math.exp(minimum.place), float((contact + viscous)[0]))


@one_blas_thread
def roughness_without_minimum(
    problem: Groups | Contact,
    boundary_friction: Any = None,
    beta: float | None = None,
    definition: Definition = "balanced",
    rtol: float = 1e-6,
) -> float:
    r"""Return the roughness, or its group, at which the curves over the speed lose their minimum.

    .. math:: \min_\lambda \frac{1}{\mu_f} \frac{d\mu}{d\ln\lambda} = 0
    """
    contact = problem if isinstance(problem, Contact) else None
    boundary_friction, beta = coefficients(contact, boundary_friction, beta)
    if as_asperity_friction(boundary_friction).is_frictionless:
        return 0.0

    def with_roughness(value: float) -> Any:
        """Return the problem with another roughness."""
        return problem.replace(roughness=value) if isinstance(problem, Contact) else replace(problem, roughness=value)

    kappa_of_unit = float(as_groups(with_roughness(1.0))[0].relative_roughness)

    def least_slope(log_kappa: float) -> float:
        rough = with_roughness(math.exp(log_kappa) / kappa_of_unit)
        given: Any = {"boundary_friction": boundary_friction, "beta": beta, "definition": definition}
        curve = stribeck_curve(rough, points=2, rtol=rtol, **given)
        if curve.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if not curve.outcome.ok:
            raise SolveError(curve.outcome, None, f"{describe(as_groups(rough)[0])}: {curve.outcome.value}")
        return minimum_behind(path_of(curve))[0]

    ends = math.log(KAPPA_RANGE[0]), math.log(KAPPA_RANGE[1])
    tolerance = max(rtol, MINIMUM_TOLERANCE)
    event = zero_of_growing(cache(least_slope), math.log(KAPPA_START), math.log(KAPPA_STEP), ends, tolerance)
    return math.nan if event is None else math.exp(event.place) / kappa_of_unit
