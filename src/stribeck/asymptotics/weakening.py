r"""Whether friction falls with speed: the weakening number, and the roughness beyond which friction only grows.

The friction of [BP] near its minimum has one on either side of k = 0.4968 or none, see :func:`weakening_number`; ours is
:func:`stribeck.asymptotics.mixed.friction`, whose minimum is found numerically.
:mod:`stribeck.asymptotics.transitions` predicts the minimum by both.

Source: [BP] Section "Hydrodynamic-to-mixed lubrication transition" and Conclusion.
"""

from __future__ import annotations

import math
from typing import Literal, get_args

import numpy as np

from stribeck._types import Array, Flags
from stribeck.asymptotics import mixed
from stribeck.asymptotics.constants import FILM_CONSTANT, PRINTED_FILM_CONSTANT
from stribeck.asymptotics.documentation import described
from stribeck.asymptotics.formula import Value, coefficient
from stribeck.asymptotics.mixed import lambert_w
from stribeck.asymptotics.perturbation import phi_of
from stribeck.contacts.groups import Groups
from stribeck.quantities.units import checked_word

__all__ = ["MAX_WEAKENING", "Criterion", "Form", "has_minimum", "roughness_without_minimum", "weakening_number"]

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
        return np.isfinite(film_ratio_at_minimum(groups, boundary_friction, beta))
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

    The solver's are :func:`stribeck.regimes.weakening.roughness_without_minimum`.
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


def _uniform_slopes(load: Value, kappa: Value, boundary_friction: float, beta: float, log_ratio: Value) -> Array:
    """Return differences of the uniform law over the speed, of the sign of its slope."""

    def friction(log_ratio: Value) -> Value:
        speed = np.power(np.exp(log_ratio) * kappa / FILM_CONSTANT, 5 / 3)
        return mixed.friction.function(Groups(speed, load, kappa * load), boundary_friction, beta)

    return np.asarray(friction(log_ratio + DIFFERENCE_STEP) - friction(log_ratio - DIFFERENCE_STEP))


def film_ratio_at_minimum(groups: Groups, boundary_friction: float, beta: float) -> Value:
    """Return the film ratio at which the uniform law has its minimum, nan where it has none."""
    load, given = np.broadcast_arrays(groups.load, groups.relative_roughness)
    kappa = np.clip(given, *FINITE_SPEED_ROUGHNESS)
    ratios = np.linspace(math.log(FILM_RATIO_RANGE[0]), math.log(FILM_RATIO_RANGE[1]), SEARCH_POINTS).reshape(
        -1, *(1,) * load.ndim
    )
    falling = _uniform_slopes(load, kappa, boundary_friction, beta, ratios) < 0
    last = SEARCH_POINTS - 1 - np.argmax(falling[::-1], axis=0)
    found = falling.any(axis=0) & (last < SEARCH_POINTS - 1) & (kappa == given)
    low = ratios.ravel()[np.minimum(last, SEARCH_POINTS - 2)]
    high = ratios.ravel()[np.minimum(last, SEARCH_POINTS - 2) + 1]
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        falls = _uniform_slopes(load, kappa, boundary_friction, beta, middle) < 0
        low, high = np.where(falls, middle, low), np.where(falls, high, middle)
    return np.where(found, np.exp(low), np.nan)[()]


def _uniform_merging(load: Value, boundary_friction: float, beta: float) -> Value:
    """Return the roughness from which the uniform law has no minimum, nan where that lies outside ROUGHNESS_RANGE."""
    low, high = (np.full(np.shape(load), math.log(end)) for end in ROUGHNESS_RANGE)

    def falls(log_kappa: Array) -> Flags:
        groups = Groups(1.0, load, load * np.exp(log_kappa))
        return np.isfinite(film_ratio_at_minimum(groups, boundary_friction, beta))

    inside = falls(low) & ~falls(high)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        there = falls(middle)
        low, high = np.where(there, middle, low), np.where(there, high, middle)
    return np.where(inside, load * np.exp(low), np.nan)[()]
