"""Mixed lubrication from the side of the smooth film: asperities that reach through it, and the friction with them.

[BP] put the uniform film of the smooth contact into the contact law, theory.md Eq. (13).  Ours adds that the outlet is
thinner, and that the inlet takes in more fluid where asperities carry load.

Source: [BP] Section "Hydrodynamic-to-mixed lubrication transition"; theory.md, section 7.
"""

from __future__ import annotations

import math
from functools import partial
from typing import Any, Literal

import numpy as np
import scipy

from stribeck._types import Array
from stribeck.asymptotics.constants import FILM_CONSTANT
from stribeck.asymptotics.formula import Limit, Value, formula
from stribeck.asymptotics.hydrodynamic import central_gap, central_gap_large, friction_large, friction_uniform
from stribeck.contacts.groups import Groups

Film = Literal["uniform", "central", "large"]

# Coefficients of :func:`contact_load_share`, by smallest maximum error on 243 states of film ratio 3 to 10.
OUTLET_COEFFICIENTS = (0.37, 0.0072)
FEEDBACK_COEFFICIENT = 0.45
SATURATION_COEFFICIENT = 1.85

FIT_RANGE = (Limit("film_ratio", 3.0), Limit("relative_roughness", 1e-4, 0.1), Limit("load", 1e-3, 0.7))

_mixed = partial(formula, plane="mixed")


@_mixed(
    limits=(Limit("film_ratio", 3.0, 10.0), *FIT_RANGE[1:], Limit("speed", 0.0, 2.0)),
    worst=0.115,
    source="ours; [BP] Eqs. (contact_pressure_integral) and (friction_hydro-mixed_transition_dl)",
)
def contact_load_share(groups: Groups, film: Film = "uniform", *, printed: bool = False) -> Value:
    r"""Return the part of the load that asperities carry through a film.

    .. math::

        S_\mathrm{large} &= \frac4\pi \bar F_N^{-1/2} e^{-c \lambda^{3/5}/\kappa}, \qquad
        S_\mathrm{central} = \frac4\pi \bar F_N^{-1/2} e^{-\Lambda}, \quad \Lambda = \frac{h(0)}{\kappa} \\
        S_\mathrm{uniform} &= \frac{S}{(1 + S^n)^{1/n}}, \quad
        S = \frac{\lambda^{1/5}}{b} W_0\!\left(\frac{b S_0}{\lambda^{1/5}}\right), \quad
        S_0 = S_\mathrm{central} \left(1 + 0.37 \lambda^{3/5} + 0.0072 \Lambda^{8/3} \lambda^{2/5}\right)

    film :
        Film that the asperities meet: ``"large"``, as [BP], the limit of slow speed; ``"central"``, the same with
        :func:`~stribeck.asymptotics.hydrodynamic.central_gap`; ``"uniform"``, with the thinner outlet and with the thickening
        of the film by the asperities.
    printed : Whether ``film="large"`` with the constant 0.44 as printed.

    b = 0.45 and n = 1.85; the terms in the bracket are the outlet, from quadratures over smooth films.  Against the solver, in
    the range: ``"uniform"`` within 11.2 %, 1.5 % in the median, worst at film ratio 10 and relative roughness 0.035;
    ``"large"`` from 10 % below to 300 % above, 14 % in the median, and above where asperities thicken the film, at light
    loads and film ratios near 3; ``"central"`` from 86 % below to 300 % above, 25 % in the median: without the outlet the
    better central film is of no use.
    """
    film = "large" if printed else film
    with np.errstate(all="ignore"):
        if film == "large":
            ratio = np.divide(central_gap_large.function(groups, printed=printed), groups.relative_roughness)
            return _through(groups, ratio)
        ratio = np.divide(central_gap.function(groups), groups.relative_roughness)
        share = _through(groups, ratio)
        if film == "central":
            return share
        outlet = OUTLET_COEFFICIENTS[0] * groups.speed**0.6 + OUTLET_COEFFICIENTS[1] * ratio ** (8 / 3) * groups.speed**0.4
        inlet = groups.speed**0.2 / FEEDBACK_COEFFICIENT
        # A film of infinitely many roughnesses has an infinite outlet term and no share.
        share = np.where(np.equal(share, 0), 0.0, share * (1 + outlet))
        share = inlet * lambert_w(share / inlet)
        found: Array = share / (1 + share**SATURATION_COEFFICIENT) ** (1 / SATURATION_COEFFICIENT)
        return found[()]


@_mixed(
    limits=(FIT_RANGE[0], Limit("relative_roughness", 1e-4, 0.03), FIT_RANGE[2], Limit("beta/mu0", 0.01, 3.0)),
    worst=0.094,
    source="ours; [BP] Eq. (friction_hydro-mixed_transition_dl)",
)
def friction(
    groups: Groups, boundary_friction: float = 1.0, beta: float = 1.0, film: Film = "uniform", *, printed: bool = False
) -> Value:
    r"""Return the friction where asperities reach through a film.

    .. math::

        \mu_\mathrm{large} &= \mu_0 S_\mathrm{large} + \frac{4}{3 \pi c} \beta \bar F_N^{1/2} \lambda^{2/5}, \qquad
        \mu_\mathrm{central} = \mu_0 S_\mathrm{central} + \mu_{f,\mathrm{uniform}} \\
        \mu_\mathrm{uniform} &= \mu_0 S_\mathrm{uniform} + \mu_{f,\mathrm{uniform}}
        + \frac\pi2 \beta c^2 \bar F_N^{1/2} \Lambda \lambda^{1/5} S_\mathrm{uniform}

    film :
        Film that the asperities meet, see :func:`contact_load_share`, and law of the viscous friction:
        :func:`~stribeck.asymptotics.hydrodynamic.friction_large` for ``"large"``, else
        :func:`~stribeck.asymptotics.hydrodynamic.friction_uniform`.
    printed : Whether ``film="large"`` with the constant 0.44 as printed.

    By the definition of [BP].  The last term of ``"uniform"`` stands for what that definition leaves out, the projection of
    the contact pressure on the slope of the cylinder (theory.md, section 6): along the film
    :math:`h = h^* - c^2 \lambda^{1/5} h^* x/(1-x^2)^{1/2}`, so that the contact pressure leans towards the outlet.
    The balanced friction is without it.

    Against the solver, in the range: ``"uniform"`` within 9.4 %, worst where all limits meet, at film ratio 3, load 1e-3,
    relative roughness 1e-4 and beta/mu0 3; 0.2 % in the median.  Where beta/mu0 is smaller, asperities count at film ratios
    where little of their load is left, and the error is 17 % at 1e-3 and 29 % at 1e-4.  With mu0 = beta = 1 and up to relative
    roughness 0.1: ``"uniform"`` within 3.5 % from film ratio 5 on; ``"central"`` from 28 % below to 290 % above, 7 % in the
    median; ``"large"`` from 76 % below, as the viscous friction of relative roughness 0.1 is beyond its limit, to 300 % above,
    31 % in the median.
    """
    film = "large" if printed else film
    share = contact_load_share.function(groups, film, printed=printed)
    if film == "large":
        return boundary_friction * share + friction_large.function(groups, beta, printed=printed)
    viscous = friction_uniform.function(groups, beta)
    if film == "central":
        return boundary_friction * share + viscous
    with np.errstate(all="ignore"):
        ratio = np.divide(central_gap.function(groups), groups.relative_roughness)
        lean = np.where(np.equal(share, 0), 0.0, ratio * groups.speed**0.2 * share)[()]
    return boundary_friction * share + viscous + math.pi / 2 * beta * FILM_CONSTANT**2 * groups.load**0.5 * lean


def lambert_w(z: Value, branch: int = 0) -> Array:
    """Return a branch of Lambert's W, nan where it is not real."""
    w: Any = scipy.special.lambertw(np.asarray(z, dtype=complex), branch)
    return np.where(w.imag == 0, w.real, np.nan)


def _through(groups: Groups, film_ratio: Value) -> Value:
    """Return the load share of asperities under a uniform film in the Hertz contact."""
    return 4 / math.pi * groups.load**-0.5 * np.exp(-film_ratio)
