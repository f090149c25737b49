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
from typing import NamedTuple

import numpy as np

from stribeck._types import Array
from stribeck.equations.thinning.column import column, mean_wall_stress
from stribeck.equations.thinning.outside_rim import OutsideRim, Waves
from stribeck.fluids.laws import RateLaw
from stribeck.numerics.fourier_panels import radau
from stribeck.quantities.lazy import cached_property

ANGLE_COUNT = 20  # Angles of the columns in half a turn

MAX_DEGREE = 5  # Highest degree of the polynomial in powers of the radius

MAX_ROUNDS = 40  # Most fixed-point iterations

CONVERGED = 1e-9  # Change of the pressure coefficients over the speed at which the fixed-point iteration ends

# Distance from a resonance over the lost fraction below which an exponent is left out: fixed-point iteration diverges there.
RESONANCE_FACTOR = 20.0

MIN_LOST_FRACTION = 1e-9  # Lost fraction of the viscosity at the rim below which the far film is Newtonian to column accuracy

FIRST_ORDER = 1e-6  # Lost fraction of the viscosity at which its exponent in the rate is read

# Stated error of friction over speed, lost fraction at the rim, and offset over the squared rim radius; the true factor is up
# to 5 for Cross's law with exponents from 0.1 to 0.8.
OFFSET_ERROR_FACTOR = 12.0

ROLLING_SHEAR_RATE = 0.3  # Shear rate between walls that roll, which the pressure drives, over mean speed and film thickness


def lost(law: RateLaw, rate: float) -> float:
    """Return the part of the viscosity that is lost at a rate over that of the relaxation time."""
    return abs(1.0 - float(law.stress(np.array([rate]))[0][0]) / rate)


def far_rate(law: RateLaw, slide: float, speed: float, radius: float) -> float:
    """Return the rate at a radius far from the contact, over that of the relaxation time."""
    return 2.0 * law.time * speed * max(abs(slide), ROLLING_SHEAR_RATE) / radius**2


class _Film(NamedTuple):
    """The film less a Newtonian one, at the nodes in v."""

    pressure: Array  # Coefficients of the cosines of the pressure, over r**-3
    flux: Array  # Coefficients of the cosines of the flux along the radius, over r**2
    steepness: Array  # Derivative of the pressure's at the rim by ln r, over r**-3
    drag: Array  # Of the shear, around the ring


class FarThinned(OutsideRim):
    """The film of a ball beyond a rim, less that of a fluid that does not thin."""

    @cached_property
    def lost(self) -> float:
        """The lost part of the viscosity at the rim."""
        return lost(self.law, far_rate(self.law, self.slide, self.speed, self.rim))

    @cached_property
    def power(self) -> float:
        """The power of the rate with which it falls."""
        rate = far_rate(self.law, self.slide, self.speed, self.rim)
        while lost(self.law, rate) > FIRST_ORDER:
            rate *= 0.1
        return math.log2(lost(self.law, 2.0 * rate) / lost(self.law, rate)) if self.lost > MIN_LOST_FRACTION else 2.0

    @cached_property
    def degree(self) -> int:
        """The degree of the polynomial."""
        powers = (2.0 * self.power * np.arange(1, MAX_DEGREE + 2)[:, None]) ** 2
        resonance = np.abs(powers - 9.0 - np.arange(1, ANGLE_COUNT, 2) ** 2).min(axis=1)
        poor = np.flatnonzero(resonance < RESONANCE_FACTOR * self.lost)
        return max(0, int(poor[0]) - 1) if poor.size else MAX_DEGREE

    @property
    def drag(self) -> float:
        """An estimate of the drag that is lost beyond the rim."""
        return math.pi / 3.0 * self.speed * self.lost / self.power

    def friction_error(self, offset: float) -> float:
        """Return an estimate of the error of the friction, as the gap is more than r**2/2 by the offset."""
        return OFFSET_ERROR_FACTOR * self.speed * self.lost * max(1.0, abs(offset)) / self.rim**2

    @cached_property
    def at_rim_by_offset(self) -> tuple[Waves, Waves]:
        """The waves at the rim; those by the offset are not known."""
        film, rim = self._film, self.rim
        at_rim = film.pressure[-1] / rim**3, (film.steepness - 3.0 * film.pressure[-1]) / rim**4, film.flux[-1] * rim**2
        found = Waves(*(each[1::2] for each in at_rim))
        return found, Waves(*(np.zeros_like(each) for each in found))

    def tails(self, offset: float) -> tuple[float, float, float]:
        """Return the parts of shear, pressure flow and moment beyond the rim."""
        del offset
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
        law, speed, rim = self.law, self.speed, self.rim
        theta, modes = (np.arange(ANGLE_COUNT) + 0.5) * math.pi / ANGLE_COUNT, np.arange(ANGLE_COUNT)
        cosines, sines = (each(np.multiply.outer(theta, modes)) for each in (np.cos, np.sin))
        to_cosines, to_sines = cosines * (2.0 / ANGLE_COUNT), sines * (2.0 / ANGLE_COUNT)
        to_cosines[:, 0] *= 0.5
        v, _, derivative = _grid(self.degree)
        along_r = -2.0 * self.power * (np.eye(v.size) + v[:, None] ** 2 * derivative / v)
        odd = modes[1::2]  # as the pressure is
        inverse = np.linalg.inv(along_r @ along_r - (9.0 + odd[:, None, None] ** 2) * np.eye(v.size))
        scale = (rim * v ** (-0.5 / self.power))[:, None] ** 2  # Of r**2: all else is the same at all radii.
        along = np.stack([np.tile(np.cos(theta), (v.size, 1)), np.tile(-np.sin(theta), (v.size, 1))])
        plain = 0.8 * speed * np.stack([3.0 * along[0], -along[1]])
        slip = -(2.0 * speed * law.time * self.slide) / scale * along
        found = np.zeros((v.size, ANGLE_COUNT))
        for _ in range(MAX_ROUNDS):
            before = found
            gradient = plain + np.stack([(along_r @ found - 3.0 * found) @ cosines.T, -(found * modes) @ sines.T])
            flow = column(law, (3.0 * law.time / scale * gradient).reshape(2, -1), slip.reshape(2, -1))
            flux = 0.5 * scale / law.time * flow.carried.reshape(gradient.shape) - 0.125 * gradient
            radial, angular = flux[0] @ to_cosines, flux[1] @ to_sines
            leaving = 3.0 * radial + along_r @ radial + modes * angular
            found = np.zeros_like(before)
            found[:, odd] = -8.0 * np.matmul(inverse, leaving.T[odd, :, None])[:, :, 0].T
            if np.abs(found - before).max() <= CONVERGED * speed:
                break
        shear = mean_wall_stress(flow, along.reshape(2, -1), self.slide).reshape(gradient.shape[1:])
        shear *= 0.5 * scale / (law.time * speed) if self.slide else 1.0
        drag = (shear - 1.0).sum(axis=1) * (2.0 * math.pi / ANGLE_COUNT)
        return _Film(found, radial, (along_r @ found)[-1], drag)


def _grid(degree: int) -> tuple[Array, Array, Array]:
    """Return Radau's nodes in v from 0 to 1, the last at 1, their weights, and the derivative of the polynomial."""
    rule = radau(degree)
    return 0.5 * (rule.nodes + 1.0), 0.5 * rule.weights, 2.0 * rule.derivative
