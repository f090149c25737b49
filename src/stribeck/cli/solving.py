"""Commands that solve: one state, a curve, the regimes of a contact, the figures of the article."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

import stribeck as sb
from stribeck.cli.arguments import (
    AXES,
    Beta,
    BoundaryFriction,
    CaseFile,
    CavitationWord,
    CavityPressure,
    File,
    Flag,
    FlowFactorsWord,
    GroupsLaw,
    NoNotes,
    Number,
    Pair,
    SlideToRoll,
    Triple,
    Word,
    as_group,
    as_number,
    as_rtol,
    check_outputs,
    check_pictures,
    curve_arguments,
    model_parts,
    read_case,
    read_duration,
)
from stribeck.cli.exits import EXIT_BAD_INPUT, EXIT_FAILED, EXIT_INTERRUPTED, complain, say, stdout_console, write_each
from stribeck.cli.progress import Progress, interruptible
from stribeck.quantities.formats import format_si
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    from stribeck.checks.check import Checks
    from stribeck.uncertainty.band import Band


def solve_command(
    case: CaseFile = None,
    /,
    *,
    groups: Triple = None,
    boundary_friction: BoundaryFriction = None,
    beta: Beta = None,
    law: GroupsLaw = None,
    slide_to_roll: SlideToRoll = None,
    cavitation: CavitationWord = None,
    cavity_pressure: CavityPressure = None,
    flow_factors: FlowFactorsWord = None,
    rtol: Number = None,
    plot: File = None,
    no_notes: NoNotes = False,
    json: Flag = False,
    force: Flag = False,
) -> int:
    """Solve one state: film thickness, load shares and friction, each with its error.

    Example: stribeck solve examples/pdms_cylinder.toml --plot profile.png

    Example: stribeck solve --groups 1e-5 0.1 1e-4 --json

    Example: stribeck solve examples/pdms_cylinder.toml --cavitation exit --slide-to-roll 0.5
    """
    loaded = read_case(case, groups, boundary_friction, beta, law)
    tolerance = as_rtol(rtol, loaded)
    mu, b = as_number("boundary_friction", boundary_friction), as_number("beta", beta)
    if mu is not None or b is not None:
        from stribeck.contacts.friction import coefficients

        coefficients(None, mu, b)
    pictures = check_pictures(plot, force)
    if loaded is None and (boundary_friction is not None or slide_to_roll is not None):
        _say_unusual(boundary_friction, slide_to_roll)
    problem = loaded.contact if loaded else sb.Groups(*map(as_group, AXES, groups or ()))
    parts = model_parts(slide_to_roll, cavitation, cavity_pressure, flow_factors)
    solution = sb.solve(problem, rtol=tolerance, law=law, **parts)
    title = loaded.title if loaded else ""
    for picture in pictures:
        solution.plot(picture, force=force, title=title, notes=not no_notes)
    from stribeck.cli.reports import json as report_json
    from stribeck.cli.reports import state_and_curve as report
    from stribeck.cli.reports.printing import conversions_json, print_conversions

    checks = None
    if loaded:
        from stribeck.checks.table import checks_of_solution

        checks = checks_of_solution(solution, loaded.facts)

    if json:
        print(report_json.dump(report_json.solution_json(solution, mu, b, checks) | conversions_json(loaded)))
        return 0
    console = stdout_console()
    report.print_solution(console, solution, title, mu, b, checks)
    print_conversions(console, loaded)
    for picture in pictures:
        say(console, f"Written: {picture}")
    return 0


def curve_command(
    case: CaseFile = None,
    /,
    *,
    output: Annotated[list[Path] | None, Parameter(name=["--output", "-o"], negative="", show_default=False)] = None,
    plot: File = None,
    no_notes: NoNotes = False,
    over: Word = None,
    range: Pair = None,
    points: Number = None,
    rtol: Number = None,
    groups: Pair = None,
    boundary_friction: BoundaryFriction = None,
    beta: Beta = None,
    law: GroupsLaw = None,
    slide_to_roll: SlideToRoll = None,
    cavitation: CavitationWord = None,
    cavity_pressure: CavityPressure = None,
    flow_factors: FlowFactorsWord = None,
    definition: Word = None,
    time_limit: Number = None,
    json: Flag = False,
    force: Flag = False,
) -> int:
    """Solve a Stribeck curve: friction against speed, load or roughness, with its minimum and regimes.

    Example: stribeck curve examples/pdms_cylinder.toml -o curve.nc -o curve.csv --plot curve.png

    Example: stribeck curve examples/pdms_cylinder.toml --over load --range "5 N/m" "200 N/m" -o load.csv

    Example: stribeck curve --groups 0.1 1e-4 --range 1e-9 10 -o curve.nc

    Ctrl-C, SIGTERM or the end of --time-limit writes the finished points, marked as incomplete, and exits with code 130.
    """
    loaded = read_case(case, groups, boundary_friction, beta, law)
    outputs, pictures = check_outputs(output or [], plot, force)
    arguments = curve_arguments(loaded, over, range, points, rtol, groups, boundary_friction, beta)
    arguments["law"] = law
    arguments |= model_parts(slide_to_roll, cavitation, cavity_pressure, flow_factors)
    arguments |= {} if definition is None else {"definition": definition}
    if loaded is None and (boundary_friction is not None or slide_to_roll is not None):
        _say_unusual(boundary_friction, slide_to_roll)
    title = loaded.title if loaded else ""
    seconds = None if time_limit is None else read_duration(time_limit, "--time-limit")
    with interruptible(sigterm=True, time_limit=seconds) as progress:
        curve = sb.stribeck_curve(on_point=progress, **arguments)
        if curve.outcome is Outcome.ROUNDING:
            raise InputError(_too_small(curve))
        judged = _judged(curve, loaded, bool(pictures), progress)
        progress.writes = True
        verdict = judged.checks.headline if judged.checks is not None and judged.is_whole else ""
        shown = {"title": title, "notes": not no_notes, "band": judged.band, "verdict": verdict}
        written, problems = _write(curve, title, outputs, pictures, force, shown)
    from stribeck.cli.reports import json as report_json
    from stribeck.cli.reports import state_and_curve as report
    from stribeck.cli.reports.printing import conversions_json, print_conversions

    if json:
        content = report_json.curve_json(curve, title, written, judged.checks) | conversions_json(loaded)
        content |= {"uncertainty": judged.errors.to_dict()} if judged.errors is not None else {}
        print(report_json.dump(content))
    else:
        console = stdout_console()
        report.print_curve(console, curve, title, written, judged.checks, judged.errors, verdict)
        print_conversions(console, loaded)
    if problems:
        return complain("\n".join(problems), EXIT_BAD_INPUT)
    stopped = "Stopped by --time-limit" if progress.timed_out else "Interrupted"
    if judged.problem:
        complain(judged.problem, 0)
    if curve.outcome is Outcome.INTERRUPTED:
        kept = (
            f"{' and '.join(written)} contain the points so far, marked as incomplete" if written else "no file was asked for"
        )
        return complain(f"{stopped} after {len(curve)} of {curve.requested} points; {kept}.", EXIT_INTERRUPTED)
    if not curve.outcome.ok:
        return complain(f"{len(curve)} of {curve.requested} points: {curve.outcome.value}", EXIT_FAILED)
    if judged.is_stopped:
        left_out = "a picture has no verdict, and errors of inputs are not propagated"
        return complain(f"{stopped} after the curve was solved; {left_out}.", EXIT_INTERRUPTED)
    return 0


@dataclass(frozen=True)
class _Judged:
    """Whether the model applies to a curve, and what the errors of the inputs leave open in it."""

    checks: Checks | None
    is_whole: bool = False
    errors: sb.Uncertainty | None = None
    band: Band | None = None
    problem: str = ""
    is_stopped: bool = False


def _judged(curve: sb.StribeckCurve, case: sb.Case | None, is_drawn: bool, progress: Progress) -> _Judged:
    """Judge a curve that is solved, for a picture as ``stribeck check`` does; Ctrl-C leaves that out and keeps the curve."""
    from stribeck.checks.table import checks_of_curve

    facts = case.facts if case else None
    plain = _Judged(checks_of_curve(curve, facts))
    if case is None or curve.contact is None or not curve.outcome.ok:
        return plain
    from stribeck.uncertainty.band import friction_band

    found = plain
    try:
        if is_drawn:
            found = replace(found, checks=checks_of_curve(curve, facts, is_whole=True, on_point=progress), is_whole=True)
        if case.errors:
            errors, definition = case.errors, curve.definition
            spread = sb.propagate(curve.contact, errors, definition=definition, transitions=curve.over == "speed")
            found = replace(found, errors=spread)
            if is_drawn:
                ends = curve.values[[0, -1]]
                band = friction_band(curve.contact, errors, ends, definition, curve.over, on_point=progress)
                found = replace(found, band=band)
        if progress.wanted:  # what solves a curve keeps its points when it is stopped
            raise KeyboardInterrupt
    except KeyboardInterrupt:
        return replace(plain, is_stopped=True)
    except (InputError, sb.SolveError) as problem:
        return replace(found, problem=f"The errors of the inputs are not propagated: {problem}")
    return found


def regimes_command(case: CaseFile = None, /, *, json: Flag = False) -> int:
    """Report the lubrication regime of a contact, the distance to its neighbours and the sensitivity of friction.

    Example: stribeck regimes examples/pdms_cylinder.toml
    """
    if case is None:
        raise InputError("CASE is missing; give a case file, as in: stribeck regimes case.toml.")
    from stribeck.cli.reports import json as report_json
    from stribeck.cli.reports.explain import print_explanation, regimes_of
    from stribeck.cli.reports.printing import conversions_json

    loaded = sb.load_case(case)
    with interruptible() as progress:
        found = regimes_of(loaded, progress)
    if json:
        parts = found.solution, found.sensitivities, found.curve, found.margins, loaded.title, found.checks
        content = report_json.regimes_json(*parts)
        content |= {"uncertainty": found.errors.to_dict()} if found.errors is not None else {}
        print(report_json.dump(content | conversions_json(loaded)))
    else:
        print_explanation(stdout_console(), found, loaded)
    return 0 if found.curve.outcome.ok else complain(found.curve.outcome.value, EXIT_FAILED)


def check_command(case: CaseFile = None, /, *, json: Flag = False) -> int:
    """Check whether the model applies to a contact: value, limit and verdict of each condition, with a sentence.

    Example: stribeck check examples/rod_seal.toml

    Facts that only checks use go into the table [check] of the case: pressure_viscosity, layer_thickness, loss_tangent,
    supply_film, thinning_rate, molecular_size, thermal_conductivity, thermal_thinning, density, rms_slope.

    The exit code is 0 whatever the verdict.
    """
    if case is None:
        raise InputError("CASE is missing; give a case file, as in: stribeck check case.toml.")
    from stribeck.checks.subject import Subject
    from stribeck.checks.table import checks_of
    from stribeck.cli.reports import checks as report_checks
    from stribeck.cli.reports import json as report_json

    loaded = sb.load_case(case)
    found = checks_of(Subject(loaded.contact, loaded.facts, loaded.definition))
    if json:
        print(report_json.dump({"title": loaded.title} | found.to_dict() | {"unchecked": list(found.unchecked)}))
    else:
        from stribeck.cli.reports.printing import print_conversions

        console = stdout_console()
        report_checks.print_checks(console, found, loaded.title)
        print_conversions(console, loaded)
    return 0


def figures_command(
    names: Annotated[list[str] | None, Parameter(name="FIGURE", negative="", show_default=False)] = None,
    /,
    *,
    out: Annotated[Path, Parameter(name="--out")] = Path("figures"),
    force: Flag = False,
) -> int:
    """Reproduce the figures of the article from our own solutions: PNG, SVG and NetCDF data for each.

    Example: stribeck figures

    Example: stribeck figures 3 5b S1 --out pictures

    Data already in the folder are reused unless the source code behind them has changed.

    Ctrl-C keeps the finished figures and exits with code 130.
    """
    from stribeck.figures import make_figures

    with interruptible() as progress:
        made = make_figures(
            names or (),
            out,
            force=force,
            on_progress=lambda name, done, steps: progress(done, steps, f"figure {name}"),
        )
    console = stdout_console()
    for each in made:
        if each.files:
            kept = ", kept data" if each.outcome == "reused" else ""
            names_of_files = ", ".join(map(str, each.files))
            say(console, f"Figure {each.name}{kept}: {names_of_files}")
    for each in made:
        if each.outcome in ("failed", "unwritten"):
            complain(each.message, EXIT_FAILED)
    outcomes = {each.outcome for each in made}
    if "interrupted" in outcomes:
        finished = ", ".join(each.name for each in made if each.files)
        kept = f"finished and kept in {out}: {finished}" if finished else "none was finished"
        return complain(f"{made[-1].message.rstrip('.')}; {kept}.", EXIT_INTERRUPTED)
    return EXIT_FAILED if "failed" in outcomes else EXIT_BAD_INPUT if "unwritten" in outcomes else 0


def _write(
    curve: sb.StribeckCurve,
    title: str,
    outputs: Collection[Path],
    pictures: Collection[Path],
    force: bool,
    shown: Mapping[str, Any],
) -> tuple[list[str], list[str]]:
    """Write the files of a curve; return their names, and sentences about those that failed."""
    actions: dict[Path, Callable[[], object]] = {}
    if outputs:
        from stribeck.curves.table import curve_dataset
        from stribeck.files.datasets import write_data

        dataset = curve_dataset(curve, title)
        for path in outputs:
            actions[path] = lambda path=path: write_data(dataset, path, force=force)  # type: ignore[misc]
    for path in pictures:
        from stribeck.plot.curve import plot_curve

        actions[path] = lambda path=path: plot_curve(curve, path, force=force, **shown)  # type: ignore[misc]
    return write_each(actions)


def _say_unusual(boundary_friction: str | None, slide_to_roll: str | None) -> None:
    """Say which numbers given beside groups are hardly meant; those of a case are checked with it."""
    from stribeck.checks.body import check_sizes
    from stribeck.quantities.inputs import LINE

    given = {"boundary_friction": boundary_friction, "slide_to_roll": slide_to_roll}
    numbers = {name: number for name, text in given.items() if (number := as_number(name, text)) is not None}
    found = check_sizes(numbers, LINE)
    if found.verdict != "fine":
        complain(found.sentence, 0)


def _too_small(curve: sb.StribeckCurve) -> str:
    where = f"states whose {curve.over} is below {_si(curve)}" if len(curve) else "these states"
    return (
        f"rtol = {curve.rtol:g} cannot be reached: double precision limits the error of {where} above it; "
        "ask for a larger rtol."
    )


def _si(curve: sb.StribeckCurve) -> str:
    value = float(curve.values[0])
    return f"{value:.3g}" if curve.contact is None else format_si(value, curve.contact.INPUTS.quantities[curve.over].dimension)
