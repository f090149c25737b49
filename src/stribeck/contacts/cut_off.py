r"""Where the logarithm in the friction of a ball ends: at the edge of the liquid, or at the ball itself.

Shear and pressure fall so slowly that friction grows with the radius X up to which the parabola is wetted. In Hertz units, S
being the slide-to-roll ratio and J the finite parts of a state,

.. math::

    J = \frac S2 \left[J^\mathrm{couette} + \tfrac23 \pi \lambda \ln X\right]
        + J^\mathrm{poiseuille} + \tfrac25 \pi \lambda \ln X .

*A disc of liquid* ends at X. *A ball in liquid without bounds* whose surfaces move at :math:`u_2` along a plane that moves at
:math:`u_1` has, by Stokes' equations at a small gap h, the force

.. math::

    \frac{F}{6 \pi \eta R} = u_1 \left[\tfrac8{15} \ln\frac Rh + K\right] - u_2 \left[\tfrac2{15} \ln\frac Rh + K'\right],
    \qquad K = 0.954293, \quad K' = -0.257268 .

The rigid parabola with :math:`p_f = -\tfrac65 \eta U x/h^2` has the same shear and the same pressure for

.. math:: \ln \frac{X^\mathrm{couette}}R = \tfrac12 \left[\ln 2 + \tfrac32 (K + K')\right], \qquad
    \ln \frac{X^\mathrm{poiseuille}}R = \tfrac12 \left[\ln 2 + 2 + \tfrac52 (K - K')\right],

one radius of 5.034 R if one surface is at rest.

*A film as thick as the parabola at X* would make the logarithms negative. The shear begins at a radius :math:`X_0`, known from
:math:`J^\mathrm{couette}`; with :math:`y = X_0^2/X^2` the rigid parabola has

.. math::

    J^\mathrm{couette}(X) = \tfrac13 \pi \lambda \ln(1 + 1/y), \qquad
    J^\mathrm{poiseuille}(X) = J^\mathrm{poiseuille} + \tfrac25 \pi \lambda \ln X
    + \tfrac15 \pi \lambda \left[\frac{2 y}{1 + y} + \ln(1 + y)\right],

which is taken for every film: exact for thick ones, the logarithms for thin ones, and no drag along the motion while the
film is thinner than the ball.

Source: ours; K and K' from series in bispherical coordinates of sliding and turning spheres, as in A. J. Goldman, R. G. Cox
and H. Brenner (1967), whose 0.9588 and -0.2526 are fits at finite gaps; M. Chaoui and F. Feuillebois (2003) have 0.95429.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Model
from stribeck.fluids.fluid import Cavitation

CUT_OFF_SLIDING = 0.954293  # K, the offset of ln X by sliding [-]
CUT_OFF_ROTATION = -0.257268  # K', the offset of ln X by rotation [-]

COUETTE = 2 / 3 * math.pi  # Coefficient of lambda ln X in the Couette part of the friction integral
POISEUILLE = 2 / 5 * math.pi  # Coefficient of lambda ln X in the Poiseuille part of the friction integral


@dataclass(frozen=True)
class FarFilm:
    r"""How a film far from the contact ends, and the logarithms of its friction."""

    pressure: float  # The factor of `-\lambda \cos\theta/r^3` in the film pressure [-]
    couette: float  # Coefficient of `\lambda \ln X` in the Couette part of the friction integral [-]
    poiseuille: float  # Coefficient of `\lambda \ln X` in the Poiseuille part [-]
    rise: float


FAR_FILM_MIN_RADIUS = 5.0  # Radius of the disc of liquid below which friction is of the film itself and not of a far film [a]

FULL_FAR_FILM = FarFilm(0.8, COUETTE, POISEUILLE, 1.0)  # Full on both sides

RUPTURE_ANGLE = 1.249038748131262  # Angle at which a film that ends at ambient pressure ruptures far from the contact [radian]

# Ends at ambient pressure; its liquid goes on as streaks in the wake
CAVITATED_FAR_FILM = FarFilm(
    0.40553909094606316,
    (2 / 3) * (math.pi - RUPTURE_ANGLE) + (10 / 27) * (RUPTURE_ANGLE - math.sin(2 * RUPTURE_ANGLE) / 2),
    0.40553909094606316 * math.pi / 2,
    1.1306,
)


def far_film(model: Model) -> FarFilm:
    """Return the far film of a model: behind a cavity whose pressure is below the ambient one it is full."""
    is_full = model.cavitation is Cavitation.NONE or model.cavity_pressure < 0
    return FULL_FAR_FILM if is_full else CAVITATED_FAR_FILM


_COUETTE_RADIUS = 0.5 * (math.log(2) + 1.5 * (CUT_OFF_SLIDING + CUT_OFF_ROTATION))
_POISEUILLE_RADIUS = 0.5 * (math.log(2) + 2 + 2.5 * (CUT_OFF_SLIDING - CUT_OFF_ROTATION))


def log_cut_offs(slope: Any, wetted_radius: Any = math.inf) -> tuple[Any, Any]:
    """Return ln X of the Couette and of the Poiseuille part [ln a]."""
    is_disc = np.isfinite(wetted_radius)
    at_rim, at_ball = np.log(np.where(is_disc, wetted_radius, 1.0)), -np.log(slope)
    couette, poiseuille = (np.where(is_disc, at_rim, own + at_ball) for own in (_COUETTE_RADIUS, _POISEUILLE_RADIUS))
    return couette[()], poiseuille[()]


def far_logarithms(by_shear: Any, by_pressure: Any, minus_log_start: Any, rise: Any) -> tuple[Any, Any, Any]:
    """Return both logarithms of a film that is thick at its ends, from those of a thin one, and how thin its end is."""
    # By logarithms: a film that hardly anything shears is thicker than numbers hold.
    at_shear, at_pressure = (-2.0 * (minus_log_start + each) for each in (by_shear, by_pressure))
    log_shear, log_pressure = (np.logaddexp(0.0, each) for each in (at_shear, at_pressure))
    pressure = by_pressure + rise * np.exp(at_pressure - log_pressure) + 0.5 * log_pressure
    return by_shear + 0.5 * log_shear, pressure, np.exp(-log_pressure)


def friction_integral(
    parts: Mapping[str, Any],
    speed: Any,
    slope: Any,
    slide_to_roll: Any,
    wetted_radius: Any,
    definition: Definition,
    far: FarFilm = FULL_FAR_FILM,
    within: Callable[[int, Any], Any] | None = None,
) -> Any:
    r"""Return the friction integral J of balls up to where the liquid ends.

    .. math:: J = \frac S2 J^\mathrm{couette} + J^\mathrm{poiseuille}

    each with its logarithm: the force on the flat; published, that on the ball without the contact pressure along x.  What a
    film has more up to a logarithm of the radius, ``within``, takes the place of the far film in closed form.
    """
    by_shear, by_pressure = log_cut_offs(slope, wetted_radius)
    moves, edge = speed > 0, far.poiseuille * speed
    if within is None:
        start = _minus_log_cut_off(parts, speed, far)
        by_shear, by_pressure, thinness = far_logarithms(by_shear, by_pressure, start, far.rise)
        couette, poiseuille, edge = parts["J_couette"], parts["J_poiseuille"], edge * thinness
    else:
        couette, poiseuille = parts["J_couette"] + within(0, by_shear), parts["J_poiseuille"] + within(1, by_pressure)
        edge = edge + within(2, by_pressure)
    couette, poiseuille = couette + far.couette * speed * by_shear, poiseuille + far.poiseuille * speed * by_pressure
    found = 0.5 * slide_to_roll * couette + poiseuille
    if definition == "published":
        # Of a whole ball both forces differ by the contact pressure alone; a disc of liquid ends with a pressure at its rim.
        found = found - parts["J_pcx"] + np.where(np.isfinite(wetted_radius), edge, 0.0)
    return np.where(moves, found, 0.0)[()]


FAR_PARTS = ("J_couette", "J_poiseuille", "J_pcx")  # Parts of the friction of a film that is far away where it ends


def far_parts(
    parts: Mapping[str, Any], speed: Any, cut_offs: tuple[float, float], is_disc: bool, far: FarFilm
) -> dict[str, Any]:
    """Return :data:`FAR_PARTS` with which a far film has the friction of a film with ``parts`` up to where it ends."""
    by_shear, by_pressure = cut_offs
    unit, edge = far.couette * speed, far.poiseuille * speed
    shear = (parts["J_couette"] + parts["within_couette"]) / unit + by_shear
    minus_log_start = shear + 0.5 * np.log1p(-np.exp(-2.0 * shear)) - by_shear
    _, far_pressure, thinness = far_logarithms(by_shear, by_pressure, minus_log_start, far.rise)
    poiseuille = parts["J_poiseuille"] + parts["within_poiseuille"] - edge * (far_pressure - by_pressure)
    at_edge = parts["within_edge"] + edge * (1.0 - thinness) if is_disc else 0.0
    return {"J_couette": unit * minus_log_start, "J_poiseuille": poiseuille, "J_pcx": parts["J_pcx"] - at_edge}


def far_error(
    parts: Mapping[str, Any], speed: Any, slide_to_roll: Any, wetted_radius: Any, far: FarFilm = FULL_FAR_FILM
) -> Any:
    """Return the largest error of :func:`friction_integral` by the end of a disc of liquid."""
    # The offset of thin films, at least minus one indentation, is left out.
    log_from_there = np.logaddexp(2.0 * np.log(wetted_radius), -2.0 * _minus_log_cut_off(parts, speed, far))
    return (0.5 * np.abs(slide_to_roll) * far.couette + 3.0 * far.poiseuille) * speed * np.exp(-log_from_there)


def is_far(model: Model, wetted_radius: Any) -> Any:
    """Return whether a far film in closed form holds from where the liquid ends."""
    # No closed form holds for a thinning fluid, and none is known for thick films that rupture.
    nearest = FAR_FILM_MIN_RADIUS if model.cavitation is Cavitation.NONE else math.inf
    return np.logical_and(not model.film.uses_speed, np.greater_equal(wetted_radius, nearest))


def _minus_log_cut_off(parts: Mapping[str, Any], speed: Any, far: FarFilm) -> Any:
    """Return minus the logarithm of the cut-off X_0."""
    return parts["J_couette"] / np.where(speed > 0, far.couette * speed, 1.0)
