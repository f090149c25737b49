r"""Boundary lubrication of a ball: the load share of a slow fluid in a contact of small relative roughness.

As on the line, but the pressure :math:`P_1 \cos\theta` and the gap :math:`H_1 \cos\theta`, :math:`H_1 = P_1/(1-r^2)^{1/2}`,
that it opens go with the angle: the flow over that gap carries load.

Source: ours, as [BP] Appendix C and D for the line; theory.md, section 11.
"""

from __future__ import annotations

from functools import partial
from typing import Literal, get_args

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.documentation import described
from stribeck.asymptotics.formula import Limit, Value, checked_load, fluid_number, formula
from stribeck.asymptotics.point.logarithm import far_integral
from stribeck.asymptotics.point.rest import CATALAN
from stribeck.asymptotics.point.slow_contact import of_gap
from stribeck.contacts.cut_off import POISEUILLE
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Groups
from stribeck.quantities.units import checked_word

PhiForm = Literal["quadrature", "closed"]

HEAVY_LIMIT = 2 / 125  # phi A**3 as the load tends to one, A = -ln(F)/3.
LIGHT_LIMIT = 1 / 24  # phi A**6 as the load tends to zero.

# b1, b2, a1, a2 of the closed form of phi, by smallest maximum error.
CLOSED_FORM_COEFFICIENTS = (6.809, 3.505, 8.521, 10.584)

# Coefficients of kappa**(2/3), the width of the edges, relative, as polynomials in A: of the load share, the shear and the
# moment of the pressure.  They are fitted to states at loads 1e-4 to 0.5 and kappa 1e-5 to 0.03, whose errors have that power.
SHARE_EDGE_COEFFICIENTS = (-2.143, 3.779, 1.267)
SHEAR_EDGE_COEFFICIENTS = (1.566, 4.399, -0.658)
MOMENT_EDGE_COEFFICIENTS = (-0.845, 7.554, 0.835)

SLOW_RANGE = (Limit("load", 1e-4, 0.5), Limit("relative_roughness", 0, 0.03), Limit("slow_share", 0, 1e-3))


def gap_at_rest(load: Value, kappa: Value = 0.0) -> Array:
    """Return A, the gap in the middle of the contact at rest over kappa; nan from load 1 on."""
    bounded = np.where(np.less(load, 1), load, np.nan)
    return np.asarray(-np.log(bounded) / 3 + (0.5 + CATALAN) * np.asarray(kappa))


def phi_of(A: Array, form: PhiForm = "quadrature") -> Array:
    """Return :func:`phi` of a contact by its gap at rest."""
    if form == "quadrature":
        return of_gap(A, lambda contact: contact.share)
    b1, b2, a1, a2 = CLOSED_FORM_COEFFICIENTS
    a3 = b2 * (HEAVY_LIMIT / LIGHT_LIMIT) ** (1 / 3)
    # In 1/A, which does not overflow for very rough contacts.
    a = 1 / A
    return np.asarray(HEAVY_LIMIT * (a * a * (a * (a + b1) + b2) / (a * (a * (a + a1) + a2) + a3)) ** 3)


@described(
    "phi [-], of the shape of ``load``; nan, with a warning, from load 1 on.",
    raises="If a load is no positive finite number, or the form is unknown.",
    source="ours",
    form="The integral, or the closed form.",
)
def phi(load: Value, form: PhiForm = "quadrature") -> Value:
    r"""Return the auxiliary function of the fluid's load on a ball, F_f/F_N = lambda**2/kappa**4 phi.

    .. math::

        \phi &= -\frac34 \int_0^1 r^2 H_1 \frac{1 - 3 H_0^2 P_1'}{H_0^3} \, dr \\
        \phi_\mathrm{closed} &= \frac{2}{125 A^3} \left[\frac{1 + b_1 A + b_2 A^2}{1 + a_1 A + a_2 A^2 + a_3 A^3}\right]^3,
        \quad A = -\tfrac13 \ln \bar F_N

    The quadrature is good to 1e-11.  The closed form is within 0.25 % of it for loads 1e-300 to 0.997; it has both limits,
    :math:`\tfrac{2}{125} A^{-3}` as F -> 1, where the gap closes in the middle, and :math:`\tfrac1{24} A^{-6}` as F ->
    0, reached so slowly that this is 31 % too high at load 1e-30.
    """
    checked_word("form", form, get_args(PhiForm))
    return phi_of(gap_at_rest(checked_load(load, "point")), form)[()]


def edge_factor(load: Value, kappa: Value, coefficients: tuple[float, float, float]) -> Array:
    """Return the factor of the edges on an integral over the contact."""
    A = gap_at_rest(load)
    return np.asarray(1 + np.polynomial.polynomial.polyval(A, coefficients) * np.power(kappa, 2 / 3))


_slow = partial(formula, plane="mixed", geometry="point", limits=SLOW_RANGE)


@_slow(undefined="from load 1 on", worst=0.06, source="ours; the coefficients are fitted")
def fluid_load_share(groups: Groups, with_edges: bool = True, form: PhiForm = "quadrature") -> Value:
    r"""Return the load share of the fluid under a slow rough ball.

    .. math::

        \frac{F_f}{F_N} = \frac{\lambda^2}{\kappa^4} \, \phi\left(\bar F_N e^{-3 (\frac12 + G) \kappa}\right)
        \left[1 + (3.779 A + 1.267 A^2 - 2.143) \, \kappa^{2/3}\right], \qquad A = -\tfrac13 \ln \bar F_N

    with_edges : Whether with the bracket and the exponential, which go to one as kappa goes to zero.

    G is Catalan's constant, of the gap in the middle at rest.  Without the edges the limit is reached slowly: at load
    1e-3 the true share is larger by 2.5 % at kappa = 1e-4, 12 % at 1e-3, 54 % at 0.01 and 245 % at 0.1, as the fluid
    acts under the edges too. With them it is within 4 % for kappa up to 0.03.
    """
    number = fluid_number(groups)
    if not with_edges:
        return np.square(number) * phi_of(gap_at_rest(groups.load), form)
    F, kappa = groups.load, groups.relative_roughness
    return np.square(number) * phi_of(gap_at_rest(F, kappa), form) * edge_factor(F, kappa, SHARE_EDGE_COEFFICIENTS)


@_slow(undefined="from load 1 on", worst=2e-4, source="ours")
def contact_load_share(groups: Groups, with_edges: bool = True, form: PhiForm = "quadrature") -> Value:
    r"""Return the load share of the asperities under a slow rough ball.

    .. math:: \frac{F_c}{F_N} = 1 - \frac{F_f}{F_N}
    """
    return 1 - fluid_load_share.function(groups, with_edges, form)


@_slow(undefined="from load 1 on", worst=0.09, source="ours")
def viscous_friction(
    groups: Groups, beta: float = 1.0, definition: Definition = "balanced", wetted_radius: float | None = None
) -> Value:
    r"""Return the viscous friction under a slow rough ball.

    .. math::

        \mu_f &= \tfrac34 \beta \bar F_N^{1/3} \left[\frac\lambda\kappa S + \tfrac{16}{15} \pi \lambda \ln X_c
        \; \left(- \frac{\lambda}{\kappa^2} M\right)\right] \\
        S &= \left[1 + s \kappa^{2/3}\right] \pi \int_0^1 \left[\frac{r}{3 H_0} + \tfrac12 H_0 (r P_1)'\right] dr, \quad
        M = \left[1 + m \kappa^{2/3}\right] \pi \int_0^1 r^2 P_1 \, dr \\
        s &= 1.566 + 4.399 A - 0.658 A^2, \quad m = 7.554 A + 0.835 A^2 - 0.845

    The integrals are over the contact at the load of :func:`fluid_load_share`; s and m are fitted.
    """
    lambda_, F, kappa = groups.speed, groups.load, np.asarray(groups.relative_roughness)
    if beta == 0:
        return np.zeros(groups.shape)[()]
    A = gap_at_rest(F, kappa)
    J = lambda_ / kappa * edge_factor(F, kappa, SHEAR_EDGE_COEFFICIENTS) * of_gap(A, lambda contact: contact.shear)
    J = J + lambda_ * far_integral(groups.slope(beta), wetted_radius)
    if definition == "published":
        # A disc of liquid ends with a pressure at its rim.
        J = (
            J
            + (0.0 if wetted_radius is None else POISEUILLE) * lambda_
            - fluid_number(groups)
            * edge_factor(F, kappa, MOMENT_EDGE_COEFFICIENTS)
            * of_gap(A, lambda contact: contact.moment)
        )
    return (0.75 * beta * np.power(F, 1 / 3) * J)[()]


@_slow(limits=(*SLOW_RANGE, Limit("beta/mu0", 0.0, 1.0)), undefined="from load 1 on", worst=1e-3, source="ours")
def friction(
    groups: Groups,
    boundary_friction: float = 1.0,
    beta: float = 1.0,
    definition: Definition = "balanced",
    wetted_radius: float | None = None,
) -> Value:
    r"""Return the friction of a ball in boundary lubrication.

    .. math:: \mu = \mu_0 \frac{F_c}{F_N} + \mu_f
    """
    viscous = viscous_friction.function(groups, beta, definition, wetted_radius)
    return boundary_friction * contact_load_share.function(groups) + viscous
