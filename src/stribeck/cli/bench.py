"""The command ``stribeck bench``: raw files of a rig in, a Stribeck curve with errors out."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

import stribeck as sb
from stribeck.cli.arguments import OUTPUTS, Outputs, Quantity, Verbose
from stribeck.cli.exits import EXIT_BAD_INPUT, answer, complain
from stribeck.cli.progress import interruptible
from stribeck.files.writing import check_writable

SHORT_NOTES = 8  # Notes that are printed without -v, so that the answer fits a screen


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
    written, problems = outputs.write(
        found, others={} if out is None else {out: partial(found.to_csv, out, force=outputs.force)}
    )

    def lines() -> list[str]:
        from stribeck.quantities.results import table_lines

        card = found._card()
        notes = card.notes if verbose or len(card.notes) <= SHORT_NOTES else card.notes[-SHORT_NOTES:]
        more = [] if len(notes) == len(card.notes) else [f"-v shows {len(card.notes) - len(notes)} more notes."]
        taken = [f"Read: {each}." for each in dict.fromkeys(found.taken)] if verbose else []
        return [card.headline, *table_lines(card.table, card.right), *(f"Note: {note}" for note in notes), *more, *taken]

    def content() -> dict[str, Any]:
        return found.to_dict() | {"written": written}

    answer(outputs.json, content, lines, written=written)
    return complain("\n".join(problems), EXIT_BAD_INPUT if problems else 0)
