"""Continuation on problems with known branches: the circle, and Bratu's equation with its fold at 3.5138."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import brentq

from stribeck.continuation import extrapolation_weights, march, natural, trace
from stribeck.newton import Outcome

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

    def natural(self, parameters, **arguments):
        return natural(self.residual, self.jacobian, np.zeros(self.n), parameters, **arguments)


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
    nowhere = trace(
        lambda x, p: x**2 + 1.0, lambda x, p: np.diag(2.0 * x), lambda x, p: np.zeros(1), [0.7], 0.0
    )
    assert nowhere.outcome is Outcome.STEP_LIMIT
    assert nowhere.points.shape == (0, 1)
    assert nowhere.tangents.shape == (0, 2)


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("direction", {"direction": 0}),
        ("bounds", {"bounds": (0.5, 1.0)}),
        ("bounds", {"bounds": (-1.0, 0.0)}),
    ],
)
def test_trace_refuses_impossible_arguments_by_name(name, arguments):
    with pytest.raises(ValueError, match=name):
        circle(**arguments)


# Natural continuation


def test_natural_continuation_meets_every_parameter_asked_for(bratu):
    parameters = [0.0, 0.5, 2.0, 3.0, 3.5]
    path = bratu.natural(parameters)
    assert path.outcome.ok
    assert set(parameters) <= set(path.coordinates)
    for p in parameters[1:]:
        assert path.at(p).x.max() == pytest.approx(exact_centre(p, "lower"), abs=1e-8)


def test_natural_continuation_halts_before_a_fold_and_keeps_the_branch_behind_it(bratu):
    path = bratu.natural([0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
    assert path.outcome is Outcome.PATH_LOST
    assert "lost" in path.outcome.value
    assert not path.failure.outcome.ok
    assert FOLD - 1e-3 < path.coordinates[-1] < FOLD
    assert {1.0, 2.0, 3.0} <= set(path.coordinates)
    for p, root in zip(path.coordinates[1:], path.states[1:], strict=True):
        assert root.x.max() == pytest.approx(exact_centre(p, "lower"), abs=1e-6)
    with pytest.raises(ValueError, match=r"no point at 4\.0.*lost"):
        path.at(4.0)


def test_natural_continuation_runs_downward_too(bratu):
    up = bratu.natural([0.0, 3.0])
    down = natural(bratu.residual, bratu.jacobian, up.at(3.0).x, [3.0, 1.5, 0.0])
    assert down.outcome.ok
    assert np.abs(down.at(0.0).x).max() < 1e-10


@pytest.mark.parametrize("parameters", [[1.0], [0.0, 1.0, 1.0], [0.0, 2.0, 1.0]])
def test_natural_refuses_parameters_that_do_not_rise_or_fall(bratu, parameters):
    with pytest.raises(ValueError, match="parameters"):
        bratu.natural(parameters)


# The engine, on states that are nothing but their coordinate


@dataclass
class Plain:
    s: float
    outcome: Outcome = Outcome.CONVERGED
    effort: int = 3


class Corrector:
    """Returns plain states; fails where ``fails(s, before)`` is true; keeps what it was asked."""

    def __init__(self, fails=lambda s, before: False, effort=3):
        self.fails, self.effort, self.asked = fails, effort, []

    def __call__(self, s, history):
        before = history[-1][0] if history else s
        self.asked.append((s, [c for c, _ in history]))
        if self.fails(s, before):
            return Plain(s, Outcome.STEP_LIMIT)
        return Plain(s, effort=self.effort)


LENGTHS = {"first_step": 0.1, "max_step": 0.5, "min_step": 1e-3}


@pytest.mark.parametrize(("start", "stop"), [(0.0, 3.0), (3.0, -1.0), (-2.0, 0.1)])
def test_a_march_hits_its_ends_and_every_target_exactly(start, stop):
    targets = list(np.random.default_rng(5).uniform(min(start, stop), max(start, stop), 9))
    path = march(Corrector(), start, stop, targets=targets, **LENGTHS)
    assert path.outcome.ok
    assert {start, stop, *targets} <= set(path.coordinates)
    assert (path.coordinates[0], path.coordinates[-1]) == (start, stop)
    steps = np.diff(path.coordinates) * np.sign(stop - start)
    assert (steps > 0.0).all()
    assert steps.max() <= 0.5 * (1 + 1e-12)
    for target in targets:
        assert path.at(target).s == target


def test_steps_grow_with_easy_corrections_and_shrink_with_hard_ones():
    easy = np.diff(march(Corrector(effort=1), 0.0, 100.0, **LENGTHS | {"max_step": 1e3}).coordinates)
    hard = np.diff(march(Corrector(effort=9), 0.0, 0.5, **LENGTHS).coordinates)
    even = np.diff(march(Corrector(effort=4), 0.0, 2.0, **LENGTHS).coordinates)
    np.testing.assert_allclose(easy[1:6] / easy[:5], 2.0)
    np.testing.assert_allclose(hard[1:6] / hard[:5], 0.5)
    assert hard.min() >= 0.5e-3
    np.testing.assert_allclose(even[:-2], 0.1)


def test_a_target_close_by_does_not_shorten_the_steps_after_it():
    path = march(Corrector(effort=4), 0.0, 2.0, targets=[0.01, 0.012], **LENGTHS)
    np.testing.assert_allclose(np.diff(path.coordinates)[2:10], 0.1)


def test_a_failed_step_is_retried_shorter_and_nothing_behind_it_is_lost():
    corrector = Corrector(fails=lambda s, before: s > 1.0 and s - before > 0.03)
    path = march(corrector, 0.0, 2.0, **LENGTHS)
    assert path.outcome.ok
    assert path.failures > 0
    assert path.failure.outcome is Outcome.STEP_LIMIT
    asked = [s for s, _ in corrector.asked]
    assert set(path.coordinates) <= set(asked)
    assert len(asked) == len(path.coordinates) + path.failures
    for (s, history), (following, same) in zip(corrector.asked, corrector.asked[1:], strict=False):
        if s not in path.coordinates:
            assert following - same[-1] == pytest.approx(0.5 * (s - history[-1]))
            assert same == history
    assert all(state.outcome.ok for state in path.states)


def test_the_step_after_a_retried_one_does_not_grow():
    corrector = Corrector(fails=lambda s, before: s - before > 0.15, effort=1)
    march(corrector, 0.0, 5.0, **LENGTHS)
    steps = [s - history[-1] for s, history in corrector.asked[1:-2]]
    failed = [i for i, step in enumerate(steps[:-2]) if step > 0.15]
    assert len(failed) > 5
    for i in failed:
        np.testing.assert_allclose(steps[i + 1 : i + 3], 0.5 * steps[i])


def test_a_state_that_is_none_counts_as_a_failure():
    path = march(lambda s, history: None if s > 1.0 else Plain(s), 0.0, 2.0, **LENGTHS)
    assert path.outcome is Outcome.PATH_LOST
    assert path.failure is None
    assert path.failures > 0


def test_a_path_with_no_way_on_is_lost_next_to_its_end():
    path = march(Corrector(fails=lambda s, before: s > 1.0), 0.0, 2.0, targets=[0.25], **LENGTHS)
    assert path.outcome is Outcome.PATH_LOST
    assert 1.0 - 2e-3 < path.coordinates[-1] <= 1.0
    assert path.at(0.25).s == 0.25
    assert path.failure.outcome is Outcome.STEP_LIMIT


def test_a_failed_start_is_named_by_its_own_outcome():
    path = march(Corrector(fails=lambda s, before: True), 0.0, 2.0, **LENGTHS)
    assert path.outcome is Outcome.STEP_LIMIT
    assert path.states == ()


def test_outcomes_that_the_caller_accepts_count_as_points():
    path = march(
        lambda s, history: Plain(s, Outcome.ROUNDING),
        0.0,
        1.0,
        accept=(Outcome.CONVERGED, Outcome.ROUNDING),
        **LENGTHS,
    )
    assert path.outcome.ok
    assert path.states[-1].outcome is Outcome.ROUNDING


@pytest.mark.parametrize("where", ["correct", "on_point"])
def test_an_interrupt_keeps_the_points_before_it(where):
    def interrupt(s):
        if s > 1.0:
            raise KeyboardInterrupt

    def correct(s, history):
        if where == "correct":
            interrupt(s)
        return Plain(s)

    path = march(
        correct, 0.0, 3.0, on_point=lambda s, _: interrupt(s) if where == "on_point" else None, **LENGTHS
    )
    assert path.outcome is Outcome.INTERRUPTED
    assert len(path.states) == len(path.coordinates) >= 4
    assert (path.coordinates[-1] > 1.0) == (where == "on_point")

    resumed = march(
        Corrector(),
        path.coordinates[-1],
        3.0,
        history=list(zip(path.coordinates, path.states, strict=True)),
        **LENGTHS,
    )
    assert resumed.outcome.ok
    assert resumed.states[: len(path.states)] == path.states


def test_the_corrector_sees_the_last_accepted_points_only():
    corrector = Corrector(fails=lambda s, before: s - before > 0.2)
    path = march(corrector, 0.0, 2.0, order=2, **LENGTHS)
    accepted = []
    for s, history in corrector.asked:
        assert history == accepted[-3:]
        if not (accepted and corrector.fails(s, accepted[-1])):
            accepted.append(s)
    assert tuple(accepted) == path.coordinates
    assert path.failures > 0


def test_progress_is_told_each_accepted_point_once():
    told = []
    path = march(
        Corrector(fails=lambda s, before: s - before > 0.2),
        0.0,
        2.0,
        on_point=lambda s, state: told.append((s, state)),
        **LENGTHS,
    )
    assert told == list(zip(path.coordinates, path.states, strict=True))


def test_extrapolation_is_exact_for_polynomials_of_its_order():
    s = np.array([0.0, 0.3, 1.1, 1.2])
    for degree in range(4):
        assert extrapolation_weights(s, 2.5) @ s**degree == pytest.approx(2.5**degree, rel=1e-12)
    assert extrapolation_weights([4.0], 5.0).tolist() == [1.0]


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("min_step", {"min_step": 0.0}),
        ("max_step", {"max_step": 0.05}),
        ("targets", {"targets": [0.5, 2.5]}),
        ("targets", {"targets": [-0.5]}),
        ("stop", {"stop": math.inf}),
        ("history", {"history": [(0.5, Plain(0.5))]}),
    ],
)
def test_march_refuses_impossible_arguments_by_name(name, arguments):
    with pytest.raises(ValueError, match=name):
        march(Corrector(), **({"start": 0.0, "stop": 2.0} | LENGTHS | arguments))
