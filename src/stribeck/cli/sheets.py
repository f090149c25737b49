"""Commands for data sheets: a new case to fill in, and a page of results to hand over."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

import stribeck as sb
from stribeck.cli.arguments import CaseFile, File, Flag, Word, need_extra
from stribeck.cli.exits import say, stdout_console
from stribeck.cli.progress import interruptible
from stribeck.files.writing import atomic_write, check_writable
from stribeck.quantities.units import InputError


def new_command(
    output: Annotated[Path | None, Parameter(name="FILE", show_default=False)] = None,
    /,
    *,
    geometry: Word = None,
    force: Flag = False,
) -> int:
    """Write a commented case file with every key, its unit and usual range, ready to run.

    Example: stribeck new case.toml

    Example: stribeck new ball.toml --geometry point
    """
    from stribeck.contacts.geometries import check_geometry

    text = sb.new_case(check_geometry(geometry or "line"))
    if output is None:
        print(text, end="")
        return 0
    with atomic_write(output, (".toml",), force=force) as temporary:
        temporary.write_text(text, encoding="utf-8")
    console = stdout_console()
    say(console, f"Written: {output}")
    say(console, f"Put your values in, then: stribeck check {output}")
    return 0


def report_command(
    case: CaseFile = None,
    data: Annotated[Path | None, Parameter(name="DATA", show_default=False)] = None,
    /,
    *,
    output: Annotated[File, Parameter(name=["--output", "-o"], negative="", show_default=False)] = None,
    force: Flag = False,
) -> int:
    """Write one page to hand over: inputs with sources, checks, curve, films, regime, margins and the cheapest levers.

    Example: stribeck report examples/lip_seal.toml -o lip_seal.html

    Example: stribeck report examples/pdms_fit.toml examples/pdms_measured.csv -o fit.pdf

    Sources of the inputs are the comments of the case file. Where inputs have errors ("1.0 +- 0.2 um"), the page has
    intervals and the probability of each regime.
    """
    from stribeck.data_sheet.report import REPORT_ENDINGS

    if case is None or output is None:
        missing = "CASE" if case is None else "output"
        raise InputError(
            f"{missing} is missing; give a case file and a page, as in: stribeck report case.toml -o report.html."
        )
    check_writable(output, REPORT_ENDINGS, force=force)
    need_extra("a report", "report", "matplotlib")
    with interruptible() as progress:
        content = sb.write_report(case, output, data, force=force, on_step=lambda n, m: progress(n, m, "report"))
    console = stdout_console()
    for line in (content.headline, *content.sentences, f"Written: {output}"):
        say(console, line)
    return 0
