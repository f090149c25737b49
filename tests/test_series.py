"""Taylor series, and the interpolation between two of them."""

import math

import numpy as np
import pytest

from stribeck.numerics.cells import Cells
from stribeck.numerics.dual import Dual
from stribeck.numerics.hermite import (
    chebyshev_basis,
    hermite_form,
    hermite_weights,
    missed_by,
    slope_noise,
    weights_through,
)
from stribeck.numerics.series import Tape, beyond, implicit_series, polynomial, radius

pytestmark = pytest.mark.quick

SINGULAR = 1.3
"""Radius of convergence of exp(0.7 t)/(1 + (t/SINGULAR)**2)."""


def coefficients(order):
    exponential = np.array([0.7**k / math.factorial(k) for k in range(order + 1)])
    quotient = np.array([0.0 if k % 2 else (-1) ** (k // 2) * SINGULAR**-k for k in range(order + 1)])
    return np.convolve(exponential, quotient)[: order + 1]


def test_jets_have_the_coefficients_of_the_closed_form():
    tape = Tape(12)
    t = tape.given(np.eye(13)[:, 1:2])
    below = 1 + (t / SINGULAR) ** 2
    columns = np.linspace(0.5, 1.5, 3)  # nodes with a function each
    for jet in (
        np.exp(0.7 * t) / below,
        tape.growth(0.7) * (1 / below),
        np.exp(0.7 * t - np.log(below)),
        np.sqrt(np.exp(1.4 * t)) * below**-1.0,
        (columns * np.exp(0.7 * t) / (below * columns))[..., 1:2],
        np.maximum(np.exp(0.7 * t) / below, t) @ np.ones(1),
        np.expm1(np.log1p(np.exp(0.7 * t) / below - 1)) + 1,
    ):
        tape.reached = 0
        for k in range(1, 13):
            tape.fill(k)
        np.testing.assert_allclose(jet.coefficients[:, 0], coefficients(12), rtol=1e-12, atol=1e-15)


def test_a_polynomial_of_a_jet_has_its_series():
    tape, rng = Tape(5), np.random.default_rng(5)
    inner, outer = rng.standard_normal((6, 2)), rng.standard_normal((4, 2))
    found = polynomial(outer, tape.given(inner))
    for k in range(1, 6):
        tape.fill(k)
    for column in range(2):
        exact = np.polynomial.Polynomial(outer[:, column])(np.polynomial.Polynomial(inner[:, column])).coef[:6]
        np.testing.assert_allclose(found.coefficients[:, column], exact, rtol=1e-12)
    np.testing.assert_allclose(polynomial(outer, inner[:1]), found.coefficients[:1])


def test_the_series_of_a_solution_is_that_of_its_closed_form():
    """``x**2 = 1 + t`` and ``exp(y) = x``: a power with a binomial series and half of a logarithm."""
    order = 8
    binomial = np.cumprod([1.0, *((0.5 - k) / (k + 1) for k in range(order))])
    logarithm = np.array([0.0, *(-0.5 * (-1) ** k / k for k in range(1, order + 1))])
    exact = np.stack([binomial, logarithm], axis=1)
    found = np.zeros((order + 1, 2))
    found[0, 0] = 1.0
    tape = Tape(order)
    x, y = (tape.given(found[:, k : k + 1]) for k in range(2))
    rows = x**2 - 1 - tape.given(np.eye(order + 1)[:, 1:2]), np.exp(y) - x

    def coefficient(k):
        tape.fill(k)
        return np.concatenate([row.coefficients[k] for row in rows])

    nearly = np.array([[2.0, 0.0], [-1.0, 1.0]]) + 1e-5  # of another state
    implicit_series(found, coefficient, lambda r: -np.linalg.solve(nearly, r))
    np.testing.assert_allclose(found, exact, atol=1e-8)


def test_the_radius_is_that_of_convergence_and_rounding_is_no_singularity():
    assert radius(coefficients(12)[:, None]) == pytest.approx(SINGULAR, rel=0.15)
    noise = 1e-13 * np.random.default_rng(3).normal(size=(13, 5))
    entire = np.array([0.1**k / math.factorial(k) for k in range(13)])[:, None] + noise
    assert radius(entire) > 2


def interpolated(left, right, length, tau):
    order = len(left) - 1
    scale = length ** np.arange(order + 1.0)
    return chebyshev_basis(tau, 2 * order + 2) @ hermite_form(order) @ np.concatenate([left * scale, right * scale])


def test_a_polynomial_of_the_degree_is_interpolated_exactly(subtests):
    for order in [0, 1, 3, 8, 12]:
        with subtests.test(order=order):
            rng = np.random.default_rng(order)
            polynomial = np.polynomial.Polynomial(rng.normal(size=2 * order + 2))
            length, tau = 1.7, np.linspace(0, 1, 9)

            def taylor(t):
                return np.array([polynomial.deriv(k)(t) / math.factorial(k) if k else polynomial(t) for k in range(order + 1)])

            found = interpolated(taylor(0.2), taylor(0.2 + length), length, tau)
            np.testing.assert_allclose(found, polynomial(0.2 + length * tau), rtol=1e-10, atol=1e-10 * np.abs(found).max())


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


def test_cells_are_the_function_and_its_slope_inside_and_constant_beyond():
    cells = Cells.of(lambda x: np.stack([np.sin(x), np.exp(-x)]), 0.0, 3.0, 40, 8)
    x = np.linspace(0, 3, 101).reshape(-1, 1)
    value, slope = cells.with_slope(x)
    np.testing.assert_allclose(value, [np.sin(x), np.exp(-x)], atol=1e-14)
    np.testing.assert_allclose(slope, [np.cos(x), -np.exp(-x)], atol=1e-11)
    np.testing.assert_array_equal(cells(np.array([-5.0, 7.0])), cells(np.array([0.0, 3.0])))


def test_a_prediction_beyond_the_radius_knows_about_its_error():
    orders = np.arange(1.0, 17.0)
    series = np.append(0.0, np.cos(np.pi * orders / 2) / orders)[:, None] * np.array([1.0, 0.3])

    def exact(t):  # -ln(1 + t^2) / 2, of radius one
        return -0.5 * np.log(1 + t * t) * np.array([1.0, 0.3])

    for t in (0.5, 1.2, 2.0):
        found, doubt = beyond(series, t)
        assert np.abs(found - exact(t)).max() <= doubt + 1e-12 and doubt < 0.1 * t


def test_weights_of_values_and_slopes_bring_their_derivatives():
    nodes, exact = np.array([-1.0, -0.2, 0.5, 1.1]), np.polynomial.Polynomial([0.3, -1.0, 0.5, 2.0, -0.7, 0.1, 0.4, 0.2])
    x = np.append(np.linspace(-1.0, 1.1, 9), nodes)
    at, slope = weights_through(nodes, Dual(x, np.ones_like(x)))
    found = at @ exact(nodes)[:, None] + slope @ exact.deriv()(nodes)[:, None]
    np.testing.assert_allclose(found.value[:, 0], exact(x), rtol=1e-12)
    np.testing.assert_allclose(found.slope[:, 0], exact.deriv()(x), rtol=1e-11, atol=1e-11)


def test_a_wrong_slope_shows_in_the_highest_order():
    nodes, errors = np.linspace(0.0, 1.0, 6), np.full((6, 1), 1e-9)
    x = np.linspace(0.02, 0.98, 33)
    values, slopes = np.sin(nodes)[:, None], np.cos(nodes)[:, None]
    assert slope_noise(nodes, values, slopes, errors, x).max() == 0.0
    for wrong in range(6):
        slopes = np.cos(nodes)[:, None] + 1e-4 * (np.arange(6) == wrong)[:, None]
        at, along = weights_through(nodes, x)
        missed = np.abs(at @ values + along @ slopes - np.sin(x)[:, None])
        assert (missed <= 1.02 * slope_noise(nodes, values, slopes, errors, x) + 1e-8).all()
