"""Newton's iteration on problems whose roots are known: its rate, its economy, and each way to fail."""

import math

import numpy as np
import pytest
from scipy.linalg import lu_solve

from stribeck import Outcome
from stribeck.numerics.newton import Dense, StepControl, relative_size, root_between, root_find

pytestmark = pytest.mark.quick


def find(residual, jacobian, start, *, fraction=None, size=relative_size, kept=None, **control):
    """Find the root of plain functions."""
    problem = Dense(residual, jacobian, fraction, size)
    return root_find(problem, start, StepControl(**control), kept)


class Problem:
    """A x + x^3 = b with a known root; counts what the iteration asks for."""

    def __init__(self, n=12, curvature=1.0, seed=20731):
        rng = np.random.default_rng(seed)
        self.matrix = rng.normal(size=(n, n)) + 3.0 * np.sqrt(n) * np.eye(n)
        self.root = rng.uniform(-1.0, 1.0, n)
        self.curvature = curvature
        self.right = self.matrix @ self.root + curvature * self.root**3
        self.jacobians = 0

    def residual(self, x):
        return self.matrix @ x + self.curvature * x**3 - self.right

    def jacobian(self, x):
        self.jacobians += 1
        return self.matrix + np.diag(3.0 * self.curvature * x**2)


def error(root, exact):
    return np.abs(root.x - exact).max()


# Rate and economy


def test_newton_converges_at_second_order():
    exact, errors = 2.0 ** (1.0 / 3.0), []

    def jacobian(x):
        errors.append(abs(x[0] - exact))
        return np.diag(3.0 * x**2)

    root = find(lambda x: x**3 - 2.0, jacobian, [1.6], tolerance=1e-15)
    e = np.array([value for value in errors if value > 1e-11])  # below, rounding shows
    assert root.outcome is Outcome.CONVERGED
    assert e.size >= 4
    assert abs(math.log(e[-1] / e[-2]) / math.log(e[-2] / e[-3]) - 2.0) < 0.1
    assert abs(root.x[0] - exact) < 1e-15


def test_a_chord_step_that_contracts_badly_is_replaced_by_a_newton_step():
    # From 5, exp(x) - 1 = 0 needs five Newton steps of about one each, where old factors are useless.
    root = find(lambda x: np.exp(x) - 1.0, lambda x: np.diag(np.exp(x)), [5.0], chord=0.1)
    assert root.outcome.ok
    assert root.factorisations >= 5
    assert root.steps < 15
    assert abs(root.x[0]) < 1e-11


def test_factors_of_a_neighbour_spare_the_factorisation():
    problem = Problem(curvature=0.1)
    first = find(problem.residual, problem.jacobian, np.zeros(12), chord=0.1)
    problem.right = problem.right + 1e-3
    second = find(problem.residual, problem.jacobian, first.x, chord=0.1, kept=first.inverse)
    fresh = find(problem.residual, problem.jacobian, first.x)
    assert second.outcome.ok
    assert second.factorisations == 0
    assert error(second, fresh.x) < 1e-10


def test_foreign_factors_that_make_every_step_small_do_not_pass_for_convergence():
    problem = Problem()
    wrong = find(lambda x: 1e14 * x, lambda x: 1e14 * np.eye(12), np.ones(12)).inverse
    root = find(problem.residual, problem.jacobian, np.zeros(12), chord=0.1, kept=wrong)
    assert root.outcome.ok
    assert error(root, problem.root) < 1e-10


def test_the_error_left_is_below_the_tolerance(subtests):
    for chord in [None, 0.1, 0.5]:
        with subtests.test(chord=chord):
            rng = np.random.default_rng(9157)
            spared = 0
            for case in range(200):
                problem = Problem(n=4, curvature=10.0 ** rng.uniform(-1, 2), seed=case)
                tolerance = 10.0 ** rng.uniform(-12, -4)
                root = find(problem.residual, problem.jacobian, rng.normal(size=4) * 3.0, chord=chord, tolerance=tolerance)
                assert root.outcome.ok
                spared += root.factorisations < root.steps
                assert error(root, problem.root) <= tolerance * (1.0 + np.abs(problem.root).max())
            assert spared > 100


def test_a_huge_step_followed_by_a_small_one_does_not_pass_for_convergence():
    root = find(lambda x: x**2 - 2.0, lambda x: np.diag(2.0 * x), [1e-6])
    assert root.outcome.ok
    assert abs(root.x[0] - math.sqrt(2.0)) < 1e-9


# Damping


def test_no_step_is_longer_than_the_fraction_allows():
    seen = []

    def residual(x):
        seen.append(x[0])
        return np.log(x)

    def fraction(x, dx):
        return 1.0 if dx[0] >= 0.0 else min(1.0, 0.7 * x[0] / -dx[0])

    root = find(residual, lambda x: np.diag(1.0 / x), [50.0], fraction=fraction)
    assert root.outcome.ok
    assert abs(root.x[0] - 1.0) < 1e-10
    x = np.array(seen)
    assert (x[1:] / x[:-1]).min() == pytest.approx(0.3)


def test_a_chord_step_that_the_fraction_would_shorten_is_not_taken():
    seen = []

    def residual(x):
        seen.append(x[0])
        return np.log(x)

    flat = find(lambda x: x, lambda x: np.eye(1), [1.0]).inverse  # makes the first step 3.9 long
    root = find(
        residual,
        lambda x: np.diag(1.0 / x),
        [50.0],
        fraction=lambda x, dx: min(1.0, 1.0 / abs(dx[0])),
        chord=0.1,
        kept=flat,
        max_steps=100,
    )
    assert root.outcome.ok
    assert np.abs(np.diff(seen)).max() <= 1.0 + 1e-12


def test_a_damped_step_is_never_the_last():
    # The step itself is small at once, but only a tenth of it is admitted, so it proves nothing.
    root = find(lambda x: x, lambda x: np.eye(1), [1e-4], fraction=lambda x, dx: 0.1, tolerance=1e-3)
    assert root.outcome is Outcome.STEP_LIMIT


def test_a_small_power_is_solved_by_monotone_steps():
    """Full steps go to and fro farther and farther."""

    def residual(x):
        return np.sign(x) * np.abs(x) ** 0.22 - 0.3

    def jacobian(x):
        return np.diag(0.22 * np.abs(x) ** -0.78)

    assert not find(residual, jacobian, [1.0], chord=0.25).outcome.ok
    root = find(residual, jacobian, [1.0], chord=0.25, monotone=True)
    assert root.outcome.ok
    assert root.x[0] == pytest.approx(0.3 ** (1 / 0.22), rel=1e-8)


def test_monotone_steps_that_no_part_shortens_stall():
    root = find(lambda x: x**2 + 1, lambda x: np.diag(2 * x), [0.1], monotone=True)
    assert root.outcome is Outcome.STALLED


def test_a_step_to_where_the_residual_is_not_finite_is_halved():
    root = find(np.log, lambda x: np.diag(1.0 / x), [50.0])
    assert root.outcome.ok
    assert abs(root.x[0] - 1.0) < 1e-10


# Failures: each by its name, none by a warning (warnings are errors in this run)


def test_a_problem_without_a_root_ends_at_the_step_limit(subtests):
    for chord in [None, 0.1]:
        with subtests.test(chord=chord):
            root = find(lambda x: x**2 + 1.0, lambda x: np.diag(2.0 * x), [0.7], max_steps=9, chord=chord)
            assert root.outcome is Outcome.STEP_LIMIT
            assert root.steps == 9


def test_a_zero_pivot_is_singular():
    matrix = np.array([[1.0, 2.0], [2.0, 4.0]])
    for right in np.array([[1.0, 1.0], [1.0, 2.0], [0.0, 0.0]]):
        root = find(lambda x, b=right: matrix @ x - b, lambda x: matrix, [0.0, 0.0])
        assert root.outcome is Outcome.SINGULAR


def test_a_badly_scaled_matrix_is_not_singular():
    rng = np.random.default_rng(78)
    matrix = 10.0 ** rng.uniform(-20, 20, (6, 1)) * rng.normal(size=(6, 6))
    right = matrix @ np.arange(1.0, 7.0)
    root = find(lambda x: matrix @ x - right, lambda x: matrix, np.zeros(6))
    assert root.outcome.ok
    np.testing.assert_allclose(root.x, np.arange(1.0, 7.0), rtol=1e-12)
    np.testing.assert_allclose(lu_solve(root.inverse.factors, right), np.arange(1.0, 7.0), rtol=1e-12)


def test_what_is_not_finite_is_named_so():
    eye = np.eye(1)
    at_start = find(np.log, lambda x: eye, [-1.0])
    in_jacobian = find(lambda x: x, lambda x: eye * np.nan, [1.0])
    everywhere_else = find(lambda x: np.where(x == 1.0, 1.0, np.inf), lambda x: eye, [1.0])
    for root in (at_start, in_jacobian, everywhere_else):
        assert root.outcome is Outcome.NOT_FINITE
    assert everywhere_else.x[0] == 1.0


def test_a_vanishing_fraction_stalls():
    for value in (0.0, 1e-12, math.nan):
        root = find(lambda x: x, lambda x: np.eye(1), [1.0], fraction=lambda x, dx, t=value: t)
        assert root.outcome is Outcome.STALLED
        assert root.steps == 0


def test_steps_that_rounding_keeps_from_contracting_end_the_iteration(subtests):
    for chord in [None, 0.1]:
        with subtests.test(chord=chord):

            def noisy(x):  # the noise of a residual that is a difference of numbers of order 1e8
                return (1e8 + x**2) - (1e8 + 2.0) + 1e-8 * np.sin(1e12 * x)

            root = find(noisy, lambda x: np.diag(2.0 * x), [1.0], chord=chord, tolerance=1e-13)
            assert root.outcome is Outcome.ROUNDING
            assert root.steps < 25
            assert abs(root.x[0] - math.sqrt(2.0)) < 1e-7


# What the result says, what is left alone, what is refused


@pytest.mark.quick
def test_a_root_lies_between_two_signs():
    calls = []

    def function(x):
        calls.append(x)
        return math.exp(x) - 3.0

    assert root_between(function, 0.0, 5.0, 1e-10) == pytest.approx(math.log(3.0), abs=1e-10)
    assert len(calls) <= 10  # by bisection it takes 36
    assert root_between(lambda x: x, 0.0, 1.0, 1e-10) == 0.0
    assert root_between(lambda x: x * x + 1, 0.0, 1.0, 1e-10) is None
