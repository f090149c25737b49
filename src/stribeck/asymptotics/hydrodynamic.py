r"""Friction of smooth surfaces in the limits of small and of large speed group, and between them.

Source: [BP] Section "Smooth limit"; theory.md, section 7.
"""

from __future__ import annotations

import math

import numpy as np

from .._types import Array
from ..parameters import Groups

FILM_CONSTANT = 0.44583
r"""Central film over u_Hz lambda**(3/5) as lambda -> 0; [BP] print 0.44.  From our solver at speeds down to
1e-10, extrapolated with the correction ~ lambda**(2/5); good to 1e-6."""


def friction_large(groups: Groups, beta: float = 1.0) -> float | Array:
    r"""Return the viscous friction at large deformation, speed group -> 0.

    .. math:: \mu = \frac{4}{3 \pi c} \beta \bar F_N^{1/2} \lambda^{2/5}

    Parameters
    ----------
    groups : Groups
        Uses ``speed`` and ``load`` [-]; arrays broadcast.
    beta : float
        Coefficient of the contact law [-].

    Returns
    -------
    float or ndarray
        Friction coefficient [-].

    Notes
    -----
    Next term relative to it about 4 lambda**(2/5).

    Source: [BP] Eq. (hydrofriction_large), with c = 0.44583 for 0.44 and (F_N/(E* R))**(1/2) for the printed
    (F_N R/E*)**(1/2).
    """
    return 4 / (3 * math.pi * FILM_CONSTANT) * beta * groups.load**0.5 * groups.speed**0.4


def friction_small(groups: Groups, beta: float = 1.0) -> float | Array:
    r"""Return the viscous friction at small deformation, speed group -> infinity.

    .. math:: \mu = \frac{4 \sqrt2}{3} \, 24^{1/6} \, \beta \bar F_N^{1/2} \lambda^{2/3}

    Parameters
    ----------
    groups : Groups
        Uses ``speed`` and ``load`` [-]; arrays broadcast.
    beta : float
        Coefficient of the contact law [-].

    Returns
    -------
    float or ndarray
        Friction coefficient [-].

    Notes
    -----
    Source: [BP] Eq. (hydrofriction_small) with Eq. (film_thickness_small_deformation).
    """
    return 4 * math.sqrt(2) / 3 * 24 ** (1 / 6) * beta * groups.load**0.5 * groups.speed ** (2 / 3)


def friction(groups: Groups, beta: float = 1.0) -> float | Array:
    r"""Return the viscous friction of smooth surfaces at any speed, by interpolation.

    .. math:: \mu_{f,\mathrm{th}} = \sqrt{\mu_\mathrm{small}^2 + \mu_\mathrm{large}^2}

    Parameters
    ----------
    groups : Groups
        Uses ``speed`` and ``load`` [-]; arrays broadcast.
    beta : float
        Coefficient of the contact law [-].

    Returns
    -------
    float or ndarray
        Friction coefficient [-].

    Notes
    -----
    Between 7.2 % below the solver (at speed 0.003) and 1.2 % above it.

    Source: [BP] Eq. (interpolated_hydrodynamic_friction).
    """
    return np.hypot(friction_small(groups, beta), friction_large(groups, beta))
