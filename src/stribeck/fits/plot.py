"""Pictures of measured friction, and of a fit: with the fitted curves and their 95 % bands, and the residuals below.

matplotlib comes with the extra ``plot`` and is imported on first use.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.files.pictures import (
    CONTACT,
    FLUID,
    GREY,
    INK,
    MARK,
    add_legend,
    finish_figure,
    make_logarithmic,
    new_figure,
    picture,
)
from stribeck.files.writing import PathLike
from stribeck.fits.case_file import format_interval, format_value
from stribeck.fits.measurements import Measurements
from stribeck.fits.result import Fit
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_fit", "plot_measurements"]

POINTS = 121

COLOURS = (INK, CONTACT, FLUID, MARK, "#009e73", "#e69f00")
MARKERS = ("o", "s", "^", "D", "v", "P")  # Of the curves, in turn

LABELS = {
    "speed": "speed $U$, sum of both surfaces (m/s)",
    "speed_viscosity": r"viscosity times speed $\eta U$ (Pa m)",
    "hersey_number": "Hersey number",
    "hersey_per_length": r"Hersey number over length $\eta U/F_N$ (1/m)",
}


@picture()
def plot_fit(
    fit: Fit,
    path: PathLike | None = None,
    *,
    ax: Axes | None = None,
    force: bool = False,
    title: str = "",
    notes: bool = True,
) -> Figure:
    """Draw a fit.

    Parameters
    ----------
    fit : Fit
        The fit.
    ax : matplotlib.axes.Axes, optional
        Axes to draw friction into, in place of a new figure.
    """
    data = fit.data
    caption = _caption(fit, notes)
    figure, (above, *others) = new_figure((8.5, 6.2), *caption, rows=2, title=title or "Fit to measured friction", ax=ax)
    bars: Any = fit._minimum.objective.sigma
    bars = None if bars is None else bars * (data.friction if fit.logarithmic else 1.0)
    styles = _draw_measured(above, data, bars)
    for k, style in enumerate(styles):
        rows = data.curve == k
        colour = style["color"]
        x = np.geomspace(data.values[rows].min(), data.values[rows].max(), POINTS)
        friction, low, high = fit.band(k, x)
        above.plot(x, friction, color=colour, lw=1.6, zorder=3, label="fitted" if k == 0 else None)
        above.fill_between(
            x, low, high, color=colour, alpha=0.18, lw=0, zorder=2, label="95 % band of the curve" if k == 0 else None
        )
        for below in others:
            below.plot(data.values[rows], fit.residuals[rows], zorder=3, **style)
    if not others:
        above.set_xlabel(LABELS[data.abscissa])
        above.legend(frameon=False, fontsize=8.5)
        return finish_figure(figure, path, force)
    (below,) = others
    make_logarithmic(below, "x", data.values)
    for level, dashes in ((0.0, "-"), (-2.0, (0, (5, 3))), (2.0, (0, (5, 3)))):
        below.axhline(level, color=GREY, lw=0.9, ls=dashes, zorder=1)
    reach = 1.1 * max(3.0, float(np.abs(fit.residuals).max()))
    below.set_ylim(-reach, reach)
    below.set_xlim(above.get_xlim())
    above.tick_params(labelbottom=False, which="both")
    below.set_ylabel("residual (standard errors)")
    below.set_xlabel(LABELS[data.abscissa])
    add_legend(figure, (above, below))
    return finish_figure(figure, path, force)


@picture("there are no rows")
def plot_measurements(
    data: Measurements, path: PathLike | None = None, *, ax: Axes | None = None, force: bool = False, title: str = ""
) -> Figure:
    """Draw measured friction, with its standard errors where they are known.

    Parameters
    ----------
    data : Measurements
        The rows.
    """
    if not len(data):
        raise InputError("there are no rows, so that there is nothing to draw.")
    figure, (ax,) = new_figure((7.5, 4.6), [], title=title or "Measured friction", ax=ax)
    _draw_measured(ax, data, data.error)
    ax.set_xlabel(LABELS[data.abscissa])
    ax.legend(frameon=False, fontsize=8.5)
    return finish_figure(figure, path, force)


def _draw_measured(axes: Axes, data: Measurements, bars: Any) -> list[dict[str, Any]]:
    """Draw each measured curve with error bars, if there are any, and return the styles."""
    make_logarithmic(axes, "x", data.values)
    make_logarithmic(axes, "y", data.friction)
    axes.set_ylabel(r"friction coefficient $\mu$")
    styles = []
    for k, name in enumerate(data.curves):
        rows = data.curve == k
        colour, marker = COLOURS[k % len(COLOURS)], MARKERS[k % len(MARKERS)]
        style: dict[str, Any] = {"color": colour, "ls": "none", "marker": marker, "ms": 4.0, "mfc": "white", "mew": 1.1}
        label = "measured" if len(data.curves) == 1 else f"measured: {name}"
        error = None if bars is None else bars[rows]
        axes.errorbar(data.values[rows], data.friction[rows], error, lw=0.9, zorder=4, label=label, **style)
        styles.append(style)
    return styles


def _caption(fit: Fit, notes: bool) -> tuple[list[list[str]], list[str]]:
    """Return what stands below the picture: values and how the fit ended, and the notes where they are wanted."""
    parts = [f"{each.label} {format_value(each)} (95 % {format_interval(each, 0.95)})" for each in fit.inputs]
    noise = "" if math.isnan(fit.noise) else f" Noise {fit.noise:.2g}{', relative' if fit.logarithmic else ''}."
    ended = f"{fit.outcome.value}{noise} Contact law: {fit.law}; friction: {fit.definition}."
    warnings = [*fit.quality.messages, *(each.message for each in fit.undetermined)] if notes else []
    return [[f"Fitted: {parts[0]}", *parts[1:]], [ended]], warnings
