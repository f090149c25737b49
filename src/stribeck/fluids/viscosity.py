r"""Fluids whose viscosity grows with the pressure.

.. math:: \eta = \eta_0 e^{\alpha_p p}, \qquad G = e^{a p_f} \, \frac{h - h^*}{h^3}, \quad a = \alpha_p p_\mathrm{Hz}

Source: [Barus 1893]; theory of the film as for the Newtonian fluid.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.fluids import newtonian
from stribeck.fluids.fluid import Slopes
from stribeck.quantities.units import InputError, show

__all__ = ["Barus"]

LARGEST_COEFFICIENT = 5.0
"""Pressure coefficient times Hertz pressure beyond which the pressure has the spike of hard elastohydrodynamics."""


@dataclass(frozen=True)
class Barus:
    """The fluid whose viscosity grows exponentially with the pressure.

    Parameters
    ----------
    pressure_coefficient : float
        Pressure coefficient of the viscosity times the Hertz pressure, a [-]; zero is the Newtonian fluid.

    Raises
    ------
    InputError
        If the coefficient is negative, or above 5: there the pressure has a spike that needs a solver of hard
        elastohydrodynamics.
    """

    pressure_coefficient: float
    name: str = "barus"
    uses_pressure: bool = True

    def __post_init__(self) -> None:
        """Refuse a coefficient outside its range."""
        a = self.pressure_coefficient
        if isinstance(a, bool) or not isinstance(a, int | float) or not 0 <= a <= LARGEST_COEFFICIENT:
            raise InputError(
                f"pressure_coefficient = {show(a)}; times the Hertz pressure it must lie between 0 and "
                f"{LARGEST_COEFFICIENT:g}. Beyond, the contact is one of hard elastohydrodynamics, which needs a solver that "
                "follows the pressure spike."
            )

    @property
    def parameters(self) -> dict[str, float | str]:
        """The coefficient."""
        return {"pressure_coefficient": self.pressure_coefficient}

    def gradient(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Array:
        """Return ``exp(a p) (h - h*)/h**3``."""
        assert pressure is not None
        return np.asarray(np.exp(self.pressure_coefficient * pressure) * newtonian.gradient(gap, flux_gap))

    def slopes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Slopes:
        """Return the derivatives of G, that with respect to the pressure being ``a G``."""
        assert pressure is not None
        viscosity = np.exp(self.pressure_coefficient * pressure)
        return Slopes(
            viscosity * newtonian.gap_derivative(gap, flux_gap),
            self.pressure_coefficient * viscosity * newtonian.gradient(gap, flux_gap),
            viscosity * newtonian.flux_derivative(gap),
        )
