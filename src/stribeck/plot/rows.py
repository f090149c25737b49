"""Pictures with a row for each number: checks over their limits, and the intervals of a state over its values."""

import math

import numpy as np

from stribeck.checks.check import Check, Checks
from stribeck.plot import style
from stribeck.plot.style import CONTACT, FLUID, GREY, INK, MARK, Axes, Figure, new_figure
from stribeck.quantities.units import InputError
from stribeck.uncertainty.result import Uncertainty

VERDICT_MARKS = {"fine": (FLUID, "o"), "doubtful": (MARK, "D"), "outside": (CONTACT, "s")}  # Colour and marker

MAX_DRAWN_RATIO = 1e3  # Largest ratio of a value and its limit that is drawn, and with its inverse the smallest

MIN_DRAWN_RATIO = 1e-3  # Smallest end of an interval that is drawn, over the value as given, and with its inverse the largest


@style.picture("there is none")
def plot_checks(checks: Checks, *, ax: Axes | None = None, title: str = "") -> Figure:
    """Draw each check as its value over the limit up to which it is fine, or the limit over the value if it must be larger."""
    if not len(checks):
        raise InputError("no check could be made, so that there is nothing to draw.")
    inside = ax is not None
    size, headline = (9.5, 1.2 + 0.28 * len(checks)), [[checks.headline]]
    figure, (ax,) = new_figure(size, headline, title=title or "Whether the model applies", ax=ax, left=2.2, right=2.3)
    ax.set_xscale("log")
    for verdict, (colour, marker) in VERDICT_MARKS.items():
        mine = [(row, limit_fraction(each)) for row, each in enumerate(checks) if each.verdict == verdict]
        rows, parts = (np.array(each) for each in zip(*mine, strict=True)) if mine else (np.empty(0), np.empty(0))
        ax.hlines(rows, 1 / MAX_DRAWN_RATIO, parts, color=colour, lw=1.6)
        ax.plot(parts, rows, ls="", marker=marker, color=colour, label=verdict)
    for row, each in enumerate(checks):
        value, limit = each.texts
        ax.annotate(f"{value} ({limit})", (1.01, row), xycoords=("axes fraction", "data"), va="center", size=7.5, color=INK)
    ax.axvline(1.0, color=GREY, lw=0.9, ls=style.DASHED, zorder=0)
    style.label_rows(ax, [each.name for each in checks])
    ax.set(xlim=(1 / MAX_DRAWN_RATIO, MAX_DRAWN_RATIO), xlabel="part of its limit; beyond 1 is not fine")
    style.add_legend(figure, [ax], inside=inside)
    return figure


def limit_fraction(check: Check) -> float:
    """Return the part of its limit that a check takes, within what is drawn; the largest if its value is nan."""
    value, limit = (check.limit, check.value) if check.at_least else (check.value, check.limit)
    if math.isnan(check.value):
        return MAX_DRAWN_RATIO
    part = value / limit if limit else math.copysign(math.inf, value) if value else 0.0
    return min(max(part, 1 / MAX_DRAWN_RATIO), MAX_DRAWN_RATIO)


@style.picture("no value is positive")
def plot_uncertainty(found: Uncertainty, *, ax: Axes | None = None, title: str = "") -> Figure:
    """Draw the 68 and 95 % intervals of a state over its values for the inputs as given."""
    shown = [each for each in found.spreads if each.value > 0 and np.isfinite(each.value)]
    if not shown:
        raise InputError("no value of this state is positive, so that there is no interval to draw.")
    inside = ax is not None
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
    style.add_legend(figure, [ax], inside=inside)
    return figure
