r"""The rough ball at rest, of large and of small indentation, and its edge.

The edge is that of the line with :math:`\pi\kappa/4` for :math:`\kappa` (:mod:`stribeck.asymptotics.edge_layer`).

Source: ours; theory.md, section 11.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics import rest
from stribeck.asymptotics.edge_layer import at_edge, coordinate, layer
from stribeck.asymptotics.formula import Limit, Value, second
from stribeck.contacts.groups import Groups

CATALAN = 0.915965594177219  # Catalan's constant.

# Coefficient of kappa**2 in the offset beside its logarithm, from states at kappa = 1e-2 and 1e-4; the logarithm is derived.
OFFSET_CONSTANT = 0.6532


GAUSS_RULE = np.polynomial.legendre.leggauss(40)  # Rule of the correction of the pressure, good to rounding.

_large_indentation = partial(rest.large_indentation, geometry="point")


@_large_indentation(
    undefined="from the edge of the contact outwards, where this has no value",
    worst=0.05,
    source="ours",
)
def gap(groups: Groups, x: Value, terms: int = 1) -> Value:
    r"""Return the gap in the contact of a rough ball at rest.

    .. math::

        h = -\kappa \ln\left[\bar F_N^{1/3} (1 - x^2)^{1/2}\right] \;
        \left(- \frac{\kappa^2 p_1(x)}{(1 - x^2)^{1/2}}\right), \qquad
        p_1 = -\frac{1}{(1-x^2)^{1/2}} - \frac12 \int_x^1 \frac{g'(t) \, dt}{(t^2-x^2)^{1/2}}, \quad
        g(t) = -1 + \frac{t \arcsin t - \pi/2}{(1-t^2)^{1/2}}

    Compared with the solver up to 0.9 of the radius; the edge has a layer of width kappa**(2/3).  Under the first term the
    half-space carries :math:`\kappa p_1` beside Hertz's pressure, by Abel's transform, and a ring at the edge.
    """
    x, below = np.asarray(x, dtype=float), rest.below_one(x)
    kappa = np.asarray(groups.relative_roughness)
    leading: Array = -kappa * (np.log(groups.load) / 3 + 0.5 * np.log(below))
    if second(terms) == 0:
        return leading
    inside = np.where(np.abs(x) < 1, x, 0.0)
    return np.asarray(leading - kappa**2 * pressure_correction(inside) / np.sqrt(below))


@_large_indentation(worst=0.062, source="ours")
def central_gap(groups: Groups, terms: int = 1) -> Value:
    r"""Return the gap in the middle of a rough ball at rest.

    .. math:: h(0) = -\frac\kappa3 \ln \bar F_N \; \left(+ \left[\tfrac12 + G\right] \kappa^2\right), \quad G = 0.915966

    With both terms the error is 0.0002 kappa at kappa = 0.01 and falls as kappa**3 and its logarithm.
    """
    kappa = np.asarray(groups.relative_roughness)
    leading: Array = -kappa * np.log(groups.load) / 3
    found: Value = (leading + second(terms) * (0.5 + CATALAN) * np.square(kappa))[()]
    return found


@_large_indentation(worst=2e-4, error_order=1.9, source="ours; theory.md, section 11")
def offset(groups: Groups, terms: int = 1) -> Value:
    r"""Return the offset of a rough ball at rest.

    .. math::

        z_0 = -1 + \kappa \left(1 - \tfrac13 \ln \bar F_N\right) \;
        \left(+ \kappa^2 \left[0.6532 - \frac{\pi^2}{48} \ln \kappa\right]\right)

    The ring at the edge has an energy, :math:`\tfrac{\pi^3}{24} \kappa^2 \ln \kappa`, whose derivative with respect to
    the load is the logarithm; the other number is measured.
    """
    kappa = np.asarray(groups.relative_roughness)
    leading: Array = -1 + kappa * (1 - np.log(groups.load) / 3)
    if second(terms) == 0:
        return leading[()]
    logarithm = np.log(np.where(kappa > 0, kappa, 1.0))
    found: Value = (leading + np.square(kappa) * (OFFSET_CONSTANT - math.pi**2 / 48 * logarithm))[()]
    return found


_at_edge = partial(
    at_edge,
    geometry="point",
    limits=(Limit("load", 1e-4, 0.5), Limit("relative_roughness", 1e-5, 1e-2)),
    source="ours, with the edge of the line",
)


@_at_edge(predicts="gap", uses=("load", "relative_roughness"), worst=0.012)
def edge_gap(groups: Groups, x: Value) -> Value:
    r"""Return the gap at the edge of the contact of a rough ball at rest.

    .. math::

        h = \kappa \left[-\tfrac13 \ln F - \tfrac13 \ln\frac{\pi\kappa}{4} + H(\xi)\right], \qquad
        \xi = \frac{|x| - 1 + \kappa}{(\pi\kappa/4)^{2/3}}

    H is the layer of the line, :func:`stribeck.asymptotics.edge_layer.layer`.  Compared within 5 widths of the edge.
    """
    kappa = groups.relative_roughness
    wide = np.multiply(math.pi / 4, kappa)
    return kappa * (-(np.log(groups.load) + np.log(wide)) / 3 + layer().gap(coordinate(x, 1 - kappa, wide)))


@_at_edge(predicts="contact_pressure", uses=("relative_roughness",), worst=0.07)
def edge_contact_pressure(groups: Groups, x: Value) -> Value:
    r"""Return the contact pressure at the edge of the contact of a rough ball at rest.

    .. math:: p_c = \left(\frac{\pi\kappa}{4}\right)^{1/3} e^{-H(\xi)}, \qquad
        \xi = \frac{|x| - 1 + \kappa}{(\pi\kappa/4)^{2/3}}

    Compared with the solver within 5 widths of the edge.
    """
    kappa = groups.relative_roughness
    wide = np.multiply(math.pi / 4, kappa)
    return np.power(wide, 1 / 3) * np.exp(-layer().gap(coordinate(x, 1 - kappa, wide)))


_small_indentation = partial(
    rest.small_indentation,
    geometry="point",
    limits=(Limit("load", 1e-7, 0.5), Limit("1/relative_roughness", 0, 0.2)),
    source="ours, as for the line",
)


@_small_indentation(worst=0.006, error_order=1.5)
def central_gap_small_indentation(groups: Groups, terms: int = 1) -> Value:
    r"""Return the gap in the middle of a very rough ball at rest, which is hardly deflected.

    .. math::

        h(0) = \kappa \ln\left(3 \kappa \bar F_N^{-1/3}\right) \;
        \left(+ \frac{4 - 2 \sqrt2}{3 (2 \pi \kappa)^{1/2}}\right)

    The pressure is Gaussian, :math:`e^{-r^2/(2\kappa)}/(3\kappa)`, on the rigid ball; the second term is the deflection in the
    middle less its mean over that pressure.
    """
    kappa = np.asarray(groups.relative_roughness)
    leading: Array = kappa * np.log(3 * kappa * np.power(groups.load, -1 / 3))
    return (leading + second(terms) * (4 - 2 * math.sqrt(2)) / (3 * np.sqrt(2 * math.pi * kappa)))[()]


@_small_indentation(worst=6e-5, error_order=3)
def offset_small_indentation(groups: Groups) -> Value:
    r"""Return the offset of a very rough ball at rest.

    .. math:: z_0 = \kappa \ln\left(3 \kappa \bar F_N^{-1/3}\right) - \frac{2}{3 (\pi \kappa)^{1/2}}

    The gap of the rigid ball less the mean of its deflection over the pressure.
    """
    kappa = np.asarray(groups.relative_roughness)
    return np.asarray(central_gap_small_indentation.function(groups) - 2 / (3 * np.sqrt(math.pi * kappa)))[()]


def pressure_correction(r: Array) -> Array:
    """Return p_1 at distances below one from the middle, the pressure under the gap of a rough contact over kappa."""
    r = np.asarray(r, dtype=float)[..., None]
    psi = math.pi / 4 * (GAUSS_RULE[0] + 1)
    # cos(theta) on the path, by which the distance from the edge is exact.
    away = np.sqrt((1 - r) * (1 + r)) * np.cos(psi)
    phi = np.arcsin(away)
    slope = (0.5 * np.sin(2 * phi) - phi + math.pi * np.sin(phi / 2) ** 2) / away**2
    integral = (slope / np.sqrt((1 - away) * (1 + away))) @ (math.pi / 4 * GAUSS_RULE[1])
    return np.asarray(-1 / np.sqrt((1 - r[..., 0]) * (1 + r[..., 0])) - 0.5 * integral)
