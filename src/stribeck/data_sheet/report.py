"""One page to hand over, as HTML or PDF: self-contained, without requests to any server."""

from __future__ import annotations

import io
import os
import re
import textwrap
from collections.abc import Callable, Iterator, Sequence
from importlib.resources import files
from pathlib import Path

from stribeck.cases.case import Case
from stribeck.cases.reading import load_case
from stribeck.checks.check import VERDICTS
from stribeck.data_sheet.content import Content, content_of
from stribeck.files.writing import PathLike, atomic_write, check_writable, need_extra, path_of
from stribeck.fits.measurements import Measurements
from stribeck.plot.curve import draw_report
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.units import InputError, show

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
    for library in ("matplotlib", *(["jinja2"] if target.suffix.lower() == ".html" else [])):
        need_extra("a report", "report", library)
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
    picture = Markup(_svg(content))  # noqa: S704 - our own drawing
    return page.render(c=content, picture=picture, verdicts=VERDICTS)


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
    for line in textwrap.wrap(content.headline, PAGE_COLUMNS):
        yield line, True
    yield from _wrapped(content.checks.first_line)
    yield from _part(content.title, (), content.sentences)
    for section in content.sections:
        yield from _part(*section)
    yield "", False
    yield from _wrapped(content.versions)


def _part(heading: str, table: Sequence[Sequence[str]], paragraphs: Sequence[str]) -> Iterator[tuple[str, bool]]:
    """Yield the lines of a part of the page; the last column of a table is wrapped."""
    yield "", False
    yield heading, True
    widths = [max(map(len, column)) + 2 for column in [*zip(*table, strict=True)][:-1]]
    for *cells, last in table:
        before = "".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True))
        yield from _wrapped(before + last, " " * sum(widths))
    for each in paragraphs:
        yield from _wrapped(each)


def _wrapped(text: str, indent: str = "") -> Iterator[tuple[str, bool]]:
    for line in textwrap.wrap(text, PAGE_COLUMNS, subsequent_indent=indent):
        yield line, False
