"""Commands around the solver: sweeps, measured surfaces, the explorer, new cases, and a page of results to hand over."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

import stribeck as sb
from stribeck.cli.arguments import OUTPUTS, Number, Outputs, Whole
from stribeck.cli.exits import EXIT_FAILED, EXIT_INTERRUPTED, answer, complain, show
from stribeck.cli.measured import ENDING
from stribeck.cli.progress import interruptible
from stribeck.files.writing import atomic_write

if TYPE_CHECKING:
    from stribeck.sweeps.sweep import SweepProgress


def sweep_command(
    sweep: Path,
    /,
    *,
    out: Path,
    workers: Whole = 1,
    scheduler: str | None = None,
    export: Path | None = None,
    json: bool = False,
    force: bool = False,
) -> int:
    """Solve many states and store each as it finishes; after an interruption, run the command again to resume.

    Example: stribeck sweep examples/sweep.toml --out sweep.sqlite --export sweep.nc

    Example: stribeck sweep examples/sweep.toml --out sweep.sqlite --workers 2

    The store is one SQLite file.  --export writes NetCDF (.nc), Zarr (.zarr), CSV (.csv) or Parquet (.parquet).

    With --scheduler, such as --scheduler tcp://node1:8786, the workers of a Dask cluster solve the states.

    After Ctrl-C the finished states are in the store; the exit code is then 130.  It is 1 where states failed; they are in the
    store too, with their outcome.
    """
    from stribeck.files.datasets import check_export, write_data

    plan = sb.load_sweep(sweep)
    if export is not None:
        check_export(export, force=force)
    complain("\n".join(plan.unusual), 0)
    with interruptible(after_point=True, sigterm=True) as progress:

        def report_progress(state: SweepProgress) -> None:
            progress(state.done, state.total, state.text, state.seconds_left)
            progress.writes = state.done == state.total

        found = sb.sweep(plan, out, workers=workers, scheduler=scheduler, on_progress=report_progress)
        written = []
        if export is not None and not found.interrupted:
            write_data(found.to_dataset(), export, force=force)
            written.append(str(export))
    complain(found.note if json else "", 0)
    said = [*filter(None, [plan.title]), str(found)]
    answer(json, lambda: found.to_dict() | {"files": written}, lambda: said, written=written)
    if found.interrupted:
        kept = f"they are stored in {out}; run the same command again to resume"
        return complain(f"Interrupted after {found.finished} of {len(found)} states; {kept}.", EXIT_INTERRUPTED)
    if found.failed:
        return complain(
            f"{found.failed} of {len(found)} states did not converge; each has its outcome in the store.", EXIT_FAILED
        )
    return 0


def surface_command(
    file: Annotated[list[Path], Parameter(consume_multiple=True)],
    /,
    *,
    unit: str | None = None,
    height_unit: str | None = None,
    spacing: str | None = None,
    channel: str | None = None,
    trend: str | None = None,
    window: str | None = None,
    resolution: str | None = None,
    gamma: Number = None,
    keep_spikes: bool = False,
    out: Path | None = None,
    outputs: Outputs = OUTPUTS,
) -> int:
    """Analyse a measured topography: rms height, spectrum, and contact-law alpha and beta, with errors.

    Example: stribeck surface examples/cylinder_profile.csv --plot surface.png --out surface.toml

    Example: stribeck surface place_1.csv place_2.csv place_3.csv --out surface.toml

    Example: stribeck surface scan.xyz --unit um --height-unit nm --resolution "1 um"

    Text files (.csv, .tsv, .txt, .dat, .xyz) are read directly; .x3p, .sur, .opd, .sdf, .plux and some forty other formats
    through SurfaceTopography (pip install 'stribeck[surface]').  Several files are scans of one surface at different places:
    the intervals then count their scatter.
    """
    from stribeck import surfaces

    outputs.check(out)
    choices = {"trend": trend, "window": window, "resolution": resolution, "gamma": gamma}
    arguments: dict[str, Any] = {name: value for name, value in choices.items() if value is not None}
    found = []
    for path in file:
        scan = surfaces.read_topography(path, unit=unit, height_unit=height_unit, spacing=spacing, channel=channel)
        found.append(surfaces.analyse(scan, keep_spikes=keep_spikes, **arguments))
    surface = found[0] if len(found) == 1 else surfaces.combine(found)
    others = {} if out is None else {out: lambda: surfaces.write_surface_table(surface, out, force=outputs.force)}
    return outputs.finish(surface, lambda: [str(surface)], others=others)


def explore_command(
    case: Path | None = None,
    /,
    *,
    port: Whole | None = None,
    host: str | None = None,
    browser: Annotated[bool, Parameter(negative="--no-browser")] = True,
) -> int:
    """Open the interactive explorer: change the inputs, and curve, profiles, regimes and numbers follow.

    Example: stribeck explore examples/pdms_cylinder.toml

    The page is served on this machine only, works offline and sends no data.  It opens only with the token in its
    address.  Ctrl-C ends it.
    """
    from stribeck.explorer.server import serve

    with suppress(KeyboardInterrupt):  # which is how it ends
        serve(case, port, browser, "127.0.0.1" if host is None else host)
    return 0


def new_command(
    file: Path | None = None,
    /,
    *,
    geometry: str = "line",
    seal: str | None = None,
    force: bool = False,
) -> int:
    """Write a commented case file with every key, its unit and usual range, ready to run, or that of a seal.

    Example: stribeck new case.toml

    Example: stribeck new seal.toml --seal o-ring

    Example: stribeck new ball.toml --geometry point

    --geometry is line or point; --seal is o-ring, u-cup or shaft.
    """
    from stribeck.contacts.groups import check_geometry

    text = sb.new_case(check_geometry(geometry), seal)
    if file is None:
        print(text, end="")
        return 0
    with atomic_write(file, (".toml",), force=force) as temporary:
        temporary.write_text(text, encoding="utf-8")
    show([f"Written: {file}", f"Edit the values, then run: stribeck check {file}"])
    return 0


def report_command(
    case: Path,
    data: Path | None = None,
    /,
    *,
    output: Annotated[Path, Parameter(alias="-o")],
    force: bool = False,
) -> int:
    """Write one page to hand over: inputs with sources, checks, curve, films, regime, margins and the cheapest levers.

    Example: stribeck report examples/lip_seal.toml -o lip_seal.html

    Example: stribeck report examples/pdms_fit.toml examples/pdms_measured.csv -o fit.pdf

    Sources of the inputs are the comments of the case file. Where inputs have errors ("1.0 +- 0.2 um"), the page has
    intervals and the probability of each regime.
    """
    if data is not None and data.suffix.lower() == ENDING != case.suffix.lower():  # in the order of a fit
        case, data = data, case
    with interruptible() as progress:
        content = sb.write_report(case, output, data, force=force, on_step=lambda n, m: progress(n, m, "report"))
    show([content.headline, *content.sentences, f"Written: {output}"])
    return 0
