"""Elements of charts as options of ECharts: axes, lines, points and legends; and the difference of two charts.

Keys that begin with a colon hold JavaScript and are sent once, when a chart is made. Every series has a name for itself,
``id``, by which later data find it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.explorer.charts.palette import Palette

__all__ = [
    "Options",
    "chart",
    "data_only",
    "difference",
    "legend",
    "line",
    "linear_axis",
    "log_axis",
    "marker",
    "pairs",
    "with_unit",
]

Options = dict[str, Any]

FONT = "Roboto, system-ui, sans-serif"

POWER = """value => {
  const e = Math.round(Math.log10(value));
  const raised = n => '10' + String(n).replace(/./g, c => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]);
  if (Math.abs(value / Math.pow(10, e) - 1) > 1e-6) {
    const low = Math.floor(Math.log10(value));
    const part = Number((value / Math.pow(10, low)).toPrecision(2));
    return low >= -2 && low <= 2 ? String(Number(value.toPrecision(2))) : part + '·' + raised(low);
  }
  return e === 0 ? '1' : e === 1 ? '10' : raised(e);
}"""
"""Labels of logarithmic axes: powers of ten, all in one style."""

MOST_DECADES = 9
"""Decades up to which an axis has a label at each."""

PRECISION = "value => typeof value === 'number' ? Number(value.toPrecision(4)).toString() : value"


def data_only(options: Any) -> Any:
    """Return options without the keys that hold JavaScript."""
    if isinstance(options, dict):
        return {key: data_only(value) for key, value in options.items() if not key.startswith(":")}
    if isinstance(options, list):
        return [data_only(value) for value in options]
    return options


def difference(old: Options, new: Options) -> tuple[Options, Options] | None:
    """Return the options that take ECharts from ``old`` to ``new``, and how to merge them.

    Parameters
    ----------
    old, new : dict
        Data of a chart before and after.

    Returns
    -------
    tuple of dict, or None
        Only the series whose data moved, where nothing else changed; None where nothing did.
    """
    if old == new:
        return None
    before, after = old["series"], new["series"]
    if [s["id"] for s in before] != [s["id"] for s in after]:
        return new, {"replaceMerge": ["series"]}
    changed: Options = {key: value for key, value in new.items() if key != "series" and old.get(key) != value}
    series = []
    for one, two in zip(before, after, strict=True):
        if one != two:
            same = all(one.get(key) == value for key, value in two.items() if key != "data")
            series.append({"id": two["id"], "data": two["data"]} if same else two)
    return changed | ({"series": series} if series else {}), {}


def chart(palette: Palette, x: Options, y: Options, series: list[Options]) -> Options:
    """Return a whole chart without its legend."""
    return {
        "animation": False,
        "textStyle": {"fontFamily": FONT, "color": palette.ink},
        "grid": {"left": 62, "right": 16, "top": 40, "bottom": 46},
        "xAxis": x,
        "yAxis": y,
        "tooltip": {
            "trigger": "axis",
            "axisPointer": {"type": "line", "lineStyle": {"color": palette.grey, "type": "dotted"}},
            "backgroundColor": palette.card,
            "borderColor": palette.grid,
            "textStyle": {"color": palette.ink, "fontSize": 12},
            ":valueFormatter": PRECISION,
            "confine": True,
        },
        "series": series,
    }


def _axis(name: str, low: float, high: float, palette: Palette) -> Options:
    return {
        "name": name,
        "nameLocation": "middle",
        "nameTextStyle": {"color": palette.grey, "fontSize": 12},
        "min": low,
        "max": high,
        "axisLine": {"show": True, "onZero": False, "lineStyle": {"color": palette.grey}},
        "axisLabel": {"color": palette.grey, "fontSize": 11, "hideOverlap": True},
        "splitLine": {"show": True, "lineStyle": {"color": palette.grid}},
        "nameGap": 28,
    }


POINTED = """p => Number(p.value.toPrecision(3)) + ' ' + ((window.explorerUnits || {})['CHART'] || '')"""
"""Headline of a tooltip: the position along an axis with its present unit."""


def with_unit(chart: str, axis: Options) -> Options:
    """Return an axis whose tooltip shows the position with its unit."""
    return axis | {"axisPointer": {"label": {":formatter": POINTED.replace("CHART", chart)}}}


def log_axis(name: str, low: float, high: float, palette: Palette) -> Options:
    """Return a logarithmic axis with a name, between two ends."""
    axis = _axis(name, low, high, palette) | {"type": "log", "minorTick": {"show": True, "splitNumber": 9}}
    axis["axisLabel"] = axis["axisLabel"] | {":formatter": POWER}
    decades = math.log10(high / low)
    # ECharts itself labels every tenth power on an axis of ten decades or more, and a tenth of it as minor ticks.
    wide = decades > MOST_DECADES and math.log10(low).is_integer()
    axis["interval"] = 2 if wide else None
    axis["minorTick"]["show"] = not wide
    return axis


def linear_axis(name: str, low: float, high: float, palette: Palette) -> Options:
    """Return a linear axis with a name, between two ends."""
    return _axis(name, low, high, palette) | {"type": "value", "splitNumber": 4}


def line(key: str, name: str, x: Array, y: Array, color: str, width: float, dash: Sequence[float] | None = None) -> Options:
    """Return a line through points, as a series."""
    return {
        "id": key,
        "name": name,
        "type": "line",
        "data": pairs(x, y),
        "showSymbol": False,
        "symbol": "none",
        "color": color,
        "lineStyle": {"color": color, "width": width, "type": list(dash) if dash else "solid"},
        "emphasis": {"disabled": True},
        "z": 3,
    }


def marker(key: str, place: Sequence[float], palette: Palette) -> Options:
    """Return the mark of the present point, as a series."""
    return {
        "id": key,
        "name": "present point",
        "type": "scatter",
        "data": [list(place)],
        "symbolSize": 13,
        "itemStyle": {"color": palette.point, "borderColor": palette.ink, "borderWidth": 2},
        "z": 6,
    }


def legend(palette: Palette, names: Sequence[str], points: Sequence[str] = ()) -> Options:
    """Return a legend of lines, and of points for the names of those."""
    look: Options = {"itemStyle": {"opacity": 0}}
    return {
        "data": [{"name": name} | ({} if name in points else look) for name in names],
        "type": "scroll",
        "top": 4,
        "left": 0,
        "right": 0,
        "itemWidth": 22,
        "itemHeight": 13,
        "itemGap": 10,
        "textStyle": {"color": palette.ink, "fontSize": 11.5},
        "pageIconSize": 10,
        "pageTextStyle": {"color": palette.grey},
        "pageIconColor": palette.grey,
        "pageIconInactiveColor": palette.grid,
        "inactiveColor": palette.grid,
    }


def pairs(x: Array, y: Array) -> list[list[float | None]]:
    """Return points, null where there is none, rounded to what a screen can show."""
    points = np.stack([x, y], axis=1).astype(float)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        unit = 10.0 ** (5 - np.floor(np.log10(np.abs(points))))
        rounded = np.where((points == 0) | ~np.isfinite(unit), points, np.round(points * unit) / unit)
    if np.isfinite(rounded).all():
        return rounded.tolist()  # type: ignore[no-any-return]
    return [[value if math.isfinite(value) else None for value in point] for point in rounded.tolist()]
