r"""Viscosity and density of a fluid as functions of the pressure.

.. math::

    \ln\frac{\eta}{\eta_0} = \alpha_p p \quad \text{(Barus)}, \qquad
    \ln\frac{\eta}{\eta_0} = S \left[\left(1 + \frac{p}{p_r}\right)^z - 1\right], \quad
    S = \ln\frac{\eta_0}{\eta_r}, \quad z = \frac{\alpha_p p_r}{S} \quad \text{(Roelands)}, \qquad
    \frac{\rho}{\rho_0} = \frac{c + k p}{c + p} \quad \text{(Dowson and Higginson)}
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from stribeck._types import Array
from stribeck.fluids.laws import DensityLaw, FilmUnits, ViscosityLaw
from stribeck.quantities.units import InputError, show, to_si

__all__ = ["MAX_PRESSURE_EXPONENT", "Barus", "Constant", "DowsonHigginson", "Incompressible", "Roelands", "check_range"]

MAX_PRESSURE_EXPONENT = 5.0  # Pressure coefficient times Hertz pressure above which the pressure has the spike of hard EHL.

REFERENCE_PRESSURE = 1.96e8  # p_r of Roelands' law [Pa].

REFERENCE_VISCOSITY = 6.31e-5  # eta_r of Roelands' law [Pa s]: ln(eta_r) = -9.67.


MAX_SUCTION_RATIO = 0.1  # Suction over the pressure of the density law that draws a note; no liquid is stretched so far.


@dataclass(frozen=True)
class Constant(ViscosityLaw):
    """The viscosity that does not depend on the pressure."""

    def scaled(self, units: FilmUnits) -> Self:
        """Return itself: it has no numbers."""
        return self

    def milder(self, part: float) -> Self:
        """Return itself: it does nothing."""
        return self

    def log(self, pressure: Array) -> tuple[Array, Array]:
        """Return zero twice."""
        return np.zeros_like(pressure), np.zeros_like(pressure)


@dataclass(frozen=True, init=False)
class Barus(ViscosityLaw):
    r"""The viscosity that grows exponentially with the pressure, :math:`\eta = \eta_0 e^{\alpha_p p}`.

    Parameters
    ----------
    pressure_coefficient : str or float
        :math:`\alpha_p \ge 0` [1/Pa], with groups [1/p_Hz]; mineral oils have 10 to 30 1/GPa, water about 0.

    Raises
    ------
    InputError
        Where the value is impossible or its unit is wrong.  A film refuses :math:`\alpha_p p_\mathrm{Hz}` above 5: there the
        pressure has the spike of hard elastohydrodynamics, which needs a solver that follows it.

    Notes
    -----
    Source: [Barus 1893].  Above about 0.1 GPa :class:`Roelands` is nearer to measurements.
    """

    pressure_coefficient: float

    def __init__(self, pressure_coefficient: str | float) -> None:
        object.__setattr__(self, "pressure_coefficient", _coefficient(pressure_coefficient))

    @property
    def name(self) -> str:
        """Name that outputs print."""
        return "barus"

    @property
    def parameters(self) -> dict[str, float | str]:
        """The coefficient."""
        return {"pressure_coefficient": self.pressure_coefficient}

    def scaled(self, units: FilmUnits) -> Self:
        """Return the law in Hertz units."""
        return type(self)(self.pressure_coefficient * units.pressure)

    def milder(self, part: float) -> Self:
        """Return the law with a part of the coefficient."""
        return type(self)(part * self.pressure_coefficient)

    def log(self, pressure: Array) -> tuple[Array, Array]:
        """Return ``a p`` and a."""
        return self.pressure_coefficient * pressure, np.full_like(pressure, self.pressure_coefficient)


@dataclass(frozen=True, init=False)
class Roelands(ViscosityLaw):
    r"""The viscosity that grows with a power of the pressure in its logarithm.

    .. math:: \ln\frac{\eta}{\eta_0} = S \left[\left(1 + \frac{p}{p_r}\right)^z - 1\right], \quad
        S = \ln\frac{\eta_0}{\eta_r}, \quad z = \frac{\alpha_p p_r}{S}

    Parameters
    ----------
    pressure_coefficient : str or float
        :math:`\alpha_p \ge 0`, the slope of :math:`\ln \eta` at ambient pressure [1/Pa], with groups [1/p_Hz].
    reference_pressure : str or float
        :math:`p_r > 0` [Pa], with groups [p_Hz].
    reference_viscosity : str or float
        :math:`\eta_r > 0` [Pa s], below the viscosity of the fluid; with groups over that viscosity.

    Raises
    ------
    InputError
        Where a value is impossible or its unit is wrong.  A film refuses :math:`\alpha_p p_\mathrm{Hz}` above 5, see
        :class:`Barus`.

    Notes
    -----
    Source: [Roelands 1966]; a fit to oils up to about 0.5 GPa.
    """

    pressure_coefficient: float
    reference_pressure: float
    reference_viscosity: float

    def __init__(
        self,
        pressure_coefficient: str | float,
        reference_pressure: str | float = REFERENCE_PRESSURE,
        reference_viscosity: str | float = REFERENCE_VISCOSITY,
    ) -> None:
        object.__setattr__(self, "pressure_coefficient", _coefficient(pressure_coefficient))
        for name, value, dimension, example in (
            ("reference_pressure", reference_pressure, "pressure", "196 MPa"),
            ("reference_viscosity", reference_viscosity, "viscosity", "63.1 uPa*s"),
        ):
            number = to_si(value, dimension, name, example)
            if number <= 0:
                raise InputError(f"{name} = {show(value)} must be above zero; Roelands' fit has {example}.")
            object.__setattr__(self, name, number)

    @property
    def name(self) -> str:
        """Name that outputs print."""
        return "roelands"

    @property
    def parameters(self) -> dict[str, float | str]:
        """All three."""
        return {
            "pressure_coefficient": self.pressure_coefficient,
            "reference_pressure": self.reference_pressure,
            "reference_viscosity": self.reference_viscosity,
        }

    def scaled(self, units: FilmUnits) -> Self:
        """Return the law in Hertz units."""
        ratio = self.reference_viscosity / units.viscosity
        if ratio >= 1:
            raise InputError(
                f"reference_viscosity = {self.reference_viscosity:g} Pa s is not below the viscosity of the fluid, "
                f"{units.viscosity:g} Pa s; Roelands' law needs it smaller. Take Barus for a fluid so thin."
            )
        return type(self)(self.pressure_coefficient * units.pressure, self.reference_pressure / units.pressure, ratio)

    def milder(self, part: float) -> Self:
        """Return the law with a part of the coefficient."""
        return type(self)(part * self.pressure_coefficient, self.reference_pressure, self.reference_viscosity)

    def log(self, pressure: Array) -> tuple[Array, Array]:
        """Return ``S [(1 + p/p_r)**z - 1]`` and its slope; below ``-p_r/2`` the tangent there."""
        p_r, S = self.reference_pressure, -math.log(self.reference_viscosity)
        z = self.pressure_coefficient * p_r / S
        lifted = np.maximum(pressure, -0.5 * p_r)
        base = np.log1p(lifted / p_r)
        slope = self.pressure_coefficient * np.exp((z - 1) * base)
        return S * np.expm1(z * base) + slope * (pressure - lifted), slope

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

    def milder(self, part: float) -> Self:
        """Return itself: it does nothing."""
        return self

    def ratio(self, pressure: Array) -> tuple[Array, Array]:
        """Return one and zero."""
        return np.ones_like(pressure), np.zeros_like(pressure)


@dataclass(frozen=True, init=False)
class DowsonHigginson(DensityLaw):
    r"""The density of a mineral oil, which a high pressure raises by a third at most.

    .. math:: \frac{\rho}{\rho_0} = \frac{c + k p}{c + p}

    Parameters
    ----------
    pressure : str or float
        :math:`c > 0` [Pa], with groups [p_Hz].
    limit : float
        :math:`k > 1`, the density ratio that no pressure exceeds [-].

    Raises
    ------
    InputError
        Where a value is impossible or a unit is wrong.

    Notes
    -----
    A fit to mineral oils up to about 0.4 GPa.  Under suction it falls to zero at :math:`p = -c/k` and has a pole at -c; from
    :math:`-c/10` on the volume :math:`\rho_0/\rho` goes on as its parabola there, and a note is written.

    Source: [Dowson & Higginson 1966].
    """

    pressure: float
    limit: float

    def __init__(self, pressure: str | float = 0.59e9, limit: float = 1.34) -> None:
        c, k = to_si(pressure, "pressure", "pressure", "0.59 GPa"), to_si(limit, "number", "limit", "1.34")
        if c <= 0:
            raise InputError(f"pressure = {show(pressure)} must be above zero; mineral oils have 0.59 GPa.")
        if k <= 1:
            raise InputError(f"limit = {show(limit)} must be above 1; mineral oils have 1.34.")
        object.__setattr__(self, "pressure", c)
        object.__setattr__(self, "limit", k)

    @property
    def name(self) -> str:
        """Name that outputs print."""
        return "dowson-higginson"

    @property
    def parameters(self) -> dict[str, float | str]:
        """Both."""
        return {"density_pressure": self.pressure, "density_limit": self.limit}

    def scaled(self, units: FilmUnits) -> Self:
        """Return the law in Hertz units."""
        return type(self)(self.pressure / units.pressure, self.limit)

    def milder(self, part: float) -> Self:
        """Return the law with a part of the growth."""
        return type(self)(self.pressure, 1 + max(part, 1e-9) * (self.limit - 1))

    def ratio(self, pressure: Array) -> tuple[Array, Array]:
        """Return rho/rho0 and its slope."""
        c, k = self.pressure, self.limit
        held = np.maximum(pressure, -MAX_SUCTION_RATIO * c)
        beyond, above = held - pressure, c + k * held
        falls = (k - 1) * c / above**2
        bends = 2 * k * falls / above
        volume = (c + held) / above + (falls + 0.5 * bends * beyond) * beyond
        return 1 / volume, (falls + bends * beyond) / volume**2

    def notes(self, gap: Array, pressure: Array | None) -> tuple[str, ...]:
        """Return whether suction stretches the fluid farther than the law can mean."""
        if pressure is None or float(pressure.min(initial=0.0)) > -MAX_SUCTION_RATIO * self.pressure:
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


def _coefficient(value: str | float) -> float:
    coefficient = to_si(value, "pressure coefficient", "pressure_coefficient")
    if coefficient < 0:
        raise InputError(f"pressure_coefficient = {show(value)} must be zero or positive, such as '15 1/GPa'.")
    return coefficient
