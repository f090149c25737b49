"""Commands around the solver: sweeps, measured surfaces, fits of measured friction, the explorer."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from stribeck.cli.arguments import (
    CaseFile,
    File,
    Flag,
    NoNotes,
    Number,
    Word,
    as_number,
    as_whole,
    check_pictures,
    data_and_case,
    need_extra,
)
from stribeck.cli.exits import EXIT_BAD_INPUT, EXIT_FAILED, EXIT_INTERRUPTED, complain, stdout_console, write_each
from stribeck.cli.progress import interruptible
from stribeck.files.writing import check_writable
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    from stribeck.sweeps.design import SweepDesign
    from stribeck.sweeps.sweep import SweepProgress


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
    """Solve many states and store each as it finishes; after an interruption, run the command again to resume.

    Example: stribeck sweep examples/sweep.toml --out sweep.sqlite --export sweep.nc

    Example: stribeck sweep examples/sweep.toml --out sweep.sqlite --workers 2

    The store is one SQLite file.  --export writes NetCDF (.nc), Zarr (.zarr), CSV (.csv) or Parquet (.parquet).

    With --scheduler, such as --scheduler tcp://node1:8786, the workers of a Dask cluster solve the states.

    After Ctrl-C the finished states are in the store; the exit code is then 130.  It is 1 where states failed; they are in the
    store too, with their outcome.
    """
    from stribeck.cli.reports import sweep as report_sweep
    from stribeck.files.datasets import check_export, write_data
    from stribeck.sweeps.design import load_sweep
    from stribeck.sweeps.sweep import sweep

    if design is None:
        raise InputError("SWEEP is missing; give a sweep file, as in: stribeck sweep sweep.toml --out sweep.sqlite.")
    if out is None:
        raise InputError("out is missing; give the file of the store with --out.")
    if export is not None:
        check_export(export, force=force)
    plan = load_sweep(design)
    _say_unusual(plan)
    processes = 1 if workers is None else as_whole("workers", workers)
    with interruptible(after_point=True, sigterm=True) as progress:
        lines = report_sweep.ProgressLines(sys.stderr if progress.bar is None else None)

        def report_progress(state: SweepProgress) -> None:
            lines(state)
            progress(state.done, state.total, report_sweep.progress_text(state))

        found = sweep(plan, out, workers=processes, scheduler=scheduler, on_progress=report_progress)
    written = []
    if export is not None and not found.interrupted:
        write_data(found.to_dataset(), export, force=force)
        written.append(str(export))
    if found.note:
        complain(found.note, 0)
    if json:
        from stribeck.cli.reports import json as report_json

        print(report_json.dump(report_sweep.sweep_json(found, written)))
    else:
        report_sweep.print_sweep(stdout_console(), found, written)
    if found.interrupted:
        kept = f"they are stored in {out}; run the same command again to resume"
        return complain(f"Interrupted after {found.finished} of {len(found)} states; {kept}.", EXIT_INTERRUPTED)
    if found.failed:
        return complain(
            f"{found.failed} of {len(found)} states did not converge; each has its outcome in the store.", EXIT_FAILED
        )
    return 0


def _say_unusual(plan: SweepDesign) -> None:
    """Say which inputs of a sweep are hardly meant, at the ends of what varies."""
    from stribeck.checks.body import check_sizes
    from stribeck.quantities.inputs import INPUT_TABLES

    table = INPUT_TABLES[plan.physics["geometry"]]
    inputs = {name: values for name, values in plan.inputs.items() if name in table.quantities}
    fixed = {name: float(values[0]) for name, values in inputs.items() if name not in plan.varied}
    if "slide_to_roll" not in inputs:
        fixed["slide_to_roll"] = plan.parts.slide_to_roll
    ends = ({name: float(end(inputs[name])) for name in plan.varied if name in inputs} for end in (min, max))
    for given in (fixed, *ends):
        found = check_sizes(given, table)
        if found.verdict != "fine":
            complain(found.sentence, 0)


def fit_command(
    data: Annotated[Path | None, Parameter(name="DATA", show_default=False)] = None,
    case: CaseFile = None,
    /,
    *,
    free: Annotated[list[str] | None, Parameter(negative="", consume_multiple=True, show_default=False)] = None,
    out: File = None,
    plot: File = None,
    no_notes: NoNotes = False,
    robust: Flag = False,
    posterior: Number = None,
    json: Flag = False,
    force: Flag = False,
) -> int:
    """Fit inputs to measured friction, with confidence intervals and what the data cannot determine.

    Example: stribeck fit examples/pdms_measured.csv examples/pdms_fit.toml --plot fit.png --out fitted.toml

    Example: stribeck fit measured.csv case.toml --free boundary_friction h_rms modulus --robust
    """
    data, loaded = data_and_case("fit", data, case)
    pictures = check_pictures(plot, force)
    if out is not None:
        check_writable(out, (".toml",), force=force)
    steps = None if posterior is None else as_whole("posterior", posterior)
    if steps is not None:
        need_extra("a posterior", "fit", "emcee")
    from stribeck.fits.case_file import check_fitted_case, write_fitted_case
    from stribeck.fits.fit import fit, names_to_fit
    from stribeck.fits.posterior import draw_posterior

    if out is not None:
        check_fitted_case(loaded, names_to_fit(free, loaded.fit), out)
    with interruptible() as progress:
        found = fit(data, loaded, free=free, robust=True if robust else None, on_step=lambda what, n: progress(n, n + 1, what))
        drawn = None if steps is None else draw_posterior(found, steps=steps, on_step=lambda n, m: progress(n, m, "posterior"))
    actions: dict[Path, Callable[[], object]] = {}
    for picture in pictures:
        from stribeck.plot.fit import plot_fit

        actions[picture] = lambda picture=picture: plot_fit(  # type: ignore[misc]
            found, picture, force=force, title=loaded.title, notes=not no_notes
        )
    if out is not None and found.converged:
        actions[out] = lambda: write_fitted_case(found, loaded, out, force=force)
    written, problems = write_each(actions)
    from stribeck.cli.reports import fit as report_fit
    from stribeck.cli.reports import json as report_json

    if json:
        print(report_json.dump(report_fit.fit_json(found, loaded.title, written, drawn)))
    else:
        report_fit.print_fit(stdout_console(), found, loaded.title, written, drawn)
    if problems:
        return complain("\n".join(problems), EXIT_BAD_INPUT)
    if not found.converged:
        return complain(found.outcome.value, EXIT_FAILED)
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
    no_notes: NoNotes = False,
    out: File = None,
    json: Flag = False,
    force: Flag = False,
) -> int:
    """Analyse a measured topography: rms height, spectrum, and contact-law alpha and beta, with errors.

    Example: stribeck surface examples/cylinder_profile.csv --plot surface.png --out surface.toml

    Example: stribeck surface scan.xyz --unit um --height-unit nm --resolution "1 um"

    Text files (.csv, .tsv, .txt, .dat, .xyz) are read directly; .x3p, .sur, .opd, .sdf, .plux and some forty other formats
    through SurfaceTopography (pip install 'stribeck[surface]').
    """
    from stribeck import surfaces
    from stribeck.cli.reports import surface as report_surface

    if file is None:
        raise InputError("FILE is missing; give a file of heights, as in: stribeck surface scan.x3p.")
    pictures = check_pictures(plot, force)
    if out is not None:
        check_writable(out, (".toml",), force=force)
    given = {"trend": trend, "window": window, "resolution": resolution, "gamma": as_number("gamma", gamma)}
    arguments: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    scan = surfaces.read_topography(file, unit=unit, height_unit=height_unit, spacing=spacing, channel=channel)
    surface = surfaces.analyse(scan, keep_spikes=keep_spikes, **arguments)
    for picture in pictures:
        from stribeck.plot.surface import plot_surface

        plot_surface(surface, picture, force=force, notes=not no_notes)
    if out is not None:
        surfaces.write_surface_table(surface, out, force=force)
    written = [str(name) for name in (*pictures, *([out] if out is not None else []))]
    if json:
        from stribeck.cli.reports import json as report_json

        print(report_json.dump({**surface.to_dict(), "files": written}))
    else:
        report_surface.print_surface(stdout_console(), surface, written)
    return 0


def explore_command(
    case: CaseFile = None,
    /,
    *,
    port: Number = None,
    host: Word = None,
    browser: Annotated[bool, Parameter(negative="--no-browser", show_default=False)] = True,
) -> int:
    """Open the interactive explorer: change the inputs, and curve, profiles, regimes and numbers follow.

    Example: stribeck explore examples/pdms_cylinder.toml

    The page is served on this machine only, works offline and sends no data.  It opens only with the token in its
    address.  Ctrl-C ends it.
    """
    from stribeck.explorer.server import serve

    number = None if port is None else as_whole("port", port)
    with suppress(KeyboardInterrupt):  # which is how it ends
        serve(case, number, browser, "127.0.0.1" if host is None else host)
    return 0
