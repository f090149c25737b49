r"""Films of fluids that thin under shear, exact across the film: no average viscosity.

In a steady film the shear stress is linear across the gap, :math:`\tau(z) = \tau_m + 6 G (z - h/2)` in units of
:math:`\eta_0 U/u_\mathrm{Hz}`.  The walls slide and the film carries the flux m:

.. math::

    \int_0^h \dot\gamma(\tau) \, dz = -s, \qquad \int_0^h (z - h/2) \, \dot\gamma(\tau) \, dz = \tfrac12 (h - m/\rho)

The pressure divides the rate at a given stress by :math:`\eta(p)/\eta_0`: the stress at which thinning begins is held.  These
are two equations for :math:`\tau_m` and G at each node; their derivatives are those of the implicit function.  Sliding thins
the fluid for the flow along the film too, so that the film depends on s.
"""

import math
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from stribeck._types import Array
from stribeck.fluids.fluid import MAX_CACHED_SHAPES, Decay
from stribeck.fluids.laws import (
    DensityLaw,
    FilmUnits,
    Profile,
    RateLaw,
    ViscosityLaw,
    joined_names,
    joined_parameters,
    notes_of,
)
from stribeck.fluids.local_flow import profile
from stribeck.fluids.newtonian import Column, Newtonian
from stribeck.fluids.rheology.viscosity import Constant, Incompressible
from stribeck.numerics.dual import value_of
from stribeck.numerics.trace import Trace, mapped, pointwise

MIN_WEISSENBERG = 1e-60  # Weissenberg number at rest: the viscosity is that of low rates, and squares stay above zero.

MAX_GAP_RATIO = 4.0  # Largest ratio of the films of two evaluations for which the last flow is the first guess.

FIRST_ORDER_BELOW = 0.3  # Change of a wall rate over the larger one up to which a first-order prediction is the first guess.

PLATEAU_RATE_RATIO = 1e4  # Largest rate of a film over the plateau of a power law above which the inlet misses the plateau.


class _Flow(NamedTuple):
    """The flow across the film at nodes, and the integrals that it was made for."""

    flow: Profile
    r_0: Array
    r_1: Array


@dataclass(frozen=True)
class ShearThinning(Column):
    """The fluid whose viscosity falls with the shear rate."""

    law: RateLaw  # Stress as a function of the rate, in Hertz units
    viscosity: ViscosityLaw = Constant()  # Viscosity at low rates as a function of pressure
    density: DensityLaw = Incompressible()  # Density as a function of pressure
    slide: float = 1.0  # Half the slide-to-roll ratio, `s = (u1 - u2)/(u1 + u2)`
    entrained: float = 1.0  # Sum of the speeds over U, see :meth:`moving`
    speed: Any = field(default=1.0, compare=False)  # Speed group at which the film is looked at, see :meth:`at`
    uses_speed: ClassVar[bool] = True

    @property
    def name(self) -> str:
        """The names of the laws."""
        return joined_names(self.law.name, self.viscosity, self.density)

    @property
    def parameters(self) -> dict[str, float | str]:
        """Parameters of the laws of the film."""
        return joined_parameters(self.law, self.viscosity, self.density)

    def at(self, speed: Any) -> Self:
        """Return the film at a speed group."""
        return self._changed(speed=speed)

    @property
    def at_low_rates(self) -> Newtonian:
        """The film without shear thinning: its G vanishes at the same gap."""
        return Newtonian(self.viscosity, self.density, slide=self.slide, entrained=self.entrained)

    def with_shorter_time(self, part: float) -> Self:
        """Return the film of a fluid whose relaxation time is a part of this one's."""
        return replace(self, law=self.law.scaled(FilmUnits(1.0, 1.0 / part, 1.0, 1.0)))

    def decay(self, speed: float) -> Decay:
        """Return how the pressure falls off far away: there the rate is about 1/h, and h about x**2/2."""
        rate = self.law.plateau
        return Decay(math.sqrt(2 * self.law.time * speed / rate) if rate > 0 else 0.0, rate < 1)

    def gradient(self, gap: Any, pressure: Any, flux_gap: Any) -> Any:
        """Return G."""
        eta, _, slope = self._stress(gap, pressure, flux_gap)
        return eta * slope / (6 * gap)

    def tractions(self, gap: Any, pressure: Any, flux_gap: Any) -> tuple[Any, Any]:
        """Return the wall stresses."""
        eta, mean, slope = self._stress(gap, pressure, flux_gap)
        return -(eta * (mean - 0.5 * slope)), -(eta * (mean + 0.5 * slope))

    def cavity_traction(self, gap: Any, pressure: Any, flux_gap: Any) -> Any:
        """Return the stress at the rate ``s/h`` in the part of the width that is wet."""
        eta, rho, wi = self._laws(pressure)

        # Above zero, where the viscosity of some laws has no slope.
        size = np.maximum(wi * abs(self.slide) / gap, MIN_WEISSENBERG)
        wet = np.minimum(1.0, flux_gap / (rho * self.entrained * gap))
        return math.copysign(1.0, self.slide) * eta / wi * mapped(self.law.stress, size) * wet

    def notes(self, gap: Array, pressure: Array | None, flux_gap: Any) -> tuple[str, ...]:
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

    def _laws(self, pressure: Any) -> tuple[Any, Any, Any]:
        """Return viscosity, density and the relaxation time over that of the film: it grows as the viscosity."""
        eta, rho = self._of_pressure(pressure)
        return eta, rho, np.maximum(self._times(), MIN_WEISSENBERG) * eta

    def _times(self) -> Any:
        """Return the relaxation time at the speed, in units of the film's."""
        return self.law.time * (self.speed if isinstance(self.speed, Trace) else np.asarray(self.speed))

    def _stress(self, gap: Any, pressure: Any, flux_gap: Any) -> tuple[Any, Any, Any]:
        """Return the viscosity, and over it the mean of the stress across the film and its change from wall to wall."""
        eta, rho, wi = self._laws(pressure)
        r_0 = -(wi * self.slide / gap)
        carried_along = gap if self.entrained == 1.0 else self.entrained * gap
        r_1 = 0.5 * wi * (carried_along - flux_gap / rho) / (gap * gap)
        at_rest = (value_of(r_0) == 0) & (value_of(r_1) == 0)
        if at_rest.any():
            r_1 = r_1 + np.where(at_rest, MIN_WEISSENBERG * value_of(wi) / value_of(gap), 0.0)
        flow = self._flow(value_of(r_0), value_of(r_1))
        (mean_0, slope_0), (mean_1, slope_1) = flow.change(1.0, 0.0), flow.change(0.0, 1.0)
        mean = pointwise(lambda *_: (0.5 * (flow.g_a + flow.g_b), mean_0, mean_1), r_0, r_1)
        slope = pointwise(lambda *_: (flow.g_b - flow.g_a, slope_0, slope_1), r_0, r_1)
        return eta, mean / wi, slope / wi

    def _flow(self, r_0: Array, r_1: Array) -> Profile:
        """Return the flow with two integrals, that known if the last on as many nodes was for the same."""
        shape = r_0.shape
        r_0, r_1 = r_0.ravel(), r_1.ravel()
        last = self._known.get(r_0.size)
        if last is None or not (np.array_equal(last.r_0, r_0) and np.array_equal(last.r_1, r_1)):
            flow = profile(self.law, r_0, r_1, None if last is None else _first_guess(last, r_0, r_1))
            if len(self._known) >= MAX_CACHED_SHAPES:
                self._known.clear()
            last = self._known[r_0.size] = _Flow(flow, r_0, r_1)
        return Profile(*(each.reshape(shape) for each in last.flow))


def _first_guess(last: _Flow, r_0: Array, r_1: Array) -> tuple[Array, Array]:
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
        found.append(np.where(np.abs(step) < FIRST_ORDER_BELOW * size, x + step, far))
    return found[0], found[1]
