r"""Reynolds' equation on the line: the pressure gradient of a film that carries the flux of the gap h*.

.. math:: \frac{dp_f}{dx} = \lambda \, \frac{h - h^*}{h^3}, \qquad p_f(\pm\infty) = 0

The gradient is kept divided by ``h**3``: multiplied out, Newton's iteration diverges.  All functions leave the factor
lambda out, so that the condition on the flux stays well posed at speed zero.

Source: [BP] Eq. (thin-film_dl); isoviscous fluid, no flow factors.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stribeck._types import Array, Numbers
from stribeck.fluids.fluid import Slopes


def gradient(gap: Array, flux_gap: Numbers) -> Array:
    """Return ``(h - h*)/h**3``: the pressure gradient over lambda [u_Hz**-2]."""
    return np.asarray((gap - flux_gap) / gap**3)


def gap_derivative(gap: Array, flux_gap: Numbers) -> Array:
    """Return the derivative of :func:`gradient` with respect to the gap, ``(3 h* - 2 h)/h**4``."""
    return np.asarray((3.0 * flux_gap - 2.0 * gap) / (gap * gap) ** 2)


def flux_derivative(gap: Array) -> Array:
    """Return the derivative of :func:`gradient` with respect to h*, ``-1/h**3``."""
    return -1.0 / gap**3


@dataclass(frozen=True)
class Newtonian:
    """The fluid of constant viscosity and density."""

    name: str = "newtonian"
    uses_pressure: bool = False

    @property
    def parameters(self) -> dict[str, float | str]:
        """None."""
        return {}

    def gradient(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Array:
        """Return :func:`gradient`."""
        return gradient(gap, flux_gap)

    def slopes(self, gap: Array, pressure: Array | None, flux_gap: Numbers) -> Slopes:
        """Return :func:`gap_derivative` and :func:`flux_derivative`."""
        return Slopes(gap_derivative(gap, flux_gap), None, flux_derivative(gap))


def flux_gap(gap: Array, weights: Array) -> float:
    r"""Return the flux gap of a given film.

    .. math:: h^* = \frac{\int h^{-2} dx}{\int h^{-3} dx}

    Parameters
    ----------
    gap : ndarray, shape (n,)
        Positive gap at the nodes of a mesh [u_Hz].
    weights : ndarray, shape (n,)
        Weights of the integral over the whole line.

    Returns
    -------
    float
        The gap h* at which the pressure gradient vanishes [u_Hz]; follows from p_f(+-inf) = 0.
    """
    minimum = gap.min()
    scaled = minimum / gap
    return float(minimum * (weights @ scaled**2) / (weights @ scaled**3))
