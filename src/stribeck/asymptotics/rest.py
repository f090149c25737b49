r"""The rough contact at rest, of large and of small indentation.

With the load fixed, all but a shift of the gap depends on kappa alone.

Source: [BP] Section "Quasistatic limit"; the second terms are ours.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.formula import Limit, Value, formula, second
from stribeck.contacts.groups import Groups
from stribeck.solids import hertz

large_indentation = partial(
    formula,
    uses=("load", "relative_roughness"),
    plane="rest",
    limits=(Limit("load", 1e-4, 0.5), Limit("relative_roughness", 0, 1e-2)),
    small="relative_roughness",
    error_order=1,
)


@large_indentation(
    undefined="from the edge of the contact outwards, where this has no value",
    worst=0.03,
    source="[BP] Eq. (central_region_contact)",
)
def gap(groups: Groups, x: Value, terms: int = 1) -> Value:
    r"""Return the gap in a rough contact at rest.

    .. math:: h = -\frac\kappa2 \ln\left[\bar F_N (1 - x^2)\right] \; \left(+ \frac{\kappa^2}{1 - x^2}\right)

    Compared with the solver up to 0.9 of the half-width; the edge has a layer of width kappa**(2/3).

    The second term is ours: the pressure :math:`-\kappa (1 - x^2)^{-1/2}` of next order, whose elastic gap is the first term.
    """
    kappa, below = groups.relative_roughness, below_one(x)
    leading: Array = -0.5 * kappa * np.log(groups.load * below)
    return leading + second(terms) * np.square(kappa) / below


@large_indentation(worst=0.03, source="[BP] Eq. (central_region_contact); the second term is ours")
def central_gap(groups: Groups, terms: int = 1) -> Value:
    r"""Return the gap at the centre of a rough contact at rest.

    .. math:: h(0) = -\frac\kappa2 \ln \bar F_N \; (+ \kappa^2)

    With both terms the error is -2.67 kappa**4, as measured.
    """
    return gap.function(groups, 0.0, terms)


@large_indentation(worst=1e-4, error_order=2, source="theory.md, section 7")
def offset(groups: Groups, terms: int = 1) -> Value:
    r"""Return the offset of a rough contact at rest.

    .. math:: z_0 = -\frac{1 + \ln 4}{4} + \kappa \left(\ln 2 - \tfrac12 \ln \bar F_N\right) \; (+ \tfrac13 \kappa^2)

    The energy of the contact per kappa**2 holds :math:`\tfrac\pi6 \ln(\kappa u_\mathrm{Hz})`, the logarithm of the pressure at
    the edge times the load there; its derivative with respect to the load is the second term.  With both terms the error is
    -0.178 kappa**4, as measured.
    """
    kappa = groups.relative_roughness
    leading: Array = hertz.HERTZ_OFFSET + kappa * (math.log(2) - 0.5 * np.log(groups.load))
    return leading + second(terms) * np.square(kappa) / 3


small_indentation = partial(
    formula,
    uses=("load", "relative_roughness"),
    plane="rest",
    limits=(Limit("load", 1e-8, 0.5), Limit("1/relative_roughness", 0, 0.1)),
    small="1/relative_roughness",
    error_order=1,
)


@small_indentation(worst=0.011, source="[BP] Eq. (separation_small_indentation); the second term is ours")
def gap_small_indentation(groups: Groups, x: Value, terms: int = 1) -> Value:
    r"""Return the gap at rest of a very rough contact, which is hardly deflected.

    .. math:: h = -\frac\kappa2 \ln \frac{\pi \bar F_N}{8 \kappa} \; \left(+ \tfrac14 \ln 2\right) + \frac{x^2}{2}

    Compared with the solver up to three standard deviations of the pressure, :math:`3 \kappa^{1/2}`.
    The second term is right at x = 0.
    """
    x = np.asarray(x, dtype=float)
    return central_gap_small_indentation.function(groups, terms) + np.square(x) / 2


@small_indentation(worst=0.009, source="[BP] Eq. (separation_small_indentation); the second term is ours")
def central_gap_small_indentation(groups: Groups, terms: int = 1) -> Value:
    r"""Return the gap at the centre of a very rough contact at rest.

    .. math:: h(0) = -\frac\kappa2 \ln \frac{\pi \bar F_N}{8 \kappa} \; \left(+ \tfrac14 \ln 2\right)

    The second term is the deflection under the Gaussian pressure, averaged over it, less that at the centre.
    """
    kappa = np.asarray(groups.relative_roughness)
    leading: Array = -0.5 * kappa * np.log(math.pi * groups.load / (8 * kappa))
    return leading + second(terms) * math.log(2) / 4


@small_indentation(worst=3e-4, error_order=2, source="ours, from [BP] Section 'Small indentation limit'")
def offset_small_indentation(groups: Groups) -> Value:
    r"""Return the offset of a very rough contact at rest.

    .. math:: z_0 = -\frac\kappa2 \ln \frac{\pi \bar F_N}{8 \kappa} + \tfrac14 \ln \kappa - \tfrac14 \gamma_E

    The central gap with both terms, less the deflection :math:`-\tfrac12 \langle \ln |y| \rangle` under a Gaussian of
    variance kappa.
    """
    kappa = np.asarray(groups.relative_roughness)
    deflection = -0.25 * (np.log(kappa / 2) - np.euler_gamma)
    return central_gap_small_indentation.function(groups, terms=2) - deflection


@small_indentation(
    uses=("relative_roughness",),
    worst=0.018,
    source="[BP] Section 'Small indentation limit', without its minus sign",
)
def contact_pressure_small_indentation(groups: Groups, x: Value, printed: bool = False) -> Value:
    r"""Return the contact pressure at rest of a very rough contact.

    .. math:: p_c = \left(\frac{\pi}{8 \kappa}\right)^{1/2} e^{-x^2/(2 \kappa)}

    printed : With the minus sign that is printed.
    """
    kappa = np.asarray(groups.relative_roughness)
    sign = -1.0 if printed else 1.0
    gaussian: Array = np.exp(-np.square(np.asarray(x, dtype=float)) / (2 * kappa))
    return sign * np.sqrt(math.pi / (8 * kappa)) * gaussian


def below_one(x: Value) -> Array:
    """Return 1 - x**2, nan outside the contact."""
    x = np.asarray(x, dtype=float)
    return np.where(np.abs(x) < 1, (1 - x) * (1 + x), np.nan)
