r"""Boundary lubrication of a ball: the load share of a slow fluid in a contact of small relative roughness.

With gaps in :math:`\kappa u_\mathrm{Hz}`, :math:`H_0 = A - \tfrac12 \ln(1 - r^2)`, :math:`A = -\tfrac13 \ln F`, the pressure
:math:`p_f = (\lambda/\kappa^2) P_1(r) \cos\theta` obeys

.. math:: \frac1r (r H_0^3 P_1')' - \frac{H_0^3}{r^2} P_1 = H_0', \qquad P_1(0) = P_1(1) = 0 ,

and the gap :math:`H_1 \cos\theta`, :math:`H_1 = P_1/(1-r^2)^{1/2}`, that it opens goes with the angle too: the flow over that
gap carries load.  All of it depends on the load alone.  The coordinate is that of the line
(:mod:`stribeck.asymptotics.perturbation`), :math:`r = \tanh(\delta \sinh v)` with :math:`\cos\delta = e^{-A}`; spectral
elements in v; beyond, where :math:`1 - r^2 < 10^{-16}`, nothing is left.

Source: ours, as [BP] Appendix C and D for the line; theory.md, section 11.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Literal, get_args

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.documentation import described
from stribeck.asymptotics.formula import Limit, Value, checked_load, fluid_number, formula
from stribeck.asymptotics.point.rest import CATALAN
from stribeck.contacts.cut_off import COUETTE, FAR_FILM_MIN_RADIUS, FULL_FAR_FILM, POISEUILLE, far_logarithms, log_cut_offs
from stribeck.contacts.friction import Definition
from stribeck.contacts.groups import Groups
from stribeck.numerics.fourier_panels import lobatto
from stribeck.quantities.units import InputError, checked_word, real_array, show

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

ELEMENT_DEGREE = 16  # Degree of the elements: the integrals err by 1e-12 for loads up to 1 - 1e-3.
ELEMENTS = 12  # Number of the elements.
DOMAIN_LENGTH = 19.0  # Length of the integrals in artanh(r): 1e-16 of the whole is left out.
MAX_GAP = 1e50  # A up to which powers of the gap stay in double precision; above it the integrals are zero.

LOGARITHM_COEFFICIENT = COUETTE + POISEUILLE  # Coefficient of lambda ln X, 16 pi/15.


@dataclass(frozen=True)
class Slow:
    """The contact from its middle to its edge at the nodes of the elements, shape (elements, nodes).

    ``r``, ``H``, ``p_0``: distance, gap at rest, pressure at rest; ``P``, ``slope``: P_1 and its derivative; ``weights``:
    those of dr.
    """

    r: Array
    H: Array
    p_0: Array
    P: Array
    slope: Array
    weights: Array

    def integral(self, integrand: Array) -> float:
        """Return the integral over r from the middle to the edge."""
        return float((self.weights * integrand).sum())

    def share(self) -> float:
        """Return the fluid's share of the load over lambda**2/kappa**4, phi."""
        return -0.75 * self.integral(self.r**2 * self.P / self.p_0 * (1 - 3 * self.H**2 * self.slope) / self.H**3)

    def shear(self) -> float:
        r"""Return the balanced shear over lambda/kappa, :math:`\pi \int [r/(3 H_0) + \tfrac12 H_0 (r P_1)'] dr`."""
        return np.pi * self.integral(self.r / (3 * self.H) + 0.5 * self.H * (self.r * self.slope + self.P))

    def moment(self) -> float:
        r"""Return the moment of the fluid's pressure over lambda/kappa**2, :math:`\pi \int r^2 P_1 dr`."""
        return np.pi * self.integral(self.r**2 * self.P)


@lru_cache(maxsize=512)
def slow_contact(A: float) -> Slow:
    """Return the contact at -1/3 ln F = A > 0."""
    rule = lobatto(ELEMENT_DEGREE)
    delta = np.arcsin(np.sqrt(-np.expm1(-2 * A)))
    edges = np.linspace(0.0, np.arcsinh(DOMAIN_LENGTH / delta), ELEMENTS + 1)
    half = 0.5 * (edges[1] - edges[0])
    v = edges[:-1, None] + half * (rule.nodes + 1)
    u = delta * np.sinh(v)
    r, p_0 = np.tanh(u), 1 / np.cosh(u)
    H = A + np.log1p(2 * np.sinh(u / 2) ** 2)
    stretch = half * delta * np.cosh(v) * p_0**2
    weights = rule.weights * stretch
    d_dr = rule.derivative / stretch[..., None]
    n = ELEMENTS * ELEMENT_DEGREE + 1
    matrix, right = np.zeros((n, n)), np.zeros(n)
    for k in range(ELEMENTS):
        place = slice(k * ELEMENT_DEGREE, (k + 1) * ELEMENT_DEGREE + 1)
        matrix[place, place] -= d_dr[k].T @ ((weights[k] * r[k] * H[k] ** 3)[:, None] * d_dr[k])
        # The node in the middle has P = 0.
        matrix[place, place] -= np.diag(weights[k] * H[k] ** 3 / np.where(r[k] > 0, r[k], 1.0))
        right[place] += weights[k] * r[k] ** 2 / p_0[k] ** 2
    P = np.zeros(n)
    P[1:-1] = np.linalg.solve(matrix[1:-1, 1:-1], right[1:-1])
    local = np.stack([P[k * ELEMENT_DEGREE : (k + 1) * ELEMENT_DEGREE + 1] for k in range(ELEMENTS)])
    slope = np.einsum("kij,kj->ki", d_dr, local)
    return Slow(r, H, p_0, local, slope, weights)


def of_gap(A: Value, number: Callable[[Slow], float]) -> Array:
    """Return a number for each A from its contact, equal ones once; nan where A is no finite positive number."""
    gaps = np.asarray(A, dtype=float)
    different, where = np.unique(gaps, return_inverse=True)
    found = [number(slow_contact(each)) if 0 < each < MAX_GAP else np.nan for each in different.tolist()]
    return np.asarray(np.array(found)[where.reshape(gaps.shape)])


def gap_at_rest(load: Value, kappa: Value = 0.0) -> Array:
    """Return A, the gap in the middle of the contact at rest over kappa; nan from load 1 on."""
    bounded = np.where(np.less(load, 1), load, np.nan)
    return np.asarray(-np.log(bounded) / 3 + (0.5 + CATALAN) * np.asarray(kappa))


def phi_of(A: Array, form: PhiForm = "quadrature") -> Array:
    """Return :func:`phi` of a contact by its gap at rest."""
    if form == "quadrature":
        return of_gap(A, Slow.share)
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


def edge_factor(A: Array, kappa: Value, coefficients: tuple[float, float, float]) -> Array:
    """Return the factor of the edges on an integral over the contact, by its gap at rest without roughness."""
    return np.asarray(1 + np.polynomial.polynomial.polyval(A, coefficients) * np.power(kappa, 2 / 3))


_slow = partial(formula, plane="mixed", geometry="point", limits=SLOW_RANGE, undefined="from load 1 on")


@_slow(worst=0.06, source="ours; the coefficients are fitted")
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
    return (
        np.square(number) * phi_of(gap_at_rest(F, kappa), form) * edge_factor(gap_at_rest(F), kappa, SHARE_EDGE_COEFFICIENTS)
    )


@_slow(worst=2e-4, source="ours")
def contact_load_share(groups: Groups, with_edges: bool = True, form: PhiForm = "quadrature") -> Value:
    r"""Return the load share of the asperities under a slow rough ball.

    .. math:: \frac{F_c}{F_N} = 1 - \frac{F_f}{F_N}
    """
    return 1 - fluid_load_share.function(groups, with_edges, form)


@_slow(worst=0.09, source="ours")
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
    A_0, kappa = gap_at_rest(groups.load), np.asarray(groups.relative_roughness)
    A = gap_at_rest(groups.load, kappa)
    J = groups.speed / kappa * edge_factor(A_0, kappa, SHEAR_EDGE_COEFFICIENTS) * of_gap(A, Slow.shear)
    if definition == "published":
        J = J - fluid_number(groups) * edge_factor(A_0, kappa, MOMENT_EDGE_COEFFICIENTS) * of_gap(A, Slow.moment)
    return friction_of(groups, J, beta, definition, wetted_radius)[()]


@_slow(limits=(*SLOW_RANGE, Limit("beta/mu0", 0.0, 1.0)), worst=1e-3, source="ours")
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


def far_integral(slope: Value, wetted_radius: Value | None = None, film: Value = 0.0) -> Array:
    r"""Return what the liquid around the contact adds to the friction integral, over the speed group.

    .. math:: \tfrac{16}{15} \pi \ln X + \tfrac{8}{15} \pi \ln(1 + y) + \tfrac25 \pi \frac{y}{1 + y}, \quad y = 2 h(0)/X^2

    The gap in the middle h(0), ``film``, counts where it is no longer thin beside the gap at the wetted radius X.  One surface
    rests; source: :mod:`stribeck.contacts.cut_off`.
    """
    radius: Value = math.inf
    if wetted_radius is not None:
        radius = real_array("wetted_radius", wetted_radius)
        if not np.all((radius >= FAR_FILM_MIN_RADIUS) & (radius < math.inf)):
            raise InputError(
                f"wetted_radius = {show(wetted_radius)}; in Hertz radii it must be {FAR_FILM_MIN_RADIUS:g} or more, where the "
                "film does not feel the contact. Use solve for smaller drops."
            )
    with np.errstate(divide="ignore"):
        logarithms = log_cut_offs(np.asarray(slope, dtype=float), radius)
        start = -0.5 * np.log(2.0 * np.asarray(film))
    by_shear, by_pressure, _ = far_logarithms(*logarithms, start, FULL_FAR_FILM.rise)
    return np.asarray(COUETTE * by_shear + POISEUILLE * by_pressure)


def friction_of(
    groups: Groups, J: Value, beta: float, definition: Definition, wetted_radius: float | None, film: Value = 0.0
) -> Array:
    """Return the friction coefficient of the finite part J of a friction integral, with the liquid around the contact."""
    if beta == 0:
        return np.zeros(np.shape(J))
    J = J + np.multiply(groups.speed, far_integral(groups.slope(beta), wetted_radius, film))
    if definition == "published" and wetted_radius is not None:
        # A disc of liquid ends with a pressure at its rim.
        J = J + POISEUILLE * np.asarray(groups.speed) / (1.0 + 2.0 * film / np.square(wetted_radius))
    return np.asarray(0.75 * beta * np.power(groups.load, 1 / 3) * J)
