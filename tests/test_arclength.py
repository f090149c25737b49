"""Pseudo-arclength on known branches: Bratu's equation with its fold at 3.5138, the circle, exp(-p)."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from stribeck.numerics.arclength import trace
from stribeck.numerics.newton import Outcome

# Bratu: u'' + p e^u = 0 has u(1/2) = 2 ln cosh(a) with p = 8 (a / cosh a)^2, largest where a tanh a = 1.
FOLD_A = brentq(lambda a: a * math.tanh(a) - 1.0, 1.0, 2.0, xtol=1e-15)
FOLD = 8.0 * (FOLD_A / math.cosh(FOLD_A)) ** 2


class Bratu:
    """u'' + p e^u = 0, u(0) = u(1) = 0, by collocation at Chebyshev points; u(1/2) is the middle value."""

    def __init__(self, n=32):
        x = np.cos(np.pi * np.arange(n + 1) / n)
        c = np.r_[2.0, np.ones(n - 1), 2.0] * (-1.0) ** np.arange(n + 1)
        first = np.outer(c, 1.0 / c) / (x[:, None] - x[None, :] + np.eye(n + 1))
        first -= np.diag(first.sum(axis=1))
        self.second = 4.0 * (first @ first)[1:-1, 1:-1]
        self.n = n - 1

    def residual(self, u, p):
        return self.second @ u + p * np.exp(u)

    def jacobian(self, u, p):
        return self.second + np.diag(p * np.exp(u))

    def derivative(self, u, p):
        return np.exp(u)

    def trace(self, **arguments):
        return trace(self.residual, self.jacobian, self.derivative, np.zeros(self.n), 0.0, **arguments)


def exact_centre(p, branch):
    """u(1/2) on the "lower" or the "upper" branch of Bratu's problem."""
    ends = (0.0, FOLD_A) if branch == "lower" else (FOLD_A, 50.0)
    a = brentq(lambda a: 8.0 * (a / math.cosh(a)) ** 2 - p, *ends, xtol=1e-15)
    return 2.0 * math.log(math.cosh(a))


@pytest.fixture(scope="module")
def bratu():
    return Bratu()


@pytest.fixture(scope="module")
def branch(bratu):
    """The branch from p = 0 through the fold to p = 1 on its upper part."""
    passed = bratu.trace(
        bounds=(-math.inf, 4.0),
        stop_when=lambda u, p: u.max() > 2.0 and p < 1.0,
        record=lambda u, p: u[bratu.n // 2],
    )
    assert passed.outcome.ok
    return passed


# Pseudo-arclength: Bratu


def test_the_bratu_fold_is_located_to_1e_8(branch):
    assert pytest.approx(3.513830719, abs=1e-9) == FOLD
    (fold,) = branch.folds
    assert abs(fold.parameter - FOLD) < 1e-10
    assert abs(fold.x.max() - 2.0 * math.log(math.cosh(FOLD_A))) < 1e-8


def test_the_jacobian_is_singular_at_the_fold_and_only_there(bratu, branch):
    (fold,) = branch.folds

    def smallest(u, p):
        return np.linalg.svd(bratu.jacobian(u, p), compute_uv=False)[-1]

    assert smallest(fold.x, fold.parameter) < 1e-8
    assert min(smallest(u, p) for u, p in zip(branch.points, branch.parameters, strict=True)) > 1e-3


def test_the_fold_converges_spectrally_with_the_points_of_the_discretisation():
    errors = [abs(Bratu(n).trace(max_points=30).folds[0].parameter - FOLD) for n in (6, 10, 14)]
    assert errors[1] < 0.05 * errors[0]
    assert errors[2] < 0.05 * errors[1]
    assert errors[2] < 1e-6


def test_both_branches_are_followed(branch):
    (fold,) = branch.folds
    assert 5 < fold.index < len(branch.points) - 3
    for i in range(1, len(branch.points)):
        side = "lower" if i < fold.index else "upper"
        assert branch.record[i] == pytest.approx(exact_centre(branch.parameters[i], side), abs=1e-8)


def test_the_slope_along_the_branch_changes_sign_at_the_fold_only(branch):
    (fold,) = branch.folds
    assert (branch.tangents[: fold.index, -1] > 0.0).all()
    assert (branch.tangents[fold.index :, -1] < 0.0).all()


def test_tangents_have_unit_length_and_lie_along_the_branch(bratu, branch):
    for u, p, t in zip(branch.points, branch.parameters, branch.tangents, strict=True):
        assert t[:-1] @ t[:-1] / bratu.n + t[-1] ** 2 == pytest.approx(1.0, abs=1e-12)
        across = bratu.jacobian(u, p) @ t[:-1] + bratu.derivative(u, p) * t[-1]
        assert np.abs(across).max() < 1e-9


def test_a_branch_ends_exactly_at_a_bound(bratu):
    before_fold = bratu.trace(bounds=(0.0, 3.0))
    assert before_fold.outcome.ok
    assert before_fold.parameters[-1] == 3.0
    assert before_fold.folds == ()
    assert before_fold.points[-1].max() == pytest.approx(exact_centre(3.0, "lower"), abs=1e-8)
    after_fold = bratu.trace(bounds=(-1.0, 3.6), stop_when=lambda u, p: u.max() > 2.0 and p < 1.0)
    assert len(after_fold.folds) == 1
    back = trace(
        bratu.residual,
        bratu.jacobian,
        bratu.derivative,
        after_fold.points[-1],
        after_fold.parameters[-1],
        bounds=(0.0, 3.4),
    )
    assert back.parameters[-1] == 3.4
    assert back.points[-1].max() == pytest.approx(exact_centre(3.4, "upper"), abs=1e-8)


def test_a_bound_just_before_a_fold_ends_the_branch_without_it(bratu):
    cut = bratu.trace(bounds=(0.0, FOLD - 1e-3), step=0.4, max_step=2.0)
    assert cut.outcome.ok
    assert cut.parameters[-1] == FOLD - 1e-3
    assert cut.folds == ()
    assert cut.points[-1].max() == pytest.approx(exact_centre(FOLD - 1e-3, "lower"), abs=1e-7)


def test_the_branch_does_not_depend_on_the_number_of_collocation_points(bratu):
    coarse, fine = Bratu(20).trace(max_points=15), Bratu(40).trace(max_points=15)
    np.testing.assert_allclose(coarse.parameters, fine.parameters, rtol=0.1)


# Pseudo-arclength: the circle x^2 + p^2 = 1


def circle(**arguments):
    return trace(
        lambda x, p: x**2 + p**2 - 1.0,
        lambda x, p: np.diag(2.0 * x),
        lambda x, p: np.array([2.0 * p]),
        [1.0],
        0.0,
        **({"max_step": 0.3} | arguments),
    )


@pytest.mark.parametrize("direction", [1, -1])
def test_a_circle_is_traced_round_with_two_folds(direction):
    turned = [0.0]

    def once_round(x, p):
        angle = math.atan2(direction * p, x[0])
        turned.append(turned[-1] + (angle - turned[-1] + math.pi) % (2.0 * math.pi) - math.pi)
        return turned[-1] > 2.0 * math.pi

    round_trip = circle(direction=direction, stop_when=once_round, min_step=1e-3)
    assert round_trip.outcome.ok
    assert turned[-1] < 2.0 * math.pi + 0.3
    np.testing.assert_allclose(round_trip.points[:, 0] ** 2 + round_trip.parameters**2, 1.0, atol=1e-10)
    assert [fold.parameter for fold in round_trip.folds] == pytest.approx([direction, -direction], abs=1e-12)
    assert [fold.x[0] for fold in round_trip.folds] == pytest.approx([0.0, 0.0], abs=1e-9)
    for fold in round_trip.folds:
        slopes = round_trip.tangents[fold.index - 1 : fold.index + 1, -1]
        assert slopes[0] * slopes[1] < 0.0


def test_a_step_that_turns_too_far_is_retried_shorter():
    # The first step would land across the circle; the branch is kept by halving it.
    wide = circle(step=1.9, max_step=1.9, max_points=30)
    tight = circle(step=0.05, max_step=0.05, max_points=30)
    assert wide.failures > 0
    assert tight.failures == 0
    for traced in (wide, tight):
        assert traced.outcome.ok
        steps = np.diff(np.unwrap(np.arctan2(traced.parameters, traced.points[:, 0])))
        assert (steps > 0.0).all()
        assert steps.max() <= math.acos(0.7) + 1e-12


def test_max_points_ends_a_branch_and_record_follows_it():
    short = circle(max_points=7, record=lambda x, p: (x[0], 2.0 * p))
    assert short.outcome.ok
    assert len(short.points) == len(short.parameters) == len(short.tangents) == len(short.record) == 7
    np.testing.assert_array_equal(short.record[:, 1], 2.0 * short.parameters)


def test_an_interrupted_trace_keeps_its_branch():
    def on_point(s, point):
        if s > 1.0:
            raise KeyboardInterrupt

    kept = circle(on_point=on_point)
    assert kept.outcome is Outcome.INTERRUPTED
    assert len(kept.points) > 3
    np.testing.assert_allclose(kept.points[:, 0] ** 2 + kept.parameters**2, 1.0, atol=1e-10)


def test_a_branch_that_ends_is_kept_to_its_end():
    # The branch x = p stops at p = 1, beyond which its residual is not finite.
    def residual(x, p):
        return x - (p if p <= 1.0 else math.nan)

    ended = trace(residual, lambda x, p: np.eye(1), lambda x, p: -np.ones(1), [0.0], 0.0, min_step=1e-4)
    assert ended.outcome is Outcome.PATH_LOST
    assert 1.0 - 1e-3 < ended.parameters[-1] <= 1.0
    assert len(ended.points) > 5


def test_a_start_that_is_no_solution_is_named_as_newton_named_it():
    nowhere = trace(lambda x, p: x**2 + 1.0, lambda x, p: np.diag(2.0 * x), lambda x, p: np.zeros(1), [0.7], 0.0)
    assert nowhere.outcome is Outcome.STEP_LIMIT
    assert nowhere.points.shape == (0, 1)
    assert nowhere.tangents.shape == (0, 2)


# What the caller knows of the unknowns: weight, fraction, size, condition


def test_a_branch_does_not_depend_on_the_units_of_its_unknowns(bratu, branch):
    unit = 10.0 ** np.random.default_rng(3391).uniform(-6.0, 6.0, bratu.n)
    scaled = trace(
        lambda v, p: bratu.residual(v / unit, p),
        lambda v, p: bratu.jacobian(v / unit, p) / unit,
        lambda v, p: bratu.derivative(v / unit, p),
        np.zeros(bratu.n),
        0.0,
        weight=lambda v: 1.0 / (bratu.n * unit**2),
        size=lambda v, dv: np.abs(dv / unit).max() / (1.0 + np.abs(v / unit).max()),
        max_points=len(branch.points),
    )
    assert scaled.outcome.ok
    np.testing.assert_allclose(scaled.parameters, branch.parameters, atol=1e-8)
    np.testing.assert_allclose(scaled.points / unit, branch.points, atol=1e-8)
    assert abs(scaled.folds[0].parameter - FOLD) < 1e-10


def decay(**arguments):
    """The branch x = exp(-p)."""
    return trace(
        lambda x, p: np.log(x) + p,
        lambda x, p: np.diag(1.0 / x),
        lambda x, p: np.ones(1),
        [1.0],
        0.0,
        **arguments,
    )


def test_weights_that_follow_the_state_measure_the_logarithm_of_the_unknowns():
    # In ln x and p the branch is straight: ds^2 = 3 (d ln x)^2 + dp^2 = 4 dp^2, but for the bend of a step.
    for step in (0.1, 0.01):
        s = []
        even = decay(
            weight=lambda x: 3.0 / x**2,
            step=step,
            max_step=step,
            max_points=round(4.0 / step),
            on_point=lambda a, _, s=s: s.append(a),
        )
        assert even.outcome.ok
        assert even.parameters[-1] > 1.9
        np.testing.assert_allclose(even.parameters, np.array(s) / 2.0, rtol=0.3 * step)
        np.testing.assert_allclose(even.tangents[:, -1], 0.5, rtol=1e-9)
        np.testing.assert_allclose(even.tangents[:, 0], -0.5 * even.points[:, 0], rtol=1e-9)


def test_a_large_step_along_unknowns_that_shrink_does_not_count_as_a_turn():
    # x falls to less than a third on each step; its relative slope, all that the weight sees, never changes.
    steep = decay(weight=lambda x: 1e4 / x**2, step=70.0, max_step=70.0, max_points=5)
    assert steep.outcome.ok
    assert steep.failures == 0
    assert (steep.points[1:] / steep.points[:-1]).max() < 1.0 / 3.0


def test_a_prediction_leaves_the_last_point_no_farther_than_the_fraction_allows():
    limits = {"step": 3.0, "max_step": 3.0, "bounds": (0.0, 4.0)}
    bare = decay(**limits)
    limited = decay(fraction=lambda x, dx: min(1.0, 0.7 * x[0] / max(-dx[0], 1e-300)), **limits)
    for traced in (bare, limited):
        assert traced.outcome.ok
        np.testing.assert_allclose(traced.points[:, 0], np.exp(-traced.parameters), rtol=1e-9)
    assert bare.failures > 0  # the tangent at p = 0 meets zero at p = 1, where ln x ends
    assert limited.failures == 0


def test_a_size_of_the_callers_own_makes_small_unknowns_as_exact_as_large_ones():
    scale = np.array([1e-9, 1e3])

    def error(**size):
        traced = trace(
            lambda x, p: (x / scale) ** [5, 1] - p,
            lambda x, p: np.diag([5.0, 1.0] * (x / scale) ** [4, 0] / scale),
            lambda x, p: -np.ones(2),
            scale,
            1.0,
            weight=lambda x: [1.0, 0.5e-6],  # blind to the small unknown, as the default is
            step=1.0,
            max_points=4,
            **size,
        )
        assert traced.outcome.ok
        exact = scale * traced.parameters[:, None] ** [0.2, 1.0]
        return np.abs(traced.points / exact - 1.0).max(axis=0)

    assert error(size=lambda x, dx: np.abs(dx / x).max()).max() < 1e-10
    by_default = error()
    assert by_default[1] < 1e-10
    assert by_default[0] > 1e-6


def test_the_caller_says_how_ill_conditioned_a_jacobian_may_be():
    # Past p = 1/2 the second equation is tiny: small pivots, though well conditioned once it is scaled.
    def tiny(p):
        return np.array([1.0, 1.0 if p < 0.5 else 1e-20])

    def follow(p, **limit):
        return trace(
            lambda x, p: tiny(p) * (x - p),
            lambda x, p: np.diag(tiny(p)),
            lambda x, p: -tiny(p),
            [p, p],
            p,
            bounds=(0.0, 1.0),
            **limit,
        )

    for start in (0.0, 0.75):
        tolerant = follow(start)
        assert tolerant.outcome.ok
        assert tolerant.parameters[-1] == 1.0
    strict = follow(0.0, singular_below=1.0)
    assert strict.outcome is Outcome.PATH_LOST
    assert 0.49 < strict.parameters[-1] < 0.5
    assert follow(0.75, singular_below=1.0).outcome is Outcome.SINGULAR


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("weight", {"weight": lambda x: 0.0}),
        ("weight", {"weight": lambda x: [math.nan]}),
        ("weight", {"weight": lambda x: math.inf}),
        ("weight", {"weight": lambda x: [1.0, 1.0]}),
        ("direction", {"direction": 0}),
        ("bounds", {"bounds": (0.5, 1.0)}),
        ("bounds", {"bounds": (-1.0, 0.0)}),
    ],
)
def test_trace_refuses_impossible_arguments_by_name(name, arguments):
    with pytest.raises(ValueError, match=name):
        circle(**arguments)
