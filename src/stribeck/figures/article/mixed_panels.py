"""The panels of figure 9: friction around its minimum by the solver and by the formulas, and what is known of the minimum."""

from __future__ import annotations

from stribeck.figures import style
from stribeck.figures.article.stribeck_cases import draw_reports, drawn_cases, say_what_is_missing
from stribeck.figures.style import Axes, Dataset, Figure

MIN_FILM_RATIO = 3.0  # Film ratio above which the formulas for friction are compared.
MAX_FILM_RATIO = 20.0  # Film ratio below which the formulas for friction are compared.
MAX_KAPPA = 0.1  # Relative roughness up to which the formulas for friction are compared.

# Label and dashes of each law of Lambda at the minimum.
LAMBDA_STYLES = {
    "exact": (r"Lambert's $W$", style.DASHED),
    "expansion": ("its expansion", style.DOTTED),
    "uniform": ("ours", "-"),
}
# Label and dashes of the friction at the minimum by each law.
FRICTION_STYLES = {
    "friction_exact": (r"with Lambert's $W$", style.DASHED),
    "friction_leading": (r"$\Lambda = -\ln k$, power $+2/3$", style.DOTTED),
    "friction_printed": (r"as printed, power $-2/3$", (0, (1, 3))),
    "friction_uniform": ("ours", "-"),
}

DATA_MISSING = (
    "The paper draws data of Bongaerts 2007 here, which are\n"
    "not public to us: bars show the ranges that it quotes,\nat no roughness in particular."
)

LOAD_COLOURS = (style.FLUID, style.CONTACT)


def draw(figure: Figure, data: Dataset) -> None:
    """Draw figure 9."""
    a, b, d, errors, c, ratios = style.panels(figure, 2, 3)
    for i, look, label in drawn_cases(data):
        x = data.hydrodynamic_friction[i]
        a.loglog(x, data.friction[i], markevery=2, label=label, **look)
        shown = data.film_ratio[i] > MIN_FILM_RATIO
        a.plot(x.where(shown), data.law_large[i].where(shown), color=style.INK, ls=style.DASHED, lw=1.0, zorder=4)
        a.plot(x.where(shown), data.law_uniform[i].where(shown), color=style.MARK, ls=style.DOTTED, lw=1.6, zorder=5)
        if float(data["roughness"][i] / data["load"][i]) <= MAX_KAPPA:
            for name, dashes in (("large_error", style.DASHED), ("uniform_error", "-")):
                errors.semilogx(data.film_ratio[i], 100 * data[name][i], color=look["color"], ls=dashes, lw=1.3)
    legend = {"loc": "lower right", "title": r"$\bar F_N$,  $\bar h_\mathrm{rms}$", "fontsize": 7.5, "ncols": 2}
    x, y = r"$\mu_{f,\mathrm{th}}$", r"friction coefficient $\mu$"
    text = "dashed: the paper's formula; dotted: ours"
    style.panel(a, "a", text, legend, xlabel=x, ylabel=y, xlim=(5e-4, 10), ylim=(2e-4, 10))
    errors.axhline(0.0, color=style.GREY, lw=0.8)
    x, y = r"film ratio $c\lambda^{3/5}/\kappa$", "formula over solver − 1 (%)"
    text = "error of the friction: dashed the paper's, full ours"
    style.panel(errors, "+", text, xlabel=x, ylabel=y, xlim=(1, 100), ylim=(-100, 60))
    _draw_lambda(b, data)
    _draw_reported(d, data)
    _draw_friction(c, ratios, data)


def _draw_lambda(axes: Axes, data: Dataset) -> None:
    for i, (load, colour) in enumerate(zip(data.minimum_load.values, LOAD_COLOURS, strict=True)):
        x = data.minimum_roughness[i]
        axes.semilogx(x, data.separation[i], "o", color=colour, ms=5, label=f"solved, load {load:g}")
        axes.plot(x, data.film_ratio_at_minimum[i], "o", color=colour, mfc="white", ms=5)
        for form, (label, dashes) in LAMBDA_STYLES.items():
            axes.plot(x, data[f"lambda_{form}"][i], color=colour, ls=dashes, lw=1.2, label=label if i else None)
    axes.axhline(float(data.textbook), color=style.GREY, lw=1.2, ls=style.DASHED, label="textbook, Spikes 1997")
    x, y = r"roughness $\bar h_\mathrm{rms}$", r"$\Lambda$ at the minimum of friction"
    text = r"full dots $h(0)$, open dots $c\lambda^{3/5}$, over $\kappa$"
    style.panel(axes, "b", text, {"loc": "upper right", "ncols": 2}, xlabel=x, ylabel=y, ylim=(0, 19))


def _draw_friction(axes: Axes, ratios: Axes, data: Dataset) -> None:
    for i, (load, colour) in enumerate(zip(data.minimum_load.values, LOAD_COLOURS, strict=True)):
        x = data.minimum_roughness[i]
        axes.loglog(x, data.minimum_friction[i], "o", color=colour, ms=5, label=f"solved, load {load:g}")
        for name, (label, dashes) in FRICTION_STYLES.items():
            shown = {"color": colour, "ls": dashes, "lw": 1.2, "label": label if i else None}
            axes.plot(x, data[name][i], **shown)
            ratios.loglog(x, data[name][i] / data.minimum_friction[i], **shown)
    ratios.axhline(1.0, color=style.GREY, lw=0.8)
    x, y = r"roughness $\bar h_\mathrm{rms}$", r"minimum friction $\mu_\mathrm{min}$"
    style.panel(axes, "c", "minimum friction", {"loc": "upper left"}, xlabel=x, ylabel=y, ylim=(2e-5, 5))
    text = "the same over the solved: corrected and printed"
    style.panel(ratios, "+", text, xlabel=x, ylabel=r"formula over solver", ylim=(0.03, 2))


def _draw_reported(axes: Axes, data: Dataset) -> None:
    axes.loglog(data.k, data.lambda_of_number, color=style.INK, lw=1.6, label=r"$\Lambda^{1/3} e^{-\Lambda} = k$")
    solved = zip(data.minimum_load.values, LOAD_COLOURS, data.number.values, data.separation.values, strict=True)
    for load, colour, numbers, ratios in solved:
        axes.plot(numbers, ratios, "o", color=colour, ms=4, label=f"solved, load {load:g}")
    draw_reports(axes, data, 0.66)
    first, last = float(data.k[0]), float(data.k[-1])
    axes.set_xlim(first, first * (last / first) ** (1 / 0.66))
    say_what_is_missing(axes, DATA_MISSING)
    legend = {"loc": "lower left", "bbox_to_anchor": (0.0, 0.5)}
    x = r"$k \propto (\beta/\mu_0)\, \bar h_\mathrm{rms}^{2/3} \bar F_N^{1/3}$"
    text, y = r"instead of measured data: $\Lambda$, solved and reported", r"$\Lambda$ at the minimum of friction"
    style.panel(axes, "d", text, legend, xlabel=x, ylabel=y, ylim=(0.3, 3e5))
