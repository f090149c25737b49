"""The picture of propagated errors: intervals over the values for the inputs as given."""

from __future__ import annotations

import numpy as np

from stribeck.plot import style
from stribeck.plot.style import GREY, INK, Axes, Figure, new_figure
from stribeck.quantities.units import InputError
from stribeck.uncertainty.result import Uncertainty

MIN_DRAWN_RATIO = 1e-3  # Smallest end of an interval that is drawn, over the value as given, and with its inverse the largest


@style.picture("no value is positive")
def plot_uncertainty(found: Uncertainty, *, ax: Axes | None = None, title: str = "") -> Figure:
    """Draw the 68 and 95 % intervals of a state over its values for the inputs as given."""
    shown = [each for each in found.spreads if each.value > 0 and np.isfinite(each.value)]
    if not shown:
        raise InputError("no value of this state is positive, so that there is no interval to draw.")
    size, footer = (8.5, 1.2 + 0.28 * len(shown)), [[f"Regime: {found.probabilities}."], *([line] for line in found.sources)]
    figure, (ax,) = new_figure(size, footer, title=title or "Uncertainty of a state", ax=ax, left=3.4)
    ends = np.clip([[*each.interval_95, *each.interval_68, each.median] for each in shown], 0.0, None)
    ends = np.clip(ends / np.array([[each.value] for each in shown]), MIN_DRAWN_RATIO, 1 / MIN_DRAWN_RATIO)
    rows = np.arange(len(shown))
    ax.hlines(rows, ends[:, 0], ends[:, 1], color=INK, lw=1.2, label="95 %")
    ax.hlines(rows, ends[:, 2], ends[:, 3], color=INK, lw=4.5, label="68 %")
    ax.plot(ends[:, 4], rows, color=INK, ls="", marker="o", ms=5.5, mfc="white", mew=1.3, label="median")
    ax.axvline(1.0, color=GREY, lw=0.8, ls=style.DASHED, zorder=0)
    style.label_rows(ax, [each.label for each in shown])
    style.make_logarithmic(ax, "x", ends)
    ax.set_xlabel("times the value for the inputs as given")
    ax.legend(frameon=False, fontsize=8, loc="best")
    return figure
