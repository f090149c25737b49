r"""Reynolds' equation on the line: the pressure gradient of a film that carries the flux of the gap h*.

.. math:: \frac{dp_f}{dx} = \lambda \, \frac{h - h^*}{h^3}, \qquad p_f(\pm\infty) = 0

The gradient is kept divided by ``h**3``: multiplied out, Newton's iteration diverges.  All functions leave the factor
lambda out, so that the condition on the flux stays well posed at speed zero.

Source: [BP] Eq. (thin-film_dl); isoviscous fluid, no cavitation, no flow factors.
"""

from __future__ import annotations

import numpy as np

from stribeck._types import Array, Numbers


def gradient(gap: Array, flux_gap: Numbers) -> Array:
    """Return ``(h - h*)/h**3``: the pressure gradient over lambda [u_Hz**-2]."""
    return np.asarray((gap - flux_gap) / gap**3)


def gap_derivative(gap: Array, flux_gap: Numbers) -> Array:
    """Return the derivative of :func:`gradient` with respect to the gap, ``(3 h* - 2 h)/h**4``."""
    return np.asarray((3.0 * flux_gap - 2.0 * gap) / (gap * gap) ** 2)


def flux_derivative(gap: Array) -> Array:
    """Return the derivative of :func:`gradient` with respect to h*, ``-1/h**3``."""
    return -1.0 / gap**3


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
        The gap h* where the pressure gradient vanishes [u_Hz]; follows from p_f(+-inf) = 0.
    """
    least = gap.min()
    scaled = least / gap
    return float(least * (weights @ scaled**2) / (weights @ scaled**3))
