"""Errors of means of series that remember: neighbouring samples are alike and count for less than independent ones."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from stribeck._types import Array

__all__ = ["FEWEST", "FEWEST_BLOCKS", "error_of_mean", "errors_of_means", "memory"]

FEWEST = 3  # Repeats from which their scatter is an error, and rows from which a setting is one

FEWEST_BLOCKS = 8  # Blocks of a series from which the correlation of neighbours is estimated

SMALL_PROBABILITY = 0.01  # Probability below which the scatter of one step is its own and not that of all


def errors_of_means(series: Sequence[Array]) -> list[float]:
    """Return the standard errors of the means of series that share variance and correlation, given their deviations."""
    best = [0.0] * len(series)
    block = 1
    # Blocks show slow changes of long steps; steps too short for blocks may remember longer than themselves.
    short = bool(np.median([len(each) for each in series]) < 2 * FEWEST_BLOCKS)
    while True:
        blocks = [each[: len(each) // block * block].reshape(-1, block).mean(axis=1) for each in series]
        blocks = [each - each.mean() if len(each) else each for each in blocks]
        if block > 1 and np.median([len(each) for each in blocks]) < FEWEST_BLOCKS:
            return best
        others = [[*blocks[:i], *blocks[i + 1 :]] for i in range(len(blocks))]
        own = [
            len(each) >= FEWEST_BLOCKS and _is_its_own(each, memory(rest)) for each, rest in zip(blocks, others, strict=True)
        ]
        common = memory([each for each, apart in zip(blocks, own, strict=True) if not apart], short)
        for i, (each, apart) in enumerate(zip(blocks, own, strict=True)):
            error = error_of_mean(max(1.0, len(series[i]) / block), *common)
            best[i] = max(best[i], error, error_of_mean(len(each), *memory([each])) if apart else 0.0)
        block *= 2


def memory(series: Sequence[Array], as_pass: bool = False) -> tuple[float, float]:
    """Return variance and correlation of neighbours of series about their means, without the bias of these means."""
    long = [each for each in series if len(each) >= FEWEST]
    squares = sum(float(each @ each) for each in series)
    freedom = sum(max(len(each) - 1, 0) for each in series)
    if not squares or not freedom:
        return 0.0, 0.0
    if not long:
        return squares / freedom, 0.0
    rows = float(np.mean([len(each) for each in long]))
    products = sum(float(each[1:] @ each[:-1]) for each in long)
    found = products / sum(float(each @ each) for each in long)
    # What never forgets, a step or a pass, is a single row.
    longest = sum(len(each) for each in series) if as_pass else rows
    low, high = 0.0, (longest - 1) / (longest + 1)
    for _ in range(40):
        rho = 0.5 * (low + high)
        low, high = (rho, high) if _expected(rows, rho) < found else (low, rho)
    expected = sum(len(each) * (1 - _share(len(each), rho)) for each in series if len(each) > 1)
    return float(squares / expected), rho


def _expected(rows: float, rho: float) -> float:
    """Return the expected correlation of neighbours about the mean of a series."""
    share, first = _share(rows, rho), (1 - rho**rows) / (rows * (1 - rho))
    return float(((rows - 1) * rho - (rows + 1) * share + 2 * first) / (rows * (1 - share)))


def _share(rows: float, rho: float) -> float:
    """Return the variance of the mean of a series over that of its rows."""
    if rows <= 1:
        return 1.0
    sums = (1 + rho) / (1 - rho) - 2 * rho * (1 - rho**rows) / (rows * (1 - rho) ** 2)
    return float(min(1.0, sums / rows))


def error_of_mean(rows: float, variance: float, rho: float) -> float:
    """Return the standard error of the mean of rows of a variance whose neighbours have a correlation."""
    return math.sqrt(variance * _share(rows, rho))


def _is_its_own(series: Array, common: tuple[float, float]) -> bool:
    """Return whether a series scatters or remembers more than chance lets one of the common kind."""
    from scipy.stats import chi2

    rows, alone = len(series), memory([series])
    freedom = max(1.0, 1 / _share(rows, common[1]) - 1)
    scatters = alone[0] > common[0] * float(chi2.ppf(1 - SMALL_PROBABILITY, freedom)) / freedom
    return bool(scatters) or alone[1] - common[1] > 2 / math.sqrt(rows)
