"""The picture of the checks: each value over its limit, coloured by the verdict."""

from __future__ import annotations

import math

import numpy as np

from stribeck.checks.check import Check, Checks
from stribeck.plot import style
from stribeck.plot.style import CONTACT, FLUID, GREY, INK, MARK, Axes, Figure, new_figure
from stribeck.quantities.units import InputError

VERDICT_MARKS = {"fine": (FLUID, "o"), "doubtful": (MARK, "D"), "outside": (CONTACT, "s")}  # Colour and marker

MAX_DRAWN_RATIO = 1e3  # Largest ratio of a value and its limit that is drawn, and with its inverse the smallest


@style.picture("there is none")
def plot_checks(checks: Checks, *, ax: Axes | None = None, title: str = "") -> Figure:
    """Draw each check as its value over the limit up to which it is fine, or the limit over the value if it must be larger."""
    if not len(checks):
        raise InputError("no check could be made, so that there is nothing to draw.")
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
    ax.legend(frameon=False, fontsize=8, loc="lower right")
    return figure


def limit_fraction(check: Check) -> float:
    """Return the part of its limit that a check takes, within what is drawn; the largest if its value is nan."""
    value, limit = (check.limit, check.value) if check.at_least else (check.value, check.limit)
    if math.isnan(check.value):
        return MAX_DRAWN_RATIO
    part = value / limit if limit else math.copysign(math.inf, value) if value else 0.0
    return min(max(part, 1 / MAX_DRAWN_RATIO), MAX_DRAWN_RATIO)
