r"""The force on a sphere that slides along a plane in Stokes flow, for the constant in the friction of a whole ball.

In cylindrical coordinates about the axis through the sphere (radius 1, speed 1 along x, viscosity 1) every flow has
harmonic Q, W, U_0, U_2 of the angular orders 1, 1, 0, 2 with

.. math::

    u_\rho = \tfrac12 \left[\frac{\rho Q}{c} + U_2 + U_0\right] \cos\phi, \quad
    u_\phi = \tfrac12 (U_2 - U_0) \sin\phi, \quad u_z = \tfrac12 \left[\frac{z Q}{c} + 2 W\right] \cos\phi .

They are series in bispherical coordinates, whose coefficients follow by collocation from the speeds on both surfaces and from
:math:`\nabla \cdot u = 0` there, which suffices as the divergence is harmonic.

Source: W. R. Dean and M. E. O'Neill, Mathematika 10 (1963) 13, and M. E. O'Neill, Mathematika 11 (1964) 67.
"""

from __future__ import annotations

import math

import numpy as np

from stribeck._types import Array, Indices

Series = tuple[Array, Array, Array]
Factors = tuple[Array | float, ...]

# Angular orders of the series: sinh of W; cosh and sinh of Q, of U_0, of U_2; each begins with the term of its order.
ANGULAR_ORDERS = {"A": 1, "B": 1, "C": 1, "D": 0, "E": 0, "F": 2, "G": 2}

# Terms of the series times the bispherical coordinate of the sphere; what is left out is below 1e-8.
SERIES_TERMS = 22

# Bispherical coordinates arcosh(1 + gap) at which the constant is fitted: gaps 0.34 to 0.0098 of the radius.
BISPHERICAL_COORDINATES = (0.8, 0.6, 0.45, 0.35, 0.28, 0.22, 0.18, 0.14)


def force(gap: float, turning: bool = False) -> float:
    """Return the force over 6 pi eta R U on a sphere at a gap [R] from a plane, sliding or turning at U."""
    alpha = math.acosh(1 + gap)
    c = math.sinh(alpha)
    count = int(SERIES_TERMS / alpha)
    eta = (np.arange(count) + 0.5) / count * math.pi
    mu, sine = np.cos(eta), np.sin(eta)
    P = _legendre(count + 2, mu)
    place = {name: slice(k * count, (k + 1) * count) for k, name in enumerate(ANGULAR_ORDERS)}
    rows: list[Array] = []
    right: list[Array] = []

    def add(series: dict[str, Series], terms: dict[str, Factors], value: Array | float) -> None:
        row = np.zeros((count, 7 * count))
        for name, factors in terms.items():
            for factor, part in zip(factors, series[name], strict=False):
                row[:, place[name]] += np.broadcast_to(factor, (count,))[:, None] * part
        rows.append(row)
        right.append(np.broadcast_to(value, (count,)))

    for xi in (0.0, alpha):
        G = math.cosh(xi) - mu
        rho, z = c * sine / G, c * math.sinh(xi) / G
        z_xi, z_eta = c * (1 - math.cosh(xi) * mu) / G**2, -c * math.sinh(xi) * sine / G**2
        by_rho, by_z = (z_eta * (G / c) ** 2, -z_xi * (G / c) ** 2), (z_xi * (G / c) ** 2, z_eta * (G / c) ** 2)
        series = {
            name: _series(P, xi, alpha, mu, sine, m, np.arange(m, m + count), name in "ACEG")
            for name, m in ANGULAR_ORDERS.items()
        }
        half = rho / (2 * c)
        across = np.zeros(count) if not xi else z - math.cosh(alpha) if turning else np.ones(count)
        add(series, {"D": (1.0,), "E": (1.0,), "B": (half,), "C": (half,)}, 2 * across)
        add(series, {"F": (1.0,), "G": (1.0,), "B": (half,), "C": (half,)}, 0.0)
        if xi:
            add(series, {"A": (1.0,), "B": (z / (2 * c),), "C": (z / (2 * c),)}, -rho if turning else 0.0)
        pressure = (3.0, rho * by_rho[0] + z * by_z[0], rho * by_rho[1] + z * by_z[1])
        plain, twice = (0.0, c * by_rho[0], c * by_rho[1]), (2 * c / rho, c * by_rho[0], c * by_rho[1])
        upward = (0.0, 2 * c * by_z[0], 2 * c * by_z[1])
        add(series, {"A": upward, "B": pressure, "C": pressure, "D": plain, "E": plain, "F": twice, "G": twice}, 0.0)

    matrix = np.concatenate(rows)
    columns = np.abs(matrix).max(axis=0)
    matrix = matrix / columns
    lines = np.abs(matrix).max(axis=1)
    found = np.linalg.solve(matrix / lines[:, None], np.concatenate(right) / lines) / columns
    n_E, n_C = np.arange(count), np.arange(1, count + 1)
    E = found[place["E"]] * np.exp(-(n_E + 0.5) * alpha)
    C = found[place["C"]] * np.exp(-(n_C + 0.5) * alpha)
    return float(math.sqrt(2) / 6 * c * (E.sum() + (n_C * (n_C + 1) * C).sum()))


def wall_constant(turning: bool = False) -> float:
    r"""Return K of :math:`\tfrac{8}{15} \ln(1/\epsilon) + K + O(\epsilon \ln \epsilon)`, the force at small gaps.

    For a turning sphere K' of :math:`\tfrac{2}{15} \ln(1/\epsilon) + K'`, against the motion of its lowest point.
    """
    gaps = np.cosh(BISPHERICAL_COORDINATES) - 1
    sign, coefficient = (-1, 2 / 15) if turning else (1, 8 / 15)
    rest = sign * np.array([force(float(gap), turning) for gap in gaps]) + coefficient * np.log(gaps)
    logs = np.log(gaps)
    terms = np.stack([np.ones_like(gaps), gaps * logs, gaps, gaps**2 * logs, gaps**2], axis=1)
    return float(np.linalg.lstsq(terms, rest, rcond=None)[0][0])


def _legendre(count: int, mu: Array) -> tuple[Array, Array, Array, Array]:
    """Return Legendre's polynomials 0 .. count - 1 and three derivatives, each of shape (count, points)."""
    P, first, second, third = (np.zeros((count, mu.size)) for _ in range(4))
    P[0], P[1] = 1.0, mu
    for n in range(1, count - 1):
        P[n + 1] = ((2 * n + 1) * mu * P[n] - n * P[n - 1]) / (n + 1)
    for lower, higher in ((P, first), (first, second), (second, third)):
        for n in range(1, count):
            higher[n] = (higher[n - 2] if n > 1 else 0.0) + (2 * n - 1) * lower[n - 1]
    return P, first, second, third


def _series(P: tuple[Array, ...], xi: float, alpha: float, mu: Array, sine: Array, m: int, n: Indices, odd: bool) -> Series:
    """Return the terms n of a harmonic function of angular order m, and their derivatives by xi and eta."""
    q = np.sqrt(math.cosh(xi) - mu)
    shape = sine**m * P[m][n]
    turned = (m * sine ** (m - 1) * mu * P[m][n] if m else 0.0) - sine ** (m + 1) * P[m + 1][n]
    k = n + 0.5
    # Scaled by their growth, so that no term overflows.
    grow, fall = np.exp(k * (xi - alpha)), np.exp(-k * (xi + alpha))
    even_part, odd_part = 0.5 * (grow + fall), 0.5 * (grow - fall)
    f, slope = (odd_part, k * even_part) if odd else (even_part, k * odd_part)
    value = q * shape * f[:, None]
    by_xi = math.sinh(xi) / (2 * q) * shape * f[:, None] + q * shape * slope[:, None]
    by_eta = sine / (2 * q) * shape * f[:, None] + q * turned * f[:, None]
    return value.T, by_xi.T, by_eta.T
