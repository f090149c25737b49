r"""Where the logarithm in the friction of a ball ends: at the edge of the liquid, or at the ball itself.

Far from the contact the shear :math:`\eta (u_1 - u_2)/h` and the pressure fall so slowly that the friction of a parabola
grows as :math:`\ln X` with the radius X up to which it is wetted. In Hertz units, S being the slide-to-roll ratio,

.. math::

    J = \frac S2 \left[J^\mathrm{couette} + \tfrac23 \pi \lambda \ln X\right]
        + J^\mathrm{poiseuille} + \tfrac25 \pi \lambda \ln X ,

with the finite parts J of a state. *A disc of liquid* ends at X. *A ball in liquid without bounds* that turns and moves along
a plane with the surface speeds :math:`u_2` and :math:`u_1` at a small gap h has, by Stokes' equations, the force

.. math::

    \frac{F}{6 \pi \eta R} = u_1 \left[\tfrac8{15} \ln\frac Rh + K\right] - u_2 \left[\tfrac2{15} \ln\frac Rh + K'\right]
    = \frac{u_1 - u_2}{2} \left[\tfrac23 \ln\frac Rh + K + K'\right]
    + \frac{u_1 + u_2}{2} \left[\tfrac25 \ln\frac Rh + K - K'\right]

with K = 0.954293 and K' = -0.257268. The rigid parabola :math:`h = h_0 + r^2/2R` with
:math:`p_f = -\tfrac65 \eta U x/h^2`, up to X, has both with :math:`\tfrac23 \ln(X^2/2 R h_0)` and
:math:`\tfrac25 [\ln(X^2/2 R h_0) - 2]` in the brackets, so that they agree for

.. math:: \ln \frac{X^\mathrm{couette}}R = \tfrac12 \left[\ln 2 + \tfrac32 (K + K')\right], \qquad
    \ln \frac{X^\mathrm{poiseuille}}R = \tfrac12 \left[\ln 2 + 2 + \tfrac52 (K - K')\right].

With one surface at rest both together are one radius, 5.034 R.

Source: ours; K and K' from series in bispherical coordinates of sliding and turning spheres, as in A. J. Goldman, R. G. Cox
and H. Brenner (1967), whose 0.9588 and -0.2526 are fits at finite gaps; M. Chaoui and F. Feuillebois (2003) have 0.95429.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck.contacts.friction import Definition
from stribeck.contacts.model import Model
from stribeck.fluids.cavitation import Cavitation

__all__ = ["COUETTE", "POISEUILLE", "SLIDING", "TURNING", "friction_integral", "log_cut_offs"]

SLIDING, TURNING = 0.954293, -0.257268
"""K and K'."""

COUETTE, POISEUILLE = 2 / 3 * math.pi, 2 / 5 * math.pi
"""Coefficients of lambda ln X in the two parts of the friction integral."""


@dataclass(frozen=True)
class FarFilm:
    r"""How a film far from the contact ends, and the logarithms of its friction.

    Attributes
    ----------
    pressure : float
        The factor of :math:`-\lambda \cos\theta/r^3` in the film pressure [-].
    couette, poiseuille : float
        Coefficients of :math:`\lambda \ln X` in the two parts of the friction integral [-].
    """

    pressure: float
    couette: float
    poiseuille: float


FULL = FarFilm(0.8, COUETTE, POISEUILLE)
"""The film is full on both sides."""

RUPTURE = 1.249038748131262
"""Angle at which a film that ends at ambient pressure ruptures far from the contact [radian]."""

CAVITATED = FarFilm(
    0.40553909094606316,
    (2 / 3) * (math.pi - RUPTURE) + (10 / 27) * (RUPTURE - math.sin(2 * RUPTURE) / 2),
    0.40553909094606316 * math.pi / 2,
)
"""The film ends at ambient pressure; its liquid goes on as streaks in the wake."""


def far_film(model: Model) -> FarFilm:
    """Return the far film of a model: behind a cavity whose pressure is below the ambient one it is full."""
    is_full = model.cavitation is Cavitation.NONE or model.cavity_pressure < 0
    return FULL if is_full else CAVITATED


_COUETTE_RADIUS = 0.5 * (math.log(2) + 1.5 * (SLIDING + TURNING))
_POISEUILLE_RADIUS = 0.5 * (math.log(2) + 2 + 2.5 * (SLIDING - TURNING))


def log_cut_offs(slope: Any, wetted_radius: Any = math.inf) -> tuple[Any, Any]:
    """Return ln X of the Couette and of the Poiseuille part [ln a].

    Parameters
    ----------
    slope : float or ndarray
        a/R [-].
    wetted_radius : float or ndarray
        Radius of the disc of liquid [a]; infinite for a whole ball in liquid without bounds.

    Returns
    -------
    tuple of float or ndarray
        Both logarithms; the same for a disc of liquid.
    """
    is_disc = np.isfinite(wetted_radius)
    at_rim, at_ball = np.log(np.where(is_disc, wetted_radius, 1.0)), -np.log(slope)
    couette, poiseuille = (np.where(is_disc, at_rim, own + at_ball) for own in (_COUETTE_RADIUS, _POISEUILLE_RADIUS))
    return couette[()], poiseuille[()]


def friction_integral(
    parts: Mapping[str, Any],
    speed: Any,
    slope: Any,
    slide_to_roll: Any,
    wetted_radius: Any,
    definition: Definition,
    far: FarFilm = FULL,
) -> Any:
    r"""Return the friction integral J of balls up to where the liquid ends.

    .. math:: J = \frac S2 J^\mathrm{couette} + J^\mathrm{poiseuille}

    each with its logarithm: the force on the flat; published, that on the ball without the contact pressure along x.

    Parameters
    ----------
    parts : mapping
        Finite parts ``J_couette``, ``J_poiseuille`` and, for the published one, ``J_pcx`` [-].
    speed : float or ndarray
        Speed group; zero gives zero [-].
    slope : float or ndarray
        a/R [-].
    slide_to_roll : float or ndarray
        S [-].
    wetted_radius : float or ndarray
        Radius of the disc of liquid [a]; infinite for a whole ball.
    definition : {"balanced", "published"}
        Which force.
    far : FarFilm
        How the film ends far away.

    Returns
    -------
    float or ndarray
        J [-].
    """
    by_shear, by_pressure = log_cut_offs(slope, wetted_radius)
    couette = parts["J_couette"] + far.couette * speed * by_shear
    found = 0.5 * slide_to_roll * couette + parts["J_poiseuille"] + far.poiseuille * speed * by_pressure
    if definition == "published":
        # Of a whole ball both forces differ by the contact pressure alone; a disc of liquid ends with a pressure at its rim.
        found = found - parts["J_pcx"] + np.where(np.isfinite(wetted_radius), far.poiseuille * speed, 0.0)
    return np.where(np.real(speed) > 0, found, 0.0)[()]
