"""One page to hand over, as HTML or PDF: its content, solved here, and the page, which makes no request to any server."""

import io
import os
import re
import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from datetime import date
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

from stribeck.cases.case import Case
from stribeck.cases.reading import load_case
from stribeck.checks.check import VERDICTS, Checks
from stribeck.contacts.contact import Contact, model_words
from stribeck.contacts.parts import PART_INPUTS
from stribeck.curves.result import StribeckCurve
from stribeck.files.writing import PathLike, atomic_write, check_writable, need_extra, path_of
from stribeck.fits.measurements import Measurements, read_measurements, reading_of
from stribeck.plot.curve import draw_report
from stribeck.quantities.formats import format_percent, format_si
from stribeck.quantities.keywords import answers_typos
from stribeck.quantities.units import InputError, show
from stribeck.regimes.advice import MAX_FACTOR, cheapest_levers, regime_sentence, ways_to
from stribeck.regimes.overview import Overview, overview_of
from stribeck.solver.numbers import main_rows
from stribeck.uncertainty.result import Uncertainty

# What a report says of its certainty if no input has an error.
NO_ERRORS_TEXT = (
    'With errors of the inputs, as in roughness = "1.0 +- 0.2 um", this page has intervals and the probability of each regime.'
)

NO_LEVERS_TEXT = f"No single input lowers friction by a fifth within a factor of {MAX_FACTOR:g}."


class Section(NamedTuple):
    """A part of the page: a heading, a table whose first row names its columns, and paragraphs below."""

    heading: str
    table: Sequence[Sequence[str]] = ()
    paragraphs: Sequence[str] = ()


@dataclass(frozen=True)
class Content:
    """Content of a report."""

    title: str
    headline: str  # Whether the model applies
    checks: Checks
    sentences: tuple[str, ...]  # Regime, friction and load share
    sections: tuple[Section, ...]  # The parts of the page below its picture
    versions: str  # Program and libraries
    curve: StribeckCurve  # Friction over the speed
    uncertainty: Uncertainty | None  # The propagated errors of the inputs
    data: Measurements | None = None  # Measured friction


def content_of(
    case: Case, data: str | Path | Measurements | None = None, on_step: Callable[[int, int], object] | None = None
) -> Content:
    """Solve the content of a report."""
    measured = read_measurements(data, case.fit) if isinstance(data, str | Path) else data
    found = overview_of(case, on_step, is_whole=True)
    checks, errors, friction = found.checks, found.errors, found.friction
    assert checks is not None
    certainty = [NO_ERRORS_TEXT] if errors is None else [errors.probability_sentence, *errors.sources]
    return Content(
        title=case.title or case.path.name,
        headline=checks.headline,
        checks=checks,
        sentences=(regime_sentence(found.solution, friction), *certainty),
        sections=tuple(each for each in _sections(case, found, checks, measured) if each.table or each.paragraphs),
        versions=_versions(case),
        curve=found.curve,
        uncertainty=errors,
        data=measured,
    )


def _sections(case: Case, found: Overview, checks: Checks, data: Measurements | None) -> Iterator[Section]:
    """Yield the parts of the page, those too that have nothing to say."""
    yield Section("Friction, films and transitions", list(_films(found)))
    yield Section("Margins to the next regimes", (), [*ways_to(found.margins)] or ["There is no other regime in reach."])
    levers = cheapest_levers(case.contact, found.friction.total, found.sensitivities, case.definition, case.rtol)
    head = "To lower friction by about a fifth", "Change", "Friction solved there"
    rows = [(lever.label, *lever.texts) for lever in levers]
    yield Section("The two cheapest levers", [head, *rows] if rows else (), () if rows else [NO_LEVERS_TEXT])
    yield Section("Inputs", list(_inputs(case)), [f"Converted: {each}" for each in case.conversions])
    verdicts = [("Check", "Value", "Fine", "Verdict"), *((each.name, *each.texts, each.verdict) for each in checks)]
    said = [f"{each.word}: {each.sentence}" for each in checks.said]
    yield Section("Does the model apply?", verdicts, said + [f"Not checked: {each}" for each in checks.unchecked])
    if data:
        drawn = f"{len(data)} rows of {data.path or 'measured friction'}, drawn as read."
        yield Section("Data", (), [drawn, *filter(None, [reading_of(data)]), *_other_inputs(case.contact, data), *data.notes])
    yield Section("Notes", (), [note for note in dict.fromkeys(found.notes) if not checks.covers(note, doubts=True)])


def _other_inputs(contact: Contact, data: Measurements) -> Iterator[str]:
    """Yield what measured curves have in another way than the contact, beside whose curve they are drawn."""
    for curve, inputs in zip(data.curves, data.inputs, strict=True):
        said = [
            f"{row.label} {format_si(inputs[name], row.dimension, 4)} instead of {format_si(own, row.dimension, 4)}"
            for name, row in contact.INPUTS.kept.items()
            if (own := getattr(contact, name)) is not None and inputs.get(name, own) != own
        ]
        if said:
            yield f"{curve}: measured with {' and '.join(said)}, which the drawn curve has."


def _inputs(case: Case) -> Iterator[tuple[str, str, str, str]]:
    """Yield label, value, error and source of each input, as stated in the file."""
    yield "Input", "Value", "Error", "Source, from the case file"
    sources, table, given = _sources(case.path), case.contact.INPUTS, case.tables.get("contact", {})
    for name, value in case.contact.inputs():
        row, error = table.kept[name], case.errors.get(name)
        own = (name, "h_rms") if name == "roughness" else (name,)
        others = (each for each, of in table.stands_for.items() if of == name and each in given)
        # What is said of a mean speed is not said of the sum.
        said = {each: "" for each in own} | {each: f"{each} = {given[each]}: " for each in others}
        source = " ".join(begin + sources[each] for each, begin in said.items() if each in sources)
        shown = "" if error is None else f"± {format_percent(error)}"
        yield row.label, format_si(value, row.dimension, 4), shown, source
    model = model_words(case.contact.groups, case.contact)
    uncertain = (
        f"{row.label} ± {format_percent(case.errors[name])}" for name, row in PART_INPUTS.items() if name in case.errors
    )
    if model:
        yield "model", model, ", ".join(uncertain), ""


def _sources(path: Path) -> dict[str, str]:
    """Return the comments of a case file on its contact and surface, those above each key and behind it on its line."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except OSError:
        return {}
    found: dict[str, str] = {}
    above: list[str] = []
    table = ""
    for line in lines:
        if line.lstrip().startswith("#"):
            above.append(line.strip().lstrip("# "))
            continue
        if header := re.match(r"\s*\[\s*([\w.]+)", line):
            table = header[1]
        key = re.match(r"\s*(\w+)\s*=(?:\"[^\"]*\"|[^#\"])*(?:#\s*(.*))?$", line)
        if key and table in ("contact", "surface"):  # others have keys of these names, such as a stroke
            found.setdefault(key[1], " ".join([*above, key[2] or ""]).strip())
        above = []
    return {name: text for name, text in found.items() if text}


def _films(found: Overview) -> Iterator[tuple[str, ...]]:
    """Yield friction, films and transitions, with 95 % intervals where inputs have errors."""
    if found.errors is not None:
        yield "Quantity", "Value", "95 %"
        yield from ((each.label, *each.texts) for each in found.errors.spreads)
        return
    yield "Quantity", "Value"
    yield from ((each.label, each.texts[0]) for each in main_rows(found.solution, definition=found.curve.definition))
    yield from ((str(mark.name), format_si(mark.value, "speed")) for mark in found.curve.transitions)


def _versions(case: Case) -> str:
    libraries = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy"))
    law = "exponential" if case.contact.law is None else case.contact.law.name
    return (
        f"stribeck {version('stribeck')}, {libraries}; contact law: {law}; friction: {case.definition}; "
        f"relative tolerance {case.rtol:g}; {case.path.name}; {date.today().isoformat()}."
    )


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
            temporary.write_bytes(_pdf(content))
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


def _pdf(content: Content) -> bytes:
    """Return the pages as PDF, which matplotlib writes with errors of its own on a full disk."""
    from matplotlib.backends.backend_pdf import PdfPages
    from matplotlib.figure import Figure

    lines = list(_lines(content))
    pages = [lines[i : i + PAGE_ROWS] for i in range(0, len(lines), PAGE_ROWS)]
    stream = io.BytesIO()
    with PdfPages(stream) as book:
        for page in pages:
            figure = Figure(figsize=PAGE_INCH)
            for i, (text, strong) in enumerate(page):
                weight = "bold" if strong else "normal"
                place = 0.07, 0.955 - i * 0.0117
                figure.text(*place, text, size=7, weight=weight, family="DejaVu Sans Mono", va="top", parse_math=False)
            book.savefig(figure)
        book.savefig(draw_report(content.curve, content.data, content.uncertainty))
    return stream.getvalue()


def _lines(content: Content) -> Iterator[tuple[str, bool]]:
    """Yield the lines of the PDF, and whether each is a heading."""
    yield from _wrapped(content.headline, strong=True)
    yield from _wrapped(content.checks.first_line)
    yield from _part(content.title, (), content.sentences)
    for section in content.sections:
        yield from _part(*section)
    yield "", False
    yield from _wrapped(content.versions)


def _part(heading: str, table: Sequence[Sequence[str]], paragraphs: Sequence[str]) -> Iterator[tuple[str, bool]]:
    """Yield the lines of a part of the page; the last column of a table is wrapped."""
    yield "", False
    yield from _wrapped(heading, strong=True)
    widths = [max(map(len, column)) + 2 for column in [*zip(*table, strict=True)][:-1]]
    for *cells, last in table:
        before = "".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True))
        yield from _wrapped(before + last, " " * sum(widths))
    for each in paragraphs:
        yield from _wrapped(each)


def _wrapped(text: str, indent: str = "", strong: bool = False) -> Iterator[tuple[str, bool]]:
    for line in textwrap.wrap(text, PAGE_COLUMNS, subsequent_indent=indent):
        yield line, strong
