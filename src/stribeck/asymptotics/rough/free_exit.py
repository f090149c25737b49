r"""Boundary lubrication with a film that ends at ambient pressure: the share of the fluid is of first order in the speed.

Asperities carry the load, so that the gap is :math:`h = \kappa H(x)` with :math:`H = -\frac12 \ln \bar F_N - \frac12 \ln(1 -
x^2)`.  At the first order in :math:`n = \lambda/\kappa^2` the film upstream of its exit is that of this gap,

.. math::

    p_f = n \int_{-1}^{x} \frac{H - H^*}{H^3} \, dx, \qquad H(x_c) = H^*, \qquad
    \int_{-1}^{x_c} \frac{H - H^*}{H^3} \, dx = 0

and carries the share :math:`F_f/F_N = n \, \varphi_1(\bar F_N)`.  Without an exit suction cancels this order, and the share is
:math:`n^2 \varphi`.

Source: ours; theory.md, section 12.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from stribeck.quantities.units import InputError, show

__all__ = ["FreeExit", "boundary_film_with_free_exit"]

LARGEST_LOAD = 0.9
"""Load group up to which the gap in the middle is clearly positive."""

NODES = 400


class FreeExit(NamedTuple):
    r"""The film of boundary lubrication that ends at ambient pressure, at the first order in the speed.

    Attributes
    ----------
    exit : float
        Where the film ends [a].
    flux_gap : float
        Flux gap over the relative roughness, :math:`H^*` [-].
    share : float
        :math:`\varphi_1`: the share of the load on the fluid over :math:`\lambda/\kappa^2` [-].
    """

    exit: float
    flux_gap: float
    share: float


def boundary_film_with_free_exit(load: float) -> FreeExit:
    r"""Return the first order of a film with a free exit in boundary lubrication.

    .. math:: \varphi_1 = \frac2\pi \int_{-1}^{x_c} (x_c - x) \, \frac{H - H^*}{H^3} \, dx

    Parameters
    ----------
    load : float
        Load group :math:`\bar F_N`, from 1e-8 to 0.9 [-].

    Returns
    -------
    FreeExit
        Exit, flux gap and share.

    Raises
    ------
    InputError
        If the load group is out of range: from one on asperities cannot carry the load at a positive gap.

    Notes
    -----
    For relative roughness to zero at :math:`\lambda/\kappa^2 \ll 1`; of a state at load 0.1 the share is 4 % higher at
    relative roughness 1e-3 and 24 % at 1e-2 (``test_free_exit_law.py``).
    """
    if isinstance(load, bool) or not isinstance(load, int | float) or not 1e-8 <= load <= LARGEST_LOAD:
        raise InputError(f"load = {show(load)}; it must be a number from 1e-8 to {LARGEST_LOAD:g}.")
    # x = -tanh(s): the gap grows as s towards the edge of the contact, where it is infinite.
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    half_log = -0.5 * math.log(load)

    def integrals(end: float) -> tuple[float, float]:
        gap_at_end = half_log + math.log(math.cosh(end))
        s = end + 20.0 * (0.5 * (1 + nodes)) ** 2
        ds = 20.0 * 0.5 * (1 + nodes) * weights
        gap = half_log + np.log(np.cosh(s))
        gradient = (gap - gap_at_end) / gap**3 / np.cosh(s) ** 2 * ds
        return float(gradient.sum()), float(gradient @ (np.tanh(s) - math.tanh(end)))

    low, high = -8.0, 0.0  # the exit lies behind the middle, at s < 0; the pressure there falls with its distance
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if integrals(middle)[0] < 0 else (low, middle)
    end = 0.5 * (low + high)
    share = 2 / math.pi * integrals(end)[1]
    return FreeExit(-math.tanh(end), half_log + math.log(math.cosh(end)), share)
