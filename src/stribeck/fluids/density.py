r"""Density of a fluid as a function of the pressure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from stribeck._types import Array
from stribeck.fluids.laws import DensityLaw, FilmUnits
from stribeck.quantities.units import InputError, show, to_si

__all__ = ["DowsonHigginson", "Incompressible"]

TENSION = 0.1
"""Suction over the pressure of the law from which a note is written: no liquid is stretched so far."""


@dataclass(frozen=True)
class Incompressible(DensityLaw):
    """The density that does not depend on the pressure."""

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
    Source: [Dowson & Higginson 1966], a fit to mineral oils up to about 0.4 GPa.
    """

    pressure: float
    limit: float

    def __init__(self, pressure: str | float = 0.59e9, limit: float = 1.34) -> None:
        c, k = to_si(pressure, "pressure", "pressure"), to_si(limit, "number", "limit")
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
        below = c + pressure
        return (c + k * pressure) / below, (k - 1) * c / below**2

    def notes(self, gap: Array, pressure: Array | None) -> tuple[str, ...]:
        """Return whether suction stretches the fluid farther than the law can mean."""
        if pressure is None or float(pressure.min(initial=0.0)) > -TENSION * self.pressure:
            return ()
        return (
            f"the suction exceeds {TENSION:g} of the pressure in the Dowson-Higginson density: no liquid is stretched so far",
        )
