"""Parts of a series and passes: what it holds of one speed, load and direction, with its mean and the error of that mean.

Parts are steps of steady speed, found by binary segmentation at change points of ln(speed), strokes, ramps and rest.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.bench.raw import Raw
from stribeck.files.cells import rows_listed
from stribeck.fits.repeats import (
    CLEAR,
    FEWEST,
    FEWEST_BLOCKS,
    LARGEST_NOISE,
    SAME_SPEED,
    error_of_mean,
    memory,
    noise_of_means,
)
from stribeck.fits.strokes import REST_SPEED
from stribeck.quantities.formats import format_percent, format_si
from stribeck.quantities.units import InputError

MEDIAN_OF_DIFFERENCES = 0.954  # Median size of the difference of two normal numbers, over their standard deviation


@dataclass(frozen=True)
class Part:
    """Neighbouring rows of one curve and direction."""

    first: int
    end: int
    direction: int  # Sign of the speed; 0 at rest or while it turns
    steady: bool  # Whether the speed is that of a step
    speed: float  # Size of its mean [m/s]

    @property
    def rows(self) -> Indices:
        """The places of its rows."""
        return np.arange(self.first, self.end)


def directions(speed: Array, friction: Array) -> tuple[Array, Array]:
    """Return the speed with its sign, and friction positive along the motion."""
    turns = [[end - first for first, end in _runs(np.sign(friction)) if way * friction[first] > 0] for way in (1, -1)]
    both = all(turns)
    if not (speed < 0).any() and both and min(map(np.median, turns)) >= FEWEST:
        speed = speed * np.where(friction < 0, -1.0, 1.0)
    along = np.sign(speed) * friction if (speed < 0).any() and both else friction
    polarity = 1.0 if np.sum(along) >= 0 else -1.0
    return speed, polarity * along


def parts_of(speed: Array, changes: Flags) -> list[Part]:
    """Return the parts of a series in order; ``changes`` marks rows at which a part begins whatever the speed does."""
    largest = float(np.max(np.abs(speed), initial=0.0))
    sign = np.where(np.abs(speed) <= REST_SPEED * largest, 0, np.sign(speed)).astype(int)
    found: list[Part] = []
    for first, end in _runs(sign, changes):
        if sign[first] == 0:
            found.append(Part(first, end, 0, False, 0.0))
            continue
        sizes = np.abs(speed[first:end])
        for start, stop, steady in _steps(np.log(sizes)):
            mean = float(np.exp(np.log(sizes[start:stop]).mean()))
            found.append(Part(first + start, first + stop, int(sign[first]), steady, mean))
    return found


def _steps(y: Array) -> list[tuple[int, int, bool]]:
    """Return first, end and whether the speed is steady of the pieces of a stretch of one direction; y is its logarithm."""
    pieces = _pieces(y)
    means = [float(y[first:end].mean()) for first, end in pieces]
    changes = [abs(_change(y[first:end])) for first, end in pieces]
    # On a ramp a piece changes by as much as it lies from the next; within a step it hardly changes.
    steady = [
        end - first >= FEWEST and change < max(nearest / 2, SAME_SPEED)
        for (first, end), change, nearest in zip(pieces, changes, _to_nearest(means, np.inf), strict=True)
    ]
    joined: list[tuple[int, int, bool]] = []
    for k, (first, end) in enumerate(pieces):
        if joined and steady[k] and joined[-1][2] and abs(means[k] - means[k - 1]) < LARGEST_NOISE:
            joined[-1] = (joined[-1][0], end, True)
        else:
            joined.append((first, end, steady[k]))
    # Pieces of a slow ramp that look steady lie near each other, and joined they change as a ramp does.
    rests = [float(y[first:end].mean()) for first, end, is_steady in joined if is_steady]
    beside = iter(_to_nearest(rests, 0.0))
    return [
        (first, end, is_steady and abs(_change(y[first:end])) < max(next(beside) / 2, LARGEST_NOISE))
        for first, end, is_steady in joined
    ]


def _to_nearest(places: Sequence[float], alone: float) -> list[float]:
    """Return the distance of each place from the nearer of its neighbours in the list."""
    apart = np.abs(np.diff(places)).tolist()
    return [min(apart[max(0, k - 1) : k + 1], default=alone) for k in range(len(places))]


def _pieces(y: Array) -> list[tuple[int, int]]:
    """Return the pieces between the change points of a mean, by binary segmentation."""
    changes = np.diff(y)
    turns = np.mean(changes[1:] * changes[:-1] < 0) if len(y) > 2 else 0.0  # two thirds of noise, none of a smooth speed
    noise = float(np.median(np.abs(changes))) / MEDIAN_OF_DIFFERENCES if turns >= 0.5 else 0.0
    least = 2 * noise**2 * np.log(max(len(y), 2))  # what noise alone lowers the sum of squares by
    sums = np.concatenate([[0.0], np.cumsum(y)])
    waiting, found = [(0, len(y))], list[tuple[int, int]]()
    while waiting:
        first, end = waiting.pop()
        if end - first > 1:
            rows = np.arange(1, end - first)
            left = (sums[first + 1 : end] - sums[first]) / rows
            right = (sums[end] - sums[first + 1 : end]) / (end - first - rows)
            gain = rows * (end - first - rows) / (end - first) * (left - right) ** 2
            at = int(np.argmax(gain))
            if abs(left[at] - right[at]) > SAME_SPEED and gain[at] > least:
                waiting += [(first + at + 1, end), (first, first + at + 1)]
                continue
        found.append((first, end))
    return found


def _change(y: Array) -> float:
    """Return by how much a straight line through a series changes from end to end."""
    if len(y) < 2:
        return 0.0
    place = np.arange(len(y)) - (len(y) - 1) / 2
    return float(place @ y / (place @ place) * (len(y) - 1))


def _runs(sign: Array | Indices, changes: Flags | None = None) -> list[tuple[int, int]]:
    """Return first and end of the stretches of equal signs."""
    new = np.diff(sign) != 0
    if changes is not None:
        new |= changes[1:]
    edges = [0, *(np.flatnonzero(new) + 1).tolist(), len(sign)]
    return list(zip(edges[:-1], edges[1:], strict=True))


# What becomes of a row.
KEPT, AT_REST, CHANGING, STARTING, RUN_IN = range(5)

TURNING = 0.1  # Length over that of the usual stroke below which a stretch of one direction is noise around rest


@dataclass(frozen=True, eq=False)
class Pass:
    """The rows of one speed, load and direction, or the strokes, one after the other."""

    curve: int  # Of the file
    direction: int
    speed: float  # [m/s]
    time: float  # Mean time [s]
    rows: Indices = field(repr=False)  # Places of the rows that are kept
    values: Array = field(repr=False)  # Friction of each row, or of each stroke
    strokes: bool  # Whether the values are means of strokes
    starting: Indices = field(repr=False)  # Places of the rows of its start
    error: float = 0.0  # Standard error of the mean of the values [-]
    independent: float = 1.0  # Number of independent values that have this error
    file: int = 0

    @property
    def mean(self) -> float:
        """The mean of its values."""
        return float(self.values.mean())


@dataclass(frozen=True)
class Series:
    """A file with its passes."""

    raw: Raw
    friction: Array  # Positive along the motion [-]
    passes: tuple[Pass, ...]
    status: Indices  # What became of each row
    notes: tuple[str, ...]


def passes_of(raw: Raw, per_decade: float) -> Series:
    """Return the passes of a file, with what was left out and why."""
    speed, friction = directions(raw.speed, raw.friction)
    changes = np.zeros(len(speed), dtype=bool)
    changes[1:] = raw.curve[1:] != raw.curve[:-1]
    if raw.steps:
        steps = np.array(raw.steps)
        changes[1:] |= steps[1:] != steps[:-1]
    parts = parts_of(speed, changes)
    if not any(part.direction for part in parts):
        raise InputError(f"{raw.path}: no row is in motion; check the columns of speed and friction.")
    if not friction.any():
        raise InputError(f"{raw.path}: friction is zero in all rows; check the sensor, or the column of friction.")
    status = np.full(len(speed), CHANGING)
    for part in parts:
        status[part.first : part.end] = KEPT if part.steady else AT_REST if part.direction == 0 else CHANGING
    notes: list[str] = []
    if int((status == KEPT).sum()) >= int((status == CHANGING).sum()):
        found = _of_steps([part for part in parts if part.steady], raw, friction)
        notes += _rest_and_changes(raw, status)
        common = {strokes: common_memory([p.values for p in found if p.strokes == strokes]) for strokes in (False, True)}
        found = [_settled(each, common[each.strokes], raw, notes) for each in found]
        for each in found:
            status[each.starting] = STARTING
    else:
        found, said = _of_ramps(parts, raw, speed, friction, per_decade)
        status[np.concatenate([each.rows for each in found])] = KEPT
        notes += [said, *_rest_and_changes(raw, status)]
    return Series(raw, friction, tuple(_with_errors(found, raw)), status, tuple(notes))


def _of_steps(parts: Sequence[Part], raw: Raw, friction: Array) -> list[Pass]:
    """Return the passes of steps; many strokes at one speed, one after the other, are two passes of strokes."""
    blocks: list[list[Part]] = []
    for part in parts:
        last = blocks[-1][-1] if blocks else None
        same = last is not None and raw.curve[last.first] == raw.curve[part.first]
        if same and last is not None and abs(math.log(part.speed / last.speed)) <= SAME_SPEED:
            blocks[-1].append(part)
        else:
            blocks.append([part])
    return [each for block in blocks for each in _passes([(part.rows, part.direction) for part in block], raw, friction)]


def _of_ramps(parts: Sequence[Part], raw: Raw, speed: Array, friction: Array, per_decade: float) -> tuple[list[Pass], str]:
    """Return the passes of a speed that does not rest: rows of neighbouring speeds in bins, and a sentence on these."""
    stretches: list[list[int]] = []
    for part in parts:
        if part.direction and stretches and stretches[-1][1] == part.first and stretches[-1][2] == part.direction:
            stretches[-1][1] = part.end
        elif part.direction:
            stretches.append([part.first, part.end, part.direction])
    lengths = np.array([end - first for first, end, _ in stretches])
    order = np.argsort(lengths)
    usual = lengths[order][int(np.searchsorted(np.cumsum(lengths[order]), lengths.sum() / 2))]
    stretches = [each for each in stretches if each[1] - each[0] >= TURNING * usual]
    moving = np.concatenate([np.arange(first, end) for first, end, _ in stretches])
    y = np.log(np.abs(speed[moving]))
    decades = max(float(np.ptp(y)) / math.log(10), 1 / per_decade)
    count = max(1, round(per_decade * decades))
    if len(moving) < FEWEST * count:  # each row is a mean that the rig made
        single = [pass_ for i in moving for pass_ in _passes([(np.array([i]), int(np.sign(speed[i])))], raw, friction)]
        stated = "" if raw.stated is None else ": its error is that which the file gives"
        return single, f"Each row is a point, as there are fewer than three for each bin of the speed{stated}."
    bins = np.minimum(((y - y.min()) / max(float(np.ptp(y)), 1e-300) * count).astype(int), count - 1)
    of_row = np.full(len(speed), -1)
    of_row[moving] = bins
    found: list[Pass] = []
    for curve in np.unique(raw.curve[moving]):
        places = [np.flatnonzero((of_row == k) & (raw.curve == curve)) for k in range(count)]
        places = [mine for mine in places if len(mine)]
        level = _at_mean_speeds(np.log(np.maximum(np.abs(speed), 1e-300)), friction, places)
        for mine in places:
            new = (np.diff(mine) > 1) | (np.diff(np.sign(speed[mine])) != 0)
            pieces = np.split(mine, np.flatnonzero(new) + 1)
            found += _passes([(each, int(np.sign(speed[each[0]]))) for each in pieces], raw, level, together=True)
    said = (
        f"The speed never rests: its rows are put together in {count} bins, {per_decade:g} for each decade of the speed; "
        "friction while the speed changes may differ from that of a steady speed."
    )
    return found, said


def _at_mean_speeds(y: Array, friction: Array, bins: Sequence[Indices]) -> Array:
    """Return friction brought to the mean speed of its bin, by the slope of the means of neighbouring bins over y."""
    # A slope of the rows of a bin alone would take slow noise out of them, and its error with it.
    places, means = (np.array([float(each[mine].mean()) for mine in bins]) for each in (y, friction))
    slopes = np.gradient(means, places) if len(bins) > 1 else np.zeros(len(bins))
    level = friction.copy()
    for mine, place, slope in zip(bins, places, slopes, strict=True):
        level[mine] -= slope * (y[mine] - place)
    return level


def _passes(pieces: Sequence[tuple[Indices, int]], raw: Raw, friction: Array, *, together: bool = False) -> list[Pass]:
    """Return the passes that pieces at one speed are: each by itself, or, where they are many, those of a direction."""
    ways = {way: [rows for rows, each in pieces if each == way] for way in dict.fromkeys(way for _, way in pieces)}
    many = min(map(len, ways.values())) >= FEWEST_BLOCKS

    def made(rows: Sequence[Indices], way: int, strokes: bool) -> Pass:
        places = np.concatenate(rows)
        values = np.array([friction[each].mean() for each in rows]) if strokes else friction[places]
        speed = math.exp(float(np.log(np.abs(raw.speed[places])).mean()))
        time = float(raw.time[places].mean())
        return Pass(int(raw.curve[places[0]]), way, speed, time, places, values, strokes, np.array([], int))

    if many:
        return [made(rows, way, True) for way, rows in ways.items()]
    if together:  # of a bin through which few strokes pass
        return [made(rows, way, False) for way, rows in ways.items()]
    return [made([rows], way, False) for rows, way in pieces]


def _settled(each: Pass, common: tuple[float, float], raw: Raw, notes: list[str]) -> Pass:
    """Return a pass without its start, and add a sentence where there is one."""
    cut, apart = start_of(each.values, common)
    if not cut:
        return each
    if each.strokes:
        strokes = np.split(each.rows, np.flatnonzero(np.diff(each.rows) > 1) + 1)
        gone = np.concatenate(strokes[:cut]) if len(strokes) == len(each.values) else each.rows[:0]
        what = f"first {cut} strokes"
    else:
        gone = each.rows[:cut]
        long = float(raw.time[each.rows[cut]] - raw.time[each.rows[0]])
        what = f"first {format_si(long, 'time') if raw.timed else f'{cut} rows'}"
    kept = each.rows[~np.isin(each.rows, gone)]
    numbers = raw.numbers[gone] if len(gone) else raw.numbers[each.rows[:1]]
    notes.append(
        f"Left out: {what} of the step at {format_si(each.speed, 'speed')} (rows {numbers[0]} to {numbers[-1]}), as the "
        f"running mean still drifted, {format_percent(abs(apart))} {'above' if apart > 0 else 'below'} the rest."
    )
    return replace(each, rows=kept, values=each.values[cut:], starting=gone, time=float(raw.time[kept].mean()))


def _with_errors(found: Sequence[Pass], raw: Raw) -> list[Pass]:
    """Return passes with the error of their means: that of correlated values, at least that of the last digit or the file."""
    done = dict[int, Pass]()
    for strokes in {each.strokes for each in found}:
        mine = [i for i, each in enumerate(found) if each.strokes == strokes]
        for i, (own, independent) in zip(mine, noise_of_means([found[i].values for i in mine]), strict=True):
            rounding = raw.resolution / math.sqrt(12) if own > 0 or len(found[i].values) > 1 else 0.0
            error = max(own, rounding, _stated(found[i], raw))
            done[i] = replace(found[i], error=error, independent=independent)
    return [done[i] for i in range(len(found))]


def _stated(each: Pass, raw: Raw) -> float:
    """Return the error of the mean of a pass by the errors that the file gives its rows, zero where one has none."""
    errors = None if raw.stated is None else raw.stated[each.rows]
    return 0.0 if errors is None or not np.isfinite(errors).all() else float(np.linalg.norm(errors)) / len(errors)


def _rest_and_changes(raw: Raw, status: Flags | Indices) -> list[str]:
    """Return how many rows are left out at rest and while the speed changes."""
    said = []
    for kind, what in ((AT_REST, "at rest"), (CHANGING, "in which the speed changes from step to step")):
        rows = np.flatnonzero(status == kind)
        if len(rows):
            listed = rows_listed(raw.numbers[rows], 5)
            said.append(f"Left out: {len(rows)} row{'s' * (len(rows) > 1)} {what}: {listed}.")
    return said


def common_memory(series: Sequence[Array]) -> tuple[float, float]:
    """Return variance and correlation of neighbours of the second halves of series, over their means."""
    halves = [each[len(each) // 2 :] for each in series if len(each) >= 2 * FEWEST_BLOCKS]
    return memory([each / each.mean() - 1 for each in halves if each.mean()])


def start_of(series: Array, common: tuple[float, float]) -> tuple[int, float]:
    """Return how many rows of a step belong to its start, and how far their mean lies from the others, over theirs."""
    rows = len(series)
    if rows < 2 * FEWEST_BLOCKS:
        return 0, 0.0
    # MSER [White 1997]; where the means differ by less than three standard errors, what looks like a start is noise.
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
