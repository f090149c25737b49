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
    left = 1 - np.einsum("ij,jk,ik->i", design, covariance, design) / errors**2  # of each pass, not spent on the parameters
    points, widened = [], list[float]()
    curves = np.array([each.curve for each in passes])
    for curve in range(max(curves) + 1):
        mine = curves == curve
        if not mine.any():
            continue
        levels = np.unique(level[mine])
        freedom = round(float(left[mine].sum()))
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
    columns: list[tuple[int, str, Array]] = []  # File, what it is of and its column; first the zeros of all files
    for file in np.unique(files).tolist():
        mine = files == file
        if any(both[k] and {1, -1} <= set(ways[mine & (level == k)].tolist()) for k in np.unique(level[mine])):
            columns.append((file, "zero", np.where(mine, ways / np.where(np.isfinite(loads), loads, 1.0), 0.0)))
    for file, _, force in columns.copy():
        for name, column in _candidates(files == file, ways, loads, times, force):
            tried = np.column_stack([base, *(each for *_, each in columns), column])
            if np.linalg.matrix_rank(tried / errors[:, None]) == tried.shape[1] < tried.shape[0]:
                columns.append((file, name, column))
    while True:  # the least clear goes until all are
        extra = np.column_stack([np.empty((len(passes), 0)), *(each for *_, each in columns)])
        found, covariance = _least(np.hstack([base, extra]), means, errors)
        doubts = np.sqrt(np.diag(covariance))
        ends = list(zip(found[base.shape[1] :].tolist(), doubts[base.shape[1] :].tolist(), strict=True))
        clear = [math.inf if name == "zero" else abs(size) / e for (_, name, _), (size, e) in zip(columns, ends, strict=True)]
        if min(clear, default=math.inf) > CLEAR:
            break
        del columns[int(np.argmin(clear))]
    said: list[str] = []
    for file in dict.fromkeys(each for each, *_ in columns):
        own = {name: end for (each, name, _), end in zip(columns, ends, strict=True) if each == file}
        sentence = _zero_sentence(own, loads[files == file])
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


def _has_several_loads(loads: Array) -> bool:
    """Return whether passes have several loads, all known."""
    return bool(np.isfinite(loads).all() and np.ptp(loads) > SAME_SPEED * loads.max())


def _candidates(mine: Flags, ways: Array, loads: Array, times: Array, force: Array) -> list[tuple[str, Array]]:
    """Return the columns of what a file may have beside the zero of its force: its drift, and a misalignment."""
    long = float(np.ptp(times[mine]))
    later = (times - times[mine].mean()) / long if long > 0 else np.zeros(len(times))
    found = [("drift", force * later)]
    if _has_several_loads(loads[mine]):
        found.append(("misalignment", np.where(mine, ways, 0.0)))
    return found


def _zero_sentence(found: dict[str, tuple[float, float]], loads: Array) -> str:
    """Return the sentence on the zero of the force of a file, its drift and misalignment, each with its standard error."""
    known = bool(np.isfinite(loads).all())
    parts = []
    for name, (value, doubt) in found.items():
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
    if known and not _has_several_loads(loads):
        angle = math.degrees(found["zero"][0] / float(np.median(loads)))
        several = f" (or the load is misaligned by {angle:.2g} degrees: two loads would tell)"
    return f"Both directions: {', '.join(parts)}{several}; taken off."


def _load(raw: Raw, each: Pass) -> float:
    """Return the mean load of a pass [N], NaN where the file has none."""
    loads = np.array([]) if raw.load is None else raw.load[each.rows]
    return float(np.nanmean(loads)) if np.isfinite(loads).any() else math.nan


def _least(design: Array, means: Array, errors: Array) -> tuple[Array, Array]:
    """Return the parameters of a weighted least squares and their covariance."""
    weighted = design / errors[:, None]
    covariance = np.asarray(np.linalg.pinv(weighted.T @ weighted, hermitian=True), float)
    return covariance @ (weighted.T @ (means / errors)), covariance
