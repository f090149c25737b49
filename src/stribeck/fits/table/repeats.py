"""Repeats of a measured curve: averaged with the scatter as error, and run-in told apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

__all__ = ["Averaged", "Row", "average_repeats"]

SAME_SPEED = 0.01
"""Relative difference up to which speeds are the same point."""

FEWEST = 3
"""Repeats from which their scatter is an error, and rows from which a setting is one."""

RUN_IN, CLEAR = 0.03, 3.0
"""Relative difference of a first run from the later ones, and that in standard errors, from which it is run-in."""

Row = tuple[str, int, float, float, float, dict[str, float]]


@dataclass(frozen=True)
class Averaged:
    """Rows in which repeats have been averaged.

    Attributes
    ----------
    rows : list of tuple
        The rows: curve, number, speed, friction, its standard error, inputs.
    notes : tuple of str
        What was put together and left out.
    run_in : tuple of int
        Numbers of the rows that look like run-in.
    """

    rows: list[Row]
    notes: tuple[str, ...]
    run_in: tuple[int, ...]


def average_repeats(rows: Sequence[Row], runs: Sequence[str], keep_run_in: bool) -> Averaged | None:
    r"""Average repeats at the same speed of a curve: their mean and its standard error.

    .. math:: \bar\mu = \frac{1}{n} \sum_i \mu_i, \qquad s = \bar\mu \, \sigma / n^{1/2}

    with the relative scatter :math:`\sigma` of single rows about their means, pooled over all speeds.

    Parameters
    ----------
    rows : sequence of tuple
        Curve, number, speed, friction, error and inputs of each row.
    runs : sequence of str
        The run of each row; all empty if the file has none.
    keep_run_in : bool
        Whether runs that look like run-in are kept.

    Returns
    -------
    Averaged or None
        None where fewer than three rows share a speed throughout.
    """
    marked, sentences = _run_in(rows, _counted(rows, runs))
    kept = [row for row in rows if keep_run_in or row[1] not in marked]
    sizes = [len(group) for group in _at_same_speed(rows).values()]
    groups = _at_same_speed(kept)
    if not groups or np.median(sizes) < FEWEST:
        return None
    freedom = sum(len(group) - 1 for group in groups.values())
    squares = 0.0
    means = {}
    for key, group in groups.items():
        mean = sum(row[3] for row in group) / len(group)
        means[key] = mean
        squares += sum((row[3] / mean - 1) ** 2 for row in group)
    scatter = math.sqrt(squares / freedom) if freedom else 0.0
    made = [
        (
            group[0][0],
            group[0][1],
            math.exp(sum(math.log(row[2]) for row in group) / len(group)),
            means[key],
            max(scatter, 1e-6) * means[key] / math.sqrt(len(group)),
            group[0][5],
        )
        for key, group in groups.items()
    ]
    sentences.append(
        f"{len(kept)} rows at {len(made)} speeds put together: the scatter of repeats, {100 * scatter:.2g} % of a single row, "
        "became the error of each mean; repeats = false in [fit] keeps all rows."
    )
    return Averaged(made, tuple(sentences), tuple(sorted(marked)))


def _curve_of(row: Row) -> tuple[str, tuple[tuple[str, float], ...]]:
    """Return name and inputs of the curve of a row."""
    return row[0], tuple(sorted(row[5].items()))


def _at_same_speed(rows: Sequence[Row]) -> dict[Any, list[Row]]:
    """Return rows of the same curve, inputs and speed together."""
    groups: dict[Any, list[Row]] = {}
    for row in sorted(rows, key=lambda row: (row[0], sorted(row[5].items()), row[2])):
        key = _curve_of(row)
        at = [k for k in groups if k[0] == key and abs(k[1] / row[2] - 1) <= SAME_SPEED]
        groups.setdefault(at[-1] if at else (key, row[2]), []).append(row)
    return groups


def _counted(rows: Sequence[Row], runs: Sequence[str]) -> Sequence[str]:
    """Return the runs; where each row has a label of its own, as steps have, the k-th row at a speed is of run k."""
    if len(set(runs)) < len(runs):
        return runs
    seen: list[Row] = []
    found = []
    for row in rows:
        alike = [each for each in seen if each[0] == row[0] and each[5] == row[5] and abs(each[2] / row[2] - 1) <= SAME_SPEED]
        seen.append(row)
        found.append(str(len(alike) + 1))
    return found


def _run_in(rows: Sequence[Row], runs: Sequence[str]) -> tuple[set[int], list[str]]:
    """Return the rows of first runs that differ from later ones, and a note on them."""
    marked: set[int] = set()
    said = []
    for curve in dict.fromkeys(map(_curve_of, rows)):
        mine = [(row, run) for row, run in zip(rows, runs, strict=True) if _curve_of(row) == curve]
        names = list(dict.fromkeys(run for _, run in mine))
        if len(names) < FEWEST:
            continue
        first = [row for row, run in mine if run == names[0]]
        later = [row for row, run in mine if run != names[0]]
        ratios, scatter = [], []
        for row in first:
            others = [math.log(each[3]) for each in later if abs(each[2] / row[2] - 1) <= SAME_SPEED]
            if len(others) >= 2:
                ratios.append(math.log(row[3]) - float(np.mean(others)))
                scatter.append(float(np.var(others, ddof=1)) * (1 + 1 / len(others)))
        if len(ratios) < 3:
            continue
        mean, error = float(np.mean(ratios)), math.sqrt(float(np.mean(scatter)) / len(ratios))
        if abs(mean) > max(RUN_IN, CLEAR * error):
            numbers = [row[1] for row in first]
            marked |= set(numbers)
            of = "".join(f", {part}" for part in (curve[0], *(f"{name} {value:g}" for name, value in curve[1])) if part)
            said.append(
                f"Run {names[0]}{of} lies {100 * math.expm1(mean):+.0f} % from the later ones: run-in, rows "
                f'{min(numbers)} to {max(numbers)}, left out of the means; run_in = "keep" in [fit] keeps it.'
            )
    return marked, said
