r"""Eyring's fluid, whose stress grows as the logarithm of the rate.

.. math:: \tau t/\eta_0 = \operatorname{arsinh}(t \dot\gamma), \quad t = \eta_0/\tau_0

Source: [Eyring 1936].
"""

from typing import Any, ClassVar, Self

import numpy as np

from stribeck.fluids.laws import FilmUnits, RateLaw
from stribeck.quantities.schema import Input, law


@law
class Eyring(RateLaw):
    r"""The fluid whose stress grows as the logarithm of the rate, as that of oils does at high pressure.

    .. math:: \dot\gamma = \frac{\tau_0}{\eta} \sinh\frac{\tau}{\tau_0}

    Notes
    -----
    If the viscosity grows with the pressure, the stress :math:`\tau_0` is held.

    Source: [Eyring 1936].
    """

    name: ClassVar[str] = "eyring"
    label: ClassVar[str] = "Eyring"
    max_log_rate: ClassVar[float] = 300.0  # No power of the rate: its table ends where no film has one

    eyring_stress: Input = Input(
        label="Eyring's stress",
        symbol=r"$\tau_0$",
        dimension="pressure",
        typical="5 MPa",
        source="oils",
        letters=("stress",),
    )

    @property
    def time(self) -> float:
        """Viscosity over stress, in Hertz units."""
        return 1.0 / self.eyring_stress

    def scaled(self, units: FilmUnits) -> Self:
        """Return the law in Hertz units."""
        return type(self)(self.eyring_stress / units.stress)

    @property
    def shape(self) -> tuple[float, ...]:
        """None."""
        return ()

    def stress(self, rate: Any) -> Any:
        """Return arsinh(x)."""
        return np.arcsinh(rate)

    def smallest(self) -> float:
        """Return the logarithm of the rate below which the law is Newtonian to rounding."""
        return -21.0
