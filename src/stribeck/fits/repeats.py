"""Repeats of a measured curve: averaged with the error of their mean, and run-in told apart.

Rows of one step, one after the other at one speed, are samples of one series: what the series remembers makes the error of
its mean larger, as neighbouring samples are alike and count for less than independent ones.  Passes over the same speeds are
repeats: their scatter is an error, whatever a pass remembers.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.files.cells import rows_listed
from stribeck.quantities.formats import format_percent

FEWEST = 3  # Repeats from which their scatter is an error, and rows from which a setting is one

FEWEST_BLOCKS = 8  # Blocks of a series from which the correlation of neighbours is estimated

SMALL_PROBABILITY = 0.01  # Probability below which the scatter of one step is its own and not that of all


def noise_of_means(series: Sequence[Array]) -> list[tuple[float, float]]:
    """Return the standard error of the mean of each series, and how many independent values of its kind have this error."""
    sizes = _sizes_of_noise(series)
    scaled = [(each - each.mean()) / size for each, size in zip(series, sizes, strict=True)]
    variance, errors = memory(scaled)[0], errors_of_means(scaled)
    counts = [min(len(each), max(1.0, variance / e**2)) if e > 0 else 1.0 for each, e in zip(series, errors, strict=True)]
    return [(error * size, count) for error, size, count in zip(errors, sizes, counts, strict=True)]


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


def _sizes_of_noise(series: Sequence[Array]) -> list[float]:
    """Return what the noise of each series goes with: its mean, or a lower power of it where their scatter clearly says so."""
    from scipy.stats import linregress

    means = np.array([abs(float(each.mean())) or 1.0 for each in series])
    scatter = np.array([float(each.std()) for each in series])
    seen = scatter > 0
    x, y = np.log(means[seen]), np.log(scatter[seen] / means[seen])
    power = 1.0
    if len(x) > 2 and np.ptp(x) > 0:
        line = linregress(x, y)
        power = float(np.clip(1 + line.slope, 0, 1)) if line.pvalue < SMALL_PROBABILITY else 1.0
    return list((means**power).tolist())


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


SAME_SPEED = 0.01  # Relative difference up to which speeds are the same point

LARGEST_NOISE = 0.02  # Noise of a speed that a drive may have; what changes by more is set

DEVIATIONS = 4.0  # Standard deviations of the noise of a speed within which rows belong to one step

# Way from end to end over the way from row to row, from which a speed is ramped: 1 on a ramp, 1/2 for three rows of noise.
RAMP_SHARE = 0.75

# Relative difference of a first run from the later ones, and that in standard errors, from which it is run-in.
RUN_IN, CLEAR = 0.03, 3.0

Row = tuple[str, int, float, float, float, dict[str, float]]


@dataclass(frozen=True)
class Averaged:
    """Rows in which repeats have been averaged."""

    rows: list[Row]  # The rows: curve, number, speed, friction, its standard error, inputs; all of them where nothing repeats
    notes: tuple[str, ...]  # What was put together and left out, or why not
    run_in: tuple[int, ...]  # Numbers of the rows that look like run-in
    has_errors: bool = True  # Whether the rows are means with their errors


@dataclass(frozen=True)
class _Step:
    """Rows one after the other at one speed."""

    rows: list[Row] = field(repr=False)
    run: str

    @property
    def mean(self) -> Row:
        """The means of its rows."""
        name, number, _, _, error, inputs = self.rows[0]
        speed = math.exp(float(np.mean([math.log(row[2]) for row in self.rows])))
        return name, number, speed, float(np.mean([row[3] for row in self.rows])), error, inputs


def average_repeats(rows: Sequence[Row], runs: Sequence[str], keep_run_in: bool) -> Averaged:
    r"""Average rows at the same speed of a curve: their mean and its standard error."""
    tolerance = _tolerance(rows, runs)
    steps, starting, ramped = _steps(rows, runs, tolerance)
    means = [step.mean for step in steps]
    marked, sentences = run_in(means, counted(means, [step.run for step in steps]))
    numbers = {row[1] for step in steps for row in step.rows if step.rows[0][1] in marked}
    kept = [step for step in steps if keep_run_in or step.rows[0][1] not in marked]
    groups = _at_same_speed(kept, tolerance)
    counts = [sum(len(step.rows) for step in group) for group in groups]
    at_all = [sum(len(step.rows) for step in group) for group in _at_same_speed(steps, tolerance)]
    if not groups or 2 * sum(count for count in at_all if count >= FEWEST) < sum(at_all):
        why = (
            "the speed changes steadily, without steps"
            if ramped
            else f"fewer than {FEWEST} rows share a speed at most speeds of a curve"
        )
        return Averaged(list(rows), (f"Rows were not put together: {why}.",), (), False)
    errors, said = _errors(groups)
    made = [_together(group, error) for group, error in zip(groups, errors, strict=True)]
    if starting:
        listed = rows_listed(starting, 20)
        many = len(starting) != 1
        of = "their steps" if many else "its step"
        sentences.append(f"{len(starting)} row{'s' * many} of other speeds than {of}, as while starting, left out: {listed}.")
    sentences.append(f"{sum(counts)} rows at {len(made)} speeds put together; {said} repeats = false in [fit] keeps all rows.")
    return Averaged(made, tuple(sentences), tuple(sorted(numbers)))


def _together(group: Sequence[_Step], error: float) -> Row:
    """Return the mean of steps at one speed, each weighed by its rows."""
    weights = [len(step.rows) for step in group]
    name, number, _, _, _, inputs = group[0].mean
    speed = math.exp(float(np.average([math.log(step.mean[2]) for step in group], weights=weights)))
    mean = float(np.average([step.mean[3] for step in group], weights=weights))
    return name, number, speed, mean, max(error, 1e-6) * mean, inputs


def _errors(groups: Sequence[Sequence[_Step]]) -> tuple[list[float], str]:
    """Return the relative standard errors of the means of steps at one speed, and what they are from."""
    steps = [step for group in groups for step in group]
    series = [np.array([row[3] for row in step.rows]) for step in steps]
    within = iter([error / step.mean[3] for (error, _), step in zip(noise_of_means(series), steps, strict=True)])
    series = [each / each.mean() - 1 for each in series]
    own, spread, freedom = [], 0.0, 0
    for group in groups:
        sizes = np.array([len(step.rows) for step in group], float)
        weights = sizes / sizes.sum()
        each = np.array([next(within) for _ in group])
        own.append(float(np.sqrt(weights**2 @ each**2)))
        ratios = np.array([step.mean[3] for step in group])
        ratios = ratios / (weights @ ratios) - 1
        spread += float((sizes / sizes.mean()) @ ratios**2)
        freedom += len(group) - 1
    passes = math.sqrt(spread / freedom) if freedom >= FEWEST - 1 else 0.0
    found, between = [], 0
    for group, error in zip(groups, own, strict=True):
        sizes = np.array([len(step.rows) for step in group], float)
        scatter = passes / math.sqrt(len(group)) if len(group) > 1 else 0.0
        between += scatter >= error
        found.append(max(error, scatter))
    longest = max(map(len, series))
    if 2 * between >= len(groups) or longest == 1:
        scatter_of, single = ("repeats", "row") if longest == 1 else ("passes", "pass")
        return (
            found,
            f"the scatter of {scatter_of}, {format_percent(passes)} of a single {single}, became the error of each mean;",
        )
    rows = float(np.mean([len(each) for each in series]))
    alone = math.sqrt(sum(float(each @ each) for each in series) / max(sum(len(each) - 1 for each in series), 1))
    typical = float(np.median(found))
    count = min(rows, max(1.0, (alone / typical) ** 2)) if typical > 0 else rows
    return found, (
        f"the error of a mean is that of {count:.2g} independent rows in {rows:.3g}, by the correlation of neighbouring rows;"
    )


def _steps(rows: Sequence[Row], runs: Sequence[str], tolerance: float) -> tuple[list[_Step], list[int], bool]:
    """Return the steps, the numbers of rows that are of none, and whether the speed is ramped all along."""
    steps, starting = list[_Step](), list[int]()
    ramped = False
    for mine in _blocks(rows, runs).values():
        found = list[_Step]()
        total = 0.0  # of the logarithms of the speeds of the last step
        for row, run in mine:
            speed = math.log(row[2])
            if found and found[-1].run == run and abs(speed - total / len(found[-1].rows)) <= tolerance:
                found[-1].rows.append(row)
                total += speed
            else:
                found.append(_Step([row], run))
                total = speed
        if _is_ramp(found):
            ramped = True
            steps += [_Step([row], run) for row, run in mine]
            continue
        for run in dict.fromkeys(step.run for step in found):
            of_run = [step for step in found if step.run == run]
            long = [step for step in of_run if len(step.rows) >= FEWEST]
            if 2 * sum(len(step.rows) for step in long) > sum(len(step.rows) for step in of_run):
                starting += [row[1] for step in of_run if len(step.rows) < FEWEST for row in step.rows]
                of_run = long
            steps += of_run
    return steps, sorted(starting), ramped


def _blocks(rows: Sequence[Row], runs: Sequence[str]) -> dict[Any, list[tuple[Row, str]]]:
    """Return the rows of each curve with their runs, as they were measured."""
    found: dict[Any, list[tuple[Row, str]]] = {}
    for row, run in zip(rows, runs, strict=True):
        found.setdefault(_curve_of(row), []).append((row, run))
    return found


def _tolerance(rows: Sequence[Row], runs: Sequence[str]) -> float:
    """Return the difference of logarithms up to which speeds are the same: by the noise where that is larger."""
    changes, turns = list[float](), list[float]()
    for mine in _blocks(rows, runs).values():
        steps = np.diff(np.log([row[2] for row, _ in mine]))
        changes += np.abs(steps).tolist()
        turns += (steps[1:] * steps[:-1] < 0).tolist()
    if not turns or np.mean(turns) < 0.5:
        return SAME_SPEED
    noise = float(np.median(changes)) / 0.954  # the median size of differences of two normal numbers
    return max(SAME_SPEED, DEVIATIONS * noise) if noise < LARGEST_NOISE else SAME_SPEED


def _is_ramp(steps: Sequence[_Step]) -> bool:
    """Return whether the speed changes in one direction within what look like steps."""
    way, path = 0.0, 0.0
    for step in steps:
        if len(step.rows) >= FEWEST:
            speeds = np.log([row[2] for row in step.rows])
            way += abs(float(speeds[-1] - speeds[0]))
            path += float(np.abs(np.diff(speeds)).sum())
    return way > RAMP_SHARE * path


def _curve_of(row: Row) -> tuple[str, tuple[tuple[str, float], ...]]:
    """Return name and inputs of the curve of a row."""
    return row[0], tuple(sorted(row[5].items()))


def _at_same_speed(steps: Sequence[_Step], tolerance: float) -> list[list[_Step]]:
    """Return steps of the same curve and speed together."""
    means = [step.mean for step in steps]
    return [[steps[i] for i in each] for each in at_same_speed([(_curve_of(row), row[2]) for row in means], tolerance)]


def at_same_speed(places: Sequence[tuple[Any, float]], tolerance: float = SAME_SPEED) -> list[list[int]]:
    """Return which of curves and speeds are the same: those of a curve up to a tolerance above the slowest, ascending."""
    groups: list[list[int]] = []
    for i in sorted(range(len(places)), key=lambda i: places[i]):
        curve, slowest = places[groups[-1][0]] if groups else (None, 0.0)
        if groups and places[i][0] == curve and places[i][1] / slowest <= 1 + tolerance:
            groups[-1].append(i)
        else:
            groups.append([i])
    return groups


def counted(rows: Sequence[Row], runs: Sequence[str]) -> Sequence[str]:
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


def run_in(rows: Sequence[Row], runs: Sequence[str]) -> tuple[set[int], list[str]]:
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
