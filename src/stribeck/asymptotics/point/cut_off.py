r"""The logarithm in the friction of a ball, and where it ends.

Far from the contact :math:`1/h \to 2/r^2` and :math:`p_f \to -\tfrac45 \lambda x/r^4`, so that the friction of a
parabola grows as the logarithm of the radius X up to which it is wetted. In Hertz units, J of [F_N (3/2 pi) a/R],

.. math:: J = J_\mathrm{fp} + \tfrac{16}{15} \pi \lambda \ln X .

*Where the liquid ends* at a radius, that is X. *A whole sphere* in liquid without bounds has the force

.. math:: F = 6 \pi \eta R U \left[\tfrac{8}{15} \ln\frac Rh + K\right], \qquad K = 0.954294,

at a small gap h to a plane (Stokes flow; :mod:`stribeck.evidence.sphere_along_wall` solves it). As
:math:`J = \pi \lambda F/(6 \pi \eta R U)` and the rigid parabola has
:math:`J_\mathrm{fp} = -\pi\lambda [\tfrac{8}{15} \ln(2 h_0) + \tfrac25]`, both agree for

.. math:: \ln\left(X_c \frac aR\right) = \tfrac{15}{16} \left[K + \tfrac25 + \tfrac{8}{15} \ln 2\right],

X_c = 5.0340 R/a, for the balanced friction.  The published definition leaves the pressure of the fluid on the ball beyond X
out, :math:`\tfrac25` in the bracket, hence 3.4598 R/a; with the contact pressure on the slope, which it leaves out too,
both give one force.

Source: ours; K by A. J. Goldman, R. G. Cox and H. Brenner (1967) is 0.9588, which is 0.5 % too high, and by M. Chaoui and
F. Feuillebois (2003) 0.954294; theory.md, section 11.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.formula import Value
from stribeck.quantities.units import InputError, real_array, show

Definition = Literal["published", "balanced"]

WALL = 0.954294
"""K: force over 6 pi eta R U of a sphere sliding along a plane, less (8/15) ln(R/h), as h -> 0."""

LOGARITHM = 16 / 15 * math.pi
"""Coefficient of lambda ln X in the friction integral."""

WHOLE_SPHERE: dict[Definition, float] = {
    "balanced": math.exp(15 / 16 * (WALL + 2 / 5 + 8 / 15 * math.log(2))),
    "published": math.exp(15 / 16 * (WALL + 8 / 15 * math.log(2))),
}
"""X_c a/R of the whole sphere."""


def cut_off(slope: Value, wetted_radius: Value | None = None, definition: Definition = "balanced") -> Array:
    r"""Return the radius at which the logarithm of the friction ends.

    .. math:: X_c = 5.034 \, \frac Ra \text{ balanced}, \qquad X_c = 3.460 \, \frac Ra \text{ published}

    Parameters
    ----------
    slope : float or array_like
        a/R [-], see :meth:`stribeck.Groups.slope`.
    wetted_radius : float or array_like, optional
        Where the liquid ends [a]; by default that of a whole sphere in liquid without bounds.
    definition : {"balanced", "published"}
        Definition of the friction.

    Returns
    -------
    ndarray
        Radius [a].

    Raises
    ------
    InputError
        If the definition is unknown, or a wetted radius lies in the contact, at 1 or below.
    """
    if not isinstance(definition, str) or definition not in WHOLE_SPHERE:
        raise InputError(f"definition = {show(definition)}; it must be 'balanced' or 'published'.")
    if wetted_radius is None:
        return np.asarray(np.divide(WHOLE_SPHERE[definition], slope))
    radius = real_array("wetted_radius", wetted_radius)
    if not (radius > 1).all():
        raise InputError(
            f"wetted_radius = {show(wetted_radius)}; it is in Hertz radii and must exceed 1, the edge of the contact."
        )
    return np.asarray(radius)
