"""Taylor series from values alone, and the interpolation between two of them."""

import math

import numpy as np
import pytest

from stribeck.numerics.cells import Cells
from stribeck.numerics.hermite import chebyshev_basis, hermite_form, hermite_weights, missed_by
from stribeck.numerics.series import (
    along,
    beyond,
    exponential,
    implicit_series,
    integral_of_product,
    interval,
    logarithm,
    product,
    radius,
    reciprocal,
)

pytestmark = pytest.mark.quick

SINGULAR = 1.3
"""Radius of convergence of the function below."""


def function(t):
    return np.exp(0.7 * t) / (1 + (t / SINGULAR) ** 2)


def coefficients(order):
    exponential = np.array([0.7**k / math.factorial(k) for k in range(order + 1)])
    quotient = np.array([0.0 if k % 2 else (-1) ** (k // 2) * SINGULAR**-k for k in range(order + 1)])
    return np.convolve(exponential, quotient)[: order + 1]


def test_products_quotients_and_exponentials_have_the_coefficients_of_the_closed_form():
    order = 12
    factor, below = along(0.7, order), np.zeros(order + 1)
    below[[0, 2]] = 1.0, SINGULAR**-2
    np.testing.assert_allclose(product(factor, reciprocal(below)), coefficients(order), rtol=1e-13, atol=1e-16)
    columns = np.stack([factor, below], axis=1)  # each column is a series of its own
    for each in columns.T:
        np.testing.assert_allclose(exponential(logarithm(each)), each, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(product(columns, columns[:, ::-1]), product(factor, below)[:, None] * [1, 1], rtol=1e-13)
    np.testing.assert_allclose(product(columns, reciprocal(columns))[1:], 0, atol=1e-15)


def test_coefficients_come_from_real_values_with_fewer_digits():
    samples = interval(0.2 * SINGULAR)
    found = samples.taylor(function(samples.places), 6)
    np.testing.assert_allclose(found * SINGULAR ** np.arange(7), coefficients(6) * SINGULAR ** np.arange(7), atol=1e-4)
    np.testing.assert_allclose(found[:3], coefficients(2), rtol=1e-8)


def test_a_polynomial_is_its_own_series():
    exact = np.array([3.0, -1.0, 0.5, 2.0])
    samples = interval(0.3)
    values = np.polynomial.polynomial.polyval(samples.places, exact)
    np.testing.assert_allclose(samples.taylor(values, 3), exact, rtol=1e-9)


def test_the_series_of_a_solution_is_that_of_its_closed_form():
    """``x**2 = 1 + t`` and ``exp(y) = x``: a power with a binomial series and half of a logarithm."""
    order, samples = 8, interval(0.35)
    binomial = np.cumprod([1.0, *((0.5 - k) / (k + 1) for k in range(order))])
    logarithm = np.array([0.0, *(-0.5 * (-1) ** k / k for k in range(1, order + 1))])
    jacobian = np.array([[2.0, 0.0], [-1.0, 1.0]])
    powers = samples.powers(order)

    def local(k, w):
        x, y = (powers[:, :k] @ w[:k]).T
        return np.stack([x**2, np.exp(y) - x], axis=1)

    def residual(k, w, v):
        return v - np.array([float(k == 1), 0.0])

    found = implicit_series(np.array([1.0, 0.0]), samples, local, residual, lambda r: -np.linalg.solve(jacobian, r), order)
    exact = np.stack([binomial, logarithm], axis=1)
    np.testing.assert_allclose(found, exact, atol=1e-4)


def test_the_radius_is_that_of_convergence_and_rounding_is_no_singularity():
    assert radius(coefficients(12)[:, None], 0.3) == pytest.approx(SINGULAR, rel=0.15)
    noise = 1e-13 * np.random.default_rng(3).normal(size=(13, 5)) * 0.3 ** -np.arange(13.0)[:, None]
    entire = np.array([0.1**k / math.factorial(k) for k in range(13)])[:, None] + noise
    assert radius(entire, 0.3) > 2


def interpolated(left, right, length, tau):
    order = len(left) - 1
    scale = length ** np.arange(order + 1.0)
    return chebyshev_basis(tau, 2 * order + 2) @ hermite_form(order) @ np.concatenate([left * scale, right * scale])


@pytest.mark.parametrize("order", [0, 1, 3, 8, 12])
def test_a_polynomial_of_the_degree_is_interpolated_exactly(order):
    rng = np.random.default_rng(order)
    polynomial = np.polynomial.Polynomial(rng.normal(size=2 * order + 2))
    length, tau = 1.7, np.linspace(0, 1, 9)

    def taylor(t):
        return np.array([polynomial.deriv(k)(t) / math.factorial(k) if k else polynomial(t) for k in range(order + 1)])

    found = interpolated(taylor(0.2), taylor(0.2 + length), length, tau)
    np.testing.assert_allclose(found, polynomial(0.2 + length * tau), rtol=1e-10, atol=1e-10 * np.abs(found).max())


def test_both_ends_keep_their_coefficients():
    of_left, of_right = hermite_weights(5, np.array([0.0, 1.0]))
    np.testing.assert_array_equal(of_left, [[1, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]])
    np.testing.assert_array_equal(np.abs(of_right), [[0, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, 0]])


def test_an_error_is_not_taken_for_small_where_the_highest_order_changes_nothing_by_chance():
    order, orders = 8, np.arange(9)
    poles = np.array([0.4 + 0.7j, 0.1 + 0.8j, 0.7 + 0.6j])
    values = [(-1.0) ** orders[:, None] / (end - poles) ** (orders[:, None] + 1) for end in (0.0, 1.0)]
    each = np.vstack([value.real for value in values])
    lower = np.delete(each, (order, 2 * order + 1), axis=0)
    at = np.array([0.3, 0.7])
    changes = np.hstack(hermite_weights(order, at)) @ each - np.hstack(hermite_weights(order - 1, at)) @ lower
    factors = np.linalg.svd(changes)[2][-1]  # of a sum of which the highest order changes nothing
    ends = each @ factors[:, None]
    tau = np.linspace(0, 1, 41)
    true = (1 / (tau[:, None] - poles)).real @ factors
    error = np.abs(np.hstack(hermite_weights(order, tau)) @ ends[:, 0] - true).max()
    stated = [missed_by(order, ends, rate)[0] / 4**order for rate in (0.0, 1 / np.abs(poles * (poles - 1)).min())]
    assert stated[0] < 1e-3 * error < error < stated[1]


def test_twelve_orders_interpolate_to_rounding():
    a, b = (np.array([math.exp(t) / math.factorial(k) for k in range(13)]) for t in (0.0, 2.0))
    tau = np.linspace(0, 1, 101)
    np.testing.assert_allclose(interpolated(a, b, 2.0, tau), np.exp(2 * tau), rtol=1e-14)


def test_cells_are_the_function_and_its_slope_inside_and_constant_beyond():
    cells = Cells.of(lambda x: np.stack([np.sin(x), np.exp(-x)]), 0.0, 3.0, 40, 8)
    x = np.linspace(0, 3, 101).reshape(-1, 1)
    value, slope = cells.with_slope(x)
    np.testing.assert_allclose(value, [np.sin(x), np.exp(-x)], atol=1e-14)
    np.testing.assert_allclose(slope, [np.cos(x), -np.exp(-x)], atol=1e-11)
    np.testing.assert_array_equal(cells(np.array([-5.0, 7.0])), cells(np.array([0.0, 3.0])))


def test_the_integral_of_a_product_is_that_of_its_series():
    a, b = np.random.default_rng(3).standard_normal((2, 7, 5))
    weights = np.arange(1.0, 6.0)
    np.testing.assert_allclose(integral_of_product(a, b, weights), product(a, b) @ weights, rtol=1e-13)
    assert along(0.7, 4) == pytest.approx([0.7**k / math.factorial(k) for k in range(5)])


def test_a_prediction_beyond_the_radius_knows_about_its_error():
    orders = np.arange(1.0, 17.0)
    series = np.append(0.0, np.cos(np.pi * orders / 2) / orders)[:, None] * np.array([1.0, 0.3])

    def exact(t):  # -ln(1 + t^2) / 2, of radius one
        return -0.5 * np.log(1 + t * t) * np.array([1.0, 0.3])

    for t in (0.5, 1.2, 2.0):
        found, doubt = beyond(series, t)
        assert np.abs(found - exact(t)).max() <= doubt + 1e-12 and doubt < 0.1 * t


def test_a_polynomial_of_few_degrees_leaves_out_what_is_not_smooth():
    """The cusp of a fluid without a plateau passes through a node between the samples."""
    true = 1.0 / np.cumprod([1.0, *range(1, 12)])
    worst = []
    for degree in (None, 7):
        samples = interval(0.3, degree=degree)
        cusps = [np.exp(samples.places) + 1e-6 * np.abs(samples.places - place) ** 0.7 for place in np.linspace(-0.3, 0.3, 41)]
        found = samples.taylor(np.stack(cusps, axis=1), 6)
        worst.append(np.abs(found - true[:7, None]).max(axis=1))
    assert (worst[1][3:] < 0.3 * worst[0][3:]).all()
    smooth = interval(0.3, degree=7)
    assert smooth.taylor(np.exp(smooth.places), 5) == pytest.approx(true[:6], rel=1e-5)
