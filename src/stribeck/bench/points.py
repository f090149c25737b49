"""Points of a curve by one weighted least squares: friction, force zero, its drift and misalignment (docs/bench.md)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.bench.passes import Pass
from stribeck.bench.raw import Raw
from stribeck.fits.repeats import CLEAR, FEWEST, SAME_SPEED, Row, at_same_speed, counted, run_in
from stribeck.quantities.formats import format_error, format_percent, format_si

UNLIKELY = 0.05  # Probability below which passes differ by more than the noise within them


@dataclass(frozen=True)
class Point:
    """A point of a curve."""

    curve: int
    speed: float  # [m/s]
    friction: float
    half_width: float  # Half of the 95 % interval; NaN where nothing shows the error
    rows: int  # Rows of the files
    independent: float  # Independent values among them
    difference: float  # Friction one way less that the other way; NaN where only one was measured
    difference_error: float  # Its standard error
    temperature: float  # [degC]; NaN where it was not measured


def run_in_of(passes: Sequence[Pass], names: Sequence[str]) -> list[int]:
    """Return the number of each pass of a first run that differs from the later ones."""
    rows: list[Row] = []
    runs: list[str] = []
    places: list[int] = []
    for k, each in enumerate(passes):
        if each.mean > 0:
            rows.append((f"{names[each.curve]} {each.direction}", len(places), each.speed, each.mean, 1.0, {}))
            several = len({other.file for other in passes if other.curve == each.curve}) > 1
            runs.append(str(each.file) if several else "")
            places.append(k)
    single = [i for i, run in enumerate(runs) if not run]
    for i, run in zip(single, counted([rows[i] for i in single], [str(i) for i in single]), strict=True):
        runs[i] = f"pass {run}"
    marked, _ = run_in(rows, runs)
    return [places[i] for i in sorted(marked)]


def points_of(passes: Sequence[Pass], raw: Sequence[Raw], paths: Sequence[str]) -> tuple[list[Point], list[str]]:
    """Return the points of all curves, and what is to be said of force zeros and of the scatter of passes."""
    from scipy.stats import f, t

    level = _levels(passes)
    means = np.array([each.mean for each in passes])
    errors = np.array([each.error for each in passes])
    usable = errors > 0
    single = not usable.any()  # means of the rig, whose noise is proportional to friction and shows in their scatter alone
    errors = np.where(usable, errors, np.where(means, np.abs(means), 1.0) if single else np.median(errors[usable]))
    base = np.equal.outer(level, np.arange(level.max() + 1)).astype(float)
    said, extra = _force_zeros(raw, passes, level, base, means, errors, paths)
    design = np.hstack([base, extra])
    friction, covariance = _least(design, means, errors)
    residuals = (means - design @ friction) / errors
    points, widened = [], list[float]()
    curves = np.array([each.curve for each in passes])
    for curve in range(max(curves) + 1):
        mine = curves == curve
        if not mine.any():
            continue
        levels = np.unique(level[mine])
        freedom = int(mine.sum()) - len(levels) - extra.shape[1] * (curve == curves[0])
        scale = math.sqrt(float(residuals[mine] @ residuals[mine]) / freedom) if freedom >= FEWEST - 1 else 0.0
        own = [each for each, one in zip(passes, mine, strict=True) if one]
        within = sum(each.independent - 1 for each in own) if any(np.ptp(each.values) for each in own) else math.inf
        unlikely = scale > 1 and bool(f.sf(scale**2, freedom, min(max(within, 1.0), 1e6)) < UNLIKELY)
        apart = scale > 0 if single else unlikely
        factor, quantile = (scale if apart else 1.0), float(t.ppf(0.975, max(freedom if apart else within, 1.0)))
        widened += [scale] * apart
        for k in levels:
            of = [each for each, at in zip(passes, level, strict=True) if at == k]
            error = math.sqrt(float(covariance[k, k])) * factor if apart or usable[level == k].any() else math.nan
            points.append(_point(curve, of, raw, float(friction[k]), quantile * error))
    if widened and single:
        said.append(f"Single means have no error: it is by their scatter at the same speed, {format_percent(max(widened))}.")
    elif widened:
        advice = " Files of different fluids need names: --name '{fluid}' (in Python name=)." if len(paths) > 1 else ""
        said.append(
            f"Passes at the same speed differ by {max(widened):.2g} times what the noise within them allows, and errors are "
            f"larger by that.{advice}"
        )
    return points, said


def _point(curve: int, of: Sequence[Pass], raw: Sequence[Raw], friction: float, half_width: float) -> Point:
    """Return the point of passes at one speed."""
    weights = np.array([len(each.rows) for each in of], float)
    speed = math.exp(float(np.average([math.log(each.speed) for each in of], weights=weights)))
    ways = {way: [each for each in of if each.direction == way] for way in (1, -1)}
    difference = error = math.nan
    if ways[1] and ways[-1]:
        difference = float(np.mean([each.mean for each in ways[1]]) - np.mean([each.mean for each in ways[-1]]))
        error = math.sqrt(sum(sum(each.error**2 for each in way) / len(way) ** 2 for way in ways.values()))
    measured = [(raw[each.file].temperature, each.rows) for each in of]
    warm = [temperature[rows] for temperature, rows in measured if temperature is not None]
    known = np.concatenate(warm) if warm else np.array([])
    known = known[np.isfinite(known)]
    return Point(
        curve=curve,
        speed=speed,
        friction=friction,
        half_width=half_width,
        rows=int(weights.sum()),
        independent=float(sum(each.independent for each in of)),
        difference=difference,
        difference_error=error,
        temperature=float(known.mean()) if len(known) else math.nan,
    )


def _levels(passes: Sequence[Pass]) -> Indices:
    """Return the number of the speed of each pass; passes of a curve within one per cent have the same."""
    found = np.zeros(len(passes), dtype=int)
    for number, alike in enumerate(at_same_speed([(each.curve, each.speed) for each in passes])):
        found[alike] = number
    return found


def _force_zeros(
    raw: Sequence[Raw],
    passes: Sequence[Pass],
    level: Indices,
    base: Array,
    means: Array,
    errors: Array,
    paths: Sequence[str],
) -> tuple[list[str], Array]:
    """Return the columns of force zeros, drifts and misalignment that the passes show, after a sentence on each."""
    ways = np.array([each.direction for each in passes], float)
    files = np.array([each.file for each in passes])
    loads = np.array([_load(raw[each.file], each) for each in passes])
    times = np.array([each.time for each in passes])
    both = [bool({1, -1} <= set(ways[level == k].tolist())) for k in range(base.shape[1])]
    said: list[str] = []
    extra = np.empty((len(passes), 0))
    for file in np.unique(files):
        mine = files == file
        paired = {k for k in np.unique(level[mine]) if both[k] and {1, -1} <= set(ways[mine & (level == k)].tolist())}
        if not paired:
            continue
        extra, sentence = _zero_of(mine, ways, loads, times, base, extra, means, errors)
        said.append(f"{paths[file]}: {sentence}" if len(paths) > 1 else sentence)
    one_way = [k for k, there in enumerate(both) if not there]
    if one_way and np.abs(ways).any():
        several = "all" if len(one_way) == len(both) else str(len(one_way))
        said.append(
            f"Measured in one direction at {several} speed{'s' * (several != '1')}: a zero of the force that is off, or a "
            "misalignment, is in the friction there"
            + ("." if not extra.shape[1] else ", less that of the others.")
            + (" Measure both directions, or the force without load." if not extra.shape[1] else "")
        )
    return said, extra


def _zero_of(
    mine: Flags, ways: Array, loads: Array, times: Array, base: Array, extra: Array, means: Array, errors: Array
) -> tuple[Array, str]:
    """Return the columns with those of the force zero of a file, and of its drift and misalignment where these are clear."""
    measured = np.isfinite(loads)
    force = np.where(mine, ways / np.where(measured, loads, 1.0), 0.0)
    long = float(np.ptp(times[mine]))
    later = (times - times[mine].mean()) / long if long > 0 else np.zeros(len(times))
    candidates = [("drift", force * later)]
    if measured.all() and np.ptp(loads[mine]) > SAME_SPEED * loads[mine].max():
        candidates.append(("misalignment", np.where(mine, ways, 0.0)))
    taken, names = np.column_stack([extra, force]), ["zero"]
    for name, column in candidates:
        tried = np.column_stack([base, taken, column])
        if np.linalg.matrix_rank(tried / errors[:, None]) < tried.shape[1] or tried.shape[1] >= tried.shape[0]:
            continue
        found, covariance = _least(tried, means, errors)
        if abs(found[-1]) > CLEAR * math.sqrt(float(covariance[-1, -1])):
            taken, names = np.column_stack([taken, column]), [*names, name]
    design = np.column_stack([base, taken])
    found, covariance = _least(design, means, errors)
    found, doubts = found[-len(names) :], np.sqrt(np.diag(covariance))[-len(names) :]
    known = bool(measured[mine].all())
    parts = []
    for name, value, doubt in zip(names, found.tolist(), doubts.tolist(), strict=True):
        if name == "misalignment":
            parts.append(f"the load is misaligned by {math.degrees(value):.2g} ± {math.degrees(doubt):.2g} degrees")
            continue
        text = (
            f"{format_si(value, 'force')} ± {format_error(doubt, 'force')}"
            if known
            else f"{value:.2g} ± {doubt:.2g} of friction"
        )
        parts.append(
            f"the zero of the force is off by {text}"
            if name == "zero"
            else f"it drifts by {text} from the first pass to the last"
        )
    several = ""
    if known and len(candidates) == 1:
        angle = math.degrees(found[0] / float(np.median(loads[mine])))
        several = f" (or the load is misaligned by {angle:.2g} degrees: two loads would tell)"
    return taken, f"Both directions: {', '.join(parts)}{several}; taken off."


def _load(raw: Raw, each: Pass) -> float:
    """Return the mean load of a pass [N], NaN where the file has none."""
    loads = np.array([]) if raw.load is None else raw.load[each.rows]
    return float(np.nanmean(loads)) if np.isfinite(loads).any() else math.nan


def _least(design: Array, means: Array, errors: Array) -> tuple[Array, Array]:
    """Return the parameters of a weighted least squares and their covariance."""
    weighted = design / errors[:, None]
    covariance = np.asarray(np.linalg.pinv(weighted.T @ weighted, hermitian=True), float)
    return covariance @ (weighted.T @ (means / errors)), covariance
