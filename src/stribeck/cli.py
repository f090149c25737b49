"""The command ``stribeck``: arguments in, files and tables out; no physics here.

Exit codes: 0 done, 1 the solve failed, 2 bad input, 130 interrupted (Ctrl-C).
"""

from __future__ import annotations

import importlib.util
import os
import re
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib.metadata import version
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import App, CycloptsError, MissingArgumentError, Parameter, UnusedCliTokensError

from .case import Case, curve_range, load_case
from .curve import Over, StribeckCurve, stribeck_curve
from .distances import transition_distances
from .newton import Outcome
from .output import MissingExtraError, check_output
from .parameters import QUANTITIES, Groups
from .regimes import friction_elasticities
from .solution import coefficients
from .solve import SolveError, solve
from .sweep_store import SweepError
from .units import InputError, format_si, read_number, show

if TYPE_CHECKING:
    from rich.console import Console

    from .sweep import SweepProgress

__all__ = ["main"]

AXES: tuple[Over, ...] = ("speed", "load", "roughness")

FAILED, BAD_INPUT, INTERRUPTED = 1, 2, 130
"""Exit codes besides 0."""

REGIME_POINTS = 41
"""Points of the curve on which ``stribeck regimes`` looks for transitions, which are then located exactly."""

HELP = """Friction and film thickness of lubricated rough line contacts, from a TOML file with units.

Example: stribeck curve examples/pdms_cylinder.toml -o curve.nc --plot curve.png

Exit codes: 0 done, 1 the solve failed, 2 bad input, 130 interrupted."""

CaseFile = Annotated[Path | None, Parameter(name="CASE", show_default=False)]
Word = Annotated[str | None, Parameter(show_default=False)]
Number = Annotated[str | None, Parameter(allow_leading_hyphen=True, show_default=False)]
Flag = Annotated[bool, Parameter(negative="", show_default=False)]
File = Annotated[Path | None, Parameter(show_default=False)]
Pair = Annotated[tuple[str, str] | None, Parameter(allow_leading_hyphen=True, show_default=False, negative="")]
Triple = Annotated[tuple[str, str, str] | None, Parameter(allow_leading_hyphen=True, show_default=False, negative="")]


def main(tokens: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code; errors become sentences on stderr.

    Parameters
    ----------
    tokens : sequence of str, optional
        Arguments; those of the process by default.

    Returns
    -------
    int
        0 done, 1 the solve failed, 2 bad input, 130 interrupted.
    """
    if tokens is None:
        tokens = sys.argv[1:]
        _adapt_process()
    try:
        result = make_app()(
            list(tokens),
            print_error=False,
            exit_on_error=False,
            help_on_error=False,
            result_action="return_value",
        )
        sys.stdout.flush()
        return result if isinstance(result, int) else 0
    except CycloptsError as problem:
        return _complain(f"{_parsing(problem)} See {_command(tokens)} --help.", BAD_INPUT)
    except InputError as problem:
        return _complain(str(problem), BAD_INPUT)
    except SolveError as problem:
        if problem.outcome is Outcome.ROUNDING and problem.solution is not None:
            return _complain(f"rtol = {problem.solution.rtol:g} cannot be reached at {problem}", BAD_INPUT)
        return _complain(str(problem), FAILED)
    except SweepError as problem:
        return _complain(str(problem), FAILED)
    except KeyboardInterrupt:
        return _complain("Interrupted; nothing was written.", INTERRUPTED)
    except BrokenPipeError:  # the reader, such as head, had enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except MemoryError:
        return _complain("The memory of this machine does not suffice; ask for fewer points or a larger rtol.", FAILED)
    except Exception as problem:
        if os.environ.get("STRIBECK_DEBUG"):
            raise
        return _complain(
            f"Something went wrong that should not ({type(problem).__name__}: {_line(problem)}) "
            "Please report it with what STRIBECK_DEBUG=1 in the environment adds.",
            FAILED,
        )


def make_app() -> App:
    """Return the command line as cyclopts sees it."""
    app = App(
        name="stribeck",
        help=HELP,
        version=version("stribeck"),
        help_format="plaintext",
        suppress_keyboard_interrupt=False,
    )
    for command in (
        solve_command,
        curve_command,
        regimes_command,
        figures_command,
        sweep_command,
        surface_command,
        fit_command,
        explore_command,
    ):
        app.command(command, name=command.__name__.removesuffix("_command"))
    app.register_install_completion_command()
    return app


def solve_command(
    case: CaseFile = None,
    /,
    *,
    groups: Triple = None,
    mu0: Number = None,
    beta: Number = None,
    law: Word = None,
    rtol: Number = None,
    plot: File = None,
    json: Flag = False,
    force: Flag = False,
) -> int:
    """Solve one state: films, load shares and friction, each with its error.

    Example: stribeck solve examples/pdms_cylinder.toml --plot profile.png

    Example: stribeck solve --groups 1e-5 0.1 1e-4 --json

    Parameters
    ----------
    case
        Case file (TOML).
    groups
        Groups instead of a case: SPEED LOAD ROUGHNESS.
    mu0
        Dry friction coefficient; only with --groups, 1 if not given.
    beta
        Coefficient of the contact law; only with --groups, 1 if not given.
    law
        Contact law: exponential, greenwood-williamson or greenwood-tripp; only with --groups, exponential if not given.
    rtol
        Largest relative error of the results, 1e-11 to 1e-2; that of the case or 1e-6 if not given.
    plot
        Draw gap and pressure to this file (.png, .svg or .pdf).
    json
        Print JSON: every observable under its name, friction_paper, friction_balanced; with a case SI values.
    force
        Replace an existing file.
    """
    loaded = _case(case, groups, mu0, beta, law)
    tolerance = _rtol(rtol, loaded)
    mu, b = _number("mu0", mu0), _number("beta", beta)
    with _named("friction_coefficient", "mu0", loaded is None):
        coefficients(loaded.contact if loaded else None, mu, b)
    pictures = _pictures(plot, force)
    problem = loaded.contact if loaded else Groups(*map(_group, AXES, groups or ()))
    solution = solve(problem, rtol=tolerance, law=law)
    title = loaded.title if loaded else ""
    for picture in pictures:
        from .plotting import plot_profile

        plot_profile(solution, picture, force=force, title=title)
    from . import report

    if json:
        print(report.dump(report.solution_json(solution, mu, b)))
        return 0
    console = _console()
    report.print_solution(console, solution, title, mu, b)
    for picture in pictures:
        console.print(f"Written: {picture}", markup=False, highlight=False, soft_wrap=True)
    return 0


def curve_command(
    case: CaseFile = None,
    /,
    *,
    output: Annotated[list[Path] | None, Parameter(name=["--output", "-o"], negative="", show_default=False)] = None,
    plot: File = None,
    over: Word = None,
    range: Pair = None,
    points: Number = None,
    rtol: Number = None,
    groups: Pair = None,
    mu0: Number = None,
    beta: Number = None,
    law: Word = None,
    json: Flag = False,
    force: Flag = False,
) -> int:
    """Solve a Stribeck curve: friction along speed, load or roughness, its minimum and its regimes.

    Example: stribeck curve examples/pdms_cylinder.toml -o curve.nc -o curve.csv --plot curve.png

    Example: stribeck curve examples/pdms_cylinder.toml --over load --range "5 N/m" "200 N/m" -o load.csv

    Example: stribeck curve --groups 0.1 1e-4 --range 1e-9 10 -o curve.nc

    After Ctrl-C the finished points are written, marked incomplete; the exit code is then 130.

    Parameters
    ----------
    case
        Case file (TOML); options override its tables [curve] and [solver].
    output
        Write the data to this file (.nc or .csv); may be given several times.
    plot
        Draw the curve to this file (.png, .svg or .pdf).
    over
        What varies: speed, load or roughness; that of the case or speed if not given.
    range
        Lowest and highest value of what varies, with units for a case; for speed found if not given.
    points
        Number of points, 2 to 100000; that of the case or 101 if not given.
    rtol
        Largest relative error of the results, 1e-11 to 1e-2; that of the case or 1e-6 if not given.
    groups
        Groups instead of a case: the two that stay fixed, in the order speed, load, roughness.
    mu0
        Dry friction coefficient; only with --groups, 1 if not given.
    beta
        Coefficient of the contact law; only with --groups, 1 if not given.
    law
        Contact law: exponential, greenwood-williamson or greenwood-tripp; only with --groups, exponential if not given.
    json
        Print the curve as JSON.
    force
        Replace existing files.
    """
    loaded = _case(case, groups, mu0, beta, law)
    outputs, pictures = _outputs(output or [], plot, force)
    arguments = _curve_arguments(loaded, over, range, points, rtol, groups, mu0, beta)
    arguments["law"] = law
    title = loaded.title if loaded else ""
    with _interruptible() as progress, _named("friction_coefficient", "mu0", loaded is None):
        curve = stribeck_curve(on_point=progress, **arguments)
        if curve.outcome is Outcome.ROUNDING:
            raise InputError(_too_small(curve))
        written, problems = _write(curve, title, outputs, pictures, force)
    from . import report

    if json:
        print(report.dump(report.curve_json(curve, title, written)))
    else:
        report.print_curve(_console(), curve, title, written)
    if problems:
        return _complain("\n".join(problems), BAD_INPUT)
    if curve.outcome is Outcome.INTERRUPTED:
        kept = f"{' and '.join(written)} hold the points so far, marked incomplete" if written else "no file was asked for"
        return _complain(f"Interrupted after {len(curve)} of {curve.requested} points; {kept}.", INTERRUPTED)
    if not curve.outcome.ok:
        return _complain(f"{len(curve)} of {curve.requested} points: {curve.outcome.value}", FAILED)
    return 0


def regimes_command(case: CaseFile = None, /, *, json: Flag = False) -> int:
    """Tell the lubrication regime of a contact, how far the next ones are, and what moves its friction.

    Example: stribeck regimes examples/pdms_cylinder.toml

    Parameters
    ----------
    case
        Case file (TOML).
    json
        Print JSON.
    """
    if case is None:
        raise InputError("CASE is missing; give a case file, as in: stribeck regimes case.toml.")
    loaded = load_case(case)
    solution, elasticities = friction_elasticities(loaded.contact, rtol=loaded.rtol, definition=loaded.definition)
    with _interruptible() as progress:
        curve = stribeck_curve(
            loaded.contact,
            points=REGIME_POINTS,
            rtol=loaded.rtol,
            definition=loaded.definition,
            on_point=progress,
        )
        _ = curve.transitions
        if curve.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        distances = transition_distances(loaded.contact, rtol=loaded.rtol, definition=loaded.definition, on_point=progress)
    from . import report

    if json:
        print(report.dump(report.regimes_json(solution, elasticities, curve, distances, loaded.title)))
    else:
        report.print_regimes(_console(), solution, elasticities, curve, distances, loaded.title)
    return 0 if curve.outcome.ok else _complain(curve.outcome.value, FAILED)


def figures_command(
    names: Annotated[list[str] | None, Parameter(name="FIGURE", negative="", show_default=False)] = None,
    /,
    *,
    out: Annotated[Path, Parameter(name="--out")] = Path("figures"),
    force: Flag = False,
) -> int:
    """Make figures of the paper from our own solves: PNG, SVG and the data as NetCDF for each.

    Example: stribeck figures

    Example: stribeck figures 3 5b S1 --out pictures

    Data in the folder are used again as long as the sources that they come from are the same.

    After Ctrl-C the figures that are finished stay; the exit code is then 130.

    Parameters
    ----------
    names
        Figures: 3 to 11 and S1; all of them if none is given.
    out
        Folder to write to; made if the folder above it exists.
    force
        Solve again what the folder already holds, and replace files that are not of this command.
    """
    from .figures import make_figures

    with _interruptible() as progress:
        made = make_figures(
            names or (),
            out,
            force=force,
            on_progress=lambda name, done, steps: progress(done, steps, f"figure {name}"),
        )
    console = _console()
    for each in made:
        if each.files:
            kept = ", kept data" if each.outcome == "reused" else ""
            names_of_files = ", ".join(map(str, each.files))
            console.print(f"Figure {each.name}{kept}: {names_of_files}", markup=False, highlight=False, soft_wrap=True)
    for each in made:
        if each.outcome in ("failed", "unwritten"):
            _complain(each.message, FAILED)
    outcomes = {each.outcome for each in made}
    if "interrupted" in outcomes:
        finished = ", ".join(each.name for each in made if each.files)
        kept = f"finished and kept in {out}: {finished}" if finished else "none was finished"
        return _complain(f"{made[-1].message.rstrip('.')}; {kept}.", INTERRUPTED)
    return FAILED if "failed" in outcomes else BAD_INPUT if "unwritten" in outcomes else 0


def sweep_command(
    design: Annotated[Path | None, Parameter(name="SWEEP", show_default=False)] = None,
    /,
    *,
    out: File = None,
    workers: Number = None,
    scheduler: Word = None,
    export: File = None,
    json: Flag = False,
    force: Flag = False,
) -> int:
    """Solve many states and keep each in a store as it finishes; the same command again goes on where it stopped.

    Example: stribeck sweep examples/sweep.toml --out sweep.zarr --export sweep.nc

    Example: stribeck sweep examples/sweep.toml --out sweep.zarr --workers 2

    With --scheduler, as in --scheduler tcp://node1:8786, the workers of a Dask cluster solve the states.

    After Ctrl-C the finished states are in the store; the exit code is then 130.  It is 1 where states failed; they are in the
    store too, with their outcome.

    Parameters
    ----------
    design
        Sweep file (TOML): what stays fixed, what varies and how.
    out
        Folder of the store; made if there is none.
    workers
        Processes of this machine, 1 if not given.
    scheduler
        Address of a Dask scheduler, whose workers solve the states instead.
    export
        Write all states to this file (.nc) at the end.
    json
        Print JSON.
    force
        Replace an existing file of --export; a store is never replaced.
    """
    from . import report_sweep
    from .store import NETCDF
    from .sweep import sweep
    from .sweep_design import load_sweep

    if design is None:
        raise InputError("SWEEP is missing; give a sweep file, as in: stribeck sweep sweep.toml --out sweep.zarr.")
    if out is None:
        raise InputError("out is missing; give the folder of the store with --out.")
    if export is not None:
        check_output(export, NETCDF, force=force)
        _need("a NetCDF file", "data", "netCDF4")
    plan = load_sweep(design)
    processes = 1 if workers is None else _whole("workers", workers)
    with _interruptible(sigterm=True) as progress:
        lines = report_sweep.ProgressLines(sys.stderr if progress.bar is None else None)

        def tell(state: SweepProgress) -> None:
            lines(state)
            progress(state.done, state.total, report_sweep.progress_text(state))

        found = sweep(plan, out, workers=processes, scheduler=scheduler, on_progress=tell)
    written = []
    if export is not None and not found.interrupted:
        found.to_netcdf(export, force=force)
        written.append(str(export))
    if found.note:
        _complain(found.note, 0)
    if json:
        from . import report

        print(report.dump(report_sweep.sweep_json(found, written)))
    else:
        report_sweep.print_sweep(_console(), found, written)
    if found.interrupted:
        kept = f"{out} holds them, and the same command goes on from there"
        return _complain(f"Interrupted after {found.finished} of {len(found)} states; {kept}.", INTERRUPTED)
    if found.failed:
        return _complain(f"{found.failed} of {len(found)} states did not converge; each has its outcome in the store.", FAILED)
    return 0


def fit_command(
    data: Annotated[Path | None, Parameter(name="DATA", show_default=False)] = None,
    case: CaseFile = None,
    /,
    *,
    free: Annotated[list[str] | None, Parameter(negative="", consume_multiple=True, show_default=False)] = None,
    out: File = None,
    plot: File = None,
    robust: Flag = False,
    posterior: Number = None,
    json: Flag = False,
    force: Flag = False,
) -> int:
    """Fit inputs of a contact to measured friction: values with intervals, and what the data do not say.

    Example: stribeck fit examples/pdms_measured.csv examples/pdms_fit.toml --plot fit.png --out fitted.toml

    Example: stribeck fit measured.csv case.toml --free mu0 h_rms modulus --robust

    Parameters
    ----------
    data
        Measured friction (text in columns): friction and speed, viscosity times speed or Hersey number, units in the header.
    case
        Case file (TOML) with the contact where the fit begins, and in its table [fit] what is asked.
    free
        Inputs to fit; those of the case, else friction_coefficient and roughness.
    out
        Write the case with the fitted values to this file (.toml).
    plot
        Draw data, fit and residuals to this file (.png, .svg or .pdf).
    robust
        Keep outliers from steering the fit.
    posterior
        Draw from the posterior with so many steps of emcee, such as 2000.
    json
        Print JSON.
    force
        Replace existing files.
    """
    if data is None or case is None:
        missing, example = ("DATA", "measured.csv case.toml") if data is None else ("CASE", f"{data} case.toml")
        raise InputError(f"{missing} is missing; give measured friction and a case file, as in: stribeck fit {example}.")
    loaded = load_case(case)
    pictures = _pictures(plot, force)
    if out is not None:
        check_output(out, (".toml",), force=force)
    steps = None if posterior is None else _whole("posterior", posterior)
    if steps is not None:
        _need("a posterior", "fit", "emcee")
    from .fit import fit
    from .fit_posterior import draw_posterior

    with _interruptible() as progress:
        found = fit(data, loaded, free=free, robust=True if robust else None, on_step=lambda what, n: progress(n, n + 1, what))
        drawn = None if steps is None else draw_posterior(found, steps=steps, on_step=lambda n, m: progress(n, m, "posterior"))
    written = []
    for picture in pictures:
        from .plot_fit import plot_fit

        plot_fit(found, picture, force=force, title=loaded.title)
        written.append(str(picture))
    if out is not None and found.converged:
        from .fit_file import write_fitted_case

        write_fitted_case(found, loaded, out, force=force)
        written.append(str(out))
    from . import report, report_fit

    if json:
        print(report.dump(report_fit.fit_json(found, loaded.title, written, drawn)))
    else:
        report_fit.print_fit(_console(), found, loaded.title, written, drawn)
    if not found.converged:
        return _complain(found.outcome.value, FAILED)
    return 0


def surface_command(
    file: Annotated[Path | None, Parameter(name="FILE", show_default=False)] = None,
    /,
    *,
    unit: Word = None,
    height_unit: Word = None,
    spacing: Word = None,
    channel: Word = None,
    trend: Word = None,
    window: Word = None,
    resolution: Word = None,
    gamma: Number = None,
    keep_spikes: Flag = False,
    plot: File = None,
    out: File = None,
    json: Flag = False,
    force: Flag = False,
) -> int:
    """Evaluate a measured topography: rms height, spectrum, alpha and beta of the contact law, with errors.

    Example: stribeck surface examples/cylinder_profile.csv --plot surface.png --out surface.toml

    Example: stribeck surface scan.xyz --unit um --height-unit nm --resolution "1 um"

    Text files (.csv, .tsv, .txt, .dat, .xyz) are read directly; .x3p, .sur, .opd, .sdf, .plux and some forty other formats
    through SurfaceTopography (pip install 'stribeck[surface]').

    Parameters
    ----------
    file
        File of heights: a line or a map.
    unit
        Unit of lengths where the file does not declare it, such as um.
    height_unit
        Unit of heights, where it is another one.
    spacing
        Distance between points, such as '0.5 um', where the file has no positions.
    channel
        Name of the channel, where the file has several.
    trend
        Shape of the body to take away: none, mean, tilt or curvature; curvature if not given.
    window
        Window of the spectrum: hann, or none for periodic heights; hann if not given.
    resolution
        Shortest wavelength that the instrument resolves; that of the file or four points if not given.
    gamma
        Reduction of the elastic energy in Persson's theory, 0 to 1; 0.45 if not given.
    keep_spikes
        Keep points far off all their neighbours; otherwise they count as dead.
    plot
        Draw heights, spectrum and contact law to this file (.png, .svg or .pdf).
    out
        Write the table [surface] of a case file to this file (.toml).
    json
        Print JSON in SI units.
    force
        Replace existing files.
    """
    from . import report_surface, surfaces

    if file is None:
        raise InputError("FILE is missing; give a file of heights, as in: stribeck surface scan.x3p.")
    pictures = _pictures(plot, force)
    if out is not None:
        check_output(out, (".toml",), force=force)
    given = {"trend": trend, "window": window, "resolution": resolution, "gamma": _number("gamma", gamma)}
    arguments: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    scan = surfaces.read_topography(file, unit=unit, height_unit=height_unit, spacing=spacing, channel=channel)
    surface = surfaces.analyse(scan, keep_spikes=keep_spikes, **arguments)
    for picture in pictures:
        from .plot_surface import plot_surface

        plot_surface(surface, picture, force=force)
    if out is not None:
        surfaces.write_surface_table(surface, out, force=force)
    written = [str(name) for name in (*pictures, *([out] if out is not None else []))]
    if json:
        from . import report

        print(report.dump({**surface.to_dict(), "files": written}))
    else:
        report_surface.print_surface(_console(), surface, written)
    return 0


def explore_command(
    case: CaseFile = None,
    /,
    *,
    port: Number = None,
    browser: Annotated[bool, Parameter(negative="--no-browser", show_default=False)] = True,
) -> int:
    """Open a page on which the contact is changed by hand and curve, profile, regimes and numbers follow.

    Example: stribeck explore examples/pdms_cylinder.toml

    The page is served on this machine only, needs no internet and sends nothing away.  Ctrl-C ends it.

    Parameters
    ----------
    case
        Case file (TOML) to begin with; a soft cylinder if not given.
    port
        Port of the page; a free one if not given.
    browser
        Open the page in the browser, or only tell its address.
    """
    from .app.server import serve

    number = None if port is None else _whole("port", port)
    with suppress(KeyboardInterrupt):  # which is how it ends
        serve(case, number, browser)
    return 0


# --- arguments ---


def _case(path: Path | None, groups: Sequence[str] | None, mu0: str | None, beta: str | None, law: str | None) -> Case | None:
    """Return the case, or None where groups are given instead."""
    if path is not None and groups is not None:
        if re.fullmatch(r"[-+0-9.eE]+", str(path)):
            raise InputError(f"--groups has more than {len(groups)} numbers: {' '.join(groups)} {path}; see --help.")
        raise InputError(f"{path} and --groups are both given; give a case file or groups.")
    if path is None and groups is None:
        raise InputError("CASE is missing; give a case file, or groups with --groups.")
    if path is None:
        return None
    for name, key, value in (("--mu0", "friction_coefficient", mu0), ("--beta", "beta", beta), ("--law", "law", law)):
        if value is not None:
            raise InputError(f"{name} = {value} goes with --groups only; in {path} it is the key {key}.")
    return load_case(path)


def _number(name: str, text: str | None) -> float | None:
    return None if text is None else read_number(name, text)


def _group(name: str, text: str) -> float:
    value = _number(name, text)
    assert value is not None
    return value


def _whole(name: str, text: str) -> int:
    if not re.fullmatch(r"[+-]?[0-9]{1,18}", text.strip()):
        raise InputError(f"{name} = {show(text)} is not a whole number; write it as 101.")
    return int(text)


def _rtol(text: str | None, case: Case | None) -> float:
    given = _number("rtol", text)
    return given if given is not None else case.rtol if case else Case.rtol


def _curve_arguments(
    case: Case | None,
    over: str | None,
    ends: tuple[str, str] | None,
    points: str | None,
    rtol: str | None,
    groups: tuple[str, str] | None,
    mu0: str | None,
    beta: str | None,
) -> dict[str, Any]:
    """Return the arguments of :func:`stribeck_curve` that a command line asks for."""
    from .case import CurveSettings

    settings = case.curve if case else CurveSettings()
    varied: Over = settings.over if over is None else _axis(over)
    found: dict[str, Any] = {
        "points": settings.points if points is None else _whole("points", points),
        "rtol": _rtol(rtol, case),
    }
    if case is not None:
        found |= {"problem": case.contact, "definition": case.definition}
        span = settings.range if varied == settings.over else None
        if ends is not None:
            span = curve_range([_bare_or_text(end) for end in ends], varied)
    else:
        fixed = [name for name in AXES if name != varied]
        found |= {name: _group(name, text) for name, text in zip(fixed, groups or (), strict=True)}
        found |= {"mu0": _number("mu0", mu0), "beta": _number("beta", beta)}
        span = None
        if ends is not None:
            low, high = (_group(varied, text) for text in ends)
            span = low, high
    if span is not None:
        found[varied] = span
    elif varied != "speed":
        raise InputError(f"range is missing; a curve over {varied} needs --range with the lowest and highest {varied}.")
    return found


def _axis(text: str) -> Over:
    for axis in AXES:
        if text == axis:
            return axis
    raise InputError(f"over = {show(text)} must be 'speed', 'load' or 'roughness'.")


def _bare_or_text(text: str) -> float | str:
    """Return a bare number, which is in SI units, as number; what has a unit as it is."""
    try:
        return float(text)
    except ValueError:
        return text


def _outputs(data: Sequence[Path], plot: Path | None, force: bool) -> tuple[list[Path], list[Path]]:
    """Return the files to write, after a look at whether that will be possible."""
    from .store import DATA, NETCDF

    for path in data:
        check_output(path, DATA, force=force)
    if data:
        _need("a data file", "data", "xarray")
    if any(path.suffix.lower() in NETCDF for path in data):
        _need("a NetCDF file", "data", "netCDF4")
    pictures = _pictures(plot, force)
    targets = [path.resolve() for path in (*data, *pictures)]
    for path, target in zip((*data, *pictures), targets, strict=True):
        if targets.count(target) > 1:
            raise InputError(f"{path} is named twice among the outputs; give each its own name.")
    return list(data), pictures


def _pictures(plot: Path | None, force: bool) -> list[Path]:
    from .plotting import PICTURES

    if plot is None:
        return []
    check_output(plot, PICTURES, force=force)
    _need("a picture", "plot", "matplotlib")
    return [plot]


def _need(purpose: str, extra: str, library: str) -> None:
    if importlib.util.find_spec(library) is None:
        raise MissingExtraError(purpose, extra, library)


# --- results ---


def _write(
    curve: StribeckCurve, title: str, outputs: Collection[Path], pictures: Collection[Path], force: bool
) -> tuple[list[str], list[str]]:
    """Write the files of a curve; return their names, and sentences about those that failed."""
    written, problems = [], []

    def attempt(path: Path, action: Callable[[], object]) -> None:
        try:
            action()
        except InputError as problem:
            problems.append(str(problem))
        else:
            written.append(str(path))

    if outputs:
        from .store import curve_dataset, write_data

        dataset = curve_dataset(curve, title)
        for path in outputs:
            attempt(path, lambda path=path: write_data(dataset, path, force=force))  # type: ignore[misc]
    for path in pictures:
        from .plotting import plot_curve

        attempt(path, lambda path=path: plot_curve(curve, path, force=force, title=title))  # type: ignore[misc]
    return written, problems


def _too_small(curve: StribeckCurve) -> str:
    where = f"the states of which the {curve.over} is below {_si(curve)}" if len(curve) else "these states"
    return (
        f"rtol = {curve.rtol:g} cannot be reached: double precision bounds the error of {where} above it; "
        "ask for a larger rtol."
    )


def _si(curve: StribeckCurve) -> str:
    value = float(curve.values[0])
    return f"{value:.3g}" if curve.contact is None else format_si(value, QUANTITIES[curve.over].dimension)


def _console() -> Console:
    from rich.console import Console

    return Console(file=sys.stdout)


@contextmanager
def _named(key: str, option: str, wanted: bool) -> Iterator[None]:
    """Let sentences about a key of case files speak of the option that took its place."""
    try:
        yield
    except InputError as problem:
        if not wanted or type(problem) is not InputError:
            raise
        raise InputError(str(problem).replace(key, option)) from None


class _Progress:
    """A bar on stderr where this is a terminal, and the place where Ctrl-C takes effect.

    Ctrl-C is a wish to stop after the present point: then nothing that was finished can be lost. Before the
    first point, and when it comes a second time, it takes effect at once.
    """

    def __init__(self) -> None:
        self.started = self.wanted = False
        self.bar: Any = None
        self.task: Any = None

    def __call__(self, done: int, total: int, what: str = "solving") -> None:
        """Take note of a finished point."""
        self.started = True
        if self.bar is not None:
            self.bar.update(self.task, completed=done, total=total, description=what)
        if self.wanted and done < total:
            raise KeyboardInterrupt

    def interrupt(self, number: int, frame: FrameType | None) -> None:
        """Handle Ctrl-C."""
        again, self.wanted = self.wanted, True
        if again or not self.started:
            raise KeyboardInterrupt


@contextmanager
def _interruptible(sigterm: bool = False) -> Iterator[_Progress]:
    """Show progress and let Ctrl-C stop the work between two points, and SIGTERM too where that is wanted."""
    progress = _Progress()
    main = threading.current_thread() is threading.main_thread()
    # A shell makes background jobs ignore Ctrl-C; that stays so.
    handles = main and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if handles:
        signal.signal(signal.SIGINT, progress.interrupt)
    before = signal.signal(signal.SIGTERM, progress.interrupt) if sigterm and main else None
    try:
        with _bar(progress):
            yield progress
    except SolveError:
        # Also a path that was lost because it was interrupted.
        if progress.wanted:
            raise KeyboardInterrupt from None
        raise
    finally:
        if handles:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        if before is not None:
            signal.signal(signal.SIGTERM, before)


@contextmanager
def _bar(progress: _Progress) -> Iterator[None]:
    if not sys.stderr.isatty():
        yield
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        progress.bar, progress.task = bar, bar.add_task("starting", total=None)
        yield


# --- errors ---


def _complain(text: str, code: int) -> int:
    for line in text.splitlines():
        print(f"stribeck: {line}", file=sys.stderr)
    return code


def _parsing(problem: CycloptsError) -> str:
    """Return the sentence for arguments that do not fit together."""
    if isinstance(problem, UnusedCliTokensError) and problem.unused_tokens:
        return f"{problem.unused_tokens[0]!r} is one argument too many."
    if isinstance(problem, MissingArgumentError) and problem.argument is not None:
        count = problem.argument.token_count()[0]
        wanted = f"{count} values" if count > 1 else "a value"
        name = getattr(problem, "keyword", None) or problem.argument.name
        return f"{name} needs {wanted}, {len(problem.tokens_so_far)} given."
    return _line(problem)


def _line(problem: BaseException) -> str:
    text = " ".join(str(problem).split())
    return text if not text or text.endswith((".", "?", "!")) else f"{text}."


def _command(tokens: Sequence[str]) -> str:
    known = ("solve", "curve", "regimes", "figures", "sweep", "surface", "fit", "explore")
    return " ".join(["stribeck", *(token for token in tokens[:1] if token in known)])


def _adapt_process() -> None:
    """Set what belongs to a process of our own: letters that any terminal takes, warnings only on demand."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")
    if not sys.warnoptions and not os.environ.get("STRIBECK_DEBUG"):
        warnings.simplefilter("ignore")
