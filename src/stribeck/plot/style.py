"""The style of all pictures: colours, the empty figure with headline and footer, axes, legend and file.

Figures are made without pyplot, so that they need no display and change no settings of the caller.
"""

from __future__ import annotations

import inspect
import io
import textwrap
from bisect import bisect_left
from collections.abc import Callable, Sequence
from functools import wraps
from importlib.metadata import version
from itertools import accumulate
from typing import TYPE_CHECKING, Any

from stribeck._types import Array
from stribeck.files.writing import MissingExtraError, PathLike, atomic_write
from stribeck.quantities.docstrings import complete_docstring
from stribeck.quantities.formats import format_si
from stribeck.quantities.units import DIMENSIONS, InputError, show

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Axes
    from matplotlib.figure import Figure as Figure
else:  # Annotations that other modules of pictures import
    Axes = Figure = Any

PICTURE_ENDINGS = (".png", ".svg", ".pdf")

# Okabe and Ito's colours, which most colour-blind readers tell apart; dashes differ as well.
INK = "#1f2328"
GREY = "#6e7781"
CONTACT = "#d55e00"
FLUID = "#0072b2"
MARK = "#cc79a7"
SERIES = (INK, CONTACT, FLUID, MARK, "#009e73", "#e69f00")  # Of lines that are alike, in turn
TINTS = {"boundary": "#fbe9dd", "mixed": "#f6f3e3", "hydrodynamic": "#e2eff8"}
DASHED = (0, (5, 3))
CONTACT_LINE: dict[str, Any] = {"color": CONTACT, "ls": (0, (6, 2)), "label": "from asperities"}
FLUID_LINE: dict[str, Any] = {"color": FLUID, "ls": "-.", "label": "from the fluid"}
ROUGHNESS_LINE: dict[str, Any] = {"color": GREY, "lw": 1.0, "ls": DASHED}

FRICTION = r"friction coefficient $\mu$"

CAPTION_LINE_INCH = 0.19
LEGEND_INCH = 0.55
CAPTION_MARGIN_INCH = 0.15  # Free beside a caption

# The arguments that functions share which draw.
ARGUMENTS = {
    "path": "str or path-like, optional\n    Image to write as well, ending in ``.png``, ``.svg`` or ``.pdf``.",
    "ax": "matplotlib.axes.Axes, optional\n    Axes to draw the main panel into, in place of a new figure.",
    "force": "bool\n    Whether an existing file is replaced; otherwise it is kept.",
    "title": "str\n    Headline.",
    "notes": "bool\n    Whether the notes stand below the picture.",
}

RETURNS = "matplotlib.figure.Figure\n    The figure."
RAISES = (
    "InputError\n    If the file cannot be written, or exists and ``force`` is not given{}.\n"
    "MissingExtraError\n    If matplotlib is not installed."
)


def picture(also: str = "") -> Callable[[Callable[..., Figure]], Callable[..., Figure]]:
    """Return a decorator that lets a function which draws a result write the picture, and completes its docstring.

    ``also`` is what else it refuses.
    """

    def decorate(function: Callable[..., Figure]) -> Callable[..., Figure]:
        @wraps(function)
        def draw(result: Any, path: PathLike | None = None, *, force: bool = False, **options: Any) -> Figure:
            figure = function(result, **options)
            if path is not None:
                from matplotlib import rc_context

                with atomic_write(path, PICTURE_ENDINGS, force=force) as temporary:
                    stream = io.BytesIO()  # matplotlib's own errors would hide that of a full disk
                    with rc_context({"pdf.fonttype": 42}):  # journals refuse matplotlib's default, Type 3
                        figure.savefig(stream, format=temporary.suffix[1:].lower())
                    temporary.write_bytes(stream.getvalue())
            return figure

        own, added = inspect.signature(function), inspect.signature(draw, follow_wrapped=False).parameters
        first, *others = own.parameters.values()
        draw.__signature__ = own.replace(parameters=[first, added["path"], *others, added["force"]])  # type: ignore[attr-defined]
        shared = ARGUMENTS | {first.name: f"{first.annotation}\n    What is drawn."}
        draw.__doc__ = complete_docstring(draw, shared, RETURNS, RAISES.format(f", or if {also}" if also else ""))
        return draw

    return decorate


def blank_figure(width: float, height: float, dpi: float = 150, **options: Any) -> Figure:
    """Return a white figure of a size in inches with nothing on it, which can be written without a display."""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("a picture", "plot", "matplotlib") from None
    except ValueError as problem:  # of the environment variable MPLBACKEND, or of a file of settings
        raise InputError(f"matplotlib cannot be loaded ({' '.join(str(problem).split())}).") from None
    figure = Figure(figsize=(width, height), dpi=dpi, facecolor="white", **options)
    FigureCanvasAgg(figure)
    return figure


def new_figure(
    size: tuple[float, float],
    footer: Sequence[Sequence[str]],
    notes: Sequence[str] = (),
    *,
    title: str,
    ax: Axes | None = None,
    columns: int = 1,
    rows: int = 1,
    top: float = 0.6,
    left: float = 0.8,
    right: float = 0.25,
    between: float = 0.2,
) -> tuple[Figure, list[Axes]]:
    """Return an empty figure in house style, with title, caption of :func:`caption_lines` and axes, between margins in inches.

    Of axes that a caller gave it returns their figure, and them alone.
    """
    if ax is not None:
        return figure_of(ax), [ax]
    width, height = size
    figure = blank_figure(width, height)
    caption = caption_lines(figure, footer, notes, width - 0.8 - CAPTION_MARGIN_INCH)
    height += CAPTION_LINE_INCH * len(caption) + LEGEND_INCH
    figure.set_size_inches(width, height)
    low = (CAPTION_LINE_INCH * len(caption) + LEGEND_INCH + 0.72) / height
    high = 1 - top / height
    grid = figure.add_gridspec(
        rows, columns, left=left / width, right=1 - right / width, bottom=low, top=high, wspace=between, hspace=0.08
    )
    axes = [figure.add_subplot(grid[i, j]) for i in range(rows) for j in range(columns)]
    for ax in axes:
        house_style(ax, 10.5)
    headline = textwrap.shorten(title, int(7.3 * width), placeholder=" …")
    place = 0.8 / width, 1 - 0.16 / height
    figure.text(*place, headline, size=14, weight="bold", color=INK, va="top", parse_math=False)
    for i, (line, colour) in enumerate(reversed(caption)):
        place = 0.8 / width, (0.14 + CAPTION_LINE_INCH * i) / height
        figure.text(*place, line, size=8, color=colour, va="bottom", parse_math=colour == GREY)
    return figure, axes


def house_style(axes: Axes, size: float = 10.0) -> None:
    """Give axes the colours of the house, and labels of a size."""
    for side in axes.spines.values():
        side.set(color=GREY, linewidth=0.8)
    axes.tick_params(which="both", direction="in", top=True, right=True, colors=INK, labelsize=size - 1.5)
    for axis in (axes.xaxis, axes.yaxis):
        axis.label.set(color=INK, size=size)


def figure_of(axes: Axes) -> Figure:
    """Return the figure of axes that a caller gave."""
    if not hasattr(axes, "get_figure"):
        raise InputError(f"ax = {show(axes)} is no axes of matplotlib; give one, as of matplotlib.pyplot.subplots().")
    found: Any = axes.get_figure()
    return found  # type: ignore[no-any-return]


def make_logarithmic(axes: Axes, which: str, values: Array) -> None:
    """Make an axis logarithmic, with plain numbers and some between the decades where these are few."""
    from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

    axes.set(**{f"{which}scale": "log"})
    axis = axes.xaxis if which == "x" else axes.yaxis
    positive = values[values > 0]
    if not positive.size or positive.max() > 300 * positive.min():
        return
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter("{x:g}")
    if positive.max() > 5 * positive.min():
        axis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
    else:
        axis.set_major_locator(MaxNLocator(4))
        axis.set_minor_locator(NullLocator())


def readable_unit(dimension: str, largest: float) -> tuple[float, str]:
    """Return the factor from SI to a unit in which the largest value is a readable number, and that unit."""
    unit = format_si(largest, dimension).rpartition(" ")[2]
    return 10.0 ** -next(power for power, known in DIMENSIONS[dimension].steps.items() if known == unit), unit


def with_unit(text: str, unit: str) -> str:
    """Return the label of an axis; numbers have no unit."""
    return text if unit in ("", "1") else f"{text} ({unit})"


def label_rows(axes: Axes, names: Sequence[str]) -> None:
    """Name the rows of a picture of horizontal bars, the first on top."""
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)


def program() -> str:
    """Return name and version of the program, for captions."""
    return f"stribeck {version('stribeck')}"


def add_legend(figure: Figure, axes: Sequence[Axes], columns: int = 4, *, inside: object = False) -> None:
    """Put one legend for all axes under them, in as many columns as the figure is wide for, or into the last of the axes."""
    if inside:
        axes[-1].legend(frameon=False, fontsize=8.5)
        return
    found: dict[str, Any] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    bottom = axes[-1].get_position().y0 - 0.52 / figure.get_figheight()
    for ncols in range(columns, 0, -1):
        legend = figure.legend(
            list(found.values()),
            list(found),
            loc="upper left",
            bbox_to_anchor=(0.7 / figure.get_figwidth(), bottom),
            ncols=ncols,
            frameon=False,
            fontsize=8.5,
            labelcolor=INK,
            handlelength=2.6,
            columnspacing=2.0,
        )
        if legend.get_window_extent().x1 <= figure.bbox.x1 or ncols == 1:
            return
        legend.remove()


def caption_lines(figure: Figure, parts: Sequence[Sequence[str]], notes: Sequence[str], room: float) -> list[tuple[str, str]]:
    """Return the lines below a picture with their colours, broken as they are measured so that each fits into its room."""
    probe = figure.text(0.0, 0.0, "", size=8)

    def fits(line: str) -> bool:
        probe.set_text(line)
        return bool(probe.get_window_extent().width <= room * figure.dpi)

    lines = []
    for part in parts:
        items = [item for item in part if item]
        pieces = [f"{item}," for item in items[:-1]] + items[-1:]
        whole = [word for piece in pieces for word in ([piece] if fits(piece) else piece.split(" "))]
        lines += [(line, GREY) for line in _wrap(whole, fits)]
    probe.set_parse_math(False)
    lines += [(line, INK) for note in notes for line in _wrap(note.split(), fits)]
    probe.remove()
    return lines


def _wrap(words: Sequence[str], fits: Callable[[str], bool]) -> list[str]:
    """Return words as lines that fit; a word longer than a line is cut."""
    lines, rest = [], list(words)
    while rest:
        count = _most([*accumulate(rest, "{} {}".format)], fits)
        if not count:
            cut = max(1, _most([*accumulate(rest[0])][:-1], fits))
            rest[:1], count = filter(None, [rest[0][:cut], rest[0][cut:]]), 1
        lines.append(" ".join(rest[:count]))
        rest = rest[count:]
    return lines


def _most(growing: Sequence[str], fits: Callable[[str], bool]) -> int:
    """Return how many of growing texts fit, by bisection: to measure one takes long."""
    return bisect_left(growing, True, key=lambda text: not fits(text))
