"""Parts of charts as plain data for ``chart.js``: axes, lines, points and legends."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.explorer.charts.palette import Palette

__all__ = ["Options", "chart", "line", "linear_axis", "log_axis", "marker", "pairs", "points"]

Options = dict[str, Any]


def chart(palette: Palette, x: Options, y: Options, series: list[Options], listed: Sequence[str] = ()) -> Options:
    """Return a whole chart, with a legend of some of its series by name."""
    return {"x": x, "y": y, "series": series, "legend": list(listed), "grey": palette.grey, "grid": palette.grid}


def log_axis(name: str, low: float, high: float) -> Options:
    """Return a logarithmic axis with a name, which ends with its unit, between two ends."""
    return {"name": name, "low": low, "high": high, "log": True, "unit": name.partition("(")[2].partition(")")[0].strip("–")}


def linear_axis(name: str, low: float, high: float) -> Options:
    """Return a linear axis with a name and its unit, between two ends."""
    return log_axis(name, low, high) | {"log": False}


def line(key: str, name: str, x: Array, y: Array, color: str, width: float, dash: Sequence[float] = ()) -> Options:
    """Return a line through points, as a series."""
    look = {"color": color, "width": width, "dash": list(dash)}
    return {"id": key, "name": name, "type": "line", "data": pairs(x, y), **look}


def points(key: str, name: str, x: Array, y: Array, symbol: str, edge: str) -> Options:
    """Return open symbols at points, as a series."""
    look = {"symbol": symbol, "size": 7, "fill": "transparent", "edge": edge, "width": 1.6}
    return {"id": key, "name": name, "type": "points", "data": pairs(x, y), **look}


def marker(x: float, y: float, palette: Palette) -> Options:
    """Return the mark of the present point, as a series."""
    look = {"symbol": "circle", "size": 13, "fill": palette.point, "edge": palette.ink, "width": 2}
    return {"id": "point", "name": "present point", "type": "points", "data": [[x, y]], **look}


def pairs(x: Array, y: Array) -> list[list[float | None]]:
    """Return points, null where there is none, rounded to what a screen can show."""
    points = np.stack([x, y], axis=1).astype(float)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        unit = 10.0 ** (5 - np.floor(np.log10(np.abs(points))))
        rounded = np.where((points == 0) | ~np.isfinite(unit), points, np.round(points * unit) / unit)
    if np.isfinite(rounded).all():
        return rounded.tolist()  # type: ignore[no-any-return]
    return [[value if math.isfinite(value) else None for value in point] for point in rounded.tolist()]
