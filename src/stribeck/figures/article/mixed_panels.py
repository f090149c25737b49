"""The panels of figure 9: friction around its minimum by the solver and by the formulas, and what is known of the minimum."""

from __future__ import annotations

from typing import Any

from stribeck.figures import style
from stribeck.figures.article.stribeck_cases import draw_reports, drawn_cases
from stribeck.figures.style import Dataset, Panels

# Film ratios and relative roughness for which the formulas for friction are compared.
MIN_FILM_RATIO, MAX_FILM_RATIO = 3.0, 20.0
MAX_KAPPA = 0.1

# Label and dashes of each law of Lambda at the minimum.
LAMBDA_STYLES = {
    "lambda_exact": (r"Lambert's $W$", style.DASHED),
    "lambda_expansion": ("its expansion", style.DOTTED),
    "lambda_uniform": ("ours", "-"),
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


def draw(panels: Panels, data: Dataset) -> None:
    """Draw figure 9."""
    a, b, d, errors, c, ratios = panels.values()
    for row, look in drawn_cases(data):
        x, shown = row.hydrodynamic_friction, row.film_ratio > MIN_FILM_RATIO
        a.plot(x, row.friction, markevery=2, **look)
        a.plot(x.where(shown), row.law_large.where(shown), color=style.INK, ls=style.DASHED, lw=1.0, zorder=4)
        a.plot(x.where(shown), row.law_uniform.where(shown), color=style.MARK, ls=style.DOTTED, lw=1.6, zorder=5)
        if float(row["roughness"] / row["load"]) <= MAX_KAPPA:
            for error, dashes in ((row.large_error, style.DASHED), (row.uniform_error, "-")):
                errors.plot(row.film_ratio, 100 * error, color=look["color"], ls=dashes, lw=1.3)
    errors.axhline(0.0, color=style.GREY, lw=0.8)
    d.plot(data.k, data.lambda_of_number, color=style.INK, lw=1.6, label=r"$\Lambda^{1/3} e^{-\Lambda} = k$")
    for i, colour in enumerate((style.FLUID, style.CONTACT)):
        row = data.isel(minimum_load=i)
        x = row.minimum_roughness
        dots: dict[str, Any] = {"marker": "o", "ls": "", "color": colour, "ms": 5}
        solved = f"solved, load {float(row.minimum_load):g}"
        b.plot(x, row.separation, label=solved, **dots)
        b.plot(x, row.film_ratio_at_minimum, mfc="white", **dots)
        c.plot(x, row.minimum_friction, label=solved, **dots)
        d.plot(row.number, row.separation, label=solved, **dots | {"ms": 4})
        for axes, laws in ((b, LAMBDA_STYLES), (c, FRICTION_STYLES)):
            for name, (label, dashes) in laws.items():
                axes.plot(x, row[name], color=colour, ls=dashes, lw=1.2, label=label if i else None)
        for name, (_, dashes) in FRICTION_STYLES.items():
            ratios.plot(x, row[name] / row.minimum_friction, color=colour, ls=dashes, lw=1.2)
    b.axhline(float(data.textbook), color=style.GREY, lw=1.2, ls=style.DASHED, label="textbook, Spikes 1997")
    ratios.axhline(1.0, color=style.GREY, lw=0.8)
    draw_reports(d, data, data.k, DATA_MISSING)
