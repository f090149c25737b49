"""Intervals hold the truth as often as they say, on synthetic experiments."""

import numpy as np
import pytest
from fit_data import TRUE, noisy
from scipy.stats import binom

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


def test_intervals_cover_in_3_experiments():
    check(*covered(3, 500), 3)


@pytest.mark.slow
def test_intervals_cover_in_200_experiments():
    check(*covered(200, 1000), 200)
