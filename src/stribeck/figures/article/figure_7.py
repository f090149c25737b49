"""Figure 7: Stribeck curves over the Hersey number, and over the friction that their speed causes between smooth surfaces."""

from __future__ import annotations

import math

import numpy as np

from stribeck._types import Array, Flags
from stribeck.asymptotics import hydrodynamic, transitions
from stribeck.contacts.groups import Groups
from stribeck.figures import style
from stribeck.figures.article.stribeck_cases import (
    CASES,
    LOADS,
    REPORTED_LAMBDA,
    ROUGHNESSES,
    draw_reports,
    drawn_cases,
    give_cases,
    give_reports,
    over,
    say_what_is_missing,
    solved_cases,
)
from stribeck.figures.job import FigureJob
from stribeck.figures.style import Axes, Dataset, Figure

TITLE = "Stribeck curves of several loads and roughnesses"
CLAIM = (
    "the hydrodynamic branches spread slightly over the Hersey number, with slopes 2/5 and 2/3, and collapse onto the "
    "line y = x over mu_f,th; smoother surfaces and larger loads shift the transition to slower speeds and less friction."
)
SIZE = 13.0, 4.9
STEPS = len(CASES)

SPEED_RANGE = 1e-8, 1e3  # Speed groups of the curves.
PREDICTED_ROUGHNESS_RANGE = 1e-8, 1e-2  # Roughness groups over which Lambda is predicted.

CURVES_MISSING = (
    "The paper draws curves of Bongaerts 2007 here, whose data\n"
    "are not public to us: bars show the ranges of $\\Lambda$ that\nthe paper quotes, at no roughness in particular."
)

MAX_SOLID_FRICTION_SHARE = 1e-3  # Share of friction from asperities below which a state counts as hydrodynamic here.


def compute(work: FigureJob) -> Dataset:
    """Solve the curves and find their minima."""
    curves = solved_cases(work, SPEED_RANGE, points=67)
    (friction, law), hersey = give_cases(work, curves), over(curves, "hersey_number")
    uniform = np.array([hydrodynamic.friction_uniform.function(curve.groups) for curve in curves])
    fluid_film = over(curves, "friction.asperities") < MAX_SOLID_FRICTION_SHARE * friction
    off, ours = (np.where(fluid_film, friction / x - 1, np.nan) for x in (law, uniform))
    minima = [curve.minimum for curve in curves]
    lowest = {
        "minimum_hersey": [m.solution.hersey_number if m else math.nan for m in minima],
        "minimum_friction": [m.friction if m else math.nan for m in minima],
        "minimum_law": [float(hydrodynamic.friction.function(m.solution.groups)) if m else math.nan for m in minima],
        "separation_at_minimum": [m.solution.central_separation if m else math.nan for m in minima],
    }
    spread = _spread(hersey, friction, fluid_film)
    slopes = np.gradient(np.log(friction[0]), np.log(hersey[0]))
    slopes = np.where(fluid_film[0], slopes, np.nan)
    groups = Groups(1.0, np.array(LOADS)[:, None], np.geomspace(*PREDICTED_ROUGHNESS_RANGE, 61))
    predicted = transitions.separation_at_minimum.function(groups)
    finding = (
        f"over the Hersey number the hydrodynamic branches of loads {LOADS[0]} and {LOADS[1]} differ by up to {spread:.2f} "
        f"times; over mu_f,th they lie from {100 * np.nanmin(off):.1f} to {100 * np.nanmax(off):+.1f} % of the line y = x, "
        f"the error of mu_f,th itself (over our uniform law within {100 * np.nanmax(np.abs(ours)):.2f} %). The slope grows "
        f"from {np.nanmin(slopes):.2f} to {np.nanmax(slopes):.2f}. Lambda at the minimum falls from "
        f"{np.nanmax(lowest['separation_at_minimum']):.1f} to {np.nanmin(lowest['separation_at_minimum']):.1f} with "
        "roughness; "
        f"load {CASES[-1][0]} with roughness {CASES[-1][1]} has no minimum below its plateau. The paper names only load 0.1 "
        "with roughness 1e-4 and prints no table of the others."
    )
    work.along(
        predicted_load=(LOADS, "load group"),
        predicted_roughness=(np.geomspace(*PREDICTED_ROUGHNESS_RANGE, 61), "roughness group h_rms"),
    )
    work.give(
        ("case", "speed"),
        hersey_number=(hersey, "Hersey number eta U/F_N for beta = 1"),
        uniform_friction=(uniform, "friction of smooth surfaces by our uniform law"),
        distance=(off, "friction over hydrodynamic_friction - 1 where asperities cause < 0.1 % of it"),
        uniform_distance=(ours, "the same over uniform_friction"),
    )
    work.give((), hersey_spread=(spread, "largest ratio of hydrodynamic frictions at one Hersey number"))
    work.give("speed", slope=(slopes, "d ln friction / d ln Hersey number of the first case, where hydrodynamic"))
    work.give(("predicted_load", "predicted_roughness"), predicted_separation=(predicted, "Lambda at the minimum, law"))
    work.give("case", **{name: (values, f"{name.replace('_', ' ')} of friction") for name, values in lowest.items()})
    give_reports(work)
    return work.dataset(finding, reports="; ".join(REPORTED_LAMBDA))


def _spread(hersey: Array, friction: Array, fluid_film: Flags) -> float:
    """Return the largest ratio of the frictions of both loads, smoothest case of each, where both are hydrodynamic."""
    heavy, light = 0, len(ROUGHNESSES)
    x, y = np.log(hersey[light][fluid_film[light]]), np.log(friction[light][fluid_film[light]])
    at = np.log(hersey[heavy][fluid_film[heavy]])
    both = (at >= x[0]) & (at <= x[-1])
    difference = np.interp(at[both], x, y) - np.log(friction[heavy][fluid_film[heavy]])[both]
    return float(np.exp(np.abs(difference).max()))


def draw(figure: Figure, data: Dataset) -> None:
    """Draw the curves over the Hersey number and over the friction of smooth surfaces, and Lambda at their minima."""
    a, b, c = style.panels(figure, 1, 3, width_ratios=[1, 1, 1.05])
    friction = r"friction coefficient $\mu$"
    _draw_curves(a, data, "hersey_number", "minimum_hersey")
    legend = {"loc": "upper left", "title": r"$\bar F_N$,  $\bar h_\mathrm{rms}$", "fontsize": 7.5}
    over_hersey = {"xlabel": r"Hersey number $\eta U/F_N$", "ylabel": friction, "xlim": (1e-9, 30), "ylim": (3e-3, 150)}
    style.panel(a, "a", r"over the Hersey number, $\beta = \mu_0 = 1$", legend, **over_hersey)
    style.slope(a, 3e-5, 5e-3, 0.4, "2/5")
    style.slope(a, 0.3, 2.2, 2 / 3, "2/3")
    line = np.array([1e-3, 200])
    b.plot(line, line, color=style.INK, lw=1.1, ls=style.DASHED, label="$y = x$")
    _draw_curves(b, data, "hydrodynamic_friction", "minimum_law", labels=False)
    over_smooth = {"xlabel": r"$\mu_{f,\mathrm{th}}$", "ylabel": friction, "xlim": (3e-5, 150), "ylim": (3e-3, 150)}
    style.panel(b, "b", "over the friction of smooth surfaces", {"loc": "upper left"}, **over_smooth)
    _draw_ratios(c, data)


def _draw_curves(axes: Axes, data: Dataset, x: str, minimum: str, labels: bool = True) -> None:
    for i, look, label in drawn_cases(data):
        axes.loglog(data[x][i], data.friction[i], markevery=2, label=label if labels else None, **look)
        if np.isfinite(data[minimum].values[i]):
            words = "minimum friction" if i == 0 and not labels else None
            axes.plot(data[minimum][i], data.minimum_friction[i], "v", color=style.MARK, ms=5, zorder=5, label=words, ls="")


def _draw_ratios(axes: Axes, data: Dataset) -> None:
    for load, ratios, dashes in zip(
        data.predicted_load.values, data.predicted_separation.values, (style.DASHED, style.DOTTED), strict=True
    ):
        axes.loglog(data.predicted_roughness, ratios, color=style.INK, ls=dashes, lw=1.4, label=f"formula, load {load:g}")
    for i, look, _ in drawn_cases(data):
        axes.plot(data["roughness"][i], data.separation_at_minimum[i], **look | {"ms": 7})
    draw_reports(axes, data, 0.66)
    axes.set_xlim(1e-8, 10 ** (-8 + 6 / 0.66))
    say_what_is_missing(axes, CURVES_MISSING)
    legend = {"loc": "lower left", "bbox_to_anchor": (0.0, 0.52)}
    x, y = r"roughness $\bar h_\mathrm{rms}$", r"$\Lambda$ at the minimum of friction"
    text = r"instead of measured curves: $\Lambda$, solved and reported"
    style.panel(axes, "c", text, legend, xlabel=x, ylabel=y, ylim=(0.3, 3e5))
