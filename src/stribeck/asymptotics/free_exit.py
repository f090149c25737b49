r"""Films of a cylinder that end at ambient pressure, ``cavitation = "exit"``: boundary lubrication, and smooth surfaces.

In boundary lubrication the share of the fluid is of first order in the speed, which suction cancels in a film without an exit:
theory.md, section 12.

Source: ours; theory.md, section 12.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from stribeck.asymptotics.constants import FILM_CONSTANT
from stribeck.asymptotics.documentation import described
from stribeck.asymptotics.formula import Value
from stribeck.quantities.units import InputError, real_array, show

MAX_LOAD = 0.9  # Load group up to which the gap in the middle is clearly positive.

GAUSS_NODES = 400

MINIMUM_OVER_CENTRAL = 0.796202  # Minimum over central gap of slow films, from states at speeds of 1e-8 to 1e-10.
EXIT_SLOPE = 0.16406  # Way of the exit beyond the edge of the dry contact over lambda**(2/5), from the same states.

RIGID_LOAD = 2.44748424  # Load over eta U R/h_0 under a rigid parabola.
RIGID_EXIT = 0.47512992  # Exit over (2 h_0)**(1/2) under a rigid parabola.


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


class SmoothFilm(NamedTuple):
    r"""A smooth film that ends at ambient pressure, in a limit of the speed.

    Attributes
    ----------
    central_gap, minimum_gap : float or ndarray
        Gap at x = 0, and the smallest one [u_Hz].
    exit : float or ndarray
        Where the film ends [a].
    """

    central_gap: Value
    minimum_gap: Value
    exit: Value


@described(
    "Central and minimum gap and exit.",
    kind="SmoothFilm",
    raises="If the speed is no such number.",
    source="ours; theory.md, section 12",
)
def slow_film_with_free_exit(speed: Value) -> SmoothFilm:
    r"""Return the limit of slow smooth films: that of the full film with its own outlet.

    .. math:: h(0) = c \lambda^{3/5}, \quad h_\mathrm{min} = 0.7962 \, h(0), \quad x_c = 1 + 0.16406 \, \lambda^{2/5}

    c = 0.44583 is that of the full film, as the inlet makes it.  Of solved states the central gap is higher by 0.25 % at speed
    1e-5, 1.6 % at 1e-3 and 4 % at 0.01, the way of the exit shorter by 2, 10 and 22 % (``test_free_exit_law.py``).
    """
    speed = _speed(speed)
    central = FILM_CONSTANT * speed**0.6
    return SmoothFilm(central, MINIMUM_OVER_CENTRAL * central, 1 + EXIT_SLOPE * speed**0.4)


@described(
    "Central and minimum gap and exit.",
    kind="SmoothFilm",
    raises="If the speed is no such number.",
    source="textbooks of lubrication, as Reynolds' condition under a parabola",
)
def rigid_film_with_free_exit(speed: Value) -> SmoothFilm:
    r"""Return the limit of fast smooth films: that of a rigid parabola.

    .. math:: h(0) = h_\mathrm{min} = \frac{2.44748}{3 \pi} \lambda, \quad x_c = 0.47513 \, [2 h(0)]^{1/2}

    The flux gap is :math:`1.22575 \, h(0)`.  Of solved states gaps are higher by 1.1 % at speed 100 and by 0.11 % at 1000, and
    the exit lies farther out by 3 and 0.3 % (``test_free_exit_law.py``).
    """
    central = RIGID_LOAD / (3 * math.pi) * _speed(speed)
    return SmoothFilm(central, central, RIGID_EXIT * np.sqrt(2 * central))


def _speed(value: Value) -> Value:
    speed = real_array("speed", value)
    if not ((speed >= 0) & (speed < math.inf)).all():
        raise InputError(f"speed = {show(value)}; it must be the speed group, finite and zero or positive.")
    return speed[()]


@described(
    "Exit, flux gap and share.",
    kind="FreeExit",
    raises="If the load group is out of range: from one on asperities cannot carry the load at a positive gap.",
    load="Load group, from 1e-8 to 0.9 [-].",
)
def boundary_film_with_free_exit(load: float) -> FreeExit:
    r"""Return the first order of a film with a free exit in boundary lubrication.

    .. math::

        \varphi_1 = \frac2\pi \int_{-1}^{x_c} (x_c - x) \, \frac{H - H^*}{H^3} \, dx, \qquad
        \int_{-1}^{x_c} \frac{H - H^*}{H^3} \, dx = 0, \quad H(x_c) = H^*, \quad
        H = -\tfrac12 \ln\left[\bar F_N (1 - x^2)\right]

    For relative roughness to zero at :math:`\lambda/\kappa^2 \ll 1`; of a state at load 0.1 the share is 4 % higher at
    relative roughness 1e-3 and 24 % at 1e-2 (``test_free_exit_law.py``).
    """
    if isinstance(load, bool) or not isinstance(load, int | float) or not 1e-8 <= load <= MAX_LOAD:
        raise InputError(f"load = {show(load)}; it must be a number from 1e-8 to {MAX_LOAD:g}.")
    # x = -tanh(s): the gap grows as s towards the edge of the contact, where it is infinite.
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS_NODES)
    half_log = -0.5 * math.log(load)

    def integrals(end: float) -> tuple[float, float]:
        gap_at_end = half_log + math.log(math.cosh(end))
        s = end + 20.0 * (0.5 * (1 + nodes)) ** 2
        ds = 20.0 * 0.5 * (1 + nodes) * weights
        gap = half_log + np.log(np.cosh(s))
        gradient = (gap - gap_at_end) / gap**3 / np.cosh(s) ** 2 * ds
        return float(gradient.sum()), float(gradient @ (np.tanh(s) - math.tanh(end)))

    # The exit lies behind the middle, at s < 0; the pressure there falls with its distance.
    end = float(brentq(lambda s: integrals(s)[0], -8.0, 0.0, xtol=1e-15, rtol=1e-15))
    share = 2 / math.pi * integrals(end)[1]
    return FreeExit(-math.tanh(end), half_log + math.log(math.cosh(end)), share)
