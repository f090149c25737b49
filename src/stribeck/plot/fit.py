"""Pictures of measured friction, and of a fit: with the fitted curves and their 95 % bands, and the residuals below."""

import math
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.fits.measurements import Measurements
from stribeck.fits.result import Fit
from stribeck.plot import style
from stribeck.plot.style import GREY, SERIES, Axes, Figure, add_legend, make_logarithmic, new_figure
from stribeck.quantities.units import InputError

POINTS = 121  # Of a fitted curve
MARKERS = ("o", "s", "^", "D", "v", "P")  # Of the curves, in turn

LABELS = {
    "speed": "speed $U$, sum of both surfaces (m/s)",
    "speed_viscosity": r"viscosity times speed $\eta U$ (Pa m)",
    "hersey_number": "Hersey number",
    "hersey_per_length": r"Hersey number over length $\eta U/F_N$ (1/m)",
}


@style.picture()
def plot_fit(fit: Fit, *, ax: Axes | None = None, title: str = "", notes: bool = True) -> Figure:
    """Draw a fit."""
    data = fit.data
    caption = _caption(fit, notes)
    figure, (above, *others) = new_figure((8.5, 6.2), *caption, rows=2, title=title or "Fit to measured friction", ax=ax)
    bars: Any = fit._minimum.objective.sigma
    bars = None if bars is None else bars * (data.friction if fit.logarithmic else 1.0)
    styles = draw_points(above, data, data.values, bars)
    for k, form in enumerate(styles):
        rows = data.curve == k
        colour = form["color"]
        x = np.geomspace(data.values[rows].min(), data.values[rows].max(), POINTS)
        friction, low, high = fit.band(k, x)
        above.plot(x, friction, color=colour, lw=1.6, zorder=3, label="fitted" if k == 0 else None)
        name = "95 % band of the curve" if k == 0 else None
        above.fill_between(x, low, high, color=colour, alpha=0.18, lw=0, zorder=2, label=name)
        for below in others:
            below.plot(data.values[rows], fit.residuals[rows], zorder=3, **form)
    for below in others:
        make_logarithmic(below, "x", data.values)
        for level, dashes in ((0.0, "-"), (-2.0, style.DASHED), (2.0, style.DASHED)):
            below.axhline(level, color=GREY, lw=0.9, ls=dashes, zorder=1)
        reach = 1.1 * max(3.0, float(np.abs(fit.residuals).max()))
        below.set(xlim=above.get_xlim(), ylim=(-reach, reach), ylabel="residual (standard errors)")
        above.tick_params(labelbottom=False, which="both")
    drawn = [above, *others]
    drawn[-1].set_xlabel(LABELS[data.abscissa])
    add_legend(figure, drawn, inside=not others)
    return figure


@style.picture("there are no rows")
def plot_measurements(data: Measurements, *, ax: Axes | None = None, title: str = "") -> Figure:
    """Draw measured friction, with its standard errors where they are known."""
    if not len(data):
        raise InputError("there are no rows, so that there is nothing to draw.")
    figure, (ax,) = new_figure((7.5, 4.6), [], title=title or "Measured friction", ax=ax)
    draw_points(ax, data, data.values, data.error)
    ax.set_xlabel(LABELS[data.abscissa])
    add_legend(figure, [ax], inside=True)
    return figure


def draw_points(axes: Axes, data: Measurements, values: Array, bars: Any) -> list[dict[str, Any]]:
    """Draw each measured curve over an abscissa with error bars, if there are any, and return the styles."""
    make_logarithmic(axes, "x", values)
    make_logarithmic(axes, "y", data.friction)
    axes.set_ylabel(style.FRICTION)
    styles = []
    for k, name in enumerate(data.curves):
        rows = data.curve == k
        colour, marker = SERIES[k % len(SERIES)], MARKERS[k % len(MARKERS)]
        form: dict[str, Any] = {"color": colour, "ls": "none", "marker": marker, "ms": 4.0, "mfc": "white", "mew": 1.1}
        label = "measured" if len(data.curves) == 1 else f"measured: {name}"
        error = None if bars is None else bars[rows]
        axes.errorbar(values[rows], data.friction[rows], error, lw=0.9, zorder=4, label=label, **form)
        styles.append(form)
    return styles


def _caption(fit: Fit, notes: bool) -> tuple[list[list[str]], list[str]]:
    """Return what stands below the picture: values and how the fit ended, and the notes where they are wanted."""
    parts = [f"{each.label} {each.texts[0]} (95 % {each.texts[3]})" for each in fit.inputs]
    noise = "" if math.isnan(fit.noise) else f" Noise {fit.noise:.2g}{', relative' if fit.logarithmic else ''}."
    ended = f"{fit.outcome.value}{noise} Contact law: {fit.law}; friction: {fit.definition}."
    warnings = [*fit.quality.messages, *(each.message for each in fit.undetermined)] if notes else []
    return [[f"Fitted: {parts[0]}", *parts[1:]], [ended]], warnings
