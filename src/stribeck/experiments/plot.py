"""Pictures of experiments: which law the data prefer, and what to measure next.

matplotlib comes with the extra ``plot`` and is imported on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stribeck.experiments.compare import EXCLUDED_AICC, Comparison
from stribeck.experiments.next_runs import Plan
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
from stribeck.quantities.formats import format_si

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_comparison", "plot_plan"]


@picture()
def plot_comparison(
    comparison: Comparison,
    path: PathLike | None = None,
    *,
    ax: Axes | None = None,
    force: bool = False,
    title: str = "",
    notes: bool = True,
) -> Figure:
    """Draw by how much each law is behind the preferred one, with its weight.

    Parameters
    ----------
    comparison : Comparison
        The fitted laws or models.
    """
    laws = comparison.candidates
    size = 8.0, 1.4 + 0.35 * len(laws)
    failed = [f"{name}: {why}" for name, why in comparison.failed.items()] if notes else []
    figure, (ax,) = new_figure(size, [[comparison.sentence]], failed, title=title or "Which the data prefer", ax=ax, left=2.3)
    rows = np.arange(len(laws))
    ax.barh(rows, [each.difference for each in laws], height=0.6, color=[INK, *[GREY] * (len(laws) - 1)])
    for row, each in enumerate(laws):
        ax.annotate(
            f"weight {each.weight:.2g}", (each.difference, row), (4, 0), textcoords="offset points", va="center", size=8
        )
    ax.axvline(EXCLUDED_AICC, color=MARK, lw=1.0, ls=(0, (5, 3)), zorder=0, label="practically excluded beyond")
    ax.set_yticks(rows, [each.name for each in laws])
    ax.set_ylim(len(laws) - 0.4, -0.6)
    ax.set_xlim(0.0, 1.25 * max(EXCLUDED_AICC, *(each.difference for each in laws)))
    ax.set_xlabel("difference of AICc")
    ax.legend(frameon=False, fontsize=8, loc="lower right")
    return finish_figure(figure, path, force)


@picture()
def plot_plan(
    plan: Plan, path: PathLike | None = None, *, ax: Axes | None = None, force: bool = False, title: str = ""
) -> Figure:
    """Draw the gain of a first run over the speed, a line for each load and viscosity, the chosen runs marked.

    Parameters
    ----------
    plan : Plan
        The runs worth measuring.
    """
    given = ax is not None
    figure, (ax,) = new_figure((7.0, 4.4), [], title=title or "What to measure next", ax=ax)
    colours = (INK, CONTACT, FLUID, "#009e73", "#e69f00")
    keys = list(dict.fromkeys((each.load, each.viscosity) for each in plan.scanned))
    for i, (load, viscosity) in enumerate(keys):
        mine = [each for each in plan.scanned if (each.load, each.viscosity) == (load, viscosity)]
        label = f"{format_si(load, plan.load_dimension)}, {format_si(viscosity, 'viscosity').replace('*', '·')}"
        ax.plot([e.speed for e in mine], [e.gain for e in mine], color=colours[i % 5], lw=1.8, label=label)
    for i, each in enumerate(plan.runs, 1):
        ax.axvline(each.speed, color=MARK, lw=1, ls=(0, (4, 2)))
        ax.annotate(str(i), (each.speed, 1.0), xycoords=("data", "axes fraction"), color=MARK, ha="center", va="bottom")
    make_logarithmic(ax, "x", np.array([each.speed for each in plan.scanned]))
    ax.set_xlabel("speed $U$ (m/s)")
    ax.set_ylabel("gain of information")
    ax.set_ylim(bottom=0)
    if given:
        ax.legend(frameon=False, fontsize=8)
    else:
        add_legend(figure, [ax], columns=2)
    return finish_figure(figure, path, force)
