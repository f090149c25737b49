"""The one style of all figures: panels with letters, colours for the steps of a parameter, and a foot that says whose numbers.

matplotlib is imported on first use, and pyplot never, so that no display is needed and no setting of the caller changes.
"""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stribeck.plot.style import CONTACT, FLUID, GREY, INK, MARK, TINTS, Axes, Figure, blank_figure, house_style

if TYPE_CHECKING:
    from xarray import DataArray as DataArray
    from xarray import Dataset as Dataset
else:  # Annotations that the modules of the figures import
    DataArray = Dataset = Any

# Names of other modules that the modules of the figures take from here.
__all__ = ["CONTACT", "FLUID", "GREY", "INK", "MARK", "TINTS", "Axes", "DataArray", "Dataset", "Figure", "house_style"]

Panels = dict[str, Axes]

CYAN = "#56b4e9"
GREEN = "#009e73"  # The fourth of the strong colours of Okabe and Ito, beside CONTACT, FLUID and MARK.

DASHED: Any = (0, (5, 2.5))  # Dashes of lines that formulas give; states of the solver are full lines or dots.
DOTTED: Any = (0, (1.2, 1.6))  # Dots of lines that formulas give.

# How the files of the figures name them
COLOURS = {"ink": INK, "grey": GREY, "fluid": FLUID, "contact": CONTACT, "mark": MARK, "green": GREEN, "cyan": CYAN}
DASHES: dict[Any, Any] = {"dashed": DASHED, "dotted": DOTTED}

FOOT_LINE_HEIGHT = 0.17  # Height of a line of the foot [inch].

LETTERS_PER_INCH = 17.0  # Letters of the foot that fit into an inch.


def new_figure(data: Dataset, width: float, height: float) -> Figure:
    """Return an empty figure with the title, and a foot of claim, finding and source of the data."""
    foot = _foot(data, int(LETTERS_PER_INCH * (width - 0.3)))
    head, low = 0.45, FOOT_LINE_HEIGHT * len(foot) + 0.22
    whole = height + head + low
    figure = blank_figure(width, whole, layout="constrained")
    engine: Any = figure.get_layout_engine()
    engine.set(rect=(0.005, low / whole, 0.99, height / whole), w_pad=0.06, h_pad=0.06, wspace=0.03, hspace=0.04)
    headline = f"Figure {data.attrs['figure']}: {data.attrs['title']}"
    figure.text(0.15 / width, 1 - 0.13 / whole, headline, size=13, weight="bold", color=INK, va="top", parse_math=False)
    for i, (text, colour) in enumerate(reversed(foot)):
        figure.text(
            0.15 / width, (0.1 + FOOT_LINE_HEIGHT * i) / whole, text, size=8, color=colour, va="bottom", parse_math=False
        )
    return figure


def panels(figure: Figure, grid: Mapping[str, Any]) -> Panels:
    """Return the axes of the panels by name, in the places of :meth:`~matplotlib.figure.Figure.subplot_mosaic`."""
    found: Panels = figure.subplot_mosaic(**grid)
    for axes in found.values():
        house_style(axes)
    return found


def finish(
    axes: Axes,
    name: str,
    data: Dataset,
    *,
    text: str = "",
    steps_of: str = "",
    lines: Mapping[str, Mapping[str, Any]] | None = None,
    unit: str | float = 1.0,
    legend: Mapping[str, Any] | None = None,
    **settings: Any,
) -> None:
    """Draw into a panel what its file names, over a unit or a variable, and give it title, settings of its axes and legend."""
    unit_of: Any = data[unit] if isinstance(unit, str) else unit
    if steps_of:  # The title of the legend says what the steps are
        steps(axes, data[steps_of] / unit_of, named="title" in (legend or {}))
    for variable, look in (lines or {}).items():
        limit(axes, data[variable] / unit_of, **look)
    axes.set(**settings)
    if text:  # Panels that the paper does not have are named by words
        axes.set_title(f"({name if len(name) == 1 else '+'}) {text}", loc="left", size=9.5, color=INK)
    if legend is not None:
        small_legend(axes, **legend)


def small_legend(axes: Axes, **options: Any) -> None:
    """Put a legend inside a panel, small and without frame."""
    small = {"frameon": False, "fontsize": 8, "labelcolor": INK, "handlelength": 2.2, "title_fontsize": 8.5}
    axes.legend(**small | options)


def inset(axes: Axes, bounds: tuple[float, float, float, float], title: str) -> Axes:
    """Return a small panel inside another one."""
    found = axes.inset_axes(bounds)
    house_style(found)
    found.set_title(title, size=8, color=GREY, pad=2)
    found.tick_params(labelsize=7)
    return found


def steps(axes: Axes, rows: DataArray, lw: float = 1.4, by: DataArray | None = None, named: bool = True) -> None:
    """Draw a line for each step of the first dimension over the second, dark to light, labelled by its value."""
    x = rows[rows.dims[1]]
    values = rows[rows.dims[0]] if by is None else by
    for colour, row, value in zip(sequence(len(values)), rows.values, values.values, strict=True):
        axes.plot(x, row, color=colour, lw=lw, label=power(value) if named else None)
    axes.set_xlim(float(x[0]), float(x[-1]))


def limit(axes: Axes, values: DataArray, *, color: str = "ink", ls: Any = "dashed", **look: Any) -> None:
    """Draw what a formula gives in a limit, over its coordinate."""
    look = {"color": COLOURS.get(color, color), "ls": DASHES.get(ls, ls), "lw": 1.2} | look
    axes.plot(values[values.dims[0]], values, **look)


def sequence(count: int) -> list[str]:
    """Return colours for the ascending steps of a parameter, dark to light, which colour-blind readers distinguish."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    viridis = colormaps["viridis"]
    return [to_hex(viridis(0.88 * i / max(1, count - 1))) for i in range(count)]


def power(value: float) -> str:
    r"""Return a number as text for labels, powers of ten as such."""
    if value == 0 or 0.01 < abs(value) < 1000:
        return f"{value:.3g}"
    exponent = math.floor(math.log10(abs(value)) + 1e-9)
    factor = f"{value / 10.0**exponent:.3g}"
    return f"$10^{{{exponent}}}$" if factor == "1" else rf"${factor}\times10^{{{exponent}}}$"


def slope(axes: Axes, x: float, y: float, exponent: float, text: str, decades: float = 1.0) -> None:
    """Draw a triangle that shows the slope of a power law on logarithmic axes."""
    far, high = x * 10**decades, y * 10 ** (decades * exponent)
    axes.plot([x, far, far, x], [y, y, high, y], color=GREY, lw=0.9, zorder=1)
    axes.annotate(
        text, (far, math.sqrt(y * high)), (4, 0), textcoords="offset points", size=8, color=GREY, va="center", zorder=1
    )


def save(figure: Figure, path: Path) -> None:
    """Write a picture; the same data give the same bytes."""
    from matplotlib import rc_context

    # The last digits of a layout differ from one process to the next, and with them the names of clipping paths in an SVG.
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    for axes in figure.axes:
        x, y, width, height = (round(each, 9) for each in axes.get_position().bounds)
        axes.set_position((x, y, width, height))
    metadata: dict[str, Any] = {"Date": None} if path.suffix == ".svg" else {"Software": None}
    with rc_context({"svg.hashsalt": "stribeck"}):
        figure.savefig(path, metadata=metadata)


def _foot(data: Dataset, width: int) -> list[tuple[str, str]]:
    """Return the lines of the foot with their colours."""
    numbers = [f"{name} {data.attrs[key]:.1g}" for name, key in (("rtol", "rtol"), ("estimated error", "error_estimate"))]
    parts: Sequence[tuple[str, str]] = (
        (f"The paper: {data.attrs['claim']}", GREY),
        (f"Found: {data.attrs['finding']}", INK),
        (f"All numbers by {data.attrs['source']}, {', '.join(numbers)}.", GREY),
    )
    return [(line, colour) for text, colour in parts for line in textwrap.wrap(_tidy(text), width)]


def _tidy(text: str) -> str:
    """Return text with shorter powers of ten, and with signs of per cent that stay beside their number."""
    return re.sub(r"e-0(\d)\b", r"e-\1", text).replace(" %", "\N{NO-BREAK SPACE}%")
