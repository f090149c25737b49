"""Continuation: on a branch known in closed form, and on states that are bare numbers."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.special import lambertw

from stribeck import Outcome
from stribeck.numerics.continuation import Steps, extrapolation_weights
from stribeck.numerics.newton import Dense, StepControl, root_find

pytestmark = pytest.mark.quick

# Semenov's thermal explosion: heat made, p c exp(x), equals heat lost, x. The cold branch x = -W(-p c) ends
# at p c = 1/e, here for three vessels side by side.
VESSELS = np.array([0.2, 1.0, 0.5])
EXPLOSION = math.exp(-1.0)


def temperature(p):
    """The cold branch."""
    return -lambertw(-p * VESSELS).real


def heated(stop):
    """Follow the cold branch from p = 0 by Newton's iteration and extrapolation."""

    def correct(p, history):
        guess = np.zeros(3)
        if history:
            coordinates, roots = zip(*history, strict=True)
            guess = extrapolation_weights(coordinates, p) @ np.array([root.x for root in roots])
        problem = Dense(lambda x: x - p * VESSELS * np.exp(x), lambda x: np.diag(1.0 - p * VESSELS * np.exp(x)))
        return root_find(problem, guess, StepControl(max_steps=12))

    return Steps(correct, first=0.05).to(stop, 0.0)


def test_a_path_follows_a_branch_to_its_end():
    path = heated(0.36)
    assert path.outcome.ok and path.coordinates[-1] == 0.36
    for p, root in zip(path.coordinates, path.states, strict=True):
        np.testing.assert_allclose(root.x, temperature(p), atol=1e-9)


def test_a_path_halts_before_a_fold_and_keeps_the_branch_behind_it():
    path = heated(0.5)
    assert path.outcome is Outcome.PATH_LOST
    assert EXPLOSION - 1e-3 < path.coordinates[-1] < EXPLOSION
    for p, root in zip(path.coordinates, path.states, strict=True):
        np.testing.assert_allclose(root.x, temperature(p), atol=1e-6)


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


def test_a_path_hits_its_ends_exactly(subtests):
    for start, stop in [(0.0, 3.0), (3.0, -1.0), (-2.0, 0.1)]:
        with subtests.test(start=start, stop=stop):
            path = Steps(Corrector(), first=0.1).to(stop, start)
            assert path.outcome.ok
            assert (path.coordinates[0], path.coordinates[-1]) == (start, stop)
            assert (np.diff(path.coordinates) * np.sign(stop - start) > 0.0).all()


def test_a_failed_step_is_retried_shorter_and_nothing_behind_it_is_lost():
    corrector = Corrector(fails=lambda s, before: s > 1.0 and s - before > 0.03)
    path = Steps(corrector, first=0.1).to(2.0, 0.0)
    assert path.outcome.ok
    asked = [s for s, _ in corrector.asked]
    assert set(path.coordinates) < set(asked)
    for (s, history), (following, same) in zip(corrector.asked, corrector.asked[1:], strict=False):
        if s not in path.coordinates:
            assert following - same[-1] == pytest.approx(0.5 * (s - history[-1]))
            assert same == history
    assert all(state.outcome.ok for state in path.states)


def test_a_state_that_is_none_counts_as_a_failure():
    path = Steps(lambda s, history: None if s > 1.0 else Plain(s), first=0.1).to(2.0, 0.0)
    assert path.outcome is Outcome.PATH_LOST


def test_a_failed_start_is_named_by_its_own_outcome():
    path = Steps(Corrector(fails=lambda s, before: True)).to(2.0, 0.0)
    assert path.outcome is Outcome.STEP_LIMIT
    assert path.states == ()


def test_a_path_begins_at_a_known_state():
    known = Plain(0.0)
    corrector = Corrector()
    path = Steps(corrector, first=0.1).to(3.0, (0.0, known))
    assert path.outcome.ok and path.states[0] is known
    assert corrector.asked[0] == (0.1, [0.0])


def test_extrapolation_is_exact_for_polynomials_of_its_order():
    s = np.array([0.0, 0.3, 1.1, 1.2])
    for degree in range(4):
        assert extrapolation_weights(s, 2.5) @ s**degree == pytest.approx(2.5**degree, rel=1e-12)
    assert extrapolation_weights([4.0], 5.0).tolist() == [1.0]
