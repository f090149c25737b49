r"""Eyring's fluid: its flow across a film follows from one equation at each node.

.. math:: \tau t/\eta_0 = \operatorname{arsinh}(t \dot\gamma), \quad t = \eta_0/\tau_0

Source: [Eyring 1936].
"""

from __future__ import annotations

import math
from typing import Any, ClassVar, Self

import numpy as np

from stribeck._types import Array
from stribeck.fluids.laws import FilmUnits, Profile, RateLaw
from stribeck.quantities.schema import Input, law

__all__ = ["Eyring"]

MIN_HALF_DIFFERENCE = 1e-150  # Least half difference of the wall stresses over Eyring's stress: its square is above zero.
MAX_HALF_DIFFERENCE = 300.0  # Largest half difference of the wall stresses over Eyring's stress: the rates stay finite.

MAX_LOG_STEP = math.log(4.0)  # Largest change of the logarithm of that half difference in one step.

STEP_RTOL = 1e-7  # Step of that logarithm that ends the iteration: the next one, its square, is below rounding.

MAX_STEPS = 80  # Newton steps of a column before its flow counts as not found.

# Eyring's second moment over the third power of the stress in powers of its square, to 1e-17 up to Eyring's stress.
SECOND_MOMENT_SERIES = [2 * k / math.factorial(2 * k + 1) for k in range(9, 0, -1)]


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

    def stress(self, rate: Any) -> Any:
        """Return arsinh(x)."""
        return np.arcsinh(rate)

    def rate(self, stress: Array) -> Array:
        """Return the rate at a stress."""
        return np.sinh(np.minimum(stress, 700.0))

    def moments(self, rate: Array, stress: Array) -> tuple[Array, Array]:
        """Return ``cosh(g) - 1`` and ``g cosh(g) - sinh(g)``, without loss of digits at small g."""
        g, cosh = stress, np.hypot(1.0, rate)
        square = np.minimum(g, 1.0) ** 2
        return rate * (rate / (1 + cosh)), np.where(g < 1, g * square * _series(square), g * cosh - rate)

    def across(self, r_0: Array, r_1: Array, start: tuple[Array, Array] | None) -> Profile:
        r"""Return the flow across a film, from one equation at each node.

        With the stress :math:`T + Q \zeta` and :math:`S(Q) = \sinh(Q/2)/(Q/2)` the integrals are
        :math:`r_0 = S \sinh T` and :math:`r_1 = S' \cosh T`, so that

        .. math:: \ln|S'| + \tfrac12 \ln(1 + r_0^2/S^2) = \ln|r_1| .

        The left side rises with Q.
        """
        size = np.maximum(np.abs(r_1), MIN_HALF_DIFFERENCE * (1 + np.abs(r_0)))
        wanted, square = np.log(2 * size), r_0 * r_0
        q = np.arcsinh(6 * size) if start is None else 0.5 * np.abs(np.arcsinh(start[1]) - np.arcsinh(start[0]))
        q = np.clip(q, np.minimum(3 * size / (1 + np.abs(r_0)), 1.0), MAX_HALF_DIFFERENCE)
        for _ in range(MAX_STEPS):
            S, S_q = of_half(q)
            slip = square / (S * S)
            missing = wanted - np.log(S_q) - 0.5 * np.log1p(slip)
            change = missing / (q * ((S - 2 * S_q / q) / S_q - slip / (1 + slip) * S_q / S))
            q = np.minimum(q * np.exp(np.clip(change, -MAX_LOG_STEP, MAX_LOG_STEP)), MAX_HALF_DIFFERENCE)
            if not np.abs(change).max() > STEP_RTOL:
                break
        else:
            q = np.where(np.abs(change) > STEP_RTOL, np.nan, q)
        S, S_q = of_half(q)
        sinh_T = r_0 / S
        T, cosh_T, curvature = np.arcsinh(sinh_T), np.hypot(1.0, sinh_T), 0.25 * (S - 2 * S_q / q)
        q, S_q = np.copysign(q, r_1), np.copysign(S_q, r_1)
        g_a, g_b = T - q, T + q
        x_a, x_b = np.sinh(g_a), np.sinh(g_b)
        slopes = 1 / np.hypot(1.0, x_a), 1 / np.hypot(1.0, x_b)
        return Profile(x_a, x_b, g_a, g_b, *slopes, cosh_T * S, 0.5 * sinh_T * S_q, cosh_T * curvature)


def of_half(q: Array) -> tuple[Array, Array]:
    r"""Return :math:`S = \sinh(q)/q` and its slope, for q > 0."""
    e = np.exp(q)
    cosh, square = 0.5 * (e + 1 / e), q * q
    third = np.where(q < 1, _series(np.minimum(square, 1.0)), (cosh - 0.5 * (e - 1 / e) / q) / square)
    return cosh - square * third, q * third


def _series(square: Array) -> Array:
    """Return (q cosh q - sinh q)/q**3 for q**2 up to one."""
    found = np.full_like(square, SECOND_MOMENT_SERIES[0])
    for term in SECOND_MOMENT_SERIES[1:]:
        found *= square
        found += term
    return found
