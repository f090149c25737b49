"""Commands on measurements: curves from raw files of a rig, fits, what to measure next, and published experiments."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

import stribeck as sb
from stribeck.cli.arguments import OUTPUTS, Names, Outputs, Quantities, Quantity, Verbose, Whole
from stribeck.cli.exits import EXIT_FAILED, answer, complain
from stribeck.cli.progress import interruptible
from stribeck.files.writing import check_writable
from stribeck.quantities.formats import format_percent
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    from stribeck.cases.case import Case
    from stribeck.experiments.experiment import Experiment, Prediction


STROKES = 20  # Strokes that a fit of a loop solves, about

SHORT_NOTES = 8  # Notes that are printed without -v, so that the answer fits a screen

ENDING = ".toml"  # Of case files


def fit_command(
    *files: Path,
    free: Names = None,
    per_file: Names = None,
    out: Path | None = None,
    robust: bool = False,
    posterior: Whole | None = None,
    outputs: Outputs = OUTPUTS,
) -> int:
    """Fit inputs to measured friction, with confidence intervals and what the data cannot determine.

    Example: stribeck fit examples/pdms_measured.csv examples/pdms_fit.toml --plot fit.png --out fitted.toml

    Example: stribeck fit measured.csv case.toml --free boundary_friction roughness modulus --robust

    Example: stribeck fit oil_*.csv water.csv case.toml --free boundary_friction roughness --per-file roughness

    Several data files are fitted together; [fit.files] of the case says in what they differ.
    """
    from stribeck.fits.case_file import check_fitted_case, write_fitted_case

    data, loaded = read_arguments("fit", files)
    outputs.check(out)
    from stribeck.fits.fit import names_to_fit
    from stribeck.fits.posterior import check_posterior, draw_posterior

    if posterior is not None:
        check_posterior(posterior, robust or loaded.fit.robust)
    if out is not None:
        check_fitted_case(loaded, names_to_fit(free, loaded.fit, loaded.contact), out)
    with interruptible() as progress:
        found = sb.fit(data, loaded, free=free, per_file=per_file, robust=True if robust else None, on_step=progress.of_fit)
        drawn = None
        if posterior is not None:
            drawn = draw_posterior(found, steps=posterior, on_step=lambda n, m: progress(n, m, "posterior"))
    others = {out: partial(write_fitted_case, found, loaded, out, force=outputs.force)} if out and found.converged else {}

    def content() -> dict[str, Any]:
        return {"title": loaded.title} | found.to_dict() | ({} if drawn is None else {"posterior": drawn.to_dict()})

    said = filter(None, [found.checks.first_line, loaded.title, str(found), str(drawn or "")])
    code = outputs.finish(found, lambda: said, loaded.title, content=content, others=others, checks=found.checks)
    return code if code or found.converged else complain(found.outcome.value, EXIT_FAILED)


def loop_command(
    *files: Path,
    free: Names = None,
    outputs: Outputs = OUTPUTS,
) -> int:
    """Fit inputs to a friction loop of a motion to and fro, by strokes solved in time, with confidence intervals.

    Example: stribeck loop loop.csv case.toml --plot loop.png

    The file has a column position [mm] or time [s], and friction, below zero on the way back; the case has the motion in
    [stroke].
    """
    data, loaded = read_arguments("loop", files)
    if len(data) > 1:
        raise InputError(f"{' and '.join(map(str, data))}: loop takes one file.")
    outputs.check()
    with interruptible() as progress:
        found = sb.bench.fit_loop(data[0], loaded, free=free, on_step=lambda n: progress(n, max(n, STROKES), "stroke"))
    headline, _, rest = str(found).partition("\n")
    said = filter(None, [headline, loaded.title, rest])
    code = outputs.finish(found, lambda: said, loaded.title, content=lambda: {"title": loaded.title} | found.to_dict())
    return code if code or found.outcome.ok else complain(found.outcome.value, EXIT_FAILED)


def next_command(
    *files: Path,
    count: Whole = 3,
    speeds: Quantities = None,
    loads: Quantities = None,
    viscosities: Quantities = None,
    outputs: Outputs = OUTPUTS,
) -> int:
    """Fit measured friction and report which runs to measure next: those that shrink the intervals most for their cost.

    Example: stribeck next examples/pdms_measured.csv examples/pdms_fit.toml --count 5 --plot next.png

    Example: stribeck next measured.csv case.toml --loads "10 N/m" "100 N/m"
    """
    data, loaded = read_arguments("next", files)
    outputs.check()
    with interruptible() as progress:
        found = sb.fit(data, loaded, intervals=False, on_step=progress.of_fit)
        plan = sb.next_runs(
            found,
            count,
            speeds=speeds,
            loads=loads,
            viscosities=viscosities,
            on_step=lambda n, m: progress(n, m, "states"),
        )
    said = filter(None, [found.checks.first_line, str(plan)])
    return replace(outputs, no_notes=False).finish(plan, lambda: said, loaded.title, checks=found.checks)


def master_command(*files: Path, outputs: Outputs = OUTPUTS) -> int:
    """Put all fluids and loads over viscosity times speed and over the Hersey number, and report what breaks one curve.

    Example: stribeck master oil_*.csv water.csv case.toml --plot master.png

    Prints the scatter about one curve relative to the errors, and which file, load or fluid breaks it.
    """
    data, loaded = read_arguments("master", files)
    outputs.check()
    found = sb.master_curve(data, loaded)
    return outputs.finish(found, lambda: [loaded.title, str(found)], loaded.title)


def compare_command(
    *files: Path,
    models: str | None = None,
    free: Names = None,
    out: Path | None = None,
    outputs: Outputs = OUTPUTS,
) -> int:
    """Fit measured friction with several contact laws or models and report which the data prefer, and by how much.

    Example: stribeck compare examples/pdms_measured.csv examples/pdms_fit.toml --plot laws.png --out laws.csv

    Example: stribeck compare measured.csv case.toml --models cavitation --free boundary_friction roughness

    --out writes the criteria of all laws as data (.nc, .zarr, .csv or .parquet), or the preferred one with its fitted values
    as a case (.toml), which the other commands read.
    """
    from stribeck.experiments.compare import write_preferred_case
    from stribeck.files.datasets import EXPORT_ENDINGS, write_data

    data, loaded = read_arguments("compare", files)
    as_case = out if out is not None and out.suffix.lower() == ENDING else None
    if out is not None and out.suffix.lower() not in EXPORT_ENDINGS:
        check_writable(out, (*EXPORT_ENDINGS, ENDING), force=outputs.force)
    outputs.check(as_case, data=[out] if out is not None and as_case is None else [])
    with interruptible() as progress:
        found = sb.compare(data, loaded, models=models, free=free, on_step=progress.of_fit)
    stored: list[str] = []
    others: dict[Path, Callable[[], object]] = {}
    if as_case is not None:
        others[as_case] = lambda: stored.append(write_preferred_case(found, loaded, as_case, force=outputs.force))
    elif out is not None:
        others[out] = lambda: write_data(found.to_dataset(), out, force=outputs.force)

    def lines() -> list[str]:
        of_case = [f"{out} is the case of {name}." for name in stored]
        return [*filter(None, [found.candidates[0].fit.checks.first_line, str(found)]), *of_case]

    return outputs.finish(found, lines, loaded.title, others=others)


def read_arguments(command: str, files: Sequence[Path]) -> tuple[list[Path], Case]:
    """Return the data files and the case that a command was given, which may stand in any order."""
    # Imported here, so that other commands need not load fits.
    from stribeck.cases.reading import load_case
    from stribeck.files.toml import read_toml
    from stribeck.fits.measurements import files_of, missing_text

    example = f"stribeck {command} measured.csv case.toml"
    if not files:
        raise InputError(f"DATA is missing, and CASE too; give files of measured friction and the case, as in: {example}.")
    found = files_of(files)
    cases = [path for path in found if path.suffix.lower() == ENDING]
    data = [path for path in found if path.suffix.lower() != ENDING]
    listed = " and ".join(map(str, found))
    if not cases:
        raise InputError(
            f"CASE is missing: {listed} {'are' if len(data) > 1 else 'is'} taken for data, as the name of a case ends in "
            f"{ENDING}; give it as in: {example}. To write one: stribeck new case.toml."
        )
    for path in cases:
        read_toml(path)  # which says what is wrong with one
    if not data:
        what = "are case files" if len(cases) > 1 else "is a case file"
        raise InputError(f"DATA is missing: {listed} {what}; give files of measured friction too, as in: {example}.")
    if len(cases) > 1:
        several = " and ".join(map(str, cases))
        raise InputError(f"{several} are case files; {command} takes one of them, with any number of data files.")
    for path in found:
        if not path.exists():
            raise InputError(missing_text(path))
    return data, load_case(cases[0])


def bench_command(
    runs: Annotated[list[str], Parameter(consume_multiple=True)],
    /,
    *,
    out: Annotated[Path | None, Parameter(alias="-o")] = None,
    case: Path | None = None,
    name: str | None = None,
    fluid: str | None = None,
    temperature: Quantity = None,
    per_decade: float | None = None,
    arm: Quantity = None,
    track_radius: Quantity = None,
    verbose: Verbose = False,
    outputs: Outputs = OUTPUTS,
) -> int:
    """Make a Stribeck curve of raw files of a rig: what is steady, both directions averaged, the error of each point.

    Example: stribeck bench run_1.csv run_2.csv -o curve.csv --plot kept.png

    Example: stribeck bench "runs/*.csv" -o curve.csv --name "{fluid}_{load}N_{run}.csv" --fluid "iso-vg grade=46"

    Example: stribeck bench rheometer.csv -o curve.csv --arm "15 mm" --track-radius "15 mm"

    stribeck fit reads the curve as it is.  --arm makes a torque a friction force, --track-radius a rotation a speed, and
    --fluid gives the viscosity at the temperature of the file or of --temperature.  --name is the pattern of the file names.

    The table [bench] of --case has these options, columns and units.  --per-decade is the number of bins in a decade of speed
    where the speed never rests.
    """
    if out is not None:
        from stribeck.files.datasets import CSV_ENDINGS

        check_writable(out, CSV_ENDINGS, force=outputs.force)
    outputs.check()
    with interruptible() as progress:
        found = sb.bench.read(
            runs,
            case,
            name=name,
            fluid=fluid,
            temperature=temperature,
            per_decade=per_decade,
            arm=arm,
            track_radius=track_radius,
            on_file=lambda n, m: progress(n, m, "files"),
        )

    def lines() -> list[str]:
        from stribeck.quantities.results import table_lines

        card = found._card()
        notes = card.notes if verbose or len(card.notes) <= SHORT_NOTES else card.notes[-SHORT_NOTES:]
        read = card.sentences if verbose else card.sentences[:1]
        hidden = len(card.notes) - len(notes) + len(card.sentences) - len(read)
        more = [f"-v shows {hidden} more note{'s' * (hidden > 1)}."] if hidden else []
        return [card.headline, *table_lines(card.table, card.right), *read, *(f"Note: {note}" for note in notes), *more]

    curve = {} if out is None else {out: partial(found.to_csv, out, force=outputs.force)}
    return outputs.finish(found, lines, others=curve)


def experiment_command(
    folder: Path,
    /,
    *,
    model: str | None = None,
    verbose: Verbose = False,
    json: bool = False,
) -> int:
    """Predict a published experiment without a fit and report measured over predicted, the model's error first.

    Example: stribeck experiment tests/data/experiments/oring

    The folder holds experiment.toml, in which every input has a value, an error and a source, and a table of what was
    measured.  --model predicts by one of its models instead of all.
    """
    from stribeck.experiments.experiment import load_experiment, predict_experiment

    experiment = load_experiment(folder)
    names = list(experiment.models) if model is None else [model]
    with interruptible() as progress:
        found = [predict_experiment(experiment, name, progress) for name in names]
    answer(json, lambda: _experiment_content(experiment, found), lambda: _experiment_lines(experiment, found, verbose))
    return 0


def _experiment_content(experiment: Experiment, found: list[Prediction]) -> dict[str, Any]:
    numbers = ("predicted", "predicted_error", "measured", "measured_error", "ratio", "ratio_error", "agrees")
    models = {each.model: {name: getattr(each, name).tolist() for name in numbers} for each in found}
    about = {name: getattr(experiment, name) for name in ("title", "source", "licence", "relative_to")}
    return about | {"unknown": list(experiment.unknown), "rows": list(experiment.labels), "models": models}


def _experiment_lines(experiment: Experiment, found: list[Prediction], verbose: bool) -> Iterator[str]:
    """Yield each model's answer, then what is not known, and with all the inputs and their sources."""
    for each in found:
        yield str(each)
    yield from (f"Not known: {sentence}" for sentence in experiment.unknown)
    yield f"{experiment.title}. Source: {experiment.source} ({experiment.licence})."
    if not verbose:
        yield "-v shows every input with its error and source."
        return
    for stated in dict.fromkeys(stated for each in found for stated in experiment.inputs[each.model]):
        error = "error not known" if stated.error is None else f"± {format_percent(stated.error)}"
        yield f"{stated.name} = {stated.value} {error}: {stated.source}"
