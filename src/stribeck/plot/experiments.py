"""Pictures of experiments: which law the data prefer, what to measure next, and all curves as one."""

import numpy as np

from stribeck.experiments.compare import EXCLUDED_AICC, Comparison
from stribeck.experiments.master_curve import ABSCISSAS, MasterCurve
from stribeck.experiments.next_runs import Plan
from stribeck.plot import style
from stribeck.plot.fit import LABELS, draw_points
from stribeck.plot.style import GREY, INK, MARK, SERIES, Axes, Figure, add_legend, make_logarithmic, new_figure
from stribeck.quantities.formats import format_si


@style.picture()
def plot_comparison(comparison: Comparison, *, ax: Axes | None = None, title: str = "", notes: bool = True) -> Figure:
    """Draw by how much each law is behind the preferred one, with its weight."""
    laws = comparison.candidates
    size = 8.0, 1.4 + 0.35 * len(laws)
    failed = [f"{name}: {why}" for name, why in comparison.failed.items()] if notes else []
    inside = ax is not None
    figure, (ax,) = new_figure(size, [[comparison.sentence]], failed, title=title or "Which the data prefer", ax=ax, left=2.3)
    rows = np.arange(len(laws))
    ax.barh(rows, [each.difference for each in laws], height=0.6, color=[INK, *[GREY] * (len(laws) - 1)])
    for row, each in enumerate(laws):
        place, text = (each.difference, row), f"weight {each.weight:.2g}"
        ax.annotate(text, place, (4, 0), textcoords="offset points", va="center", size=8)
    ax.axvline(EXCLUDED_AICC, color=MARK, lw=1.0, ls=style.DASHED, zorder=0, label="practically excluded beyond")
    style.label_rows(ax, [each.name for each in laws])
    ax.set_xlim(0.0, 1.25 * max(EXCLUDED_AICC, *(each.difference for each in laws)))
    ax.set_xlabel("difference of AICc")
    add_legend(figure, [ax], inside=inside)
    return figure


@style.picture()
def plot_plan(plan: Plan, *, ax: Axes | None = None, title: str = "") -> Figure:
    """Draw the gain of a first run over the speed, a line for each curve, load and viscosity, the chosen runs marked."""
    inside = ax is not None
    figure, (ax,) = new_figure((7.0, 4.4), [], title=title or "What to measure next", ax=ax)
    colours = [each for each in SERIES if each != MARK]
    keys = list(dict.fromkeys((each.curve, each.load, each.viscosity) for each in plan.scanned))
    several = len({curve for curve, _, _ in keys}) > 1
    for i, (curve, load, viscosity) in enumerate(keys):
        mine = [each for each in plan.scanned if (each.curve, each.load, each.viscosity) == (curve, load, viscosity)]
        fluid = format_si(viscosity, "viscosity").replace("*", "·")
        label = ", ".join([*[curve] * several, format_si(load, plan.load_dimension), fluid])
        ax.plot([e.speed for e in mine], [e.gain for e in mine], color=colours[i % 5], lw=1.8, label=label)
    for speed in dict.fromkeys(each.speed for each in plan.runs):
        numbers = ", ".join(str(i) for i, each in enumerate(plan.runs, 1) if each.speed == speed)
        ax.axvline(speed, color=MARK, lw=1, ls=(0, (4, 2)))
        ax.annotate(numbers, (speed, 1.0), xycoords=("data", "axes fraction"), color=MARK, ha="center", va="bottom")
    make_logarithmic(ax, "x", np.array([each.speed for each in plan.scanned]))
    ax.set(xlabel="speed $U$ (m/s)", ylabel="gain of information")
    ax.set_ylim(bottom=0)
    add_legend(figure, [ax], columns=2, inside=inside)
    return figure


@style.picture()
def plot_master_curve(found: MasterCurve, *, ax: Axes | None = None, title: str = "", notes: bool = True) -> Figure:
    """Draw friction of all curves over each abscissa, with the common curve; into given axes over the best alone."""
    said = [[found.sentence]]
    lines = list(found.notes) if notes else []
    shown = found.collapses if ax is None else found.collapses[:1]
    shown = tuple(sorted(shown, key=lambda each: list(ABSCISSAS).index(each.over)))
    figure, axes = new_figure((5.2 * len(shown), 4.6), said, lines, title=title or "Master curve", ax=ax, columns=len(shown))
    data = found.data
    for place, each in zip(axes, shown, strict=True):
        draw_points(place, data, each.values, data.error)
        unit = "the errors" if found.has_errors else "the noise"
        label = f"scatter about one curve {each.ratio:.2g} ± {each.ratio_error:.1g} times {unit}"
        place.plot(*each.line, color=INK, lw=1.4, zorder=3, label="one curve")
        place.set_xlabel(LABELS[each.over])
        place.set_title(label, fontsize=9)
    add_legend(figure, axes[:1], inside=ax is not None)
    return figure
