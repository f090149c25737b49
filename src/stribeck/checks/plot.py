"""The picture of the checks: each value over its limit, coloured by the verdict.

matplotlib comes with the extra ``plot`` and is imported on first use.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from stribeck.files.pictures import CONTACT, FLUID, GREY, INK, MARK, finish_figure, new_figure, picture
from stribeck.files.writing import PathLike
from stribeck.quantities.units import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stribeck.checks.check import Check, Checks

__all__ = ["plot_checks"]

VERDICT_COLOURS = {"fine": FLUID, "doubtful": MARK, "outside": CONTACT}

MAX_DRAWN_RATIO = 1e3  # Largest ratio of a value and its limit that is drawn, and with its inverse the smallest


@picture("there is none")
def plot_checks(
    checks: Checks, path: PathLike | None = None, *, ax: Axes | None = None, force: bool = False, title: str = ""
) -> Figure:
    """Draw each check as its value over the limit up to which it is fine, or the limit over the value if it must be larger.

    Parameters
    ----------
    checks : Checks
        The checks.
    """
    if not len(checks):
        raise InputError("no check could be made, so that there is nothing to draw.")
    size, headline = (9.5, 1.2 + 0.28 * len(checks)), [[checks.headline]]
    figure, (ax,) = new_figure(size, headline, title=title or "Whether the model applies", ax=ax, left=2.2, right=2.3)
    ax.set_xscale("log")
    for verdict, colour in VERDICT_COLOURS.items():
        mine = [(row, limit_fraction(each)) for row, each in enumerate(checks) if each.verdict == verdict]
        rows, parts = (np.array(each) for each in zip(*mine, strict=True)) if mine else (np.empty(0), np.empty(0))
        ax.hlines(rows, 1 / MAX_DRAWN_RATIO, parts, color=colour, lw=1.6)
        ax.plot(
            parts, rows, ls="", marker={"fine": "o", "doubtful": "D", "outside": "s"}[verdict], color=colour, label=verdict
        )
    for row, each in enumerate(checks):
        value, limit = each.texts
        ax.annotate(f"{value} ({limit})", (1.01, row), xycoords=("axes fraction", "data"), va="center", size=7.5, color=INK)
    ax.axvline(1.0, color=GREY, lw=0.9, ls=(0, (5, 3)), zorder=0)
    ax.set_yticks(range(len(checks)), [each.name for each in checks])
    ax.set(
        xlim=(1 / MAX_DRAWN_RATIO, MAX_DRAWN_RATIO),
        ylim=(len(checks) - 0.4, -0.6),
        xlabel="part of its limit; beyond 1 is not fine",
    )
    ax.legend(frameon=False, fontsize=8, loc="lower right")
    return finish_figure(figure, path, force)


def limit_fraction(check: Check) -> float:
    """Return the part of its limit that a check takes, within what is drawn; the largest if its value is nan."""
    value, limit = (check.limit, check.value) if check.at_least else (check.value, check.limit)
    if math.isnan(check.value):
        return MAX_DRAWN_RATIO
    part = value / limit if limit else math.copysign(math.inf, value) if value else 0.0
    return min(max(part, 1 / MAX_DRAWN_RATIO), MAX_DRAWN_RATIO)
