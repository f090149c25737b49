r"""Boundary lubrication: how much of the load and friction a slow fluid takes over at small relative roughness.

The contact at rest is that of :mod:`stribeck.asymptotics.rest`, whose formulas this module imports.

Source: [BP] Section "Boundary-to-mixed lubrication transition", Appendix C; theory.md, section 6.
"""

from __future__ import annotations

import math
from functools import partial
from typing import Literal

import numpy as np

from stribeck.asymptotics.formula import Limit, Value, fluid_number, formula
from stribeck.asymptotics.perturbation import PhiForm, phi_of, pressure_moment, shear
from stribeck.asymptotics.rest import (
    central_gap,
    central_gap_small_indentation,
    contact_pressure_small_indentation,
    gap,
    gap_small_indentation,
    offset,
    offset_small_indentation,
)
from stribeck.contacts.groups import Groups

__all__ = [
    "central_gap",
    "central_gap_small_indentation",
    "contact_load_share",
    "contact_pressure_small_indentation",
    "fluid_load_share",
    "friction",
    "gap",
    "gap_small_indentation",
    "offset",
    "offset_small_indentation",
    "viscous_friction",
]

Viscous = Literal["published", "balanced", "neglected"]

# Range of the formulas for load and friction of both together.
SLOW_RANGE = (Limit("load", 1e-4, 0.5), Limit("relative_roughness", 0, 1e-3), Limit("paper_fluid_share", 0, 0.1))
# Range of the formulas for the small share of the fluid.
SMALL_SHARE_RANGE = (Limit("load", 1e-4, 0.5), Limit("relative_roughness", 0, 1e-4), Limit("paper_fluid_share", 0, 0.01))

_slow = partial(
    formula,
    plane="mixed",
    limits=SMALL_SHARE_RANGE,
    undefined="from load 1 on",
    small="relative_roughness",
    error_order=2 / 3,
)


@_slow(worst=0.07, source="[BP] Eqs. (fluid-normal), (fluid-normal-dl), with 2/pi")
def fluid_load_share(groups: Groups, form: PhiForm = "quadrature", printed: bool = False) -> Value:
    r"""Return the part of the load that the fluid carries at slow speed.

    .. math:: \frac{F_f}{F_N} = \frac{\lambda^2}{\kappa^4} \, \phi(\bar F_N)

    form : Form of :func:`stribeck.asymptotics.perturbation.phi`; "printed" is :math:`(-\ln \bar F_N)^5/2`.
    printed :
        With the factors of Eq. (fluid-normal): pi**2, as :math:`6 \pi \eta U a` is printed for :math:`6 \eta U a`, and phi
        without its 2/pi.

    With ``printed=True, form="printed"`` it is the formula of [BP] as printed.  The error, of order kappa**(2/3) with
    logarithms, comes from the edge of the contact, which is a layer of that width.
    """
    share = np.square(fluid_number(groups)) * phi_of(groups.load, form)
    if printed:
        lacking = 1.0 if form == "printed" else math.pi / 2
        share = math.pi**2 * lacking * share
    return share


@_slow(
    limits=SLOW_RANGE,
    worst=0.017,
    small="fluid_number",
    error_order=4,
    source="[BP] Eq. (friction_contact)",
)
def contact_load_share(groups: Groups, form: PhiForm = "quadrature", printed: bool = False) -> Value:
    r"""Return the part of the load that asperities carry at slow speed.

    .. math:: \frac{F_c}{F_N} = 1 - \frac{\lambda^2}{\kappa^4} \, \phi(\bar F_N)

    printed : As the article prints it, see :func:`fluid_load_share`.

    Negative where the formula has long ceased to hold.
    """
    return 1 - fluid_load_share.function(groups, form, printed)


@_slow(worst=0.075, source="theory.md, section 6")
def viscous_friction(groups: Groups, beta: float = 1.0, viscous: Viscous = "published") -> Value:
    r"""Return the viscous friction at slow speed.

    .. math::

        \mu_f^\mathrm{balanced} &= \frac{2 \beta \bar F_N^{1/2}}{3 \pi} \frac{\lambda}{\kappa} S(\bar F_N) \\
        \mu_f^\mathrm{published} &= \mu_f^\mathrm{balanced}
        + \frac{4 \beta \bar F_N^{1/2}}{\pi} \frac{\lambda}{\kappa^2} M(\bar F_N)

    [BP] state only that it goes as :math:`\eta U a/(F_N h_\mathrm{rms})`, which is true of the balanced definition; by their
    own it is larger by :math:`6 M/(S \kappa)`, 0.0701/kappa at load 0.1.

    S and M are :func:`stribeck.asymptotics.perturbation.shear` and ``pressure_moment``.
    """
    F, kappa = groups.load, np.asarray(groups.relative_roughness)
    if viscous == "neglected":
        return np.zeros(groups.shape)
    friction: Value = 2 * beta * F**0.5 / (3 * math.pi) * groups.speed / kappa * shear(F)
    if viscous == "published":
        friction = friction + 4 * beta * F**0.5 / math.pi * fluid_number(groups) * pressure_moment(F)
    return friction


@_slow(
    limits=(*SLOW_RANGE, Limit("beta/mu0", 0.0, 3.0)),
    worst=0.017,
    source="[BP] Eqs. (friction_contact), (fluid-normal-dl), with its viscous part",
)
def friction(
    groups: Groups,
    boundary_friction: float = 1.0,
    beta: float = 1.0,
    viscous: Viscous = "published",
    form: PhiForm = "quadrature",
    printed: bool = False,
) -> Value:
    r"""Return the friction in boundary lubrication.

    .. math:: \mu = \mu_0 \left(1 - \frac{\lambda^2}{\kappa^4} \, \phi(\bar F_N)\right) + \mu_f

    printed : As in :func:`fluid_load_share`; what is printed has the viscous part neglected too.

    The error, 1.4 % at most, is that of the asperities' part up to beta/mu0 = 3; at 10 the viscous part makes it 4.2 %.
    [BP] Eq. (friction_contact) is ``viscous="neglected"``.  In the paper's own definition the neglected part is of first order
    in the speed, and the load share of second.
    """
    mu_f = viscous_friction.function(groups, beta, "neglected" if printed else viscous)
    return boundary_friction * contact_load_share.function(groups, form, printed) + mu_f
