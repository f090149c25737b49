r"""Shear stress of a fluid as a function of the shear rate.

Each law is of the form :math:`\tau t/\eta_0 = g(t \dot\gamma)` with one time t, the relaxation time.  With
:math:`\epsilon = \eta_\infty/\eta_0`:

.. math::

    g(x) = \begin{cases}
        x \, [\epsilon + (1 - \epsilon)(1 + x^2)^{(n-1)/2}] & \text{Carreau} \\
        x \, [\epsilon + (1 - \epsilon)/(1 + x^m)] & \text{Cross} \\
        x \, (10^{-16} + x^2)^{(n-1)/2} \approx x^n & \text{power law}
    \end{cases}

Source: [Carreau 1972], [Cross 1965].
"""

from dataclasses import replace
from typing import Any, ClassVar, Self

import numpy as np

from stribeck._types import Array
from stribeck.fluids.laws import FilmUnits, RateLaw
from stribeck.fluids.rheology.tabulated import EXPONENT, MIN_EXPONENT, RELAXATION_TIME
from stribeck.quantities.schema import Input, law
from stribeck.quantities.units import InputError

# Shear rate times relaxation time below which a power law has its plateau: without one, its drag has no bound for n <= 1/2.
PLATEAU_RATE = 1e-8

# Exponent below which the drag grows by 1e-3 or more if the plateau begins at a rate 1e4 times lower.
FAR_DRAG_EXPONENT = 0.75

INFINITE_VISCOSITY = Input(
    label="viscosity at high rates",
    symbol=r"$\eta_\infty$",
    dimension="viscosity",
    typical="1 mPa*s",
    source="the solvent of a polymer solution",
    zero=True,
    default=0.0,
)


@law
class _BetweenPlateaus(RateLaw):
    """A law with a plateau of the viscosity at low and one at high rates, below that of the contact."""

    relaxation_time: Input = RELAXATION_TIME
    exponent: Input = EXPONENT
    infinite_viscosity: Input = INFINITE_VISCOSITY

    @property
    def time(self) -> float:
        """The relaxation time."""
        return self.relaxation_time

    def scaled(self, units: FilmUnits) -> Self:
        """Return the law in Hertz units."""
        return type(self)(self.relaxation_time / units.time, self.exponent, _ratio(self.infinite_viscosity, units))

    @property
    def shape(self) -> tuple[float, ...]:
        """Its numbers but for the time."""
        return self.exponent, self.infinite_viscosity


@law
class Carreau(_BetweenPlateaus):
    r"""The fluid that thins from one plateau of its viscosity to another.

    .. math:: \eta = \eta_\infty + (\eta_0 - \eta_\infty) \, [1 + (t \dot\gamma)^2]^{(n-1)/2}

    Notes
    -----
    If the viscosity grows with the pressure, so do both plateaus and the time t: the stress at which thinning begins is held.

    Source: [Carreau 1972].
    """

    name: ClassVar[str] = "carreau"
    label: ClassVar[str] = "Carreau"

    def stress(self, rate: Any) -> Any:
        """Return g(x)."""
        n, rest = self.exponent, self.infinite_viscosity
        return rate * (rest + (1 - rest) * np.exp(0.5 * (n - 1) * np.log1p(rate * rate)))

    def smallest(self) -> float:
        """Return the logarithm of the rate below which the law is Newtonian to rounding."""
        return -21.0


@law
class Cross(_BetweenPlateaus):
    r"""The fluid that thins from one plateau of its viscosity to another, more gradually than Carreau's.

    .. math:: \eta = \eta_\infty + \frac{\eta_0 - \eta_\infty}{1 + (t \dot\gamma)^m}

    Notes
    -----
    If the viscosity grows with the pressure, so do both plateaus and the time t: the stress at which thinning begins is held.

    Source: [Cross 1965].
    """

    name: ClassVar[str] = "cross"
    label: ClassVar[str] = "Cross"
    plateau = 0.0

    exponent: Input = replace(
        EXPONENT,
        lowest=0.1,
        highest=1 - MIN_EXPONENT,
        reason="the viscosity of a Cross fluid falls as the rate to the power -exponent, which of a Carreau fluid is 1 - n",
    )

    def stress(self, rate: Any) -> Any:
        """Return g(x)."""
        rest = self.infinite_viscosity
        return rate * (rest + (1 - rest) / (1 + rate**self.exponent))

    def smallest(self) -> float:
        """Return the logarithm of the rate below which the law is Newtonian to rounding."""
        return -38.0 / self.exponent


@law
class PowerLaw(RateLaw):
    r"""The fluid whose viscosity falls as a power of the rate, above a rate far below those of films.

    .. math:: \eta = \eta_0 \, [10^{-16} + (t \dot\gamma)^2]^{(n-1)/2} \approx \eta_0 (t \dot\gamma)^{n-1}

    Of cylinders only.  The viscosity of the contact is that at the rate 1/t.  With the consistency
    :math:`K = \eta_0 t^{n-1}`, that is :math:`\tau = K \dot\gamma^n`.

    Notes
    -----
    Below the rate :math:`10^{-8}/t` the viscosity is constant, which films do not feel where :math:`U/h` is above
    :math:`10^{-4}/t`; a note says where it is not.  A pure power law is infinitely viscous where nothing flows: its drag falls
    off so slowly along the gap that it has no bound for :math:`n \le 1/2`.  Much of the drag comes from far outside the
    contact, where no cylinder is a parabola, for n below 0.75 so much that a note says so; films and load shares do not.  If
    the viscosity grows with the pressure, the rate at a given stress falls by its factor, as with the other laws.
    """

    name: ClassVar[str] = "power-law"
    label: ClassVar[str] = "power law"

    relaxation_time: Input = RELAXATION_TIME
    exponent: Input = EXPONENT

    @property
    def time(self) -> float:
        """The relaxation time."""
        return self.relaxation_time

    def scaled(self, units: FilmUnits) -> Self:
        """Return the law in Hertz units."""
        return type(self)(self.relaxation_time / units.time, self.exponent)

    @property
    def plateau(self) -> float:
        """Rate below which the viscosity is constant."""
        return PLATEAU_RATE

    def notes(self, gap: Array, pressure: Array | None) -> tuple[str, ...]:
        """Return whether the drag is that of places where no surface is a parabola."""
        if self.exponent >= FAR_DRAG_EXPONENT:
            return ()
        return (
            f"much of the drag of a power law with exponent {self.exponent:g} comes from far outside the contact, up to where "
            "its viscosity is constant; take films and load shares, or give Carreau's law for the friction",
        )

    def stress(self, rate: Any) -> Any:
        """Return g(x)."""
        return rate * (rate * rate + PLATEAU_RATE**2) ** (0.5 * (self.exponent - 1))

    @property
    def shape(self) -> tuple[float, ...]:
        """Its numbers but for the time."""
        return (self.exponent,)

    def smallest(self) -> float:
        """Return the logarithm of the rate below which the law is Newtonian to rounding."""
        return -40.0


def _ratio(viscosity: float, units: FilmUnits) -> float:
    """Return the viscosity at high rates over that at low ones."""
    if viscosity >= units.viscosity:
        raise InputError(
            f"infinite_viscosity = {viscosity:g} Pa s must be below the viscosity of the contact, {units.viscosity:g} Pa s, "
            "which is that at low rates."
        )
    return viscosity / units.viscosity
