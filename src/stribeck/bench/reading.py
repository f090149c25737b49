"""Raw files of a rig read into one Stribeck curve, or one for each fluid and load, with the error of each point."""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from stribeck.bench.passes import RUN_IN, Pass, Series, directions, passes_of
from stribeck.bench.points import Point, points_of, run_in_of
from stribeck.bench.raw import read_raw
from stribeck.bench.result import INPUTS, BenchCurve
from stribeck.cases.case import Case
from stribeck.cases.fit_settings import FitSettings, with_bench_keys
from stribeck.cases.reading import load_rig
from stribeck.fits.measurements import files_of
from stribeck.fluids.presets import PRESETS, Preset
from stribeck.quantities.formats import format_si
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.units import InputError, checked_kind, listed

OnFile = Callable[[int, int], Any]  # Called with the number of files read and of all


@answers_typos
def read(
    runs: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    settings: str | os.PathLike[str] | Case | FitSettings | None = None,
    *,
    name: str | None = None,
    fluid: str | Mapping[str, Any] | None = None,
    temperature: str | float | None = None,
    per_decade: float | None = None,
    arm: str | float | None = None,
    track_radius: str | float | None = None,
    on_file: OnFile | None = None,
) -> BenchCurve:
    r"""Read raw files of a rig into a Stribeck curve: what is steady, both directions averaged, with the error of each point.

    Parameters
    ----------
    runs : str, path-like or list of them
        Files of a tribometer or a rheometer, or globs: columns of speed (or rotation) and friction (or forces, or torque).
    settings : path-like, Case or FitSettings, optional
        A case, or a file with its table ``[bench]`` alone: columns in another language, units that no header gives, what
        files have for themselves, and all options of this call, which count for more; or ``case.fit``.
    name : str, optional
        Pattern of the names of the files, as ``"{fluid}_{load}N_{run}"``: ``run`` numbers repeats, all else tells curves
        apart.
    fluid : str or mapping, optional
        Liquid by which the temperature gives the viscosity, as ``"iso-vg grade=46"`` or ``{"preset": "iso-vg", "grade": 46}``;
        by default that of the case, if it is such a preset.
    temperature : str or float, optional
        Temperature where the files have none, as ``"25 degC"``.
    per_decade : float, optional
        Bins for a decade of a speed that never rests, in a ramp or a sine; 10 if the case has none.
    arm : str or float, optional
        Arm over which a torque is the friction force, as ``"20 mm"`` [m].
    track_radius : str or float, optional
        Radius of the track on which a rotation is a speed [m].
    on_file : callable, optional
        Called after each file with the number of those read and of all.

    Returns
    -------
    BenchCurve
        Its error is half of the 95 % interval over 1.96; in 40 simulated series, of noise with a correlation of 0.9 from row
        to row, a drifting zero of the force and a start in each step, 90 to 99 % of the intervals hold the truth
        (``test_bench.py``).

    Raises
    ------
    InputError
        If a file cannot be read, or a value be used; the sentence names file, row and column.

    Examples
    --------
    >>> import stribeck as sb
    >>> import pathlib, tempfile
    >>> rows = [f"{0.1 * i};{5 if i < 60 else 10};{0.3 + 0.01 * (i % 3)}" for i in range(120)]
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "run.csv"
    >>> _ = file.write_text("time [s];speed [mm/s];COF\n" + "\n".join(rows))
    >>> curve = sb.bench.read(file)
    >>> curve.speed.round(6).tolist(), curve.rows.tolist()
    ([0.005, 0.01], [60, 60])
    """
    options = {
        "name": name,
        "fluid": fluid,
        "temperature": temperature,
        "per_decade": per_decade,
        "arm": arm,
        "track_radius": track_radius,
    }
    settings = with_bench_keys(_settings(settings), {key: each for key, each in options.items() if each is not None})
    several = [runs] if isinstance(runs, str | os.PathLike) else list(runs)
    if not several:
        raise InputError("runs is empty; give the files of a rig.")
    paths = files_of(several)
    for i, path in enumerate(paths):
        if path in paths[:i]:
            raise InputError(f"{path} is given twice; a file counts once.")
    series: list[Series] = []
    for i, path in enumerate(paths, 1):
        try:
            series.append(passes_of(read_raw(path, settings), settings.per_decade))
        except InputError as problem:
            raise InputError(_of_bench(str(problem))) from None
        if on_file is not None:
            on_file(i, len(paths))
    curves: list[tuple[str, dict[str, float]]] = []
    passes: list[Pass] = []
    for f, (path, one) in enumerate(zip(paths, series, strict=True)):
        names = {} if settings.file_names is None else settings.file_names.labels(path.name)
        own = [
            (" ".join(filter(None, [names.get("fluid", ""), label])), inputs | one.raw.said)
            for label, inputs in one.raw.curves
        ]
        for each in own:
            if each not in curves:
                curves.append(each)
        passes += [replace(each, file=f, curve=curves.index(own[each.curve])) for each in one.passes]
    labels, inputs_of = _labels(curves), tuple(inputs for _, inputs in curves)
    texts = [path.name for path in paths]
    out = [passes[i] for i in run_in_of(passes, labels)] if settings.run_in == "leave" else []
    points, said = points_of([each for each in passes if each not in out], [one.raw for one in series], texts)
    for gone in out:
        series[gone.file].status[gone.rows] = RUN_IN
    liquid = _liquid(settings)
    notes = [
        _of_bench(f"{text}: {note}" if len(texts) > 1 else note)
        for text, one in zip(texts, series, strict=True)
        for note in (*one.raw.notes, *one.notes)
    ]
    notes += [
        f"Left out as run-in: {texts[each.file]}, {format_si(each.speed, 'speed')}, which differs from later passes "
        f'(run_in = "keep" in [bench] keeps it).'
        for each in out
    ]
    of_points: dict[str, Any] = {
        each.name: np.array([getattr(point, each.name) for point in points]) for each in fields(Point)
    }
    return BenchCurve(
        paths=tuple(map(str, paths)),
        curves=labels,
        inputs=inputs_of,
        **of_points,
        viscosity=np.array([_viscosity(point, inputs_of[point.curve], liquid) for point in points]),
        notes=(*notes, *said, *_on_errors(points), *_on_viscosity(points, liquid)),
        taken=tuple(one.raw.taken for one in series),
        rolls=settings.rolls or any("slide_to_roll" in each for each in inputs_of),
        file=np.concatenate([np.full(len(one.status), f) for f, one in enumerate(series)]),
        row=np.concatenate([one.raw.numbers for one in series]),
        time=np.concatenate([one.raw.time for one in series]),
        row_speed=np.concatenate([directions(one.raw.speed, one.raw.friction)[0] for one in series]),
        row_friction=np.concatenate([one.friction for one in series]),
        status=np.concatenate([one.status for one in series]),
    )


def _settings(given: str | os.PathLike[str] | Case | FitSettings | None) -> FitSettings:
    """Return what a call was given of the files."""
    if given is None:
        return FitSettings()
    if isinstance(given, str | os.PathLike):
        return load_rig(given)
    return given.bench if isinstance(given, Case) else checked_kind("settings", given, FitSettings, "a case or its settings")


def _of_bench(text: str) -> str:
    """Return what a reader of data files says, with the table in which a rig has it."""
    return text.replace("[fit", "[bench")


def _labels(curves: Sequence[tuple[str, dict[str, float]]]) -> tuple[str, ...]:
    """Return names of the curves that tell them apart, by their inputs where the files have no names."""
    found = []
    for name, inputs in curves:
        alike = [each for other, each in curves if other == name]
        differing = [key for key in inputs if len({each.get(key) for each in alike}) > 1]
        texts = [f"{key.replace('_', ' ')} {format_si(inputs[key], INPUTS[key].dimension)}" for key in differing]
        found.append(", ".join(filter(None, [name, *texts])))
    return tuple(found)


def _liquid(settings: FitSettings) -> tuple[Preset, dict[str, Any]] | None:
    """Return the liquid and its conditions, None where its viscosity is not known over the temperature."""
    preset = PRESETS.get(settings.liquid.get("preset", ""))
    if preset is None or "temperature" not in preset.conditions:
        return None
    return preset, {key: value for key, value in settings.liquid.items() if key in preset.conditions}


def _viscosity(point: Point, inputs: dict[str, float], liquid: tuple[Preset, dict[str, Any]] | None) -> float:
    """Return the viscosity of a point [Pa s]: of its curve, else of the liquid at its temperature; else NaN."""
    known = inputs.get("viscosity")
    if known is not None or liquid is None:
        return np.nan if known is None else known
    preset, conditions = liquid
    if np.isfinite(point.temperature):
        conditions = conditions | {"temperature": point.temperature}
    elif "temperature" not in conditions:
        raise InputError("fluid needs a temperature: the files have none; give temperature, as '25 degC'.")
    return preset(**conditions).viscosity


def _on_errors(points: Sequence[Point]) -> list[str]:
    against = [format_si(each.speed, "speed") for each in points if each.friction <= 0]
    if against:
        said = (
            f"Friction is not positive at {listed(against)}: check the zero of the force, and codes of missing values there."
        )
        return [said, *_on_errors([each for each in points if each.friction > 0])]
    unknown = [each for each in points if not np.isfinite(each.half_width)]
    if not unknown:
        return ["Errors allow for the correlation of neighbouring values; 'error' is half of the 95 % interval over 1.96."]
    which = (
        "Nothing shows the errors of the points"
        if len(unknown) == len(points)
        else f"Nothing shows the error of {len(unknown)} points"
    )
    return [
        f"{which}: a file of single means for each speed has none; export the raw samples, or measure each speed more often."
    ]


def _on_viscosity(points: Sequence[Point], liquid: tuple[Preset, dict[str, Any]] | None) -> list[str]:
    known = [each.temperature for each in points if np.isfinite(each.temperature)]
    if not known:
        return []
    lowest, highest = f"{min(known):.1f}", f"{max(known):.1f}"
    temperature = f"{lowest} °C" if lowest == highest else f"{lowest} to {highest} °C"
    if liquid is not None:
        preset, conditions = liquid
        taken = {name: value for name, value in (preset.conditions | conditions).items() if name != "temperature"}
        told = f" ({', '.join(f'{name} = {value}' for name, value in taken.items())})" if taken else ""
        return [f"Viscosity of {preset.label}{told} at {temperature}, of each point."]
    return [
        f"The temperature was {temperature}; name the liquid (--fluid 'iso-vg grade=46', in Python fluid=) to have its "
        "viscosity there."
    ]
