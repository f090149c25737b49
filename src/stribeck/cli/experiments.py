"""Commands for experiments: what to measure next, and which contact law the data prefer."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

import stribeck as sb
from stribeck.cli.arguments import CaseFile, File, Flag, Number, Word, as_whole, bare_or_text, check_pictures, data_and_case
from stribeck.cli.exits import say, stdout_console
from stribeck.cli.progress import interruptible

DataFile = Annotated[Path | None, Parameter(name="DATA", show_default=False)]
Values = Annotated[list[str] | None, Parameter(negative="", consume_multiple=True, show_default=False)]


def next_command(
    data: DataFile = None,
    case: CaseFile = None,
    /,
    *,
    count: Number = None,
    speeds: Values = None,
    loads: Values = None,
    viscosities: Values = None,
    plot: File = None,
    json: Flag = False,
    force: Flag = False,
) -> int:
    """Fit measured friction and report which runs to measure next: those that shrink the intervals most for their cost.

    Example: stribeck next examples/pdms_measured.csv examples/pdms_fit.toml --count 5 --plot next.png

    Example: stribeck next measured.csv case.toml --loads "10 N/m" "100 N/m"
    """
    data, loaded = data_and_case("next", data, case)
    number = 3 if count is None else as_whole("count", count)
    pictures = check_pictures(plot, force)
    given = {"speeds": speeds, "loads": loads, "viscosities": viscosities}
    choices: dict[str, Any] = {
        name: None if texts is None else [bare_or_text(text) for text in texts] for name, texts in given.items()
    }
    with interruptible() as progress:
        found = sb.fit(data, loaded, intervals=False, on_step=lambda what, n: progress(n, n + 1, what))
        plan = sb.next_runs(found, number, **choices, on_step=lambda n, m: progress(n, m, "states"))
    for picture in pictures:
        plan.plot(picture, force=force, title=loaded.title)
    if json:
        from stribeck.cli.reports import json as report_json

        print(report_json.dump(found.checks.to_dict() | plan.to_dict() | {"files": list(map(str, pictures))}))
        return 0
    _print_texts(found.checks.first_line, str(plan), *(f"Written: {picture}" for picture in pictures))
    return 0


def compare_command(data: DataFile = None, case: CaseFile = None, /, *, models: Word = None, json: Flag = False) -> int:
    """Fit measured friction with several contact laws or models and report which the data prefer, and by how much.

    Example: stribeck compare examples/pdms_measured.csv examples/pdms_fit.toml

    Example: stribeck compare measured.csv case.toml --models cavitation
    """
    data, loaded = data_and_case("compare", data, case)
    with interruptible() as progress:
        found = sb.compare(data, loaded, models=models, on_step=lambda what, n: progress(n, n + 1, what))
    if json:
        from stribeck.cli.reports import json as report_json

        print(report_json.dump(found.to_dict()))
        return 0
    _print_texts(found.candidates[0].fit.checks.first_line, str(found))
    return 0


def _print_texts(*texts: str) -> None:
    console = stdout_console()
    for text in filter(None, texts):
        say(console, text)
