"""The start of a step that has not settled, cut where the standard error of the mean of the rest is smallest.

Source: MSER [White 1997]; the cut counts if the means differ by three standard errors, else what looks like a start is noise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from stribeck._types import Array
from stribeck.fits.table.correlated import FEWEST_BLOCKS, error_of_mean, memory
from stribeck.fits.table.repeats import CLEAR

__all__ = ["common_memory", "start_of"]


def common_memory(series: Sequence[Array]) -> tuple[float, float]:
    """Return variance and correlation of neighbours of the second halves of series, over their means."""
    halves = [each[len(each) // 2 :] for each in series if len(each) >= 2 * FEWEST_BLOCKS]
    return memory([each / each.mean() - 1 for each in halves if each.mean()])


def start_of(series: Array, common: tuple[float, float]) -> tuple[int, float]:
    """Return how many rows of a step belong to its start, and how far their mean lies from the others, over theirs."""
    rows = len(series)
    if rows < 2 * FEWEST_BLOCKS:
        return 0, 0.0
    left = np.arange(rows, 0, -1)
    sums, squares = (np.cumsum(each[::-1])[::-1] for each in (series, (series - series.mean()) ** 2))
    deviations = squares - left * (sums / left - series.mean()) ** 2
    cut = int(np.argmin((deviations / left**2)[: rows // 2 + 1]))
    if not cut:
        return 0, 0.0
    rest = float(series[cut:].mean())
    apart = float(series[:cut].mean()) - rest
    doubt = abs(rest) * math.hypot(error_of_mean(cut, *common), error_of_mean(rows - cut, *common))
    return (cut, apart / rest) if rest and abs(apart) > CLEAR * doubt else (0, 0.0)
