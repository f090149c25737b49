"""Panels on the whole line: exact interpolation and integrals, spectral rates, and the choice of panels."""

import numpy as np
import pytest
from numpy.polynomial import legendre

from stribeck.numerics.panels import Mesh, MeshTooLargeError, adapt, base_edges, legendre_tail, reference
from stribeck.numerics.panels import graded as halved_towards
from stribeck.numerics.running_integral import RunningIntegral
from stribeck.numerics.settings import MAX_PANELS

pytestmark = pytest.mark.quick

SEED = 70_419


def graded(order=12, towards=1.0, levels=10):
    """Panels that halve towards ``x = towards`` from both sides, on [-8, 8]."""
    steps = 0.5 ** np.arange(1, levels)
    outer = np.array([2.0, 4.0, 8.0])
    around = np.concatenate([towards - steps, [towards], towards + steps[::-1]])
    return Mesh(np.concatenate([-outer[::-1], [-1.0, 0.0], around, outer]), order)


# Nodes


def test_the_reference_rule_integrates_its_own_polynomials(subtests):
    for order in [1, 2, 7, 16]:
        with subtests.test(order=order):
            rule = reference(order)
            coefficients = np.random.default_rng(SEED).normal(size=order)
            values = legendre.legval(rule.nodes, coefficients)
            antiderivative = legendre.legint(coefficients, lbnd=-1)
            assert np.abs(rule.to_legendre @ values - coefficients).max() < 1e-13
            assert np.abs(rule.integral @ values - legendre.legval(rule.nodes, antiderivative)).max() < 1e-13
            assert abs(rule.left_half @ values - legendre.legval(0.0, antiderivative)) < 1e-13


# Interpolation


def test_interpolation_is_exact_for_polynomials_in_x_and_beyond_in_its_inverse():
    mesh = graded(order=8)
    rng = np.random.default_rng(SEED)
    inner, outer = rng.normal(size=(2, 8))

    def field(x):
        t = np.where(np.abs(x) > 8, 8 / np.where(x == 0, 1, x), 0.0)
        return np.where(np.abs(x) <= 8, np.polyval(inner, x / 8), np.polyval(outer, t))

    beyond = 8 / rng.uniform(-0.999, 0.999, 100)
    x = np.concatenate([rng.uniform(-8, 8, 300), mesh.edges[1:-1], [0.0], beyond])
    assert np.abs(mesh.interpolate(field(mesh.nodes), x) - field(x)).max() < 2e-12


# Integrals


def test_rational_functions_are_integrated_over_the_whole_line(subtests):
    for function, integral in [
        (lambda x: 1 / (1 + x**2), np.pi),
        (lambda x: 1 / (1 + x**2) ** 2, np.pi / 2),
        (lambda x: x**2 / (1 + x**2) ** 2, np.pi / 2),
        (lambda x: (2 + x) / (1 + x**2) ** 2, np.pi),
        (lambda x: 1 / ((x - 1.25) ** 2 + 0.5), np.pi / np.sqrt(0.5)),
        (lambda x: 1 / ((1 + x**2) * (9 + x**2)), np.pi / 12),
    ]:
        with subtests.test(integral=integral):
            mesh = Mesh(base_edges(0.5, 16.0), 24)
            assert abs(mesh.weights @ function(mesh.nodes) / integral - 1) < 1e-13


LOPSIDED = np.array([-5.0, 0.0, 0.25, 1.0, 5.0])


def test_an_operator_after_the_running_integral_is_the_product_of_their_matrices(subtests):
    for edges in [graded().edges, base_edges(1.0, 2.0), LOPSIDED]:
        with subtests.test(edges=edges):
            mesh = Mesh(edges, 6)
            matrix = np.stack([RunningIntegral(mesh)(column) for column in np.eye(mesh.size)], axis=1)
            operator = np.random.default_rng(SEED).normal(size=(7, mesh.size))
            product = operator @ matrix
            assert np.abs(RunningIntegral(mesh).after(operator) - product).max() < 1e-13 * np.abs(product).max()


# Choice of panels


def bump(width, centre=1.0):
    return lambda x, *_: (width**2 / (width**2 + (x - centre) ** 2))[None]


def test_panels_are_short_where_the_field_bends_and_nowhere_else(subtests):
    for width in [1e-2, 1e-4]:
        with subtests.test(width=width):
            mesh = adapt(bump(width), 1.0, 16.0, 10, 1e-6)
            half = mesh.half_widths[:-1]
            smallest = np.abs(mesh.centres[:-1][half < 1.1 * half.min()] - 1)
            assert (smallest < 4 * width).all()
            assert width / 10 < half.min() < 2 * width
            assert half[mesh.centres[:-1] < -1].min() >= 0.5
            assert 0.0 in mesh.edges


def test_the_panels_resolve_the_field_to_four_times_the_tolerance(subtests):
    for width, centre in [(1e-3, 0.7), (1e-2, 0.0), (1e-2, 0.3), (1e-2, 1.0)]:
        with subtests.test(width=width, centre=centre):
            for order, tolerance in ((10, 1e-3), (10, 1e-6), (10, 1e-9), (8, 1e-6), (12, 1e-6), (16, 1e-9)):
                mesh = adapt(bump(width, centre), 1.0, 16.0, order, tolerance)
                field = bump(width, centre)(mesh.nodes)[0]
                assert legendre_tail(field, order).max() <= 4 * tolerance
                halved = adapt(bump(width, centre), 1.0, 16.0, order, tolerance, anew=False)
                assert legendre_tail(bump(width, centre)(halved.nodes)[0], order).max() <= tolerance
                x = np.random.default_rng(SEED).uniform(centre - 10 * width, centre + 10 * width, 400)
                error = np.abs(mesh.interpolate(field, x) - bump(width, centre)(x)[0]).max()
                assert error < tolerance


def test_panels_of_a_field_known_on_other_panels_are_not_shortened_where_those_end():
    coarse = adapt(bump(1e-2, 0.3), 1.0, 16.0, 10, 1e-4)
    values = bump(1e-2, 0.3)(coarse.nodes)[0]

    def known(x, *_):
        return coarse.interpolate(values, x.ravel()).reshape(1, *x.shape)

    exact = adapt(bump(1e-2, 0.3), 1.0, 16.0, 10, 1e-7)
    assert adapt(known, 1.0, 16.0, 10, 1e-7, coarse).panels <= 1.2 * exact.panels


def test_kinks_that_are_edges_take_fewer_panels_and_are_resolved():
    at = np.array([-0.6, 0.3])

    def kinked(x, *_):
        return np.exp(-x * x)[None] * (1 + sum(np.abs(x - place) for place in at))

    mesh, hidden = adapt(kinked, 1.0, 16.0, 10, 1e-6, places=at), adapt(kinked, 1.0, 16.0, 10, 1e-6)
    assert np.isin([*at, 0.0], mesh.edges).all()
    assert mesh.panels < 0.8 * hidden.panels
    x = np.linspace(-3, 3, 2001)
    error, of_hidden = (np.abs(m.interpolate(kinked(m.nodes)[0], x) - kinked(x)[0]).max() for m in (mesh, hidden))
    assert error < 1e-5
    assert error < 0.1 * of_hidden


def test_the_panel_through_infinity_begins_where_the_tail_is_resolved():
    mesh = adapt(lambda x, *_: (1e4 / (1e4 + x * x))[None], 1.0, 4.0, 10, 1e-8)
    assert 16.0 <= mesh.edges[-1] <= 1024.0
    values = 1e4 / (1e4 + mesh.nodes**2)
    assert legendre_tail(values, 10)[-1] <= 1e-8


def test_a_field_that_no_panel_resolves_needs_too_many():
    with pytest.raises(MeshTooLargeError):
        adapt(lambda x, *_: np.sin(300 * x)[None] * (np.abs(x) < 10), 1.0, 16.0, 10, 1e-6)


def test_a_step_is_not_chased_beyond_double_precision():
    mesh = adapt(lambda x, *_: np.sign(x - 0.3)[None] * (np.abs(x) < 4), 1.0, 8.0, 10, 1e-6)
    assert mesh.panels <= MAX_PANELS
    assert np.diff(mesh.edges).min() >= 2.0**-45


def test_an_edge_that_rounding_keeps_apart_from_a_place_leaves_no_panel_between():
    """Nodes there were the same, and slopes between them divided by zero."""
    beside = 0.25 * (1 + 2.0**-51)
    mesh = halved_towards(Mesh(np.array([-8.0, -1.0, 0.0, beside, 1.0, 8.0]), 12), [0.0, 0.25], 5)
    assert 0.25 in mesh.edges and beside not in mesh.edges
    assert (np.diff(mesh.nodes[: -mesh.order]) > 0).all()
