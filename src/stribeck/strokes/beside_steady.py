"""A stroke beside steady sliding at the same speeds, on the way out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array
from stribeck.curves.stribeck_curve import stribeck_curve
from stribeck.numerics.settings import COARSE_RTOL, NEGLIGIBLE
from stribeck.strokes.result import Stroke

__all__ = ["BesideSteady", "beside_steady"]

SLOWEST = NEGLIGIBLE**2  # Speed over the largest from which on steady friction is solved


@dataclass(frozen=True)
class BesideSteady:
    """Friction coefficients on the way out of the last cycle, and those of steady sliding at the same speeds."""

    largest_speed: float  # [m/s]
    friction_at_largest_speed: float
    friction_at_largest_speed_error: float
    steady_friction: float  # At the largest speed
    steady_friction_error: float
    mean_friction: float  # Over the path
    mean_friction_error: float
    steady_mean_friction: float
    steady_mean_friction_error: float


def beside_steady(stroke: Stroke, on_point: Callable[[int, int], None] | None = None) -> BesideSteady:
    """Return friction at the largest speed and its mean over the path, beside steady sliding; of speeds above zero."""
    # On the way back a body that is not symmetric has other steady states.
    last = stroke.last_cycle
    time, speed, friction, doubt = (
        each[last] for each in (stroke.time, stroke.speed, stroke.friction, stroke.errors["friction"])
    )
    top = int(np.argmax(speed))
    largest = float(speed[top])
    contact, asperities = stroke.contact, stroke.contact.friction_of_asperities
    known = asperities.known_speeds
    slowest = max(SLOWEST * largest, known[0])
    curve = stribeck_curve(
        contact,
        speed=(max(0.99 * slowest, known[0]), min(1.01 * largest, known[1])),
        points=2,
        rtol=NEGLIGIBLE * COARSE_RTOL,
        on_point=on_point,
    )
    steady = curve.at(np.clip(speed, slowest, largest)).friction
    total, error = np.asarray(steady), np.asarray(steady.error)
    # Slower than the curve, friction is between that of its slow end and that of asperities with all of the load.
    dry = asperities.coefficient_at_small_area(contact.replace(speed=slowest))
    slow = np.where((speed > 0) & (speed < slowest), dry, 0.0)
    mean, mean_error = _mean(time, speed, friction, doubt)
    steady_mean, steady_error = _mean(time, speed, total, error + slow)
    return BesideSteady(
        largest_speed=largest,
        friction_at_largest_speed=float(friction[top]),
        friction_at_largest_speed_error=float(doubt[top]),
        steady_friction=float(total[top]),
        steady_friction_error=float(error[top]),
        mean_friction=mean,
        mean_friction_error=mean_error,
        steady_mean_friction=steady_mean,
        steady_mean_friction_error=steady_error,
    )


def _mean(time: Array, speed: Array, values: Array, doubt: Array) -> tuple[float, float]:
    """Return the mean over the path out, and its error: that of the values, and the difference from every second of them."""
    path = np.maximum(speed, 0.0)

    def mean(numbers: Array, step: int = 1) -> float:
        t, v = time[::step], path[::step]
        return float(np.trapezoid(numbers[::step] * v, t) / np.trapezoid(v, t))

    found = mean(values)
    return found, mean(doubt) + abs(found - mean(values, 2))
