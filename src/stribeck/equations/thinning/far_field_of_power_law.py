r"""The film far from a ball of a fluid whose viscosity is a power of the rate, down to the slowest.

In a gap :math:`r^2/2` rates fall as :math:`r^{-2}`, stresses as :math:`r^{-2n}` and the pressure as :math:`r^{-1-2n}`, for all
fluids and ball in the same way: with :math:`r_0^2 = 2 \lambda t` and :math:`\rho = r/r_0`

.. math:: p_f = \frac{\rho^{-1-2n}}{3 t r_0} \sum_k c_k \cos k\theta, \qquad
    \frac{\mathbf F}{\lambda r^2} = \mathbf f(c, \theta), \qquad 3 f_r + \partial_\theta f_\theta = 0

with f from columns across the film.  The offset changes the gap by the part :math:`\epsilon = 2 z_0/r^2`, pressure and flux to
first order by multiples of it, with :math:`f_r + \partial_\theta f_\theta = 0`.

The drag grows as :math:`r^{2-2n}`: its integrals to infinity have no finite value, and those here are without that power, so
that integrals up to a radius are right.

Source: ours, from the generalised Reynolds equation.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any, ClassVar, NamedTuple, cast

import numpy as np

from stribeck._types import Array, Indices
from stribeck.contacts.cut_off import FULL_FAR_FILM
from stribeck.equations.thinning.column import Column, column, mean_wall_stress
from stribeck.equations.thinning.outside_rim import OutsideRim, Waves
from stribeck.fluids.laws import RateLaw
from stribeck.quantities.lazy import cached_property

ANGLE_COUNT = 64  # Angles in half a turn

MAX_STEPS = 40  # Most Newton steps

CONVERGED = 1e-11  # Largest residual of the equations at which Newton's iteration ends

DIFFERENCE_STEP = 1e-6  # Step of the derivatives with respect to the coefficients

GAP_DIFFERENCE_STEP = 1e-3  # Relative change of the gap for the derivative with respect to the offset

FAR_DRAG_RTOL = 3e-6  # Least stated error of the far friction over the drag up to the rim: the finite parts are differences

OFFSET_ERROR = 50.0  # Stated error of the far friction over that drag and the squared relative change of the gap


STEEP_EXPONENT = 0.2  # Exponent below which Newton's iteration starts from the film of a larger exponent

EXPONENT_STEP_RATIO = 1.5  # That larger exponent over the smaller one


class _Similar(NamedTuple):
    """Coefficients of the pressure, of the flux along the radius over r**2, and the integral of the shear over h."""

    pressure: Array
    flux: Array
    shear: float


def _grid(angles: int) -> tuple[Array, Indices, Array, Array]:
    """Return angles, odd modes, and their cosines and sines at the angles."""
    theta, modes = (np.arange(angles) + 0.5) * math.pi / angles, np.arange(1, angles, 2)
    waves = np.multiply.outer(theta, modes)
    return theta, modes, np.cos(waves), np.sin(waves)


def _flux(law: RateLaw, slide: float, found: Array, change: Array, part: float) -> tuple[Array, Array, Column]:
    """Return the coefficients of both components of the flux at the reference radius, and the columns."""
    # ``found`` has the coefficients of the pressure, shape (number, modes), ``change`` their part that grows with the gap.
    theta, modes, cosines, sines = _grid(2 * found.shape[1])
    n = cast("Any", law).exponent
    along = np.stack([np.cos(theta), -np.sin(theta)])[:, None] * np.ones((len(found), 1))
    gradient = np.stack([-((1.0 + 2.0 * n) * found + 2.0 * change) @ cosines.T, -(found * modes) @ sines.T])
    slope, slip = (1.0 + part) * gradient, -slide / (1.0 + part) * along
    flow = column(law, slope.reshape(2, -1), slip.reshape(2, -1))
    flux = (1.0 + part) ** 2 * flow.carried.reshape(gradient.shape) - 0.5 * (1.0 + part) * along
    return flux[0] @ cosines * (2.0 / len(theta)), flux[1] @ sines * (2.0 / len(theta)), flow


def _solved(law: RateLaw, slide: float, start: Array, base: _Similar | None, part: float, known: Array) -> _Similar:
    """Return the film; the radial flux that is not ``base``'s falls as r**-2 besides."""
    theta, modes, _, _ = _grid(2 * start.size)
    old_radial = 0.0 if base is None else base.flux
    old_angular, power = known, 3.0 if base is None else 1.0

    def equations(found: Array) -> tuple[Array, Array, Column]:
        change = np.zeros_like(found) if base is None else found - base.pressure
        radial, angular, flow = _flux(law, slide, found, change, part)
        return power * (radial - old_radial) + modes * (angular - old_angular), radial, flow

    found = start
    left = equations(found[None])[0][0]
    for _ in range(MAX_STEPS):
        moved = found + np.concatenate([DIFFERENCE_STEP * np.eye(found.size), -DIFFERENCE_STEP * np.eye(found.size)])
        values = equations(moved)[0]
        jacobian = (values[: found.size] - values[found.size :]).T / (2.0 * DIFFERENCE_STEP)
        step, length = np.linalg.solve(jacobian, -left), 1.0
        while length > 1e-3:
            there = equations((found + length * step)[None])[0][0]
            if np.linalg.norm(there) < np.linalg.norm(left):
                break
            length *= 0.5
        else:
            break
        found, left = found + length * step, there
        if np.abs(left).max() <= CONVERGED:
            break
    _, radial, flow = equations(found[None])
    shear = mean_wall_stress(flow, np.stack([np.cos(theta), -np.sin(theta)]), slide) / (1.0 if slide else 1.0 + part)
    return _Similar(found, radial[0], float(shear.mean()) * 2.0 * math.pi)


@lru_cache(maxsize=64)
def similar(law: Any, slide: float, angles: int = ANGLE_COUNT) -> tuple[_Similar, _Similar]:
    """Return the film of a law, and its change by the part by which the gap differs."""
    start, nothing = np.zeros(angles // 2), np.zeros(angles // 2)
    start[0] = -1.2  # of a Newtonian fluid
    if law.exponent < STEEP_EXPONENT:
        start = similar(replace(law, exponent=EXPONENT_STEP_RATIO * law.exponent), slide, angles)[0].pressure
    found = _solved(law, slide, start, None, 0.0, nothing)
    angular = _flux(law, slide, found.pressure[None], nothing[None], 0.0)[1][0]
    below, above = (
        _solved(law, slide, found.pressure, found, part, angular) for part in (-GAP_DIFFERENCE_STEP, GAP_DIFFERENCE_STEP)
    )
    double = 2.0 * GAP_DIFFERENCE_STEP
    pressure, flux = ((getattr(above, name) - getattr(below, name)) / double for name in ("pressure", "flux"))
    return found, _Similar(pressure, flux, (above.shear - below.shear) / double)


class FarPower(OutsideRim):
    """The film of a ball beyond a rim, of a power law."""

    is_all: ClassVar[bool] = True

    @property
    def exponent(self) -> float:
        """N."""
        return float(cast("Any", self.law).exponent)

    @property
    def ratio(self) -> float:
        """The rim over the radius where the rate is one over the relaxation time."""
        return self.rim / math.sqrt(2.0 * self.law.time * self.speed)

    def _film_by(self, angles: int) -> tuple[_Similar, _Similar]:
        return similar(replace(cast("Any", self.law), relaxation_time=1.0), self.slide, angles)

    @cached_property
    def _film(self) -> tuple[_Similar, _Similar]:
        return self._film_by(ANGLE_COUNT)

    @cached_property
    def _known(self) -> float:
        """An estimate of the error of friction over the drag up to the rim, by half the angles."""
        # Where a wall rests a stress has a kink along the angle, and the modes fall off slowly, the slower the smaller n.
        half = self._film_by(ANGLE_COUNT // 2)[0]
        film, q = self._film[0], 2.0 - 2.0 * self.exponent
        pressure = abs(film.pressure[0] - half.pressure[0]) * (0.25 + 0.5 / q)
        return max(FAR_DRAG_RTOL, abs(film.shear - half.shear) / (2.0 * math.pi * q) + float(pressure))

    @property
    def drag(self) -> float:
        """An estimate of the drag up to the rim."""
        return math.pi * self._unit

    def friction_error(self, offset: float) -> float:
        """Return an estimate of the error of the friction."""
        return self.drag * (self._known + OFFSET_ERROR * (2.0 * max(1.0, abs(offset)) / self.rim**2) ** 2)

    @property
    def _unit(self) -> float:
        """Unit of the pressure at the rim times the rim to the power three."""
        return float(self.speed / 1.5 * self.ratio ** (2.0 - 2.0 * self.exponent))

    def _parts(self, offset: float) -> float:
        return 2.0 * offset / self.rim**2

    @cached_property
    def at_rim_by_offset(self) -> tuple[Waves, Waves]:
        """The waves at the rim, and by the offset to first order."""
        rim, gap = self.rim, 0.5 * self.rim**2
        base, change = (
            Waves(
                self._unit / rim**3 * film.pressure,
                -(power + 2.0 * self.exponent) * self._unit / rim**4 * film.pressure,
                self.speed * rim**2 * film.flux,
            )
            for film, power in zip(self._film, (1.0, 3.0), strict=True)
        )
        part, carried = self._parts(1.0), np.zeros_like(base.flux)
        carried[0] = self.speed
        change = Waves(*(part * each for each in change))
        # What the walls carry, and what the slope moves in the gap of a fluid that does not thin, is counted elsewhere.
        by_offset = change.flux + carried - gap**3 * change.slope - 3.0 * gap**2 * base.slope
        return base._replace(flux=base.flux + gap * carried - gap**3 * base.slope), change._replace(flux=by_offset)

    def tails(self, offset: float) -> tuple[float, float, float]:
        """Return the parts of shear, pressure flow and moment beyond the rim, and Newtonian logarithms up to it."""
        base, change = self._film
        q, part, log = 2.0 - 2.0 * self.exponent, self._parts(offset), math.log(self.rim)
        drag = self.ratio**q * (-base.shear / q + part * change.shear / (2.0 - q))
        first = self._unit * float(base.pressure[0] + part * change.pressure[0])
        moment = math.pi * self._unit * float(-base.pressure[0] / q + part * change.pressure[0] / (2.0 - q))
        # By parts: (r h f)/2 at the rim, and half the moment; the constant is that of the other fluids.
        poiseuille = -0.25 * math.pi * (1.0 + part) * first - 0.5 * moment - 0.5 * FULL_FAR_FILM.poiseuille * self.speed
        strength = FULL_FAR_FILM.poiseuille * self.speed * log
        return (
            self.speed / 3.0 * drag + FULL_FAR_FILM.couette * self.speed * log,
            poiseuille + strength,
            moment - 2.0 * strength,
        )
