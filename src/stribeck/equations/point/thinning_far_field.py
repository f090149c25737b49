r"""The film far from a ball of a fluid that still thins there.

In a gap :math:`r^2/2` all rates fall as :math:`r^{-2}`, and so does, to the power :math:`\mu` of the rate, the part of its
viscosity that the fluid has lost.  With :math:`v = (r_\mathrm{rim}/r)^{2\mu}` the flux differs from that of a fluid that does
not thin by :math:`\mathbf F_\delta = r^2 \mathbf f(v, \theta)`, the pressure by :math:`r^{-3} \sum_k c_k(v) \cos k\theta`, and

.. math:: \tfrac18 (D^2 - 9 - k^2) \, c_k = -\big[(3 + D) f_r + \partial_\theta f_\theta\big]_k, \qquad
    D = \frac{d}{d\ln r} = -2 \mu v \frac{d}{dv}

with f from columns under the whole pressure gradient.  Both are v times what is smooth in v: a polynomial through Radau's
nodes from infinity to the rim, found in rounds of which each gains the lost part.  What is left is of the order of the lost
part times the offset over the gap at the rim.

Source: ours, from the generalised Reynolds equation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.equations.point.column import column, mean_wall_stress
from stribeck.fluids.laws import RateLaw
from stribeck.numerics.fourier_panels import radau
from stribeck.numerics.settings import HALF_DIGITS, LEAST_DEGREE, MAX_STEPS, NEGLIGIBLE, SAFETY
from stribeck.quantities.lazy import cached_property


def lost(law: RateLaw, rate: float) -> float:
    """Return the part of the viscosity that is lost at a rate over that of the relaxation time."""
    return abs(1.0 - float(law.stress(np.array([rate]))[0]) / rate)


def usual_rate(law: RateLaw, slide: float, speed: float, gap: float) -> float:
    """Return the rate in a gap over that of the relaxation time: pressure shears films of walls that roll, too."""
    return law.time * speed * max(1.0, abs(slide)) / gap


class _Film(NamedTuple):
    """The film less a Newtonian one, at the nodes in v."""

    pressure: Array  # Coefficients of the cosines of the pressure, over r**-3
    flux: Array  # Coefficients of the cosines of the flux along the radius, over r**2
    steepness: Array  # Derivative of the pressure's at the rim by ln r, over r**-3
    drag: Array  # Of the shear, around the ring


@dataclass(frozen=True, eq=False)
class FarThinned:
    """The film of a ball beyond a rim, less that of a fluid that does not thin."""

    law: RateLaw  # The law, its time in Hertz units at this speed
    slide: float  # Half the slide-to-roll ratio
    speed: float  # Speed group
    rim: float  # Radius of the rim [a]
    angles: int  # Angles of the columns in half a turn

    def at_radius(self, radius: float) -> FarThinned:
        """Return the film beyond another radius."""
        return replace(self, rim=radius)

    @cached_property
    def lost(self) -> float:
        """The lost part of the viscosity at the rim."""
        return lost(self.law, usual_rate(self.law, self.slide, self.speed, 0.5 * self.rim**2))

    @cached_property
    def power(self) -> float:
        """The power of the rate with which it falls."""
        rate = 1.0
        while lost(self.law, rate) > HALF_DIGITS:
            rate *= NEGLIGIBLE
        return math.log(lost(self.law, rate / NEGLIGIBLE) / lost(self.law, rate)) / -math.log(NEGLIGIBLE)

    @cached_property
    def degree(self) -> int:
        """The degree of the polynomial."""
        # Near a power with which pressures fall by themselves a round does not gain what is lost.
        powers = (2.0 * self.power * np.arange(1, LEAST_DEGREE + 2)[:, None]) ** 2
        resonance = np.abs(powers - 9.0 - np.arange(1, self.angles, 2) ** 2).min(axis=1)
        poor = np.flatnonzero(NEGLIGIBLE * resonance < SAFETY * self.lost)
        return max(0, int(poor[0]) - 1) if poor.size else LEAST_DEGREE

    @property
    def drag(self) -> float:
        """An estimate of the drag that is lost beyond the rim."""
        return math.pi / 3.0 * self.speed * self.lost / self.power if self.lost > HALF_DIGITS else 0.0

    def friction_error(self, offset: float) -> float:
        """Return an estimate of the error of the friction, as the gap is more than r**2/2 by the offset."""
        more = max(1.0, abs(offset)) / (0.5 * self.rim**2)  # in flow and drag with the third power at most
        return SAFETY * 3.0 * more * self.speed * self.lost

    @property
    def first(self) -> float:
        """The factor of cos(theta) in the pressure at the rim."""
        return float(self._film.pressure[-1, 1] / self.rim**3)

    def at_rim(self, angles: Array, modes: int) -> Array:
        """Return pressure, its radial derivative and flux at angles of the rim, shape (3, angles)."""
        film, rim = self._film, self.rim
        cosines = np.cos(np.multiply.outer(angles, np.arange(min(modes, self.angles))))
        waves = film.pressure[-1] / rim**3, (film.steepness - 3.0 * film.pressure[-1]) / rim**4, film.flux[-1] * rim**2
        return np.stack([cosines @ each[: cosines.shape[1]] for each in waves])

    @cached_property
    def tails(self) -> tuple[float, float, float]:
        """The parts of shear, pressure flow and moment beyond the rim."""
        film = self._film
        v, weights = _grid(self.degree)[:2]
        weights = weights / (2.0 * self.power * v)  # of dr/r
        first = film.pressure[:, 1]
        couette = self.speed / 3.0 * float(weights @ film.drag)
        moment = math.pi * float(weights @ first)
        # (r h/2)(f' + f/r), by parts.
        return couette, -0.25 * math.pi * float(first[-1]) - 0.5 * moment, moment

    @cached_property
    def _film(self) -> _Film:
        law, speed, rim, count = self.law, self.speed, self.rim, self.angles
        theta, modes = (np.arange(count) + 0.5) * math.pi / count, np.arange(count)
        cosines, sines = (each(np.multiply.outer(theta, modes)) for each in (np.cos, np.sin))
        to_cosines, to_sines = cosines * (2.0 / count), sines * (2.0 / count)
        to_cosines[:, 0] *= 0.5
        v, _, derivative = _grid(self.degree)
        along_r = -2.0 * self.power * (np.eye(v.size) + v[:, None] ** 2 * derivative / v)
        odd = modes[1::2]  # as the pressure is
        inverse = np.linalg.inv(along_r @ along_r - (9.0 + odd[:, None, None] ** 2) * np.eye(v.size))
        scale = (rim * v ** (-0.5 / self.power))[:, None] ** 2  # Of r**2: all else is the same at all radii.
        along = np.stack([np.tile(np.cos(theta), (v.size, 1)), np.tile(-np.sin(theta), (v.size, 1))])
        plain = 0.8 * speed * np.stack([3.0 * along[0], -along[1]])
        slip = (-(2.0 * speed * law.time * self.slide) / scale * along).reshape(2, -1)
        found, start = np.zeros((v.size, count)), None
        for _ in range(MAX_STEPS):
            before = found
            gradient = plain + np.stack([(along_r @ found - 3.0 * found) @ cosines.T, -(found * modes) @ sines.T])
            flow = column(law, (3.0 * law.time / scale * gradient).reshape(2, -1), slip, start)
            flux, start = 0.5 * scale / law.time * flow.carried.reshape(gradient.shape) - 0.125 * gradient, flow.mean
            radial, angular = flux[0] @ to_cosines, flux[1] @ to_sines
            leaving = 3.0 * radial + along_r @ radial + modes * angular
            found = np.zeros_like(before)
            found[:, odd] = -8.0 * np.matmul(inverse, leaving.T[odd, :, None])[:, :, 0].T
            if np.abs(found - before).max() <= HALF_DIGITS * speed:
                break
        shear = mean_wall_stress(flow, along.reshape(2, -1), self.slide).reshape(gradient.shape[1:])
        shear *= 0.5 * scale / (law.time * speed) if self.slide else 1.0
        drag = (shear - 1.0).sum(axis=1) * (2.0 * math.pi / count)
        return _Film(found, radial, (along_r @ found)[-1], drag)


def _grid(degree: int) -> tuple[Array, Array, Array]:
    """Return Radau's nodes in v from 0 to 1, the last at 1, their weights, and the derivative of the polynomial."""
    rule = radau(degree)
    return 0.5 * (rule.nodes + 1.0), 0.5 * rule.weights, 2.0 * rule.derivative
