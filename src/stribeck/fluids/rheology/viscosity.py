r"""Viscosity and density of a fluid as functions of the pressure.

.. math::

    \ln\frac{\eta}{\eta_0} = \alpha_p p \quad \text{(Barus)}, \qquad
    \ln\frac{\eta}{\eta_0} = S \left[\left(1 + \frac{p}{p_r}\right)^z - 1\right], \quad
    S = \ln\frac{\eta_0}{\eta_r}, \quad z = \frac{\alpha_p p_r}{S} \quad \text{(Roelands)}, \qquad
    \frac{\rho}{\rho_0} = \frac{c + k p}{c + p} \quad \text{(Dowson and Higginson)}
"""

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from stribeck._types import Array
from stribeck.fluids.laws import DensityLaw, FilmUnits, ViscosityLaw
from stribeck.quantities.schema import Input, law
from stribeck.quantities.units import InputError

MAX_PRESSURE_EXPONENT = 5.0  # Pressure coefficient times Hertz pressure above which the pressure has the spike of hard EHL.

REFERENCE_PRESSURE = 1.96e8  # p_r of Roelands' law [Pa].

REFERENCE_VISCOSITY = 6.31e-5  # eta_r of Roelands' law [Pa s]: ln(eta_r) = -9.67.


PRESSURE_COEFFICIENT = Input(
    label="pressure coefficient of the viscosity",
    symbol=r"$\alpha_p$",
    dimension="pressure coefficient",
    typical="15 1/GPa",
    source="mineral oils, 10 to 30 1/GPa",
    letters=("pressure_viscosity", "alpha_p"),
    zero=True,
)

MAX_SUCTION_RATIO = 0.1  # Suction over the pressure of the density law that draws a note; no liquid is stretched so far.


@dataclass(frozen=True)
class Constant(ViscosityLaw):
    """The viscosity that does not depend on the pressure."""

    def scaled(self, units: FilmUnits) -> Self:
        """Return itself: it has no numbers."""
        return self

    def log(self, pressure: Any) -> Any:
        """Return zero."""
        return np.zeros_like(pressure)


@law
class Barus(ViscosityLaw):
    r"""The viscosity that grows exponentially with the pressure, :math:`\eta = \eta_0 e^{\alpha_p p}`.

    Notes
    -----
    A film refuses :math:`\alpha_p p_\mathrm{Hz}` above 5: there the pressure has the spike of hard elastohydrodynamics, which
    needs a solver that follows it.

    Source: [Barus 1893].  Above about 0.1 GPa :class:`Roelands` is nearer to measurements.
    """

    name: ClassVar[str] = "barus"
    label: ClassVar[str] = "Barus"

    pressure_coefficient: Input = PRESSURE_COEFFICIENT

    def scaled(self, units: FilmUnits) -> Self:
        """Return the law in Hertz units."""
        return type(self)(self.pressure_coefficient * units.pressure)

    def log(self, pressure: Any) -> Any:
        """Return ``a p``."""
        return self.pressure_coefficient * pressure


@law
class Roelands(ViscosityLaw):
    r"""The viscosity that grows with a power of the pressure in its logarithm.

    .. math:: \ln\frac{\eta}{\eta_0} = S \left[\left(1 + \frac{p}{p_r}\right)^z - 1\right], \quad
        S = \ln\frac{\eta_0}{\eta_r}, \quad z = \frac{\alpha_p p_r}{S}

    Notes
    -----
    :math:`\eta_r` is below the viscosity of the fluid.  A film refuses :math:`\alpha_p p_\mathrm{Hz}` above 5, see
    :class:`Barus`.

    Source: [Roelands 1966]; a fit to oils up to about 0.5 GPa.
    """

    name: ClassVar[str] = "roelands"
    label: ClassVar[str] = "Roelands"

    pressure_coefficient: Input = PRESSURE_COEFFICIENT
    reference_pressure: Input = Input(
        label="reference pressure",
        symbol="$p_r$",
        dimension="pressure",
        typical="196 MPa",
        source="Roelands' fit to mineral oils",
        default=REFERENCE_PRESSURE,
        is_free=False,
    )
    reference_viscosity: Input = Input(
        label="reference viscosity",
        symbol=r"$\eta_r$",
        dimension="viscosity",
        typical="63.1 uPa*s",
        source="Roelands' fit to mineral oils",
        default=REFERENCE_VISCOSITY,
        is_free=False,
    )

    def scaled(self, units: FilmUnits) -> Self:
        """Return the law in Hertz units."""
        ratio = self.reference_viscosity / units.viscosity
        if ratio >= 1:
            raise InputError(
                f"reference_viscosity = {self.reference_viscosity:g} Pa s is not below the viscosity of the fluid, "
                f"{units.viscosity:g} Pa s; Roelands' law needs it smaller. Take Barus for a fluid so thin."
            )
        return type(self)(self.pressure_coefficient * units.pressure, self.reference_pressure / units.pressure, ratio)

    def log(self, pressure: Any) -> Any:
        """Return ``S [(1 + p/p_r)**z - 1]``; below ``-p_r/2`` the tangent there."""
        p_r, S = self.reference_pressure, -math.log(self.reference_viscosity)
        z = self.pressure_coefficient * p_r / S
        lifted = np.maximum(pressure, -0.5 * p_r)
        slope_there = self.pressure_coefficient * 0.5 ** (z - 1)
        return S * np.expm1(z * np.log1p(lifted / p_r)) + slope_there * (pressure - lifted)

    def notes(self, gap: Array, pressure: Array | None) -> tuple[str, ...]:
        """Return whether suction leaves the range of the law."""
        if pressure is None or float(pressure.min(initial=0.0)) > -0.5 * self.reference_pressure:
            return ()
        return ("the suction exceeds half the reference pressure of Roelands' law, which holds for pressures",)


@dataclass(frozen=True)
class Incompressible(DensityLaw):
    """The density that does not depend on the pressure."""

    def scaled(self, units: FilmUnits) -> Self:
        """Return itself: it has no numbers."""
        return self

    def ratio(self, pressure: Any) -> Any:
        """Return one."""
        return np.ones_like(pressure)


@law
class DowsonHigginson(DensityLaw):
    r"""The density of a mineral oil, which a high pressure raises by a third at most.

    .. math:: \frac{\rho}{\rho_0} = \frac{c + k p}{c + p}

    Notes
    -----
    A fit to mineral oils up to about 0.4 GPa.  Under suction it falls to zero at :math:`p = -c/k` and has a pole at -c; from
    :math:`-c/10` on the volume :math:`\rho_0/\rho` goes on as its parabola there, and a note is written.

    Source: [Dowson & Higginson 1966].
    """

    name: ClassVar[str] = "dowson-higginson"
    label: ClassVar[str] = "Dowson, Higginson"

    density_pressure: Input = Input(
        label="pressure in the density",
        symbol="$c$",
        dimension="pressure",
        typical="0.59 GPa",
        source="mineral oils",
        default=0.59e9,
        is_free=False,
    )
    density_limit: Input = Input(
        label="largest density ratio",
        symbol="$k$",
        dimension="number",
        typical="1.34",
        source="mineral oils",
        lowest=1.0,
        default=1.34,
        is_free=False,
    )

    def scaled(self, units: FilmUnits) -> Self:
        """Return the law in Hertz units."""
        return type(self)(self.density_pressure / units.pressure, self.density_limit)

    def ratio(self, pressure: Any) -> Any:
        """Return rho/rho0."""
        c, k = self.density_pressure, self.density_limit
        held = np.maximum(pressure, -MAX_SUCTION_RATIO * c)
        beyond, above = held - pressure, c * (1 - k * MAX_SUCTION_RATIO)
        falls = (k - 1) * c / above**2  # with the curvature 2 k falls/above, where the parabola begins
        return 1 / ((c + held) / (c + k * held) + falls * (1 + k / above * beyond) * beyond)

    def notes(self, gap: Array, pressure: Array | None) -> tuple[str, ...]:
        """Return whether suction stretches the fluid farther than the law can mean."""
        if pressure is None or float(pressure.min(initial=0.0)) > -MAX_SUCTION_RATIO * self.density_pressure:
            return ()
        return (
            f"the suction exceeds {MAX_SUCTION_RATIO:g} of the pressure in the Dowson-Higginson density: no liquid is "
            "stretched so far",
        )


def check_range(law: ViscosityLaw) -> None:
    """Refuse a law in Hertz units whose coefficient is that of hard elastohydrodynamics."""
    a = law.parameters.get("pressure_coefficient", 0.0)
    if isinstance(a, float) and a > MAX_PRESSURE_EXPONENT:
        raise InputError(
            f"pressure_coefficient times the Hertz pressure is {a:.3g}; it must lie between 0 and {MAX_PRESSURE_EXPONENT:g}. "
            "Beyond, the contact is one of hard elastohydrodynamics, which needs a solver that follows the pressure spike; "
            "for film thickness there are the formulas of Hamrock and Dowson, or of Moes for lines."
        )
