r"""Slow speed at a rough contact of small relative roughness: the fields to second order in the speed, and the fluid's load.

With gaps in kappa u_Hz all depend on the load alone: :math:`H_0 = A + g`, :math:`A = -\tfrac12 \ln F`,
:math:`g = -\tfrac12 \ln(1 - x^2)`.  Integrals to the edge are taken in :math:`v`, :math:`x = \tanh(\delta \sinh v)` with
:math:`\delta = \arccos F^{1/2}`: there the zeros of :math:`H_0` lie at :math:`v = \pm i \pi/2` whatever the load, so that one
set of panels serves them all.

Source: [BP] Appendix C and D, with the cubes that the former lacks; theory.md, section 7; the quadrature is ours.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal, get_args

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.documentation import described
from stribeck.asymptotics.formula import Limit, Value, checked_load, fluid_number, formula
from stribeck.asymptotics.rest import below_one
from stribeck.contacts.groups import Groups
from stribeck.numerics.panels import reference
from stribeck.quantities.units import checked_word

PhiForm = Literal["quadrature", "closed", "asymptote", "power", "printed"]

LIGHT_LIMIT = 96 - 128 * math.log(2)  # phi (-ln F)**6 as F -> 0.

# Least-squares fit of ln(phi (-ln F)**5) over loads 1e-5 to 1e-1; [BP] print 0.510 = 0.325 pi/2.
POWER_COEFFICIENT = 0.325

CLOSED_FORM_COEFFICIENTS = (6.055, 4.462, 4.861, 1.498)  # a1, a2, b1, b2 of the closed form of phi, by smallest maximum error.

NODES_PER_PANEL = 16  # Gauss points of a panel: phi errs by 1e-13 for loads up to 1 - 1e-6.
PANELS = 14  # Panels of the integrals.
DOMAIN_LENGTH = 19.0  # Length of the integrals in artanh(x): 1e-16 of the whole is left out.
LOADS_PER_BLOCK = 256  # Loads that are integrated in one block, to bound the memory.


@dataclass(frozen=True)
class Outward:
    """The contact from positions x >= 0 to its edge, on Gauss nodes in two axes behind those of load and position.

    ``A`` is -1/2 ln F, ``g`` the gap over it, ``g_star`` the flux gap over it, ``weights`` those of dx.
    """

    A: Array
    x: Array
    p_0: Array
    g: Array
    weights: Array
    g_star: Array

    @property
    def H(self) -> Array:
        """The gap H_0 at rest."""
        return self.A + self.g

    def integral(self, integrand: Array) -> Array:
        """Return the integral over x to the edge."""
        return np.asarray((self.weights * integrand).sum((-1, -2)))

    def first(self, power: int = 3) -> Array:
        """Return (H_0 - H_0*)/H_0**power, the slope of P_f1."""
        return np.asarray((self.g - self.g_star) / self.H**power)

    def second(self) -> Array:
        """Return (3 H_0* - 2 H_0) H_1/H_0**4, the slope of P_f2."""
        rule = reference(NODES_PER_PANEL)
        slope = self.first() * self.weights / rule.weights
        panels = slope @ rule.weights
        from_here = panels[..., ::-1].cumsum(-1)[..., ::-1]
        P_1 = slope @ rule.integral.T - from_here[..., None]
        return np.asarray((self.A + 3 * self.g_star - 2 * self.g) * P_1 / (self.p_0 * self.H**4))


def outward(A: Value, x: Value | None = None) -> Outward:
    """Return the contact from a position inside it, or from its centre, to its edge at -1/2 ln F = A."""
    whole = _panels(np.asarray(A, dtype=float)[..., None, None], np.zeros((1, 1)))
    H_cubed = whole.H**3
    g_star = whole.integral(whole.g / H_cubed) / whole.integral(1 / H_cubed)
    if x is None:
        return replace(whole, g_star=g_star[..., None, None])
    start = np.arctanh(np.abs(np.asarray(x, dtype=float)))[..., None, None]
    return replace(_panels(whole.A, start), g_star=g_star[..., None, None])


def _panels(A: Array, start: Array) -> Outward:
    rule = reference(NODES_PER_PANEL)
    delta = np.arcsin(np.sqrt(-np.expm1(-2 * A)))
    v, end = np.arcsinh(start / delta), np.arcsinh((start + DOMAIN_LENGTH) / delta)
    half = (end - v) / (2 * PANELS)
    v = v + half * (2 * np.arange(PANELS)[:, None] + 1 + rule.nodes)
    u = delta * np.sinh(v)
    p_0 = 1 / np.cosh(u)
    # ln cosh u, exact also where u is small.
    g = np.log1p(2 * np.sinh(u / 2) ** 2)
    return Outward(A, np.tanh(u), p_0, g, rule.weights * half * delta * np.cosh(v) * p_0**2, np.zeros(()))


def half_logarithm(load: Value) -> Array:
    """Return -1/2 ln F, nan where there is no positive gap."""
    A = -0.5 * np.log(load)
    return np.where(A > 0, A, np.nan)


def of_load(load: Value, function: Callable[[Outward], Array]) -> Value:
    """Return a number for each load from its contact; equal loads are computed once."""
    A = half_logarithm(load)
    different, where = np.unique(A, return_inverse=True)
    parts = [different[i : i + LOADS_PER_BLOCK] for i in range(0, different.size, LOADS_PER_BLOCK)]
    found = np.concatenate([function(outward(part)) for part in parts] or [different])
    values: Value = found[where.reshape(A.shape)][()]
    return values


def phi_of(load: Value, form: PhiForm = "quadrature") -> Value:
    """Return :func:`phi` without its warning for loads of 1 or more, for formulas that warn themselves."""
    if form == "quadrature":
        # By parts, -(2/pi) int x P_f2' dx.
        return of_load(load, lambda c: -4 / math.pi * c.integral(c.x * c.second()))
    L = 2 * half_logarithm(load)
    if form == "closed":
        a1, a2, b1, b2 = CLOSED_FORM_COEFFICIENTS
        a3 = b2 * (1.5 * LIGHT_LIMIT) ** -0.4
        ratio: Array = (1 + L * (b1 + L * b2)) / (1 + L * (a1 + L * (a2 + L * a3)))
        return 2 / 3 * ratio**2.5 * L**-3.5
    if form == "asymptote":
        return LIGHT_LIMIT * L**-6
    if form == "power":
        return POWER_COEFFICIENT * L**-5
    return 0.5 * L**5


@described(
    "phi [-], of the shape of ``load``; nan, with a warning, from load 1 on.",
    raises="If a load is no positive finite number, or the form is unknown.",
    source="[BP] Eq. (fluid-normal-dl) and Appendix D",
    form="The integral; closed form; its limit :math:`(96 - 128 \\ln 2)/L^6`; :math:`0.325/L^5`; the printed :math:`L^5/2`.",
)
def phi(load: Value, form: PhiForm = "quadrature") -> Value:
    r"""Return the auxiliary function of the fluid's load, F_f/F_N = lambda**2/kappa**4 phi.

    .. math::

        \phi &= \frac2\pi \int_{-1}^1 P_{f,2} \, dx \\
        \phi_\mathrm{closed} &= \frac{2}{3 L^{7/2}}
        \left[\frac{1 + b_1 L + b_2 L^2}{1 + a_1 L + a_2 L^2 + a_3 L^3}\right]^{5/2}, \quad L = -\ln \bar F_N

    The quadrature is good to 1e-12 for loads 1e-300 to 0.999999.  The closed form is within 0.33 % of it for all these; it has
    both limits, :math:`\tfrac23 L^{-7/2}` as F -> 1, where phi diverges as the gap closes at x = 0, and the asymptote as
    F -> 0.  That is reached so slowly that it is 2.5 times too high at load 1e-4, by 45 % at 1e-12 and by 1.7 % at 1e-300.
    The power is within 12 % for loads 1e-5 to 1e-1, and 78 % too high at 1e-12.  Closed form and limits are ours.

    [BP] lack 2/pi, and print the power with a positive exponent in Eq. (phi_approximation).
    """
    checked_word("form", form, get_args(PhiForm))
    return phi_of(checked_load(load, "line"), form)


@described("M [-], of the shape of ``load``; nan from load 1 on.", source="theory.md, section 6, with [BP] Appendix D")
def pressure_moment(load: Value) -> Value:
    r"""Return the moment of the fluid pressure of first order, equal and opposite to that of the contact pressure.

    .. math:: M = -\int_{-1}^1 x \, P_{f,1} \, dx = \int_0^1 x^2 \, \frac{H_0 - H_0^*}{H_0^3} \, dx
    """
    return of_load(load, lambda c: c.integral(c.x**2 * c.first()))


@described(
    "S [-], of the shape of ``load``; nan from load 1 on.",
    source="theory.md, section 6, with the gap of [BP] Eq. (central_region_contact)",
)
def shear(load: Value) -> Value:
    r"""Return the shear stress on the substrate, integrated.

    .. math:: S = \int_{-1}^1 \frac{1}{H_0} \left[1 + 3 \frac{H_0 - H_0^*}{H_0}\right] dx
    """
    return of_load(load, lambda c: 2 * c.integral(1 / c.H + 3 * c.first(2)))


_expansion = partial(formula, plane="mixed", undefined="from load 1 on", small="relative_roughness", error_order=2 / 3)


@_expansion(
    uses=("load", "relative_roughness"),
    plane="rest",
    limits=(Limit("load", 1e-4, 0.5), Limit("relative_roughness", 0, 1e-3)),
    worst=0.009,
    source="[BP] Appendix D",
)
def flux_gap(groups: Groups) -> Value:
    r"""Return the flux gap of a slow rough contact.

    .. math:: h^* = \kappa H_0^*, \quad H_0^* = \frac{\int_{-1}^1 H_0^{-2} dx}{\int_{-1}^1 H_0^{-3} dx}

    It has no term of first order in the speed.
    """
    return groups.relative_roughness * of_load(groups.load, lambda c: np.asarray((c.A + c.g_star)[..., 0, 0]))


@_expansion(
    limits=(Limit("load", 1e-4, 0.5), Limit("relative_roughness", 0, 1e-4), Limit("paper_fluid_share", 0, 1e-4)),
    worst=0.07,
    source="[BP] Eqs. (first-order_thin-film) and (pf1), which lack the cube that Appendix D has",
)
def fluid_pressure_first(groups: Groups, x: Value, printed: bool = False) -> Value:
    r"""Return the fluid pressure to first order in the speed, odd in x.

    .. math:: p_f = \frac{\lambda}{\kappa^2} P_{f,1}(x), \quad P_{f,1} = \int_{-1}^x \frac{H_0 - H_0^*}{H_0^3} \, dy

    printed :
        With the denominator as printed in Appendix C, h_0 for its cube; then the pressure behind the contact is not zero.

    Zero outside the contact.
    """
    scale = groups.speed if printed else fluid_number(groups)
    return scale * _first_pressure(groups.load, x, 1 if printed else 3)


def _first_pressure(load: Value, x: Value, power: int = 3) -> Array:
    """Return the integral of (H_0 - H_0*)/H_0**power from -1 to x, or to 1 beyond."""
    A, x = half_logarithm(load), np.asarray(x, dtype=float)
    inside = np.abs(x) < 1
    contact = outward(A, np.where(inside, x, 0.0))
    centre = outward(A)
    half = 0.0 if power == 3 else centre.integral(centre.first(power))
    beyond = np.where(inside, contact.integral(contact.first(power)), np.where(np.isnan(A), A, 0.0))
    return np.where(x < 0, beyond, 2 * half - beyond)


@_expansion(
    limits=(Limit("load", 1e-4, 0.5), Limit("relative_roughness", 0, 1e-3), Limit("paper_fluid_share", 0, 0.1)),
    undefined="outside the contact, where this has no value, and from load 1 on",
    worst=0.06,
    error_order=1,
    source="[BP] Eqs. (central_region_contact) and (h1)",
)
def gap_first(groups: Groups, x: Value) -> Value:
    r"""Return the gap in the contact to first order in the speed.

    .. math:: h = \kappa H_0 + \frac{\lambda}{\kappa} H_1, \quad H_1 = \frac{P_{f,1}}{(1 - x^2)^{1/2}}

    The part odd in x is the second term.  [BP] print h_1 ~ kappa for 1/kappa, and the step function of p_0 the wrong way
    round.
    """
    below, kappa = below_one(x), np.asarray(groups.relative_roughness)
    H_0 = half_logarithm(groups.load) - 0.5 * np.log(below)
    return kappa * H_0 + groups.speed / kappa * _first_pressure(groups.load, x) / np.sqrt(below)


@_expansion(
    limits=(Limit("load", 1e-4, 0.5), Limit("relative_roughness", 0, 1e-4), Limit("paper_fluid_share", 0, 0.01)),
    worst=0.085,
    source="[BP] Eqs. (pf1), with cubed denominator, and (p2)",
)
def fluid_pressure_second(groups: Groups, x: Value) -> Value:
    r"""Return the fluid pressure to second order in the speed.

    .. math::

        p_f = \frac{\lambda}{\kappa^2} P_{f,1} + \frac{\lambda^2}{\kappa^4} P_{f,2}, \quad
        P_{f,2} = \int_{-1}^x \frac{(3 H_0^* - 2 H_0) H_1}{H_0^4} \, dy

    Zero outside the contact.  The part even in x is the second term, which carries load.
    """
    number = fluid_number(groups)
    A, x = half_logarithm(groups.load), np.asarray(x, dtype=float)
    inside = np.abs(x) < 1
    contact = outward(A, np.where(inside, x, 0.0))
    second = np.where(inside, -contact.integral(contact.second()), 0.0)
    return np.asarray(number * _first_pressure(groups.load, x) + np.square(number) * second)
