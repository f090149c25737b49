"""Commands that solve: one state, a curve, the regimes of a contact, the figures of the article."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

import stribeck as sb
from stribeck.cli.arguments import (
    GROUP_OPTIONS,
    MODEL_OPTIONS,
    OUTPUTS,
    GroupOptions,
    ModelOptions,
    Number,
    Outputs,
    Pair,
    Quantity,
    Triple,
    Verbose,
    Whole,
    as_group,
    as_rtol,
    check_duration,
    curve_arguments,
    read_case,
)
from stribeck.cli.exits import EXIT_BAD_INPUT, EXIT_FAILED, EXIT_INTERRUPTED, answer, complain, show
from stribeck.cli.progress import interruptible
from stribeck.quantities.outcome import Outcome
from stribeck.quantities.outputs import GROUPS
from stribeck.quantities.units import InputError


def solve_command(
    case: Path | None = None,
    /,
    *,
    groups: Triple = None,
    beside: GroupOptions = GROUP_OPTIONS,
    model: ModelOptions = MODEL_OPTIONS,
    rtol: Number = None,
    verbose: Verbose = False,
    outputs: Outputs = OUTPUTS,
) -> int:
    """Solve one state: film thickness, load shares and friction, each with its error.

    Example: stribeck solve examples/pdms_cylinder.toml --plot profile.png

    Example: stribeck solve --groups 1e-5 0.1 1e-4 --json

    Example: stribeck solve examples/pdms_cylinder.toml --cavitation exit --slide-to-roll 0.5
    """
    loaded = read_case(case, groups, beside, model)
    tolerance = as_rtol(rtol, loaded)
    mu, b = beside.boundary_friction, beside.beta
    if mu is not None or b is not None:
        from stribeck.contacts.friction import coefficients

        coefficients(None, mu, b)
    outputs.check()
    problem = loaded.contact if loaded else sb.Groups(*map(as_group, GROUPS, groups or ()))
    solution = sb.solve(problem, rtol=tolerance, law=beside.law, **model.parts())
    written, problems = outputs.write(solution, loaded.title if loaded else "")
    from stribeck.checks.table import checks_of_solution
    from stribeck.cli import reports

    checks = checks_of_solution(solution, loaded.facts, loaded.definition) if loaded else None
    said = solution, loaded, mu, b, checks, verbose

    def content() -> dict[str, Any]:
        own: dict[str, Any] = {"definition": loaded.definition} if loaded else {}
        return {**solution.to_dict(mu, b, **own), **own}

    answer(outputs.json, content, lambda: reports.solution_lines(*said), checks, loaded, written)
    return complain("\n".join(problems), EXIT_BAD_INPUT if problems else 0)


def curve_command(
    case: Path | None = None,
    /,
    *,
    output: Annotated[list[Path] | None, Parameter(alias="-o")] = None,
    over: str | None = None,
    range: Pair = None,
    points: Whole | None = None,
    rtol: Number = None,
    groups: Pair = None,
    beside: GroupOptions = GROUP_OPTIONS,
    model: ModelOptions = MODEL_OPTIONS,
    definition: str | None = None,
    time_limit: Quantity = None,
    verbose: Verbose = False,
    outputs: Outputs = OUTPUTS,
) -> int:
    """Solve a Stribeck curve: friction against speed, load or roughness, with its minimum and regimes.

    Example: stribeck curve examples/pdms_cylinder.toml -o curve.nc -o curve.csv --plot curve.png

    Example: stribeck curve examples/pdms_cylinder.toml --over load --range "5 N/m" "200 N/m" -o load.csv

    Example: stribeck curve --groups 0.1 1e-4 --range 1e-9 10 -o curve.nc

    Ctrl-C, SIGTERM or the end of --time-limit writes the finished points, marked as incomplete, and exits with code 130.
    """
    loaded = read_case(case, groups, beside, model)
    outputs.check(data=output or [])
    arguments = curve_arguments(loaded, over, range, points, rtol, groups, beside)
    arguments |= {"law": beside.law} | model.parts()
    arguments |= {} if definition is None else {"definition": definition}
    title = loaded.title if loaded else ""
    seconds = check_duration(time_limit, "--time-limit")
    with interruptible(sigterm=True, time_limit=seconds) as progress:
        curve = sb.stribeck_curve(on_point=progress, **arguments)
        if curve.outcome is Outcome.ROUNDING:
            raise InputError(_too_small(curve))
        from stribeck.regimes.overview import first_verdict, whole_verdict

        verdict = first_verdict(curve, loaded)
        with suppress(KeyboardInterrupt):  # which keeps the curve
            whole = whole_verdict(curve, loaded, is_drawn=outputs.plot is not None, on_point=progress)
            verdict = verdict if progress.wanted else whole  # what solves a curve ends silently when it is stopped
        is_stopped = progress.wanted and loaded is not None
        progress.writes = True
        written, problems = outputs.write(curve, title, output or [], **verdict.drawn)
    from stribeck.cli import reports

    def content() -> dict[str, Any]:
        errors = {} if verdict.errors is None else {"uncertainty": verdict.errors.to_dict()}
        return {"title": title} | curve.to_dict() | {"files": written} | errors

    said = curve, loaded, verdict, verbose
    answer(outputs.json, content, lambda: reports.curve_lines(*said), verdict.checks, loaded, written)
    if problems:
        return complain("\n".join(problems), EXIT_BAD_INPUT)
    stopped = "Stopped by --time-limit" if progress.timed_out else "Interrupted"
    complain(verdict.problem, 0)
    if curve.outcome is Outcome.INTERRUPTED:
        kept = f"{' and '.join(written)} contain the points so far, marked as incomplete"
        kept = kept if written else "no file was asked for"
        return complain(f"{stopped} after {len(curve)} of {curve.requested} points; {kept}.", EXIT_INTERRUPTED)
    if not curve.outcome.ok:
        return complain(f"{len(curve)} of {curve.requested} points: {curve.outcome.value}", EXIT_FAILED)
    if is_stopped:
        left_out = "a picture has no verdict, and errors of inputs are not propagated"
        return complain(f"{stopped} after the curve was solved; {left_out}.", EXIT_INTERRUPTED)
    return 0


def regimes_command(case: Path, /, *, verbose: Verbose = False, json: bool = False) -> int:
    """Report the lubrication regime of a contact, the distance to its neighbours and the sensitivity of friction.

    Example: stribeck regimes examples/pdms_cylinder.toml
    """
    from stribeck.cli import reports
    from stribeck.regimes import overview

    loaded = sb.load_case(case)
    with interruptible() as progress:
        found = overview.overview_of(loaded, progress)
    lines = reports.regimes_lines if verbose else reports.regimes_answer
    answer(json, lambda: {"title": loaded.title} | found.to_dict(), lambda: lines(found), found.checks, loaded)
    return 0 if found.curve.outcome.ok else complain(found.curve.outcome.value, EXIT_FAILED)


def check_command(case: Path, /, *, json: bool = False) -> int:
    """Check whether the model applies to a contact: value, limit and verdict of each condition, with a sentence.

    Example: stribeck check examples/rod_seal.toml

    Facts that only checks use go into the table [check] of the case: stribeck new writes a case with all of them.

    A table [stroke] gives the stroke, unless [check] does.

    The exit code is 0 whatever the verdict.
    """
    from stribeck.checks.subject import Subject
    from stribeck.checks.table import checks_of
    from stribeck.cli import reports

    loaded = sb.load_case(case)
    with interruptible() as progress:
        found = checks_of(Subject(loaded.contact, loaded.facts, loaded.definition, on_point=progress))
    headline, *lines = str(found).splitlines()
    said = [headline, *filter(None, [loaded.title]), *lines, *reports.conversion_lines(loaded)]
    answer(json, lambda: {"title": loaded.title, "unchecked": list(found.unchecked)}, lambda: said, found, loaded)
    return 0


def figures_command(
    figure: list[str] | None = None,
    /,
    *,
    out: Path = Path("figures"),
    force: bool = False,
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
            figure or (),
            out,
            force=force,
            on_progress=lambda name, done, steps: progress(done, steps, f"figure {name}"),
        )
    for each in made:
        if each.files:
            kept = ", kept data" if each.outcome == "reused" else ""
            show([f"Figure {each.name}{kept}: {', '.join(map(str, each.files))}"])
    for each in made:
        if each.outcome in ("failed", "unwritten"):
            complain(each.message, EXIT_FAILED)
    outcomes = {each.outcome for each in made}
    if "interrupted" in outcomes:
        finished = ", ".join(each.name for each in made if each.files)
        kept = f"finished and kept in {out}: {finished}" if finished else "none was finished"
        return complain(f"{made[-1].message.rstrip('.')}; {kept}.", EXIT_INTERRUPTED)
    return EXIT_FAILED if "failed" in outcomes else EXIT_BAD_INPUT if "unwritten" in outcomes else 0


def _too_small(curve: sb.results.StribeckCurve) -> str:
    from stribeck.cli import reports

    where = f"states whose {curve.over} is below {reports.place(curve, curve.values[0])}" if len(curve) else "these states"
    return (
        f"rtol = {curve.rtol:g} cannot be reached: double precision limits the error of {where} above it; "
        "ask for a larger rtol."
    )
