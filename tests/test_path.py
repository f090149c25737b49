"""Following a path of expanded states: of functions that are known, so that nothing depends on a contact."""

import math
from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from stribeck import Outcome
from stribeck.numerics.continuation import follow
from stribeck.numerics.dual import Dual
from stribeck.numerics.series import radius
from stribeck.solver.path.hermite_path import HermitePath, Knot
from stribeck.solver.path.path import Expansion, Interval, SolvedPath

pytestmark = pytest.mark.quick

ORDER = 10

ROUNDING = 1e-10
"""What the samples of the coefficients leave, relative to the scales."""


def values(s):
    """A share that falls from one to nothing, what crosses zero, and a power with a bend."""
    return np.stack([1 / (1 + np.exp(2 * s)), np.exp(0.2 * s) - 1, np.exp(0.5 * s) * np.sqrt(1 + (s + 3) ** 2)], axis=-1)


@dataclass
class Known:
    """The problem whose states are those functions."""

    path = SolvedPath
    error: float = 0.0
    order: int = ORDER
    longest: float = math.inf
    fails_below: float = -math.inf
    solved: list = field(default_factory=list)
    controlled: np.ndarray = field(default_factory=lambda: np.ones(3, bool))

    def solve(self, s, near):
        if s < self.fails_below or (near and max(abs(s - one.coordinate) for one in near) > self.longest):
            return Outcome.STEP_LIMIT
        self.solved.append(s)
        places = 0.15 * np.exp(1j * np.pi * (np.arange(12) + 0.5) / 12)  # on a circle: Cauchy's integral
        around, to_series = values(s + places), places ** -np.arange(self.order + 1)[:, None] / 12
        series, logs = (to_series @ around).real, np.full((self.order + 1, 3), np.nan)
        logs[:, [0, 2]] = (to_series @ np.log(around[:, [0, 2]])).real
        return Expansion(s, None, series, logs, np.full(3, self.error), radius(series, 0.15))

    @property
    def sign_changing(self):
        return np.array([False, True, False])

    def scales(self, found, s):
        scale = np.abs(found)
        scale[:, 0] = 1.0
        scale[:, 1] = np.maximum(scale[:, 1], 1e-3)
        return scale

    def checked_error(self, left, right):
        return np.zeros(3)

    negligible = 0.0

    def read_scales(self, values):
        return np.empty(0)

    def read(self, left, right, parts):
        return np.empty((len(parts), 0)), np.empty((len(parts), 0)), []


def wrong(path, s):
    found, errors = path.at(s)
    return np.abs(found - values(s)) / path.problem.scales(values(s), s), errors


def test_everything_between_the_solved_states_is_within_its_stated_error(subtests):
    for rtol in [1e-4, 1e-6, 1e-9]:
        with subtests.test(rtol=rtol):
            path = follow(Known(), 3.0, -9.0, rtol)
            assert path.outcome.ok and (path.coordinates[0], path.coordinates[-1]) == (-9.0, 3.0)
            assert len(path.expansions) < 25
            found, errors = wrong(path, np.linspace(-9, 3, 2001))
            assert errors.max() <= rtol
            assert (found <= errors + max(ROUNDING, 1e-3 * rtol)).all()


def test_polynomials_of_few_orders_on_long_intervals_err_by_hardly_more_than_they_state():
    problem, parts, worst = Known(order=4), np.linspace(0.05, 0.95, 21), []
    for start in np.arange(-6, 1.01, 0.25):
        for length in (0.8, 1.2, 1.6, 2.0):
            interval = Interval(problem, problem.solve(start, []), problem.solve(start + length, []))
            (found, errors), true = interval.at(parts), values(start + parts * length)
            worst.append((np.abs(found - true) / problem.scales(true, parts) / (errors + ROUNDING)).max())
    assert max(worst) < 1.5 and np.mean(np.array(worst) > 1) < 0.02


def test_the_stated_error_holds_that_of_the_solved_states():
    path = follow(Known(error=3e-7), 3.0, -9.0, 1e-6)
    _, errors = wrong(path, np.linspace(-9, 3, 301))
    assert errors[:, [0, 2]].min() >= 3e-7 and errors.max() <= 1e-6 + 3e-7 * 1e3  # what crosses zero keeps absolute errors
    assert errors[:, [0, 2]].max() <= 1e-6


def test_a_share_far_below_one_keeps_its_digits():
    path = follow(Known(), 30.0, -9.0, 1e-6)
    s = np.linspace(20, 30, 101)
    np.testing.assert_allclose(path.at(s)[0][:, 0], values(s)[:, 0], rtol=1e-4)


def test_steps_that_fail_are_taken_shorter():
    path = follow(Known(longest=0.5), 3.0, -3.0, 1e-6)
    assert path.outcome.ok
    assert np.diff(path.coordinates).max() <= 0.5


def test_a_lost_path_reaches_as_far_as_it_was_solved():
    path = follow(Known(fails_below=-2.0), 3.0, -9.0, 1e-6)
    assert path.outcome is Outcome.STEP_LIMIT
    assert -2.0 <= path.coordinates[0] < -1.95
    assert follow(Known(fails_below=5.0), 3.0, -9.0, 1e-6).expansions == ()


def test_a_path_ends_where_rounding_leaves_more_than_the_tolerance():
    class Rounded(Known):
        asked = 0

        def solve(self, s, near):
            self.asked += 1
            return Outcome.ROUNDING if s < -4.0 else super().solve(s, near)

    problem = Rounded()
    path = follow(problem, 3.0, -9.0, 1e-6)
    assert path.outcome is Outcome.ROUNDING
    assert -4.0 <= path.coordinates[0] < -3.5
    assert problem.asked - len(problem.solved) < 20


def test_a_path_that_halves_without_end_ends(monkeypatch):
    monkeypatch.setattr("stribeck.numerics.continuation.MAX_STATES", 50)
    monkeypatch.setattr("stribeck.numerics.continuation.MAX_LOG_STEP", 0.2)

    class Doubted(Known):
        def checked_error(self, left, right):
            return np.full(3, 100.0 * (right.coordinate - left.coordinate))

    problem = Doubted()
    path = follow(problem, 3.0, -9.0, 1e-6)
    assert path.outcome is Outcome.STATE_LIMIT
    assert len(problem.solved) < 150
    assert path.coordinates[-1] == 3.0 and path.coordinates[0] < 3.0


class Noisy:
    """A parabola whose values have errors that no more states reduce."""

    path, names, shares, summands = HermitePath, ("one", "other", "third"), (0, 1), ((1, 2),)
    one_signed, controlled = np.zeros(3, dtype=bool), np.ones(3, dtype=bool)

    def __init__(self, noise):
        self.noise, self.rng, self.solved = noise, np.random.default_rng(1), 0

    def units(self, s):
        return np.ones((len(s), 3))

    def scales(self, values, s):
        return np.ones((len(s), 3))

    def solve(self, s, near=()):
        self.solved += 1
        values = s * s + self.noise * self.rng.choice([-1.0, 1.0], 3)
        return Knot(s, values, np.full(3, 2.0 * s), np.full(3, self.noise), None)


def test_no_interval_is_halved_for_what_the_errors_of_its_states_explain():
    exact, noisy = Noisy(0.0), Noisy(8e-4)
    for problem in (exact, noisy):
        path = follow(problem, 1.0, -1.0, 1e-3)
        assert path.outcome.ok
    assert noisy.solved <= exact.solved + 4
    s = np.linspace(-1.0, 1.0, 101)
    found, errors = path.at(s)
    assert (np.abs(found - (s * s)[:, None]) <= errors + 1e-12).all()


class Kinked(Noisy):
    """A parabola that goes on as a straight line beyond zero, where states are of another kind."""

    def solve(self, s, near=()):
        found = super().solve(s, near)
        is_beyond = s > 0.013
        return replace(found, values=found.values - is_beyond * (s - 0.013), slopes=found.slopes - is_beyond, kind=is_beyond)


def test_where_the_kind_of_states_changes_the_error_is_that_of_a_kink():
    path, s = follow(Kinked(0.0), 1.0, -1.0, 1e-3), np.linspace(-1.0, 1.0, 801)
    found, errors = path.at(s)
    missed = np.abs(found[:, 0] - s * s + np.maximum(s - 0.013, 0.0))
    assert path.outcome.ok and missed.max() > 1e-5
    assert (missed <= errors[:, 0] + 1e-12).all()
    left, right = path.around(0.013)
    assert left.kind != right.kind and right.coordinate - left.coordinate < 0.05
    is_smooth = (s < left.coordinate) | (s > right.coordinate)
    assert errors[is_smooth].max() <= 1e-3 and missed[is_smooth].max() < 1e-9


def test_states_with_slopes_bring_the_derivatives_between_them():
    path, s = follow(Noisy(0.0), 1.0, -1.0, 1e-3), np.linspace(-0.9, 0.9, 41)
    np.testing.assert_allclose(path.smooth(Dual(s, np.ones_like(s))).slope, np.tile(2 * s[:, None], 3), atol=1e-12)


def test_an_interrupted_path_keeps_what_was_reported():
    seen = []

    def report(low, high):
        seen.append((low, high))
        if len(seen) == 3:
            raise KeyboardInterrupt

    path = follow(Known(), 3.0, -9.0, 1e-6, report)
    assert path.outcome is Outcome.INTERRUPTED
    assert path.coordinates[0] == seen[-1][0]
    assert [high for _, high in seen[1:]] == [low for low, _ in seen[:-1]]


def test_what_two_states_have_and_no_series_tells_between_them_is_wrong_without_bound():
    problem = Known()
    left, right = (problem.solve(s, []) for s in (0.0, 0.3))
    left.series[1:, 2] = np.nan
    right.series[:, 1] = np.nan  # what one of both has not is nothing between
    found, errors = Interval(problem, left, right).at(np.array([0.5]))
    assert np.isnan(found[0, 1:]).all()
    assert np.isfinite(errors[0, 0])
    assert np.isnan(errors[0, 1])
    assert errors[0, 2] == math.inf


def test_a_path_may_end_itself_and_go_on_from_both_ends():
    part = follow(Known(), 3.0, -9.0, 1e-6, until=lambda found: found.expansions[0].series[0, 0] > 0.9)
    assert -9.0 < part.coordinates[0] < 0.0 and part.outcome.ok
    both = follow(part.problem, follow(part.problem, part, -6.0, 1e-6), 5.0, 1e-6)
    assert (both.coordinates[0], both.coordinates[-1]) == (-6.0, 5.0) and (np.diff(both.coordinates) > 0).all()
    difference, errors = wrong(both, np.linspace(-6.0, 5.0, 301))
    assert (difference <= errors + ROUNDING).all()
