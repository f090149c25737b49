"""What is shown as one picture for slides and papers: the four charts in the style of the package's figures."""

from __future__ import annotations

import io
from collections.abc import Sequence
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.explorer.charts.charts import all_charts
from stribeck.explorer.charts.palette import LIGHT
from stribeck.explorer.inputs import FIELDS
from stribeck.files.writing import MissingExtraError
from stribeck.quantities.inputs import QUANTITIES, SYMBOLS
from stribeck.quantities.units import format_si

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from stribeck.explorer.downloads import View

__all__ = ["picture"]

DPI = 160
PLACES = {"friction": (0, 0), "diagram": (0, 1), "gap": (1, 0), "pressure": (1, 1)}


def picture(shown: View, kind: str) -> bytes:
    """Return a picture of the four charts, drawn from the very data that the page shows.

    Parameters
    ----------
    shown : View
        What is shown.
    kind : {"png", "svg"}
        Its format.

    Returns
    -------
    bytes
        The file.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    """
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("a picture", "plot", "matplotlib") from None
    inputs, solution = shown.answer.inputs, shown.answer.solution
    figure = Figure(figsize=(12.0, 8.4), dpi=DPI, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    figure.get_layout_engine().set(rect=(0.0, 0.06, 1.0, 0.94))  # type: ignore[union-attr, call-arg]
    grid = figure.add_gridspec(2, 2)
    for name, options in all_charts(shown.answer, shown.pins, shown.measured, LIGHT).items():
        axes = figure.add_subplot(grid[PLACES[name]])
        _draw(axes, options)
    figure.suptitle(inputs.title or "stribeck", fontsize=13, fontweight="bold")
    values = [
        f"{SYMBOLS[name]} = {format_si(getattr(inputs.contact, name), QUANTITIES[name].dimension, 4).replace('*', '·')}"
        for name in FIELDS
    ]
    friction = solution.friction(definition=inputs.definition)
    state = (
        f"{shown.answer.regime} lubrication, friction {friction.total:.5g} ± {friction.error:.0e} "
        f"(definition {inputs.definition}), "
        f"Lambda {solution.lambda_ratio:.4g}, fluid carries {100 * solution.fluid_load_share:.4g} % of the load"
    )
    source = "" if shown.answer.curve is None else f"curve {shown.answer.curve.source}; "
    last = f"{source}state solved, estimated error {solution.error_estimate:.0e}; stribeck {version('stribeck')}"
    for i, line in enumerate((",  ".join(values), state, last)):
        figure.text(0.01, 0.044 - 0.018 * i, line, fontsize=8.5, color=LIGHT.grey)
    file = io.BytesIO()
    metadata: dict[str, Any] = {"Date": None} if kind == "svg" else {}
    figure.savefig(file, format=kind, metadata=metadata)
    return file.getvalue()


def _draw(axes: Axes, options: dict[str, Any]) -> None:
    """Draw one chart from its options."""
    x, y = options["xAxis"], options["yAxis"]
    for which, axis in (("x", x), ("y", y)):
        axes.set(**{f"{which}scale": "log" if axis["type"] == "log" else "linear"})
        axes.set(**{f"{which}lim": (axis["min"], axis["max"]), f"{which}label": axis["name"]})
    axes.grid(color=LIGHT.grid, lw=0.7)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=8.5)
    listed = [each["name"] for each in options["legend"]["data"]]
    for series in options["series"]:
        pairs = [[np.nan if value is None else value for value in point[:2]] for point in series["data"]]
        label = series["name"] if series["name"] in listed else None
        _draw_series(axes, series, np.array(pairs, dtype=float).reshape(-1, 2), label)
    if listed:
        axes.legend(fontsize=8, frameon=False, loc="best")


def _draw_series(axes: Axes, series: dict[str, Any], points: Any, label: str | None) -> None:
    if series["type"] == "custom":
        outline = np.array(series["data"][0][3:]).reshape(-1, 2)
        axes.fill(outline[:, 0], outline[:, 1], color=series["itemStyle"]["color"], lw=0, zorder=0.5)
    elif series["id"].startswith("name-"):
        for place in points:
            name = series["label"]["formatter"]
            axes.text(place[0], place[1], name, color=LIGHT.grey, fontsize=9, style="italic", ha="center", va="center")
    elif series["type"] == "scatter":
        style = series["itemStyle"]
        hollow = style["color"] == "transparent"
        axes.plot(
            points[:, 0],
            points[:, 1],
            "o",
            ms=5 if hollow else 8,
            mfc="none" if hollow else style["color"],
            mec=style["borderColor"],
            mew=1.2,
            label=label,
            zorder=6,
            clip_on=False,
        )
    else:
        line = series["lineStyle"]
        for start, end, tint in _grounds(series):
            axes.axvspan(start, end, color=tint, lw=0, zorder=0.5)
        axes.plot(
            points[:, 0],
            points[:, 1],
            color=line["color"],
            lw=0.8 * line["width"],
            ls=_dash(line["type"]),
            label=label,
            zorder=3,
        )
        for mark in series.get("markLine", {}).get("data", ()):
            axes.axvline(mark["xAxis"], color=LIGHT.mark, lw=1, ls=(0, (2, 3)), zorder=2)


def _grounds(series: dict[str, Any]) -> list[tuple[float, float, str]]:
    areas = series.get("markArea", {}).get("data", ())
    return [(first["xAxis"], last["xAxis"], first["itemStyle"]["color"]) for first, last in areas]


def _dash(kind: str | Sequence[float]) -> Any:
    return "-" if isinstance(kind, str) else (0, tuple(0.7 * part for part in kind))
