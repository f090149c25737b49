"""Intervals hold the truth as often as they say, on synthetic experiments."""

import math

import numpy as np
import pytest
from fit_data import TRUE, noisy
from scipy.stats import binom, chi2

import stribeck as sb

FREE = ("boundary_friction", "roughness", "modulus")


def covered(experiments, first_seed):
    """Return how often the two intervals of each input held the truth, and how often residuals were called structured."""
    held, alarms = np.zeros((len(FREE), 2), dtype=int), 0
    for seed in range(first_seed, first_seed + experiments):
        found = sb.fit(noisy(seed, noise=0.05), TRUE, free=FREE)
        assert found.converged
        alarms += bool(found.quality.messages)
        for i, name in enumerate(FREE):
            true, each = getattr(TRUE, name), found[name]
            for k, (low, high) in enumerate((each.interval_68, each.interval_95)):
                held[i, k] += low < true < high
    return held, alarms


def check(held, alarms, experiments):
    """Compare with what chance allows in all but one of ten thousand runs, each way."""
    for k, level in enumerate((0.6827, 0.95)):
        low, high = binom.ppf([1e-4, 1 - 1e-4], experiments, level)
        assert np.all(held[:, k] >= low) and np.all(held[:, k] <= high), held
    assert alarms <= binom.ppf(1 - 1e-4, experiments, 0.01)


def test_errors_with_their_correlations_are_those_of_the_scatter_in_3_experiments():
    """The sum of squares of the misses over the covariance has the distribution of chi-square, within 999 of 1000 each way."""
    total = 0.0
    for seed in range(500, 503):
        found = sb.fit(noisy(seed, noise=0.02), TRUE, free=FREE, intervals=False)
        missed = np.log([each.value / getattr(TRUE, each.name) for each in found.inputs])
        total += float(missed @ np.linalg.solve(found.covariance, missed))
    low, high = chi2.ppf([1e-3, 1 - 1e-3], 3 * len(FREE))
    assert low < total < high


@pytest.mark.slow
def test_intervals_cover_in_200_experiments():
    check(*covered(200, 1000), 200)


@pytest.mark.slow
def test_friction_of_a_full_film_alone_leaves_boundary_friction_open():
    # The fit may lie where rough, slippery asperities follow the noise: smooth ones of any friction explain it as well.
    start = TRUE.replace(boundary_friction=0.42, roughness=1.3e-6)
    found = sb.fit(noisy(2, noise=0.02, low=0.1, high=5.0, rows=10), start, free=["boundary_friction", "roughness", "modulus"])
    assert found["boundary_friction"].interval_95[1] == math.inf
