"""Pictures in time: raw rows of a rig and the curve that they make, a stroke, and a fitted loop of friction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck._types import Array, Indices
from stribeck.bench.loop_fit import LoopFit
from stribeck.plot import style
from stribeck.plot.style import Axes, Figure
from stribeck.quantities.units import InputError
from stribeck.strokes.result import Stroke

if TYPE_CHECKING:
    from stribeck.bench.result import BenchCurve


MAX_DRAWN = 20_000  # Rows of each kind that are drawn, evenly spaced ones of more

# Colour and size of the rows by what became of them.
LOOKS = ((style.FLUID, 2.2), (style.GREY, 1.5), (style.GREY, 1.5), (style.CONTACT, 2.5), (style.MARK, 2.5))
LABELS = ("kept", "at rest", "speed changes", "start of a step", "run-in")


@style.picture("there are no points")
def plot_bench(curve: BenchCurve, *, ax: Axes | None = None, title: str = "", notes: bool = False) -> Figure:
    """Draw speed and friction of all rows over time, what was left out in other colours, and the curve with 95 % intervals."""
    if not len(curve):
        raise InputError("there are no points, so that there is nothing to draw.")
    size = (9.0, 8.2) if ax is None else (9.0, 4.0)
    said = [each for each in curve.notes if each.startswith("Left out")] if notes else []
    figure, axes = style.new_figure(size, [], said, title=title or "What was kept, and the curve", ax=ax, rows=3)
    if ax is None:
        _draw_rows(axes[0], axes[1], curve)
        box = axes[2].get_position()
        axes[2].set_position((box.x0, box.y0, box.width, box.height * 0.82))
    _draw_points(axes[-1], curve)
    style.add_legend(figure, axes, columns=5, inside=ax is not None)
    return figure


def _draw_rows(above: Axes, below: Axes, curve: BenchCurve) -> None:
    """Draw speed and friction of the rows over time, file after file."""
    time, edges = _one_after_another(curve)
    for k, ((colour, size), label) in enumerate(zip(LOOKS, LABELS, strict=True)):
        rows = np.flatnonzero(curve.status == k)
        if not len(rows):
            continue
        rows = rows[:: -(-len(rows) // MAX_DRAWN)]
        for axes, values in ((above, np.abs(curve.row_speed)), (below, curve.row_friction)):
            look: dict[str, Any] = {"color": colour, "ms": size, "zorder": 2 + k, "rasterized": True}
            axes.plot(time[rows], values[rows], ".", label=label, **look)
    usual = np.abs(curve.row_friction[curve.status == 0])
    if len(usual):
        below.set_ylim(min(0.0, float(curve.row_friction[curve.status == 0].min())), 1.4 * float(usual.max()))
    moving = np.abs(curve.row_speed[(curve.row_speed != 0) & (curve.status == 0)])
    style.make_logarithmic(above, "y", moving)
    above.set_ylim(float(moving.min()) / 2, 2 * float(moving.max()))
    above.set_ylabel("size of the speed (m/s)")
    below.set(xlabel="time (s)", ylabel="friction of the rows")
    above.tick_params(labelbottom=False)
    for edge in edges:
        for axes in (above, below):
            axes.axvline(edge, color=style.INK, lw=0.7)


def _one_after_another(curve: BenchCurve) -> tuple[Array, list[float]]:
    """Return the time of each row with the files one after another, and where a file begins."""
    found, edges, end = curve.time.astype(float), list[float](), 0.0
    for k in range(len(curve.paths)):
        rows: Indices = np.flatnonzero(curve.file == k)
        if not len(rows):
            continue
        found[rows] += end - curve.time[rows].min()
        if k:
            edges.append(end)
        end = float(found[rows].max())
    return found, edges


def _draw_points(axes: Axes, curve: BenchCurve) -> None:
    """Draw the points with their 95 % intervals."""
    for k, name in enumerate(curve.curves):
        mine = curve.curve == k
        bars = np.where(np.isfinite(curve.half_width[mine]), curve.half_width[mine], 0.0)
        colour = style.SERIES[k % len(style.SERIES)]
        look: dict[str, Any] = {"fmt": "o", "ms": 4.0, "mfc": "white", "capsize": 2.0, "color": colour}
        axes.errorbar(curve.speed[mine], curve.friction[mine], bars, label=name or "mean and 95 % interval", **look)
    style.make_logarithmic(axes, "x", curve.speed)
    if (curve.friction > 0).all():
        style.make_logarithmic(axes, "y", curve.friction)
    axes.set(xlabel="speed $U$, sum of both surfaces (m/s)", ylabel=style.FRICTION)


@style.picture("there is none")
def plot_stroke(stroke: Stroke, *, ax: Axes | None = None, title: str = "", notes: bool = True) -> Figure:
    """Draw the loop of friction over position, with its error, and beside it the films over time.

    Of a motion that repeats the last cycle is drawn.
    """
    data, last = stroke.to_dataset(), stroke.last_cycle
    size, said = (10.0, 4.6), [[str(data.attrs["inputs"])]]
    figure, (loop, *others) = style.new_figure(
        size,
        said,
        stroke.notes if notes else (),
        title=title or "Friction over a stroke",
        ax=ax,
        columns=2,
    )
    x, mu, error = (np.asarray(data[name])[last] for name in ("position", "friction", "friction_error"))
    factor, unit = style.readable_unit("length", float(np.ptp(x)))
    loop.errorbar(x * factor, mu, error, color=style.INK, ecolor=style.GREY, lw=1.4, label="friction")
    loop.plot(x * factor, np.asarray(data["friction_asperities"])[last], color=style.CONTACT, lw=1.0, label="by asperities")
    loop.plot(x * factor, np.asarray(data["friction_fluid"])[last], color=style.FLUID, lw=1.0, label="by the fluid")
    loop.axhline(0.0, color=style.GREY, lw=0.6, zorder=0)
    loop.set(xlabel=style.with_unit("position", unit), ylabel="friction coefficient")
    if others:
        time, film = np.asarray(data["time"])[last], np.asarray(data["central_film_thickness"])[last]
        factor, unit = style.readable_unit("length", float(film.max()))
        others[0].plot(time, film * factor, color=style.FLUID, lw=1.4, label="film at the centre")
        others[0].plot(
            time, np.asarray(data["minimum_film_thickness"])[last] * factor, color=style.MARK, lw=1.2, label="thinnest film"
        )
        others[0].set(xlabel="time (s)", ylabel=style.with_unit("film", unit))
    style.add_legend(figure, [loop, *others], columns=5, inside=ax)
    return figure


@style.picture("there is none")
def plot_loop_fit(fit: LoopFit, *, ax: Axes | None = None, title: str = "", notes: bool = True) -> Figure:
    """Draw measured and fitted friction over position or time."""
    data = fit.to_dataset()
    said = [[f"{each.label} {' ± '.join(each.texts[:2])}" for each in fit.inputs]]
    figure, (axes,) = style.new_figure(
        (6.4, 4.6), said, fit.notes if notes else (), title=title or "A fitted friction loop", ax=ax
    )
    x = np.asarray(data[fit.over])
    factor, unit = style.readable_unit("length", float(np.ptp(x))) if fit.over == "position" else (1.0, "s")
    axes.plot(x * factor, np.asarray(data["friction"]), ".", color=style.GREY, ms=4, label="measured")
    fitted, error = np.asarray(data["fitted_friction"]), np.asarray(data["fitted_friction_error"])
    axes.errorbar(
        x * factor, fitted, error, fmt=".", color=style.INK, ecolor=style.MARK, ms=3, lw=0.8, label="fitted, with its error"
    )
    axes.axhline(0.0, color=style.GREY, lw=0.6, zorder=0)
    axes.set(xlabel=style.with_unit(fit.over, unit), ylabel="friction coefficient")
    style.add_legend(figure, [axes], inside=ax)
    return figure
