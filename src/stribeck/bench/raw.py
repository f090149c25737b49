"""A rig's file as series in SI units: time, speed and friction with their signs, load and temperature of each row."""

import datetime
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from stribeck._types import Array, Flags, Indices
from stribeck.cases.fit_settings import FitSettings
from stribeck.files.cells import has_number, is_missing, is_named, rows_left_out
from stribeck.files.columns import has_dimension, si_factor
from stribeck.files.table_reading import read_table
from stribeck.files.text_table import TextTable
from stribeck.fits.columns import abscissa_of, candidates, columns_of, curve_labels, has_column, known_name, with_errors_named
from stribeck.fits.repeats import FEWEST, errors_of_means
from stribeck.fits.rig import PATTERNS, column_of, levels_of, measured, prepared, temperatures
from stribeck.fits.stated import inputs_said
from stribeck.fits.strokes import emptied, without_codes, without_codes_of_forces
from stribeck.fits.values import LARGEST_FRICTION, MADE_FRICTION, checked, numbers, what_may_be_wrong
from stribeck.quantities.formats import format_error, format_si
from stribeck.quantities.units import InputError, listed, show

# Headers of a time
TIME = (
    r"(?:(?:elapsed|test|total|run|running|measuring|cycle|relative) )?(?:time|zeit)|time ?stamp|t"
    r"|(?:mess|lauf|test|prüf|versuchs)zeit|zeitstempel|(?:date|datum)(?: ?(?:time|zeit|uhrzeit))?|clock|uhrzeit"
)

_LIKE_TIME = re.compile("time|zeit|date|clock|datum", re.IGNORECASE)

_DATE = re.compile(r"(?:(?P<year>\d{4})-(?P<month>\d\d)-(?P<day>\d\d)|(?P<of>\d\d?)\.(?P<in>\d\d?)\.(?P<at>\d{4}))[T ]")

_CLOCK = re.compile(r"(?:.*[T ])?(\d{1,3}):(\d\d):(\d\d(?:[.,]\d+)?)(?: ?(AM|PM))?(?:Z|[+-]\d\d:?\d\d)?", re.IGNORECASE)

DAY = 86400.0  # Seconds

UNLOADED = 0.05  # Part of the usual load below which the surfaces are apart

SAME_FRICTION = 0.02  # Relative difference up to which forces agree with the friction coefficient beside them


@dataclass(frozen=True)
class Raw:
    """The series of one file."""

    path: str
    numbers: Indices  # Row of the file
    time: Array  # Time [s]; rows where the file has none
    timed: bool  # Whether the file has a time
    speed: Array  # Sum of the surface speeds with the sign of the direction [m/s]
    friction: Array  # Friction coefficient with the sign of the force [-]
    stated: Array | None  # Standard error of the friction coefficient that the file gives [-]
    load: Array | None  # Size of the normal force [N]
    temperature: Array | None  # [degC]
    curve: Indices  # Curve of each row
    curves: tuple[tuple[str, dict[str, float]], ...]  # Name and inputs [SI] of each curve
    steps: tuple[str, ...]  # The step that the file says of each row; empty where it says none
    resolution: float  # Last digit of a friction coefficient [-]
    notes: tuple[str, ...]
    taken: str  # What each column was taken for
    said: dict[str, float]  # Inputs [SI] by lines above the header, by the name of the file and by the case


def read_raw(path: Path, settings: FitSettings) -> Raw:
    """Return the series of a file; refuse one that has none in a sentence."""
    asked, settings = settings, replace(settings, geometry="point")  # a rig measures forces
    table = with_errors_named(read_table(path, settings.header_row, knows=known_name, sheet=settings.sheet))
    table = without_codes_of_forces(table, settings)
    written = table.header
    table, zero = _zero_of_force(table, settings)
    own, load = settings, measured(table, "normal_force", settings)
    table, made, run, settings, _ = prepared(
        table,
        settings,
        lambda meaning: has_column(table, own, meaning) if meaning != "friction" else _uses_coefficient(table, own),
        signed=True,
    )
    columns = columns_of(table, settings)
    if "speed" not in columns:
        raise InputError(
            f"{table.path}: {show(next(iter(columns.values()))[0])} is no speed; a series needs a column of speed."
        )
    abscissa_of(table, columns, settings)  # which asks where a speed may be the mean of both surfaces or their sum
    if len(columns["friction"]) > 1:
        raise InputError(
            f"{table.path} has curves side by side, which are no series in time; 'stribeck fit' reads it as it is."
        )
    speed_name, friction_name = columns["speed"][0], columns["friction"][0]
    table = without_codes(table, speed_name, [friction_name])
    speed, friction = (
        numbers(table, name, meaning, settings) for name, meaning in ((speed_name, "speed"), (friction_name, "friction"))
    )
    table, friction = _plausible(table, friction_name, friction)
    stated = numbers(table, columns["error"][0], "error", settings) if "error" in columns else None
    time, timed, time_note = _time(table, table.header.index(run) if run else None)
    warm = temperatures(table)
    there = np.isfinite(speed) & np.isfinite(friction) & np.isfinite(time)
    if not there.any():
        raise InputError(f"{table.path}: no row holds both speed and friction; check the columns.")
    notes = [*table.notes, *table.thousands_noted([names[0] for names in columns.values() if names[0] in written]), *time_note]
    if zero is not None:
        assert load is not None
        friction = friction - zero / np.abs(load)
    if not there.all():
        notes.append(rows_left_out(np.array(table.numbers)[~there].tolist(), "without a value"))
    per_length = None if "load" in columns else _load_per_length(table)
    curve, curves = _curves(table, columns, settings, {} if per_length is None else {"load_per_length": per_length[0]})
    labels = table.column(run) if run else ()
    kept = np.flatnonzero(there)
    parts = [f"{show(names[0])} as {meaning.replace('_', ' ')}" for meaning, names in columns.items() if names[0] in written]
    if per_length is not None:
        parts.append(f"{show(per_length[1])} as load per length")
    if warm is not None:
        parts.append(f"{show(warm[1])} as temperature")
    told = "; ".join([*made, *parts])
    notes += _unread_labels(table, [name for name in written if name and show(name) not in told and name != run])
    of_case, said, unused = _said(table, asked, path.name, [*columns, *(["temperature"] if warm is not None else [])])
    return Raw(
        path=table.path,
        numbers=np.array(table.numbers)[kept],
        time=time[kept],
        timed=timed,
        speed=speed[kept],
        friction=friction[kept],
        stated=None if stated is None else stated[kept],
        load=None if load is None else np.abs(load)[kept],
        temperature=None if warm is None else warm[0][kept],
        curve=curve[kept],
        curves=curves,
        steps=tuple(labels[i] for i in kept) if labels else (),
        resolution=_resolution(table, friction_name, own) * float(np.median(np.abs(friction[there]))),
        notes=(*notes, *unused),
        taken="; ".join([*made, *parts, *of_case]),
        said=said,
    )


def _plausible(table: TextTable, name: str, friction: Array) -> tuple[TextTable, Array]:
    """Return the table and its friction without what no friction is, such as an overflow; refuse where most rows are so."""
    out = np.abs(friction) > LARGEST_FRICTION
    if not out.any():
        return table, friction
    if 2 * out.sum() > np.isfinite(friction).sum():
        raise InputError(
            f"{table.path}: column {show(name)}: a friction coefficient of {np.nanmedian(np.abs(friction)):.3g} "
            f"is not plausible; {what_may_be_wrong(name)}."
        )
    which = f"with a friction coefficient above {LARGEST_FRICTION:g} in size, which is none (an overflow, or percent),"
    return emptied(table, name, out, which), np.where(out, np.nan, friction)


def _said(
    table: TextTable, asked: FitSettings, name: str, columns: list[str]
) -> tuple[list[str], dict[str, float], list[str]]:
    """Return sentences, numbers and notes on what file, name and case say of all rows; a load is a force, or per length."""
    try:
        texts, found, unused = inputs_said(table, replace(asked, geometry="point"), name, columns)
    except InputError:
        if asked.geometry != "line":
            raise
        texts, found, unused = inputs_said(table, asked, name, columns)
        if "load" in found:
            found["load_per_length"] = found.pop("load")
    return texts, {key: value for key, value in found.items() if isinstance(value, float)}, unused


def _uses_coefficient(table: TextTable, settings: FitSettings) -> bool:
    """Return whether the friction coefficient of the file is taken, and not the forces, which keep the sign."""
    if not has_column(table, settings, "friction"):
        return False
    force, load = measured(table, "friction_force", settings), measured(table, "normal_force", settings)
    if "friction" in settings.columns or force is None or load is None:
        return True
    given = numbers(table, candidates(table, settings, "friction")[0], "friction", settings)
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.abs(force / load)
        apart = np.abs(found / np.abs(given) - 1)
    apart = apart[np.isfinite(apart)]
    return not apart.size or float(np.median(apart)) > SAME_FRICTION


def _zero_of_force(table: TextTable, settings: FitSettings) -> tuple[TextTable, Array | None]:
    """Return the table without rows in which the surfaces are apart, and the zero of the force in the others."""
    load = measured(table, "normal_force", settings)
    if load is None:
        return table, None
    sizes = np.abs(load)
    loaded = sizes[sizes > UNLOADED * np.nanmax(sizes, initial=0.0)]
    apart = sizes <= UNLOADED * (np.median(loaded) if loaded.size else 0.0)
    if not apart.any() or apart.all():
        return table, None
    force = measured(table, "friction_force", settings)
    of_rows = np.array(table.numbers, float)
    shorter = table.of_rows(~apart)
    force = np.full(len(sizes), np.nan) if force is None else force
    stretches = [each[np.isfinite(force[each])] for each in _stretches(apart)]
    stretches = [each for each in stretches if len(each) >= FEWEST]
    if not stretches:
        note = f"{int(apart.sum())} rows without load left out."
        return replace(shorter, notes=(*shorter.notes, note)), None
    series = [force[each] for each in stretches]
    errors = errors_of_means([each - each.mean() for each in series])
    means = np.array([float(each.mean()) for each in series])
    texts = " and ".join(f"{format_si(m, 'force')} ± {format_error(e, 'force')}" for m, e in zip(means, errors, strict=True))
    drift = ("", ", on a straight line between the two", ", on straight lines between them")[min(len(means) - 1, 2)]
    said = f"Zero of the force by {int(apart.sum())} rows without load: {texts}, taken off{drift}."
    # Between two stretches on the straight line, else that of the nearest
    zero = np.interp(np.array(shorter.numbers, float), [float(of_rows[each].mean()) for each in stretches], means)
    return replace(shorter, notes=(*shorter.notes, said)), zero


def _stretches(rows: Flags) -> list[Indices]:
    """Return the rows that are set, each stretch of neighbours by itself."""
    places = np.flatnonzero(rows)
    return [each for each in np.split(places, np.flatnonzero(np.diff(places) > 1) + 1) if len(each)]


def _time(table: TextTable, step: int | None) -> tuple[Array, bool, list[str]]:
    """Return the time of each row [s], whether the file has one, and what is to be said; refuse one that runs backwards."""
    rows = np.arange(len(table.rows), dtype=float)
    unread = []
    for name in filter(None, dict.fromkeys(table.header)):
        unit = "" if ":" in table.unit(name) else table.unit(name)  # hh:mm:ss is the form of its cells
        like = _LIKE_TIME.search(name)
        if not is_named(name, TIME):
            unread += [f"{show(name)} was not read as time, as its name is not known as one"] if like else []
            continue
        if not (has_dimension(unit or "-", "time") or (not unit and like)):
            unread += [f"{show(name)} was not read as time, as {show(unit)} is no unit of time"] if like else []
            continue
        read = table.values(name)
        there = bool(np.isfinite(read).any())
        stamps = None if there else _stamps(table.column(name))
        if stamps is not None:
            return _going_on(table, name, stamps, step), True, [f"{show(name)} was read as the time of day."]
        if not there:
            cell = next(filter(None, table.column(name)), "")
            unread.append(f"{show(name)} was not read as time, as {show(cell)} is neither a number nor a clock that goes on")
            continue
        time = read * (si_factor(unit, "time", name) if unit else 1.0)
        if np.ptp(time[np.isfinite(time)]) == 0:
            unread.append(f"{show(name)} is the same in all rows")  # the length of a step
            continue
        said = [] if unit else [f"{show(name)} was read in seconds, as its header has no unit."]
        return _going_on(table, name, time, step), True, said
    spaced = f"{'; '.join(unread) or 'The file has no time'}; rows count as evenly spaced."
    return rows, False, [spaced] if len(rows) > FEWEST else []


def _stamps(cells: Sequence[str]) -> Array | None:
    """Return the seconds since the first of times of day, with or without a date; None where cells are none."""
    found, first, days, before = [], 0.0, 0.0, -1.0
    for cell in cells:
        clock = _CLOCK.fullmatch(cell.strip())
        if clock is None:
            found.append(math.nan)
            continue
        hours = int(clock[1]) % 12 + 12 * (clock[4].upper() == "PM") if clock[4] else int(clock[1])
        seconds = 3600.0 * hours + 60 * int(clock[2]) + float(clock[3].replace(",", "."))
        date = _DATE.match(cell.strip())
        if date is not None:
            parts = date.group("year", "month", "day") if date["year"] else date.group("at", "in", "of")
            try:
                day = DAY * datetime.date(*map(int, parts)).toordinal()
            except ValueError:  # no day of any calendar
                found.append(math.nan)
                continue
            first = first or day
            days = day - first
        elif seconds < before - DAY / 2:  # midnight has passed
            days += DAY
        before = seconds
        found.append(days + seconds)
    time = np.array(found)
    known = np.isfinite(time)
    if not known.any() or np.ptp(time[known]) == 0:
        return None
    return np.asarray(time - time[known][0])


def _going_on(table: TextTable, name: str, time: Array, step: int | None) -> Array:
    """Return a time that goes on where it begins again with a step, as many rigs write it."""
    found = time.copy()
    known = np.flatnonzero(np.isfinite(time))
    steps = np.diff(time[known])
    usual = float(np.median(steps[steps > 0])) if (steps > 0).any() else 1.0
    shift, first = 0.0, time[known[0]]
    for before, after in zip(known[:-1], known[1:], strict=True):
        if time[after] < time[before]:
            again = step is not None and table.rows[after][step] != table.rows[before][step]
            if not again and time[after] > first + usual:
                raise InputError(
                    f"{table.path}: row {table.numbers[after]}, column {show(name)}: time runs backwards, from "
                    f"{time[before]:g} s to {time[after]:g} s, and does not begin again; sort the rows, or take out those "
                    "that do not belong to the series."
                )
            shift += time[before] - time[after] + usual
            first = time[after]
        found[after] = time[after] + shift
    return found


def _load_per_length(table: TextTable) -> tuple[Array, str] | None:
    """Return the settings [N/m] of the load on a cylinder in each row, and the header of its column; None without one."""
    for name in filter(None, table.header):
        if is_named(name, rf"(?:line(?:ar)? )?(?:{PATTERNS['normal_force']})") and has_dimension(
            table.unit(name) or "-", "load"
        ):
            loads = np.abs(table.numbers_of(name, lambda unit, where: si_factor(unit, "load", where)))
            loads[~(loads > 0)] = np.nan
            loads[loads > 0] = levels_of(loads[loads > 0])
            return loads, name
    return None


def _unread_labels(table: TextTable, names: Sequence[str]) -> list[str]:
    """Return notes on columns of words that stand in several rows each, such as those of two liquids, and are not used."""
    found = []
    for name in names:
        read = name not in table.header or is_named(name, TIME)
        words = [] if read else [cell for cell in table.column(name) if not is_missing(cell)]
        different = list(dict.fromkeys(words))
        if 1 < len(different) <= len(words) / FEWEST and not any(map(has_number, different)):
            example = listed(map(show, different[:2]))
            found.append(
                f"{show(name)} was not used, though its rows differ, as {example}; curve = {show(name)} in [fit.columns] "
                "makes curves of them."
            )
    return found


def _curves(
    table: TextTable, columns: dict[str, list[str]], settings: FitSettings, others: dict[str, Array]
) -> tuple[Indices, tuple[tuple[str, dict[str, float]], ...]]:
    """Return the curve of each row, and name and inputs of each curve."""
    given = [name for name in columns if name in settings.inputs.quantities and name not in ("speed", "boundary_friction")]
    labels = curve_labels(table, columns)
    series = others | {name: checked(table, columns[name][0], name, settings) for name in given}
    keys: dict[tuple[str, tuple[tuple[str, float], ...]], int] = {}
    found = []
    last: dict[str, float] = {}
    for i, label in enumerate(labels):
        last = last | {name: float(each[i]) for name, each in series.items() if not np.isnan(each[i])}
        found.append(keys.setdefault((label, tuple(sorted(last.items()))), len(keys)))
    return np.array(found), tuple((label, dict(inputs)) for label, inputs in keys)


def _resolution(table: TextTable, friction: str, settings: FitSettings) -> float:
    """Return the last digit of what friction was read from, over its usual size."""
    sources = (column_of(table, meaning, settings) for meaning in ("friction_force", "torque"))
    name = friction if friction != MADE_FRICTION else next(filter(None, sources), "")
    if not name:
        return 0.0
    sizes = np.abs(table.values(name))
    sizes = sizes[sizes > 0]
    return _last_digit(table.column(name)) / float(np.median(sizes)) if sizes.size else 0.0


def _last_digit(cells: Sequence[str]) -> float:
    """Return the last digit that cells have after the decimal sign; zero where some have an exponent."""
    digits = [re.fullmatch(r"[+-]?\d*(?:[.,](\d*))?", cell.strip()) for cell in cells]
    counts = [len(each[1] or "") for each in digits if each]
    return 10.0 ** -max(counts) if counts and 2 * len(counts) > len(cells) else 0.0
