"""Cold starts under every contact law anywhere in the box: none fails, rtol holds, and the estimates cover the errors."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import stribeck as sb
from stribeck import Outcome
from stribeck.surfaces import SelfAffine, persson_law

SEED = 15_485_863


@cache
def laws():
    s = np.linspace(0.05, 6.0, 40)
    return {
        "persson": persson_law(SelfAffine(h_rms=1e-6, q0=1e4, q1=1e9, hurst=0.8)),
        "narrow": persson_law(SelfAffine(h_rms=1e-6, q0=1e5, q1=1e6, hurst=0.5, roll_off=2e5), gamma=1.0),
        "greenwood-williamson": sb.contact_laws.GreenwoodWilliamson(),
        "greenwood-tripp": sb.contact_laws.GreenwoodTripp(),
        "table": sb.contact_laws.TableLaw(s, np.exp(-s) + 0.3 * np.exp(-3 * s)),
        "function": sb.contact_laws.FunctionLaw(lambda s: -s - np.log(s)),
    }


def box(number, seed):
    """Random groups: speed 1e-12 to 1e6 and 0, load 1e-8 to 10, relative roughness 1e-6 to 1e3."""
    rng = np.random.default_rng(seed)
    for i in range(number):
        speed, load, kappa = 10 ** rng.uniform((-12, -8, -6), (6, 1, 3))
        yield sb.Groups(0.0 if i % 10 == 5 else speed, load, kappa * load)


def check(name, number, seed, true_errors, rtol=1e-6):
    """Solve cold; return the ratio of true to estimated error of each state."""
    ratios = []
    for groups in box(number, seed):
        s = sb.solve(replace(groups, law=laws()[name]), rtol=rtol)  # a failure raises
        assert s.outcome is Outcome.CONVERGED
        assert s.error_estimate <= rtol
        assert abs(s.contact_load_share + s.fluid_load_share - 1) < 1e-8, groups
        assert s.minimum_gap > 0 or groups.speed == 0
        ratios.append(np.nanmax(true_errors(s)) / s.error_estimate)
        assert ratios[-1] < 10, groups
    return np.array(ratios)


def test_random_states_are_solved_from_cold_and_their_errors_covered(subtests, true_errors):
    for number, name in enumerate(laws()):
        with subtests.test(name=name):
            assert (check(name, 2, SEED + 10 + number, true_errors) <= 1).all()


@pytest.mark.slow
@pytest.mark.parametrize("name", list(laws()))
def test_a_hundred_random_states_are_solved_from_cold_and_their_errors_covered(name, true_errors):
    assert (check(name, 100, SEED + 1, true_errors) <= 1).mean() >= 0.95


@pytest.mark.slow
@pytest.mark.parametrize("name", list(laws()))
def test_random_states_reach_a_small_tolerance_or_say_that_rounding_bounds_it(name, true_errors):
    covered = []
    for groups in box(20, SEED + 2):
        s = sb.solve(replace(groups, law=laws()[name]), rtol=1e-9, on_failure="return")
        assert s.outcome in (Outcome.CONVERGED, Outcome.ROUNDING)
        assert s.error_estimate <= 1e-9 or s.outcome is Outcome.ROUNDING
        covered.append(np.nanmax(true_errors(s)) <= max(s.error_estimate, 1e-11))
    assert np.mean(covered) >= 0.95
