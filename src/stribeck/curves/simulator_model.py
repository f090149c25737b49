"""The formula of Stribeck friction that simulators of motion take, through a computed curve."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from stribeck._types import Array
from stribeck.files.results import Record
from stribeck.quantities.results import Card, Told
from stribeck.quantities.units import InputError

POINTS = 121  # Points of the curve, evenly in ln(speed), that the formula is fitted to
EXPONENTS = (0.5, 1.0, 2.0)  # First values of the exponent
MAX_EXPONENT = 4.0  # Largest exponent: a steeper fall is a step
ROUGH = 0.1  # Largest relative deviation above which the text says that the formula is coarse


@dataclass(frozen=True, repr=False)
class StribeckModel(Record, Told):
    r"""Parameters of the usual formula of Stribeck friction, and how far it is from the curve.

    .. math:: \mu(v) = \mu_c + (\mu_s - \mu_c) \, e^{-(v/v_s)^\delta} + k v

    Examples
    --------
    >>> model = StribeckModel(0.5, 0.02, 1e-3, 1.0, 0.3, 0.05, 0.01, (1e-4, 1.0))
    >>> round(float(model.at(1e-3)), 4)
    0.1969
    """

    static_friction: Annotated[float, "friction coefficient at rest, mu_s", "1"]
    coulomb_friction: Annotated[float, "friction coefficient that the fall ends at, mu_c", "1"]
    stribeck_speed: Annotated[float, "speed over which friction falls, v_s", "m/s"]
    exponent: Annotated[float, "exponent of the fall, delta", "1"]
    viscous_coefficient: Annotated[float, "rise of friction with the speed, k", "s/m"]
    relative_error: Annotated[float, "largest deviation from the curve over the friction there", "1"]
    error: Annotated[float, "largest deviation from the curve", "1"]
    speeds: Annotated[tuple[float, float], "range of the sliding speed that it was fitted on", "m/s"]

    def at(self, speed: Any) -> Array:
        """Return the friction coefficient of the formula.

        Parameters
        ----------
        speed : array_like
            Sliding speeds [m/s].

        Returns
        -------
        ndarray
            Friction coefficients [-].
        """
        v = np.abs(np.asarray(speed, dtype=float))
        fall = np.exp(-((v / self.stribeck_speed) ** self.exponent))
        rest = self.static_friction - self.coulomb_friction
        return np.asarray(self.coulomb_friction + rest * fall + self.viscous_coefficient * v)

    def _card(self) -> Card:
        rows = [
            (label, f"{getattr(self, name):.4g}", "" if unit == "1" else unit)
            for name, (unit, label) in self._labels.items()
            if name != "speeds"
        ]
        low, high = self.speeds
        advice = ["The formula is coarse here; take the curve itself as a table."] if self.relative_error > ROUGH else []
        return Card(
            "mu(v) = mu_c + (mu_s - mu_c) exp(-(v/v_s)^delta) + k v",
            table=[("parameter", "value", "unit"), *rows],
            sentences=[
                f"Fitted to the curve from {low:.3g} to {high:.3g} m/s, evenly in the logarithm of the speed.",
                *advice,
            ],
        )


def simulator_model(curve: Any) -> StribeckModel:
    """Return the formula through a curve over the speed."""
    if curve.over != "speed" or curve.contact is None:
        raise InputError(
            f"the formula is one of the speed in m/s, and this curve runs over the {curve.over}"
            f"{'' if curve.contact is not None else ' group'}; make a stribeck_curve of a contact over its speed."
        )
    if len(curve) < 2 or np.unique(curve.speed).size < 2:
        raise InputError("the curve has fewer than two speeds; make one over a range.")
    slides = 0.5 * abs(float(getattr(curve.contact, "slide_to_roll", 2.0)))
    if slides == 0:
        raise InputError("the surfaces roll and do not slide, so that there is no sliding speed for the formula.")
    speed = np.geomspace(curve.speed[0], curve.speed[-1], POINTS)
    friction = np.abs(np.asarray(curve.at(speed).friction.total))
    return _fitted(speed * slides, friction)


def _fitted(v: Array, friction: Array) -> StribeckModel:
    from scipy.optimize import least_squares  # slow to import

    top, low = float(friction.max()), float(friction.min())
    fastest = float(v[-1])

    def model(p: Array) -> StribeckModel:
        k = math.exp(p[4]) / fastest
        ends = float(v[0]), fastest
        return StribeckModel(math.exp(p[0]), math.exp(p[1]), math.exp(p[2]), float(p[3]), k, 0.0, 0.0, ends)

    def deviation(p: Array) -> Array:
        return np.asarray(np.log(model(p).at(v) / friction))

    half = float(v[np.argmin(np.abs(np.log(friction / math.sqrt(top * low))))])
    rise = math.log(max(float(friction[-1]) - low, 1e-3 * low))
    starts = [np.array([math.log(top), math.log(low), math.log(half), n, rise]) for n in EXPONENTS]
    bounds = ([-40.0, -40.0, -80.0, 0.05, -60.0], [5.0, 5.0, 40.0, MAX_EXPONENT, 5.0])
    best = min((least_squares(deviation, start, bounds=bounds, x_scale="jac") for start in starts), key=lambda each: each.cost)
    found = model(best.x)
    off = found.at(v) - friction
    values = {name: getattr(found, name) for name in found._labels}
    return StribeckModel(**values | {"relative_error": float(np.abs(off / friction).max()), "error": float(np.abs(off).max())})
