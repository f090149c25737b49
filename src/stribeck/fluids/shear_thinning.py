r"""Films of fluids that thin under shear, exact across the film: no average viscosity.

In a steady film the shear stress is linear across the gap, :math:`\tau(z) = \tau_m + 6 G (z - h/2)` in units of
:math:`\eta_0 U/u_\mathrm{Hz}`.  The walls slide and the film carries the flux m:

.. math::

    \int_0^h \dot\gamma(\tau) \, dz = -s, \qquad \int_0^h (z - h/2) \, \dot\gamma(\tau) \, dz = \tfrac12 (h - m/\rho)

The pressure divides the rate at a given stress by :math:`\eta(p)/\eta_0`: the stress at which thinning begins is held.  These
are two equations for :math:`\tau_m` and G at each node; their derivatives are those of the implicit function.  Sliding thins
the fluid for the flow along the film too, so that the film depends on s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import ClassVar, NamedTuple, Self

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.fluids.fluid import MAX_CACHED_SHAPES, Decay, Key, Slopes, key_of
from stribeck.fluids.laws import DensityLaw, Profile, RateLaw, ViscosityLaw, joined_names, joined_parameters, notes_of
from stribeck.fluids.local_flow import profile
from stribeck.fluids.newtonian import Newtonian
from stribeck.fluids.rheology.viscosity import Constant, Incompressible

__all__ = ["ShearThinning"]

MIN_WEISSENBERG = 1e-60  # Weissenberg number at rest: the viscosity is that of low rates, and squares stay above zero.

MAX_GAP_RATIO = 4.0  # Largest ratio of the films of two evaluations for which the last flow is the first guess.

FIRST_ORDER_BELOW = 0.3  # Change of a wall rate over the larger one up to which a first-order prediction is the first guess.

PLATEAU_RATE_RATIO = 1e4  # Largest rate of a film over the plateau of a power law above which the inlet misses the plateau.


class _Local(NamedTuple):
    """What the film is at nodes, and what it was made for."""

    key: Key
    flow: Profile
    wi: Array
    eta: Array
    eta_slope: Array
    rho: Array
    rho_slope: Array
    r_0: Array
    r_1: Array

    @property
    def as_row(self) -> _Local:
        """Column as an array of one row of nodes."""
        fields = (each[None] for each in self[2:])
        return _Local(self.key, Profile(*(each[None] for each in self.flow)), *fields)


@dataclass(frozen=True)
class ShearThinning:
    """The fluid whose viscosity falls with the shear rate."""

    law: RateLaw  # Stress as a function of the rate, in Hertz units
    viscosity: ViscosityLaw = Constant()  # Viscosity at low rates as a function of pressure
    density: DensityLaw = Incompressible()  # Density as a function of pressure
    slide: float = 1.0  # Half the slide-to-roll ratio, `s = (u1 - u2)/(u1 + u2)`
    speed: Numbers = field(default=1.0, compare=False)  # Speed group at which the film is looked at, see :meth:`at`
    uses_pressure: bool = field(init=False, repr=False, compare=False)
    _known: dict[tuple[int, ...], _Local] = field(init=False, repr=False, compare=False)
    uses_speed: ClassVar[bool] = True

    def __post_init__(self) -> None:
        """Note whether viscosity or density depend on the pressure."""
        uses_pressure = not (isinstance(self.viscosity, Constant) and isinstance(self.density, Incompressible))
        object.__setattr__(self, "uses_pressure", uses_pressure)
        object.__setattr__(self, "_known", {})

    @property
    def name(self) -> str:
        """The names of the laws."""
        return joined_names(self.law.name, self.viscosity, self.density)

    @property
    def parameters(self) -> dict[str, float | str]:
        """Parameters of the laws of the film."""
        return joined_parameters(self.law, self.viscosity, self.density)

    def at(self, speed: Numbers) -> Self:
        """Return the film at a speed group."""
        found = replace(self, speed=speed)
        object.__setattr__(found, "_known", self._known)
        return found

    @property
    def at_low_rates(self) -> Newtonian:
        """The film without shear thinning: its G vanishes at the same gap."""
        return Newtonian(self.viscosity, self.density, slide=self.slide)

    def milder(self, part: float) -> Self:
        """Return the film with milder laws."""
        return replace(
            self, law=self.law.milder(part), viscosity=self.viscosity.milder(part), density=self.density.milder(part)
        )

    def decay(self, speed: float) -> Decay:
        """Return how the pressure falls off far away: there the rate is about 1/h, and h about x**2/2."""
        rate = self.law.plateau
        return Decay(math.sqrt(2 * self.law.time * speed / rate) if rate > 0 else 0.0, rate < 1)

    def gradient(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Array:
        """Return G."""
        local = self._local(gap, pressure, flux_gap)
        return np.asarray(local.eta * (local.flow.g_b - local.flow.g_a) / (6 * gap * local.wi))

    def slopes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Slopes:
        """Return the derivatives of G."""
        local = self._local(gap, pressure, flux_gap)
        g = self.gradient(gap, pressure, flux_gap)
        unit = local.eta / (6 * gap * local.wi)
        by_gap, by_density, by_flux, by_speed = (unit * slope for _, slope in self._changes(local, gap, flux_gap))
        by_speed = by_speed - g
        return Slopes(by_gap - g / gap, self._by_pressure(local, g, by_density, by_speed), by_flux, by_speed)

    def tractions(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> tuple[Array, Array]:
        """Return the wall stresses."""
        local = self._local(gap, pressure, flux_gap)
        unit = -local.eta / local.wi
        return np.asarray(unit * local.flow.g_a), np.asarray(unit * local.flow.g_b)

    def traction_slopes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> tuple[Slopes, Slopes]:
        """Return the derivatives of the wall stresses."""
        local = self._local(gap, pressure, flux_gap)
        unit = -local.eta / local.wi
        found = []
        for wall, traction in zip((-0.5, 0.5), self.tractions(gap, pressure, flux_gap), strict=True):
            changes = self._changes(local, gap, flux_gap)
            by_gap, by_density, by_flux, by_speed = (unit * (mean + wall * slope) for mean, slope in changes)
            by_speed = by_speed - traction
            found.append(Slopes(by_gap, self._by_pressure(local, traction, by_density, by_speed), by_flux, by_speed))
        return found[0], found[1]

    def cavity_traction(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Array:
        """Return the stress at the rate ``s/h`` in the part of the width that is wet."""
        stress, _, eta, _, rho, _, wi = self._couette_stress(gap, pressure)
        return np.asarray(eta * stress / wi * np.minimum(1.0, flux_gap / (rho * gap)))

    def cavity_traction_slopes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Slopes:
        """Return the derivatives of :meth:`cavity_traction`."""
        stress, slope, eta, eta_slope, rho, rho_slope, wi = self._couette_stress(gap, pressure)
        wet = np.minimum(1.0, flux_gap / (rho * gap))
        partly = np.where(wet < 1, 1.0, 0.0)
        traction = eta * stress / wi * wet
        by_speed = eta * slope * self.slide / gap * wet - traction
        by_pressure = None
        if self.uses_pressure:
            by_pressure = eta_slope * (traction + by_speed) - partly * traction * rho_slope / rho
        by_gap = -eta * slope * self.slide / gap**2 * wet - partly * traction / gap
        return Slopes(by_gap, by_pressure, partly * eta * stress / wi / (rho * gap), by_speed)

    def notes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> tuple[str, ...]:
        """Return where the state leaves the range of the laws, or shears a power law at hardly more than its plateau."""
        said = notes_of(self.law, self.viscosity, self.density, gap=gap, pressure=pressure)
        rate = self.law.time * float(self.speed) / float(gap.min())
        if not 0 < self.law.plateau < 1 or rate > PLATEAU_RATE_RATIO * self.law.plateau:
            return said
        return (
            *said,
            f"U/h times the relaxation time is {rate:.1e} at most; where it is below {self.law.plateau:g} the viscosity of a "
            "power law is constant here, which the inlet feels. Give the viscosity at a lower rate, with its longer time",
        )

    def _of_pressure(self, gap: Array, pressure: Array | None) -> tuple[Array, Array, Array, Array]:
        """Return viscosity, slope of its logarithm, density and its slope."""
        if not self.uses_pressure:
            one, zero = np.ones_like(gap), np.zeros_like(gap)
            return one, zero, one, zero
        assert pressure is not None
        log, log_slope = self.viscosity.log(pressure)
        return np.exp(log), log_slope, *self.density.ratio(pressure)

    def _weissenberg(self, eta: Array) -> Array:
        """Return the relaxation time in units of the film's, at each node: with the pressure it grows as the viscosity."""
        wi = np.maximum(self.law.time * np.asarray(self.speed), MIN_WEISSENBERG)
        return np.asarray(wi * eta)

    def _couette_stress(self, gap: Array, pressure: Array | None) -> tuple[Array, ...]:
        """Return stress and slope of the film sheared by the walls alone, and what the pressure does."""
        of_pressure = self._of_pressure(gap, pressure)
        wi = self._weissenberg(of_pressure[0])
        rate = wi * self.slide / gap
        stress, slope = self.law.stress(np.abs(rate))
        return np.copysign(stress, rate), slope, *of_pressure, wi

    def _changes(self, local: _Local, gap: Array, flux_gap: Numbers) -> list[tuple[Array, Array]]:
        """Return how mean and slope of the stress change with gap, density, flux gap and ln U."""
        h, thin = gap, flux_gap / local.rho
        by_r_0, by_r_1 = local.flow.change(1.0, 0.0), local.flow.change(0.0, 1.0)
        changes = (
            (self.slide / h**2 * local.wi, 0.5 * local.wi * (2 * thin - h) / h**3),
            (0.0, 0.5 * local.wi * thin / local.rho / h**2),
            (0.0, -0.5 * local.wi / local.rho / h**2),
            (local.r_0, local.r_1),
        )
        return [(by_r_0[0] * first + by_r_1[0] * second, by_r_0[1] * first + by_r_1[1] * second) for first, second in changes]

    def _by_pressure(self, local: _Local, value: Array, by_density: Array, by_speed: Array) -> Array | None:
        """Return the derivative by pressure of a stress: viscosity and relaxation time grow by the same factor."""
        if not self.uses_pressure:
            return None
        return np.asarray(local.eta_slope * (value + by_speed) + local.rho_slope * by_density)

    def _local(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> _Local:
        """Return the local solutions, those known if the last on as many nodes were for the same film."""
        if len(gap.shape) == 2 and len(gap) == 1 and np.ndim(self.speed) == 0:
            return self._local(gap[0], None if pressure is None else pressure[0], np.ravel(flux_gap)).as_row
        key = key_of(flux_gap, gap, pressure, self.speed)
        last = self._known.get(gap.shape)
        if last is not None and last.key == key:
            return last
        of_pressure = self._of_pressure(gap, pressure)
        eta, _, rho, _ = of_pressure
        wi = self._weissenberg(eta)
        r_0 = -wi * self.slide / gap
        r_1 = 0.5 * wi * (gap - flux_gap / rho) / gap**2
        r_1 = np.where((r_0 == 0) & (r_1 == 0), MIN_WEISSENBERG * wi / gap, r_1)
        start = None if last is None or last.r_0.shape != r_0.shape else _first_guess(last, r_0, r_1)
        shape = r_0.shape
        flow = profile(self.law, r_0.ravel(), r_1.ravel(), start)
        flow = Profile(*(each.reshape(shape) for each in flow))
        found = _Local(key, flow, wi, *of_pressure, r_0, r_1)
        if len(self._known) >= MAX_CACHED_SHAPES:
            self._known.clear()
        self._known[gap.shape] = found
        return found


def _first_guess(last: _Local, r_0: Array, r_1: Array) -> tuple[Array, Array]:
    """Return wall rates to start from: those of the last film, to first order, or the Newtonian ones where that is far."""
    flow = last.flow
    mean, slope = flow.change(r_0 - last.r_0, r_1 - last.r_1)
    size = np.maximum(np.abs(flow.x_a), np.abs(flow.x_b))
    before, now = np.abs(last.r_0) + 6 * np.abs(last.r_1), np.abs(r_0) + 6 * np.abs(r_1)
    found = []
    for sign, x, of_rate, newtonian in (
        (-1.0, flow.x_a, flow.slope_a, r_0 - 6 * r_1),
        (1.0, flow.x_b, flow.slope_b, r_0 + 6 * r_1),
    ):
        step = (mean + 0.5 * sign * slope) / of_rate
        ratio = now / before
        far = np.where((ratio < MAX_GAP_RATIO) & (ratio > 1 / MAX_GAP_RATIO), x * ratio, newtonian)
        found.append(np.where(np.abs(step) < FIRST_ORDER_BELOW * size, x + step, far).ravel())
    return found[0], found[1]
