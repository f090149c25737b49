"""One page to hand over, as HTML or PDF: self-contained, without requests to any server."""

from __future__ import annotations

import io
import os
import re
import textwrap
from collections.abc import Callable, Iterator
from importlib.resources import files
from pathlib import Path

from stribeck.cases.case import Case
from stribeck.cases.reading import load_case
from stribeck.data_sheet.content import Content, content_of
from stribeck.files.writing import MissingExtraError, PathLike, atomic_write, check_writable, path_of
from stribeck.fits.measurements import Measurements
from stribeck.plot.curve import draw_report
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.units import InputError, show

__all__ = ["REPORT_ENDINGS", "write_report"]

REPORT_ENDINGS = (".html", ".pdf")

PAGE_INCH = (8.27, 11.69)  # A4
PAGE_COLUMNS = 104  # Letters on a line of the PDF
PAGE_ROWS = 78  # Lines on a page of the PDF


@answers_typos
def write_report(
    case: PathLike | Case,
    path: PathLike,
    data: PathLike | Measurements | None = None,
    *,
    force: bool = False,
    on_step: Callable[[int, int], object] | None = None,
) -> Content:
    """Write one page about a contact: inputs with sources, checks, curve, films, regime, margins and levers.

    Parameters
    ----------
    case : path-like or Case
        The case; sources of the inputs are the comments of its file.
    path : path-like
        The file to write, ending in ``.html`` or ``.pdf``.
    data : path-like or Measurements, optional
        Measured friction, drawn over the curve.
    force : bool
        Whether an existing file is replaced.
    on_step : callable, optional
        ``on_step(done, total)`` is called as the work goes on.

    Returns
    -------
    Content
        What the page says.

    Raises
    ------
    InputError
        If case or data cannot be used, or the file not be written.
    SolveError
        If the contact cannot be solved.
    MissingExtraError
        If matplotlib or jinja2 is not installed.
    """
    target = check_writable(path, REPORT_ENDINGS, force=force)
    _check_libraries(target.suffix.lower())
    if not isinstance(case, Case):
        if not isinstance(case, str | os.PathLike):
            raise InputError(f"case = {show(case)}; it must be the path of a case file or a Case.")
        case = load_case(case)
    given = data if isinstance(data, Measurements) or data is None else path_of(data, "data")
    content = content_of(case, given, on_step)
    with atomic_write(path, REPORT_ENDINGS, force=force) as temporary:
        if target.suffix.lower() == ".pdf":
            _write_pdf(content, temporary)
        else:
            temporary.write_text(page_of(content), encoding="utf-8")
    return content


def page_of(content: Content) -> str:
    """Return the page as HTML, its picture inside."""
    from jinja2 import Environment
    from markupsafe import Markup

    template = files("stribeck.data_sheet").joinpath("page.html").read_text(encoding="utf-8")
    page = Environment(autoescape=True, trim_blocks=True).from_string(template)
    return page.render(c=content, picture=Markup(_svg(content)))  # noqa: S704 - our own drawing


def _svg(content: Content) -> str:
    """Return the picture as SVG for a page, without references to other addresses."""
    import matplotlib as mpl

    stream = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "path", "svg.hashsalt": "stribeck"}):
        draw_report(content.curve, content.data, content.uncertainty).savefig(stream, format="svg", metadata={"Date": None})
    text = stream.getvalue()
    text = re.sub(r"<metadata>.*?</metadata>", "", text[text.index("<svg") :], flags=re.DOTALL)
    return text.replace("<svg ", '<svg role="img" aria-label="Friction and film over the speed" ', 1)


def _write_pdf(content: Content, path: Path) -> None:
    from matplotlib.backends.backend_pdf import PdfPages
    from matplotlib.figure import Figure

    lines = list(_lines(content))
    pages = [lines[i : i + PAGE_ROWS] for i in range(0, len(lines), PAGE_ROWS)]
    with PdfPages(path) as book:
        for page in pages:
            figure = Figure(figsize=PAGE_INCH)
            for i, (text, strong) in enumerate(page):
                weight = "bold" if strong else "normal"
                place = 0.07, 0.955 - i * 0.0117
                figure.text(*place, text, size=7, weight=weight, family="DejaVu Sans Mono", va="top", parse_math=False)
            book.savefig(figure)
        book.savefig(draw_report(content.curve, content.data, content.uncertainty))


def _lines(content: Content) -> Iterator[tuple[str, bool]]:
    """Yield the lines of the PDF, and whether each is a heading."""

    def wrapped(text: str, indent: str = "") -> Iterator[tuple[str, bool]]:
        for line in textwrap.wrap(text, PAGE_COLUMNS, subsequent_indent=indent) or [""]:
            yield line, False

    def heading(text: str) -> Iterator[tuple[str, bool]]:
        yield "", False
        yield text, True

    for line in textwrap.wrap(content.headline, PAGE_COLUMNS):
        yield line, True
    if content.checks.first_line:
        yield from wrapped(content.checks.first_line)
    yield from heading(content.title)
    for each in content.sentences:
        yield from wrapped(each)
    yield from heading("Friction, films and transitions")
    for name, value, interval in content.films:
        yield f"{name:<52}{value:<14}{interval}", False
    yield from heading("Margins to the next regimes")
    for each in content.margins:
        yield from wrapped(each)
    yield from heading("The two cheapest levers: to lower friction by about a fifth")
    for lever in content.levers:
        yield f"{lever.label:<30}{lever.change:<34}friction {lever.friction}", False
    yield from heading("Inputs")
    for given in content.inputs:
        yield from wrapped(f"{given.label:<28}{given.value:<14}{given.error:<9}{given.source}", " " * 51)
    for each in content.conversions:
        yield from wrapped(f"Converted: {each}")
    yield from heading("Does the model apply?")
    for check in content.checks:
        value, limit = check.texts
        yield f"{check.name:<32}{value:<18}fine {limit:<18}{check.verdict}", False
    for check in content.checks.said:
        yield from wrapped(f"{check.word}: {check.sentence}")
    for each in content.checks.unchecked:
        yield from wrapped(f"Not checked: {each}")
    if content.notes:
        yield from heading("Notes")
        for each in content.notes:
            yield from wrapped(each)
    yield "", False
    yield from wrapped(content.versions)


def _check_libraries(ending: str) -> None:
    from importlib.util import find_spec

    for library in ("matplotlib", *(["jinja2"] if ending == ".html" else [])):
        if find_spec(library) is None:
            raise MissingExtraError("a report", "report", library)
