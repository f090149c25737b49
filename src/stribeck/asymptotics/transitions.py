"""The transitions along a Stribeck curve: its minimum, where boundary lubrication ends, and whether friction falls at all.

[BP] predict the minimum by theory.md Eq. (14), which is exact for vanishing roughness, and slow to become so: the friction has
one on either side of k = 0.4968 or none, see :func:`weakening_number`.  Ours is the minimum of
:func:`stribeck.asymptotics.mixed.friction`, found numerically.

Source: [BP] Sections "Hydrodynamic-to-mixed lubrication transition", "Boundary-to-mixed lubrication transition", "Conclusion".
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Literal, get_args

import numpy as np

from stribeck._types import Array, Flags
from stribeck.asymptotics import mixed
from stribeck.asymptotics.constants import FILM_CONSTANT, PRINTED_FILM_CONSTANT
from stribeck.asymptotics.documentation import described
from stribeck.asymptotics.formula import Limit, Value, coefficient, formula
from stribeck.asymptotics.hydrodynamic import central_gap
from stribeck.asymptotics.mixed import lambert_w
from stribeck.asymptotics.perturbation import phi_of
from stribeck.contacts.groups import Groups
from stribeck.quantities.units import checked_word

FIT_RANGE = (Limit("load", 1e-4, 0.5), Limit("relative_roughness", 1e-5, 0.01), Limit("beta/mu0", 1e-3, 1.0))

Form = Literal["uniform", "exact", "expansion", "leading"]
Criterion = Literal["uniform", "plateau", "lines", "weakening"]

MAX_WEAKENING = (3 * math.e) ** (-1 / 3)  # k up to which the branch of Lambert's W exists on which the minimum lies.
FILM_RATIO_RANGE = (1.5, 60.0)  # Film ratios c lambda**(3/5)/kappa between which the minimum of the uniform law is sought.
# Relative roughness between which the speed of the minimum stays in double precision.
FINITE_SPEED_ROUGHNESS = 1e-170, 1e170

SEARCH_POINTS = 121  # Film ratios at which the uniform law is scanned for its minimum.
BISECTIONS = 30  # Halvings of the interval that holds a root.
DIFFERENCE_STEP = 1e-4  # Step of the differences in ln(speed).

ROUGHNESS_RANGE = (1e-7, 1e3)  # Relative roughness between which the merging of the uniform law is sought.

_at_minimum = partial(
    formula, uses=("load", "roughness"), plane="mixed", limits=FIT_RANGE, undefined="where the form has no minimum"
)


@_at_minimum(worst=0.044, source="ours; [BP] Eqs. (Lambda_solution) and (Lambda_asymptotic)")
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
        ratio = _film_ratio(groups, boundary_friction, beta)
    else:
        ratio = _ratio_of_paper(groups, boundary_friction, beta, form, printed)
    c = PRINTED_FILM_CONSTANT if printed else FILM_CONSTANT
    with np.errstate(all="ignore"):
        return np.power(groups.relative_roughness * ratio / c, 5 / 3)


@_at_minimum(
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


@described("k [-].", source="[BP] Eq. (Lambda_solution)")
def weakening_number(groups: Groups, boundary_friction: float = 1.0, beta: float = 1.0, *, printed: bool = False) -> Value:
    r"""Return the number on which the minimum of friction depends in the limit of small roughness.

    .. math:: k = \frac{2}{9 c^{5/3}} \frac{\beta \bar h_\mathrm{rms}^{2/3} \bar F_N^{1/3}}{\mu_0}
    """
    boundary_friction, beta = coefficient("boundary_friction", boundary_friction), coefficient("beta", beta)
    c = PRINTED_FILM_CONSTANT if printed else FILM_CONSTANT
    with np.errstate(divide="ignore"):
        scale = np.divide(2 * beta, 9 * c ** (5 / 3) * boundary_friction)
    number: Value = scale * np.power(groups.roughness, 2 / 3) * np.power(groups.load, 1 / 3)
    return number


@described(
    "Of the shape of load and roughness.",
    kind="ndarray of bool",
    source="[BP] Eq. (Lambda_solution), whose condition is not stated there",
    form='``"uniform"``: by :func:`stribeck.asymptotics.mixed.friction`; the others: by that of [BP], as above.',
)
def has_minimum(groups: Groups, boundary_friction: float = 1.0, beta: float = 1.0, form: Form = "uniform") -> Flags:
    r"""Return whether friction has a minimum over the speed.

    .. math:: k < (3e)^{-1/3} = 0.4968

    The condition on k is necessary and far from sufficient, see :func:`roughness_without_minimum`.
    """
    boundary_friction, beta = coefficient("boundary_friction", boundary_friction), coefficient("beta", beta)
    if checked_word("form", form, get_args(Form)) == "uniform":
        return np.isfinite(_film_ratio(groups, boundary_friction, beta, 0))
    return np.asarray(weakening_number(groups, boundary_friction, beta) < MAX_WEAKENING)


@described(
    "Roughness group [-]; nan where the criterion is never met.",
    raises="If ``criterion`` is none of the four, or a load is no positive number.",
    source="[BP] Conclusion, in words; formulas ours",
    load="Load group [-].",
)
def roughness_without_minimum(
    load: Value, boundary_friction: float = 1.0, beta: float = 1.0, criterion: Criterion = "uniform"
) -> Value:
    r"""Return the roughness beyond which friction never falls with speed, by formulas.

    .. math::

        \bar h_\mathrm{rms} = \left(\frac{9 c^{5/3} k \mu_0}{2 \beta \bar F_N^{1/3}}\right)^{3/2}, \quad
        k = \Lambda^{1/3} e^{-\Lambda}, \quad
        \Lambda_\mathrm{plateau} = -\tfrac23 - W_{-1}\!\left(-\tfrac\pi6 \bar F_N^{1/2} e^{-2/3}\right), \quad
        \Lambda_\mathrm{weakening} = \tfrac13, \quad
        \Lambda_\mathrm{lines} = 3 W_0\!\left(\tfrac13 \left[\frac{9 c^5 \mu_0}{2 \beta \bar F_N \phi}\right]^{1/3}\right)

    criterion :
        ``"uniform"``: :func:`stribeck.asymptotics.mixed.friction` no longer falls anywhere.
        ``"plateau"``: the minimum of [BP]'s friction reaches boundary_friction, what its Conclusion names.
        ``"lines"``: the two transitions of [BP],
        ``speed_boundary_to_mixed`` and ``speed_at_minimum`` (exact), meet, what its Conclusion means by merging.
        ``"weakening"``: the minimum of [BP]'s friction disappears, k = 0.4968.

    Relative roughness of the merging with mu0 = beta = 1:

    ===============================================  =====  =====  =====  =====
    Load                                             0.001  0.01   0.1    0.5
    ===============================================  =====  =====  =====  =====
    solver, no minimum, balanced                     0.778  0.342  0.175  0.151
    solver, no minimum, published                    0.784  0.343  0.160  0.103
    solver, minimum at boundary_friction, balanced   0.586  0.267  0.146  0.133
    solver, minimum at boundary_friction, published  0.577  0.254  0.122  0.084
    uniform                                          0.813  0.297  0.115  0.040
    plateau                                          12.2   2.69   0.645  0.266
    lines                                            0.271  0.672  1.59   1.21
    weakening                                        14029  444    14.0   1.25
    ===============================================  =====  =====  =====  =====

    The solver's are :func:`stribeck.regimes.phase_diagram.roughness_without_minimum`.
    The last three assume small relative roughness and are asked where it is not small.
    """
    checked_word("criterion", criterion, get_args(Criterion))
    boundary_friction, beta = coefficient("boundary_friction", boundary_friction), coefficient("beta", beta)
    F = np.asarray(Groups(0.0, load, 0.0).load)
    if criterion == "uniform":
        return _uniform_merging(F, boundary_friction, beta)
    c = FILM_CONSTANT
    with np.errstate(all="ignore"):
        if criterion == "plateau":
            argument = -math.pi / 6 * np.power(F, 0.5) * math.exp(-2 / 3)
            ratio = -2 / 3 - lambert_w(argument, -1)
        elif criterion == "lines":
            phi = np.where(np.less(F, 1), phi_of(F), np.nan)
            ratio = 3 * lambert_w(np.power(9 * c**5 * boundary_friction / (2 * beta * F * phi), 1 / 3) / 3)
        else:
            ratio = np.full(np.shape(F), 1 / 3)
        # Below 1/3 lies the other branch, the maximum.
        ratio = np.where(ratio >= 1 / 3, ratio, np.nan)
        k = np.power(ratio, 1 / 3) * np.exp(-ratio)
        found: Value = np.power(9 * c ** (5 / 3) * k * boundary_friction / (2 * beta * np.power(F, 1 / 3)), 1.5)[()]
        return found


def _speed(film_ratio: Value, kappa: Value) -> Value:
    speed: Value = np.power(film_ratio * kappa / FILM_CONSTANT, 5 / 3)
    return speed


def _last(holds: Callable[[Array], Flags], low: Array, high: Array, bisections: int = BISECTIONS) -> Array:
    """Return up to where something holds that does at ``low`` and does not at ``high``."""
    for _ in range(bisections):
        middle = (low + high) / 2
        there = holds(middle)
        low, high = np.where(there, middle, low), np.where(there, high, middle)
    return low


def _film_ratio(groups: Groups, boundary_friction: float, beta: float, bisections: int = BISECTIONS) -> Value:
    """Return the film ratio at which the uniform law has its minimum, nan where it has none, as no bisections tell too."""
    load, given = np.broadcast_arrays(groups.load, groups.relative_roughness)
    kappa = np.clip(given, *FINITE_SPEED_ROUGHNESS)

    def falls(log_ratio: Array) -> Flags:
        above, below = (
            mixed.friction.function(Groups(_speed(np.exp(each), kappa), load, kappa * load), boundary_friction, beta)
            for each in (log_ratio + DIFFERENCE_STEP, log_ratio - DIFFERENCE_STEP)
        )
        return np.less(above - below, 0)

    ratios = np.log(np.geomspace(*FILM_RATIO_RANGE, SEARCH_POINTS))
    falling = falls(ratios.reshape(-1, *(1,) * load.ndim))
    last = SEARCH_POINTS - 1 - np.argmax(falling[::-1], axis=0)
    found = falling.any(axis=0) & (last < SEARCH_POINTS - 1) & (kappa == given)
    low = np.minimum(last, SEARCH_POINTS - 2)
    return np.where(found, np.exp(_last(falls, ratios[low], ratios[low + 1], bisections)), np.nan)[()]


def _uniform_merging(load: Value, boundary_friction: float, beta: float) -> Value:
    """Return the roughness from which the uniform law has no minimum, nan where that lies outside ROUGHNESS_RANGE."""
    low, high = (np.full(np.shape(load), math.log(end)) for end in ROUGHNESS_RANGE)

    def falls(log_kappa: Array) -> Flags:
        groups = Groups(1.0, load, load * np.exp(log_kappa))
        return np.isfinite(_film_ratio(groups, boundary_friction, beta, 0))

    inside = falls(low) & ~falls(high)
    return np.where(inside, load * np.exp(_last(falls, low, high)), np.nan)[()]


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
