"""The one style of all figures: panels with letters, colours for the steps of a parameter, and a foot that says whose numbers.

matplotlib is imported on first use, and pyplot never, so that no display is needed and no setting of the caller changes.
"""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stribeck.plot.style import CONTACT, FLUID, GREY, INK, MARK, TINTS, Axes, Figure, blank_figure

if TYPE_CHECKING:
    from xarray import DataArray as DataArray
    from xarray import Dataset as Dataset
else:  # Annotations that the modules of the figures import
    DataArray = Dataset = Any

# Names of other modules that the modules of the figures take from here.
__all__ = ["CONTACT", "FLUID", "GREY", "INK", "MARK", "TINTS", "Axes", "DataArray", "Dataset", "Figure"]

CYAN = "#56b4e9"
GREEN = "#009e73"  # The fourth of the strong colours of Okabe and Ito, beside CONTACT, FLUID and MARK.

DASHED: Any = (0, (5, 2.5))  # Dashes of lines that formulas give; states of the solver are full lines or dots.
DOTTED: Any = (0, (1.2, 1.6))  # Dots of lines that formulas give.

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


def panels(figure: Figure, rows: int, columns: int, **options: Any) -> list[Axes]:
    """Return the axes of a grid of panels, row by row, each in house style."""
    grid = figure.add_gridspec(rows, columns, **options)
    found = [figure.add_subplot(grid[i, j]) for i in range(rows) for j in range(columns)]
    for axes in found:
        house_style(axes)
    return found


def house_style(axes: Axes) -> None:
    """Give axes the colours and sizes of the house."""
    for side in axes.spines.values():
        side.set(color=GREY, linewidth=0.8)
    axes.tick_params(which="both", direction="in", top=True, right=True, colors=INK, labelsize=8.5)
    axes.xaxis.label.set(color=INK, size=10)
    axes.yaxis.label.set(color=INK, size=10)


def panel(axes: Axes, which: str, text: str, legend: dict[str, Any] | None = None, **settings: Any) -> None:
    """Give a panel its letter, what it shows, the settings of its axes, and a legend."""
    axes.set(**settings)
    axes.set_title(f"({which}) {text}", loc="left", size=9.5, color=INK)
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


def steps(axes: Axes, rows: DataArray, lw: float = 1.4, by: DataArray | None = None) -> None:
    """Draw a line for each step of the first dimension over the second, dark to light, labelled by its value."""
    x = rows[rows.dims[1]]
    values = rows[rows.dims[0]] if by is None else by
    for colour, row, value in zip(sequence(len(values)), rows.values, values.values, strict=True):
        axes.plot(x, row, color=colour, lw=lw, label=power(value))
    axes.set_xlim(float(x[0]), float(x[-1]))


def limit(axes: Axes, values: DataArray, label: str, **look: Any) -> None:
    """Draw what a formula gives in a limit, over its coordinate."""
    axes.plot(values[values.dims[0]], values, **{"color": INK, "lw": 1.2, "ls": DASHED, "label": label} | look)


def lines(axes: Axes, data: Dataset, table: dict[str, tuple[str, str, Any]], **look: Any) -> None:
    """Draw variables of a dataset over their coordinate, each with its label, colour and dashes."""
    for name, (label, colour, dashes) in table.items():
        limit(axes, data[name], **{"color": colour, "ls": dashes, "lw": 1.5, "label": label} | look)


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
    """Write a picture; the same figure gives the same bytes."""
    from matplotlib import rc_context

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
