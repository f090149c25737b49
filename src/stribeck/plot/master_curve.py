"""Picture of a master curve: friction of all curves over viscosity times speed and over the Hersey number."""

from __future__ import annotations

from stribeck.experiments.master_curve import ABSCISSAS, MasterCurve
from stribeck.plot import style
from stribeck.plot.fit import LABELS, draw_points
from stribeck.plot.style import INK, Axes, Figure, add_legend, new_figure


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
