"""The transitions along a Stribeck curve: its minimum, where boundary lubrication ends, and where both lines meet.

[BP] predict the minimum by theory.md Eq. (14), which is exact for vanishing roughness, and slow to become so; ours is the
minimum of :func:`stribeck.asymptotics.mixed.friction`, found numerically.

Source: [BP] Sections "Hydrodynamic-to-mixed lubrication transition", "Boundary-to-mixed lubrication transition", "Conclusion".
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics import mixed
from stribeck.asymptotics.constants import FILM_CONSTANT, PRINTED_FILM_CONSTANT
from stribeck.asymptotics.formula import Limit, Value, formula
from stribeck.asymptotics.hydrodynamic import central_gap
from stribeck.asymptotics.mixed import lambert_w
from stribeck.asymptotics.perturbation import phi_of
from stribeck.asymptotics.weakening import (
    MAX_WEAKENING,
    Criterion,
    Form,
    film_ratio_at_minimum,
    has_minimum,
    roughness_without_minimum,
    weakening_number,
)
from stribeck.contacts.groups import Groups

__all__ = [
    "MAX_WEAKENING",
    "Criterion",
    "Form",
    "friction_at_minimum",
    "has_minimum",
    "separation_at_minimum",
    "roughness_without_minimum",
    "speed_at_minimum",
    "speed_boundary_to_mixed",
    "weakening_number",
]

FIT_RANGE = (Limit("load", 1e-4, 0.5), Limit("relative_roughness", 1e-5, 0.01), Limit("beta/mu0", 1e-3, 1.0))


_at_minimum = partial(formula, uses=("load", "roughness"), plane="mixed", limits=FIT_RANGE)


@_at_minimum(
    undefined="where the form has no minimum", worst=0.044, source="ours; [BP] Eqs. (Lambda_solution) and (Lambda_asymptotic)"
)
def separation_at_minimum(
    groups: Groups, boundary_friction: float = 1.0, beta: float = 1.0, form: Form = "uniform", *, printed: bool = False
) -> Value:
    r"""Return the central gap over h_rms/alpha at the friction minimum.

    .. math::

        \Lambda_\mathrm{exact} = -\tfrac13 W_{-1}(-3 k^3), \qquad
        \Lambda_\mathrm{expansion} = -\ln k + \tfrac13 \ln(-\ln k), \qquad \Lambda_\mathrm{leading} = -\ln k

    form :
        ``"uniform"``: the minimum of :func:`stribeck.asymptotics.mixed.friction`, and
        :func:`~stribeck.asymptotics.hydrodynamic.central_gap` there.  The others: [BP]'s friction, in Lambert's W, its
        expansion for small k, and the first term of that.
    printed : Whether the expansion with the constant 0.44 as printed.

    Against the central gap of the solver, in the range: ``"uniform"`` within 2.2 % for beta/mu0 = 1 and 4.4 % for 1e-3, 0.2
    and 0.6 % in the median; beyond, 6 % at 1e-4, 9 % at 3 and 20 % at 10.  For mu0 = beta = 1 ``"exact"`` and ``"expansion"``
    within 1.1 % and 1.5 % at relative roughness 1e-4, up to 13 % above at 0.01; ``"leading"`` up to 10 % below.
    """
    form = "expansion" if printed else form
    if form == "uniform":
        speed = speed_at_minimum.function(groups, boundary_friction, beta)
        with np.errstate(all="ignore"):
            return np.divide(central_gap.function(Groups(_known(speed), 1.0, 0.0)), groups.relative_roughness) + 0 * speed
    k = np.asarray(weakening_number(groups, boundary_friction, beta, printed=printed))
    with np.errstate(all="ignore"):
        k = np.where(k < MAX_WEAKENING, k, np.nan)
        if form == "exact":
            # scipy's branch loses its way next to -0.
            return np.where(k > 1e-90, lambert_w(-3 * k**3, -1) / -3, -np.log(k))[()]
        leading: Array = -np.log(k)
        return (leading if form == "leading" else leading + np.log(leading) / 3)[()]


@_at_minimum(
    undefined="where the form has no minimum",
    worst=0.069,
    source="ours; [BP] Eq. (lambda_min), which neglects the logarithm of a logarithm",
)
def speed_at_minimum(
    groups: Groups, boundary_friction: float = 1.0, beta: float = 1.0, form: Form = "uniform", *, printed: bool = False
) -> Value:
    r"""Return the speed at the friction minimum.

    .. math:: \lambda_\mathrm{min} = \left(\frac{\kappa \Lambda}{c}\right)^{5/3}

    form : Of Lambda, as in :func:`separation_at_minimum`; for ``"uniform"`` the speed itself.
    printed : Whether as printed: the leading form with the constant 0.44.

    Against the solver, in the range: ``"uniform"`` within 1.9 % for beta/mu0 = 1 and 6.9 % for 1e-3, 0.3 and 1.1 % in the
    median; beyond, 9 % at 1e-4, 10 % at 3 and 27 % at 10.  For mu0 = beta = 1 ``"exact"`` within 1.1 % at relative roughness
    1e-4, up to 35 % above at 0.01; as printed from 14 % below to 12 % above, as its two errors cancel.
    """
    if form == "uniform" and not printed:
        ratio = film_ratio_at_minimum(groups, boundary_friction, beta)
    else:
        ratio = _ratio_of_paper(groups, boundary_friction, beta, form, printed)
    c = PRINTED_FILM_CONSTANT if printed else FILM_CONSTANT
    with np.errstate(all="ignore"):
        return np.power(groups.relative_roughness * ratio / c, 5 / 3)


@_at_minimum(
    undefined="where the form has no minimum",
    worst=0.049,
    source="ours; [BP] Eq. (minimal_friction), with the sign of the second exponent corrected",
)
def friction_at_minimum(
    groups: Groups, boundary_friction: float = 1.0, beta: float = 1.0, form: Form = "uniform", *, printed: bool = False
) -> Value:
    r"""Return the minimum friction of a Stribeck curve.

    .. math::

        \mu_\mathrm{min} = \frac{4 \beta \bar h_\mathrm{rms}^{2/3} \bar F_N^{-1/6}}{3 \pi c^{5/3}}
        \left[\tfrac23 \Lambda^{-1/3} + \Lambda^{2/3}\right]

    form :
        Of Lambda, as in :func:`separation_at_minimum`; for ``"uniform"`` the friction of
        :func:`stribeck.asymptotics.mixed.friction` at its minimum.
    printed : Whether as printed: the leading form with the constant 0.44 and Lambda to the power -2/3 for 2/3.

    Against the solver, in the range: ``"uniform"`` within 1.1 % for beta/mu0 = 1 and 4.9 % for 1e-3, 0.1 and 0.6 % in the
    median: the error grows by 1.3 % a decade towards small beta/mu0, where the minimum lies at a thicker film with less of the
    load on asperities; beyond, 6.1 % at 1e-4 and 2.7 % at 10.  For mu0 = beta = 1 ``"exact"`` 6 to 8 % below at relative
    roughness 1e-4, 36 to 50 % at 0.01, an error that goes about as its square root; as printed 82 to 95 % below.

    [BP] Eq. (minimal_friction) follows from Eqs. (friction_hydro-mixed_transition_dl) and (Lambda_solution).
    """
    if form == "uniform" and not printed:
        speed = speed_at_minimum.function(groups, boundary_friction, beta)
        return (
            mixed.friction.function(Groups(_known(speed), groups.load, groups.roughness), boundary_friction, beta) + 0 * speed
        )
    ratio = _ratio_of_paper(groups, boundary_friction, beta, form, printed)
    c = PRINTED_FILM_CONSTANT if printed else FILM_CONSTANT
    scale: Value = 4 * beta / (3 * math.pi * c ** (5 / 3)) * np.power(groups.roughness, 2 / 3) * np.power(groups.load, -1 / 6)
    with np.errstate(all="ignore"):
        bracket: Value = 2 / 3 * np.power(ratio, -1 / 3) + np.power(ratio, -2 / 3 if printed else 2 / 3)
    return scale * bracket


@formula(
    predicts="speed_at_half_fluid",
    uses=("load", "roughness"),
    plane="mixed",
    limits=(Limit("load", 1e-4, 0.1), Limit("relative_roughness", 1e-5, 1e-3)),
    undefined="from load 1 on",
    worst=0.72,
    source="[BP] Eq. (boundary-to-mixed)",
)
def speed_boundary_to_mixed(groups: Groups, *, printed: bool = False) -> Value:
    r"""Return the speed at which boundary lubrication ends by the criterion of [BP].

    .. math:: \frac{\lambda^2}{\kappa^4} \phi(\bar F_N) = 1 \quad\Rightarrow\quad \lambda = \kappa^2 \phi(\bar F_N)^{-1/2}

    printed : Whether with the printed :math:`\phi = \tfrac12 (-\ln \bar F_N)^5`.

    The criterion extrapolates the law of slow speed to where the fluid would carry all of the load.  There the fluid really
    carries 46 to 24 % of it for loads 1e-3 to 0.1, so that half of it is carried at a speed 1.1 to 3.5 times higher, which is
    the error stated for this formula; at load 0.5, 13 % and 14 to 15 times.

    The printed phi has the exponent 5 for -5 and lacks 2/pi.  [BP] Eq. (speed_boundary-to-mixed) of the Conclusion prints
    another variant, :math:`\kappa^2 (-0.5 \ln \bar F_N)^{-5/2}`: with the factor 0.5 in the power, and with
    the wrong sign of that too; from
    :math:`\phi \approx \tfrac12 (-\ln \bar F_N)^{-5}` follows :math:`\sqrt2 \kappa^2 (-\ln \bar F_N)^{5/2}`.
    """
    with np.errstate(all="ignore"):
        phi = np.where(np.less(groups.load, 1), phi_of(groups.load, "printed" if printed else "quadrature"), np.nan)
        found: Array = np.square(groups.relative_roughness) * phi**-0.5
        return found[()]


def _ratio_of_paper(groups: Groups, boundary_friction: float, beta: float, form: Form, printed: bool) -> Value:
    """Return Lambda at the minimum of the friction of [BP]; its leading form with the constant 0.44 if ``printed``."""
    if not printed:
        return separation_at_minimum.function(groups, boundary_friction, beta, form)
    with np.errstate(all="ignore"):
        leading: Value = -np.log(weakening_number(groups, boundary_friction, beta, printed=True))
    return leading


def _known(speed: Value) -> Value:
    """Return the speed, and 1 where there is none, for groups, which refuse nan."""
    return np.where(np.isfinite(speed), speed, 1.0)[()]
