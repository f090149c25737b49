"""Pictures of the errors of formulas: maps over speed and roughness, and lines if only one of them matters."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck._types import Array
from stribeck.asymptotics.formula import Formula
from stribeck.contacts.groups import Groups
from stribeck.figures.style import DASHED, house_style, power, save, sequence
from stribeck.files.writing import PathLike, atomic_write
from stribeck.plot.style import CONTACT, GREY, INK, PICTURE_ENDINGS, TINTS, blank_figure
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_error_maps"]

PANELS_PER_ROW = 3  # Panels beside one another.

PANEL_SIZE = (3.15, 2.15)  # Width and height of a panel [inch].
WIDE_PANEL_WIDTH = 3.8  # Width of a panel where there are fewer than three [inch].
TITLE_HEIGHT = 0.42  # Height of the title [inch].
LEGEND_HEIGHT = 0.32  # Height of the legend [inch].
SCALE_HEIGHT = 0.75  # Height of the legend with a scale of colours [inch].

ERROR_SCALE = (1e-4, 1.0)  # Errors between which colours differ.

CONTOURS = {0.01: "white", 0.1: INK}  # Errors of the contour lines, and their colours, each seen on the colours around it.

MIN_ERROR = 1e-7  # Smallest error with a colour of its own: the tolerance of the solved states.

MAX_ERROR = 1e6  # Largest error with a colour of its own.

EMPTY_COLOUR, HATCH_COLOUR = "#f4f4f4", "#b8bec5"

RANGE_POINTS = 241  # Points along each side of a panel at which the range of a formula is looked up.

SYMBOLS = {
    "load": r"load $\bar F_N$",
    "relative_roughness": r"relative roughness $\kappa$",
    "speed": r"speed $\lambda$",
}


def plot_error_maps(
    maps: Sequence[tuple[Formula[Any], xarray.Dataset]],
    path: PathLike | None = None,
    *,
    force: bool = False,
    title: str = "",
) -> Figure:
    """Draw the errors of formulas, each in a panel of its own or, where it depends on speed and roughness, one for each load.

    In a map the colour is the magnitude of the error, with lines at 1 % (white) and 10 % (dark), the range of the formula is
    framed, and hatching fills what has no value. As a line the error is drawn bold in the range, which is shaded, and thin
    outside it; the stated worst error is dashed.

    Parameters
    ----------
    maps : sequence of (Formula, xarray.Dataset)
        Formulas, and what :func:`evidence.error_maps.error_map` returned for them.  More than three loads make a map
        of what does not depend on the speed.
    path : str or path-like, optional
        Image to write as well, ending in ``.png``, ``.svg`` or ``.pdf``.
    force : bool
        Whether an existing file is replaced; otherwise it is kept.
    title : str
        Headline.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.

    Raises
    ------
    InputError
        If the file cannot be written, or exists and ``force`` is not given, or if there is nothing to draw.
    MissingExtraError
        If matplotlib is not installed.

    Notes
    -----
    Errors of either sign are drawn alike.  As they pass through zero, contours follow the median of nine neighbouring states.
    """
    over_speed = [[(f, data.isel(load=i)) for i in range(data.sizes["load"])] for f, data in maps if len(_long(data)) == 2]
    over_load = [
        (f, data) for f, data in maps if _long(data) == ["relative_roughness"] and data.sizes["load"] > PANELS_PER_ROW
    ]
    lines = [(f, data) for f, data in maps if len(_long(data)) == 1 and all(data is not other for _, other in over_load)]
    rows = [part for panels in [*over_speed, over_load, lines] for part in _in_rows(panels)]
    if not rows:
        raise InputError("there is nothing to draw; give maps of more than one speed or roughness.")
    mapped = bool(over_speed or over_load)
    figure, axes = _new_figure(len(rows), max(map(len, rows)), title, mapped)
    image = None
    for i, (row, panels) in enumerate(zip(rows, axes, strict=True)):
        last = i + 1 == len(rows) or _two(rows[i + 1][0][1]) != _two(row[0][1])
        for j, (panel, ax) in enumerate(zip_longest(row, panels)):
            if panel is None:
                ax.remove()
                continue
            house_style(ax)
            if len(_two(panel[1])) == 2:
                image = _draw_map(ax, *panel, left=j == 0, bottom=last)
            else:
                _draw_lines(ax, *panel, left=j == 0)
    _explain(figure, image, lines)
    if path is not None:
        with atomic_write(path, PICTURE_ENDINGS, force=force) as temporary:
            save(figure, temporary)
    return figure


def _long(data: xarray.Dataset) -> list[str]:
    """Return the axes beside the load that have more than one point."""
    return [str(name) for name in data["error"].dims if name != "load" and data.sizes[name] > 1]


def _two(data: xarray.Dataset) -> list[str]:
    """Return the two axes of a map, or the one of lines."""
    names = [str(name) for name in data["error"].dims if data.sizes[name] > 1]
    return names if "load" not in names or data.sizes["load"] > PANELS_PER_ROW else _long(data)


def _in_rows(panels: Sequence[Any]) -> list[list[Any]]:
    columns = 2 if len(panels) == 4 else PANELS_PER_ROW
    return [list(panels[i : i + columns]) for i in range(0, len(panels), columns)]


def _new_figure(rows: int, columns: int, title: str, mapped: bool) -> tuple[Figure, list[list[Axes]]]:
    """Return an empty figure with headline, and its panels."""
    low = SCALE_HEIGHT if mapped else LEGEND_HEIGHT
    # Narrower pictures have no room for the legend.
    panel, height = PANEL_SIZE[0] if columns == PANELS_PER_ROW else WIDE_PANEL_WIDTH, PANEL_SIZE[1] * rows + TITLE_HEIGHT + low
    width = panel * max(columns, 2) + 0.3
    figure = blank_figure(width, height, dpi=100, layout="constrained")
    engine: Any = figure.get_layout_engine()
    engine.set(
        rect=(0.005, low / height, 0.99, 1 - (TITLE_HEIGHT + low) / height), w_pad=0.05, h_pad=0.05, wspace=0.02, hspace=0.03
    )
    figure.text(0.12 / width, 1 - 0.12 / height, title, size=13, weight="bold", color=INK, va="top", parse_math=False)
    return figure, [list(row) for row in figure.subplots(rows, columns, squeeze=False)]


def _fine(values: Array) -> Array:
    """Return points between the ends of an axis, evenly in the logarithm, without the ends themselves."""
    low, high = np.log(values[0]), np.log(values[-1])
    return np.asarray(np.exp(low + (high - low) * (np.arange(RANGE_POINTS) + 0.5) / RANGE_POINTS))


def _states(name: str, x: Array, kappa: Any, load: float) -> Groups:
    """Return states along ``x``, which is the speed, the load or the relative roughness."""
    if name == "speed":
        return Groups(x, load, load * kappa)
    return Groups(1.0, x, x * kappa) if name == "load" else Groups(1.0, load, load * x)


def _edges(values: Array) -> Array:
    """Return the edges of cells around points of a logarithmic axis."""
    logs = np.log(values)
    inner = 0.5 * (logs[1:] + logs[:-1])
    return np.asarray(np.exp(np.concatenate([[2 * logs[0] - inner[0]], inner, [2 * logs[-1] - inner[-1]]])))


def _draw_map(axes: Axes, formula: Formula[Any], data: xarray.Dataset, *, left: bool, bottom: bool) -> Any:
    """Draw one map, with labels where it stands at the left or at the bottom; return the artist of the colour scale."""
    from matplotlib.colors import LogNorm
    from scipy.ndimage import median_filter

    name = "speed" if "speed" in data["error"].dims else "load"
    data = data.isel({name: np.flatnonzero(data[name].values > 0)})
    x, y, load = data[name].values, data["relative_roughness"].values, float(data["load"].values.ravel()[0])
    error = np.ma.masked_invalid(np.abs(data["error"].transpose("relative_roughness", name).values))
    axes.patch.set(facecolor=EMPTY_COLOUR, edgecolor=HATCH_COLOUR, hatch="////", linewidth=0)
    axes.set(xscale="log", yscale="log")
    error = np.ma.clip(error, MIN_ERROR, MAX_ERROR)
    edges = [_edges(values) for values in (x, y)]
    image = axes.pcolormesh(*edges, error, cmap="cividis", norm=LogNorm(*ERROR_SCALE))
    smooth = np.ma.array(median_filter(error.filled(MAX_ERROR), 3, mode="nearest"), mask=error.mask)
    for level, colour in CONTOURS.items():
        if smooth.count() and smooth.min() < level < smooth.max():
            logs = np.log(smooth / level)
            axes.contour(x, y, logs, [0.0], colors=colour, linewidths=1.0, linestyles="solid")
    ends = [(values[0], values[-1]) for values in edges]
    axes.set(xlim=ends[0], ylim=ends[1])
    fine_x, fine_y = (_fine(np.asarray(pair)) for pair in ends)
    inside = np.broadcast_to(formula.valid(_states(name, fine_x, fine_y[:, None], load)), (RANGE_POINTS, RANGE_POINTS))
    frame = [np.concatenate([pair[:1], fine, pair[1:]]) for pair, fine in zip(ends, (fine_x, fine_y), strict=True)]
    # Coefficients of the friction may lie outside the range although the groups do not.
    if inside.any() and data["valid"].values.any():
        for colour, width in (("white", 3.2), (CONTACT, 1.8)):
            axes.contour(*frame, np.pad(inside.astype(float), 1), [0.5], colors=colour, linewidths=width)
    if name == "speed":
        title = f"{data.attrs['title'] if left else ''}\nload {load:g}"
    else:
        title = f"{data.attrs['title']}\nagainst {data.attrs['predicts']}"
    axes.set_title(title, loc="left", size=9, color=INK)
    _decades(axes.xaxis, ends[0])
    _decades(axes.yaxis, ends[1])
    axes.tick_params(labelbottom=bottom, labelleft=left, color=GREY)
    if bottom:
        axes.set_xlabel(SYMBOLS[name])
    if left:
        axes.set_ylabel(SYMBOLS["relative_roughness"])
    return image


def _draw_lines(axes: Axes, formula: Formula[Any], data: xarray.Dataset, *, left: bool) -> None:
    """Draw the error over the one axis that it depends on, a line for each load."""
    [name] = _long(data)
    data = data.isel({name: np.flatnonzero(data[name].values > 0)})
    x = data[name].values
    loads = data["load"].values.ravel().tolist() if "load" in data.coords else [1.0]
    shown = data.transpose(..., name)
    error, inside = (shown[key].values.reshape(-1, len(x)) for key in ("error", "valid"))
    size = np.clip(np.abs(error), MIN_ERROR, None)
    colours = sequence(len(loads)) if len(loads) > 1 else [INK]
    fine = _fine(x)
    valid = np.zeros(RANGE_POINTS, dtype=bool)
    for load, colour, values, flags in zip(loads, colours, size, inside, strict=True):
        valid |= np.broadcast_to(formula.valid(_states(name, fine, 0.0, load)), RANGE_POINTS)
        axes.plot(x, values, color=colour, lw=0.9, alpha=0.75)
        axes.plot(x, np.where(flags, values, np.nan), color=colour, lw=2.0)
    axes.set(xscale="log", yscale="log", xlim=(x[0], x[-1]))
    valid &= inside.any()
    where = valid.tolist()
    across = axes.get_xaxis_transform()
    axes.fill_between(fine, 0, 1, where=where, transform=across, color=TINTS["hydrodynamic"], lw=0, zorder=0)
    axes.plot(fine, np.where(valid, formula.worst, np.nan), color=GREY, lw=1.2, ls=DASHED)
    known = size[np.isfinite(size)]
    low, high = (known.min(), known.max()) if known.size else (MIN_ERROR, 1.0)
    axes.set_ylim(low / 2, 2 * min(max(high, formula.worst), 10.0))
    axes.set_title(data.attrs["title"], loc="left", size=9, color=INK)
    _decades(axes.xaxis, (x[0], x[-1]))
    axes.yaxis.set_major_formatter(_percent)
    axes.minorticks_off()
    axes.set_xlabel(SYMBOLS[name])
    if left:
        axes.set_ylabel("magnitude of the error")


def _percent(value: float, _: object = None) -> str:
    """Return an error as text in per cent."""
    return f"{100 * value:.10g} %" if value >= 0.99e-6 else f"{power(100 * value)} %"


def _decades(axis: Any, ends: Sequence[float]) -> None:
    """Label every second or third decade of a logarithmic axis."""
    from matplotlib.ticker import FixedLocator, NullLocator

    low, high = math.ceil(math.log10(ends[0]) - 1e-9), math.floor(math.log10(ends[-1]) + 1e-9)
    step = max(1, math.ceil((high - low) / 6))
    axis.set_major_locator(FixedLocator([10.0**n for n in range(high, low - 1, -step)]))
    axis.set_minor_locator(NullLocator())


def _explain(figure: Figure, image: Any, lines: Sequence[tuple[Formula[Any], xarray.Dataset]]) -> None:
    """Draw the colour scale under the panels, and beside it the key to lines, shades and hatching."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    width, height = figure.get_size_inches()
    marks: list[Any] = []
    if image is not None:
        scale = figure.add_axes((0.65 / width, 0.42 / height, 2.5 / width, 0.14 / height))
        bar = figure.colorbar(image, cax=scale, orientation="horizontal", extend="both")
        bar.set_ticks([1e-4, 1e-3, 1e-2, 1e-1, 1.0])
        bar.ax.xaxis.set_major_formatter(_percent)
        bar.ax.minorticks_off()
        bar.ax.tick_params(labelsize=8, colors=INK)
        for level, colour in CONTOURS.items():
            bar.ax.axvline(level, color=colour, lw=1.0)
        bar.outline.set_edgecolor(GREY)
        marks.append(Line2D([], [], color=CONTACT, lw=1.8, label="range of the formula"))
        marks.append(Patch(facecolor=EMPTY_COLOUR, edgecolor=HATCH_COLOUR, hatch="////", lw=0, label="no value"))
    if lines:
        loads: list[float] = next((data["load"].values.tolist() for _, data in lines if data.sizes.get("load", 1) > 1), [])
        colours = sequence(len(loads))
        marks.append(Line2D([], [], color=GREY, lw=1.2, ls=DASHED, label="stated worst error"))
        marks.append(Patch(facecolor=TINTS["hydrodynamic"], lw=0, label="range" if image is None else "range, of lines"))
        marks += [Line2D([], [], color=c, lw=2.0, label=f"load {power(load)}") for load, c in zip(loads, colours, strict=True)]
    figure.legend(
        handles=marks,
        loc="center left",
        bbox_to_anchor=((0.55 if image is None else 3.5) / width, (0.17 if image is None else 0.42) / height),
        ncols=len(marks) if image is None else math.ceil(len(marks) / 2),
        frameon=False,
        fontsize=8.5,
        labelcolor=INK,
        handlelength=1.8,
        columnspacing=1.4,
    )
