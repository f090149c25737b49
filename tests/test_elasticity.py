"""Deflection of the half-space: exact pairs of pressure and deflection, the log moments, spectral rates."""

import numpy as np
import pytest
from scipy.integrate import quad

from stribeck.numerics.panels import Mesh, base_edges
from stribeck.solids import hertz
from stribeck.solids.half_plane import deflection_operator, log_moments

pytestmark = pytest.mark.quick

SEED = 31_337


# Exact pairs


def lorentz(x):
    return 1 / (1 + x * x)


def lorentz_deflection(x):
    return -0.5 * np.log1p(x * x)


def hertz_pressure(x, e):
    """The Hertz pressure seen from the height e: smooth, with edges of width e."""
    z = x + 1j * e
    return (np.sqrt(z - 1) * np.sqrt(z + 1) - z).imag


def hertz_deflection(x, e):
    """Its deflection, but for a constant."""
    z = x + 1j * e
    s = np.sqrt(z - 1) * np.sqrt(z + 1)
    return -(z * z / 2 - (z * s - np.log(z + s)) / 2).real


def graded_to_both_edges(width, order):
    """Panels that halve towards x = -1 and x = 1 down to ``width``."""
    steps = 0.5 ** np.arange(1, 2 + int(np.ceil(-np.log2(width))))
    positive = np.concatenate([1 - steps, [1.0], 1 + steps[::-1], 2.0 ** np.arange(1, 5)])
    return Mesh(np.concatenate([-positive[::-1], [0.0], positive]), order)


def test_the_lorentz_pressure_bends_the_surface_as_a_logarithm():
    mesh = Mesh(base_edges(0.5, 8.0), 20)
    w = deflection_operator(mesh) @ lorentz(mesh.nodes)
    exact = lorentz_deflection(mesh.nodes)
    assert np.abs(w - exact).max() < 1e-13


def test_the_smoothed_hertz_pressure_flattens_the_parabola(subtests):
    for e in [1e-2, 1e-3, 1e-4, 1e-5]:
        with subtests.test(e=e):
            mesh = graded_to_both_edges(e, 20)
            near_edge = 1 + e * np.random.default_rng(SEED).normal(size=40)
            points = np.concatenate([np.linspace(-3, 3, 61), near_edge, -near_edge])
            w = deflection_operator(mesh, points) @ hertz_pressure(mesh.nodes, e)
            difference = w - hertz_deflection(points, e)
            assert np.ptp(difference) < 1e-14
            assert abs(difference[0] - (1 + np.log(4)) / 4) < 1e-14


def test_the_hertz_pressure_leaves_no_gap_inside_and_its_closed_form_outside():
    mesh = graded_to_both_edges(1e-13, 16)
    points = np.concatenate([np.linspace(-0.999, 0.999, 51), np.linspace(1.001, 4.0, 51)])
    gap = hertz.HERTZ_OFFSET + 0.5 * points**2 + deflection_operator(mesh, points) @ hertz.pressure(mesh.nodes)
    assert np.abs(gap - hertz.gap(points)).max() < 1e-14
    assert np.abs(gap[:51]).max() < 1e-14


def test_far_away_the_deflection_is_that_of_a_line_load():
    mesh = graded_to_both_edges(1e-13, 12)
    points = np.array([-1e9, -1e5, 1e5, 1e9])
    w = deflection_operator(mesh, points) @ hertz.pressure(mesh.nodes)
    assert np.abs(w / (-0.5 * np.log(np.abs(points))) - 1).max() < 1e-11


def test_pressure_on_the_panel_through_infinity_counts():
    mesh = Mesh(base_edges(0.5, 2.0), 24)
    beyond = np.where(np.abs(mesh.nodes) > 2, lorentz(mesh.nodes), 0.0)
    points = np.array([0.0, 0.3, -0.9, 1.0, 1.5, -40.0, 3e6])
    inside, outside = (deflection_operator(mesh, points) @ p for p in (lorentz(mesh.nodes) - beyond, beyond))
    assert (np.abs(outside) > 0.1).all()
    assert np.abs(inside + outside - lorentz_deflection(points)).max() < 1e-13


# Points


def test_the_operator_at_points_is_the_operator_at_the_nodes_where_they_agree():
    mesh = graded_to_both_edges(1e-3, 10)
    some = np.random.default_rng(SEED).choice(mesh.size, 60, replace=False)
    rows = deflection_operator(mesh)[some]
    assert np.abs(deflection_operator(mesh, mesh.nodes[some]) - rows).max() < 1e-14 * np.abs(rows).max()


def test_the_deflection_is_finite_and_right_on_panel_edges():
    mesh = Mesh(base_edges(0.25, 8.0), 20)
    ulp = np.array([1 - 2.0**-53, 1.0, 1 + 2.0**-52])
    points = np.outer(mesh.edges, ulp).ravel()
    w = deflection_operator(mesh, points) @ lorentz(mesh.nodes)
    assert np.abs(w - lorentz_deflection(points)).max() < 1e-13


def test_mirrored_pressures_bend_mirrored_surfaces():
    mesh = graded_to_both_edges(1e-2, 10)
    mirror = np.argsort(-mesh.nodes)[np.argsort(np.argsort(mesh.nodes))]
    p = hertz_pressure(mesh.nodes, 1e-2) * (1 + 0.3 * np.tanh(mesh.nodes))
    d = deflection_operator(mesh)
    assert np.abs((d @ p[mirror])[mirror] - d @ p).max() < 1e-13


def test_the_kernel_is_exact_at_any_distance_from_a_panel(subtests):
    """Near a panel by log moments, farther off by the panel's own quadrature."""
    for order in [10, 14]:
        with subtests.test(order=order):
            mesh, panel = Mesh(np.array([-64.0, 0.0, 1.0, 64.0]), order), slice(order, 2 * order)
            points = 0.5 + 0.5 * np.concatenate([np.linspace(1.3, 8.0, 400), -np.linspace(1.3, 8.0, 400), [30.0]])
            rows = deflection_operator(mesh, points)[:, panel]
            t, weights = np.polynomial.legendre.leggauss(80)
            powers = np.arange(order)[:, None]
            exact = (np.log(np.abs(points[:, None] - 0.5 - 0.5 * t)) * (0.5 * weights)) @ (t**powers).T / -np.pi
            errors = np.abs(rows @ ((2 * mesh.nodes[panel] - 1) ** powers).T - exact).max(axis=0)
            assert (errors * 2.0 ** -np.arange(order)).max() < 1e-12  # as coefficients of smooth pressures fall
            assert errors.max() < 1e-10


# Log moments


def by_quad(coefficients, s):
    """Integrate P_n(t) ln|s - t| with QUADPACK's rules for logarithms at an end."""

    def p(t):
        return np.polynomial.legendre.legval(t, coefficients)

    if abs(s) >= 1.3:
        t, weights = np.polynomial.legendre.leggauss(80)
        return weights @ (p(t) * np.log(abs(s - t)))
    options = {"wvar": (0, 0), "epsabs": 1e-14, "epsrel": 1e-14, "limit": 200}
    if abs(s) > 1:  # whole integral to the singularity less what lies beyond the panel
        end = np.sign(s)
        first = sorted((-end, s))
        beyond = sorted((end, s))
        log = {1.0: "alg-logb", -1.0: "alg-loga"}[end]
        return quad(p, *first, weight=log, **options)[0] - quad(p, *beyond, weight=log, **options)[0]
    left = quad(p, -1, s, weight="alg-logb", **options)[0] if s > -1 else 0.0
    right = quad(p, s, 1, weight="alg-loga", **options)[0] if s < 1 else 0.0
    return left + right


INSIDE = [0.0, 0.3, -0.77, 0.999, 1.0, -1.0]
OUTSIDE = [1.0001, -1.07, 1.0999, 1.1001, -1.4, 2.999, 9.0]


def test_log_moments_agree_with_quadpack(subtests):
    for s in INSIDE + OUTSIDE:
        with subtests.test(s=s):
            order = 8
            moments = log_moments(np.array([s]), order)[0]
            expected = [by_quad(unit, s) for unit in np.eye(order)]
            assert np.abs(moments - expected).max() < 1e-12


def test_log_moments_of_the_first_two_degrees_are_their_closed_forms():
    s = np.concatenate([np.random.default_rng(SEED).uniform(-0.999, 0.999, 30), [1.05, -1.3, 2.5, -7.0]])
    moments = log_moments(s, 4)
    zeroth = (1 + s) * np.log(np.abs(1 + s)) + (1 - s) * np.log(np.abs(1 - s)) - 2
    first = 0.5 * (1 - s * s) * np.log(np.abs((1 - s) / (1 + s))) - s
    assert np.abs(moments[:, 0] - zeroth).max() < 1e-14
    assert np.abs(moments[:, 1] - first).max() < 1e-13


def test_log_moments_lose_digits_only_in_the_highest_degrees(subtests):
    """Just outside the panel an upward recurrence amplifies rounding, most where coefficients are small."""
    for order in [10, 14, 18]:
        with subtests.test(order=order):
            points = np.array([1.003, -1.05, 1.12, -1.2, 1.3, 1.45])
            moments = log_moments(points, order)
            exact = np.array([[by_quad(unit, s) for unit in np.eye(order)] for s in points])
            errors = np.abs(moments - exact).max(axis=0)
            assert errors.max() < 2e-11
            assert errors[: order // 3].max() < 1e-13
            assert (errors * 2.0 ** -np.arange(order)).max() < 1e-13


# Rate


def test_the_deflection_converges_at_the_rate_of_the_nearest_pole():
    r"""Coefficients fall as :math:`\rho^{-n}`, log moments inside a panel as :math:`n^{-3/2}`."""
    edges, points = base_edges(1.0, 8.0), np.linspace(-3, 3, 201)
    orders = np.arange(6, 19, 2)
    errors = []
    for order in orders:
        mesh = Mesh(edges, int(order))
        w = deflection_operator(mesh, points) @ lorentz(mesh.nodes)
        errors.append(np.abs(w - lorentz_deflection(points)).max())
    pole = (1j - 0.5) / 0.5  # of the pressure, seen from the panel [0, 1]
    stated = np.log(abs(pole - np.sqrt(pole * pole - 1)))
    rate = -np.polyfit(orders, np.log(errors * orders**1.5), 1)[0]
    assert abs(rate - stated) < 0.1
    assert errors[-1] < 1e-13
