"""What figures 7, 9 and 10 share: the Stribeck curves of several loads and roughnesses, and the reported values of Lambda."""

from __future__ import annotations

from collections.abc import Iterator
from operator import attrgetter
from typing import Any

import numpy as np

from stribeck._types import Array
from stribeck.curves.result import StribeckCurve
from stribeck.figures import style
from stribeck.figures.job import FigureJob
from stribeck.figures.style import Axes, Dataset

LOADS = (0.1, 0.01)  # Load groups of the curves.
ROUGHNESSES = (1e-5, 1e-4, 1e-3, 1e-2)  # Roughness groups of the curves.
# Load and roughness group of each curve.  [BP] name one pair only, load 0.1 with roughness 1e-4 in blue; relative roughness
# reaches from 1e-4 to the 1 of which they say that the minimum lies near speed 1.
CASES = tuple((load, roughness) for load in LOADS for roughness in ROUGHNESSES)

# Ranges of Lambda at the transition in experiments, as the text of [BP] quotes them; the data themselves are not public.
REPORTED_LAMBDA = {
    "Bongaerts 2007": (0.7, 11.0),
    "Petrova 2019": (0.7, 1.2),
    "Sadowski 2019": (0.9, 2.3),
    "Dong 2023": (16.0, 2736.0),
}

TEXTBOOK_LAMBDA = 3.0  # Lambda that textbooks take for all contacts, after Spikes 1997.

REPORT_COLOURS = ("#cc79a7", "#e69f00", "#56b4e9", "#8c6d46")


def solved_cases(work: FigureJob, speed: tuple[float, float], points: int, **options: Any) -> list[StribeckCurve]:
    """Return the curve of each of :data:`CASES`."""
    return [work.curve(load=load, roughness=rough, speed=speed, points=points, **options) for load, rough in CASES]


def give_cases(work: FigureJob, curves: list[StribeckCurve]) -> tuple[Array, Array]:
    """Take the curves of the cases; return their friction, and that of smooth surfaces."""
    loads, roughnesses = zip(*CASES, strict=True)
    friction, smooth = over(curves, "friction"), over(curves, "hydrodynamic_friction")
    work.along("case", load=(loads, "load group"), roughness=(roughnesses, "roughness group h_rms"))
    work.along(speed=(curves[0].values, "speed group lambda"))
    work.give(
        ("case", "speed"),
        friction=(friction, "friction coefficient, definition published"),
        hydrodynamic_friction=(smooth, "friction of smooth surfaces by the root of squares of the paper"),
    )
    return friction, smooth


def give_reports(work: FigureJob) -> None:
    """Take the reported ranges of Lambda along the dimension ``report``, whose names are in the attribute ``reports``."""
    low, high = zip(*REPORTED_LAMBDA.values(), strict=True)
    work.give(
        "report",
        reported_low=(low, "minimum Lambda at the transition that the paper quotes from experiments"),
        reported_high=(high, "largest Lambda at the transition that the paper quotes from experiments"),
    )
    work.give((), textbook=(TEXTBOOK_LAMBDA, "Lambda at the transition by textbooks"))


def over(curves: list[StribeckCurve], name: str) -> Array:
    """Return an array of each curve, such as ``"friction"``, as rows."""
    return np.array([attrgetter(name)(curve) for curve in curves])


def drawn_cases(data: Dataset) -> Iterator[tuple[int, dict[str, Any], str]]:
    """Yield number, style and label of each case: colours for roughness; circles for the heavy, squares for the light load."""
    roughnesses = sorted(set(data["roughness"].values.tolist()))
    colours = dict(zip(roughnesses, style.sequence(len(roughnesses)), strict=True))
    heaviest = float(data["load"].max())
    for i, (load, roughness) in enumerate(zip(data["load"].values.tolist(), data["roughness"].values.tolist(), strict=True)):
        heavy = load == heaviest
        marks = {"marker": "o" if heavy else "s", "ms": 3.6, "mfc": colours[roughness] if heavy else "white", "lw": 1.1}
        yield i, {"color": colours[roughness]} | marks, f"{load:g},  {style.power(roughness)}"


def draw_reports(axes: Axes, data: Dataset, left: float) -> None:
    """Draw the reported ranges as bars at the right of a panel of Lambda, from ``left`` of its width on."""
    axes.fill_between([left, 1.0], 0.0, 1.0, transform=axes.transAxes, color="#f4f4f2", lw=0, zorder=0)
    across = axes.get_yaxis_transform()
    names = data.attrs["reports"].split("; ")
    places = left + (1 - left) * (np.arange(len(names)) + 0.5) / len(names)
    for place, name, colour, low, high in zip(
        places, names, REPORT_COLOURS, data.reported_low.values, data.reported_high.values, strict=True
    ):
        axes.plot([place, place], [low, high], color=colour, lw=6, solid_capstyle="butt", transform=across)
        axes.text(place, 1.25 * high, name, transform=across, rotation=90, size=7.5, color=style.INK, ha="center", va="bottom")
    axes.axhline(float(data.textbook), color=style.GREY, lw=1.1, ls=style.DASHED, label="textbook, Spikes 1997")


def say_what_is_missing(axes: Axes, text: str) -> None:
    """Write what the paper draws in the free part of a panel of Lambda, beside what is drawn in its place."""
    axes.set_xticks([1e-8, 1e-6, 1e-4, 1e-2])
    axes.minorticks_off()
    axes.text(0.03, 0.97, text, transform=axes.transAxes, size=7.5, color=style.GREY, va="top")
