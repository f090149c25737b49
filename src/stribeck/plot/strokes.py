"""The picture of a stroke: friction over position, and friction and films over time."""

from __future__ import annotations

import numpy as np

from stribeck.bench.loop_fit import LoopFit
from stribeck.plot import style
from stribeck.plot.style import CONTACT, FLUID, GREY, INK, MARK, Axes, Figure, add_legend, new_figure, readable_unit, with_unit
from stribeck.strokes.result import Stroke


@style.picture("there is none")
def plot_stroke(stroke: Stroke, *, ax: Axes | None = None, title: str = "", notes: bool = True) -> Figure:
    """Draw the loop of friction over position, with its error, and beside it the films over time.

    Of a motion that repeats the last cycle is drawn.
    """
    data, last = stroke.to_dataset(), stroke.last_cycle
    size, said = (10.0, 4.6), [[str(data.attrs["inputs"])]]
    figure, (loop, *others) = new_figure(
        size,
        said,
        stroke.notes if notes else (),
        title=title or "Friction over a stroke",
        ax=ax,
        columns=2,
    )
    x, mu, error = (np.asarray(data[name])[last] for name in ("position", "friction", "friction_error"))
    factor, unit = readable_unit("length", float(np.ptp(x)))
    loop.errorbar(x * factor, mu, error, color=INK, ecolor=GREY, lw=1.4, label="friction")
    loop.plot(x * factor, np.asarray(data["friction_asperities"])[last], color=CONTACT, lw=1.0, label="by asperities")
    loop.plot(x * factor, np.asarray(data["friction_fluid"])[last], color=FLUID, lw=1.0, label="by the fluid")
    loop.axhline(0.0, color=GREY, lw=0.6, zorder=0)
    loop.set(xlabel=with_unit("position", unit), ylabel="friction coefficient")
    if others:
        time, film = np.asarray(data["time"])[last], np.asarray(data["central_gap"])[last]
        factor, unit = readable_unit("length", float(film.max()))
        others[0].plot(time, film * factor, color=FLUID, lw=1.4, label="film at the centre")
        others[0].plot(time, np.asarray(data["minimum_gap"])[last] * factor, color=MARK, lw=1.2, label="thinnest film")
        others[0].set(xlabel="time (s)", ylabel=with_unit("film", unit))
    add_legend(figure, [loop, *others], columns=5, inside=ax)
    return figure


@style.picture("there is none")
def plot_loop_fit(fit: LoopFit, *, ax: Axes | None = None, title: str = "", notes: bool = True) -> Figure:
    """Draw measured and fitted friction over position or time."""
    data = fit.to_dataset()
    said = [[f"{each.label} {' ± '.join(each.texts[:2])}" for each in fit.inputs]]
    figure, (axes,) = new_figure((6.4, 4.6), said, fit.notes if notes else (), title=title or "A fitted friction loop", ax=ax)
    x = np.asarray(data[fit.over])
    factor, unit = readable_unit("length", float(np.ptp(x))) if fit.over == "position" else (1.0, "s")
    axes.plot(x * factor, np.asarray(data["measured_friction"]), ".", color=GREY, ms=4, label="measured")
    fitted, error = np.asarray(data["fitted_friction"]), np.asarray(data["fitted_friction_error"])
    axes.errorbar(x * factor, fitted, error, fmt=".", color=INK, ecolor=MARK, ms=3, lw=0.8, label="fitted, with its error")
    axes.axhline(0.0, color=GREY, lw=0.6, zorder=0)
    axes.set(xlabel=with_unit(fit.over, unit), ylabel="friction coefficient")
    add_legend(figure, [axes], inside=ax)
    return figure
